#include "scene/sweep/case_file.hpp"

#include <fnmatch.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "scene/sweep/distributions.hpp"
#include "shapes/given_matrix.hpp"
#include "shapes/number_names.hpp"

namespace lostbits::scene::sweep {

using rays::RayGroup;
using toml::Node;
using toml::Quantity;
using toml::TableReader;

namespace {

std::vector<Quantity> read_quantities(TableReader& table, std::string_view key, std::size_t count,
                                      bool allows_special) {
    const Node& node = table.node(key);
    if (node.kind != Node::Kind::array || node.items.size() != count)
        table.fail_at(key, "is " + node.describe() + ", but " + std::to_string(count) + " numbers are expected here");
    std::vector<Quantity> values;
    for (const Node& item : node.items) values.emplace_back(item, allows_special);
    return values;
}

/// One of the 48 symmetries of a cube. Coordinate i of the result is signs[i] times coordinate source_axes[i].
struct Symmetry {
    std::array<int, 3> source_axes;
    std::array<double, 3> signs;

    [[nodiscard]] Vec<double> apply_to(const Vec<double>& v) const {
        return {signs[0] * v[source_axes[0]], signs[1] * v[source_axes[1]], signs[2] * v[source_axes[2]]};
    }
    /// Returns S M for a matrix M to the world, and M⁻¹ S⁻¹ for a stored inverse. The primitive stays in its own space.
    [[nodiscard]] Transform<double> apply_to(const Transform<double>& transform) const {
        auto result = transform.matrix;
        for (std::size_t i = 0; i < 3; ++i) {
            const auto k = static_cast<std::size_t>(source_axes[i]);
            for (std::size_t j = 0; j < 4; ++j) {
                if (!transform.is_inverse) result[4 * i + j] = signs[i] * transform.matrix[4 * k + j];
                else if (j < 3) result[4 * j + i] = signs[i] * transform.matrix[4 * j + k];
            }
        }
        return transform_of(result, transform.is_inverse);
    }
    [[nodiscard]] Primitive<double> apply_to(const Primitive<double>& primitive) const {
        Primitive<double> result = primitive;
        if (primitive.transform) {
            result.transform = apply_to(*primitive.transform);
            return result;
        }
        for_each_key(primitive.shape, [&](const Key& key, std::size_t k) {
            if (key.count() != 3) return;
            const Vec<double> point = apply_to(primitive.point(k));
            for (int i = 0; i < 3; ++i) {
                double& x = result.numbers[k + static_cast<std::size_t>(i)] = point[i];
                if (key.kind == Key::Kind::lengths) x = std::fabs(x);
                if (key.limit != Key::Limit::at_least_previous) continue;
                // A mirror swaps the corners. Coordinates are not sorted, because −0 and +0 are equal, and each of them
                // stays where the file has it. Corners that a format's rounding puts in the wrong order (1 + ulp to
                // 1.0001) are swapped.
                double& lower = result.numbers[k + static_cast<std::size_t>(i) - 3];
                if (lower > x || (lower == x && signs[i] < 0)) std::swap(lower, x);
            }
        });
        return result;
    }
};

std::vector<Symmetry> symmetries(bool is_symmetric) {
    if (!is_symmetric) return {{{0, 1, 2}, {1, 1, 1}}};
    std::vector<Symmetry> all_symmetries;
    std::array<int, 3> order{0, 1, 2};
    do {
        for (int signs = 0; signs < 8; ++signs) {
            all_symmetries.push_back(
                {order, {(signs & 1) != 0 ? -1.0 : 1.0, (signs & 2) != 0 ? -1.0 : 1.0, (signs & 4) != 0 ? -1.0 : 1.0}});
        }
    } while (std::ranges::next_permutation(order).found);
    return all_symmetries;
}

/// Fails if the range of a ray holds no t in binary64. A range that holds no t only in a narrower format is valid; the
/// ray misses in that format.
void require_range(TableReader& ray, const Range<double>& range) {
    if (!(range.tmin >= 0 && range.tmin < HUGE_VAL))
        ray.fail_at("tmin", "is not a finite t of 0 or more, but a ray looks ahead; write one, or leave it out for 0");
    if (std::isnan(range.tmax))
        ray.fail_at("tmax", "is not a t; write where the ray ends, or leave it out for a ray without end");
    if (!range.holds_any())
        ray.fail_at(ray.has("tmax") ? "tmax" : "tmin",
                    "leaves no t between tmin and tmax; write a tmax above tmin, or leave one of them out");
}

Vec<double> vector_in_format(const std::vector<Quantity>& v, const FloatFormat& format, int exponent) {
    return {v[0].value_in(format, exponent), v[1].value_in(format, exponent), v[2].value_in(format, exponent)};
}

}  // namespace

/// Returns "spheres = [{ centre, radius }, …] or boxes = [{ lo, hi }, …]".
std::string primitives_of_a_case() {
    std::string text;
    for (const ShapeRow& shape_row : shape_rows)
        text += (text.empty() ? "" : " or ") + std::string(shape_row.plural) + " = [{ " + key_list(shape_row.shape) +
                " }, …]";
    return text;
}

CaseFile::PrimitiveSpec CaseFile::read_primitive_spec(TableReader& table, const ShapeRow& shape_row) {
    PrimitiveSpec spec{shape_row.shape, {}};
    for (const Key& key : shape_row.keys) {
        if (key.count() == 1) spec.numbers.emplace_back(table.node(key.name), false);
        else std::ranges::move(read_quantities(table, key.name, key.count(), false), std::back_inserter(spec.numbers));
    }

    for (const auto& [key, is_inverse] : {std::pair("matrix", false), std::pair("inverse_matrix", true)}) {
        if (!table.has(key)) continue;
        if (!spec.matrix.empty()) table.fail_at(key, "is given together with matrix; write one of the two");
        spec.matrix = read_quantities(table, key, Affine<double>::number_count, false);
        spec.is_inverse = is_inverse;
        if (!spec.primitive_in(binary64, 0).transform->is_proper()) table.fail_at(key, std::string(singular_reason));
    }
    table.require_known_keys();
    return spec;
}

std::vector<CaseFile::PrimitiveSpec> CaseFile::read_primitive_specs(TableReader& case_table) {
    std::vector<std::pair<std::pair<int, int>, PrimitiveSpec>> by_position;
    for (const ShapeRow& shape_row : shape_rows) {
        for (TableReader& table : case_table.tables(shape_row.plural)) {
            PrimitiveSpec spec = read_primitive_spec(table, shape_row);
            const toml::SourcePosition where = table.where();
            by_position.emplace_back(std::pair(where.line, where.column), std::move(spec));
        }
    }
    std::ranges::stable_sort(by_position, {}, [](const auto& positioned) { return positioned.first; });

    std::vector<PrimitiveSpec> specs;
    for (auto& [position, spec] : by_position) specs.push_back(std::move(spec));
    return specs;
}

CaseFile::RaySpec CaseFile::read_ray_spec(TableReader& table, OpenEnds open) {
    RaySpec ray{read_quantities(table, "origin", 3, true), read_quantities(table, "direction", 3, true), {}, {}};
    if (table.has("tmin")) ray.tmin.emplace_back(table.node("tmin"), true);
    if (table.has("tmax")) ray.tmax.emplace_back(table.node("tmax"), true);

    const auto end = [](const std::vector<Quantity>& values, double default_t) {
        return values.empty() ? default_t : values.front().value_in(binary64, 0);
    };
    require_range(table, {end(ray.tmin, 0), end(ray.tmax, HUGE_VAL), open});
    table.require_known_keys();
    return ray;
}

CaseFile::Case CaseFile::read_case(TableReader& table) {
    Case new_case;
    new_case.name = table.string("name");
    table.read("note", new_case.note);
    if (table.has("lengths")) new_case.length_exponent = toml::Exponent(table.node("lengths"));
    if (table.has("directions")) new_case.direction_exponent = toml::Exponent(table.node("directions"));
    if (const auto zeros = table.optional_string("zeros")) {
        if (*zeros != "+0" && *zeros != "-0")
            table.fail_at("zeros", "is \"" + *zeros + "\"; write \"+0\" or \"-0\", or leave it out");
        new_case.zero_sign = *zeros == "-0" ? -0.0 : 0.0;
    }
    table.read("symmetric", new_case.symmetric);

    new_case.primitives = read_primitive_specs(table);
    table.read("open_ends", new_case.open_ends, open_ends_names);
    for (TableReader& ray : table.tables("rays")) new_case.rays.push_back(read_ray_spec(ray, new_case.open_ends));
    table.require_known_keys();

    if (new_case.primitives.empty())
        toml::fail(table.where(), "a case needs " + primitives_of_a_case() + "; write one of them");
    if (new_case.rays.empty())
        toml::fail(table.where(), "a case needs rays = [{ origin, direction }, …]; write at least one");
    return new_case;
}

void CaseFile::read_conventions(TableReader& file) {
    const auto names = file.optional_strings("conventions");
    if (!names) return;
    conventions.clear();
    for (const std::string& convention_name : *names) {
        if (convention_name == "own") conventions.emplace_back(std::nullopt);
        else if (const auto convention = convention_named(convention_name)) conventions.emplace_back(convention);
        else file.fail_at("conventions", "holds \"" + convention_name + "\"; write own, closed or open");
    }
    if (conventions.empty()) file.fail_at("conventions", "is empty; leave it out, or name own, closed or open");
}

void CaseFile::require_limits(const Case& case_, const TableReader& table) {
    for (const PrimitiveSpec& spec : case_.primitives) {
        const Primitive<double> primitive = spec.primitive_in(binary64, 0);
        if (const auto broken = broken_limit(primitive))
            toml::fail(table.where(), "has " + with_article(spec.shape) + " whose " + std::string(broken->key->name) +
                                          " " + limit_phrase(spec.shape, *broken));
    }
}

CaseFile::CaseFile(const std::filesystem::path& path) {
    const Node root = toml::read_toml(path);
    TableReader file(root);
    static_cast<SweepHead&>(*this) = read_sweep_head(file, path);
    if (const auto bits = file.optional_number("right_within_bits")) right_within_bits = static_cast<double>(*bits);
    read_conventions(file);

    for (TableReader& table : file.tables("case")) {
        Case new_case = read_case(table);
        if (std::ranges::find(cases_, new_case.name, &Case::name) != cases_.end())
            table.fail_at(
                "name", "is \"" + new_case.name + "\", which is also the name of another case; give each its own name");
        require_limits(new_case, table);
        cases_.push_back(std::move(new_case));
    }
    file.require_known_keys();
    if (cases_.empty()) toml::fail(file.where(), "has no [[case]]");
}

Primitive<double> CaseFile::PrimitiveSpec::primitive_in(const FloatFormat& format, int length_exponent) const {
    Primitive<double> primitive(shape);
    for (std::size_t k = 0; k < numbers.size(); ++k)
        primitive.numbers[k] = numbers[k].value_in(format, length_exponent);
    if (matrix.empty()) return primitive;
    std::array<double, Affine<double>::number_count> in_format;
    // The last column of the matrix is a translation, whose numbers are lengths.
    for (std::size_t k = 0; k < matrix.size(); ++k)
        in_format[k] = matrix[k].value_in(format, k % 4 == 3 ? length_exponent : 0);
    primitive.transform = transform_of(in_format, is_inverse);
    return primitive;
}

bool CaseFile::has_transform() const {
    return std::ranges::any_of(cases_, [](const Case& case_) {
        return std::ranges::any_of(case_.primitives, [](const PrimitiveSpec& spec) { return !spec.matrix.empty(); });
    });
}

std::vector<Shape> CaseFile::shapes() const {
    std::vector<Shape> found;
    for (const ShapeRow& shape_row : shape_rows) {
        const auto has_shape = [&shape_row](const Case& case_) {
            return std::ranges::find(case_.primitives, shape_row.shape, &PrimitiveSpec::shape) !=
                   case_.primitives.end();
        };
        if (std::ranges::any_of(cases_, has_shape)) found.push_back(shape_row.shape);
    }
    return found;
}

std::vector<std::size_t> CaseFile::cases_matching(const std::string& glob, const toml::SourcePosition& where) const {
    std::vector<std::string> names;
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < cases_.size(); ++i) {
        names.push_back(cases_[i].name);
        if (fnmatch(glob.c_str(), cases_[i].name.c_str(), 0) == 0) found.push_back(i);
    }
    if (found.empty()) toml::fail(where, "no case \"" + glob + "\" in " + id + "; " + text::did_you_mean(glob, names));
    return found;
}

