#include "measure/answer/mesh_outcomes.hpp"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "measure/answer/owners.hpp"
#include "measure/crossing/mesh_crossings.hpp"
#include "shapes/triangle/mesh/mesh.hpp"

namespace lostbits::measure::answer {

using truth::Truth;

namespace {

/// Primitives of one ray, by their triangles of the mesh.
class RayAtMesh {
public:
    RayAtMesh(const BandAnswers& band_answers, std::size_t ray)
        : band_answers_(band_answers),
          ray_(ray),
          first_(band_answers.inputs.primitives.first_triangle_index()),
          mesh_(band_answers.inputs.primitives.mesh()->mesh()) {}

    [[nodiscard]] Outcome find_outcome(std::int32_t true_primitive, Outcome plain_outcome) const {
        const std::int32_t hit_primitive = band_answers_.answers.primitive[ray_];
        if (band_answers_.answers.claimed.empty())
            return plain_outcome == Outcome::wrong_primitive && are_neighbours(true_primitive, hit_primitive)
                       ? Outcome::wrong_neighbour
                       : plain_outcome;
        Outcome outcome = plain_outcome;
        if (plain_outcome == Outcome::false_miss && in_mesh(true_primitive) && lets_light_through(true_primitive))
            outcome = Outcome::crack;
        if (plain_outcome == Outcome::wrong_primitive && in_mesh(true_primitive)) {
            if (are_neighbours(true_primitive, hit_primitive)) outcome = Outcome::wrong_neighbour;
            else if (lets_light_through(true_primitive)) outcome = Outcome::crack;
            else if (passes_nearer_triangle(hit_primitive)) outcome = Outcome::out_of_order;
        }
        const bool hits_rightly = outcome == Outcome::agree_hit || outcome == Outcome::wrong_neighbour;
        return hits_rightly && in_mesh(hit_primitive) && is_claimed_twice(hit_primitive) ? Outcome::double_hit
                                                                                         : outcome;
    }

private:
    /// A triangle of the mesh that the form claims or the ray truly meets.
    struct CrossedTriangle {
        std::int32_t primitive;
        Truth truth;
        int facing;
    };

