#include "analysis/selection/external.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string_view>
#include <system_error>
#include <thread>

#include "analysis/selection/options.hpp"
#include "analysis/selection/select.hpp"
#include "intersect/bounding_box/behind.hpp"
#include "intersect/device/device.hpp"
#include "intersect/external/formulas.hpp"
#include "intersect/external/guard.hpp"
#include "intersect/external/pipe.hpp"
#include "intersect/external/plugin.hpp"
#include "intersect/function/function.hpp"
#include "intersect/process/child.hpp"
#include "intersect/process/process_state.hpp"
#include "intersect/table/table.hpp"
#include "intersect/transform/transformed_form.hpp"
#include "measure/tape/driver_difference.hpp"
#include "number/error.hpp"
#include "output/attribution/explain_command.hpp"
#include "output/file/atomic_file.hpp"
#include "scene/toml/files_of_run.hpp"
#include "text/count_with_noun.hpp"
#include "text/shell_word.hpp"

namespace lostbits::analysis::selection {

using intersect::external::ForeignForm;
using intersect::external::open_pipe;
using intersect::external::PipeOptions;
using text::shell_word;

namespace {

/// The forms of a library that is loaded in another process of this program.
std::vector<ForeignForm> load_isolated_forms(const std::filesystem::path& library, PipeOptions pipe_options) {
    pipe_options.message_prefix = library.string() + " in a process of its own";
    pipe_options.is_lostbits = true;
    return open_pipe(this_program("plugin serve " + shell_word(library.string())), pipe_options);
}

/// The forms of a shader. Another process of this program holds the driver, with its compiler, its threads and its
/// faults.
std::vector<ForeignForm> load_shader_forms(const std::string& shader, const std::string& device,
                                           PipeOptions pipe_options) {
    pipe_options.message_prefix = "--shader " + shader + (device.empty() ? "" : " --device " + shell_word(device));
    pipe_options.is_lostbits = true;
    return open_pipe(
        this_program("shader serve " + shell_word(shader) + (device.empty() ? "" : " --device " + shell_word(device))),
        pipe_options);
}

/// The forms of a shader on each named device; for `all`, on each available one.
std::vector<ForeignForm> load_forms_on_devices(const std::string& shader, const ExternalOptions& options,
                                               const PipeOptions& pipe_options) {
    const bool wants_all = std::ranges::find(options.devices, "all") != options.devices.end();
    std::vector<ForeignForm> forms;
    std::string problems;
    for (const std::string& device : select_devices(options.devices)) {
        try {
            std::ranges::move(load_shader_forms(shader, device, pipe_options), std::back_inserter(forms));
        } catch (const EnvironmentError& missing) {
            if (!wants_all) throw;
            problems += std::string("\n  ") + missing.what();
        }
    }
    if (forms.empty()) throw EnvironmentError("--device all: no driver can run shaders here:" + problems);
    return forms;
}

/// True if a library exports formulas: it has `lostbits_formulas` in its table of names. Runs no code of the library.
bool has_formulas(const std::filesystem::path& library) {
    std::ifstream file(library, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), {});
    return bytes.find(std::string_view("\0lostbits_formulas\0", 19)) != std::string::npos;
}

/// True if the library runs in its own process. In another process a formula would lose its tape and its formats, so
/// libraries with formulas stay here unless --isolate is given.
bool is_isolated(const std::filesystem::path& library, const ExternalOptions& options) {
    return options.isolate || (options.isolate_by_default && !has_formulas(library));
}

/// The names of the forms that are not in the catalogue; with `only_in_process`, only of those that are not isolated.
std::vector<std::string> external_names(bool only_in_process = false) {
    std::vector<std::string> names;
    for (const auto& form : intersect::table::intersectors().subspan(intersect::table::catalogue().size()))
        if (!only_in_process || !intersect::external::is_safe_to_run(form)) names.emplace_back(form.info->name);
    return names;
}

/// The item itself and, for `FORM+FORM`, `FORM@TRANSFORM` and `FORM^BOX~METHOD`, each of its parts.
std::vector<std::string> names_in_pattern(const std::string& item) {
    std::vector<std::string> names{item};
    for (std::size_t begin = 0, end = 0; begin <= item.size(); begin = end + 1) {
        end = std::min(item.find_first_of("+@^~", begin), item.size());
        names.push_back(item.substr(begin, end - begin));
    }
    return names;
}

std::string_view primitives_text(Shape shape) {
    return is_primitive(shape) ? row_of(shape).plural : "fields of distances";
}

/// Throws InputError if another library has a formula of this name. `library_by_formula` has the libraries so far, by
/// name of the formula.
void require_new_formula(const std::string& name, const std::string& library,
                         std::map<std::string, std::string>& library_by_formula) {
    if (const auto [known, is_new] = library_by_formula.try_emplace(name, library); !is_new)
        throw InputError(
            fmt::format("{0}: {1} and {2} both have a form of this name; give one library a name: --plugin new={2} "
                        "calls its form new.{0}",
                        name, known->second, library));
}

/// Adds the forms and formulas of a library, with the prefix that `plugin` gives them.
void add_library(const std::string& plugin, const ExternalOptions& options, const PipeOptions& pipe_options,
                 std::map<std::string, std::string>& library_by_formula, ExternalForms& external_forms) {
    const auto library = intersect::external::find_plugin(plugin);
    scene::toml::reserve_for_reading(library);
    const bool is_in_own_process = is_isolated(library, options);
    auto forms =
        is_in_own_process ? load_isolated_forms(library, pipe_options) : intersect::external::load_plugin(library);
    auto formulas =
        is_in_own_process ? std::vector<intersect::external::Formula>() : intersect::external::load_formulas(library);
    if (const std::string prefix = intersect::external::prefix_of_plugin(plugin); !prefix.empty()) {
        for (auto& form : forms) intersect::external::add_prefix(form, prefix);
        for (auto& formula : formulas) intersect::external::add_prefix(formula, prefix);
    }
    for (const auto& formula : formulas)
        require_new_formula(std::string(formula.intersector.info->name), library.string(), library_by_formula);
    std::ranges::move(forms, std::back_inserter(external_forms.forms));
    std::ranges::move(formulas, std::back_inserter(external_forms.formulas));
}

}  // namespace

