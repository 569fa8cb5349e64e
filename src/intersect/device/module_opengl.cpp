// The OpenGL module: runs compute programs through EGL without a window, on the installed driver. It is built as
// `lostbits_opengl` and loaded at run time.
#define EGL_NO_X11
#define GL_GLEXT_PROTOTYPES
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glcorearb.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <utility>

#include "intersect/device/device.hpp"

namespace lostbits::intersect::device {
namespace {

[[noreturn]] void fail(const std::string& problem) { throw EnvironmentError("opengl: " + problem); }

/// Finds the displays that need no window, in the order in which they are tried: one for each device, Mesa's
/// surfaceless platform, the default display.
std::vector<std::function<EGLDisplay()>> find_displays() {
    std::vector<std::function<EGLDisplay()>> result;
    const char* const extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    const auto has_extension = [extensions](const char* name) {
        return extensions != nullptr && std::strstr(extensions, name) != nullptr;
    };

    const auto get_platform_display =
        reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));

    // Adds a display for each device that the driver lists.
    if (has_extension("EGL_EXT_platform_device") && has_extension("EGL_EXT_device_enumeration") &&
        get_platform_display != nullptr) {
        const auto query_devices = reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(eglGetProcAddress("eglQueryDevicesEXT"));
        std::array<EGLDeviceEXT, 16> devices{};
        EGLint count = 0;
        if (query_devices != nullptr &&
            query_devices(static_cast<EGLint>(devices.size()), devices.data(), &count) == EGL_TRUE) {
            for (EGLint i = 0; i < count; ++i)
                result.emplace_back([device = devices[i], get_platform_display] {
                    return get_platform_display(EGL_PLATFORM_DEVICE_EXT, device, nullptr);
                });
        }
    }

    if (has_extension("EGL_MESA_platform_surfaceless") && get_platform_display != nullptr)
        result.emplace_back([get_platform_display] {
            return get_platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
        });
    result.emplace_back([] { return eglGetDisplay(EGL_DEFAULT_DISPLAY); });
    return result;
}

/// Minor versions of OpenGL 4 in the order in which they are tried, each first with notification of a lost device, then
/// without.
constexpr std::array<std::pair<EGLint, bool>, 8> context_versions{
    {{6, true}, {6, false}, {5, true}, {5, false}, {4, true}, {4, false}, {3, true}, {3, false}}};

