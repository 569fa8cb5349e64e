#include "measure/answer/mesh_outcomes.hpp"

#include <algorithm>
#include <vector>

#include "measure/answer/owners.hpp"
#include "shapes/triangle/mesh/mesh.hpp"

namespace lostbits::measure::answer {

using truth::Truth;

namespace {

/// Primitives of one ray, by their triangles of the mesh.
class RayAtMesh {
public:
    RayAtMesh(const BandAnswers& of, std::size_t ray)
        : of_(of), ray_(ray), first_(of.inputs.solids.first_of_mesh()), mesh_(of.inputs.solids.mesh()->mesh()) {}

    [[nodiscard]] Outcome outcome_of(std::int32_t truly, Outcome before) const {
        const std::int32_t met = of_.answers.object[ray_];
        if (of_.answers.claimed.empty())
            return before == Outcome::wrong_object && are_neighbours(truly, met) ? Outcome::wrong_neighbour : before;
        Outcome outcome = before;
        if (before == Outcome::false_miss && in_mesh(truly) && is_crack(truly)) outcome = Outcome::crack;
        if (before == Outcome::wrong_object && in_mesh(truly)) {
            if (are_neighbours(truly, met)) outcome = Outcome::wrong_neighbour;
            else if (is_crack(truly)) outcome = Outcome::crack;
            else if (passes_a_nearer(met)) outcome = Outcome::out_of_order;
        }
        const bool met_right = outcome == Outcome::agree_hit || outcome == Outcome::wrong_neighbour;
        return met_right && in_mesh(met) && is_claimed_twice(met) ? Outcome::double_hit : outcome;
    }

private:
    [[nodiscard]] bool in_mesh(std::int32_t solid) const {
        return solid >= 0 && static_cast<std::size_t>(solid) >= first_;
    }
    [[nodiscard]] std::size_t face(std::int32_t solid) const { return static_cast<std::size_t>(solid) - first_; }
    [[nodiscard]] bool are_neighbours(std::int32_t a, std::int32_t b) const {
        return in_mesh(a) && in_mesh(b) && mesh_.share_a_vertex(face(a), face(b));
    }
    /// True if the form claims a candidate for which `wanted(solid)` holds.
    template <class Wanted>
    [[nodiscard]] bool claims(const Wanted& wanted) const {
        const culling::CandidateLists& candidates = *of_.inputs.candidates;
        for (std::size_t pair = candidates.first(ray_); pair < candidates.first(ray_ + 1); ++pair)
            if (of_.answers.claimed[pair] != 0 && wanted(static_cast<std::int32_t>(candidates.solid(pair))))
                return true;
        return false;
    }
    [[nodiscard]] bool is_crack(std::int32_t truly) const {
        return !mesh_.has_border(face(truly)) &&
               !claims([&](std::int32_t s) { return s == truly || are_neighbours(s, truly); }) && counts_otherwise();
    }
    [[nodiscard]] Truth truth_at(std::int32_t solid) const {
        return of_.band.truth_of_solid(ray_, static_cast<std::size_t>(solid), of_.convention);
    }
    [[nodiscard]] bool is_claimed_twice(std::int32_t met) const {
        const auto of_one_crossing = [&](std::int32_t s) {
            if (s == met || !are_neighbours(s, met)) return false;
            const Truth here = truth_at(met), there = truth_at(s);
            return !(here.is_hit() && there.is_hit()) || compare(here.t, there.t) == 0;
        };
        return claims(of_one_crossing) && counts_otherwise();
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
    /// Compares two counts: the triangles of the mesh that the form claims, and those that the ray truly crosses, where
    /// several at one t count once. True if one count is odd and the other even.
    [[nodiscard]] bool counts_otherwise() const {
        const culling::CandidateLists& candidates = *of_.inputs.candidates;
        std::size_t claimed = 0;
        std::vector<truth::Certified> crossings;
        for (std::size_t pair = candidates.first(ray_); pair < candidates.first(ray_ + 1); ++pair) {
            const auto solid = static_cast<std::int32_t>(candidates.solid(pair));
            if (!in_mesh(solid)) continue;
            claimed += of_.answers.claimed[pair];
            const Truth at = truth_at(solid);
            const auto same = [&](const truth::Certified& t) { return compare(t, at.t) == 0; };
            if (at.is_hit() && std::ranges::none_of(crossings, same)) crossings.push_back(at.t);
        }
        return claimed % 2 != crossings.size() % 2;
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
        if (at_mesh && truth.decision[i] == Truth::Decision::hit)
            outcomes[i] = RayAtMesh(of, i).outcome_of(truth.object[i], outcomes[i]);
    }
}

}  // namespace lostbits::measure::answer