std::string this_program(const std::string& arguments) {
    std::error_code unknown;
    const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", unknown);
    if (unknown)
        throw EnvironmentError(
            "the path of this program is unknown (/proc is missing), so it cannot start itself again in another "
            "process; mount /proc");
    return fmt::format("exec {} {}", shell_word(program.string()), arguments);
}

std::vector<std::string> select_devices(const std::vector<std::string>& names) {
    std::vector<std::string> kinds;
    const auto add = [&kinds](std::string_view kind) { append_if_missing(kinds, std::string(kind)); };
    for (const std::string& name : names) {
        if (name == "all") std::ranges::for_each(intersect::device::device_kinds, add);
        else if (std::ranges::find(intersect::device::device_kinds, name) != std::end(intersect::device::device_kinds))
            add(name);
        else
            throw InputError(fmt::format("--device {}: is not one of {}, all", name,
                                         fmt::join(intersect::device::device_kinds, ", ")));
    }
    if (names.empty()) kinds.emplace_back();
    return kinds;
}

void decide_isolation(ExternalOptions& options, bool is_gate) {
    const char* const ci = intersect::process::own_environment("CI");
    options.isolate_by_default = !options.isolate && !options.in_process && (is_gate || (ci != nullptr && *ci != '\0'));
}

std::string libraries_in_process(const ExternalOptions& options) {
    std::string libraries;
    for (const std::string& plugin : options.plugins) {
        const auto library = intersect::external::find_plugin(plugin);
        if (!is_isolated(library, options)) libraries += (libraries.empty() ? "" : ", ") + library.string();
    }
    return libraries;
}

