// Libraries that export `lostbits_forms`.
#pragma once

#include <dlfcn.h>

#include <filesystem>
#include <string>
#include <vector>

#include "intersect/external/contract.hpp"
#include "intersect/process/floating_point.hpp"

namespace lostbits::intersect::external {

/// Finds the library that the command line names. A path is taken as it stands. A name without a slash is looked for in
/// $LOSTBITS_PLUGIN_PATH (folders separated by colons), in `plugins` beside the program and in the installed
/// `lib/lostbits/plugins`, also with `.so` added. NAME= may stand before it, see `prefix_of_plugin`. InputError that
/// says where it looked.
std::filesystem::path find_plugin(const std::string& named);

/// `new.` for `new=mine.so`: a prefix for the names of its forms, so that two builds of one library can be in one run.
/// Empty if there is no NAME=, or if a file has that name.
std::string prefix_of_plugin(const std::string& named);

/// Puts a prefix in front of the form's name. InputError if the result is not a valid name.
void rename(ForeignForm& form, const std::string& prefix);

/// A library that is loaded and stays loaded.
struct Library {
    void* handle;  ///< what `dlsym` takes
    /// Floating-point environment that the library's initialisation leaves behind. A program that uses the library
    /// computes in this environment, so its forms are called in it too.
    process::FloatingPoint fp_state;
};

/// Loads a library. InputError if the file is not a library.
Library load_library(const std::filesystem::path& library);

/// Address of the function of that name, by which a library gives its list. Null if it exports none.
template <class Ask>
Ask entry_of(const Library& library, const char* name) {
    return reinterpret_cast<Ask>(dlsym(library.handle, name));
}

/// A copy of a text that is kept beyond the end of main(): exit handlers may ask for it.
const char* lasting_text(const std::string& text);

/// A form as a library states it; it lives as long as the library is loaded. `fp_state`: the
/// floating-point environment of its library. InputError, which begins with `from`, for an invalid contract.
ForeignForm foreign(const lb_form& form, const std::string& from, const process::FloatingPoint& fp_state);

/// Loads a library, which stays loaded, and asks it for its forms. InputError if the file is not a library, exports no
/// `lostbits_forms`, is of another version, or states invalid contracts.
std::vector<ForeignForm> load_plugin(const std::filesystem::path& library);

}  // namespace lostbits::intersect::external