std::vector<RayGroup> CaseFile::rays(std::size_t i, const FloatFormat& format) const {
    return rays(cases_[i], format, format);
}

std::vector<RayGroup> CaseFile::unrounded_rays(std::size_t i, const FloatFormat& format) const {
    return rays(cases_[i], format, binary64);
}

std::vector<RayGroup> CaseFile::rays(const Case& named_case, const FloatFormat& scale_format,
                                     const FloatFormat& format) {
    const int length_exponent = named_case.length_exponent.value_in(scale_format);
    const int direction_exponent = named_case.direction_exponent.value_in(scale_format);
    std::vector<RayGroup> groups;
    for (const Symmetry& symmetry : symmetries(named_case.symmetric)) {
        RayGroup group;
        for (const PrimitiveSpec& spec : named_case.primitives)
            group.primitives.push_back(symmetry.apply_to(spec.primitive_in(format, length_exponent)));
        for (const RaySpec& ray : named_case.rays) {
            Vec<double> d = symmetry.apply_to(vector_in_format(ray.direction, format, direction_exponent));
            for (int k = 0; named_case.zero_sign && k < 3; ++k) d[k] = d[k] == 0 ? *named_case.zero_sign : d[k];
            group.rays.push({symmetry.apply_to(vector_in_format(ray.origin, format, length_exponent)), d});
        }

        // If one ray of the case has an end, all of them get one.
        const auto add_ends = [&](std::vector<toml::Quantity> RaySpec::*end, double default_t,
                                  std::vector<double>& ends) {
            if (!std::ranges::any_of(named_case.rays, [end](const RaySpec& ray) { return !(ray.*end).empty(); }))
                return;
            // tmin and tmax are parameters, not lengths: they are not scaled.
            for (const RaySpec& ray : named_case.rays)
                ends.push_back((ray.*end).empty() ? default_t : (ray.*end).front().value_in(format, 0));
        };
        add_ends(&RaySpec::tmin, 0, group.rays.tmin);
        add_ends(&RaySpec::tmax, HUGE_VAL, group.rays.tmax);
        group.rays.open_ends = named_case.open_ends;
        group.rays.mark_as_list();
        groups.push_back(std::move(group));
    }
    return groups;
}

