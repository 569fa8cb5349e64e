#include "analysis/selection/ray_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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
#include "scene/toml/counted.hpp"
#include "scene/toml/did_you_mean.hpp"
#include "scene/toml/round.hpp"
#include "shapes/number_names.hpp"

namespace lostbits::analysis::selection {

using measure::answer::OneRay;
using measure::evaluate::TestedForm;
using scene::file::Scene;
using scene::rays::RayGroup;

namespace {

/// The format of `--as`; nothing without it.
std::optional<Format> format_of(const std::string& as) {
    return as.empty() ? std::nullopt : std::optional(select_formats({as}, "--as").front());
}

Ray<double> stored(const Ray<Real>& ray) {
    const auto of = [](const Vec<Real>& v) {
        return Vec<double>(stored_number(v.x), stored_number(v.y), stored_number(v.z));
    };
    return {of(ray.origin), of(ray.direction)};
}

/// Parses --ray. With primitives given as options, the numbers need not be a proper ray (NaN, a zero direction), as in
/// a file of cases: the answer of a form to such a ray is explained too.
Ray<Real> given_ray(const RayOptions& words) {
    const bool own = words.subject.empty();
    const auto x = numbers_of(
        words.ray, {"--ray", "a ray; write origin and direction, six numbers with commas between them", 6, own},
        format_of(words.as));
    const Ray<Real> ray{{x[0], x[1], x[2]}, {x[3], x[4], x[5]}};
    if (!own && !measure::truth::is_proper(stored(ray)))
        throw InputError("--ray " + words.ray + " is not a ray; its numbers must be finite and its direction not zero");
    return ray;
}

/// The row for these primitives; the form gets the usual transform if they are placed by matrices. Throws InputError if
/// the form does not take them.
template <class Meets>
TestedForm row_for(const TestedForm& row, const std::string& where, const Meets& meets) {
    const Shape shape = row.form->shape;
    if (meets(row.form->shapes())) return row;
    if (is_primitive(shape) && !row.form->is_set() && !scene::rays::generator_of(*row.form) &&
        meets(row.form->shapes().placed())) {
        TestedForm placed = row;
        placed.form = &intersect::transform::through(intersect::transform::usual_transform_method(), *row.form);
        return placed;
    }
    if (row.form->shapes().are_placed() && meets(row.form->shapes().placed(false)))
        throw InputError(fmt::format(
            "-i {}: no primitive of {} is placed by a matrix, so a transform has nothing to do; leave out the @ and "
            "the transform",
            row.form->info->name, where));
    if (is_primitive(shape) && several_shapes(meets)) {
        std::vector<TestedForm> parts{row};
        for (const auto* const part : row.form->parts) parts.push_back({part, row.format});
        throw InputError(fmt::format("-i {}: {}{}", row.form->info->name, where, fitting_forms_advice(parts, meets)));
    }
    const std::string lacks =
        is_primitive(shape) ? fmt::format("no primitives for it: it is a form for {}", plurals(row.form->shapes()))
                            : "no [march] table, which the forms of sdf.* need";
    throw InputError(fmt::format("-i {}: {} has {}; try -i '{}'", row.form->info->name, where, lacks, globs_of(meets)));
}

/// Loads the scene. Throws InputError if its file has variants and none is named.
Scene load_one(const RayOptions& words, const std::filesystem::path& data) {
    const scene::file::SceneName name = scene::file::find_scene(words.subject, data);
    scene::file::LoadOptions options{.variant = name.variant, .stop = words.stop};
    if (!words.variant.empty()) options.variant = words.variant;
    if (!words.size.empty()) options.size = parse_size(words.size);
    for (const auto& s : words.set) options.overrides.push_back(scene::toml::parse_override(s));
    auto scenes = scene::file::load_scene(name.path, options);
    if (scenes.size() != 1)
        throw InputError(words.subject + ": has several variants; name one, such as " + scenes.front().id);
    return std::move(scenes.front());
}

OneRay pixel_of(const RayOptions& words, const Scene& scene) {
    const auto [x, y] = pixel_named(words.pixel);
    return {scene, x, y, {.stop = words.stop}};
}

SelectedRay of_scene(const RayOptions& words, const TestedForm& given, const std::filesystem::path& data) {
    const auto* const generator = scene::rays::generator_of(*given.form);
    if (generator && !words.ray.empty())
        throw InputError(fmt::format(
            "-i {}: the part after the @ is a camera's ray generator, but no camera makes the ray of --ray; "
            "give --pixel instead of --ray, or leave out the @ and the ray generator",
            given.form->info->name));
    Scene loaded = load_one(words, data);
    const auto scene =
        std::make_shared<const Scene>(generator ? with_rays(std::move(loaded), *generator) : std::move(loaded));
    const TestedForm row = row_for(given, "scene " + scene->id, [&](Shapes forms) { return scene->meets(forms); });
    std::vector<std::string> options;
    if (words.worst) options.emplace_back("--worst");
    if (!words.pixel.empty()) options.emplace_back("--pixel");
    if (!words.ray.empty()) options.emplace_back("--ray");
    if (options.size() > 1)
        throw InputError(fmt::format("explain: {} each name a ray; give only one", output::file::enumerated(options)));
    if (options.empty())
        throw InputError(
            "explain: the ray is missing; give --worst or --pixel X,Y for a scene, --ray OX,OY,OZ,DX,DY,DZ, or --case "
            "NAME "
            "for a file of cases");
    if (words.worst) return worst_of_scene(scene, row, words.stop);
    return {scene,
            words.ray.empty() ? pixel_of(words, *scene) : OneRay(*scene, given_ray(words), {.stop = words.stop}),
            row.form,
            {},
            words.ray.empty() ? std::optional(pixel_named(words.pixel)) : std::nullopt};
}

/// A case, and a ray of it: NAME or NAME:K. A text that is itself the name of a case names no ray.
struct NamedRay {
    std::size_t number;
    std::optional<int> ray;
};

NamedRay named_ray(const scene::sweep::CaseFile& file, const std::string& text) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < file.size(); ++i) names.push_back(file.name(i));
    const auto place = [&](const std::string& name) {
        return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
    };
    if (const std::size_t whole = place(text); whole < names.size()) return {whole, {}};
    const auto colon = std::min(text.rfind(':'), text.size());
    const std::string name = text.substr(0, colon), digits = colon < text.size() ? text.substr(colon + 1) : "";
    const bool counts = !digits.empty() && digits.size() < 8 &&
                        std::ranges::all_of(digits, [](char c) { return c >= '0' && c <= '9'; });
    if (const std::size_t found = place(name); counts && found < names.size()) return {found, std::stoi(digits)};
    throw InputError(fmt::format("--case {}: {} has no case of that name; {}", text, file.id,
                                 scene::toml::did_you_mean(counts ? name : text, names)));
}