    [[nodiscard]] bool in_mesh(std::int32_t primitive) const {
        return primitive >= 0 && static_cast<std::size_t>(primitive) >= first_;
    }
    [[nodiscard]] std::size_t face_of(std::int32_t primitive) const {
        return static_cast<std::size_t>(primitive) - first_;
    }
    [[nodiscard]] bool are_neighbours(std::int32_t a, std::int32_t b) const {
        return in_mesh(a) && in_mesh(b) && mesh_.share_a_vertex(face_of(a), face_of(b));
    }
    /// True if the form claims a candidate for which `is_wanted(primitive)` holds.
    template <class IsWanted>
    [[nodiscard]] bool claims(const IsWanted& is_wanted) const {
        const culling::CandidateLists& candidates = *band_answers_.inputs.candidates;
        for (std::size_t pair = candidates.first_pair(ray_); pair < candidates.first_pair(ray_ + 1); ++pair)
            if (band_answers_.answers.claimed[pair] != 0 &&
                is_wanted(static_cast<std::int32_t>(candidates.primitive(pair))))
                return true;
        return false;
    }
    [[nodiscard]] bool lets_light_through(std::int32_t true_primitive) const {
        return !claims([&](std::int32_t s) { return s == true_primitive || are_neighbours(s, true_primitive); }) &&
               has_other_crossing_parity() && !passes_border(true_primitive);
    }
    /// True if, in one of the triangles that the ray truly meets first, the edge nearest to the line of the ray is a
    /// border edge.
    [[nodiscard]] bool passes_border(std::int32_t true_primitive) const {
        const culling::CandidateLists& candidates = *band_answers_.inputs.candidates;
        const Truth first = truth_at(true_primitive);
        return std::ranges::any_of(candidates.candidates_of(ray_), [&](std::uint32_t k) {
            const auto primitive = static_cast<std::int32_t>(k);
            if (!in_mesh(primitive) || !mesh_.has_border(face_of(primitive))) return false;
            const Truth primitive_truth = truth_at(primitive);
            return primitive_truth.is_hit() && compare(primitive_truth.t, first.t) == 0 &&
                   crossing::is_beside_border(band_answers_.inputs.rays[ray_], triangle(primitive), mesh_,
                                              face_of(primitive));
        });
    }
    [[nodiscard]] Truth truth_at(std::int32_t primitive) const {
        return band_answers_.band.truth_of_primitive(ray_, static_cast<std::size_t>(primitive),
                                                     band_answers_.convention);
    }
    [[nodiscard]] Primitive<double> triangle(std::int32_t primitive) const {
        return band_answers_.inputs.primitives[primitive];
    }
    [[nodiscard]] CrossedTriangle crossed_triangle(std::int32_t primitive) const {
        return {primitive, truth_at(primitive), facing(primitive)};
    }
    [[nodiscard]] int facing(std::int32_t primitive) const {
        return crossing::find_facing(band_answers_.inputs.rays[ray_], triangle(primitive)).value_or(0);
    }
    /// True if two triangles are one crossing of the surface: they face the same side, or one is seen edge-on. In
    /// addition, if the ray meets both, it meets them at the same t; otherwise they share a vertex.
    [[nodiscard]] bool is_one_crossing(const CrossedTriangle& a, const CrossedTriangle& b) const {
        if (a.facing * b.facing < 0) return false;
        return a.truth.is_hit() && b.truth.is_hit() ? compare(a.truth.t, b.truth.t) == 0
                                                    : are_neighbours(a.primitive, b.primitive);
    }
    [[nodiscard]] bool is_claimed_twice(std::int32_t hit_primitive) const {
        std::optional<CrossedTriangle> hit_triangle;
        return claims([&](std::int32_t s) {
            if (s == hit_primitive || !are_neighbours(s, hit_primitive)) return false;
            if (!hit_triangle) hit_triangle = crossed_triangle(hit_primitive);
            return is_one_crossing(*hit_triangle, crossed_triangle(s));
        });
    }
    /// True if the ray truly meets `hit_primitive` and, before that, another claimed triangle that is not a neighbour
    /// of `hit_primitive`.
    [[nodiscard]] bool passes_nearer_triangle(std::int32_t hit_primitive) const {
        const Truth hit_truth = truth_at(hit_primitive);
        return hit_truth.is_hit() && claims([&](std::int32_t s) {
                   if (s == hit_primitive || !in_mesh(s) || are_neighbours(s, hit_primitive)) return false;
                   const Truth other_truth = truth_at(s);
                   return other_truth.is_hit() && compare(other_truth.t, hit_truth.t) < 0;
               });
    }
    /// Number of crossings of the surface at these triangles. Triangles that are one crossing form a group, and each
    /// group counts once.
    [[nodiscard]] std::size_t crossings(std::vector<CrossedTriangle> remaining) const {
        std::size_t count = 0;
        for (; !remaining.empty(); ++count) {
            std::vector<CrossedTriangle> group{remaining.back()};
            remaining.pop_back();
            for (std::size_t k = 0; k < group.size(); ++k) {
                const CrossedTriangle member = group[k];
                const auto same_crossing = std::ranges::partition(
                    remaining, [&](const CrossedTriangle& other) { return !is_one_crossing(member, other); });
                group.insert(group.end(), same_crossing.begin(), same_crossing.end());
                remaining.erase(same_crossing.begin(), same_crossing.end());
            }
        }
        return count;
    }
    /// True if two claimed triangles share a vertex and the ray does not truly meet both. With the roundings of the
    /// form such a pair is either one crossing of the surface or a fold with two, and the claims do not tell which.
    [[nodiscard]] bool leave_count_open(const std::vector<CrossedTriangle>& claimed) const {
        for (const CrossedTriangle& a : claimed)
            for (const CrossedTriangle& b : claimed)
                if (a.primitive < b.primitive && !(a.truth.is_hit() && b.truth.is_hit()) &&
                    are_neighbours(a.primitive, b.primitive))
                    return true;
        return false;
    }
    /// True if, of the claimed and the true crossings of the surface, one count is odd and the other even. Light then
    /// ends on the other side of the surface.
    [[nodiscard]] bool has_other_crossing_parity() const {
        const culling::CandidateLists& candidates = *band_answers_.inputs.candidates;
        std::vector<CrossedTriangle> claimed_crossings, true_crossings;
        for (std::size_t pair = candidates.first_pair(ray_); pair < candidates.first_pair(ray_ + 1); ++pair) {
            const auto primitive = static_cast<std::int32_t>(candidates.primitive(pair));
            if (!in_mesh(primitive)) continue;
            const Truth primitive_truth = truth_at(primitive);
            if (band_answers_.answers.claimed[pair] == 0 && !primitive_truth.is_hit()) continue;
            const CrossedTriangle crossed{primitive, primitive_truth, facing(primitive)};
            if (band_answers_.answers.claimed[pair] != 0) claimed_crossings.push_back(crossed);
            if (primitive_truth.is_hit()) true_crossings.push_back(crossed);
        }
        return !leave_count_open(claimed_crossings) &&
               crossings(std::move(claimed_crossings)) % 2 != crossings(std::move(true_crossings)) % 2;
    }

    const BandAnswers& band_answers_;
    std::size_t ray_, first_;
    const scene::triangle::Mesh& mesh_;
};

}  // namespace

Outcome outcome_in_mesh(const BandAnswers& band_answers, std::size_t ray, std::int32_t true_primitive,
                        Outcome plain_outcome) {
    return band_answers.inputs.primitives.mesh() != nullptr
               ? RayAtMesh(band_answers, ray).find_outcome(true_primitive, plain_outcome)
               : plain_outcome;
}

void refine_outcomes(const BandAnswers& band_answers, const columns::TrueLengths& truth, std::span<Outcome> outcomes) {
    const bool has_mesh = band_answers.inputs.primitives.mesh() != nullptr;
    for (std::size_t i = 0; i < outcomes.size(); ++i) {
        const bool is_wrong_primitive = outcomes[i] == Outcome::wrong_primitive;
        if (has_mesh || is_wrong_primitive) band_answers.inputs.stop.check();
        if (is_wrong_primitive &&
            meets_first(band_answers.band, i, band_answers.answers.primitive[i], band_answers.convention))
            outcomes[i] = Outcome::agree_hit;
        if (has_mesh && truth.decision[i] == Truth::Decision::hit)
            outcomes[i] = RayAtMesh(band_answers, i).find_outcome(truth.primitive[i], outcomes[i]);
    }
}

}  // namespace lostbits::measure::answer