void note_isolation(const ExternalOptions& options, bool measures_times) {
    if (!options.isolate_by_default) return;
    const std::string libraries = libraries_in_process(options);
    if (!libraries.empty())
        fmt::print(stderr,
                   "lostbits: {}: has formulas, so it runs in this process; if it ends the process, the exit status is "
                   "3. --isolate runs it in its own process, in f32 and f64 only\n",
                   libraries);
    if (measures_times && !options.plugins.empty())
        fmt::print(stderr,
                   "lostbits: CI is set, so each library runs in its own process, and its times include the transfer "
                   "of rays and answers; use --in-process to avoid the transfer\n");
}

ExternalForms load_external_forms(const ExternalOptions& options, int thread_count) {
    if ((options.isolate || options.in_process) && options.plugins.empty())
        throw InputError(
            fmt::format("{}: is for libraries; name one by --plugin", options.isolate ? "--isolate" : "--in-process"));
    if (!options.devices.empty() && options.shaders.empty())
        throw InputError("--device: is for shaders; name one by --shader");
    if (options.plugins.empty() && options.pipes.empty() && options.shaders.empty() && options.functions.empty())
        return {};

    intersect::external::guard_foreign_code(
        {options.seconds, options.stop, output::file::remove_partial_files, options.on_fatal_fault});
    const int process_count =
        thread_count > 0 ? thread_count : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    const PipeOptions pipe_options{
        .seconds = options.seconds, .max_processes = static_cast<unsigned>(process_count), .stop = options.stop};

    // The options are recorded too, so that later commands can name the same intersectors.
    ExternalForms external_forms;
    std::string plugin_options;
    std::map<std::string, std::string> library_by_formula;
    for (const std::string& plugin : options.plugins) {
        add_library(plugin, options, pipe_options, library_by_formula, external_forms);
        plugin_options += " --plugin " + shell_word(plugin);
    }
    for (const std::string& command : options.pipes) {
        std::ranges::move(open_pipe(command, pipe_options), std::back_inserter(external_forms.forms));
        plugin_options += " --pipe " + shell_word(command);
    }
    for (const std::string& shader : options.shaders) {
        for (std::size_t end = shader.size(); end != std::string::npos && end > 0; end = shader.rfind(':', end - 1))
            scene::toml::reserve_for_reading(shader.substr(0, end));  // FILE:FUNCTION
        std::ranges::move(load_forms_on_devices(shader, options, pipe_options),
                          std::back_inserter(external_forms.forms));
        plugin_options += " --shader " + shell_word(shader);
    }
    for (const std::string& function : options.functions) plugin_options += " --function " + shell_word(function);
    for (const std::string& device : options.devices) plugin_options += " --device " + shell_word(device);
    output::attribution::set_plugin_options(plugin_options);
    return external_forms;
}

