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
    std::string at;                   ///< of a sweep: a value of each axis
    int boxes = 4096;
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
    const auto found = select(shell::items_in(value, option), option);
    if (found.size() != 1)
        throw InputError(fmt::format("{} {}: the option names {} {}s, but explain looks at one ray in one {}; name one",
                                     option, value, found.size(), noun, noun));
    return found.front();
}

void refuse_ray(const selection::RayOptions& ray) {
    const std::array ray_options{std::pair{"--pixel", !ray.pixel.empty()}, std::pair{"--worst", ray.worst},
                                 std::pair{"--ray", !ray.ray.empty()}, std::pair{"--case", !ray.named_case.empty()}};
    for (const auto& [option, given] : ray_options)
        if (given)
            throw InputError(
                fmt::format("--ranges, {}: --ranges bounds the error of all rays of a scene or a step, but {} names "
                            "one ray; leave out --ranges or {}",
                            option, option, option));
    if (ray.subject.empty())
        throw InputError(
            "--ranges takes the ranges from the rays of a scene, or of a sweep at one step; name a scene or a sweep, "
            "and give other ranges by --input-range NAME=LOW..HIGH");
}

/// Parses a range that replaces that of the scene: `d.x=-0.5..0.5`.
GivenRange range_named(const std::string& text) {
    const auto equals = text.find('='), dots = text.find("..", equals == std::string::npos ? 0 : equals);
    if (equals == std::string::npos || equals == 0 || dots == std::string::npos)
        throw InputError("--input-range " + text + " is not a range; write NAME=LOW..HIGH, such as d.x=-0.5..0.5");
    const std::string option = "--input-range " + text;
    const auto parse_end = [&](const std::string& number) {
        const auto x = selection::numbers_of(number, {option.c_str(), "an end of a range; write a number", 1}, {});
        return scene::toml::round_to_format(x.front(), binary64);
    };
    const GivenRange given{text.substr(0, equals),
                           {parse_end(text.substr(equals + 1, dots - equals - 1)), parse_end(text.substr(dots + 2))}};
    if (given.range.low > given.range.high)
        throw InputError("--input-range " + text + ": ends before it begins; write the smaller number first");
    return given;
}

/// The form itself or, for primitives placed by matrices, the form with the usual transform.
template <class Subject>
const intersect::table::Intersector* form_for(const intersect::table::Intersector& form, const Subject& subject) {
    if (subject.meets(form.shapes())) return &form;
    if (subject.meets(form.shapes().placed()) && is_primitive(form.shape) && !form.is_placed)
        return &intersect::transform::transformed_form(intersect::transform::default_transform_method(), form);
    throw NothingSelected(fmt::format("{} is not a form for the primitives of {}; `lostbits list forms` lists all",
                                      form.info->name, subject.id));
}

/// The rays of a sweep at the step that --at-step names.
scene::sweep::SweepFile sweep_of(const selection::RayOptions& ray, const std::filesystem::path& file,
                                 const std::filesystem::path& data, intersect::process::StopToken stop) {
    const auto kind = scene::sweep::sweep_kind(file);
    if (kind != scene::sweep::SweepKind::axes)
        throw InputError(ray.subject +
                         ": has no axes, but --ranges takes the ranges from a step of a sweep along axes; name one, or "
                         "a scene, and give other ranges by --input-range NAME=LOW..HIGH");
    const selection::SweepChangeOptions changes{ray.size, ray.steps, ray.set};
    selection::check_changes(changes, kind, ray.subject);
    return {file, data, selection::read_changes(changes), stop};
}

StepRays step_of(const scene::sweep::SweepFile& sweep, const std::string& position) {
    std::string names;
    for (const auto& axis : sweep.axes) names += (names.empty() ? "" : ",") + axis.name;
    if (position.empty())
        throw InputError(
            fmt::format("--ranges: {} is a sweep; name one of its steps by --at-step {}", sweep.id, names));
    const std::string expected = fmt::format("a step of {}; write --at-step {}, one number for each", sweep.id, names);
    std::vector<double> values;
    for (const Real& x : selection::numbers_of(position, {"--at-step", expected.c_str(), sweep.axes.size()}, {}))
        values.push_back(scene::toml::round_to_format(x, binary64));
    return {fmt::format("{} at {}", sweep.id, position), sweep.rays(values)};
}

