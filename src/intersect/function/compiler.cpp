#include "intersect/function/compiler.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "intersect/spirv/llvm_text.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::function {
namespace {

void write_text(const fs::path& path, const std::string& text) {
    std::ofstream out(path, std::ios::binary);
    out << text;
    if (!out.flush()) throw EnvironmentError(path.string() + ": cannot be written; set TMPDIR to a folder with space");
}

bool is_in_path(const std::string& program) {
    const char* const path = std::getenv("PATH");
    std::istringstream folders(path == nullptr ? "/usr/bin:/bin" : path);
    for (std::string folder; std::getline(folders, folder, ':');)
        if (access((fs::path(folder) / program).c_str(), X_OK) == 0) return true;
    return false;
}

/// Messages of a compiler, without the names of our folder, and without what glslang adds when a file has errors.
std::string without_our_words(const std::string& said, const std::string& folder) {
    std::string text;
    std::istringstream lines(said.substr(0, 3000));
    for (std::string line; std::getline(lines, line);) {
        for (std::size_t at = 0; (at = line.find(folder + "/", at)) != std::string::npos;)
            line.erase(at, folder.size() + 1);
        const auto says = [&line](const char* words) { return line.find(words) != std::string::npos; };
        if (line.find_first_not_of(' ') != std::string::npos && !says("Missing entry point") &&
            !says("compilation errors.  No code generated") &&
            !says("SPIR-V is not generated for failed compile or link"))
            text += (text.empty() ? "" : "\n") + line;
    }
    return text;
}

}  // namespace

std::string text_of(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    if (!in || fs::is_directory(path)) throw InputError(path.string() + ": cannot be read");
    if (text.str().size() > 50'000'000) throw InputError(path.string() + ": is longer than 50 MB");
    return text.str();
}

bool is_shader(const fs::path& file) {
    constexpr std::array endings{".glsl", ".hlsl", ".spv", ".frag", ".vert", ".comp"};
    return std::ranges::find(endings, file.extension().string()) != endings.end();
}

Compiler::Compiler(const fs::path& file, SourceLanguage language, const CompileTerms& terms)
    : file_(fs::absolute(file).lexically_normal()), language_(language), terms_(terms), folder_("lostbits-function") {
    if (terms_.headers.empty()) terms_.headers = file_.parent_path();
    program_ = language == SourceLanguage::cpp ? "clang++" : language == SourceLanguage::rust ? "rustc" : "clang";
    require_in_path(program_, language == SourceLanguage::rust ? "rustup, or the Debian package rustc"
                                                               : "the Debian package clang");
}

auto Compiler::ir_of_file() -> FileText {
    if (is_shader(file_)) return ir_of_shader();
    const std::string text = file_.extension() == ".ll" ? text_of(file_) : ir_of_bitcode();
    return {text, text};
}

std::string Compiler::ir(const std::string& text, bool optimised) {
    const fs::path source = write(text), made = folder_.path / "function.ll";
    process::ProgramArguments words = language_ == SourceLanguage::rust ? rust_arguments("lib") : c_arguments();
    if (language_ == SourceLanguage::rust)
        words.insert(words.end(), {"--emit=llvm-ir", "-Cdebuginfo=2", optimised ? "-Copt-level=1" : "-Copt-level=0",
                                   "-Cno-vectorize-loops", "-Cno-vectorize-slp"});
    else words.insert(words.end(), {"-O0", "-g", "-fno-discard-value-names", "-S", "-emit-llvm"});
    run(std::move(words), source, made);
    return text_of(made);
}

external::Library Compiler::library(const std::string& text, bool is_long) {
    const fs::path source = write(text), made = folder_.path / "function.so";
    if (language_ == SourceLanguage::rust) {
        process::ProgramArguments words = rust_arguments("cdylib");
        words.emplace_back(is_long ? "-Copt-level=0" : "-Copt-level=3");
        run(std::move(words), source, made);
    } else {
        process::ProgramArguments words = c_arguments();
        words.insert(words.end(), {is_long ? "-O0" : "-O2", "-shared", "-fPIC"});
        if (language_ == SourceLanguage::llvm) words.emplace_back("-xir");
        run(std::move(words), source, made, {"-xnone", "-lm"});
    }
    return external::load_library(made);
}

