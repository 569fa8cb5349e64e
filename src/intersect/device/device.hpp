// A driver that runs compute programs, through OpenGL or Vulkan.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "intersect/process/floating_point.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::device {

/// A driver's description of itself.
struct DeviceDescription {
    std::string kind;  ///< one of `device_kinds`
    std::string renderer, vendor, version, driver;
};

struct DeviceLimits {
    std::size_t max_buffer_bytes = 0;  ///< largest size of one buffer
    std::size_t max_groups = 0;        ///< largest number of work groups in one run
    bool has_doubles = false;
    int glsl = 430;  ///< version of GLSL that programs for the device state
};

/// Thrown for a program that the compiler rejects, with the compiler's messages.
struct CompileError : InputError {
    using InputError::InputError;
};

/// Number of elements (rays, for a shader) that one work group of a program answers.
inline constexpr std::size_t group_size = 64;

/// A buffer of a run. Its bytes go to the device before the run, and come back after it if the program writes them.
struct DeviceBuffer {
    std::span<std::byte> bytes;
    bool is_written = false;  ///< true if the program writes the buffer
};

class DeviceProgram {
public:
    DeviceProgram() = default;
    DeviceProgram(const DeviceProgram&) = delete;
    DeviceProgram& operator=(const DeviceProgram&) = delete;
    virtual ~DeviceProgram() = default;
};

enum class Language { glsl, hlsl };

/// Entry point of a program: GLSL has no other name for it, and files of HLSL often have a `main` of their own.
constexpr const char* entry_of(Language language) { return language == Language::glsl ? "main" : "lb_main"; }

class Device {
public:
    Device() = default;
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;
    virtual ~Device() = default;

    [[nodiscard]] virtual const DeviceDescription& description() const = 0;
    [[nodiscard]] virtual const DeviceLimits& limits() const = 0;
    /// Compiles a compute program. Throws CompileError if the compiler rejects the program, and EnvironmentError if the
    /// compiler itself fails or does not know the language.
    [[nodiscard]] std::unique_ptr<DeviceProgram> compile(const std::string& text, Language language) {
        const process::FloatingPointGuard guard;
        return compile_program(text, language);
    }
    /// Runs this many work groups. Buffer k has binding k, and no buffer is empty. Throws EnvironmentError for a
    /// lost device.
    void run(DeviceProgram& program, std::span<const DeviceBuffer> buffers, std::size_t group_count) {
        const process::FloatingPointGuard guard;
        run_program(program, buffers, group_count);
    }

protected:
    [[nodiscard]] virtual std::unique_ptr<DeviceProgram> compile_program(const std::string& text,
                                                                         Language language) = 0;
    virtual void run_program(DeviceProgram& program, std::span<const DeviceBuffer> buffers,
                             std::size_t group_count) = 0;
};

/// The kinds of driver interfaces, the default first.
inline constexpr std::string_view device_kinds[] = {"opengl", "vulkan"};

/// Version of a driver module: it exports `lostbits_device_build`, which must equal `device_build`, and
/// `lostbits_open_device`.
inline constexpr int device_build = 3;
using OpenDevice = Device* (*)();

/// Loads the module of that kind and opens its first device that can run compute programs. Call it in a separate
/// process, since a driver brings a compiler, threads and signal handlers. Throws EnvironmentError that says what is
/// missing.
std::unique_ptr<Device> open_device(std::string_view kind);
/// Opens a device of the first kind that can be opened. Throws EnvironmentError that lists what each kind lacks.
std::unique_ptr<Device> open_any_device();

}  // namespace lostbits::intersect::device