/// Prints the bound on the error over ranges. Throws InputError for options that name a ray, and for malformed ranges.
Exit explain_ranges(const selection::RayOptions& ray, const RangeOptions& range_options,
                    const measure::evaluate::TestedForm& form_row, bool json, const Common& common) {
    refuse_ray(ray);
    RangesRequest request{.format = form_row.format, .boxes = static_cast<std::size_t>(range_options.boxes)};
    for (const std::string& text : range_options.ranges) {
        const GivenRange& given = request.given_ranges.emplace_back(range_named(text));
        if (std::ranges::count(request.given_ranges, given.name, &GivenRange::name) > 1)
            throw InputError("--input-range " + text + ": " + given.name +
                             " already has a range from another --input-range; leave out one of the two");
    }
    const auto data = selection::data_folder(common.data);
    auto file = selection::sweep_named(ray.subject, data);
    // If a scene and a sweep have the same name, --at-step means the sweep.
    if (const auto sweep = data / "sweeps" / (ray.subject + ".toml");
        !file && !range_options.at.empty() && std::filesystem::is_regular_file(sweep))
        file = sweep;
    if (file) {
        const auto sweep = sweep_of(ray, *file, data, common.stop);
        request.form = form_for(*form_row.form, sweep);
        request.rays = step_of(sweep, range_options.at);
    } else {
        auto scene = selection::load_one_scene(
            {.names = {ray.subject}, .size = ray.size, .variant = ray.variant, .set = ray.set, .stop = common.stop},
            data);
        if (!range_options.at.empty())
            throw InputError("--at-step " + range_options.at + ": the option names a step of a sweep, but " +
                             ray.subject + " is not a sweep; leave out --at-step");
        request.form = form_for(*form_row.form, scene);
        request.rays = std::move(scene);
    }
    request.limit.stop = common.stop;
    const selection::ThreadLimit limit(common.threads);
    const auto bound = measure::apriori::bound_over_ranges(request);
    fmt::print("{}", json ? output::attribution::ranges_json(request, bound)
                          : output::attribution::ranges_text(request, bound));
    return Exit::done;
}

Exit run(const ExplainOptions& o, const Common& common) {
    const intersect::table::Intersector& form = *select_one("-i", o.form, "form", selection::select_forms);
    const Format format = select_one("-f", o.format, "format", selection::select_formats);
    if (!form.exists_in(format))
        throw InputError(fmt::format("-i {}: this form does not exist in {}, only in {}; try -f {}", o.form, o.format,
                                     selection::formats_of(form), form.native32 ? "f32" : "f64"));
    if (!form.is_template() && (o.json || o.fpcore || o.c))
        throw InputError(fmt::format(
            "-i {}: its operations are not known, since it is compiled elsewhere; write it as a form over any number "
            "type to see them (docs/your-own-form.md). Without {} explain judges its answer",
            o.form,
            o.json     ? "--json"
            : o.fpcore ? "--fpcore"
                       : "--c"));
    if (o.ranges.is_given) {
        if (o.fpcore || o.c)
            throw InputError(
                "--ranges: explain prints the bound as text or as --json only; leave out --fpcore and --c");
        return explain_ranges(o.ray_options, o.ranges, {&form, format}, o.json, common);
    }
    const selection::SelectedRay selected =
        selection::find_ray(o.ray_options, {&form, format}, selection::data_folder(common.data));
    const measure::answer::OneRay& ray = selected.ray;
    if (selected.scene && !common.quiet) selection::note_lost_numbers(*selected.scene, {{&form, format}});
    const auto forms_beside = selection::select_forms(o.forms_beside, "--beside");
    std::optional<measure::attribution::ScenePixel> pixel;
    if (selected.scene && selected.pixel)
        pixel = {selected.scene.get(), selected.pixel->first, selected.pixel->second, {.stop = common.stop}};
    const measure::attribution::Explanation explanation =
        measure::attribution::explain(*selected.form, format, ray, forms_beside, pixel);
    const auto march = output::attribution::end_of_march(form, format, ray);
    for (const std::string& why : explanation.failures)
        fmt::print(stderr, "lostbits: {}\n", output::file::terminal_text(why));
    if (o.json) fmt::print("{}", output::attribution::explain_json(explanation, march));
    else if (o.fpcore) fmt::print("{}", output::attribution::explain_fpcore(explanation));
    else if (o.c) fmt::print("{}", output::attribution::explain_c(explanation));
    else {
        fmt::print("{}", selected.note);
        fmt::print("{}", output::attribution::explain_text(explanation, common.verbose, march));
    }
    return Exit::done;
}

}  // namespace

