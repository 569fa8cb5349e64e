#include "scene/sweep/sweep_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "intersect/table/table.hpp"
#include "number/error.hpp"
#include "number/real.hpp"
#include "scene/file/march_table.hpp"
#include "scene/rays/primitive_list.hpp"
#include "scene/sweep/distributions.hpp"
#include "scene/sweep/float_order.hpp"
#include "scene/toml/file_names.hpp"
#include "scene/toml/round.hpp"
#include "text/count_with_noun.hpp"

namespace lostbits::scene::sweep {

using rays::RayGroup;
using toml::round_to_12_bits;
using toml::TableReader;

namespace {

constexpr long long min_steps = 2, max_steps = 100000;

/// The ray distribution that a file names; null if it names none.
const DistributionRow* find_distribution(const toml::Node& root) {
    for (const DistributionRow& distribution_row : distributions())
        if (TableReader(root).has(distribution_row.table)) return &distribution_row;
    return nullptr;
}

void fill_values(Axis& axis, TableReader& table) {
    using S = Axis::Spacing;
    if (axis.spacing == S::every_float) {
        const FloatRange floats{index_of(static_cast<float>(axis.from)), index_of(static_cast<float>(axis.to))};
        if (floats.falls()) table.fail_at("to", "must be greater than from with spacing = \"every_float\"");
        if (floats.size() > max_steps)
            table.fail_at(
                "to",
                "leaves more than 100000 floats between from and to; bring them closer together, or try every float "
                "of one ray: see data/sweeps/exhaustive-distance.toml");
        for (std::uint64_t n = 0; n < floats.size(); ++n) {
            // A step is a value, and both zeros are the value 0. An [axis] of every float tries each zero.
            const double x = static_cast<double>(float_at(floats.at(n))) + 0.0;
            if (axis.values.empty() || x != axis.values.back()) axis.values.push_back(x);
        }
        return;
    }
    const long long steps = table.integer("steps", min_steps, max_steps);
    if (axis.spacing == S::log2 && (axis.from <= 0 || axis.to <= 0))
        table.fail_at("from", "and to must be positive with spacing = \"log2\"");
    for (long long i = 0; i < steps; ++i) {
        const Real fraction = Real(i) / Real(steps - 1);
        // Uses MPFR, because libm's exp2 and log2 differ between machines.
        const Real value = axis.spacing == S::log2
                               ? Real(Real(axis.from) * pow(Real(Real(axis.to) / Real(axis.from)), fraction))
                               : Real(Real(axis.from) + fraction * (Real(axis.to) - Real(axis.from)));
        const auto x = static_cast<double>(value);
        axis.values.push_back(axis.spacing == S::log2    ? round_to_12_bits(x)
                              : axis.spacing == S::whole ? std::nearbyint(x)
                                                         : x);
    }
    axis.values.erase(std::unique(axis.values.begin(), axis.values.end()), axis.values.end());
}

/// Reads a string that is one of `names`. A mark with an unknown name would silently not be drawn.
std::string read_name(TableReader& table, std::string_view key, const std::vector<std::string>& names) {
    std::string name = table.string(key);
    if (std::ranges::find(names, name) == names.end())
        table.fail_at(key, "is \"" + name + "\"; " + text::did_you_mean(name, names));
    return name;
}

std::vector<std::string> form_names() {
    std::vector<std::string> names;
    for (const intersect::table::Intersector& form : intersect::table::intersectors())
        names.emplace_back(form.info->name);
    return names;
}

Axis read_axis(TableReader table, const std::string& prefix) {
    using S = Axis::Spacing;
    static constexpr std::pair<std::string_view, S> spacings[] = {
        {"linear", S::linear}, {"log2", S::log2}, {"every_float", S::every_float}, {"whole", S::whole}};
    Axis axis;
    static_cast<AxisName&>(axis) = read_axis_name(table);
    axis.spacing = table.one_of<S>("spacing", spacings);
    axis.from = static_cast<double>(table.number("from"));
    axis.to = static_cast<double>(table.number("to"));

    // The axis may run downwards: an onset is the first problem in the order of the steps, and some problems are at
    // small values.
    if (axis.from == axis.to) table.fail_at("to", "equals from, which leaves nothing to sweep");
    fill_values(axis, table);

    const auto paths = table.strings("set");
    const auto factors = table.optional_numbers("factors", paths.size());
    const auto bases = table.optional_numbers("bases", paths.size());
    for (std::size_t i = 0; i < paths.size(); ++i) {
        // The constants of a march are not part of a ray distribution.
        axis.targets.push_back({.path = (paths[i].starts_with("march.") ? "" : prefix) + paths[i],
                                .factor = factors ? static_cast<double>((*factors)[i]) : 1.0,
                                .base = bases ? static_cast<double>((*bases)[i]) : 0.0,
                                .where = table.where("set")});
    }
    table.require_known_keys();
    return axis;
}

SweepFile::Mark read_mark(TableReader& mark) {
    SweepFile::Mark result{.at = static_cast<double>(mark.number("at")),
                           .label = mark.string("label"),
                           .format = mark.optional_string("format").value_or("")};
    if (auto measured = mark.optional_table("measured")) {
        result.form = read_name(*measured, "form", form_names());
        result.event = measured->has("event")
                           ? read_name(*measured, "event",
                                       {"lost_bits", "false_hit", "false_miss", "not_a_number", "wrong_primitive",
                                        "crack", "double_hit", "out_of_order", "max_dist", "max_steps", "stagnated"})
                           : "lost_bits";
        result.statistic = measured->has("statistic")
                               ? read_name(*measured, "statistic", {"p50", "p99", "max", "count"})
                           : result.event == "lost_bits" ? "p50"
                                                         : "count";
        result.threshold = static_cast<double>(measured->number("threshold"));
        measured->require_known_keys();
    }
    mark.require_known_keys();
    return result;
}

}  // namespace

double Axis::middle(double a, double b) const {
    switch (spacing) {
        case Spacing::linear: return a + (b - a) / 2;
        case Spacing::whole: return std::trunc(a + (b - a) / 2);
        case Spacing::log2: return round_to_12_bits(std::sqrt(a) * std::sqrt(b));
        case Spacing::every_float: break;
    }
    const std::uint32_t low = index_of(static_cast<float>(a)), high = index_of(static_cast<float>(b));
    const std::uint32_t half = low < high ? low + (high - low) / 2 : high + (low - high + 1) / 2;
    return static_cast<double>(float_at(half)) + 0.0;  // of the two zeros, +0
}

SweepFile::SweepFile(const std::filesystem::path& path, const std::filesystem::path& data_dir,
                     const SweepChanges& changes, intersect::process::StopToken stop)
    : root_(toml::read_toml(path, stop)), stop_(stop) {
    apply_changes(changes);
    TableReader file(root_);
    static_cast<SweepHead&>(*this) = read_sweep_head(file, path);
    convention = read_convention(file);
    read_subject(file, data_dir);
    if (axes.empty() || axes.size() > 2)
        toml::fail(file.where(),
                   "a sweep has one or two [[axis]] tables, but this one has " + std::to_string(axes.size()));
    if (axes.size() == 2 && axes[0].name == axes[1].name)
        toml::fail(file.where(),
                   "both axes are named \"" + axes[0].name + "\"; give each its own name: they become column names");
    for (TableReader& mark : file.tables("mark")) marks.push_back(read_mark(mark));
    file.require_known_keys();
    require_no_changes_of_axes(changes);
    read_both_ends();
}

/// Applies changes to the file, and stores the changes of its scene for later.
void SweepFile::apply_changes(const SweepChanges& changes) {
    const bool has_scene = TableReader(root_).has("scene");
    const std::string name = root_.where.source;
    if (changes.size && !has_scene)
        throw InputError(name +
                         ": --size is for the picture of a scene, but this sweep draws random rays; try "
                         "--set rays=N or --set views=N");

    size_ = changes.size;
    for (toml::Override change : changes.set) {
        const bool is_in_file = change.path.starts_with("axis[") || (!has_scene && change.path.starts_with("march."));
        if (has_scene && !is_in_file) {
            changes_.push_back(std::move(change));
            continue;
        }

        // A path without a table is a number of the ray distribution.
        const DistributionRow* const distribution = find_distribution(root_);
        const std::string table = std::string((distribution ? *distribution : distributions().front()).table) + '.';
        if (!is_in_file && !change.path.starts_with(table)) change.path = table + change.path;
        toml::apply_override(root_, change);
    }
    if (!changes.steps.empty()) apply_steps(changes);
}

/// Gives the axes other numbers of steps.
void SweepFile::apply_steps(const SweepChanges& changes) {
    const std::string name = root_.where.source;
    auto axes_tables = TableReader(root_).tables("axis");
    if (changes.steps.size() > 1 && changes.steps.size() != axes_tables.size())
        throw InputError(fmt::format("{}: --steps gives {}, but the sweep has {}; give {}", name,
                                     text::count_with_noun(changes.steps.size(), "number"),
                                     axes_tables.size() == 1 ? "1 axis" : fmt::format("{} axes", axes_tables.size()),
                                     axes_tables.size() == 1 ? "1 number" : "one for all, or one for each"));

    for (std::size_t a = 0; a < axes_tables.size(); ++a) {
        if (!axes_tables[a].has("steps"))
            throw InputError(name +
                             ": --steps: its axis tries every float between its ends and has no steps to choose; leave "
                             "out --steps, or bring the ends closer together with --set 'axis[0].to=VALUE'");
        const long long steps = changes.steps[changes.steps.size() > 1 ? a : 0];
        if (steps < min_steps || steps > max_steps)
            throw InputError(fmt::format("--steps {}: give a whole number from {} to {}", steps, min_steps, max_steps));
        const toml::SourcePosition where{"--steps " + std::to_string(steps), 0, 0};
        toml::apply_override(root_, {fmt::format("axis[{}].steps", a), toml::Node::of_integer(steps, where), where});
    }
}

/// Fails for a change of a number that an axis sets at every step, because this change would silently have no effect.
void SweepFile::require_no_changes_of_axes(const SweepChanges& changes) const {
    for (const toml::Override& change : changes.set) {
        for (const Axis& axis : axes) {
            for (const Axis::AxisTarget& target : axis.targets) {
                const std::string_view path = target.path;
                if (path != change.path && !path.ends_with("." + change.path)) continue;
                throw InputError(
                    fmt::format("{}: the axis {} sets it at every step; --set 'axis[0].from=VALUE' and "
                                "'axis[0].to=VALUE' change its range",
                                change.where.source, axis.name));
            }
        }
    }
}

/// Reads the subject of the sweep, and its axes, whose paths belong to the subject.
void SweepFile::read_subject(TableReader& file, const std::filesystem::path& data_dir) {
    const auto scene = file.optional_string("scene");
    const auto distribution_count = std::ranges::count_if(
        distributions(), [&](const DistributionRow& distribution_row) { return file.has(distribution_row.table); });
    if (distribution_count + int{scene.has_value()} != 1)
        toml::fail(file.where(), "a sweep has one source of rays: write either scene = \"…\", or one of the tables " +
                                     distribution_tables_text() +
                                     "; to try every float of a number, write [[ray]] tables and their primitive");

    const DistributionRow* const distribution = find_distribution(root_);
    if (scene) {
        const file::SceneName name = find_scene_of(file, *scene, data_dir);
        scene_.emplace(name.path, stop_);
        variant_ = name.variant;
        if (!variant_ && scene_->variants().size() > 1)
            file.fail_at("scene",
                         "has variants; name one, such as \"" + *scene + "." + scene_->variants().front() + "\"");
    } else {
        distribution->read(file.table(distribution->table));
    }

    if (scene) file.reject("march", "belongs in the scene file if the sweep is over a scene; write it there");
    else if (auto march = file.optional_table("march")) file::read_march(*march, file::InputRounding::shared);

    const std::string prefix = scene ? "" : std::string(distribution->table) + '.';
    for (TableReader& axis : file.tables("axis")) axes.push_back(read_axis(axis, prefix));
}

/// Reads the rays at both ends of the axes, so that errors show up before the first of a thousand steps.
void SweepFile::read_both_ends() {
    for (const bool is_last : {false, true}) {
        std::vector<double> values;
        for (const Axis& axis : axes) values.push_back(is_last ? axis.values.back() : axis.values.front());
        const RayGroup group = rays(values).front();
        marches_ = group.march.has_value();
        shapes_.clear();
        for (const Primitive<double>& primitive : group.primitives) {
            has_transform_ = has_transform_ || primitive.transform;
            if (std::ranges::find(shapes_, primitive.shape) == shapes_.end()) shapes_.push_back(primitive.shape);
        }

        has_mesh_ = group.mesh != nullptr;
        if (has_mesh_ && std::ranges::find(shapes_, triangle::Mesh::shape) == shapes_.end())
            shapes_.push_back(triangle::Mesh::shape);
    }
}

std::vector<RayGroup> SweepFile::rays(const std::vector<double>& values) const {
    std::vector<toml::Override> changes;
    for (std::size_t a = 0; a < axes.size(); ++a) {
        for (const Axis::AxisTarget& target : axes[a].targets) {
            changes.push_back(
                {target.path,
                 toml::Node::of_number(Real(target.base) + Real(values[a]) * Real(target.factor), target.where),
                 target.where});
        }
    }

    return scene_ ? rays_of_scene(changes) : rays_of_distribution(changes);
}

/// Draws the rays of the ray distribution, with changes to its numbers and to the march.
std::vector<RayGroup> SweepFile::rays_of_distribution(const std::vector<toml::Override>& changes) const {
    toml::Node root = root_;
    for (const toml::Override& change : changes) toml::apply_override(root, change);
    TableReader file(root);
    const DistributionRow* const distribution = find_distribution(root);
    std::vector<RayGroup> groups = distribution->read(file.table(distribution->table))(seed_offset_);

    if (auto march = file.optional_table("march")) {
        const auto constants = file::round_march(file::read_march(*march, file::InputRounding::shared), binary32);
        for (RayGroup& group : groups) group.march = constants;
    }
    return groups;
}

/// Makes the rays of the scene, which is loaded again with the changes.
std::vector<RayGroup> SweepFile::rays_of_scene(const std::vector<toml::Override>& changes) const {
    file::LoadOptions options;
    options.variant = variant_;
    options.size = size_;
    options.stop = stop_;
    options.overrides = changes_;
    options.overrides.insert(options.overrides.end(), changes.begin(), changes.end());
    const file::Scene scene = scene_->load(options).front();

    RayGroup group{rays::make_shared_rays(scene, 0, scene.height), {}};
    // A form that marches needs its primitives one by one, and spheres beside triangles have no tree.
    if (!scene.flake && !scene.march) group.mesh = rays::make_shared_mesh(scene);
    group.primitives = group.mesh ? rays::round_listed_primitives(scene) : rays::make_shared_primitives(scene);
    if (scene.march) group.march = file::round_march(*scene.march, binary32);
    if (scene.camera.projection) group.scene = std::make_shared<const file::Scene>(scene);
    return {std::move(group)};
}

SweepFile SweepFile::with_seed_offset(int offset) const {
    SweepFile result = *this;
    result.seed_offset_ += static_cast<std::uint64_t>(offset);
    return result;
}

RayGroup SweepFile::first_rays() const {
    std::vector<double> values;
    for (const Axis& axis : axes) values.push_back(axis.values.front());
    return std::move(rays(values).front());
}

bool is_sweep_file(const std::filesystem::path& path) {
    const toml::Node root = toml::read_toml(path);
    const toml::Node* const schema = root.find("schema");
    return schema != nullptr && schema->text.starts_with("lostbits-sweep/");
}

std::filesystem::path find_sweep(const std::string& name_or_path, const std::filesystem::path& data_dir) {
    std::error_code ignored;
    const auto status = std::filesystem::status(name_or_path, ignored);
    if (std::filesystem::is_regular_file(status)) return name_or_path;
    if (std::filesystem::exists(status) && (!is_directory(status) || name_or_path.ends_with(".toml")))
        throw InputError(name_or_path + ": is a folder or a pipe; name a .toml file, because it may be read twice");
    // `hard/padding` is found only by its whole name, because the search that found it has the same last part.
    if (const auto hard_case = data_dir / (name_or_path + ".toml");
        name_or_path.starts_with("hard/") && std::filesystem::is_regular_file(hard_case))
        return hard_case;
    std::vector<std::string> names;
    const auto folder = data_dir / "sweeps";
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder, ignored)) {
        if (entry.path().extension() == ".toml")
            names.push_back(entry.path().lexically_relative(folder).replace_extension().string());
    }
    std::ranges::sort(names);
    if (std::ranges::find(names, name_or_path) != names.end()) return folder / (name_or_path + ".toml");
    // `near` stands for `worst/near` if only one file has that name. The file's results have that name too.
    const auto has_last_part = [&](const std::string& name) {
        return std::filesystem::path(name).filename() == name_or_path;
    };
    if (std::ranges::count_if(names, has_last_part) == 1)
        return folder / (*std::ranges::find_if(names, has_last_part) + ".toml");
    if (const std::string hint_text = toml::suggest_file(name_or_path); !hint_text.empty())
        throw InputError(name_or_path + ": no such file; " + hint_text);
    const std::string hint = text::did_you_mean(std::filesystem::path(name_or_path).stem().string(), names);
    throw InputError("no sweep \"" + name_or_path + "\" in " + folder.string() + (hint.empty() ? "" : "; " + hint) +
                     " (a path to a .toml file works too; `lostbits list sweeps` lists all names)");
}

}  // namespace lostbits::scene::sweep
