#include "measure/answer/mesh_outcomes.hpp"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "measure/answer/owners.hpp"
#include "number/real.hpp"
#include "shapes/lift.hpp"
#include "shapes/triangle/mesh/mesh.hpp"

namespace lostbits::measure::answer {

using truth::Truth;

namespace {

/// How a line passes the plane of a triangle of a mesh: by the signs of the whole polynomials, in 256 bits.
struct Passing {
    int facing = 0;      ///< 1: from the front; −1: from the back; 0: in the plane
    Vec<Real> inside{};  ///< how far inside of the edges opposite to a, b and c, in the plane; unless in the plane
};

Passing passing_of(const Ray<double>& ray, const Solid<double>& triangle) {
    return in_its_space<Triangle>(
        lift_ray<Real>(ray), lift_solid<Real>(triangle), [](const Triangle<Real>& shape, const Ray<Real>& its) {
            const FlatSpan<Real> span = shape.span(its);
            if (span.at.m == 0) return Passing{};
            const Vec<Real> w = shape.weights(its);  // over an edge's length: the height above it, over the same area
            return Passing{span.front ? 1 : -1,
                           {w.x / length(Vec<Real>(shape.c - shape.b)), w.y / length(Vec<Real>(shape.a - shape.c)),
                            w.z / length(Vec<Real>(shape.b - shape.a))}};
        });
}

/// The solids of a ray, as the mesh knows them.
class RayAtMesh {
public:
    RayAtMesh(const BandAnswers& of, std::size_t ray)
        : of_(of), ray_(ray), first_(of.inputs.solids.first_of_mesh()), mesh_(of.inputs.solids.mesh()->mesh()) {}

    /// `truly` is below 0 where the ray truly misses.
    [[nodiscard]] Outcome outcome_of(std::int32_t truly, Outcome before) const {
        const std::int32_t met = of_.answers.object[ray_];
        if (of_.answers.claimed.empty())
            return before == Outcome::wrong_object && are_neighbours(truly, met) ? Outcome::wrong_neighbour : before;
        if (before == Outcome::false_hit) return in_mesh(met) && stops_light(met) ? Outcome::crack : before;
        Outcome outcome = before;
        if (before == Outcome::false_miss && in_mesh(truly) && lets_light_through(truly)) outcome = Outcome::crack;
        if (before == Outcome::wrong_object && in_mesh(truly)) {
            if (are_neighbours(truly, met)) outcome = Outcome::wrong_neighbour;
            else if (lets_light_through(truly)) outcome = Outcome::crack;
            else if (passes_a_nearer(met)) outcome = Outcome::out_of_order;
        }
        const bool met_right = outcome == Outcome::agree_hit || outcome == Outcome::wrong_neighbour;
        return met_right && in_mesh(met) && is_claimed_twice(met) ? Outcome::double_hit : outcome;
    }

private:
    /// A triangle of the mesh that the form claims or the ray truly meets.
    struct Crossed {
        std::int32_t solid;
        Truth truth;
        int facing;
    };