void add_explain(const shell::Command& program, const Common& common) {
    auto command =
        program.add_command("explain", "Show the operations of a form on one ray, and which operation loses the bits");
    const auto o = std::make_shared<ExplainOptions>();
    selection::RayOptions& ray_options = o->ray_options;
    ray_options.stop = common.stop;
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
    command.add("--ray", ray_options.ray, "A ray of your own: OX,OY,OZ,DX,DY,DZ, as decimals or hexadecimal floats");
    ray_options.primitives.add_to(
        command, "Primitives for --ray, in place of a scene (may be repeated; a matrix follows after @)");
    command.add("--tmin", ray_options.tmin, "The t at which the ray begins (default: 0)");
    command.add("--tmax", ray_options.tmax, "The t at which the ray ends (default: infinity)");
    command.add("--open-ends", ray_options.open_ends,
                "Exclude these ends of the range: a hit exactly at an excluded end does not count (default: none)",
                shell::one_of({"none", "tmin", "tmax", "both"}));
    command.add("--as", ray_options.format,
                "First round the numbers of --ray, of the primitives, --tmin and --tmax to this format");
    command.add("--case", ray_options.named_case,
                "A case of a file of cases: NAME for its worst ray, or NAME:K for its ray K, counted from 0");
    command.add(
        "--convention", ray_options.convention,
        "The right answer for a ray that touches: own (as the form states, default), closed (a hit), open (a miss)",
        shell::one_of({"own", "closed", "open"}));
    const auto ranges = command.add("--ranges", o->ranges.is_given,
                                    "Bound the error of t over all rays within the ranges of a scene or of a step of a "
                                    "sweep");
    command
        .add("--at-step", o->ranges.at, "The step of a sweep for --ranges, as a value of each axis: 4096, or 4096,0.5")
        .needs(ranges);
    command
        .add("--input-range", o->ranges.ranges,
             "Another range of an input for --ranges, such as d.x=-0.5..0.5; may be repeated")
        .needs(ranges);
    command
        .add("--boxes", o->ranges.boxes,
             "The largest number of boxes into which --ranges divides the ranges (default: 4096)",
             shell::whole_from(1, 1 << 20))
        .needs(ranges);
    command.add("-i,--form", o->form, "The form to explain").required();
    command.add("-f,--format", o->format, "The format (default: f32)");
    command.add_list("--beside", o->forms_beside, "Also try these forms on the ray, by name or glob (docs/explain.md)");
    command.add_set(ray_options.set, "Change a number of the scene or the sweep first: march.hit_eps=1e-6");
    auto output_group = command.add_group("as", "Instead of the table");
    output_group.add("--json", o->json, "Print everything as JSON");
    output_group.add("--fpcore", o->fpcore, "Print t as FPCore 2.0, for Herbie and FPBench");
    output_group.add("--c", o->c, "Print a C program that reproduces t to the bit (docs/explain.md)");
    command.runs([o, &common] { return run(*o, common); });
}

}  // namespace lostbits::analysis
