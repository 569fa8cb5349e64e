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
          first_(band_answers.inputs.primitives.first_of_mesh()),
          mesh_(band_answers.inputs.primitives.mesh()->mesh()) {}

    [[nodiscard]] Outcome outcome_of(std::int32_t true_primitive, Outcome before) const {
        const std::int32_t met = band_answers_.answers.object[ray_];
        if (band_answers_.answers.claimed.empty())
            return before == Outcome::wrong_primitive && are_neighbours(true_primitive, met) ? Outcome::wrong_neighbour
                                                                                             : before;
        Outcome outcome = before;
        if (before == Outcome::false_miss && in_mesh(true_primitive) && lets_light_through(true_primitive))
            outcome = Outcome::crack;
        if (before == Outcome::wrong_primitive && in_mesh(true_primitive)) {
            if (are_neighbours(true_primitive, met)) outcome = Outcome::wrong_neighbour;
            else if (lets_light_through(true_primitive)) outcome = Outcome::crack;
            else if (passes_a_nearer(met)) outcome = Outcome::out_of_order;
        }
        const bool met_right = outcome == Outcome::agree_hit || outcome == Outcome::wrong_neighbour;
        return met_right && in_mesh(met) && is_claimed_twice(met) ? Outcome::double_hit : outcome;
    }