/// The convention to judge by: that of --convention, else each form's own if the file has it, else the file's first.
std::optional<intersect::Touching> judged_of(const RayOptions& words, const scene::sweep::CaseFile& file) {
    if (!words.convention.empty()) return scene::sweep::convention_named(words.convention);
    const bool own = std::ranges::any_of(file.conventions, [](const auto& judged) { return !judged; });
    return own ? std::nullopt : file.conventions[0];
}

/// The worst of all rays of a sweep. --size, --steps and --set change the sweep as in `lostbits sweep`.
SelectedRay worst_of_sweep(const RayOptions& words, TestedForm row, const std::filesystem::path& path,
                           const std::filesystem::path& data) {
    using scene::sweep::SweepKind;
    const SweepKind kind = scene::sweep::sweep_kind(path);
    for (const auto& [given, option, why] :
         {std::tuple{&words.pixel, "--pixel", "names one ray, but --worst searches all of them"},
          {&words.ray, "--ray", "names one ray, but --worst searches all of them"},
          {&words.variant, "--variant", "is for a scene, but a sweep names its own"}}) {
        if (!given->empty()) throw InputError(fmt::format("{} {} {}; leave out {}", option, *given, why, option));
    }
    const SweepChangeOptions changes{words.size, words.steps, words.set};
    if (kind == SweepKind::cases || kind == SweepKind::axes) check_changes(changes, kind, words.subject);
    if (kind == SweepKind::cases) {
        const scene::sweep::CaseFile file(path);
        row = row_for(row, "the file of cases " + file.id, [&](Shapes forms) { return file.meets(forms); });
        row.judged = judged_of(words, file);
        return worst_of_cases(file, row, words.stop);
    }
    if (kind != SweepKind::axes)
        throw InputError("--worst: " + words.subject +
                         " is a sweep over every float, or a search, which takes long; run `lostbits sweep` on it: its "
                         "tables have the command that explains the worst ray");
    const scene::sweep::SweepFile sweep(path, data, read_changes(changes), words.stop);
    row = row_for(row, "the sweep " + sweep.id, [&](Shapes forms) { return sweep.meets(forms); });
    row.judged = words.convention.empty() ? sweep.convention : scene::sweep::convention_named(words.convention);
    return worst_along(sweep, row, words.stop);
}

