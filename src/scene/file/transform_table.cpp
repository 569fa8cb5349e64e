#include <boost/math/constants/constants.hpp>

#include <algorithm>
#include <iterator>
#include <string>
#include <vector>

#include "number/real.hpp"
#include "scene/file/tables.hpp"
#include "shapes/given_matrix.hpp"

namespace lostbits::scene::file {

using toml::Node;
using toml::TableReader;

namespace {

using Map = Affine<Real>;

Vec<Real> axis(int i) { return {Real(i == 0), Real(i == 1), Real(i == 2)}; }
Map identity() { return {{axis(0), axis(1), axis(2)}, {Real(0), Real(0), Real(0)}}; }

/// Returns the map that applies first `inner`, then `outer`.
Map compose(const Map& outer, const Map& inner) {
    Map composed;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec<Real>& row = outer.rows[i];
        composed.rows[i] = row.x * inner.rows[0] + row.y * inner.rows[1] + row.z * inner.rows[2];
    }
    composed.shift = outer.point(inner.shift);
    return composed;
}

bool is_zero_vector(const Vec<Real>& v) { return v.x == 0 && v.y == 0 && v.z == 0; }

/// Builds the map that takes the axes to three vectors.
Map map_of_columns(const Vec<Real>& x, const Vec<Real>& y, const Vec<Real>& z, const Vec<Real>& shift) {
    return {{Vec<Real>(x.x, y.x, z.x), Vec<Real>(x.y, y.y, z.y), Vec<Real>(x.z, y.z, z.z)}, shift};
}

Map read_scale(TableReader& table) {
    Vec<Real> factors;
    if (table.node("scale").kind == Node::Kind::array) factors = table.vec3("scale");
    else factors.x = factors.y = factors.z = table.number("scale");
    if (factors.x == 0 || factors.y == 0 || factors.z == 0)
        table.fail_at("scale", "flattens the primitive; write numbers other than 0 (a negative one mirrors)");
    return {{factors.x * axis(0), factors.y * axis(1), factors.z * axis(2)}, {Real(0), Real(0), Real(0)}};
}

/// Rotates the three axes by v cos φ + (a × v) sin φ + a (a·v)(1 − cos φ) about the unit axis a (Rodrigues).
Map read_rotation(TableReader table) {
    const Vec<Real> axis_vector = table.vec3("axis");
    if (is_zero_vector(axis_vector)) table.fail_at("axis", "is zero, which is not a direction; write [0, 0, 1]");
    const Real degrees = table.number("degrees");
    table.require_known_keys();
    // Right angles are exact.
    const Real quarter_turns = degrees / 90;
    const bool is_right_angle = quarter_turns == floor(quarter_turns);
    const int quarter =
        is_right_angle ? static_cast<int>((quarter_turns - 4 * floor(quarter_turns / 4)).convert_to<long long>()) : 0;
    const Real angle = degrees * boost::math::constants::pi<Real>() / 180;
    const Real c = is_right_angle ? Real(quarter == 0 ? 1 : quarter == 2 ? -1 : 0) : Real(cos(angle));
    const Real s = is_right_angle ? Real(quarter == 1 ? 1 : quarter == 3 ? -1 : 0) : Real(sin(angle));
    const Vec<Real> a = axis_vector / length(axis_vector);
    const auto rotated = [&](const Vec<Real>& v) { return c * v + s * cross(a, v) + (dot(a, v) * (1 - c)) * a; };
    return map_of_columns(rotated(axis(0)), rotated(axis(1)), rotated(axis(2)), {Real(0), Real(0), Real(0)});
}

/// Moves the origin to `from`, points the z axis to `to`, and the y axis up.
Map read_look_at(TableReader table) {
    const Vec<Real> from = table.vec3("from"), to = table.vec3("to");
    Vec<Real> up = axis(1);
    table.read("up", up);
    table.require_known_keys();
    const Vec<Real> view = to - from, across = cross(up, view);
    if (is_zero_vector(view)) table.fail_at("to", "equals from, which gives no direction; move one of them");
    if (is_zero_vector(across))
        table.fail_at("up", "is zero or parallel to the direction of view, to - from; write another");
    const Vec<Real> z = view / length(view), x = across / length(across);
    return map_of_columns(x, cross(z, x), z, from);
}

/// Composed map of all keys of a table, and the composed map up to each key. If a number of the map cannot be stored,
/// the error names the key that introduced this number.
class MapSteps {
public:
    void add(const TableReader& table, std::string_view key, const Map& key_map) {
        steps_.push_back({table, key, compose(key_map, map_)});
        map_ = steps_.back().map_so_far;
    }
    void add(const MapSteps& inner) {
        for (const Step& step : inner.steps_) steps_.push_back({step.table, step.key, compose(step.map_so_far, map_)});
        map_ = compose(inner.map_, map_);
    }
    [[nodiscard]] const Map& map() const { return map_; }

