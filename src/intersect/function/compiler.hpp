// The compilers of users' functions: clang and rustc, run without a shell in a folder of their own.
#pragma once

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "intersect/device/temporary_folder.hpp"
#include "intersect/external/plugin.hpp"
#include "intersect/function/function.hpp"
#include "intersect/function/signature.hpp"
#include "intersect/process/child.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::function {

namespace fs = std::filesystem;

inline std::string text_of(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    if (!in || fs::is_directory(path)) throw InputError(path.string() + ": cannot be read");
    if (text.str().size() > 50'000'000) throw InputError(path.string() + ": is longer than 50 MB");
    return text.str();
}

inline void write_text(const fs::path& path, const std::string& text) {
    std::ofstream out(path, std::ios::binary);
    out << text;
    if (!out.flush()) throw EnvironmentError(path.string() + ": cannot be written; set TMPDIR to a folder with space");
}

inline bool is_in_path(const std::string& program) {
    const char* const path = std::getenv("PATH");
    std::istringstream folders(path == nullptr ? "/usr/bin:/bin" : path);
    for (std::string folder; std::getline(folders, folder, ':');)
        if (access((fs::path(folder) / program).c_str(), X_OK) == 0) return true;
    return false;
}

/// Compiles the user's file in a folder of its own.
class Compiler {
public:
    Compiler(const fs::path& file, SourceLanguage language, const CompileTerms& terms)
        : file_(fs::absolute(file).lexically_normal()),
          language_(language),
          terms_(terms),
          folder_("lostbits-function") {
        program_ = language == SourceLanguage::cpp ? "clang++" : language == SourceLanguage::rust ? "rustc" : "clang";
        require_in_path(program_, language == SourceLanguage::rust ? "rustup, or the Debian package rustc"
                                                                   : "the Debian package clang");
    }

    /// Returns the text of a file of LLVM IR. llvm-dis reads bitcode.
    std::string ir_of_file() {
        if (file_.extension() == ".ll") return text_of(file_);
        require_in_path("llvm-dis", "the Debian package llvm");
        const fs::path made = folder_.path / "function.ll";
        run({"llvm-dis"}, file_, made);
        return text_of(made);
    }

    /// Compiles a file that ends in `text`, and returns its LLVM IR.
    std::string ir(const std::string& text, bool optimised) {
        const fs::path source = write(text), made = folder_.path / "function.ll";
        process::ProgramArguments words{program_};
        if (language_ == SourceLanguage::rust) {
            add_rust(words);
            words.insert(words.end(), {"--emit=llvm-ir", "-Cdebuginfo=2", optimised ? "-Copt-level=1" : "-Copt-level=0",
                                       "-Cno-vectorize-loops", "-Cno-vectorize-slp"});
        } else {
            add_c(words);
            words.insert(words.end(), {"-O0", "-g", "-fno-discard-value-names", "-S", "-emit-llvm"});
        }
        run(words, source, made);
        return text_of(made);
    }

    external::Library library(const std::string& text) {
        const fs::path source = write(text), made = folder_.path / "function.so";
        process::ProgramArguments words{program_};
        if (language_ == SourceLanguage::rust) {
            add_rust(words);
            words.insert(words.end(), {"--crate-type=cdylib", "-Copt-level=3"});
        } else if (language_ == SourceLanguage::llvm) {
            words.insert(words.end(), {"-O2", "-shared", "-fPIC", "-ffp-contract=off", "-w", "-xir"});
        } else {
            add_c(words);
            words.insert(words.end(), {"-O2", "-shared", "-fPIC"});
        }
        if (language_ == SourceLanguage::rust) run(words, source, made);
        else run(words, source, made, {"-xnone", "-lm"});
        return external::load_library(made);
    }

    [[nodiscard]] const fs::path& file() const { return file_; }
    [[nodiscard]] const fs::path& folder() const { return folder_.path; }

private:
    fs::path write(const std::string& text) {
        const std::string ending = language_ == SourceLanguage::c      ? ".c"
                                   : language_ == SourceLanguage::llvm ? ".ll"
                                                                       : ".cpp";
        fs::path source =
            folder_.path / (language_ == SourceLanguage::rust ? file_.filename().string() : "lostbits_entry" + ending);
        write_text(source, text);
        return source;
    }
    void add_c(process::ProgramArguments& words) const {
        words.insert(words.end(), {"-ffp-contract=off", "-fno-fast-math", "-fno-math-errno", "-fno-strict-aliasing",
                                   "-w", "-I" + file_.parent_path().string()});
        if (language_ == SourceLanguage::cpp) words.insert(words.end(), {"-std=gnu++20", "-xc++"});
    }
    void add_rust(process::ProgramArguments& words) const {
        words.insert(
            words.end(),
            {"--edition=2021", "-Awarnings", "-Cpanic=abort", "-Ccodegen-units=1", "--crate-name=lostbits_function",
             "--remap-path-prefix=" + folder_.path.string() + "=" + file_.parent_path().string()});
        if (std::ranges::find(words, "--crate-type=cdylib") == words.end()) words.push_back("--crate-type=lib");
    }
    void run(process::ProgramArguments words, const fs::path& source, const fs::path& made,
             const process::ProgramArguments& last = {}) {
        if (std::ranges::find(words, "--crate-type=cdylib") != words.end()) std::erase(words, "--crate-type=lib");
        words.insert(words.end(), {"-o", made.string(), source.string()});
        words.insert(words.end(), last.begin(), last.end());
        const std::string who = file_.string() + ": " + words[0];
        process::Child child(words, {.who = who, .duty = "", .seconds = terms_.seconds, .stop = terms_.stop});
        const process::Child::Ended ended = child.read_to_end();
        if (ended.status == 0 && fs::exists(made)) return;
        std::string said = ended.output.substr(0, 3000);
        for (std::size_t at = 0; (at = said.find(folder_.path.string() + "/", at)) != std::string::npos;)
            said.erase(at, folder_.path.string().size() + 1);
        throw InputError(who + " does not compile it:\n" + said +
                         (language_ == SourceLanguage::llvm
                              ? "\nLLVM IR can be read by the same major version of LLVM or a newer one; put its " +
                                    words[0] + " first in PATH"
                              : ""));
    }
    void require_in_path(const std::string& program, const std::string& package) const {
        if (!is_in_path(program))
            throw EnvironmentError(file_.string() + ": " + program +
                                   " is not in PATH, and reads such files; install "
                                   "it (" +
                                   package + ")");
    }

    fs::path file_;
    SourceLanguage language_;
    CompileTerms terms_;
    std::string program_;
    device::TemporaryFolder folder_;
};

}  // namespace lostbits::intersect::function