private:
    /// A triangle of the mesh that the form claims or the ray truly meets.
    struct Crossed {
        std::int32_t primitive;
        Truth truth;
        int facing;
    };

    [[nodiscard]] bool in_mesh(std::int32_t primitive) const {
        return primitive >= 0 && static_cast<std::size_t>(primitive) >= first_;
    }
    [[nodiscard]] std::size_t face(std::int32_t primitive) const {
        return static_cast<std::size_t>(primitive) - first_;
    }
    [[nodiscard]] bool are_neighbours(std::int32_t a, std::int32_t b) const {
        return in_mesh(a) && in_mesh(b) && mesh_.share_a_vertex(face(a), face(b));
    }
    /// True if the form claims a candidate for which `wanted(primitive)` holds.
    template <class Wanted>
    [[nodiscard]] bool claims(const Wanted& wanted) const {
        const culling::CandidateLists& candidates = *band_answers_.inputs.candidates;
        for (std::size_t pair = candidates.first(ray_); pair < candidates.first(ray_ + 1); ++pair)
            if (band_answers_.answers.claimed[pair] != 0 &&
                wanted(static_cast<std::int32_t>(candidates.primitive(pair))))
                return true;
        return false;
    }
    [[nodiscard]] bool lets_light_through(std::int32_t true_primitive) const {
        return !claims([&](std::int32_t s) { return s == true_primitive || are_neighbours(s, true_primitive); }) &&
               counts_otherwise() && !passes_border(true_primitive);
    }
    /// True if the line passes nearest to a border edge in one of the triangles that the ray truly meets first.
    [[nodiscard]] bool passes_border(std::int32_t true_primitive) const {
        const culling::CandidateLists& candidates = *band_answers_.inputs.candidates;
        const Truth first = truth_at(true_primitive);
        return std::ranges::any_of(candidates.of(ray_), [&](std::uint32_t k) {
            const auto primitive = static_cast<std::int32_t>(k);
            if (!in_mesh(primitive) || !mesh_.has_border(face(primitive))) return false;
            const Truth there = truth_at(primitive);
            return there.is_hit() && compare(there.t, first.t) == 0 &&
                   crossing::is_beside_border(band_answers_.inputs.rays[ray_], triangle(primitive), mesh_,
                                              face(primitive));
        });
    }
    [[nodiscard]] Truth truth_at(std::int32_t primitive) const {
        return band_answers_.band.truth_of_primitive(ray_, static_cast<std::size_t>(primitive),
                                                     band_answers_.convention);
    }
    [[nodiscard]] Primitive<double> triangle(std::int32_t primitive) const {
        return band_answers_.inputs.primitives[static_cast<std::size_t>(primitive)];
    }
    [[nodiscard]] Crossed crossed(std::int32_t primitive) const {
        return {primitive, truth_at(primitive), facing(primitive)};
    }
    [[nodiscard]] int facing(std::int32_t primitive) const {
        return crossing::facing_of(band_answers_.inputs.rays[ray_], triangle(primitive)).value_or(0);
    }
    /// True if two triangles are one crossing of the surface: they face to one side, or one is seen edge-on; and the
    /// ray meets both at the same t, or it does not meet both and they share a vertex.
    [[nodiscard]] bool is_one_crossing(const Crossed& a, const Crossed& b) const {
        if (a.facing * b.facing < 0) return false;
        return a.truth.is_hit() && b.truth.is_hit() ? compare(a.truth.t, b.truth.t) == 0
                                                    : are_neighbours(a.primitive, b.primitive);
    }
    [[nodiscard]] bool is_claimed_twice(std::int32_t met) const {
        std::optional<Crossed> here;
        return claims([&](std::int32_t s) {
            if (s == met || !are_neighbours(s, met)) return false;
            if (!here) here = crossed(met);
            return is_one_crossing(*here, crossed(s));
        });
    }
    /// True if the ray truly meets `met` and, before it, a triangle that the form claims too and that is no neighbour
    /// of it.
    [[nodiscard]] bool passes_a_nearer(std::int32_t met) const {
        const Truth there = truth_at(met);
        return there.is_hit() && claims([&](std::int32_t s) {
                   if (s == met || !in_mesh(s) || are_neighbours(s, met)) return false;
                   const Truth here = truth_at(s);
                   return here.is_hit() && compare(here.t, there.t) < 0;
               });
    }
    /// Number of crossings of the surface at some of its triangles. Triangles that are one crossing with another one
    /// form a group, and each group counts once.
    [[nodiscard]] std::size_t crossings(std::vector<Crossed> left) const {
        std::size_t count = 0;
        for (; !left.empty(); ++count) {
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
        return count;
    }
    /// True if two of them share a vertex and the ray does not truly meet both. With the roundings of the form such a
    /// pair is either one crossing of the surface or a fold with two, and the claims do not tell which.
    [[nodiscard]] bool leave_crossings_open(const std::vector<Crossed>& claimed) const {
        for (const Crossed& a : claimed)
            for (const Crossed& b : claimed)
                if (a.primitive < b.primitive && !(a.truth.is_hit() && b.truth.is_hit()) &&
                    are_neighbours(a.primitive, b.primitive))
                    return true;
        return false;
    }
    /// Compares two counts: the crossings of the surface at the triangles that the form claims, and the true ones. True
    /// if one count is odd and the other even: light ends on the other side of the surface.
    [[nodiscard]] bool counts_otherwise() const {
        const culling::CandidateLists& candidates = *band_answers_.inputs.candidates;
        std::vector<Crossed> claimed, met;
        for (std::size_t pair = candidates.first(ray_); pair < candidates.first(ray_ + 1); ++pair) {
            const auto primitive = static_cast<std::int32_t>(candidates.primitive(pair));
            if (!in_mesh(primitive)) continue;
            const Truth truth = truth_at(primitive);
            if (band_answers_.answers.claimed[pair] == 0 && !truth.is_hit()) continue;
            const Crossed one{primitive, truth, facing(primitive)};
            if (band_answers_.answers.claimed[pair] != 0) claimed.push_back(one);
            if (truth.is_hit()) met.push_back(one);
        }
        return !leave_crossings_open(claimed) && crossings(std::move(claimed)) % 2 != crossings(std::move(met)) % 2;
    }

    const BandAnswers& band_answers_;
    std::size_t ray_, first_;
    const scene::triangle::Mesh& mesh_;
};

}  // namespace

Outcome outcome_in_mesh(const BandAnswers& band_answers, std::size_t ray, std::int32_t true_primitive, Outcome before) {
    return band_answers.inputs.primitives.mesh() != nullptr
               ? RayAtMesh(band_answers, ray).outcome_of(true_primitive, before)
               : before;
}

void refine_outcomes(const BandAnswers& band_answers, const columns::TrueLengths& truth, std::span<Outcome> outcomes) {
    const bool at_mesh = band_answers.inputs.primitives.mesh() != nullptr;
    for (std::size_t i = 0; i < outcomes.size(); ++i) {
        const bool elsewhere = outcomes[i] == Outcome::wrong_primitive;
        if (at_mesh || elsewhere) band_answers.inputs.stop.check();
        if (elsewhere && meets_first(band_answers.band, i, band_answers.answers.object[i], band_answers.convention))
            outcomes[i] = Outcome::agree_hit;
        if (at_mesh && truth.decision[i] == Truth::Decision::hit)
            outcomes[i] = RayAtMesh(band_answers, i).outcome_of(truth.object[i], outcomes[i]);
    }
}

}  // namespace lostbits::measure::answer
