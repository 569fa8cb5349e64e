#include "analysis/selection/ray_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <tuple>

#include "analysis/selection/ray_numbers.hpp"
#include "analysis/selection/select.hpp"
#include "analysis/selection/sweep_options.hpp"
#include "intersect/transform/transformed_form.hpp"
#include "number/error.hpp"
#include "number/real.hpp"
#include "output/file/number_text.hpp"
#include "scene/file/march_table.hpp"
#include "scene/rays/composed_forms.hpp"
#include "scene/sweep/case_file.hpp"
#include "scene/sweep/sweep_file.hpp"
#include "scene/sweep/sweep_head.hpp"
#include "scene/toml/round.hpp"
#include "shapes/number_names.hpp"
#include "text/count_with_noun.hpp"
#include "text/did_you_mean.hpp"

namespace lostbits::analysis::selection {

using measure::answer::OneRay;
using measure::evaluate::TestedForm;
using scene::file::Scene;
using scene::rays::RayGroup;

namespace {

/// The format of `--as`; nothing without it.
std::optional<Format> rounding_format(const std::string& name) {
    return name.empty() ? std::nullopt : std::optional(select_formats({name}, "--as").front());
}

Ray<double> to_double_ray(const Ray<Real>& ray) {
    const auto to_doubles = [](const Vec<Real>& v) {
        return Vec<double>(stored_number(v.x), stored_number(v.y), stored_number(v.z));
    };
    return {to_doubles(ray.origin), to_doubles(ray.direction)};
}

/// Parses --ray. With primitives given as options, the numbers need not be a proper ray (NaN, a zero direction), as in
/// a file of cases: the answer of a form to such a ray is explained too.
Ray<Real> parse_ray(const RayOptions& options) {
    const bool has_own_primitives = options.subject.empty();
    const auto x = parse_numbers(
        options.ray,
        {"--ray", "a ray; write origin and direction, six numbers with commas between them", 6, has_own_primitives},
        rounding_format(options.format));
    const Ray<Real> ray{{x[0], x[1], x[2]}, {x[3], x[4], x[5]}};
    if (!has_own_primitives && !measure::truth::is_valid(to_double_ray(ray)))
        throw InputError("--ray " + options.ray +
                         ": is not a ray; its numbers must be finite and its direction not zero");
    return ray;
}

/// The tested form for these primitives; it gets the usual transform method if the primitives have transforms. Throws
/// InputError if the form does not take the primitives.
template <class ShapePredicate>
TestedForm tested_form_for_primitives(const TestedForm& tested_form, const std::string& subject,
                                      const ShapePredicate& can_test) {
    const Shape shape = tested_form.form->shape;
    if (can_test(tested_form.form->shapes())) return tested_form;

    if (is_primitive(shape) && !tested_form.form->is_set() && !scene::rays::generator_of(*tested_form.form) &&
        can_test(tested_form.form->shapes().with_transform())) {
        TestedForm transformed = tested_form;
        transformed.form = &intersect::transform::transformed_form(intersect::transform::default_transform_method(),
                                                                   *tested_form.form);
        return transformed;
    }

    // Says why the form does not take the primitives.
    if (tested_form.form->shapes().have_transform() && can_test(tested_form.form->shapes().with_transform(false)))
        throw InputError(fmt::format(
            "-i {}: no primitive of {} has a transform, so FORM@TRANSFORM makes no sense here; leave out the @ and "
            "the transform",
            tested_form.form->info->name, subject));
    if (is_primitive(shape) && several_shapes(can_test)) {
        std::vector<TestedForm> parts{tested_form};
        for (const auto* const part : tested_form.form->parts) parts.push_back({part, tested_form.format});
        throw InputError(
            fmt::format("-i {}: {}{}", tested_form.form->info->name, subject, forms_advice(parts, can_test)));
    }
    const std::string missing_part = is_primitive(shape) ? fmt::format("no primitives for it: it is a form for {}",
                                                                       plurals(tested_form.form->shapes()))
                                                         : "no [march] table, which the forms of sdf.* need";
    throw InputError(fmt::format("-i {}: {} has {}; try -i '{}'", tested_form.form->info->name, subject, missing_part,
                                 patterns_for(can_test)));
}

/// Loads the scene. Throws InputError if its file has variants and none is named.
Scene load_single_scene(const RayOptions& options, const std::filesystem::path& data) {
    const scene::file::SceneName name = scene::file::find_scene(options.subject, data);
    scene::file::LoadOptions load_options{.variant = name.variant, .stop = options.stop};
    if (!options.variant.empty()) load_options.variant = options.variant;
    if (!options.size.empty()) load_options.size = parse_size(options.size);
    for (const auto& assignment : options.set)
        load_options.overrides.push_back(scene::toml::parse_override(assignment));
    auto scenes = scene::file::load_scene(name.path, load_options);
    if (scenes.size() != 1)
        throw InputError(options.subject + ": has several variants; name one, such as " + scenes.front().id);
    return std::move(scenes.front());
}

OneRay select_pixel(const RayOptions& options, const Scene& scene) {
    const auto [x, y] = parse_pixel(options.pixel);
    return {scene, x, y, {.stop = options.stop}};
}

SelectedRay find_ray_in_scene(const RayOptions& options, const TestedForm& given_form,
                              const std::filesystem::path& data) {
    const auto* const generator = scene::rays::generator_of(*given_form.form);
    if (generator && !options.ray.empty())
        throw InputError(fmt::format(
            "-i {}: the part after the @ is a camera's ray generator, but no camera makes the ray of --ray; "
            "give --pixel instead of --ray, or leave out the @ and the ray generator",
            given_form.form->info->name));

    Scene loaded = load_single_scene(options, data);
    const auto scene = std::make_shared<const Scene>(generator ? with_ray_generator(std::move(loaded), *generator)
                                                               : std::move(loaded));
    const TestedForm tested_form = tested_form_for_primitives(given_form, "scene " + scene->id,
                                                              [&](Shapes forms) { return scene->accepts(forms); });

    // Exactly one option names the ray.
    std::vector<std::string> given_options;
    if (options.worst) given_options.emplace_back("--worst");
    if (!options.pixel.empty()) given_options.emplace_back("--pixel");
    if (!options.ray.empty()) given_options.emplace_back("--ray");
    if (given_options.size() > 1)
        throw InputError(
            fmt::format("explain: {} each name a ray; give only one", output::file::word_list(given_options)));
    if (given_options.empty())
        throw InputError(
            "explain: the ray is missing; give --worst or --pixel X,Y for a scene, --ray OX,OY,OZ,DX,DY,DZ, or --case "
            "NAME for a file of cases");

    if (options.worst) return find_worst_in_scene(scene, tested_form, options.stop);
    return {scene,
            options.ray.empty() ? select_pixel(options, *scene)
                                : OneRay(*scene, parse_ray(options), {.stop = options.stop}),
            tested_form.form,
            {},
            options.ray.empty() ? std::optional(parse_pixel(options.pixel)) : std::nullopt};
}

/// A case, and a ray of it: NAME or NAME:K. A text that is itself the name of a case names no ray.
struct NamedRay {
    std::size_t case_index;
    std::optional<int> ray;
};

NamedRay parse_named_ray(const scene::sweep::CaseFile& file, const std::string& text) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < file.size(); ++i) names.push_back(file.name(i));
    const auto index_of = [&](const std::string& name) {
        return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
    };
    if (const std::size_t whole = index_of(text); whole < names.size()) return {whole, {}};
    const auto colon = std::min(text.rfind(':'), text.size());
    const std::string name = text.substr(0, colon), digits = colon < text.size() ? text.substr(colon + 1) : "";
    const bool has_index = !digits.empty() && digits.size() < 8 &&
                           std::ranges::all_of(digits, [](char c) { return c >= '0' && c <= '9'; });
    if (const std::size_t found = index_of(name); has_index && found < names.size()) return {found, std::stoi(digits)};