    [[nodiscard]] bool in_mesh(std::int32_t solid) const {
        return solid >= 0 && static_cast<std::size_t>(solid) >= first_;
    }
    [[nodiscard]] std::size_t face(std::int32_t solid) const { return static_cast<std::size_t>(solid) - first_; }
    [[nodiscard]] bool are_neighbours(std::int32_t a, std::int32_t b) const {
        return in_mesh(a) && in_mesh(b) && mesh_.share_a_vertex(face(a), face(b));
    }
    /// Whether the form claims any of the candidates of which `wanted(solid)`.
    template <class Wanted>
    [[nodiscard]] bool claims(const Wanted& wanted) const {
        const culling::CandidateLists& candidates = *of_.inputs.candidates;
        for (std::size_t pair = candidates.first(ray_); pair < candidates.first(ray_ + 1); ++pair)
            if (of_.answers.claimed[pair] != 0 && wanted(static_cast<std::int32_t>(candidates.solid(pair))))
                return true;
        return false;
    }
    [[nodiscard]] bool lets_light_through(std::int32_t truly) const {
        return !claims([&](std::int32_t s) { return s == truly || are_neighbours(s, truly); }) && counts_otherwise() &&
               !is_beside_border(face(truly), passing(truly));
    }
    /// The line passes beside `met`, across an edge behind which the mesh goes on.
    [[nodiscard]] bool stops_light(std::int32_t met) const {
        const Passing by = passing(met);
        const bool beside = by.inside.x < 0 || by.inside.y < 0 || by.inside.z < 0;
        return by.facing != 0 && beside && counts_otherwise() && !is_beside_border(face(met), by);
    }
    [[nodiscard]] Truth truth_at(std::int32_t solid) const {
        return of_.band.truth_of_solid(ray_, static_cast<std::size_t>(solid), of_.convention);
    }
    [[nodiscard]] Passing passing(std::int32_t solid) const {
        return passing_of(of_.inputs.rays[ray_], of_.inputs.solids[static_cast<std::size_t>(solid)]);
    }
    [[nodiscard]] Crossed crossed(std::int32_t solid) const { return {solid, truth_at(solid), passing(solid).facing}; }
    /// Whether two triangles are crossed by one step through the surface: they face to one side, or one is seen from
    /// its edge, and the ray meets both at one t, or not both and they share a vertex.
    [[nodiscard]] bool is_one_crossing(const Crossed& a, const Crossed& b) const {
        if (a.facing * b.facing < 0) return false;
        return a.truth.is_hit() && b.truth.is_hit() ? compare(a.truth.t, b.truth.t) == 0
                                                    : are_neighbours(a.solid, b.solid);
    }
    [[nodiscard]] bool is_claimed_twice(std::int32_t met) const {
        std::optional<Crossed> here;
        return claims([&](std::int32_t s) {
            if (s == met || !are_neighbours(s, met)) return false;
            if (!here) here = crossed(met);
            return is_one_crossing(*here, crossed(s));
        });
    }
    /// Whether the ray truly meets `met`, and before it a triangle that the form claims too and that is no neighbour.
    [[nodiscard]] bool passes_a_nearer(std::int32_t met) const {
        const Truth there = truth_at(met);
        return there.is_hit() && claims([&](std::int32_t s) {
                   if (s == met || !in_mesh(s) || are_neighbours(s, met)) return false;
                   const Truth here = truth_at(s);
                   return here.is_hit() && compare(here.t, there.t) < 0;
               });
    }
    /// The edge that the line passes nearest to, or farthest outside of, has no other face across.
    [[nodiscard]] bool is_beside_border(std::size_t one, const Passing& by) const {
        if (!mesh_.has_border(one)) return false;
        const Real nearest = min(min(by.inside.x, by.inside.y), by.inside.z);
        for (std::size_t k = 0; k < 3; ++k)
            if (by.facing == 0 || by.inside[static_cast<int>(k)] == nearest) {
                const auto has = [&](const scene::triangle::Face& f) {
                    return std::ranges::count(f, mesh_.faces[one][(k + 1) % 3]) != 0 &&
                           std::ranges::count(f, mesh_.faces[one][(k + 2) % 3]) != 0;
                };
                if (std::ranges::count_if(mesh_.faces, has) == 1) return true;
            }
        return false;
    }
    /// How often a ray steps through the surface by some of the triangles: groups of which each is one crossing with
    /// another of its group.
    [[nodiscard]] std::size_t crossings(std::vector<Crossed> left) const {
        std::size_t steps = 0;
        for (; !left.empty(); ++steps) {
            std::vector<Crossed> group{left.back()};
            left.pop_back();
            for (std::size_t k = 0; k < group.size(); ++k) {
                const Crossed from = group[k];
                const auto apart =
                    std::ranges::partition(left, [&](const Crossed& other) { return !is_one_crossing(from, other); });
                group.insert(group.end(), apart.begin(), apart.end());
                left.erase(apart.begin(), apart.end());
            }
        }
        return steps;
    }
    /// Two of them share a vertex, and the ray does not truly meet both: seen with the roundings of the form, that is
    /// one step through the surface or a fold with two.
    [[nodiscard]] bool leave_steps_open(const std::vector<Crossed>& claimed) const {
        for (const Crossed& a : claimed)
            for (const Crossed& b : claimed)
                if (a.solid < b.solid && !(a.truth.is_hit() && b.truth.is_hit()) && are_neighbours(a.solid, b.solid))
                    return true;
        return false;
    }
    /// Whether light ends up on another side: by the triangles that the form claims the ray steps through the surface
    /// an odd number of times more or less than it truly does.
    [[nodiscard]] bool counts_otherwise() const {
        const culling::CandidateLists& candidates = *of_.inputs.candidates;
        std::vector<Crossed> claimed, met;
        for (std::size_t pair = candidates.first(ray_); pair < candidates.first(ray_ + 1); ++pair) {
            const auto solid = static_cast<std::int32_t>(candidates.solid(pair));
            if (!in_mesh(solid)) continue;
            const Truth truth = truth_at(solid);
            if (of_.answers.claimed[pair] == 0 && !truth.is_hit()) continue;
            const Crossed one{solid, truth, passing(solid).facing};
            if (of_.answers.claimed[pair] != 0) claimed.push_back(one);
            if (truth.is_hit()) met.push_back(one);
        }
        return !leave_steps_open(claimed) && crossings(std::move(claimed)) % 2 != crossings(std::move(met)) % 2;
    }

    const BandAnswers& of_;
    std::size_t ray_, first_;
    const scene::triangle::Mesh& mesh_;
};

}  // namespace

Outcome outcome_in_mesh(const BandAnswers& of, std::size_t ray, std::int32_t truly, Outcome before) {
    return of.inputs.solids.mesh() != nullptr ? RayAtMesh(of, ray).outcome_of(truly, before) : before;
}

void take_apart(const BandAnswers& of, const columns::TrueLengths& truth, std::span<Outcome> outcomes) {
    const bool at_mesh = of.inputs.solids.mesh() != nullptr;
    for (std::size_t i = 0; i < outcomes.size(); ++i) {
        const bool elsewhere = outcomes[i] == Outcome::wrong_object;
        if (at_mesh || elsewhere) of.inputs.stop.check();
        if (elsewhere && meets_first(of.band, i, of.answers.object[i], of.convention)) outcomes[i] = Outcome::agree_hit;
        if (!at_mesh) continue;
        if (truth.decision[i] == Truth::Decision::hit)
            outcomes[i] = RayAtMesh(of, i).outcome_of(truth.object[i], outcomes[i]);
        else if (outcomes[i] == Outcome::false_hit) outcomes[i] = RayAtMesh(of, i).outcome_of(-1, outcomes[i]);
    }
}

}  // namespace lostbits::measure::answer