namespace {

/// `adds x + (y + z) in place of (x + y) + z`, or how far the first operation is off.
std::string difference_text(const measure::tape::DriverDifference& found) {
    std::vector<std::string> parts;
    for (const auto& rewriting : found.rewritings)
        parts.push_back(rewriting.name + (rewriting.sites.size() > 1
                                              ? fmt::format(" ({} times)", rewriting.sites.size())
                                              : std::string()));
    if (found.inexact_operation != no_node)
        parts.push_back(fmt::format("is up to {} in the last place off in an operation",
                                    text::count_with_noun(static_cast<std::uint64_t>(found.ulps), "unit")));
    return fmt::format("{}", fmt::join(parts, ", and "));
}

/// Prints how the answers of a driver differ from those of the followed function, and which operation explains it.
void print_difference(const std::string& message_prefix, const measure::tape::DriverDifference& found,
                      const intersect::table::Intersector& program) {
    if (found.differing_ray_count == 0) {
        fmt::print(stderr, "{}: the driver gives the bits of the followed function on {} random rays\n", message_prefix,
                   found.ray_count);
        return;
    }
    const std::string difference =
        fmt::format("{}: the driver gives other bits than the followed function on {} of {} random rays",
                    message_prefix, found.differing_ray_count, found.ray_count);
    if (!found.is_explained()) {
        fmt::print(stderr,
                   "{}; no tried change explains all of these rays (another order of sums, fused "
                   "products, reciprocals, common factors, subnormal numbers as 0, an inexact quotient or "
                   "root), so lostbits cannot name the operation\n",
                   difference);
        return;
    }
    const std::string line = intersect::function::quote_line(*program.info, *find_format("f32"), found.first_changed());
    fmt::print(stderr, "{}: it {}\n{}", difference, difference_text(found), line.empty() ? "" : "first here: " + line);
}

/// If a function is also given to `--shader`, compares it with the answers of the drivers.
void note_driver_differences(const intersect::function::UserFunction& function) {
    const auto& program = function.intersector;
    const std::string source_prefix =
        fmt::format("{}:{} on ", std::filesystem::path(function.path).filename().string(), function.line);
    const auto returns_both = [](intersect::Roots roots) { return roots == intersect::Roots::both; };
    for (const auto& shader_form : intersect::table::intersectors()) {
        for (const ForeignForm* const form : intersect::external::find_foreign_forms(shader_form)) {
            // If the file does not say which root its t is, --shader takes t for the near root, and --function for the
            // first one. These count as the same.
            if (!form->contract.source.starts_with(source_prefix) || form->contract.bits != 32 || function.bits != 32 ||
                shader_form.shape != program.shape ||
                returns_both(form->contract.roots) != returns_both(program.info->roots))
                continue;
            const std::string message_prefix =
                fmt::format("lostbits: {} ({})", shader_form.info->name, form->contract.source);
            print_difference(message_prefix, measure::tape::find_driver_difference(shader_form, program), program);
        }
    }
}

}  // namespace

void open_external(const ExternalOptions& options, int thread_count) {
    ExternalForms external_forms = load_external_forms(options, thread_count);
    // A library with formulas has the C interface too, for --isolate and `plugin check`; the formulas are used here.
    std::erase_if(external_forms.forms, [&external_forms](const ForeignForm& form) {
        return std::ranges::any_of(external_forms.formulas,
                                   [&form](const auto& f) { return f.intersector.info->name == form.contract.name; });
    });
    intersect::external::register_formulas(external_forms.formulas);
    intersect::external::register_forms(std::move(external_forms.forms));
    for (const std::string& function_name : options.functions) {
        auto function = load_shown_function(function_name, options);
        if (!options.quiet) note_driver_differences(*function);
        intersect::function::register_forms(std::move(function));
    }
}

std::unique_ptr<intersect::function::UserFunction> load_shown_function(const std::string& function_name,
                                                                       const ExternalOptions& options) {
    auto function =
        intersect::function::load_function(function_name, {.seconds = options.seconds, .stop = options.stop});
    scene::toml::reserve_for_reading(function->path);
    if (!options.quiet) fmt::print(stderr, "lostbits: {}\n", function->signature_text);
    return function;
}

void note_processor_states() {
    std::map<std::string, std::string> states;  // by library
    for (const auto& intersector : intersect::table::intersectors()) {
        for (const ForeignForm* const form : intersect::external::find_foreign_forms(intersector))
            if (!form->contract.state.empty()) states.try_emplace(form->provider, form->contract.state);
    }
    for (const auto& [library, state] : states)
        fmt::print(stderr,
                   "lostbits: {}: changes how the processor computes ({}) when it is loaded, as linking with -Ofast "
                   "does; only this library is measured in that state, as its users run it\n",
                   library, state);
}

std::vector<std::string> form_patterns(const std::vector<std::string>& given, std::vector<std::string> defaults) {
    if (!given.empty()) return given;
    std::ranges::move(external_names(), std::back_inserter(defaults));
    return defaults;
}