    // A part of a name is enough for a suggestion: `ray 134`.
    const std::string& word = has_index ? name : text;
    std::vector<std::string> alike;
    std::ranges::copy_if(names, std::back_inserter(alike),
                         [&word](const std::string& n) { return n.find(word) != std::string::npos; });
    throw InputError(fmt::format("--case {}: {} has no case of that name; {}", text, file.id,
                                 alike.size() == 1
                                     ? fmt::format("did you mean {}?", text::quoted_excerpt(alike.front()))
                                     : text::did_you_mean(word, names)));
}

/// The convention to judge by: that of --convention, else each form's own if the file has it, else the file's first.
std::optional<intersect::Touching> judging_convention(const RayOptions& options, const scene::sweep::CaseFile& file) {
    if (!options.convention.empty()) return scene::sweep::convention_named(options.convention);
    const bool allows_own_convention =
        std::ranges::any_of(file.conventions, [](const auto& convention) { return !convention; });
    return allows_own_convention ? std::nullopt : file.conventions[0];
}

/// The worst of all rays of a sweep. --size, --steps and --set change the sweep as in `lostbits sweep`.
SelectedRay find_worst_of_sweep_or_cases(const RayOptions& options, TestedForm tested_form,
                                         const std::filesystem::path& path, const std::filesystem::path& data) {
    using scene::sweep::SweepKind;
    const SweepKind kind = scene::sweep::read_sweep_kind(path);
    for (const auto& [given, option, why] :
         {std::tuple{&options.pixel, "--pixel", "names one ray, but --worst searches all of them"},
          {&options.ray, "--ray", "names one ray, but --worst searches all of them"},
          {&options.variant, "--variant", "is for a scene, but a sweep names its own"}}) {
        if (!given->empty()) throw InputError(fmt::format("{} {}: {}; leave out {}", option, *given, why, option));
    }

    const SweepChangeOptions changes{options.size, options.steps, options.set};
    if (kind == SweepKind::cases || kind == SweepKind::axes) require_allowed_changes(changes, kind, options.subject);
    if (kind == SweepKind::cases) {
        const scene::sweep::CaseFile file(path);
        tested_form = tested_form_for_primitives(tested_form, "the file of cases " + file.id,
                                                 [&](Shapes forms) { return file.accepts(forms); });
        tested_form.touching = judging_convention(options, file);
        return find_worst_in_cases(file, tested_form, options.stop);
    }

    if (kind != SweepKind::axes)
        throw InputError("--worst: " + options.subject +
                         " is a sweep over every float, or a search, which takes long; run `lostbits sweep` on it: its "
                         "tables have the command that explains the worst ray");
    const scene::sweep::SweepFile sweep(path, data, read_changes(changes), options.stop);
    tested_form = tested_form_for_primitives(tested_form, "the sweep " + sweep.id,
                                             [&](Shapes forms) { return sweep.accepts(forms); });
    tested_form.touching =
        options.convention.empty() ? sweep.convention : scene::sweep::convention_named(options.convention);
    return find_worst_in_sweep(sweep, tested_form, options.stop);
}

