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

/// Returns the messages of a compiler without the name of our temporary folder, and without the lines that glslang adds
/// when a file has errors.
std::string clean_messages(const std::string& messages, const std::string& folder) {
    std::string text;
    std::istringstream lines(messages.substr(0, 3000));
    for (std::string line; std::getline(lines, line);) {
        for (std::size_t position = 0; (position = line.find(folder + "/", position)) != std::string::npos;)
            line.erase(position, folder.size() + 1);
        const auto contains = [&line](const char* part) { return line.find(part) != std::string::npos; };
        if (line.find_first_not_of(' ') != std::string::npos && !contains("Missing entry point") &&
            !line.starts_with("In file included from lostbits_entry") &&
            !contains("compilation errors.  No code generated") &&
            !contains("SPIR-V is not generated for failed compile or link"))
            text += (text.empty() ? "" : "\n") + line;
    }
    return text;
}

}  // namespace

std::string read_file(const fs::path& path) {
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

Compiler::Compiler(const fs::path& file, SourceLanguage language, const CompileSettings& settings)
    : file_(fs::absolute(file).lexically_normal()),
      language_(language),
      settings_(settings),
      temporary_folder_("lostbits-function") {
    if (settings_.headers.empty()) settings_.headers = file_.parent_path();
    compiler_ = language == SourceLanguage::cpp ? "clang++" : language == SourceLanguage::rust ? "rustc" : "clang";
    require_in_path(compiler_, language == SourceLanguage::rust ? "rustup, or the Debian package rustc"
                                                                : "the Debian package clang");
}

auto Compiler::read_ir_or_compile() -> FileText {
    if (is_shader(file_)) return compile_shader_to_ir();
    const std::string text = file_.extension() == ".ll" ? read_file(file_) : disassemble_bitcode();
    return {text, text};
}

std::string Compiler::compile_to_ir(const std::string& text, Optimisation optimisation) {
    const fs::path source = write_source(text), output = temporary_folder_.path / "function.ll";
    process::ProgramArguments arguments =
        language_ == SourceLanguage::rust ? make_rust_arguments("lib") : make_clang_arguments();
    if (language_ == SourceLanguage::rust)
        arguments.insert(arguments.end(), {"--emit=llvm-ir", "-Cdebuginfo=2",
                                           optimisation == Optimisation::on ? "-Copt-level=1" : "-Copt-level=0",
                                           "-Cno-vectorize-loops", "-Cno-vectorize-slp"});
    else arguments.insert(arguments.end(), {"-O0", "-g", "-fno-discard-value-names", "-S", "-emit-llvm"});
    run(std::move(arguments), source, output);
    return read_file(output);
}

external::Library Compiler::compile_library(const std::string& text, Optimisation optimisation) {
    const fs::path source = write_source(text), output = temporary_folder_.path / "function.so";
    if (language_ == SourceLanguage::rust) {
        process::ProgramArguments arguments = make_rust_arguments("cdylib");
        arguments.emplace_back(optimisation == Optimisation::off ? "-Copt-level=0" : "-Copt-level=3");
        run(std::move(arguments), source, output);
    } else {
        process::ProgramArguments arguments = make_clang_arguments();
        arguments.insert(arguments.end(), {optimisation == Optimisation::off ? "-O0" : "-O2", "-shared", "-fPIC"});
        if (language_ == SourceLanguage::llvm) arguments.emplace_back("-xir");
        run(std::move(arguments), source, output, {"-xnone", "-lm"});
    }
    return external::load_library(output);
}

std::string Compiler::disassemble_bitcode() {
    require_in_path("llvm-dis", "the Debian package llvm");
    const fs::path output = temporary_folder_.path / "function.ll";
    run({"llvm-dis"}, file_, output);
    return read_file(output);
}

auto Compiler::compile_shader_to_ir() -> FileText {
    FileText result;
    spirv::ShaderLines lines;
    require_in_path("spirv-dis", "the Debian package spirv-tools");
    const bool is_binary = file_.extension() == ".spv";
    if (is_binary) run({"spirv-val"}, file_, {});

    const fs::path spirv_file = is_binary ? file_ : compile_shader_to_spirv(result.source, lines);
    const fs::path assembly_file = temporary_folder_.path / "function.spvasm";
    run({"spirv-dis", "--no-color", "--no-header", "--no-indent"}, spirv_file, assembly_file);
    const std::string assembly = read_file(assembly_file);
    if (is_binary) result.source = assembly;

    // A binary may name its source file. If that file is beside the binary, positions refer to its lines.
    const fs::path source_file = file_.parent_path() / spirv::source_file_name(assembly);
    if (std::error_code error; is_binary && fs::is_regular_file(source_file, error)) {
        lines.file = source_file.string();
        result.source = read_file(source_file);
        std::istringstream in(result.source);
        for (std::string line; std::getline(in, line);) lines.lines.push_back(line);
    }
    result.ir = spirv::translate_to_llvm(assembly, file_.string(), lines, has_opaque_pointers());
    return result;
}

fs::path Compiler::compile_shader_to_spirv(std::string& source, spirv::ShaderLines& lines) {
    using device::Language;
    const Language language = file_.extension() == ".hlsl" ? Language::hlsl : Language::glsl;
    source = read_file(file_);
    lines.file = file_.string();
    const std::string program = is_in_path("glslang") ? "glslang" : "glslangValidator";
    require_in_path(program, "the Debian package glslang-tools");
    process::ProgramArguments arguments{
        program, "-V", "-g", "-Od", "--keep-uncalled", "-e", device::entry_of(language), "-S", "comp"};
    // Textures and uniforms of the file may have no bindings and locations, since nothing is bound to them here.
    arguments.insert(arguments.end(), {"--auto-map-bindings", "--auto-map-locations"});
    if (language == Language::hlsl) arguments.emplace_back("-D");

    // Compiles the program with a token on each line. If that fails, compiles the program with the user's lines, whose
    // messages name the lines that the user knows.
    const fs::path copied_source = temporary_folder_.path / file_.filename(),
                   output = temporary_folder_.path / "function.spv";
    try {
        write_text(copied_source, spirv::write_program_with_token_lines(source, language, lines));
        run(arguments, copied_source, output);
    } catch (const InputError&) {
        write_text(copied_source, spirv::write_program_with_user_lines(source, language));
        run(arguments, copied_source, output);
        throw;
    }
    return output;
}

/// True if clang writes pointers without the types of their targets.
bool Compiler::has_opaque_pointers() {
    const fs::path source = temporary_folder_.path / "pointer.c", output = temporary_folder_.path / "pointer.ll";
    write_text(source, "void f(float* p) { *p = 0; }\n");
    run({compiler_, "-S", "-emit-llvm"}, source, output);
    return read_file(output).find("ptr ") != std::string::npos;
}

fs::path Compiler::write_source(const std::string& text) {
    const std::string ending = language_ == SourceLanguage::c      ? ".c"
                               : language_ == SourceLanguage::llvm ? ".ll"
                                                                   : ".cpp";
    fs::path source = temporary_folder_.path /
                      (language_ == SourceLanguage::rust ? file_.filename().string() : "lostbits_entry" + ending);
    write_text(source, text);
    return source;
}

process::ProgramArguments Compiler::make_clang_arguments() const {
    process::ProgramArguments arguments{compiler_, "-w", "-ffp-contract=off"};
    if (language_ == SourceLanguage::llvm) return arguments;
    arguments.insert(arguments.end(),
                     {"-fno-fast-math", "-fno-math-errno", "-fno-strict-aliasing", "-I" + settings_.headers.string()});
    if (language_ == SourceLanguage::cpp) arguments.insert(arguments.end(), {"-std=gnu++20", "-xc++"});
    return arguments;
}

/// `kind` is the type of the crate: lib or cdylib.
process::ProgramArguments Compiler::make_rust_arguments(const std::string& kind) const {
    return {compiler_,
            "--edition=2021",
            "-Awarnings",
            "-Cpanic=abort",
            "-Ccodegen-units=1",
            "--crate-name=lostbits_function",
            "--crate-type=" + kind,
            "--remap-path-prefix=" + temporary_folder_.path.string() + "=" + file_.parent_path().string()};
}

void Compiler::run(process::ProgramArguments arguments, const fs::path& source, const fs::path& output,
                   const process::ProgramArguments& trailing_arguments) {
    if (!output.empty()) arguments.insert(arguments.end(), {"-o", output.string()});
    arguments.push_back(source.string());
    arguments.insert(arguments.end(), trailing_arguments.begin(), trailing_arguments.end());
    const std::string subject = file_.string() + ": " + arguments[0];
    process::ChildProcess child(
        arguments, {.who = subject, .timeout_advice = "", .seconds = settings_.seconds, .stop = settings_.stop});
    const process::ChildProcess::ChildEnd result = child.read_to_end();
    if (result.status == 0 && (output.empty() || fs::exists(output))) return;
    std::string messages = clean_messages(result.output, temporary_folder_.path.string());
    if (WIFSIGNALED(result.status))
        messages += "\nthe compiler crashed (signal " + std::to_string(WTERMSIG(result.status)) + ")";
    throw InputError(subject + " cannot compile it:\n" + messages +
                     (language_ == SourceLanguage::llvm && !is_shader(file_)
                          ? "\nLLVM IR can be read by the same major version of LLVM or a newer one; put its " +
                                arguments[0] + " first in PATH"
                          : ""));
}

void Compiler::require_in_path(const std::string& program, const std::string& package) const {
    if (!is_in_path(program))
        throw EnvironmentError(file_.string() + ": this file needs " + program + ", which is not in PATH; install " +
                               package);
}

}  // namespace lostbits::intersect::function
