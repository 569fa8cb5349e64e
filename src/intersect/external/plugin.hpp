// Plugins: libraries that export `lostbits_forms`.
#pragma once

#include <dlfcn.h>

#include <filesystem>
#include <string>
#include <vector>

#include "intersect/external/contract.hpp"
#include "intersect/process/floating_point.hpp"

namespace lostbits::intersect::external {

/// Finds the library that the command line names. A path is used unchanged. A name without a slash is looked for in
/// $LOSTBITS_PLUGIN_PATH (folders separated by colons), in `plugins` beside the program and in the installed
/// `lib/lostbits/plugins`, also with `.so` appended. NAME= may precede it, see `prefix_of_plugin`. Throws InputError
/// that lists the folders if there is no such file.
std::filesystem::path find_plugin(const std::string& option);

/// Returns `new.` for `new=mine.so`: a prefix for the names of the library's forms, so that two builds of one library
/// can be in one run. Empty if there is no NAME=, or if a file has the name `option`.
std::string prefix_of_plugin(const std::string& option);

/// Puts a prefix in front of the form's name. Throws InputError if the result is not a valid name.
void add_prefix(ForeignForm& form, const std::string& prefix);

/// A library that is loaded and stays loaded.
struct Library {
    void* handle;  ///< handle for `dlsym`
    /// Floating-point environment that the library's initialisation leaves. A program that uses the library computes in
    /// this environment, so the forms of the library are called in it, too.
    process::FloatingPointState fp_state;
};

/// Loads a library. Throws InputError if the file is not a library.
Library load_library(const std::filesystem::path& library);

/// Returns the address of the function with that name, such as the one that returns a library's list of forms. Null if
/// the library exports no such function.
template <class Function>
Function find_symbol(const Library& library, const char* name) {
    return reinterpret_cast<Function>(dlsym(library.handle, name));
}

/// Returns a copy of a text that is never freed: exit handlers may read it after the end of main().
const char* never_freed_copy(const std::string& text);

/// Returns a form as a library states it. `form` must live as long as the library is loaded. `fp_state` is the
/// floating-point environment of the library. Throws InputError, which begins with `from`, for an invalid contract.
ForeignForm build_foreign_form(const lb_form& form, const std::string& from,
                               const process::FloatingPointState& fp_state);

/// Loads a library, which stays loaded, and calls it for its forms. Throws InputError if the file is not a library,
/// exports no `lostbits_forms`, is of another version, or states invalid contracts.
std::vector<ForeignForm> load_plugin(const std::filesystem::path& library);

}  // namespace lostbits::intersect::external