SelectedRay find_ray_in_case(const RayOptions& options, TestedForm tested_form, const std::filesystem::path& data) {
    const auto path = scene::sweep::find_sweep(options.subject, data);
    if (scene::sweep::read_sweep_kind(path) != scene::sweep::SweepKind::cases)
        throw InputError(
            options.subject +
            ": has no [[case]] tables for --case; use --worst for its worst ray, or a command in the column "
            "worst_explain of its samples.csv");
    const scene::sweep::CaseFile file(path);
    tested_form = tested_form_for_primitives(tested_form, "the file of cases " + file.id,
                                             [&](Shapes forms) { return file.accepts(forms); });
    const auto [case_index, ray_index] = parse_named_ray(file, options.named_case);
    tested_form.touching = judging_convention(options, file);

    // Without an index, the worst ray of the case.
    const int ray_count = file.ray_count(case_index);
    auto groups = file.rays(case_index, tested_form.format.parameters);
    const int count = ray_count * static_cast<int>(groups.size());
    if (ray_index && *ray_index >= count)
        throw InputError(fmt::format("--case {}: the case has {}, counted from 0", options.named_case,
                                     text::count_with_noun(count, "ray")));
    const int k = ray_index ? *ray_index : find_worst_ray_index(groups, ray_count, tested_form, options.stop);
    SelectedRay found{nullptr, OneRay(pick_ray(std::move(groups), ray_count, k)), tested_form.form,
                      fmt::format("Case \"{}\", ray {} of {}{}.\n", file.name(case_index), k, count,
                                  ray_index || count == 1 ? " (counted from 0)"
                                                          : " (counted from 0), the worst of them for this form")};
    found.ray.set_touching(tested_form.touching);
    return found;
}

