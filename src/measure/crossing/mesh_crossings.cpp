#include "measure/crossing/mesh_crossings.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include "measure/truth/compare_hit.hpp"
#include "number/error.hpp"
#include "number/wide/running_error.hpp"
#include "shapes/lift.hpp"

namespace lostbits::measure::crossing {

using truth::find_at_rising_precision, truth::find_truth, truth::is_valid, truth::sign;
using truth::Truth, truth::ProofLimit;

namespace {

/// Exact position of a line relative to one triangle.
struct Passage {
    enum class Kind : std::uint8_t { outside, rim, inner, in_plane };
    Kind kind = Kind::outside;
    bool hits_front = false;  ///< known for `rim` and `inner`
    int t_sign = 0;           ///< known for `rim` and `inner`
};

template <class E>
FlatSpan<E> lifted_span(const Ray<double>& ray, const Primitive<double>& triangle) {
    return span_of<Triangle>(lift_ray<E>(ray), lift_primitive<E>(triangle));
}

template <class E>
std::optional<Passage> try_passage(const Ray<double>& ray, const Primitive<double>& triangle) {
    const FlatSpan<E> span = lifted_span<E>(ray, triangle);
    if (sign(span.at.m) == 0) return Passage{.kind = Passage::Kind::in_plane};
    if (span.closed.is_no()) return Passage{};
    if (!span.closed.is_yes() || span.open.is_unknown()) return std::nullopt;
    const auto t = sign(span.at.n);
    if (!t) return std::nullopt;
    return Passage{span.open.is_yes() ? Passage::Kind::inner : Passage::Kind::rim, span.is_front.is_yes(), *t};
}

/// Returns nothing if no precision decides. Single doubles with bounds decide most triangles, in a fifth of the time.
std::optional<Passage> find_passage(const Ray<double>& ray, const Primitive<double>& triangle) {
    if (!is_valid(triangle)) return Passage{};
    if (const auto fast_result = try_passage<number::wide::RunningError<double>>(ray, triangle)) return fast_result;
    return find_at_rising_precision([&]<class E>() { return try_passage<E>(ray, triangle); });
}

/// Up to the same factor for all edges, the height of the line's point above an edge e is v/|e|, with v = ±d·(p × q)
/// for the corners p and q of the edge relative to o. Heights compare as v |v|/e² do.
template <class E>
std::optional<unsigned> find_nearest_edges(const auto& triangle, const Ray<E>& ray, int facing) {
    const std::array<Vec<E>, 3> corners{triangle.a - ray.origin, triangle.b - ray.origin, triangle.c - ray.origin};

    std::array<E, 3> squares, lengths;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec<E>&p = corners[(k + 1) % 3], &q = corners[(k + 2) % 3];
        const E v = dot(ray.direction, cross(p, q));
        const auto side = sign(v);
        if (!side) return std::nullopt;
        squares[k] = *side == facing ? -square(v) : square(v);  // facing is the sign of −v inside
        lengths[k] = square(Vec<E>(q - p));
    }

    // Compares edges two by two: the one that is farther away is not nearest.
    unsigned nearest = 0b111;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < i; ++j) {
            const auto order = sign<E>(squares[i] * lengths[j] - squares[j] * lengths[i]);
            if (!order) return std::nullopt;
            if (*order != 0) nearest &= ~(1U << (*order > 0 ? i : j));
        }
    return nearest;
}

/// Order of the t of two crossings, −1, 0 or 1: that of the quotients n/m of their spans, m > 0.
std::optional<int> order_of_t(const Ray<double>& ray, const Primitive<double>& a, const Primitive<double>& b) {
    return find_at_rising_precision([&]<class E>() {
        const Fraction<E> x = lifted_span<E>(ray, a).at, y = lifted_span<E>(ray, b).at;
        return sign<E>(x.n * y.m - y.n * x.m);
    });
}

std::vector<std::uint32_t> find_candidate_triangles(const Ray<double>& ray, const Triangles& triangles) {
    std::vector<std::uint32_t> found;
    if (triangles.index) {
        triangles.index->find_candidates(ray, found);
    } else {
        found.resize(triangles.primitives.size());
        std::iota(found.begin(), found.end(), 0U);
    }
    return found;
}

/// Directions without zeros and without two components of the same size, from the fractional parts of multiples of √2,
/// √3 and √5. None of them lies in a plane that people draw.
Vec<double> direction_of_attempt(int k) {
    const auto fraction = [k](double x) { return std::fmod((k + 1) * x, 1) + 0x1p-6; };
    const Vec<double> d(fraction(std::sqrt(2.0)), fraction(std::sqrt(3.0)), fraction(std::sqrt(5.0)));
    return k % 2 == 0 ? d : -1.0 * d;
}

