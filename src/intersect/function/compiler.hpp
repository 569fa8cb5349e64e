// The compilers of users' functions: clang and rustc, run without a shell in a folder of their own.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
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
#include "intersect/spirv/llvm_text.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::function {

namespace fs = std::filesystem;

inline constexpr std::array shader_endings{".glsl", ".hlsl", ".spv", ".frag", ".vert", ".comp"};

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

inline bool is_shader(const fs::path& file) {
    const std::string ending = file.extension().string();
    return std::ranges::find(shader_endings, ending) != shader_endings.end();
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

    /// Returns the LLVM IR of a file of LLVM IR or of a shader, and the text that its places name. llvm-dis reads
    /// bitcode.
    struct FileText {
        std::string ir, source;
    };
    FileText ir_of_file() {
        if (is_shader(file_)) return ir_of_shader();
        const std::string text = file_.extension() == ".ll" ? text_of(file_) : ir_of_bitcode();
        return {text, text};
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
    std::string ir_of_bitcode() {
        require_in_path("llvm-dis", "the Debian package llvm");
        const fs::path made = folder_.path / "function.ll";
        run({"llvm-dis"}, file_, made);
        return text_of(made);
    }

    FileText ir_of_shader() {
        FileText made;
        spirv::ShaderLines lines;
        require_in_path("spirv-dis", "the Debian package spirv-tools");
        const bool is_binary = file_.extension() == ".spv";
        if (is_binary) run({"spirv-val"}, file_, {});
        const fs::path code = is_binary ? file_ : spirv_of_shader(made.source, lines);
        const fs::path text = folder_.path / "function.spvasm";
        run({"spirv-dis", "--no-color", "--no-header", "--no-indent"}, code, text);
        const std::string assembly = text_of(text);
        if (is_binary) made.source = assembly;
        const fs::path named = file_.parent_path() / spirv::source_name(assembly);
        if (std::error_code none; is_binary && fs::is_regular_file(named, none)) {
            lines.file = named.string();
            made.source = text_of(named);
            std::istringstream in(made.source);
            for (std::string line; std::getline(in, line);) lines.lines.push_back(line);
        }
        made.ir = spirv::llvm_text_of(assembly, file_.string(), lines, has_opaque_pointers());
        return made;
    }

    fs::path spirv_of_shader(std::string& source, spirv::ShaderLines& lines) {
        using device::Language;
        const Language language = file_.extension() == ".hlsl" ? Language::hlsl : Language::glsl;
        source = text_of(file_);
        lines.file = file_.string();
        const std::string program = is_in_path("glslang") ? "glslang" : "glslangValidator";
        require_in_path(program, "the Debian package glslang-tools");
        process::ProgramArguments words{
            program, "-V", "-g", "-Od", "--keep-uncalled", "-e", device::entry_of(language), "-S", "comp"};
        // Textures and uniforms of the file may have no places, since nothing is bound to them here.
        words.insert(words.end(), {"--auto-map-bindings", "--auto-map-locations"});
        if (language == Language::hlsl) words.emplace_back("-D");
        const fs::path own = folder_.path / file_.filename(), made = folder_.path / "function.spv";
        try {
            write_text(own, spirv::split_program(source, language, lines));
            run(words, own, made);
        } catch (const InputError&) {
            write_text(own, spirv::whole_program(source, language));
            run(words, own, made);  // its messages have the lines of the user's file
            throw;
        }
        return made;
    }

    /// True if clang writes pointers without their targets.
    bool has_opaque_pointers() {
        const fs::path source = folder_.path / "pointer.c", made = folder_.path / "pointer.ll";
        write_text(source, "void f(float* p) { *p = 0; }\n");
        run({program_, "-S", "-emit-llvm"}, source, made);
        return text_of(made).find("ptr ") != std::string::npos;
    }

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
        if (!made.empty()) words.insert(words.end(), {"-o", made.string()});
        words.push_back(source.string());
        words.insert(words.end(), last.begin(), last.end());
        const std::string who = file_.string() + ": " + words[0];
        process::Child child(words, {.who = who, .timeout_advice = "", .seconds = terms_.seconds, .stop = terms_.stop});
        const process::Child::Ended ended = child.read_to_end();
        if (ended.status == 0 && (made.empty() || fs::exists(made))) return;
        std::string said = ended.output.substr(0, 3000);
        for (std::size_t at = 0; (at = said.find(folder_.path.string() + "/", at)) != std::string::npos;)
            said.erase(at, folder_.path.string().size() + 1);
        if (WIFSIGNALED(ended.status)) said += "\nit crashed (signal " + std::to_string(WTERMSIG(ended.status)) + ")";
        throw InputError(who + " does not compile it:\n" + said +
                         (language_ == SourceLanguage::llvm && !is_shader(file_)
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