    /// Fails if `is_wrong` is true for the map of all keys. The error names the first key from which on `is_wrong` is
    /// true.
    template <class IsWrong>
    void fail_if(const IsWrong& is_wrong, const std::string& message) const {
        if (!is_wrong(map_) || steps_.empty()) return;
        auto step = steps_.rbegin();
        while (std::next(step) != steps_.rend() && is_wrong(std::next(step)->map_so_far)) ++step;
        step->table.fail_at(step->key, message);
    }

private:
    struct Step {
        TableReader table;
        std::string_view key;  ///< a literal in the source
        Map map_so_far;
    };
    std::vector<Step> steps_;
    Map map_ = identity();
};

/// Reads all keys of one table except `stored`.
MapSteps read_steps(TableReader& table) {
    MapSteps steps;
    if (table.has("matrix")) {
        const std::vector<Real> elements = table.numbers("matrix", Map::number_count);
        steps.add(table, "matrix", Map::of([&elements](std::size_t k) { return elements[k]; }));
    }
    if (table.has("steps"))
        for (TableReader& step : table.tables("steps")) {
            steps.add(read_steps(step));
            step.require_known_keys();
        }
    if (table.has("scale")) steps.add(table, "scale", read_scale(table));
    if (table.has("rotate")) steps.add(table, "rotate", read_rotation(table.table("rotate")));
    if (table.has("translate")) {
        Map translation = identity();
        translation.shift = table.vec3("translate");
        steps.add(table, "translate", translation);
    }
    if (table.has("look_at")) steps.add(table, "look_at", read_look_at(table.table("look_at")));
    return steps;
}

/// Returns the map p → A⁻¹ p − A⁻¹ τ.
Map inverse(const Map& m) {
    const auto columns = m.adjugate();
    const Real det = m.determinant();
    Map result = map_of_columns(columns[0] / det, columns[1] / det, columns[2] / det, {Real(0), Real(0), Real(0)});
    result.shift = -result.linear(m.shift);
    return result;
}

Transform<Real> to_transform(const Map& map, bool is_inverse) {
    std::array<Real, Map::number_count> numbers;
    std::size_t k = 0;
    map.for_each_number([&](const Real& x) { numbers[k++] = x; });
    return transform_of(numbers, is_inverse);
}

constexpr std::pair<std::string_view, bool> stored_names[] = {{"forward", false}, {"inverse", true}};

}  // namespace

std::optional<Transform<Real>> read_transform(TableReader& primitive, const StoredNumbers& numbers) {
    auto table = primitive.optional_table("transform");
    if (!table) return std::nullopt;
    bool is_inverse = false;
    table->read("stored", is_inverse, stored_names);
    const MapSteps steps = read_steps(*table);
    table->require_known_keys();

    // Fails, at the step that causes it, if the matrix is singular or has numbers that the scene cannot hold.
    const auto is_singular = [](const Map& map) { return !to_transform(map, false).is_proper(); };
    steps.fail_if(is_singular, std::string(singular_reason));
    const auto transform = [&](const Map& map) { return to_transform(is_inverse ? inverse(map) : map, is_inverse); };
    steps.fail_if(
        [&](const Map& map) {
            if (is_singular(map)) return false;
            const auto matrix = transform(map).matrix;
            return std::ranges::any_of(matrix, [&](const Real& x) { return numbers.overflows(x); });
        },
        std::string(StoredNumbers::overflow_words));

    // Rounding may also make a matrix singular.
    const auto stored_transform = [&](const Map& map) {
        return convert_numbers(transform(map), [&](const Real& x) { return numbers.round_as_stored(x); });
    };
    steps.fail_if(
        [&](const Map& map) { return !is_singular(map) && orientation_of(stored_transform(map).matrix) == 0; },
        "is singular in binary32, to which inputs = \"shared\" rounds; write larger numbers, or inputs = "
        "\"own\"");
    return transform(steps.map());
}

}  // namespace lostbits::scene::file