SelectedRay of_case(const RayOptions& words, TestedForm row, const std::filesystem::path& data) {
    const auto path = scene::sweep::find_sweep(words.subject, data);
    if (scene::sweep::sweep_kind(path) != scene::sweep::SweepKind::cases)
        throw InputError(
            words.subject +
            ": has no [[case]] tables for --case; use --worst for its worst ray, or a command in the column "
            "worst_explain of its samples.csv");
    const scene::sweep::CaseFile file(path);
    row = row_for(row, "the file of cases " + file.id, [&](Shapes forms) { return file.meets(forms); });
    const auto [number, asked] = named_ray(file, words.named_case);
    row.judged = judged_of(words, file);
    const int rays = file.rays_of(number);
    auto groups = file.rays(number, row.format.parameters);
    const int count = rays * static_cast<int>(groups.size());
    if (asked && *asked >= count)
        throw InputError(fmt::format("--case {}: the case has {}, counted from 0", words.named_case,
                                     scene::toml::counted(count, "ray")));
    const int k = asked ? *asked : worst_of(groups, rays, row, words.stop);
    SelectedRay found{
        nullptr, OneRay(ray_of(std::move(groups), rays, k)), row.form,
        fmt::format("Case \"{}\", ray {} of {}{}.\n", file.name(number), k, count,
                    asked || count == 1 ? " (counted from 0)" : " (counted from 0), the worst of them for this form")};
    found.ray.judge_by(row.judged);
    return found;
}

/// The constants of a march: those of `--set march.…`, else the defaults of a scene. Numbers are rounded to binary64.
intersect::MarchConstants<double> march_of(const std::vector<std::string>& set) {
    scene::toml::Node root, table;
    root.kind = table.kind = scene::toml::Node::Kind::table;
    root.entries.push_back({"march", {}, table});
    for (const std::string& s : set) {
        const scene::toml::Override change = scene::toml::parse_override(s);
        if (!change.path.starts_with("march."))
            throw InputError("--set " + s + ": no scene was given, so only march.KEY can be set");
        scene::toml::apply_override(root, change);
    }
    scene::toml::TableReader file(root);
    return scene::file::round_march(scene::file::read_march(file.table("march"), scene::file::Inputs::own), binary64);
}

/// Throws InputError if the range of a ray contains no t, as for `[rays]` of a scene.
void require_range(const RayOptions& words, const Range<double>& range) {
    if (!(range.tmin >= 0 && range.tmin < HUGE_VAL))
        throw InputError("--tmin " + words.tmin +
                         " is not a start of a range; write a finite t of at least 0, or leave --tmin out for 0");
    if (std::isnan(range.tmax))
        throw InputError("--tmax " + words.tmax +
                         " is not a t; write the t at which the ray ends, or leave --tmax out for a ray without end");
    if (range.holds_any()) return;
    const std::string options = (words.tmin.empty() ? "" : "--tmin " + words.tmin + " ") + "--tmax " + words.tmax +
                                (words.open_ends.empty() ? "" : " --open-ends " + words.open_ends);
    throw InputError(options +
                     ": leaves no t between tmin and tmax; write a tmax above tmin, or leave out --tmin or --tmax");
}

SelectedRay of_own_primitives(const RayOptions& words, const TestedForm& given) {
    std::vector<Primitive<double>> primitives;
    for (const auto& [shape, text] : words.primitives.given())
        primitives.push_back(primitive_phrase(shape, text, format_of(words.as)));
    const bool placed =
        std::ranges::any_of(primitives, [](const auto& primitive) { return primitive.placed.has_value(); });
    const auto is_for = [&given](const Primitive<double>& primitive) {
        return given.form->shapes().has(primitive.shape);
    };
    const TestedForm row = std::ranges::all_of(primitives, is_for) && placed == given.form->shapes().are_placed()
                               ? given
                               : row_for(given, "the ray", [of = shapes_of(primitives).placed(placed)](Shapes forms) {
                                     return (forms == Shape::sdf && !of.are_placed()) || forms == of;
                                 });
    if (words.ray.empty()) throw InputError("explain: the ray is missing; give --ray OX,OY,OZ,DX,DY,DZ");
    const Ray<Real> ray = given_ray(words);
    RayGroup one = scene::rays::group_of(stored(ray));
    one.primitives = std::move(primitives);
    const auto put_end = [&](const std::string& text, const char* option, const char* what, std::vector<double>& to) {
        if (!text.empty())
            to.push_back(stored_number(numbers_of(text, {option, what, 1, true}, format_of(words.as))[0]));
    };
    put_end(words.tmin, "--tmin", "a start of a range; write one number", one.rays.tmin);
    put_end(words.tmax, "--tmax", "an end of a range; write one number", one.rays.tmax);
    one.rays.open = open_ends_named(words.open_ends);
    require_range(words, one.rays.range(0));
    one.march = march_of(words.set);
    return {nullptr, OneRay(std::move(one)), row.form};
}

