#include "intersect/device/module_vulkan_spirv.hpp"

#include <sys/wait.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "intersect/device/device.hpp"
#include "intersect/device/temporary_folder.hpp"

namespace lostbits::intersect::device {
namespace {

namespace fs = std::filesystem;

std::string whole_file(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

/// A word for the shell.
std::string quoted(const std::string& word) {
    std::string text = "'";
    for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return text + "'";
}

/// A constant buffer, a texture or a variable that only a host could set: it has no memory here. Ours begin with lb_.
void refuse_foreign_resources(const std::vector<std::uint32_t>& code) {
    constexpr std::uint32_t op_name = 5, op_variable = 59, uniform_constant = 0, uniform = 2;
    std::map<std::uint32_t, std::string> names;
    for (std::size_t at = 5; at < code.size() && code[at] >> 16U != 0; at += code[at] >> 16U) {  // behind 5 of header
        const std::uint32_t op = code[at] & 0xffffU, words = code[at] >> 16U;
        if (at + words > code.size()) return;
        if (op == op_name && words > 2)
            names[code[at + 1]] = std::string(reinterpret_cast<const char*>(&code[at + 2]),
                                              strnlen(reinterpret_cast<const char*>(&code[at + 2]), 4 * (words - 2)));
        if (op != op_variable || words < 4 || (code[at + 3] != uniform_constant && code[at + 3] != uniform)) continue;
        if (const std::string& name = names[code[at + 2]]; !name.starts_with("lb_"))
            throw CompileError((name.empty() ? "a variable outside of functions" : name) +
                               " is read, which nobody sets here: write `static const` and its value");
    }
}

}  // namespace

std::vector<std::uint32_t> spirv_of(const std::string& text, Language language) {
    const TemporaryFolder folder("lostbits-shader");
    std::ofstream(folder.path / "program.comp") << text;
    const std::string command = "cd " + quoted(folder.path.string()) +
                                " && { command -v glslangValidator || command -v glslang || exit 127; } >/dev/null && "
                                "$(command -v glslangValidator || command -v glslang) -V " +
                                (language == Language::hlsl ? "-D " : "") + "-e " + entry_of(language) +
                                " -S comp -o program.spv program.comp >log 2>&1";
    const int status = std::system(command.c_str());
    if (WIFEXITED(status) && WEXITSTATUS(status) == 127)
        throw EnvironmentError(
            "vulkan: glslangValidator is missing (Debian: glslang-tools); it makes SPIR-V of shaders");
    if (status != 0) throw CompileError(whole_file(folder.path / "log"));
    const std::string bytes = whole_file(folder.path / "program.spv");
    std::vector<std::uint32_t> code(bytes.size() / sizeof(std::uint32_t));
    std::memcpy(code.data(), bytes.data(), code.size() * sizeof(std::uint32_t));
    if (language == Language::hlsl) refuse_foreign_resources(code);
    return code;
}

}  // namespace lostbits::intersect::device