namespace {

/// Fails for a misspelt table. Such a table gives the file another kind, and the error would be about a table that this
/// kind lacks.
void require_no_misspelt_tables(const Node& root) {
    std::vector<std::string> tables{"axis", "case", "edge_search", "march", "mark", "ray", "search"};
    for (const ShapeRow& shape_row : shape_rows) tables.emplace_back(shape_row.name);
    for (const DistributionRow& distribution_row : distributions()) tables.emplace_back(distribution_row.table);
    for (const auto& [key, where, value] : root.entries) {
        const Node& first = value.kind == Node::Kind::array && !value.items.empty() ? value.items.front() : value;
        if (first.kind != Node::Kind::table || std::ranges::find(tables, key) != tables.end()) continue;
        if (text::match_typo(key, tables))
            toml::fail(where, "unknown key " + key + "; " + text::did_you_mean(key, tables));
    }
}

}  // namespace

SweepKind read_sweep_kind(const std::filesystem::path& path) {
    const Node root = toml::read_toml(path);
    if (TableReader file(root); file.has("schema")) {
        toml::require_schema(file, sweep_schema);
        require_no_misspelt_tables(root);
    }
    const Node* const axis = root.find("axis");
    // Old files of every float have one [axis] table without steps. An [axis] table with steps is a mistake for
    // [[axis]].
    const bool is_of_every_float = axis != nullptr && axis->kind == Node::Kind::table && axis->find("steps") == nullptr;
    return root.find("case") != nullptr                       ? SweepKind::cases
           : root.find("search") != nullptr                   ? SweepKind::search
           : root.find("edge_search") != nullptr              ? SweepKind::edge_search
           : root.find("ray") != nullptr || is_of_every_float ? SweepKind::every_float
                                                              : SweepKind::axes;
}

}  // namespace lostbits::scene::sweep
