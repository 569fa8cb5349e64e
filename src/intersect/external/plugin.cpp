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
#include "intersect/process/own_state.hpp"
#include "number/error.hpp"

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
    std::error_code ignored;
    const fs::path program = fs::read_symlink("/proc/self/exe", ignored);
    if (!program.empty()) {
        folders.push_back(program.parent_path() / "plugins");
        folders.push_back(program.parent_path().parent_path() / "lib" / "lostbits" / "plugins");
    }
    return folders;
}

/// The loader's error text without the library's name in front, with which our message begins already.
std::string loader_words(const fs::path& library) {
    std::string words = dlerror();
    const std::string prefix = library.string() + ": ";
    if (words.starts_with(prefix)) words.erase(0, prefix.size());
    return words;
}

}  // namespace

ForeignForm foreign(const lb_form& form, const std::string& from, const process::FloatingPoint& fp_state) {
    ForeignForm made{contract_of(form, from), from, {}};
    made.contract.state = fp_state.differences();
    const char* const who = lasting_text(name_in_messages(made));
    made.answer = [&form, who, fp_state](const lb_batch& asked) {
        lb_batch batch = asked;
        batch.own = form.own;
        const char* const refused = call_of(who, [&] {
            const InForeignCode here(who, fp_state);
            return form.run(&batch);
        });
        if (refused != nullptr) throw EnvironmentError(std::string(who) + ": " + shown_text(refused, 400));
    };
    return made;
}

std::string prefix_of_plugin(const std::string& named) {
    std::error_code ignored;
    const std::size_t end = named.find('=');
    if (end == std::string::npos || named.substr(0, end).find('/') != std::string::npos ||
        fs::is_regular_file(named, ignored))
        return "";
    return named.substr(0, end) + ".";
}

void rename(ForeignForm& form, const std::string& prefix) {
    form.contract.name = prefix + form.contract.name;
    require_sense(form.contract, "--plugin " + prefix.substr(0, prefix.size() - 1) + "=" + form.from);
}

fs::path find_plugin(const std::string& word) {
    std::error_code ignored;
    const std::string named = word.substr(prefix_of_plugin(word).size());
    if (named.empty() && !word.empty())
        throw InputError("--plugin " + word + ": names no library; write its path after the =, as in " + word +
                         "mine.so");
    const fs::path given(named);
    if (fs::is_regular_file(given, ignored)) return given;
    if (named.find('/') != std::string::npos) throw InputError(named + ": no such file");
    std::string looked = "in the current folder";
    for (const fs::path& folder : search_path()) {
        for (const fs::path& path : {folder / named, folder / (named + ".so")}) {
            if (fs::is_regular_file(path, ignored)) return path;
        }
        looked += ", " + folder.string();
    }
    throw InputError("--plugin " + named + ": no such file; looked " + looked +
                     "; give its path, or set LOSTBITS_PLUGIN_PATH");
}

const char* lasting_text(const std::string& text) { return (new std::string(text))->c_str(); }

namespace {

std::string beginning(const fs::path& file, std::size_t size) {
    std::string text(size, '\0');
    std::ifstream in(file, std::ios::binary);
    in.read(text.data(), static_cast<std::streamsize>(size));
    text.resize(static_cast<std::size_t>(in.gcount()));
    return text;
}

/// True if the name ends like that of a source of C or C++.
bool is_source(const fs::path& file) {
    constexpr std::array<std::string_view, 7> endings{".c", ".cc", ".cpp", ".cxx", ".C", ".h", ".hpp"};
    const std::string ending = file.extension().string();
    return std::ranges::find(endings, std::string_view(ending)) != endings.end();
}

/// The command that compiles a source file to a library. The source of a formula needs the program's own headers and
/// flags.
std::string compiling(const fs::path& source) {
    const bool formula = beginning(source, 65536).find("lostbits_form.hpp") != std::string::npos;
    return (formula ? "c++ -shared " : "c++ -O2 -shared -fPIC ") + process::shell_word(source.filename().string()) +
           " -o " + process::shell_word(source.stem().string() + ".so") + (formula ? " @build/form.flags" : "");
}

}  // namespace

Library load_library(const fs::path& library) {
    static std::map<void*, process::FloatingPoint> left;  // by the first load: a second one runs no initialisers
    const std::string from = library.string();
    const char* const who = lasting_text(from);
    if (beginning(library, 4) != "\177ELF")
        throw InputError(from + ": is not a library; " +
                         (is_source(library) ? "compile it first: " + compiling(library)
                                             : "give one that a compiler made (c++ -O2 -shared -fPIC mine.cpp -o "
                                               "mine.so), or a program with --pipe"));
    // The path is absolute: for a name without a slash the loader would search its own folders.
    const auto [loaded, now] = call_of(who, [&] {
        const LoadsForeignCode here(who);
        void* const handle = dlopen(fs::absolute(library).c_str(), RTLD_NOW | RTLD_LOCAL);
        return std::pair(handle, here.left());
    });
    if (loaded == nullptr) throw InputError(from + ": cannot be loaded: " + loader_words(fs::absolute(library)));
    return {loaded, left.try_emplace(loaded, now).first->second};
}

std::vector<ForeignForm> load_plugin(const fs::path& library) {
    const std::string from = library.string();
    const char* const who = lasting_text(from);
    const Library loaded = load_library(library);
    using Ask = const lb_form* (*)(int, std::size_t*);
    const auto ask = entry_of<Ask>(loaded, "lostbits_forms");
    if (ask == nullptr)
        throw InputError(from +
                         ": exports no lostbits_forms; write LOSTBITS_FORMS(...) of lostbits_plugin.hpp or "
                         "LOSTBITS_FORMULAS(...) of lostbits_form.hpp outside of every namespace, or in C define "
                         "lostbits_forms as lostbits_plugin.h declares it");
    std::size_t count = 0;
    // The call that returns the list belongs to loading: the processor state that it leaves is the one in which the
    // library's users compute.
    const auto [forms, fp_state] = call_of(who, [&] {
        const LoadsForeignCode here(who, loaded.fp_state);
        const lb_form* const list = ask(LOSTBITS_PLUGIN_ABI, &count);
        return std::pair(list, here.left());
    });
    // A library may have only forms that march, which the C interface does not know.
    if (count == 0 && dlsym(loaded.handle, "lostbits_formulas") != nullptr) return {};
    if (forms == nullptr)
        throw InputError(from + ": has no forms for version " + std::to_string(LOSTBITS_PLUGIN_ABI) +
                         " of lostbits_plugin.h; compile it again with the header of this program");
    if (count == 0 || count > 4096)
        throw InputError(from + ": states " + std::to_string(count) + " forms; the number must be from 1 to 4096");
    std::vector<ForeignForm> all;
    for (std::size_t i = 0; i < count; ++i) all.push_back(foreign(forms[i], from, fp_state));
    return all;
}

}  // namespace lostbits::intersect::external