/// Counts the crossings of one ray from a point. Nothing if the ray meets a rim or lies in the plane of a triangle.
std::optional<PointInMesh> count_crossings(const Ray<double>& ray, const Triangles& triangles, ProofLimit limit) {
    PointInMesh position;
    bool is_clear = true;
    for (const std::uint32_t k : find_candidate_triangles(ray, triangles)) {
        limit.stop.check();
        const auto passage = find_passage(ray, triangles.primitives[k]);
        if (!passage || passage->kind == Passage::Kind::in_plane) {
            is_clear = false;
            continue;
        }
        if (passage->kind == Passage::Kind::outside || passage->t_sign < 0) continue;
        if (passage->t_sign == 0) return PointInMesh{.is_on_surface = true};
        if (passage->kind == Passage::Kind::rim) is_clear = false;
        ++position.crossings;
        position.winding += passage->hits_front ? -1 : 1;
    }
    return is_clear ? std::optional(position) : std::nullopt;
}

/// Sorts crossings by t, and gives each its rank.
void sort_and_rank(const Ray<double>& ray, const Triangles& triangles, MeshCrossings& crossings) {
    const auto order = [&](const MeshCrossing& a, const MeshCrossing& b) {
        if (const int difference = compare(a.t, b.t); difference != 0) return difference;
        const auto exact = order_of_t(ray, triangles.primitives[a.triangle], triangles.primitives[b.triangle]);
        if (!exact) crossings.is_resolved = false;
        return exact.value_or(0);
    };

    std::ranges::stable_sort(crossings.in_order, [&](const auto& a, const auto& b) { return order(a, b) < 0; });
    for (std::size_t i = 1; i < crossings.in_order.size(); ++i) {
        MeshCrossing &previous = crossings.in_order[i - 1], &next = crossings.in_order[i];
        next.rank = previous.rank + (order(previous, next) == 0 ? 0 : 1);
    }
}

}  // namespace

MeshCrossings find_crossings(const Ray<double>& ray, const Triangles& triangles, const Range<double>& range,
                             ProofLimit limit) {
    MeshCrossings crossings;
    if (!is_valid(ray)) return crossings;
    for (const std::uint32_t k : find_candidate_triangles(ray, triangles)) {
        limit.stop.check();

        // A line that passes by the triangle or lies in its plane does not cross it.
        const Primitive<double> triangle = triangles.primitives[k];
        const auto passage = find_passage(ray, triangle);
        if (passage && (passage->kind == Passage::Kind::outside || passage->kind == Passage::Kind::in_plane)) continue;

        const Truth triangle_truth = find_truth(ray, triangle, limit, {}, range);
        if (!passage || triangle_truth.decision == Truth::Decision::unresolved) crossings.is_resolved = false;
        else if (triangle_truth.is_hit())
            crossings.in_order.push_back({.triangle = k,
                                          .t = triangle_truth.t,
                                          .distance = triangle_truth.distance,
                                          .hits_front = passage->hits_front,
                                          .is_at_rim = passage->kind == Passage::Kind::rim});
    }
    sort_and_rank(ray, triangles, crossings);
    return crossings;
}

std::optional<int> find_facing(const Ray<double>& ray, const Primitive<double>& triangle) {
    return find_at_rising_precision([&]<class E>() -> std::optional<int> {
        const FlatSpan<E> span = lifted_span<E>(ray, triangle);
        const auto steepness = sign(span.at.m);
        if (!steepness || *steepness == 0) return steepness;
        return span.is_front.is_yes() ? 1 : -1;
    });
}

unsigned find_nearest_edges(const Ray<double>& ray, const Primitive<double>& triangle) {
    constexpr unsigned all_edges = 0b111;
    const int facing = find_facing(ray, triangle).value_or(0);
    if (facing == 0) return all_edges;
    const auto found = find_at_rising_precision([&]<class E>() {
        return visit_in_object_space<Triangle>(lift_ray<E>(ray), lift_primitive<E>(triangle),
                                               [facing](const auto& shape, const auto& object_ray) {
                                                   return find_nearest_edges<E>(shape, object_ray, facing);
                                               });
    });
    return found.value_or(all_edges);
}

bool is_beside_border(const Ray<double>& ray, const Primitive<double>& triangle, const scene::triangle::Mesh& mesh,
                      std::size_t face) {
    if (!mesh.has_border(face)) return false;
    const unsigned nearest = find_nearest_edges(ray, triangle);
    for (std::size_t k = 0; k < 3; ++k)
        if ((nearest >> k & 1U) != 0 && mesh.is_border(face, k)) return true;
    return false;
}

PointInMesh locate_in_mesh(const Vec<double>& point, const Triangles& triangles, ProofLimit limit) {
    constexpr int attempt_count = 64;
    if (is_valid(Ray<double>{point, {1, 1, 1}}))
        for (int k = 0; k < attempt_count; ++k)
            if (const auto found = count_crossings({point, direction_of_attempt(k)}, triangles, limit)) return *found;
    return {.is_resolved = false};
}

}  // namespace lostbits::measure::crossing
