#include "analysis/selection/ray_file_options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <string_view>

#include "analysis/selection/select.hpp"
#include "number/error.hpp"
#include "scene/ray_file/number_parser.hpp"
#include "scene/rays/rays.hpp"
#include "shapes/number_names.hpp"

namespace lostbits::analysis::selection {

using scene::ray_file::Container;
using scene::ray_file::MissRule;
using scene::ray_file::ReadOptions;

namespace {

std::optional<MissRule> parse_miss_rule(const std::string& text) {
    if (text.empty()) return {};
    if (text == "never") return MissRule{MissRule::Kind::never};
    if (text == "negative") return MissRule{MissRule::Kind::negative};
    const auto parsed = scene::ray_file::NumberParser(*find_format("f64")).read(text);
    if (parsed.kind != scene::ray_file::NumberParser::Kind::number || !std::isfinite(parsed.value))
        throw InputError(
            fmt::format("--miss {}: is not a finite number, `negative` or `never` (NaN, infinities and empty cells "
                        "are misses in any case)",
                        text));
    return MissRule{MissRule::Kind::number, parsed.value};
}

std::vector<std::string> to_strings(std::span<const std::string_view> names) { return {names.begin(), names.end()}; }

}  // namespace

const std::vector<RayFileOption>& ray_file_options() {
    using Options = RayFileOptions;
    static const std::vector<RayFileOption> options{
        // The rays.
        {"--scene", &Options::scene, "Test the rays with the primitives of this scene"},
        {"--miss", &Options::miss,
         "The t that means a miss: a number, every negative t, or none; for a file without a column hit"},

        // The contract of the answers.
        {"--direction",
         &Options::direction,
         "any: t is the parameter along the direction (default); unit: t is a distance",
         {"any", "unit"},
         true},
        {"--touching",
         &Options::touching,
         "The right answer for a ray that only touches the primitive (default: hit)",
         {"hit", "miss"},
         true},
        {"--at-origin", &Options::at_origin, "The right answer for a ray that starts on the surface (default: hit)",
         to_strings(intersect::at_origin_names), true},
        {"--inside", &Options::inside,
         "The right answer for a ray that starts inside (default: usual, which is zero for a box and exit for "
         "every other shape with an inside)",
         to_strings(intersect::inside_names), true},
        {"--facing", &Options::facing, "The side from which triangles, discs and planes are hit (default: both)",
         to_strings(intersect::facing_names), true},

        // The ends of the range of each ray.
        {"--open-ends",
         &Options::open_ends,
         "Exclude these ends of the range: a hit exactly at an excluded end does not count (default: none)",
         {"none", "tmin", "tmax", "both"}}};
    return options;
}

void add_ray_options(const shell::Command& command, RayFileOptions& options) {
    const char* const heading = "Files of rays (docs/judge.md)";
    command
        .add("--container", options.container, "Kind of the file (default: by its ending)",
             shell::one_of({"auto", "csv", "npy", "raw"}))
        .under_heading(heading);
    command
        .add("--columns", options.columns,
             "Names of the columns, if the file does not name them; with types for raw numbers: ox:f32,oy,oz")
        .under_heading(heading);
    command.add("--skip", options.skip, "Number of bytes in front of raw numbers").under_heading(heading);
    command
        .add("--answer-format", options.answer_format,
             "Number format that the answers were computed in (default: the format of the file, f64 for CSV)")
        .under_heading(heading);
    options.primitives.add_to(command, "Primitives of all rays");
    for (const RayFileOption& option : ray_file_options())
        command
            .add(option.name, options.*option.value, option.help,
                 option.allowed_values.empty() ? shell::ValueRule() : shell::one_of(option.allowed_values))
            .under_heading(heading);
}

std::optional<scene::file::Scene> load_scene_of_rays(const RayFileOptions& options,
                                                     const std::filesystem::path& data_folder) {
    if (options.scene.empty()) return {};
    auto scene = load_one_scene({{options.scene}, "", "", {}, options.stop}, data_folder);
    constexpr std::size_t max_primitives = 1024;
    const std::size_t beside_meshes = scene.primitive_count() - (scene.mesh ? scene.mesh->faces.size() : 0);
    if (beside_meshes > max_primitives)
        throw InputError(
            fmt::format("--scene {}: has {} primitives besides its meshes; every ray is tested with each of them, and "
                        "at most {} are allowed; give each ray the primitive that it meets in columns of the file, or "
                        "write the scene as a mesh of triangles",
                        options.scene, beside_meshes, max_primitives));
    return scene;
}

std::optional<Shape> shared_shape(const RayFileOptions& options, const std::optional<scene::file::Scene>& scene) {
    const auto shapes = scene ? scene->shapes() : options.primitives.shapes();
    if (scene && !options.primitives.empty())
        throw InputError("--scene " + options.scene + ": gives the primitives of all rays, but " +
                         options.primitives.names() + " gives primitives too; leave out one of the two");
    return shapes.empty() ? std::nullopt : std::optional(shapes.front());
}

std::vector<Primitive<double>> shared_primitives(const RayFileOptions& options,
                                                 const std::optional<scene::file::Scene>& scene, const Format& format) {
    if (scene) return scene::rays::make_stored_primitives_beside_mesh(*scene, format.parameters);
    std::vector<Primitive<double>> primitives;
    for (const auto& [shape, text] : options.primitives.in_given_order())
        primitives.push_back(parse_primitive(shape, text, format));
    return primitives;
}

std::unique_ptr<scene::ray_file::RayFile> open_file(const RayFileOptions& options, const std::string& file,
                                                    std::optional<Shape> primitive, bool keeps_own_columns) {
    static const std::map<std::string, Container> containers{
        {"auto", Container::by_name}, {"csv", Container::csv}, {"npy", Container::npy}, {"raw", Container::raw}};
    ReadOptions read_options{.container = containers.at(options.container),
                             .columns = options.columns,
                             .skip = options.skip,
                             .stop = options.stop};

    if (containers.contains(options.answer_format))
        throw InputError(
            "--answer-format " + options.answer_format +
            ": this is a kind of file, and --answer-format is the number format of its answers; for the kind "
            "of file see --container");
    if (!options.answer_format.empty()) {
        const auto formats = select_formats({options.answer_format}, "--answer-format");
        if (formats.size() > 1)
            throw InputError("--answer-format " + options.answer_format +
                             ": all answers have the same format; name one");
        read_options.format = formats.front();
    }

    read_options.miss = parse_miss_rule(options.miss);
    read_options.primitive = primitive;
    read_options.keeps_own_columns = keeps_own_columns;
    read_options.open_ends = open_ends_named(options.open_ends);
    return scene::ray_file::open_ray_file(file, read_options);
}

Shapes shapes_of_rays(const scene::ray_file::Layout& layout, const std::vector<Primitive<double>>& shared) {
    const Shapes shapes = layout.primitive_shape() ? Shapes(*layout.primitive_shape()) : shapes_of(shared);
    return layout.has_matrix() ? shapes.with_transform() : shapes;
}

void transform_by_records(scene::ray_file::RayFile& ray_file, const std::vector<Primitive<double>>& shared) {
    if (!ray_file.layout().has_matrix() || ray_file.layout().primitive_shape()) return;
    if (shared.size() != 1 || shared.front().transform)
        throw InputError(
            ray_file.name() +
            ": each ray has the matrix of its primitive, m00 to m23; give one primitive for all rays, without a "
            "matrix of its own, or give the primitive of each ray in columns too");
    ray_file.transform_by_records(shared.front());
}

intersect::Info answer_contract(const RayFileOptions& options, const scene::ray_file::RayFile& ray_file) {
    for (const RayFileOption& option : ray_file_options())
        if (option.is_about_answers && option.is_given(options) &&
            ray_file.layout().answer_kind() == scene::ray_file::AnswerKind::none)
            throw InputError(
                fmt::format("{} {}: is about the answers of {}, which has none (columns hit or t); leave {} out: forms "
                            "are judged by their own contract",
                            option.name, options.*option.value, ray_file.name(), option.name));

    intersect::Info info{};
    info.direction = options.direction == "unit" ? intersect::Direction::unit : intersect::Direction::any;
    info.touching = options.touching == "miss" ? intersect::Touching::miss : intersect::Touching::hit;
    const auto index_of = [](const auto& names, const std::string& word) {
        return std::ranges::find(names, word) - names.begin();
    };
    info.at_origin = static_cast<intersect::AtOrigin>(index_of(intersect::at_origin_names, options.at_origin));
    info.inside = static_cast<intersect::Inside>(index_of(intersect::inside_names, options.inside));
    info.facing = static_cast<intersect::Facing>(index_of(intersect::facing_names, options.facing));
    return info;
}

std::optional<std::size_t> group_column(const JudgeOptions& options, const scene::ray_file::Layout& layout) {
    if (options.by.empty()) return {};
    const auto own_columns = layout.kept_columns();
    const auto found = std::ranges::find(own_columns, options.by);
    if (found != own_columns.end()) return static_cast<std::size_t>(found - own_columns.begin());
    throw InputError(fmt::format("--by {}: {} has no column of its own with that name; {}", options.by, options.file,
                                 own_columns.empty() ? "all its columns belong to the ray, its primitive or the answer"
                                                     : fmt::format("it has {}", fmt::join(own_columns, ", "))));
}

void add_requirement(const JudgeOptions& options, measure::metric::MetricSet& metric_set,
                     std::vector<const measure::metric::Metric*>& metrics) {
    std::vector<std::string> metric_names;
    if (options.bits >= 0) metric_names.push_back(fmt::format("enough_bits:{}", options.bits));
    if (!options.tolerance.empty())
        metric_names.insert(
            metric_names.end(),
            {"distance_error", fmt::format("tolerance:{}", tolerance_in_units(options.tolerance, options.unit))});
    else if (!options.unit.empty())
        throw InputError("--unit " + options.unit + ": is the unit of --tolerance, which is missing; write both");
    for (const measure::metric::Metric* m : select_metrics(metric_names, metric_set)) append_if_missing(metrics, m);
}

}  // namespace lostbits::analysis::selection
