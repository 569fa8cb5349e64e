// Libraries that export `lostbits_forms`.
#pragma once

#include <dlfcn.h>

#include <filesystem>
#include <string>
#include <vector>

#include "intersect/doors/contract.hpp"
#include "intersect/process/floating_point.hpp"

namespace lostbits::intersect::doors {

/// Where a library lies that the command line names: a path as it stands; a name without a slash is looked for in
/// $LOSTBITS_PLUGIN_PATH (folders separated by colons), in `plugins` beside the program and in the installed
/// `lib/lostbits/plugins`, also with `.so` added. InputError that says where it looked.
/// Before it may stand NAME=, see `prefix_of_plugin`.
std::filesystem::path find_plugin(const std::string& named);

/// `new.` of `new=mine.so`: what the names of its forms begin with then, so that two builds of one library can be in
/// one run. Empty where there is no NAME=, or a file has that name.
std::string prefix_of_plugin(const std::string& named);

/// The form under a name that begins so. InputError where that is not a name.
void rename(ForeignForm& form, const std::string& prefix);

/// A library that is loaded, and stays so.
struct Library {
    void* handle;  ///< what `dlsym` takes
    /// What loading it left: its users compute so, and so it is run.
    process::FloatingPoint computes;
};

/// Loads a library. InputError for what is no library.
Library load_library(const std::filesystem::path& library);

/// Where a library gives its list: the function of that name. Null where it exports none.
template <class Ask>
Ask entry_of(const Library& library, const char* name) {
    return reinterpret_cast<Ask>(dlsym(library.handle, name));
}

/// A text that is kept beyond the end of main(): what is called when the program exits may ask for it.
const char* lasting_text(const std::string& text);

/// A form as a library states it, which lives as long as the library is loaded. `computes`: what loading it left.
/// InputError, which begins with `from`, for a contract that makes no sense.
ForeignForm foreign(const lb_form& form, const std::string& from, const process::FloatingPoint& computes);

/// Loads a library, which stays loaded, and asks it for its forms. InputError for what is no library, exports no
/// `lostbits_forms`, is of another version, or states contracts that make no sense.
std::vector<ForeignForm> load_plugin(const std::filesystem::path& library);

}  // namespace lostbits::intersect::doors