namespace {

/// True if `whole` is `form`, or is composed of it: a set, or `form` with a transform method or behind a box.
bool contains_form(const intersect::table::Intersector& whole, const intersect::table::Intersector& form) {
    if (&whole == &form) return true;
    if (std::ranges::any_of(whole.parts, [&form](const auto* part) { return contains_form(*part, form); })) return true;
    const auto* const transformed_form = intersect::transform::find_transformed_parts(whole).form;
    const auto* const boxed_form = intersect::bounding_box::find_boxed_parts(whole).form;
    return (transformed_form && contains_form(*transformed_form, form)) ||
           (boxed_form && contains_form(*boxed_form, form));
}

}  // namespace

void note_unmeasured(const std::vector<std::string>& patterns,
                     const std::vector<measure::evaluate::TestedForm>& tested_forms, bool quiet) {
    if (quiet) return;
    const std::vector<std::string> external_form_names = external_names();
    const auto is_wanted = [&](const std::string& name) {
        if (std::ranges::find(patterns, name) != patterns.end()) return true;
        return std::ranges::find(external_form_names, name) != external_form_names.end() &&
               (patterns.empty() || matches_any(patterns, name));
    };

    std::map<std::string, std::vector<std::string_view>> left_out;  // by the shapes and formats that they take
    for (const auto& form : intersect::table::intersectors()) {
        if (!is_wanted(std::string(form.info->name))) continue;
        const auto measures_form = [&form](const auto& tested_form) { return contains_form(*tested_form.form, form); };
        if (std::ranges::any_of(tested_forms, measures_form)) continue;
        const std::string formats = formats_text(form);
        left_out[std::string(primitives_text(form.shape)) + (formats == "all" ? "" : " in " + formats)].push_back(
            form.info->name);
    }
    for (const auto& [shapes_and_formats, names] : left_out)
        fmt::print(stderr, "lostbits: left out: {}: the selection has no {}\n", fmt::join(names, ", "),
                   shapes_and_formats);
}

void note_unused_external_forms(const shell::Command& command) {
    const shell::Option forms = command.option("--form");
    const shell::Option beside = command.option("--beside");  // a command without it uses isolated forms too
    const std::vector<std::string> names = external_names(static_cast<bool>(beside));
    if (names.empty() || !forms || forms.given_values().empty()) return;

    std::vector<std::string> patterns;
    for (const shell::Option& option : {forms, beside, command.option("--against")}) {
        for (const std::string& value : option ? option.given_values() : std::vector<std::string>())
            for (const std::string& item : shell::split_items(value, option.name()))
                std::ranges::move(names_in_pattern(item), std::back_inserter(patterns));
    }
    if (std::ranges::none_of(names, [&patterns](const auto& name) { return matches_any(patterns, name); }))
        fmt::print(stderr, "lostbits: {} {} loaded but not selected; add -i {}\n", fmt::join(names, ", "),
                   names.size() == 1 ? "is" : "are", names.front());
}

DeviceReport ask_device(std::string_view kind, const ExternalOptions& options) {
    DeviceReport report{.kind = std::string(kind), .facts = {}, .problem = {}};
    try {
        intersect::process::ChildProcess child(
            this_program("shader probe " + report.kind),
            {.who = report.kind, .timeout_advice = "", .seconds = options.seconds, .stop = options.stop});
        for (std::string line = child.read_line(); !line.empty(); line = child.read_line()) {
            const std::size_t equals = line.find('=');
            if (equals == std::string::npos) child.fail("wrote " + line + " instead of a line NAME=FACT");
            if (line.starts_with("missing=")) report.problem = line.substr(equals + 1);
            else report.facts.emplace_back(line.substr(0, equals), line.substr(equals + 1));
        }
    } catch (const EnvironmentError& error) {  // the driver crashed or hung
        report.problem = error.what();
    }
    return report;
}

}  // namespace lostbits::analysis::selection
