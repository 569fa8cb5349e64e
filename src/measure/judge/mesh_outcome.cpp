#include "measure/judge/mesh_outcome.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lostbits::measure::judge {

using crossing::MeshCrossing, crossing::MeshCrossings;
using scene::ray_file::AnswerKind;
using scene::rays::StoredMesh;
using Surface = SurfaceCrossings::Surface;

bool can_have_outcome(MeshOutcome outcome, AnswerKind kind) {
    switch (outcome) {
        case MeshOutcome::agree:
        case MeshOutcome::unresolved: return true;
        case MeshOutcome::wrong_neighbour:
        case MeshOutcome::out_of_order:
        case MeshOutcome::double_hit:
        case MeshOutcome::not_a_number: return kind == AnswerKind::all_hits;
        case MeshOutcome::missing_hit:
        case MeshOutcome::false_hit:
        case MeshOutcome::crack: return kind != AnswerKind::inside;
        case MeshOutcome::false_outside:
        case MeshOutcome::false_inside:
        case MeshOutcome::on_surface: return kind == AnswerKind::inside;
    }
    return false;
}

SurfaceCrossings::SurfaceCrossings(const MeshCrossings& crossings, intersect::Facing facing) {
    for (const MeshCrossing& owner : crossings.in_order) {
        const auto is_same_surface = [&owner](const Surface& surface) {
            return surface.rank == owner.rank && surface.is_front == owner.hits_front;
        };
        auto found = std::ranges::find_if(surfaces_, is_same_surface);
        if (found == surfaces_.end()) found = surfaces_.insert(surfaces_.end(), {owner.rank, owner.hits_front, {}});
        found->owners.push_back(&owner);
    }

    for (Surface& surface : surfaces_)
        surface.touches = std::ranges::any_of(surfaces_, [&surface](const Surface& other) {
            return other.rank == surface.rank && other.is_front != surface.is_front;
        });
    if (facing != intersect::Facing::both)
        std::erase_if(surfaces_,
                      [&](const Surface& surface) { return surface.is_front != (facing == intersect::Facing::front); });
}

std::size_t SurfaceCrossings::certain_count() const {
    return static_cast<std::size_t>(
        std::ranges::count_if(surfaces_, [](const Surface& surface) { return !surface.touches; }));
}

namespace {

/// True if the ray passes one of the owners of a crossing at a border of the mesh.
bool is_at_border(const Ray<double>& ray, const Surface& surface, const StoredMesh& mesh) {
    return std::ranges::any_of(surface.owners, [&](const MeshCrossing* owner) {
        return crossing::is_beside_border(ray, mesh[owner->triangle], mesh.mesh(), owner->triangle);
    });
}

/// Hits of one list, and the crossing that each hit is.
class ListedHits {
public:
    ListedHits(const Ray<double>& ray, std::span<const ListedHit> hits, const MeshCrossings& crossings,
               const StoredMesh& mesh, const MeshContract& contract)
        : ray_(ray),
          hits_(hits),
          mesh_(mesh),
          contract_(contract),
          surfaces_(crossings, contract.facing),
          hit_counts_(surfaces_.all().size()) {
        judgement_.crossings_of_hits.resize(hits.size());
        judgement_.crossings = surfaces_.all().size();

        // Hits of triangles that the ray meets come first: the other hits get what is left.
        surface_of_hit_.assign(hits.size(), no_surface);
        for (std::size_t i = 0; i < hits.size(); ++i) match_owned(i);
        for (std::size_t i = 0; i < hits.size(); ++i)
            if (surface_of_hit_[i] == no_surface) match_beside(i);
    }

    [[nodiscard]] ListJudgement judgement() {
        count_missing();
        for (const std::size_t n : hit_counts_) judgement_.double_hit_count += n > 1 ? n - 1 : 0;
        judgement_.false_hit_count = static_cast<std::size_t>(std::ranges::count(surface_of_hit_, no_surface));

        // The last fault that is set is the outcome.
        set_outcome_if(judgement_.neighbour_hit_count > 0, MeshOutcome::wrong_neighbour);
        set_outcome_if(is_out_of_order(), MeshOutcome::out_of_order);
        set_outcome_if(judgement_.double_hit_count > 0, MeshOutcome::double_hit);
        set_outcome_if(judgement_.missing_crossing_count > 0, MeshOutcome::missing_hit);
        set_outcome_if(judgement_.false_hit_count > 0, MeshOutcome::false_hit);
        set_outcome_if(leaks_ && judgement_.false_hit_count % 2 != judgement_.missing_crossing_count % 2,
                       MeshOutcome::crack);
        set_outcome_if(
            contract_.has_t && std::ranges::any_of(hits_, [](const ListedHit& h) { return std::isnan(h.t); }),
            MeshOutcome::not_a_number);
        return std::move(judgement_);
    }

private:
    static constexpr std::size_t no_surface = std::numeric_limits<std::size_t>::max();

