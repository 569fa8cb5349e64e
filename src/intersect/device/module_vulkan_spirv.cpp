#include "intersect/device/module_vulkan_spirv.hpp"

#include <sys/wait.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "intersect/device/device.hpp"

namespace lostbits::intersect::device {
namespace {

namespace fs = std::filesystem;

/// A folder that goes away again.
class ScratchFolder {
public:
    ScratchFolder() : path_((fs::temp_directory_path() / "lostbits-shader-XXXXXX").string()) {
        if (mkdtemp(path_.data()) == nullptr) throw EnvironmentError("vulkan: cannot make a folder in TMPDIR");
    }
    ~ScratchFolder() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;
    [[nodiscard]] fs::path operator/(const char* name) const { return fs::path(path_) / name; }
    [[nodiscard]] const std::string& path() const { return path_; }

private:
    std::string path_;
};

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

}  // namespace

std::vector<std::uint32_t> spirv_of(const std::string& glsl) {
    const ScratchFolder folder;
    std::ofstream(folder / "program.comp") << glsl;
    const std::string command = "cd " + quoted(folder.path()) +
                                " && { command -v glslangValidator || command -v glslang || exit 127; } >/dev/null && "
                                "$(command -v glslangValidator || command -v glslang) -V -S comp -o program.spv "
                                "program.comp >log 2>&1";
    const int status = std::system(command.c_str());
    if (WIFEXITED(status) && WEXITSTATUS(status) == 127)
        throw EnvironmentError("vulkan: glslangValidator is missing (Debian: glslang-tools); it makes SPIR-V of GLSL");
    if (status != 0) throw CompileError(whole_file(folder / "log"));
    const std::string bytes = whole_file(folder / "program.spv");
    std::vector<std::uint32_t> code(bytes.size() / sizeof(std::uint32_t));
    std::memcpy(code.data(), bytes.data(), code.size() * sizeof(std::uint32_t));
    return code;
}

}  // namespace lostbits::intersect::device
