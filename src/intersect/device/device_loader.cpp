#include <dlfcn.h>

#include <filesystem>
#include <system_error>

#include "intersect/device/device.hpp"
#include "intersect/device/temporary_folder.hpp"
#include "intersect/process/process_state.hpp"

namespace lostbits::intersect::device {

namespace fs = std::filesystem;

namespace {

/// Returns the path of the module of a kind, from the first folder that has it: $LOSTBITS_DEVICE_MODULES, the program's
/// own folder (a build folder), the installed `lib/lostbits`. Throws EnvironmentError if none of these folders has the
/// module.
fs::path find_device_module(std::string_view kind) {
    const std::string name = "lostbits_" + std::string(kind) + ".so";
    std::error_code error;
    const fs::path program_folder = fs::read_symlink("/proc/self/exe", error).parent_path();
    const char* const module_folder = process::own_environment("LOSTBITS_DEVICE_MODULES");
    for (const fs::path& folder : {fs::path(module_folder != nullptr ? module_folder : ""), program_folder,
                                   program_folder / "../lib/lostbits"}) {
        if (!folder.empty() && fs::exists(folder / name, error)) return folder / name;
    }
    throw EnvironmentError(std::string(kind) + ": this program was built without its module; install " +
                           (kind == "opengl" ? "libegl-dev libopengl-dev" : "libvulkan-dev") + " and build again");
}

}  // namespace

std::unique_ptr<Device> open_device(std::string_view kind) {
    const fs::path path = find_device_module(kind);
    const auto fail = [&](const char* reason) -> EnvironmentError {
        if (reason != nullptr && lacks_memory(reason))
            return EnvironmentError(std::string(kind) + ": cannot load " + path.string() + ": " + reason +
                                    "; raise `ulimit -v`, or free memory");
        return EnvironmentError(
            std::string(kind) + ": cannot load " + path.string() + ": " + (reason != nullptr ? reason : "unknown") +
            "; install its libraries (Debian: " + (kind == "opengl" ? "libegl1 libopengl0" : "libvulkan1") + ")");
    };
    const process::FloatingPointGuard guard;
    // The module is never closed: drivers start threads and register exit handlers.
    void* const handle = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (handle == nullptr) throw fail(::dlerror());
    const auto* const build = static_cast<const int*>(::dlsym(handle, "lostbits_device_build"));
    const auto open = reinterpret_cast<OpenDevice>(::dlsym(handle, "lostbits_open_device"));
    if (build == nullptr || open == nullptr || *build != device_build)
        throw EnvironmentError(std::string(kind) + ": " + path.string() + " belongs to another build; build again");
    return std::unique_ptr<Device>(open());
}

std::unique_ptr<Device> open_any_device() {
    std::string problems;
    for (const std::string_view kind : device_kinds) {
        try {
            return open_device(kind);
        } catch (const EnvironmentError& error) {
            problems += std::string("\n  ") + error.what();
        }
    }
    throw EnvironmentError("no driver can run shaders here:" + problems);
}

}  // namespace lostbits::intersect::device
