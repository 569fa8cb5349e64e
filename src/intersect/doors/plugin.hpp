// Libraries that export `lostbits_forms`.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "intersect/doors/contract.hpp"

namespace lostbits::intersect::doors {

/// Where a library lies that the command line names: a path as it stands; a name without a slash is looked for in
/// $LOSTBITS_PLUGIN_PATH (folders separated by colons), in `plugins` beside the program and in the installed
/// `lib/lostbits/plugins`, also with `.so` added. InputError that says where it looked.
std::filesystem::path find_plugin(const std::string& named);

/// Loads a library, which stays loaded: what `dlsym` takes. InputError for what is no library.
void* load_library(const std::filesystem::path& library);

/// A text that is kept beyond the end of main(): what is called when the program exits may ask for it.
const char* lasting_text(const std::string& text);

/// Loads a library, which stays loaded, and asks it for its forms. InputError for what is no library, exports no
/// `lostbits_forms`, is of another version, or states contracts that make no sense.
std::vector<ForeignForm> load_plugin(const std::filesystem::path& library);

}  // namespace lostbits::intersect::doors
