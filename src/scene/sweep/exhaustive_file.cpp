#include "scene/sweep/exhaustive_file.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "scene/toml/parse_number.hpp"
#include "scene/toml/round.hpp"
#include "shapes/number_names.hpp"

namespace lostbits::scene::sweep {

using toml::Node;
using toml::TableReader;

namespace {

constexpr std::string_view ray_paths[] = {"ray.origin.x",    "ray.origin.y",    "ray.origin.z",
                                          "ray.direction.x", "ray.direction.y", "ray.direction.z"};

/// The floats on both sides of a real number that is not itself a float.
struct AdjacentFloats {
    float below, above;
};
AdjacentFloats adjacent_floats(const Real& x) {
    const auto nearest = static_cast<float>(toml::round_to_format(x, binary32));
    if (Real(nearest) < x) return {nearest, float_at(index_of(nearest) + 1)};
    return {float_at(index_of(nearest) - 1), nearest};
}

std::string quoted(float x) { return '"' + toml::exact_text(Real(x)) + '"'; }

std::string nearest_text(const Real& x) {
    const auto [below, above] = adjacent_floats(x);
    if (std::isinf(above)) return "the largest is " + quoted(below);
    if (std::isinf(below)) return "the lowest is " + quoted(above);
    return "the nearest below and above are " + quoted(below) + " and " + quoted(above);
}

/// Reads a number that every form gets unrounded.
float read_float(TableReader& table, std::string_view key) {
    const Real x = table.number(key);
    if (const auto exact = to_exact_float(x)) return *exact;
    table.fail_at(key,
                  "is not representable in binary32, and rounding it would test another value; " + nearest_text(x));
}

Vec<float> read_float_vector(TableReader& table, std::string_view key) {
    const Vec<Real> components = table.vec3(key);
    Vec<float> v;
    for (int i = 0; i < 3; ++i) {
        const auto exact = to_exact_float(components[i]);
        if (!exact)
            table.fail_at(key, "holds a number that is not representable in binary32, at index " + std::to_string(i) +
                                   "; " + nearest_text(components[i]));
        v[i] = *exact;
    }
    return v;
}

}  // namespace

std::optional<float> to_exact_float(const Real& x) {
    const double rounded = toml::round_to_format(x, binary32);
    if (std::isfinite(rounded) && Real(rounded) == x) return static_cast<float>(rounded);
    return std::nullopt;
}

void ExhaustiveFile::read_path(const std::string& path, const TableReader& table) {
    std::vector<std::string> paths(std::begin(ray_paths), std::end(ray_paths));
    if (!mesh) std::ranges::copy(number_paths(primitive.shape), std::back_inserter(paths));
    const auto path_index = static_cast<std::size_t>(std::ranges::find(paths, path) - paths.begin());
    if (path_index == paths.size())
        table.fail_at("set", "names \"" + path + "\", which is not a number of the ray" +
                                 (mesh ? std::string(", and the numbers of a mesh are fixed")
                                       : " or of its " + std::string(name_of(primitive.shape))) +
                                 "; " + text::did_you_mean(path, paths));
    auto& indices = path_index < 6 ? ray_indices : primitive_indices;
    const std::size_t number_index = path_index < 6 ? path_index : path_index - 6;
    if (std::ranges::find(indices, number_index) != indices.end())
        table.fail_at("set", "names \"" + path + "\" twice; once is enough");
    indices.push_back(number_index);
}

void ExhaustiveFile::read_range(TableReader& table) {
    if (table.optional_boolean("all").value_or(false)) {
        for (const char* key : {"from", "to"})
            table.reject(key, "cannot be combined with all = true, which takes every float there is; leave one out");
        if (mesh)
            table.fail_at("all",
                          "includes NaN and infinities, and a ray with one of them crosses no mesh; write from and to");
        if (!primitive_indices.empty())
            table.fail_at("all",
                          "includes NaN, infinities and numbers of either sign, which are not valid for a primitive; "
                          "write from and to");
        ranges_ = {{index_of(0.0F), 0xffffffffU}, {index_of(-0.0F), 0}};
        return;
    }

    // If neither end is a float and no float lies between them, the message is about both.
    const Real from = table.number("from"), to = table.number("to");
    const bool rises = from < to;
    const auto low = to_exact_float(rises ? from : to), high = to_exact_float(rises ? to : from);
    if (!low && !high &&
        index_of(adjacent_floats(rises ? from : to).above) > index_of(adjacent_floats(rises ? to : from).below))
        table.fail_at("from", "and to have no number of binary32 between them; " + nearest_text(from));

    ranges_ = {{index_of(read_float(table, "from")), index_of(read_float(table, "to"))}};
    if (ranges_.front().size() == 1)
        table.fail_at("to", "equals from, which leaves nothing to sweep; bring them farther apart");
}

void ExhaustiveFile::read_axis(TableReader& table) {
    axis = read_axis_name(table);
    if (table.string("spacing") != "every_float")
        table.fail_at("spacing",
                      "must be \"every_float\" in a file with [[ray]] tables; steps need a [sphere_rays] or a scene");
    if (table.node("set").kind == Node::Kind::array) {
        for (const std::string& path : table.strings("set")) read_path(path, table);
    } else {
        read_path(table.string("set"), table);
    }
    if (ray_indices.empty() && primitive_indices.empty())
        table.fail_at("set", "is empty; name a number of the ray or of its primitive");
    read_range(table);
    table.require_known_keys();
}

void ExhaustiveFile::require_valid_primitives(TableReader& file, const TableReader& axis_table) const {
    if (mesh) return;
    const std::string name(name_of(primitive.shape));
    if (primitive_indices.empty()) {
        if (const auto broken = broken_limit(primitive))
            file.table(name).fail_at(broken->key->name, limit_phrase(primitive.shape, *broken));
        return;
    }
    // If a limit of lengths holds at two numbers, it holds between them. A normal may be 0 between them, and a point
    // may be on one line with two others: no ray meets such a primitive (`truth::is_valid`).
    for (const FloatRange& range : ranges_) {
        for (const std::uint32_t end : {range.first, range.last}) {
            if (const auto broken = broken_limit(primitive_at(float_at(end))))
                axis_table.fail_at(end == range.first ? "from" : "to", "leaves a " + name + " whose " +
                                                                           std::string(broken->key->name) + " " +
                                                                           limit_phrase(primitive.shape, *broken));
        }
    }
}

void ExhaustiveFile::read_primitive(TableReader& file) {
    std::string tables;
    std::vector<Shape> named_shapes;
    for (const ShapeRow& shape_row : shape_rows) {
        std::string table = with_article(shape_row.shape) + "]";
        tables += (tables.empty() ? "" : " or ") + table.insert(table.find(' ') + 1, "[");
        if (file.has(shape_row.name)) named_shapes.push_back(shape_row.shape);
    }
    if (named_shapes.size() != 1)
        toml::fail(file.where(), "a sweep over every float needs one primitive, " + tables +
                                     " table, or scene = \"…\", whose mesh its rays cross; write one of them");
    primitive = Primitive<float>(named_shapes.front());
    TableReader table = file.table(name_of(primitive.shape));
    for_each_key(primitive.shape, [&](const Key& key, std::size_t k) {
        if (key.is_optional && !table.has(key.name)) return;
        if (key.count() == 1) primitive.numbers[k] = read_float(table, key.name);
        else primitive.set_point(k, read_float_vector(table, key.name));
    });
    table.require_known_keys();
}

void ExhaustiveFile::read_scene(TableReader& file, const std::filesystem::path& data_dir,
                                intersect::process::StopToken stop) {
    for (const ShapeRow& shape_row : shape_rows)
        file.reject(shape_row.name, "cannot be combined with scene, whose mesh the rays cross; leave one out");
    scene = read_mesh_scene(file, data_dir, stop);
    mesh = rays::make_shared_mesh(*scene);
    primitive = Primitive<float>(triangle::Mesh::shape);
}

void ExhaustiveFile::read_ray(TableReader& table) {
    NamedRay ray{table.string("name"), {read_float_vector(table, "origin"), read_float_vector(table, "direction")}};
    if (std::ranges::find(rays, ray.name, &NamedRay::name) != rays.end())
        table.fail_at("name", "is \"" + ray.name + "\", which is also the name of another ray; give each its own name");
    if (!takes_tmax(primitive.shape)) table.reject("tmax", no_end_reason(primitive.shape));
    else if (table.has("tmax")) ray.tmax = read_float(table, "tmax");
    if (ray.tmax < 0) table.fail_at("tmax", "is below 0, but a ray looks ahead, and no t is left; write 0 or more");
    table.require_known_keys();
    rays.push_back(std::move(ray));
}

ExhaustiveFile::ExhaustiveFile(const std::filesystem::path& path, const std::filesystem::path& data_dir,
                               intersect::process::StopToken stop) {
    const Node root = toml::read_toml(path, stop);
    TableReader file(root);
    static_cast<SweepHead&>(*this) = read_sweep_head(file, path);

    convention = read_convention(file);
    if (file.has("scene")) read_scene(file, data_dir, stop);
    else read_primitive(file);
    for (TableReader& table : file.tables("ray")) read_ray(table);
    if (rays.empty()) toml::fail(file.where(), "a sweep over every float needs [[ray]] tables; write at least one");

    // Old files have one [axis] table.
    std::vector<TableReader> axes;
    if (file.has("axis") && file.node("axis").kind == Node::Kind::array) axes = file.tables("axis");
    else axes.push_back(file.table("axis"));
    if (axes.size() != 1)
        file.fail_at("axis", "must be one [[axis]] table: a file with [[ray]] tables tries every float of one number");

    read_axis(axes.front());
    require_valid_primitives(file, axes.front());
    file.require_known_keys();
}

std::uint64_t ExhaustiveFile::float_count() const {
    std::uint64_t sum = 0;
    for (const FloatRange& range : ranges_) sum += range.size();
    return sum;
}

void ExhaustiveFile::narrow(const Real& from, const Real& to, const toml::SourcePosition& where) {
    const auto index_in_ranges = [&](const Real& x) {
        const auto exact = to_exact_float(x);
        if (!exact) toml::fail(where, "a number is not representable in binary32; " + nearest_text(x));
        const std::uint32_t index = index_of(*exact);
        if (std::ranges::none_of(ranges_, [index](const FloatRange& r) {
                return std::min(r.first, r.last) <= index && index <= std::max(r.first, r.last);
            }))
            toml::fail(where, quoted(*exact) + " lies outside the axis " + axis.name + " of " + id);
        return index;
    };
    ranges_ = {{index_in_ranges(from), index_in_ranges(to)}};
}

Ray<float> ExhaustiveFile::ray_at(std::size_t ray, float value) const {
    Ray<float> r = rays[ray].ray;
    for (const std::size_t index : ray_indices)
        (index < 3 ? r.origin : r.direction)[static_cast<int>(index % 3)] = value;
    return r;
}

Primitive<float> ExhaustiveFile::primitive_at(float value) const {
    Primitive<float> result = primitive;
    for (const std::size_t index : primitive_indices) result.numbers[index] = value;
    return result;
}

rays::RayGroup ExhaustiveFile::group_of_floats(std::size_t ray, const FloatRange& floats) const {
    const auto to_double = [](const Vec<float>& v) { return Vec<double>(v.x, v.y, v.z); };
    const std::size_t primitive_count = mesh ? 0 : primitive_indices.empty() ? 1 : floats.size();
    rays::RayGroup group;
    for (std::uint64_t i = 0; i < floats.size(); ++i) {
        const float value = float_at(floats.at(i));
        const Ray<float> r = ray_at(ray, value);
        group.rays.push({to_double(r.origin), to_double(r.direction)});
        if (i < primitive_count)
            group.primitives.push_back(
                convert_numbers(primitive_at(value), [](float x) { return static_cast<double>(x); }));
    }
    group.rays.mark_as_list();
    if (takes_tmax(primitive.shape)) group.rays.tmax.assign(floats.size(), static_cast<double>(rays[ray].tmax));
    group.is_paired = primitive_count > 1;
    group.mesh = mesh;
    return group;
}

}  // namespace lostbits::scene::sweep
