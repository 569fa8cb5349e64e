#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "analysis/selection/options.hpp"
#include "analysis/selection/ray_numbers.hpp"
#include "analysis/selection/ray_options.hpp"
#include "analysis/selection/select.hpp"
#include "analysis/selection/sweep_options.hpp"
#include "commands.hpp"
#include "measure/apriori/ranges.hpp"
#include "number/real.hpp"
#include "output/attribution/explain_text.hpp"
#include "output/file/escape.hpp"
#include "scene/toml/round.hpp"
#include "shapes/number_names.hpp"

namespace lostbits::analysis {

using measure::apriori::GivenRange;
using measure::apriori::RangesRequest;
using measure::apriori::StepRays;

namespace {

/// The options of --ranges.
struct RangeOptions {
    bool is_given = false;            ///< --ranges
    std::vector<std::string> ranges;  ///< NAME=LOW..HIGH
    std::string step;                 ///< a step of a sweep: a value of each axis
    int max_piece_count = 4096;
};

struct ExplainOptions {
    selection::RayOptions ray_options;
    RangeOptions ranges;
    std::string form, format = "f32";
    std::vector<std::string> forms_beside;
    bool json = false, fpcore = false, c = false;
};

/// The one form or format that the option names. Throws InputError if it names several, by commas or a pattern.
template <class Select>
auto select_one(const char* option, const std::string& value, const char* noun, const Select& select) {
    const auto selected = select(shell::split_items(value, option), option);
    if (selected.size() != 1)
        throw InputError(fmt::format("{} {}: the option names {} {}s, but explain looks at one ray in one {}; name one",
                                     option, value, selected.size(), noun, noun));
    return selected.front();
}

/// Throws InputError for an option that names one ray, and if no scene or sweep is given.
void require_several_rays(const selection::RayOptions& ray) {
    const std::array ray_options{std::pair{"--pixel", !ray.pixel.empty()}, std::pair{"--worst", ray.worst},
                                 std::pair{"--ray", !ray.ray.empty()}, std::pair{"--case", !ray.named_case.empty()}};
    for (const auto& [option, is_given] : ray_options)
        if (is_given)
            throw InputError(
                fmt::format("--ranges, {}: --ranges bounds the error of all rays of a scene or a step, but {} names "
                            "one ray; leave out --ranges or {}",
                            option, option, option));
    if (ray.subject.empty())
        throw InputError(
            "--ranges: takes the ranges from the rays of a scene, or of a sweep at one step; name a scene or a sweep, "
            "and give other ranges by --input-range NAME=LOW..HIGH");
}

/// Parses a range that replaces that of the scene: `d.x=-0.5..0.5`.
GivenRange parse_range(const std::string& text) {
    const auto equals = text.find('='), dots = text.find("..", equals == std::string::npos ? 0 : equals);
    if (equals == std::string::npos || equals == 0 || dots == std::string::npos)
        throw InputError("--input-range " + text + ": is not a range; write NAME=LOW..HIGH, such as d.x=-0.5..0.5");
    const std::string option = "--input-range " + text;
    const auto parse_end = [&](const std::string& number) {
        const auto x = selection::parse_numbers(number, {option.c_str(), "an end of a range; write a number", 1}, {});
        return scene::toml::round_to_format(x.front(), binary64);
    };
    const GivenRange parsed_range{
        text.substr(0, equals),
        {parse_end(text.substr(equals + 1, dots - equals - 1)), parse_end(text.substr(dots + 2))}};
    if (parsed_range.range.low > parsed_range.range.high)
        throw InputError("--input-range " + text + ": ends before it begins; write the smaller number first");
    return parsed_range;
}

/// The form itself or, for transformed primitives, the form with the usual transform method.
template <class Subject>
const intersect::table::Intersector* form_for_primitives(const intersect::table::Intersector& form,
                                                         const Subject& subject) {
    if (subject.accepts(form.shapes())) return &form;
    if (subject.accepts(form.shapes().with_transform()) && is_primitive(form.shape) && !form.has_transform_method)
        return &intersect::transform::transformed_form(intersect::transform::default_transform_method(), form);
    throw NothingSelected(fmt::format("-i {}: is not a form for the primitives of {}; `lostbits list forms` lists all",
                                      form.info->name, subject.id));
}

/// The rays of a sweep at the step that --at-step names.
scene::sweep::SweepFile open_sweep(const selection::RayOptions& ray, const std::filesystem::path& file,
                                   const std::filesystem::path& data, intersect::process::StopToken stop) {
    const auto kind = scene::sweep::read_sweep_kind(file);
    if (kind != scene::sweep::SweepKind::axes)
        throw InputError(ray.subject +
                         ": has no axes, but --ranges takes the ranges from a step of a sweep along axes; name one, or "
                         "a scene, and give other ranges by --input-range NAME=LOW..HIGH");
    const selection::SweepChangeOptions changes{ray.size, ray.steps, ray.set};
    selection::require_allowed_changes(changes, kind, ray.subject);
    return {file, data, selection::read_changes(changes), stop};
}

StepRays rays_at_step(const scene::sweep::SweepFile& sweep, const std::string& position) {
    std::string names;
    for (const auto& axis : sweep.axes) names += (names.empty() ? "" : ",") + axis.name;
    if (position.empty()) {
        std::string values;
        for (const auto& axis : sweep.axes)
            values += fmt::format("{}{}", values.empty() ? "" : ",", axis.values.front());
        throw InputError(fmt::format("--ranges: {} is a sweep; give --at-step {}, a value of {}", sweep.id, values,
                                     sweep.axes.size() == 1 ? names : "each of " + names));
    }
    const std::string expected = fmt::format("a step of {}; write --at-step {}, one number for each", sweep.id, names);
    std::vector<double> values;
    for (const Real& x : selection::parse_numbers(position, {"--at-step", expected.c_str(), sweep.axes.size()}, {}))
        values.push_back(scene::toml::round_to_format(x, binary64));
    return {fmt::format("{} at {}", sweep.id, position), sweep.rays(values)};
}

/// Prints the bound on the error over ranges. Throws InputError for options that name a ray, and for malformed ranges.
ExitStatus explain_ranges(const selection::RayOptions& ray, const RangeOptions& range_options,
                          const measure::evaluate::TestedForm& tested_form, bool json, const CommonOptions& common) {
    require_several_rays(ray);

    // Each input may have one range from the command line.
    RangesRequest request{.format = tested_form.format,
                          .max_box_count = static_cast<std::size_t>(range_options.max_piece_count)};
    for (const std::string& text : range_options.ranges) {
        const GivenRange& given = request.given_ranges.emplace_back(parse_range(text));
        if (std::ranges::count(request.given_ranges, given.name, &GivenRange::name) > 1)
            throw InputError("--input-range " + text + ": " + given.name +
                             " already has a range from another --input-range; leave out one of the two");
    }

    // The other ranges are those of a step of a sweep, or of a scene.
    const auto data = selection::data_folder(common.data);
    auto file = selection::find_sweep_file(ray.subject, data);
    // If a scene and a sweep have the same name, --at-step means the sweep.
    if (const auto sweep = data / "sweeps" / (ray.subject + ".toml");
        !file && !range_options.step.empty() && std::filesystem::is_regular_file(sweep))
        file = sweep;
    if (file) {
        const auto sweep = open_sweep(ray, *file, data, common.stop);
        request.form = form_for_primitives(*tested_form.form, sweep);
        request.rays = rays_at_step(sweep, range_options.step);
    } else {
        auto scene = selection::load_one_scene(
            {.names = {ray.subject}, .size = ray.size, .variant = ray.variant, .set = ray.set, .stop = common.stop},
            data);
        if (!range_options.step.empty())
            throw InputError("--at-step " + range_options.step + ": the option names a step of a sweep, but " +
                             ray.subject + " is not a sweep; leave out --at-step");
        request.form = form_for_primitives(*tested_form.form, scene);
        request.rays = std::move(scene);
    }

    request.limit.stop = common.stop;
    const selection::ThreadLimit limit(common.threads);
    const auto bound = measure::apriori::bound_over_ranges(request);
    fmt::print("{}", json ? output::attribution::ranges_json(request, bound)
                          : output::attribution::ranges_text(request, bound));
    return ExitStatus::done;
}

/// The form and the format of the options. Throws InputError if the form does not exist in the format, and for an
/// output that needs the operations of a form whose operations are not known.
measure::evaluate::TestedForm select_tested_form(const ExplainOptions& options) {
    const intersect::table::Intersector& form = *select_one("-i", options.form, "form", selection::select_forms);
    const Format format = select_one("-f", options.format, "format", selection::select_formats);
    if (!form.exists_in(format))
        throw InputError(fmt::format("-i {}: this form does not exist in {}, only in {}; try -f {}", options.form,
                                     options.format, selection::formats_text(form), form.native32 ? "f32" : "f64"));
    if (!form.is_template() && (options.json || options.fpcore || options.c))
        throw InputError(fmt::format(
            "-i {}: its operations are not known, since it is compiled elsewhere; write it as a form over any number "
            "type to see them (docs/your-own-form.md), or leave out {} to judge its answer only",
            options.form,
            options.json     ? "--json"
            : options.fpcore ? "--fpcore"
                             : "--c"));
    return {&form, format};
}

/// Prints on stderr what is odd about the ray: numbers of its scene that the format cannot represent, or a direction of
/// zero.
void note_odd_ray(const selection::SelectedRay& selected, const selection::RayOptions& ray_options,
                  const measure::evaluate::TestedForm& tested_form) {
    if (selected.scene) selection::note_unrepresentable_numbers(*selected.scene, {tested_form});
    if (ray_options.ray.empty()) return;
    const auto inputs = selected.ray.inputs(*tested_form.form, tested_form.format);
    if (inputs.ray(*tested_form.form->info).direction == Vec<double>(0, 0, 0))
        fmt::print(stderr,
                   "lostbits: --ray {}: the direction is 0,0,0, so this is not a ray; what follows shows only how the "
                   "form computes with it\n",
                   output::file::terminal_line(ray_options.ray));
}

measure::attribution::Explanation explain_ray(const selection::SelectedRay& selected, const Format& format,
                                              const std::vector<std::string>& forms_beside,
                                              intersect::process::StopToken stop) {
    const auto forms = selection::select_forms(forms_beside, "--beside");
    std::optional<measure::attribution::ScenePixel> pixel;
    if (selected.scene && selected.pixel)
        pixel = {selected.scene.get(), selected.pixel->first, selected.pixel->second, {.stop = stop}};
    return measure::attribution::explain(*selected.form, format, selected.ray, forms, pixel);
}

ExitStatus run(const ExplainOptions& options, const CommonOptions& common) {
    const measure::evaluate::TestedForm tested_form = select_tested_form(options);
    if (options.ranges.is_given) {
        if (options.fpcore || options.c)
            throw InputError(
                "--ranges: explain prints the bound as text or as --json only; leave out --fpcore and --c");
        return explain_ranges(options.ray_options, options.ranges, tested_form, options.json, common);
    }

    const selection::SelectedRay selected =
        selection::find_ray(options.ray_options, tested_form, selection::data_folder(common.data));
    if (!common.quiet) note_odd_ray(selected, options.ray_options, tested_form);
    const auto explanation = explain_ray(selected, tested_form.format, options.forms_beside, common.stop);
    const auto march = output::attribution::find_march_end(*tested_form.form, tested_form.format, selected.ray);

    for (const std::string& failure : explanation.failures)
        fmt::print(stderr, "lostbits: {}\n", output::file::terminal_text(failure));
    if (options.json) fmt::print("{}", output::attribution::explain_json(explanation, march));
    else if (options.fpcore) fmt::print("{}", output::attribution::explain_fpcore(explanation));
    else if (options.c) fmt::print("{}", output::attribution::explain_c(explanation));
    else {
        fmt::print("{}", selected.note);
        fmt::print("{}", output::attribution::explain_text(explanation, common.verbose, march));
    }
    return ExitStatus::done;
}

/// Adds the options that choose a ray of a scene or of a sweep.
void add_scene_ray_options(const shell::Command& command, selection::RayOptions& ray_options) {
    command.add("SCENE", ray_options.subject,
                "A scene; with --worst also a sweep; with --case a file of cases (docs/explain.md)");
    command.add("--pixel", ray_options.pixel, "Column and row of a pixel, from the left and from the top: 17,42");
    command.add(
        "--worst", ray_options.worst,
        "Explain the worst ray: the first ray of the most frequent kind of wrong decision, or else the ray with the "
        "largest error");
    command.add("--size", ray_options.size, "Size of the picture that contains the pixel, WxH (default: the scene's)");
    command.add("--steps", ray_options.steps, "Steps of each axis of a sweep, with --worst: 40, or 40,20");
    command.add("--variant", ray_options.variant, "The variant of a scene that has several");
}

/// Adds the options that give a ray and its primitives by numbers, or name a case.
void add_given_ray_options(const shell::Command& command, selection::RayOptions& ray_options) {
    command.add("--ray", ray_options.ray,
                "A ray of your own: its origin and direction, as decimals or hexadecimal floats");
    ray_options.primitives.add_to(command, "Primitives for --ray, in place of a scene");
    command.add("--tmin", ray_options.tmin, "The t at which the ray begins (default: 0)");
    command.add("--tmax", ray_options.tmax, "The t at which the ray ends (default: infinity)");
    command.add("--open-ends", ray_options.open_ends,
                "Exclude these ends of the range: a hit exactly at an excluded end does not count (default: none)",
                shell::one_of({"none", "tmin", "tmax", "both"}));
    command.add("--as", ray_options.format, "Round --ray, the primitives, --tmin and --tmax to this format first");

    // Cases, and how to judge them.
    command.add("--case", ray_options.named_case,
                "A case of a file of cases: NAME for its worst ray, or NAME:K for its ray K, counted from 0");
    command.add(
        "--convention", ray_options.convention,
        "The right answer for a ray that only touches: own (what the form states, default), closed (a hit), open (a "
        "miss)",
        shell::one_of({"own", "closed", "open"}));
}

/// Adds --ranges and the options that need it.
void add_range_options(const shell::Command& command, RangeOptions& range_options) {
    const auto ranges = command.add(
        "--ranges", range_options.is_given,
        "Bound the error of t for all rays whose inputs lie between the smallest and the largest ones of a scene, or "
        "of a step of a sweep");
    command
        .add("--at-step", range_options.step,
             "The step of a sweep for --ranges, given by one value per axis: 4096, or 4096,0.5")
        .needs(ranges);
    command
        .add("--input-range", range_options.ranges,
             "Override the range of one input of --ranges, such as d.x=-0.5..0.5; may be repeated")
        .needs(ranges);
    command
        .add("--pieces", range_options.max_piece_count,
             "The largest number of pieces into which --ranges divides the ranges (default: 4096)",
             shell::whole_number_between(1, 1 << 20))
        .needs(ranges);
}

void add_output_options(const shell::Command& command, ExplainOptions& options) {
    auto output_group = command.add_group("as", "Instead of the table");
    output_group.add("--json", options.json, "Print everything as JSON");
    output_group.add("--fpcore", options.fpcore, "Print t as FPCore 2.0, for Herbie and FPBench");
    output_group.add("--c", options.c, "Print a C program that reproduces t to the bit (docs/explain.md)");
}

}  // namespace

void add_explain(const shell::Command& program, const CommonOptions& common) {
    auto command =
        program.add_command("explain", "Show the operations of a form on one ray, and which operation loses the bits");
    const auto options = std::make_shared<ExplainOptions>();
    options->ray_options.stop = common.stop;
    command.add("-i,--form", options->form, "The form to explain").required();
    command.add("-f,--format", options->format, "The format (default: f32)");
    add_scene_ray_options(command, options->ray_options);
    add_given_ray_options(command, options->ray_options);
    add_range_options(command, options->ranges);

    command.add_list("--beside", options->forms_beside,
                     "Also try these forms on the ray, by name or glob (docs/explain.md)");
    command.add_set(options->ray_options.set, "Change a number of the scene or the sweep first: march.hit_eps=1e-6");
    add_output_options(command, *options);
    command.set_action([options, &common] { return run(*options, common); });
}

}  // namespace lostbits::analysis
