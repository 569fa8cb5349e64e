// Bytes as text of 64 letters, for data inside of HTML and SVG.
#pragma once

#include <string>
#include <string_view>

namespace lostbits::output::file {

/// Base64 of RFC 4648, with padding.
[[nodiscard]] std::string encode_base64(std::string_view bytes);

}  // namespace lostbits::output::file
