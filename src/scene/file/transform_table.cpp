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

/// Applies first `inner`, then `outer`.
Map composed(const Map& outer, const Map& inner) {
    Map both;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec<Real>& row = outer.rows[i];
        both.rows[i] = row.x * inner.rows[0] + row.y * inner.rows[1] + row.z * inner.rows[2];
    }
    both.shift = outer.point(inner.shift);
    return both;
}

bool vanishes(const Vec<Real>& v) { return v.x == 0 && v.y == 0 && v.z == 0; }

/// Builds the map that takes the axes to three vectors.
Map of_columns(const Vec<Real>& x, const Vec<Real>& y, const Vec<Real>& z, const Vec<Real>& shift) {
    return {{Vec<Real>(x.x, y.x, z.x), Vec<Real>(x.y, y.y, z.y), Vec<Real>(x.z, y.z, z.z)}, shift};
}

Map read_scale(TableReader& table) {
    Vec<Real> by;
    if (table.node("scale").kind == Node::Kind::array) by = table.vec3("scale");
    else by.x = by.y = by.z = table.number("scale");
    if (by.x == 0 || by.y == 0 || by.z == 0)
        table.fail_at("scale", "flattens the primitive; write numbers other than 0 (a negative one mirrors)");
    return {{by.x * axis(0), by.y * axis(1), by.z * axis(2)}, {Real(0), Real(0), Real(0)}};
}

/// Rotates the three axes by v cos φ + (a × v) sin φ + a (a·v)(1 − cos φ) about the unit axis a (Rodrigues).
Map read_rotation(TableReader table) {
    const Vec<Real> about = table.vec3("axis");
    if (vanishes(about)) table.fail_at("axis", "is zero, which is not a direction; write [0, 0, 1]");
    const Real degrees = table.number("degrees");
    table.reject_unknown_keys();
    // Right angles are exact.
    const Real turned = degrees / 90;
    const bool right = turned == floor(turned);
    const int quarter = right ? static_cast<int>((turned - 4 * floor(turned / 4)).convert_to<long long>()) : 0;
    const Real angle = degrees * boost::math::constants::pi<Real>() / 180;
    const Real c = right ? Real(quarter == 0 ? 1 : quarter == 2 ? -1 : 0) : Real(cos(angle));
    const Real s = right ? Real(quarter == 1 ? 1 : quarter == 3 ? -1 : 0) : Real(sin(angle));
    const Vec<Real> a = about / length(about);
    const auto of = [&](const Vec<Real>& v) { return c * v + s * cross(a, v) + (dot(a, v) * (1 - c)) * a; };
    return of_columns(of(axis(0)), of(axis(1)), of(axis(2)), {Real(0), Real(0), Real(0)});
}

/// Moves the origin to `from`, points the z axis to `to`, and the y axis up.
Map read_look_at(TableReader table) {
    const Vec<Real> from = table.vec3("from"), to = table.vec3("to");
    Vec<Real> up = axis(1);
    table.read("up", up);
    table.reject_unknown_keys();
    const Vec<Real> view = to - from, across = cross(up, view);
    if (vanishes(view)) table.fail_at("to", "equals from, which gives no direction; move one of them");
    if (vanishes(across)) table.fail_at("up", "is zero or parallel to the direction of view, to - from; write another");
    const Vec<Real> z = view / length(view), x = across / length(across);
    return of_columns(x, cross(z, x), z, from);
}

/// The map that the keys of a table make together, and the map made up to each key. If a number cannot be stored, the
/// error names the key that introduced it.
class Steps {
public:
    void add(const TableReader& table, std::string_view key, const Map& next) {
        steps_.push_back({table, key, composed(next, map_)});
        map_ = steps_.back().until_here;
    }
    void add(const Steps& inner) {
        for (const Step& step : inner.steps_) steps_.push_back({step.table, step.key, composed(step.until_here, map_)});
        map_ = composed(inner.map_, map_);
    }
    [[nodiscard]] const Map& map() const { return map_; }

    /// Fails if `is_wrong` is true for the map of all keys, at the first key since which it is true.
    template <class IsWrong>
    void refuse(const IsWrong& is_wrong, const std::string& message) const {
        if (!is_wrong(map_) || steps_.empty()) return;
        auto since = steps_.rbegin();
        while (std::next(since) != steps_.rend() && is_wrong(std::next(since)->until_here)) ++since;
        since->table.fail_at(since->key, message);
    }

private:
    struct Step {
        TableReader table;
        std::string_view key;  ///< a literal in the source
        Map until_here;
    };
    std::vector<Step> steps_;
    Map map_ = identity();
};

/// Reads everything in one table except how it is stored.
Steps read_steps(TableReader& table) {
    Steps steps;
    if (table.has("matrix")) {
        const std::vector<Real> all = table.numbers("matrix", Map::numbers);
        steps.add(table, "matrix", Map::of([&all](std::size_t k) { return all[k]; }));
    }
    if (table.has("steps"))
        for (TableReader& step : table.tables("steps")) {
            steps.add(read_steps(step));
            step.reject_unknown_keys();
        }
    if (table.has("scale")) steps.add(table, "scale", read_scale(table));
    if (table.has("rotate")) steps.add(table, "rotate", read_rotation(table.table("rotate")));
    if (table.has("translate")) {
        Map moved = identity();
        moved.shift = table.vec3("translate");
        steps.add(table, "translate", moved);
    }
    if (table.has("look_at")) steps.add(table, "look_at", read_look_at(table.table("look_at")));
    return steps;
}

/// Returns A⁻¹ p − A⁻¹ τ.
Map inverse(const Map& m) {
    const auto columns = m.adjugate();
    const Real det = m.determinant();
    Map back = of_columns(columns[0] / det, columns[1] / det, columns[2] / det, {Real(0), Real(0), Real(0)});
    back.shift = -back.linear(m.shift);
    return back;
}

Placement<Real> stored_as(const Map& map, bool is_inverse) {
    std::array<Real, Map::numbers> numbers;
    std::size_t k = 0;
    map.each([&](const Real& x) { numbers[k++] = x; });
    return placement_of(numbers, is_inverse);
}

constexpr std::pair<std::string_view, bool> stored_names[] = {{"forward", false}, {"inverse", true}};

}  // namespace

std::optional<Placement<Real>> read_transform(TableReader& primitive, const StoredNumbers& numbers) {
    auto table = primitive.optional_table("transform");
    if (!table) return std::nullopt;
    bool is_inverse = false;
    table->read("stored", is_inverse, stored_names);
    const Steps steps = read_steps(*table);
    table->reject_unknown_keys();
    const auto is_singular = [](const Map& map) { return !stored_as(map, false).is_proper(); };
    steps.refuse(is_singular, std::string(singular_words));
    const auto placed_by = [&](const Map& map) { return stored_as(is_inverse ? inverse(map) : map, is_inverse); };
    steps.refuse(
        [&](const Map& map) {
            if (is_singular(map)) return false;
            const auto numbers_of = placed_by(map).matrix;
            return std::ranges::any_of(numbers_of, [&](const Real& x) { return numbers.overflows(x); });
        },
        std::string(StoredNumbers::overflow_words));
    const auto stored_by = [&](const Map& map) {
        return transformed(placed_by(map), [&](const Real& x) { return numbers.stored(x); });
    };
    steps.refuse([&](const Map& map) { return !is_singular(map) && orientation_of(stored_by(map).matrix) == 0; },
                 "is singular in binary32, to which inputs = \"shared\" rounds; write larger numbers, or inputs = "
                 "\"own\"");
    return placed_by(steps.map());
}

}  // namespace lostbits::scene::file
