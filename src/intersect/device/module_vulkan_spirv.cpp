#include "intersect/device/module_vulkan_spirv.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <map>
#include <string_view>
#include <utility>

#include "intersect/device/device.hpp"
#include "number/error.hpp"

extern char** environ;

namespace lostbits::intersect::device {
namespace {

/// A file in memory. It disappears with the process however that ends; a file in a folder would stay if the process
/// were killed.
class MemoryFile {
public:
    explicit MemoryFile(std::string_view text = {}) {
        const int made = memfd_create("lostbits-shader", MFD_CLOEXEC);
        // Above 3 and 4, the numbers under which the compiler inherits its files.
        number = made < 0 ? -1 : fcntl(made, F_DUPFD_CLOEXEC, 16);
        if (made >= 0) close(made);
        while (number >= 0 && !text.empty()) {
            const ssize_t written = write(number, text.data(), text.size());
            if (written <= 0) break;
            text.remove_prefix(static_cast<std::size_t>(written));
        }
        if (number < 0 || !text.empty())
            throw EnvironmentError(std::string("vulkan: cannot make a file in memory: ") + std::strerror(errno));
    }
    ~MemoryFile() { close(number); }
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;

    [[nodiscard]] std::string bytes() const {
        struct stat info {};
        std::string all(fstat(number, &info) == 0 ? static_cast<std::size_t>(info.st_size) : 0, '\0');
        const ssize_t got = pread(number, all.data(), all.size(), 0);
        all.resize(got < 0 ? 0 : static_cast<std::size_t>(got));
        return all;
    }

    int number = -1;
};

/// Runs glslang and returns its status as waitpid gives it; -1 if it is not installed under either of its names.
int run_glslang(const MemoryFile& program, const MemoryFile& spirv, const MemoryFile& log, Language language) {
    constexpr int from = 3, to = 4;
    const std::string in = "/proc/self/fd/" + std::to_string(from), out = "/proc/self/fd/" + std::to_string(to);
    for (const char* name : {"glslangValidator", "glslang"}) {
        std::vector<std::string> words{name, "-V", "-e", entry_of(language), "-S", "comp", "-o", out, in};
        if (language == Language::hlsl) words.insert(words.begin() + 1, "-D");
        std::vector<char*> arguments;
        for (std::string& word : words) arguments.push_back(word.data());
        arguments.push_back(nullptr);
        posix_spawn_file_actions_t files;
        posix_spawn_file_actions_init(&files);
        for (const auto& [own, theirs] : {std::pair(program.number, from),
                                          {spirv.number, to},
                                          {log.number, STDOUT_FILENO},
                                          {log.number, STDERR_FILENO}})
            posix_spawn_file_actions_adddup2(&files, own, theirs);
        pid_t process = 0;
        const int error = posix_spawnp(&process, name, &files, nullptr, arguments.data(), environ);
        posix_spawn_file_actions_destroy(&files);
        if (error != 0) continue;
        int status = 0;
        while (waitpid(process, &status, 0) < 0 && errno == EINTR) {}
        return status;
    }
    return -1;
}

/// Throws CompileError if the code has a constant buffer, a texture or a variable that only a host program could set:
/// it has no memory here. The names of our own buffers begin with lb_.
void refuse_foreign_resources(const std::vector<std::uint32_t>& code) {
    constexpr std::uint32_t op_name = 5, op_variable = 59, uniform_constant = 0, uniform = 2;
    std::map<std::uint32_t, std::string> names;
    for (std::size_t at = 5; at < code.size() && code[at] >> 16U != 0; at += code[at] >> 16U) {  // header: 5 words
        const std::uint32_t op = code[at] & 0xffffU, words = code[at] >> 16U;
        if (at + words > code.size()) return;
        if (op == op_name && words > 2)
            names[code[at + 1]] = std::string(reinterpret_cast<const char*>(&code[at + 2]),
                                              strnlen(reinterpret_cast<const char*>(&code[at + 2]), 4 * (words - 2)));
        if (op != op_variable || words < 4 || (code[at + 3] != uniform_constant && code[at + 3] != uniform)) continue;
        if (const std::string& name = names[code[at + 2]]; !name.starts_with("lb_"))
            throw CompileError((name.empty() ? "a variable outside of functions" : name) +
                               " is read, but nothing sets it here; declare it `static const` with its value");
    }
}

}  // namespace

std::vector<std::uint32_t> spirv_of(const std::string& text, Language language) {
    const MemoryFile program(text), spirv, log;
    const int status = run_glslang(program, spirv, log, language);
    if (status == -1)
        throw EnvironmentError(
            "vulkan: glslangValidator is missing, which compiles shaders to SPIR-V; install it (Debian: "
            "glslang-tools)");
    if (status != 0) throw CompileError(log.bytes());
    const std::string bytes = spirv.bytes();
    std::vector<std::uint32_t> code(bytes.size() / sizeof(std::uint32_t));
    std::memcpy(code.data(), bytes.data(), code.size() * sizeof(std::uint32_t));
    if (language == Language::hlsl) refuse_foreign_resources(code);
    return code;
}

}  // namespace lostbits::intersect::device