std::string Compiler::ir_of_bitcode() {
    require_in_path("llvm-dis", "the Debian package llvm");
    const fs::path made = folder_.path / "function.ll";
    run({"llvm-dis"}, file_, made);
    return text_of(made);
}

auto Compiler::ir_of_shader() -> FileText {
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

fs::path Compiler::spirv_of_shader(std::string& source, spirv::ShaderLines& lines) {
    using device::Language;
    const Language language = file_.extension() == ".hlsl" ? Language::hlsl : Language::glsl;
    source = text_of(file_);
    lines.file = file_.string();
    const std::string program = is_in_path("glslang") ? "glslang" : "glslangValidator";
    require_in_path(program, "the Debian package glslang-tools");
    process::ProgramArguments words{program, "-V",  "-g", "-Od", "--keep-uncalled", "-e", device::entry_of(language),
                                    "-S",    "comp"};
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
bool Compiler::has_opaque_pointers() {
    const fs::path source = folder_.path / "pointer.c", made = folder_.path / "pointer.ll";
    write_text(source, "void f(float* p) { *p = 0; }\n");
    run({program_, "-S", "-emit-llvm"}, source, made);
    return text_of(made).find("ptr ") != std::string::npos;
}

fs::path Compiler::write(const std::string& text) {
    const std::string ending = language_ == SourceLanguage::c      ? ".c"
                               : language_ == SourceLanguage::llvm ? ".ll"
                                                                   : ".cpp";
    fs::path source =
        folder_.path / (language_ == SourceLanguage::rust ? file_.filename().string() : "lostbits_entry" + ending);
    write_text(source, text);
    return source;
}

process::ProgramArguments Compiler::c_arguments() const {
    process::ProgramArguments words{program_, "-w", "-ffp-contract=off"};
    if (language_ == SourceLanguage::llvm) return words;
    words.insert(words.end(),
                 {"-fno-fast-math", "-fno-math-errno", "-fno-strict-aliasing", "-I" + terms_.headers.string()});
    if (language_ == SourceLanguage::cpp) words.insert(words.end(), {"-std=gnu++20", "-xc++"});
    return words;
}

/// `kind` is the type of the crate: lib or cdylib.
process::ProgramArguments Compiler::rust_arguments(const std::string& kind) const {
    return {program_,
            "--edition=2021",
            "-Awarnings",
            "-Cpanic=abort",
            "-Ccodegen-units=1",
            "--crate-name=lostbits_function",
            "--crate-type=" + kind,
            "--remap-path-prefix=" + folder_.path.string() + "=" + file_.parent_path().string()};
}

void Compiler::run(process::ProgramArguments words, const fs::path& source, const fs::path& made,
                   const process::ProgramArguments& last) {
    if (!made.empty()) words.insert(words.end(), {"-o", made.string()});
    words.push_back(source.string());
    words.insert(words.end(), last.begin(), last.end());
    const std::string who = file_.string() + ": " + words[0];
    process::Child child(words, {.who = who, .timeout_advice = "", .seconds = terms_.seconds, .stop = terms_.stop});
    const process::Child::Ended ended = child.read_to_end();
    if (ended.status == 0 && (made.empty() || fs::exists(made))) return;
    std::string said = without_our_words(ended.output, folder_.path.string());
    if (WIFSIGNALED(ended.status)) said += "\nit crashed (signal " + std::to_string(WTERMSIG(ended.status)) + ")";
    throw InputError(who + " does not compile it:\n" + said +
                     (language_ == SourceLanguage::llvm && !is_shader(file_)
                          ? "\nLLVM IR can be read by the same major version of LLVM or a newer one; put its " +
                                words[0] + " first in PATH"
                          : ""));
}

void Compiler::require_in_path(const std::string& program, const std::string& package) const {
    if (!is_in_path(program))
        throw EnvironmentError(file_.string() + ": this file needs " + program + ", which is not in PATH; install " +
                               package);
}

}  // namespace lostbits::intersect::function