/// The constants of a march: those of `--set march.…`, else the defaults of a scene. Numbers are rounded to binary64.
intersect::MarchConstants<double> parse_march(const std::vector<std::string>& set) {
    scene::toml::Node root, table;
    root.kind = table.kind = scene::toml::Node::Kind::table;
    root.entries.push_back({"march", {}, table});
    for (const std::string& assignment : set) {
        const scene::toml::Override change = scene::toml::parse_override(assignment);
        if (!change.path.starts_with("march."))
            throw InputError("--set " + assignment + ": no scene was given, so only march.KEY can be set");
        scene::toml::apply_override(root, change);
    }
    scene::toml::TableReader reader(root);
    return scene::file::round_march(scene::file::read_march(reader.table("march"), scene::file::InputRounding::own),
                                    binary64);
}

/// Throws InputError if the range of a ray contains no t, as for `[rays]` of a scene.
void require_range(const RayOptions& options, const Range<double>& range) {
    if (!(range.tmin >= 0 && range.tmin < HUGE_VAL))
        throw InputError("--tmin " + options.tmin +
                         ": is not a start of a range; write a finite t of at least 0, or leave --tmin out for 0");
    if (std::isnan(range.tmax))
        throw InputError("--tmax " + options.tmax +
                         ": is not a t; write the t at which the ray ends, or leave --tmax out for a ray without end");
    if (range.holds_any()) return;
    const std::string text = (options.tmin.empty() ? "" : "--tmin " + options.tmin + " ") + "--tmax " + options.tmax +
                             (options.open_ends.empty() ? "" : " --open-ends " + options.open_ends);
    throw InputError(text +
                     ": leaves no t between tmin and tmax; write a tmax above tmin, or leave out --tmin or --tmax");
}

SelectedRay make_ray_from_options(const RayOptions& options, const TestedForm& given_form) {
    std::vector<Primitive<double>> primitives;
    for (const auto& [shape, text] : options.primitives.in_given_order())
        primitives.push_back(parse_primitive(shape, text, rounding_format(options.format)));

    // The form gets the usual transform method if the primitives have transforms.
    const bool have_transform =
        std::ranges::any_of(primitives, [](const auto& primitive) { return primitive.transform.has_value(); });
    const auto form_takes = [&given_form](const Primitive<double>& primitive) {
        return given_form.form->shapes().has(primitive.shape);
    };
    const TestedForm tested_form =
        std::ranges::all_of(primitives, form_takes) && have_transform == given_form.form->shapes().have_transform()
            ? given_form
            : tested_form_for_primitives(
                  given_form, "the ray", [shapes = shapes_of(primitives).with_transform(have_transform)](Shapes forms) {
                      return (forms == Shape::sdf && !shapes.have_transform()) || forms == shapes;
                  });

    if (options.ray.empty()) throw InputError("explain: the ray is missing; give --ray OX,OY,OZ,DX,DY,DZ");
    const Ray<Real> ray = parse_ray(options);
    RayGroup group = scene::rays::make_group(to_double_ray(ray));
    group.primitives = std::move(primitives);

    // The ends of its range.
    const auto add_end = [&](const std::string& text, const char* option, const char* expected,
                             std::vector<double>& ends) {
        if (!text.empty())
            ends.push_back(
                stored_number(parse_numbers(text, {option, expected, 1, true}, rounding_format(options.format))[0]));
    };
    add_end(options.tmin, "--tmin", "a start of a range; write one number", group.rays.tmin);
    add_end(options.tmax, "--tmax", "an end of a range; write one number", group.rays.tmax);
    group.rays.open_ends = open_ends_named(options.open_ends);
    require_range(options, group.rays.range(0));
    group.march = parse_march(options.set);
    return {nullptr, OneRay(std::move(group)), tested_form.form};
}

