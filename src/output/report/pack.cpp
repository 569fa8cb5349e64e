#include "output/report/pack.hpp"

#include <zlib.h>

#include <stdexcept>

#include "output/file/base64.hpp"

namespace lostbits::output::report {

std::string pack(std::string_view bytes) {
    uLongf size = compressBound(static_cast<uLong>(bytes.size()));
    std::string packed(size, '\0');
    const int code = compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                               reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uLong>(bytes.size()), 9);
    if (code != Z_OK)
        throw std::runtime_error("zlib could not deflate a part of the report: code " + std::to_string(code));
    packed.resize(size);
    return file::encode_base64(packed);
}

}  // namespace lostbits::output::report