/// Throws InputError for options that do not go together.
void check(const RayOptions& words) {
    const bool own = !words.primitives.empty(), a_case = !words.named_case.empty(), a_scene = !own && !a_case;
    if (own && !words.subject.empty())
        throw InputError(words.subject + ": a scene has its own primitives; leave out the scene, or leave out " +
                         words.primitives.names());
    if (!own && words.subject.empty())
        throw InputError(
            "explain: the primitives are missing; name a scene, a file of cases with --case, or primitives (--sphere "
            "CX,CY,CZ,R; other shapes: `lostbits explain --help`)");
    const char* const own_primitives = "primitives given as options (for a scene, --set rays.tmin=VALUE)";
    struct Row {
        const char* option;
        bool given, fits;
        const char* needs;
    };
    const Row rows[] = {
        {"--as", !words.as.empty(), !words.ray.empty(), "--ray, whose numbers it rounds"},
        {"--tmin", !words.tmin.empty(), own, own_primitives},
        {"--tmax", !words.tmax.empty(), own, own_primitives},
        {"--open-ends", !words.open_ends.empty(), own, own_primitives},
        {"--size", !words.size.empty(), words.ray.empty() || own, "--pixel (a ray of --ray belongs to no picture)"},
        {"--worst", words.worst, a_scene, "a scene or a sweep, whose rays it searches"},
        {"--pixel", !words.pixel.empty(), a_scene, "a scene"},
        {"--size", !words.size.empty(), a_scene, "a scene"},
        {"--variant", !words.variant.empty(), a_scene, "a scene"},
        {"--case", a_case, !own, "a file of cases"},
        {"--ray", !words.ray.empty(), own || a_scene,
         "a scene, or primitives given as options (a case has its own rays)"},
        {"--steps", !words.steps.empty(), a_scene, "a sweep and --worst"},
        {"--set", !words.set.empty(), own || a_scene, "a scene, or primitives given as options"}};
    for (const Row& row : rows)
        if (row.given && !row.fits)
            throw InputError(fmt::format("{} needs {}; add it, or leave {} out", row.option, row.needs, row.option));
}

}  // namespace

std::optional<std::filesystem::path> sweep_named(const std::string& subject, const std::filesystem::path& data) {
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

SelectedRay find_ray(const RayOptions& words, const TestedForm& row, const std::filesystem::path& data) {
    check(words);
    for (const std::string& set : words.set) {
        if (set.starts_with("march.") && is_primitive(row.form->shape))
            throw InputError(
                fmt::format("--set {}: {} does not march, so nothing would change; leave out --set, or name a "
                            "form of sdf.*",
                            set, row.form->info->name));
    }
    if (!words.named_case.empty()) return of_case(words, row, data);
    if (const auto sweep = words.worst ? sweep_named(words.subject, data) : std::nullopt)
        return worst_of_sweep(words, row, *sweep, data);
    TestedForm judged = row;
    judged.judged = scene::sweep::convention_named(words.convention);
    if (!words.steps.empty())
        throw InputError("--steps " + words.steps +
                         " is for the worst ray of a sweep; add --worst, or leave --steps out");
    SelectedRay found = words.subject.empty() ? of_own_primitives(words, row) : of_scene(words, judged, data);
    found.ray.judge_by(judged.judged);
    return found;
}

void PrimitiveOptions::add_to(const shell::Command& command, const std::string& heading) {
    std::vector<shell::Option> options;
    for (const ShapeRow& row : shape_rows)
        options.push_back(command
                              .add(fmt::format("--{}", row.name), of(row.shape),
                                   fmt::format("{}: {}", with_article(row.shape), option_placeholder(row.shape)))
                              .below(heading));
    order_ = command.order_of(options);
}

}  // namespace lostbits::analysis::selection
