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
#include <optional>
#include <string_view>
#include <utility>

#include "intersect/device/device.hpp"
#include "number/error.hpp"

extern char** environ;

namespace lostbits::intersect::device {
namespace {

/// A file in memory. It disappears with the process, however the process ends; a file in a folder would stay if the
/// process were killed.
class MemoryFile {
public:
    explicit MemoryFile(std::string_view text = {}) {
        const int low_descriptor = memfd_create("lostbits-shader", MFD_CLOEXEC);
        // Duplicates the descriptor above 3 and 4, the descriptors by which the compiler inherits its files.
        descriptor = low_descriptor < 0 ? -1 : fcntl(low_descriptor, F_DUPFD_CLOEXEC, 16);
        if (low_descriptor >= 0) close(low_descriptor);
        while (descriptor >= 0 && !text.empty()) {
            const ssize_t written = write(descriptor, text.data(), text.size());
            if (written <= 0) break;
            text.remove_prefix(static_cast<std::size_t>(written));
        }
        if (descriptor < 0 || !text.empty())
            throw EnvironmentError(std::string("vulkan: cannot make a file in memory: ") + std::strerror(errno));
    }
    ~MemoryFile() { close(descriptor); }
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;

    [[nodiscard]] std::string bytes() const {
        struct stat info {};
        std::string content(fstat(descriptor, &info) == 0 ? static_cast<std::size_t>(info.st_size) : 0, '\0');
        const ssize_t received = pread(descriptor, content.data(), content.size(), 0);
        content.resize(received < 0 ? 0 : static_cast<std::size_t>(received));
        return content;
    }

    int descriptor = -1;
};

/// Starts glslang under one of its names. Returns no process if it is not installed under this name.
std::optional<pid_t> start_glslang(const char* name, const MemoryFile& program, const MemoryFile& spirv,
                                   const MemoryFile& log, Language language) {
    constexpr int input_descriptor = 3, output_descriptor = 4;
    const std::string input_path = "/proc/self/fd/" + std::to_string(input_descriptor),
                      output_path = "/proc/self/fd/" + std::to_string(output_descriptor);
    std::vector<std::string> arguments{name,   "-V", "-e",        entry_of(language), "-S",
                                       "comp", "-o", output_path, input_path};
    if (language == Language::hlsl) arguments.insert(arguments.begin() + 1, "-D");
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);

    // The compiler reads and writes files in memory, which it inherits.
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    for (const auto& [source, target] : {std::pair(program.descriptor, input_descriptor),
                                         {spirv.descriptor, output_descriptor},
                                         {log.descriptor, STDOUT_FILENO},
                                         {log.descriptor, STDERR_FILENO}})
        posix_spawn_file_actions_adddup2(&files, source, target);

    pid_t process = 0;
    const int error = posix_spawnp(&process, name, &files, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&files);
    return error == 0 ? std::optional(process) : std::nullopt;
}

/// Runs glslang and returns its status as waitpid gives it; -1 if glslang is not installed under either of its names.
int run_glslang(const MemoryFile& program, const MemoryFile& spirv, const MemoryFile& log, Language language) {
    for (const char* name : {"glslangValidator", "glslang"}) {
        const std::optional<pid_t> process = start_glslang(name, program, spirv, log, language);
        if (!process) continue;
        int status = 0;
        while (waitpid(*process, &status, 0) < 0 && errno == EINTR) {}
        return status;
    }
    return -1;
}

/// Throws CompileError if the code has a constant buffer, a texture or a variable that only a host program could set:
/// there is no memory for it here. The names of our own buffers begin with lb_.
void require_no_foreign_resources(const std::vector<std::uint32_t>& code) {
    constexpr std::uint32_t op_name = 5, op_variable = 59, uniform_constant = 0, uniform = 2;
    std::map<std::uint32_t, std::string> names;
    constexpr std::size_t header_word_count = 5;
    for (std::size_t position = header_word_count; position < code.size() && code[position] >> 16U != 0;
         position += code[position] >> 16U) {
        const std::uint32_t op = code[position] & 0xffffU, word_count = code[position] >> 16U;
        if (position + word_count > code.size()) return;
        if (op == op_name && word_count > 2)
            names[code[position + 1]] =
                std::string(reinterpret_cast<const char*>(&code[position + 2]),
                            strnlen(reinterpret_cast<const char*>(&code[position + 2]), 4 * (word_count - 2)));

        if (op != op_variable || word_count < 4 ||
            (code[position + 3] != uniform_constant && code[position + 3] != uniform))
            continue;
        if (const std::string& name = names[code[position + 2]]; !name.starts_with("lb_"))
            throw CompileError((name.empty() ? "a variable outside of functions" : name) +
                               " is read, but no host program sets it when lostbits runs the shader; declare it "
                               "`static const` with its value");
    }
}

}  // namespace

std::vector<std::uint32_t> compile_to_spirv(const std::string& text, Language language) {
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
    if (language == Language::hlsl) require_no_foreign_resources(code);
    return code;
}

}  // namespace lostbits::intersect::device