/// Creates a context of OpenGL 4 with this minor version. Returns EGL_NO_CONTEXT if the display has none.
EGLContext create_context(EGLDisplay display, EGLint minor, bool with_notification) {
    const std::array<EGLint, 9> context_attributes{
        EGL_CONTEXT_MAJOR_VERSION,
        4,
        EGL_CONTEXT_MINOR_VERSION,
        minor,
        EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
        with_notification ? EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY_KHR : EGL_NONE,
        EGL_LOSE_CONTEXT_ON_RESET_KHR,
        EGL_NONE};

    // If no configuration fits, tries a context without a configuration, which some drivers allow.
    EGLConfig config = nullptr;
    EGLint config_count = 0;
    const std::array<EGLint, 3> config_attributes{EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
    if (eglChooseConfig(display, config_attributes.data(), &config, 1, &config_count) != EGL_TRUE || config_count == 0)
        config = nullptr;
    return eglCreateContext(display, config, EGL_NO_CONTEXT, context_attributes.data());
}

/// Creates a context that can run compute programs, and makes it current. Returns false if the display has none.
bool make_current(EGLDisplay display) {
    if (display == EGL_NO_DISPLAY || eglInitialize(display, nullptr, nullptr) != EGL_TRUE) return false;
    if (eglBindAPI(EGL_OPENGL_API) != EGL_TRUE) return false;
    for (const auto& [minor, with_notification] : context_versions) {
        const EGLContext context = create_context(display, minor, with_notification);
        if (context == EGL_NO_CONTEXT) continue;
        if (eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_TRUE) return true;
        eglDestroyContext(display, context);
    }
    return false;
}

std::string gl_string(GLenum name) {
    const GLubyte* const text = glGetString(name);
    return text != nullptr ? reinterpret_cast<const char*>(text) : "unknown";
}

class GlProgram : public DeviceProgram {
public:
    explicit GlProgram(GLuint name) : name_(name) {}
    ~GlProgram() override { glDeleteProgram(name_); }
    [[nodiscard]] GLuint name() const { return name_; }

private:
    GLuint name_;
};

class GlDevice : public Device {
public:
    GlDevice() {
        const auto candidates = find_displays();
        const auto try_make_current = [](const auto& display) { return make_current(display()); };
        if (std::ranges::none_of(candidates, try_make_current))
            fail(
                "no driver with OpenGL 4.3 works without a window; install one (Debian: libegl-mesa0 "
                "libgl1-mesa-dri, which compute on the processor)");
        description_ = {"opengl", gl_string(GL_RENDERER), gl_string(GL_VENDOR), "OpenGL " + gl_string(GL_VERSION),
                        "EGL"};

        GLint bytes = 0, max_groups = 0;
        glGetIntegerv(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &bytes);
        glGetIntegeri_v(GL_MAX_COMPUTE_WORK_GROUP_COUNT, 0, &max_groups);
        limits_ = {.max_buffer_bytes = static_cast<std::size_t>(std::max(bytes, 1 << 20)),
                   .max_groups = static_cast<std::size_t>(std::max(max_groups, 1)),
                   .has_doubles = true,  // part of OpenGL since 4.0
                   .glsl = 430};
    }

    [[nodiscard]] const DeviceDescription& description() const override { return description_; }
    [[nodiscard]] const DeviceLimits& limits() const override { return limits_; }

    [[nodiscard]] std::unique_ptr<DeviceProgram> compile_program(const std::string& glsl, Language language) override {
        if (language != Language::glsl)
            throw EnvironmentError("opengl: takes only GLSL; --device vulkan takes HLSL too");

        const GLuint shader = glCreateShader(GL_COMPUTE_SHADER);
        const char* const text = glsl.c_str();
        glShaderSource(shader, 1, &text, nullptr);
        glCompileShader(shader);
        GLint status = 0;
        glGetShaderiv(shader, GL_COMPILE_STATUS, &status);
        if (status == 0) {
            const std::string log = log_of(shader, glGetShaderiv, glGetShaderInfoLog);
            glDeleteShader(shader);
            throw CompileError(log);
        }

        auto program = std::make_unique<GlProgram>(glCreateProgram());
        glAttachShader(program->name(), shader);
        glLinkProgram(program->name());
        glDeleteShader(shader);
        glGetProgramiv(program->name(), GL_LINK_STATUS, &status);
        if (status == 0) throw CompileError(log_of(program->name(), glGetProgramiv, glGetProgramInfoLog));
        return program;
    }

    void run_program(DeviceProgram& program, std::span<const DeviceBuffer> buffers, std::size_t group_count) override {
        while (buffer_names_.size() < buffers.size()) glGenBuffers(1, &buffer_names_.emplace_back());
        for (std::size_t k = 0; k < buffers.size(); ++k) {
            const auto bytes = static_cast<GLsizeiptr>(buffers[k].bytes.size());
            glBindBuffer(GL_SHADER_STORAGE_BUFFER, buffer_names_[k]);
            glBufferData(GL_SHADER_STORAGE_BUFFER, bytes, buffers[k].bytes.data(), GL_STREAM_READ);
            glBindBufferBase(GL_SHADER_STORAGE_BUFFER, static_cast<GLuint>(k), buffer_names_[k]);
        }

        // Runs the program. The barrier makes its results visible to the reads below.
        glUseProgram(static_cast<GlProgram&>(program).name());
        glDispatchCompute(static_cast<GLuint>(group_count), 1, 1);
        glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);

        for (std::size_t k = 0; k < buffers.size(); ++k) {
            if (!buffers[k].is_written) continue;
            glBindBuffer(GL_SHADER_STORAGE_BUFFER, buffer_names_[k]);
            glGetBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, static_cast<GLsizeiptr>(buffers[k].bytes.size()),
                               buffers[k].bytes.data());
        }

        if (const GLenum error = glGetError(); error != GL_NO_ERROR)
            fail(error == GL_OUT_OF_MEMORY
                     ? std::string("the device has no memory left")
                     : "the device is lost (error " + std::to_string(error) + "); does the shader run too long?");
    }

private:
    template <class GetValue, class GetLog>
    static std::string log_of(GLuint name, const GetValue& get_value, const GetLog& get_log) {
        GLint length = 0;
        get_value(name, GL_INFO_LOG_LENGTH, &length);
        std::string log(static_cast<std::size_t>(std::max(length, 1)), '\0');
        get_log(name, length, nullptr, log.data());
        log.resize(std::strlen(log.c_str()));
        return log;
    }

    DeviceDescription description_;
    DeviceLimits limits_;
    std::vector<GLuint> buffer_names_;
};

}  // namespace
}  // namespace lostbits::intersect::device

extern "C" {
__attribute__((visibility("default"))) extern const int lostbits_device_build =
    lostbits::intersect::device::device_build;
__attribute__((visibility("default"))) lostbits::intersect::device::Device* lostbits_open_device() {
    return new lostbits::intersect::device::GlDevice();
}
}
