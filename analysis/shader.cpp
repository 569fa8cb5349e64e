// The commands `devices` and `shader`: which drivers run shaders here and how they round, and the process behind
// --shader. Only such processes load a driver.
#include <fmt/format.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "analysis/selection/external.hpp"
#include "commands.hpp"
#include "intersect/device/probe.hpp"
#include "intersect/external/pipe.hpp"
#include "intersect/shader/forms.hpp"

namespace lostbits::analysis {

namespace {

using namespace intersect::device;
using namespace intersect::shader;

std::shared_ptr<Device> open_named_or_any(const std::string& device_kind) {
    setenv("EGL_LOG_LEVEL", "fatal", 0);  // lostbits itself reports what is missing, once
    return device_kind.empty() ? open_any_device() : open_device(device_kind);
}

/// Warns about loops that may run more often than the driver allows: some drivers end a loop after a fixed count.
void warn_about_loops(const ShaderSource& shader, const Arithmetic& arithmetic) {
    std::size_t reported_line = 0;
    for (const CountedLoop& loop : shader.loops) {
        const long long iterations = arithmetic.loops_share_limit ? loop.max_nested_iterations : loop.max_iterations;
        if (loop.line == reported_line || arithmetic.loop_limit == 0 || iterations <= arithmetic.loop_limit) continue;
        reported_line = loop.line;
        const std::string limit_text =
            iterations == CountedLoop::endless ? "has no limit" : fmt::format("may run {} times", iterations);
        fmt::print(stderr,
                   "lostbits: {}:{}: this loop {}, but this driver silently ends loops after {} iterations{}, so "
                   "answers that need more are wrong\n",
                   shader.path, loop.line, limit_text, arithmetic.loop_limit,
                   arithmetic.loops_share_limit ? ", counting the iterations of enclosing loops" : "");
    }
}

/// Compiles the shader, then answers requests on standard input. If the shader does not compile or no device runs it,
/// writes the reason to standard output in place of the header.
ExitStatus serve_shader(const std::string& shader_name, const std::string& device_kind) {
    const int output_fd = redirect_standard_output("shader serve");
    // Ends with its parent. A process whose driver hangs would not notice the end of its input.
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    std::vector<intersect::external::ForeignForm> forms;
    try {
        const ShaderSource shader = read_shader(shader_name);
        const auto device =
            open_named_or_any(device_kind.empty() && shader.is_hlsl ? "vulkan" : device_kind);  // HLSL needs Vulkan
        const Arithmetic arithmetic = probe(*device);
        warn_about_loops(shader, arithmetic);
        if (shader.f32 && shader.f64 && !device->limits().has_doubles)
            fmt::print(stderr, "lostbits: {}: {} has no doubles in shaders; its form exists in f32 only\n", shader.path,
                       device->description().renderer);
        forms = forms_of(shader, device, !device_kind.empty(), describe_device(device->description(), arithmetic));
    } catch (const Error& error) {
        const std::string message = intersect::external::error_lines_of(error);
        return write(output_fd, message.data(), message.size()) < 0 ? ExitStatus::environment : error.status();
    }
    if (intersect::external::serve_pipe(forms, STDIN_FILENO, output_fd)) return ExitStatus::done;
    throw InputError(
        "shader serve: standard input is not a request of lostbits-pipe/1; only `lostbits … --shader FILE.glsl` runs "
        "this command");
}

/// Prints the facts about a device and its rounding, one line `key=value` for each, and an empty line.
ExitStatus send_device_facts(const std::string& device_kind) {
    const int output_fd = redirect_standard_output("shader probe");
    std::string text;
    try {
        const auto device = open_named_or_any(device_kind);
        const Arithmetic arithmetic = probe(*device);
        const DeviceDescription& description = device->description();
        text = fmt::format("device={}\nrenderer={}\nvendor={}\nversion={}\ndriver={}\ndigest={:016x}\n",
                           description.kind, description.renderer, description.vendor, description.version,
                           description.driver, arithmetic.digest);
        for (const DeviceFact& fact : arithmetic.facts) text += fmt::format("{}={}\n", fact.key, fact.value);
    } catch (const Error& error) {
        const std::string_view message = error.what();
        const std::string prefix = device_kind.empty() ? "" : device_kind + ": ";
        text = fmt::format("missing={}\n", message.starts_with(prefix) ? message.substr(prefix.size()) : message);
        std::ranges::replace(text.begin(), text.end() - 1, '\n', ' ');
    }
    text += "\n";
    return write(output_fd, text.data(), text.size()) < 0 ? ExitStatus::environment : ExitStatus::done;
}

void print_device(const selection::DeviceReport& report) {
    if (!report.problem.empty()) {
        fmt::print("{}\n  not available: {}\n", report.kind, report.problem);
        return;
    }
    fmt::print("{}\n", report.kind);
    for (const auto& [key, value] : report.facts) {
        if (key != "device") fmt::print("  {:<22} {}\n", key, value);
    }
}

ExitStatus show_devices(bool json, const CommonOptions& common) {
    auto array = nlohmann::ordered_json::array();
    bool any_available = false;
    std::vector<std::string> kinds = selection::select_devices(common.external.devices);
    if (common.external.devices.empty()) kinds = selection::select_devices({"all"});
    for (const std::string& device_kind : kinds) {
        const selection::DeviceReport report = selection::ask_device(device_kind, common.external);
        any_available = any_available || report.problem.empty();
        nlohmann::ordered_json object{{"device", report.kind}};
        if (!report.problem.empty()) object["missing"] = report.problem;
        for (const auto& [key, value] : report.facts) object[key] = value;
        array.push_back(std::move(object));
        if (!json) print_device(report);
    }
    if (json) fmt::print("{}\n", array.dump(2));
    else if (any_available && !common.quiet) fmt::print("tried on {}\n", probed_inputs);
    if (!any_available) throw EnvironmentError("no driver can run shaders here; docs/shader.md says what to install");
    return ExitStatus::done;
}

}  // namespace

void add_devices(const shell::Command& program, const CommonOptions& common) {
    auto command =
        program.add_command("devices", "Show which drivers can run --shader on this machine, and how they round");
    const auto json = std::make_shared<bool>(false);
    command.add("--json", *json, "Print a JSON array");
    command.set_action([json, &common] { return show_devices(*json, common); });
}

void add_shader(const shell::Command& program, const CommonOptions& /*common*/) {
    auto command = program.add_command("shader", "The process of a shader, which --shader starts");
    command.hide_from_help();
    const auto file = std::make_shared<std::string>(), device_kind = std::make_shared<std::string>();
    auto serve_command =
        command.add_command("serve", "Answer rays on standard input with a shader (what --shader starts)");
    serve_command.add("SHADER", *file, "The file, as --shader takes it").required();
    serve_command.set_action([file, device = program.option("--device")] {
        return serve_shader(*file, device.given_values().empty() ? "" : device.given_values().front());
    });
    auto probe_command =
        command.add_command("probe", "How a device rounds, as lines for a program (what `devices` starts)");
    probe_command.add("DEVICE", *device_kind, "opengl or vulkan");
    probe_command.set_action([device_kind] { return send_device_facts(*device_kind); });
}

}  // namespace lostbits::analysis