/// Throws InputError for options that cannot be combined.
void require_compatible(const RayOptions& options) {
    const bool has_own_primitives = !options.primitives.empty(), is_case = !options.named_case.empty(),
               is_scene = !has_own_primitives && !is_case;
    if (has_own_primitives && !options.subject.empty())
        throw InputError(options.subject + ": a scene has its own primitives; leave out the scene, or leave out " +
                         options.primitives.names());
    if (!has_own_primitives && options.subject.empty())
        throw InputError(
            "explain: the primitives are missing; name a scene, a file of cases with --case, or primitives (--sphere "
            "CX,CY,CZ,R; other shapes: `lostbits explain --help`)");

    // Requirements of each option.
    const char* const needs_own_primitives = "primitives given as options (for a scene, --set rays.tmin=VALUE)";
    struct Rule {
        const char* option;
        bool is_given, is_allowed;
        const char* needs;
    };
    const Rule rules[] = {
        {"--as", !options.format.empty(), !options.ray.empty(), "--ray, whose numbers it rounds"},
        {"--tmin", !options.tmin.empty(), has_own_primitives, needs_own_primitives},
        {"--tmax", !options.tmax.empty(), has_own_primitives, needs_own_primitives},
        {"--open-ends", !options.open_ends.empty(), has_own_primitives, needs_own_primitives},
        {"--size", !options.size.empty(), options.ray.empty() || has_own_primitives,
         "--pixel (a ray of --ray belongs to no picture)"},
        {"--worst", options.worst, is_scene, "a scene or a sweep, whose rays it searches"},
        {"--pixel", !options.pixel.empty(), is_scene, "a scene"},
        {"--size", !options.size.empty(), is_scene, "a scene"},
        {"--variant", !options.variant.empty(), is_scene, "a scene"},
        {"--case", is_case, !has_own_primitives, "a file of cases"},
        {"--ray", !options.ray.empty(), has_own_primitives || is_scene,
         "a scene, or primitives given as options (a case has its own rays)"},
        {"--steps", !options.steps.empty(), is_scene, "a sweep and --worst"},
        {"--set", !options.set.empty(), has_own_primitives || is_scene, "a scene, or primitives given as options"}};

    for (const Rule& rule : rules) {
        if (!rule.is_given || rule.is_allowed) continue;
        const bool needs_other_subject = has_own_primitives && std::string_view(rule.needs).starts_with("a scene");
        throw InputError(fmt::format("{}: needs {}; {}, or leave {} out", rule.option, rule.needs,
                                     needs_other_subject ? "name it in place of the options of primitives" : "add it",
                                     rule.option));
    }
}

}  // namespace

std::optional<std::filesystem::path> find_sweep_file(const std::string& subject, const std::filesystem::path& data) {
    if (std::filesystem::is_regular_file(subject)) {
        if (scene::sweep::is_sweep_file(subject)) return subject;
        return {};
    }
    if (std::filesystem::is_regular_file(data / "scenes" / (subject.substr(0, subject.find('.')) + ".toml"))) return {};
    try {
        return scene::sweep::find_sweep(subject, data);
    } catch (const InputError&) {
        return {};  // the search for a scene reports the error
    }
}

SelectedRay find_ray(const RayOptions& options, const TestedForm& tested_form, const std::filesystem::path& data) {
    require_compatible(options);
    for (const std::string& assignment : options.set) {
        if (assignment.starts_with("march.") && is_primitive(tested_form.form->shape))
            throw InputError(
                fmt::format("--set {}: {} does not march, so nothing would change; leave out --set, or name a "
                            "form of sdf.*",
                            assignment, tested_form.form->info->name));
    }

    // A case and the worst ray of a sweep have their own conventions.
    if (!options.named_case.empty()) return find_ray_in_case(options, tested_form, data);
    if (const auto sweep = options.worst ? find_sweep_file(options.subject, data) : std::nullopt)
        return find_worst_of_sweep_or_cases(options, tested_form, *sweep, data);

    TestedForm judged_row = tested_form;
    judged_row.touching = scene::sweep::convention_named(options.convention);
    if (!options.steps.empty())
        throw InputError("--steps " + options.steps +
                         ": is for the worst ray of a sweep; add --worst, or leave --steps out");
    SelectedRay found = options.subject.empty() ? make_ray_from_options(options, tested_form)
                                                : find_ray_in_scene(options, judged_row, data);
    found.ray.set_touching(judged_row.touching);
    return found;
}

void PrimitiveOptions::add_to(const shell::Command& command, const std::string& heading) {
    const std::string full_heading =
        heading + " (may be repeated; @MATRIX or @/INVERSE may follow, 12 numbers row by row)";
    std::vector<shell::Option> options;
    for (const ShapeRow& shape_row : shape_rows)
        options.push_back(
            command.add(fmt::format("--{}", shape_row.name), values_of(shape_row.shape), with_article(shape_row.shape))
                .under_heading(full_heading));
    order_ = command.make_value_order(options);
}

}  // namespace lostbits::analysis::selection
