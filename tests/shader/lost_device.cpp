// Preloaded into the program: a device that is lost at the LOST_AT-th piece of work. With SILENTLY set, its driver does
// not report the loss and computes nothing more, as drivers may if no notice was requested.
#include <dlfcn.h>

#include <cstdint>
#include <cstdlib>

namespace {

/// True if the next piece of work is lost; all later pieces are lost, too.
bool is_lost(bool next) {
    static const char* const at = std::getenv("LOST_AT");
    static long count = 0;
    count += next;
    return at != nullptr && count >= std::atol(at);
}

bool silently() { return std::getenv("SILENTLY") != nullptr; }

/// The function itself; its library was loaded by a module of the program, for that module alone.
template <class Function>
Function* real(const char* library, const char* name) {
    return reinterpret_cast<Function*>(dlsym(dlopen(library, RTLD_NOW | RTLD_NOLOAD), name));
}

constexpr int vk_success = 0, vk_error_device_lost = -4, gl_no_error = 0, gl_context_lost = 0x0507;

}  // namespace

extern "C" {

using Submit = int(void*, std::uint32_t, const void*, void*);
using Wait = int(void*, std::uint32_t, void* const*, std::uint32_t, std::uint64_t);
using Dispatch = void(unsigned, unsigned, unsigned);
using Error = unsigned();

__attribute__((visibility("default"))) int vkQueueSubmit(void* queue, std::uint32_t n, const void* work, void* fence) {
    if (is_lost(true)) return silently() ? vk_success : vk_error_device_lost;
    return real<Submit>("libvulkan.so.1", "vkQueueSubmit")(queue, n, work, fence);
}

__attribute__((visibility("default"))) int vkWaitForFences(void* device, std::uint32_t n, void* const* fences,
                                                           std::uint32_t all, std::uint64_t limit) {
    if (is_lost(false)) return silently() ? vk_success : vk_error_device_lost;
    return real<Wait>("libvulkan.so.1", "vkWaitForFences")(device, n, fences, all, limit);
}

__attribute__((visibility("default"))) void glDispatchCompute(unsigned x, unsigned y, unsigned z) {
    if (!is_lost(true)) real<Dispatch>("libOpenGL.so.0", "glDispatchCompute")(x, y, z);
}

__attribute__((visibility("default"))) unsigned glGetError() {
    if (is_lost(false)) return silently() ? gl_no_error : gl_context_lost;
    return real<Error>("libOpenGL.so.0", "glGetError")();
}
}
