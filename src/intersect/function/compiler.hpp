// Compiles users' functions with clang and rustc, which run without a shell in a temporary folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "intersect/device/temporary_folder.hpp"
#include "intersect/external/plugin.hpp"
#include "intersect/function/function.hpp"
#include "intersect/function/signature.hpp"
#include "intersect/process/child.hpp"
#include "intersect/spirv/shader_lines.hpp"

namespace lostbits::intersect::function {

namespace fs = std::filesystem;

/// Reads the text of a user's file. Throws InputError if the file cannot be read or is longer than 50 MB.
std::string read_file(const fs::path& path);
/// True for a file of GLSL, HLSL or SPIR-V.
bool is_shader(const fs::path& file);

/// Compiles the user's file in a temporary folder.
class Compiler {
public:
    Compiler(const fs::path& file, SourceLanguage language, const CompileSettings& settings);

    /// LLVM IR of a file, and the source text that the line numbers in the IR refer to.
    struct FileText {
        std::string ir, source;
    };
    /// Returns the LLVM IR of a file that holds LLVM IR, bitcode (read by llvm-dis) or a shader.
    FileText read_ir_or_compile();
    enum class Optimisation : std::uint8_t { off, on };
    /// Compiles the user's file with `text` appended, and returns the LLVM IR. Only rustc optimises it.
    std::string compile_to_ir(const std::string& text, Optimisation optimisation);
    /// Compiles the user's file with `text` appended into a library. Long functions are compiled without optimisation,
    /// since the time of an optimising compiler grows with the square of a function's length. The answers have the same
    /// bits.
    external::Library compile_library(const std::string& text, Optimisation optimisation);
    [[nodiscard]] const fs::path& file() const { return file_; }

private:
    std::string disassemble_bitcode();
    FileText compile_shader_to_ir();
    fs::path compile_shader_to_spirv(std::string& source, spirv::ShaderLines& lines);
    bool has_opaque_pointers();
    fs::path write_source(const std::string& text);
    [[nodiscard]] process::ProgramArguments make_clang_arguments() const;
    [[nodiscard]] process::ProgramArguments make_rust_arguments(const std::string& kind) const;
    void run(process::ProgramArguments arguments, const fs::path& source, const fs::path& output,
             const process::ProgramArguments& trailing_arguments = {});
    void require_in_path(const std::string& program, const std::string& package) const;

    fs::path file_;
    SourceLanguage language_;
    CompileSettings settings_;
    std::string compiler_;  ///< name of the program
    device::TemporaryFolder temporary_folder_;
};

}  // namespace lostbits::intersect::function