    void set_outcome_if(bool has_fault, MeshOutcome outcome) {
        if (has_fault) judgement_.outcome = outcome;
    }
    void match_owned(std::size_t i) {
        const auto& surfaces = surfaces_.all();
        for (std::size_t s = 0; s < surfaces.size(); ++s)
            for (const MeshCrossing* const owner : surfaces[s].owners)
                if (static_cast<std::int64_t>(owner->triangle) == hits_[i].triangle) {
                    surface_of_hit_[i] = s;
                    judgement_.crossings_of_hits[i] = owner;
                    ++hit_counts_[s];
                    return;
                }
    }
    /// Assigns a hit, whose triangle the ray does not meet, to a crossing of a triangle with a common vertex:
    /// preferably to a crossing without a hit, and among equals to the nearest.
    void match_beside(std::size_t i) {
        const auto triangle = static_cast<std::size_t>(hits_[i].triangle);
        const int facing = crossing::find_facing(ray_, mesh_[triangle]).value_or(0);
        const auto& surfaces = surfaces_.all();
        const auto distance = [&](std::size_t s) {
            const MeshCrossing& owner = *surfaces[s].owners.front();
            return contract_.has_t ? std::fabs(truth::scaled_difference(
                                         truth::as_certified(std::isfinite(hits_[i].t) ? hits_[i].t : 0),
                                         contract_.unit_direction ? owner.distance : owner.t, 0))
                                   : 0;
        };

        // Finds the best crossing on the right side whose triangles share a vertex with the hit's triangle.
        for (std::size_t s = 0; s < surfaces.size(); ++s) {
            if (facing != 0 && (facing > 0) != surfaces[s].is_front) continue;
            const bool shares_vertex = std::ranges::any_of(surfaces[s].owners, [&](const MeshCrossing* owner) {
                return mesh_.mesh().share_a_vertex(owner->triangle, triangle);
            });
            if (!shares_vertex) continue;
            const auto rank = [&](std::size_t k) { return std::pair(hit_counts_[k] > 0, distance(k)); };
            if (surface_of_hit_[i] == no_surface || rank(s) < rank(surface_of_hit_[i])) surface_of_hit_[i] = s;
        }

        if (surface_of_hit_[i] == no_surface) return;
        if (hit_counts_[surface_of_hit_[i]] == 0) ++judgement_.neighbour_hit_count;
        ++hit_counts_[surface_of_hit_[i]];
    }
    /// Counts the missing crossings, and finds out whether light leaks through one of them.
    void count_missing() {
        const auto& surfaces = surfaces_.all();
        for (std::size_t s = 0; s < surfaces.size(); ++s) {
            if (hit_counts_[s] > 0) continue;
            const bool is_border = is_at_border(ray_, surfaces[s], mesh_);
            const bool is_at_rim = std::ranges::any_of(surfaces[s].owners, &MeshCrossing::is_at_rim);
            if (contract_.touching_may_miss && (is_touched_only(s) || (is_border && is_at_rim))) continue;
            ++judgement_.missing_crossing_count;
            leaks_ = leaks_ || !is_border;
        }
    }
    /// True if the ray meets both sides at this t and the list has neither.
    [[nodiscard]] bool is_touched_only(std::size_t s) const {
        const auto& surfaces = surfaces_.all();
        bool is_listed = false;
        for (std::size_t k = 0; k < surfaces.size(); ++k)
            is_listed = is_listed || (surfaces[k].rank == surfaces[s].rank && hit_counts_[k] > 0);
        return surfaces[s].touches && !is_listed;
    }
    [[nodiscard]] bool is_out_of_order() const {
        int last_rank = -1;
        for (const std::size_t s : surface_of_hit_) {
            if (s == no_surface) continue;
            if (surfaces_.all()[s].rank < last_rank) return true;
            last_rank = surfaces_.all()[s].rank;
        }
        return false;
    }

    const Ray<double>& ray_;
    std::span<const ListedHit> hits_;
    const StoredMesh& mesh_;
    const MeshContract& contract_;
    SurfaceCrossings surfaces_;
    std::vector<std::size_t> hit_counts_;      ///< number of hits of each crossing in the list
    std::vector<std::size_t> surface_of_hit_;  ///< index of the crossing that each hit is
    bool leaks_ = false;
    ListJudgement judgement_;
};

}  // namespace

ListJudgement judge_list(const Ray<double>& ray, std::span<const ListedHit> hits, const MeshCrossings& crossings,
                         const StoredMesh& mesh, const MeshContract& contract) {
    if (!crossings.is_resolved)
        return {.outcome = MeshOutcome::unresolved, .crossings_of_hits = {hits.size(), nullptr}};
    return ListedHits(ray, hits, crossings, mesh, contract).judgement();
}

MeshOutcome judge_count(const Ray<double>& ray, std::int32_t count, bool parity, const MeshCrossings& crossings,
                        const StoredMesh& mesh, const MeshContract& contract) {
    if (!crossings.is_resolved) return MeshOutcome::unresolved;
    const SurfaceCrossings surfaces(crossings, contract.facing);
    const auto answer = static_cast<std::size_t>(count), total = surfaces.all().size(),
               least = surfaces.certain_count();

    if (answer % 2 == total % 2 && (parity || (answer >= least && answer <= total))) return MeshOutcome::agree;
    if (total == 0) return MeshOutcome::false_hit;
    const bool is_border =
        std::ranges::all_of(surfaces.all(), [&](const Surface& surface) { return is_at_border(ray, surface, mesh); });
    if (answer % 2 != total % 2 && !is_border) return MeshOutcome::crack;
    return answer < total ? MeshOutcome::missing_hit : MeshOutcome::false_hit;
}

}  // namespace lostbits::measure::judge
