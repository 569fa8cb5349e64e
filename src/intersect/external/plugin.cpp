#include "intersect/external/plugin.hpp"

#include <dlfcn.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <string_view>
#include <system_error>
#include <utility>

#include "intersect/external/guard.hpp"
#include "intersect/external/pipe_header.hpp"
#include "intersect/process/child.hpp"
#include "intersect/process/process_state.hpp"
#include "number/error.hpp"
#include "text/shell_word.hpp"

namespace lostbits::intersect::external {

namespace fs = std::filesystem;

namespace {

std::vector<fs::path> search_path() {
    std::vector<fs::path> folders;
    if (const char* const path = process::own_environment("LOSTBITS_PLUGIN_PATH")) {
        std::string rest = path;
        for (std::size_t colon = 0; colon != std::string::npos;) {
            colon = rest.find(':');
            if (colon != 0 && !rest.empty()) folders.emplace_back(rest.substr(0, colon));
            rest = colon == std::string::npos ? "" : rest.substr(colon + 1);
        }
    }

    // The folders beside the program: of a build, then of an installation.
    std::error_code ignored;
    const fs::path program = fs::read_symlink("/proc/self/exe", ignored);
    if (!program.empty()) {
        folders.push_back(program.parent_path() / "plugins");
        folders.push_back(program.parent_path().parent_path() / "lib" / "lostbits" / "plugins");
    }
    return folders;
}

/// The loader's error text without the name of the library in front, since our message already begins with that name.
std::string loader_error(const fs::path& library) {
    std::string text = dlerror();
    const std::string prefix = library.string() + ": ";
    if (text.starts_with(prefix)) text.erase(0, prefix.size());
    return text;
}

}  // namespace

ForeignForm build_foreign_form(const lb_form& form, const std::string& from,
                               const process::FloatingPointState& fp_state) {
    ForeignForm result{read_form_contract(form, from), from, {}};
    result.contract.state = fp_state.differences();
    const char* const lasting_name = never_freed_copy(name_in_messages(result));
    result.answer = [&form, lasting_name, fp_state](const lb_batch& request) {
        lb_batch batch = request;
        batch.own = form.own;
        const char* const refusal = call_foreign(lasting_name, [&] {
            const ForeignCodeScope guard(lasting_name, fp_state);
            return form.run(&batch);
        });
        if (refusal != nullptr) throw EnvironmentError(std::string(lasting_name) + ": " + quote_text(refusal, 400));
    };
    return result;
}

std::string prefix_of_plugin(const std::string& option) {
    std::error_code ignored;
    const std::size_t end = option.find('=');
    if (end == std::string::npos || option.substr(0, end).find('/') != std::string::npos ||
        fs::is_regular_file(option, ignored))
        return "";
    return option.substr(0, end) + ".";
}

void add_prefix(ForeignForm& form, const std::string& prefix) {
    form.contract.name = prefix + form.contract.name;
    require_valid(form.contract, "--plugin " + prefix.substr(0, prefix.size() - 1) + "=" + form.provider);
}

fs::path find_plugin(const std::string& option) {
    std::error_code ignored;
    const std::string library_name = option.substr(prefix_of_plugin(option).size());
    if (library_name.empty() && !option.empty())
        throw InputError("--plugin " + option + ": names no library; write its path after the =, as in " + option +
                         "mine.so");

    const fs::path library_path(library_name);
    if (fs::is_regular_file(library_path, ignored)) return library_path;
    if (library_name.find('/') != std::string::npos) throw InputError(library_name + ": no such file");

    std::string searched = "in the current folder";
    for (const fs::path& folder : search_path()) {
        for (const fs::path& path : {folder / library_name, folder / (library_name + ".so")}) {
            if (fs::is_regular_file(path, ignored)) return path;
        }
        searched += ", " + folder.string();
    }
    throw InputError("--plugin " + library_name + ": no such file; looked " + searched +
                     "; give its path, or set LOSTBITS_PLUGIN_PATH");
}

const char* never_freed_copy(const std::string& text) { return (new std::string(text))->c_str(); }

namespace {

std::string read_first_bytes(const fs::path& file, std::size_t size) {
    std::string text(size, '\0');
    std::ifstream in(file, std::ios::binary);
    in.read(text.data(), static_cast<std::streamsize>(size));
    text.resize(static_cast<std::size_t>(in.gcount()));
    return text;
}

/// True if the name has the extension of a C or C++ source.
bool is_source(const fs::path& file) {
    constexpr std::array<std::string_view, 7> endings{".c", ".cc", ".cpp", ".cxx", ".C", ".h", ".hpp"};
    const std::string ending = file.extension().string();
    return std::ranges::find(endings, std::string_view(ending)) != endings.end();
}

/// Returns the command that compiles a source file to a library. A formula needs the program's own headers and flags.
std::string compile_command(const fs::path& source) {
    const bool is_formula = read_first_bytes(source, 65536).find("lostbits_form.hpp") != std::string::npos;
    return (is_formula ? "c++ -shared " : "c++ -O2 -shared -fPIC ") + text::shell_word(source.filename().string()) +
           " -o " + text::shell_word(source.stem().string() + ".so") + (is_formula ? " @build/form.flags" : "");
}

}  // namespace

Library load_library(const fs::path& library) {
    static std::map<void*, process::FloatingPointState>
        states_after_load;  // by handle; a second load runs no initialisers
    const std::string path = library.string();
    const char* const lasting_path = never_freed_copy(path);
    if (read_first_bytes(library, 4) != "\177ELF")
        throw InputError(path + " is not a library; " +
                         (is_source(library) ? "compile it first: " + compile_command(library)
                                             : "give one that a compiler made (c++ -O2 -shared -fPIC mine.cpp -o "
                                               "mine.so), or a program with --pipe"));
    // The path is absolute: for a name without a slash the loader would search its own folders.
    const auto [library_handle, state_after_load] = call_foreign(lasting_path, [&] {
        const ForeignLoadScope loading(lasting_path);
        void* const handle = dlopen(fs::absolute(library).c_str(), RTLD_NOW | RTLD_LOCAL);
        return std::pair(handle, loading.current_state());
    });
    if (library_handle == nullptr)
        throw InputError(path + ": cannot be loaded: " + loader_error(fs::absolute(library)));
    return {library_handle, states_after_load.try_emplace(library_handle, state_after_load).first->second};
}

std::vector<ForeignForm> load_plugin(const fs::path& library) {
    const std::string path = library.string();
    const char* const lasting_path = never_freed_copy(path);
    const Library loaded = load_library(library);
    using FormsFunction = const lb_form* (*)(int, std::size_t*);
    const auto list_forms = find_symbol<FormsFunction>(loaded, "lostbits_forms");
    if (list_forms == nullptr)
        throw InputError(path +
                         ": exports no lostbits_forms; write LOSTBITS_FORMS(...) of lostbits_plugin.hpp or "
                         "LOSTBITS_FORMULAS(...) of lostbits_form.hpp outside of every namespace, or in C define "
                         "lostbits_forms as lostbits_plugin.h declares it");

    std::size_t count = 0;
    // The call that returns the list counts as loading: it may change the floating-point state, and users of the
    // library compute in the state that it leaves.
    const auto [forms, fp_state] = call_foreign(lasting_path, [&] {
        const ForeignLoadScope loading(lasting_path, loaded.fp_state);
        const lb_form* const list = list_forms(LOSTBITS_PLUGIN_ABI, &count);
        return std::pair(list, loading.current_state());
    });

    // A library may have only forms that march, which the C interface does not know.
    if (count == 0 && dlsym(loaded.handle, "lostbits_formulas") != nullptr) return {};
    if (forms == nullptr)
        throw InputError(path + ": has no forms for version " + std::to_string(LOSTBITS_PLUGIN_ABI) +
                         " of lostbits_plugin.h; compile it again with the header of this program");
    if (count == 0 || count > 4096)
        throw InputError(path + ": states " + std::to_string(count) + " forms; the number must be from 1 to 4096");

    std::vector<ForeignForm> result;
    for (std::size_t i = 0; i < count; ++i) result.push_back(build_foreign_form(forms[i], path, fp_state));
    return result;
}

}  // namespace lostbits::intersect::external
