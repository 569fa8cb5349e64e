#include "measure/judge/mesh_outcome.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lostbits::measure::judge {

using crossing::MeshCrossing, crossing::MeshCrossings;
using scene::dump::AnswerKind;
using scene::rays::MeshColumns;
using Surface = SurfaceCrossings::Surface;

bool can_be(MeshOutcome outcome, AnswerKind kind) {
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
    for (const MeshCrossing& one : crossings.in_order) {
        const auto same = [&one](const Surface& s) { return s.place == one.place && s.front == one.front; };
        auto found = std::ranges::find_if(all_, same);
        if (found == all_.end()) found = all_.insert(all_.end(), {one.place, one.front, {}});
        found->owners.push_back(&one);
    }
    for (Surface& s : all_)
        s.touches = std::ranges::any_of(
            all_, [&s](const Surface& other) { return other.place == s.place && other.front != s.front; });
    if (facing != intersect::Facing::both)
        std::erase_if(all_, [&](const Surface& s) { return s.front != (facing == intersect::Facing::front); });
}

std::size_t SurfaceCrossings::certain() const {
    return static_cast<std::size_t>(std::ranges::count_if(all_, [](const Surface& s) { return !s.touches; }));
}

namespace {

/// True if the ray passes one of the owners of a crossing at a border of the mesh.
bool is_at_border(const Ray<double>& ray, const Surface& surface, const MeshColumns& mesh) {
    return std::ranges::any_of(surface.owners, [&](const MeshCrossing* owner) {
        return crossing::is_beside_border(ray, mesh[owner->triangle], mesh.mesh(), owner->triangle);
    });
}

/// The hits of one list, each with the crossing that it is.
class ListedHits {
public:
    ListedHits(const Ray<double>& ray, std::span<const ListedHit> hits, const MeshCrossings& crossings,
               const MeshColumns& mesh, const MeshContract& contract)
        : ray_(ray),
          hits_(hits),
          mesh_(mesh),
          contract_(contract),
          surfaces_(crossings, contract.facing),
          times_(surfaces_.all().size()) {
        found_.met.resize(hits.size());
        found_.crossings = surfaces_.all().size();
        is_.assign(hits.size(), none);
        for (std::size_t i = 0; i < hits.size(); ++i) find_owned(i);
        for (std::size_t i = 0; i < hits.size(); ++i)
            if (is_[i] == none) find_beside(i);
    }

    [[nodiscard]] ListJudgement judged() {
        count_missing();
        for (const std::size_t n : times_) found_.doubled += n > 1 ? n - 1 : 0;
        found_.wrong = static_cast<std::size_t>(std::ranges::count(is_, none));
        take(found_.neighbours > 0, MeshOutcome::wrong_neighbour);
        take(is_out_of_order(), MeshOutcome::out_of_order);
        take(found_.doubled > 0, MeshOutcome::double_hit);
        take(found_.missing > 0, MeshOutcome::missing_hit);
        take(found_.wrong > 0, MeshOutcome::false_hit);
        take(leaks_ && found_.wrong % 2 != found_.missing % 2, MeshOutcome::crack);
        take(contract_.has_t && std::ranges::any_of(hits_, [](const ListedHit& h) { return std::isnan(h.t); }),
             MeshOutcome::not_a_number);
        return std::move(found_);
    }

private:
    static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

    void take(bool is, MeshOutcome outcome) {
        if (is) found_.outcome = outcome;
    }
    void find_owned(std::size_t i) {
        const auto& all = surfaces_.all();
        for (std::size_t s = 0; s < all.size(); ++s)
            for (const MeshCrossing* const owner : all[s].owners)
                if (static_cast<std::int64_t>(owner->triangle) == hits_[i].triangle) {
                    is_[i] = s, found_.met[i] = owner;
                    ++times_[s];
                    return;
                }
    }
    /// Takes a triangle that is not met for one of the crossings beside it: for one without a hit, and for the nearest
    /// of these.
    void find_beside(std::size_t i) {
        const auto triangle = static_cast<std::size_t>(hits_[i].triangle);
        const int facing = crossing::facing_of(ray_, mesh_[triangle]).value_or(0);
        const auto& all = surfaces_.all();
        const auto distance = [&](std::size_t s) {
            const MeshCrossing& owner = *all[s].owners.front();
            return contract_.has_t
                       ? std::fabs(truth::scaled_difference(truth::exactly(std::isfinite(hits_[i].t) ? hits_[i].t : 0),
                                                            contract_.unit ? owner.distance : owner.t, 0))
                       : 0;
        };
        for (std::size_t s = 0; s < all.size(); ++s) {
            if (facing != 0 && (facing > 0) != all[s].front) continue;
            const bool beside = std::ranges::any_of(all[s].owners, [&](const MeshCrossing* owner) {
                return mesh_.mesh().share_a_vertex(owner->triangle, triangle);
            });
            if (!beside) continue;
            const auto order = [&](std::size_t k) { return std::pair(times_[k] > 0, distance(k)); };
            if (is_[i] == none || order(s) < order(is_[i])) is_[i] = s;
        }
        if (is_[i] == none) return;
        if (times_[is_[i]] == 0) ++found_.neighbours;
        ++times_[is_[i]];
    }
    /// Also finds out whether light leaks at a missing crossing.
    void count_missing() {
        const auto& all = surfaces_.all();
        for (std::size_t s = 0; s < all.size(); ++s) {
            if (times_[s] > 0) continue;
            const bool border = is_at_border(ray_, all[s], mesh_);
            const bool rim = std::ranges::any_of(all[s].owners, &MeshCrossing::at_rim);
            if (contract_.touching_may_miss && (is_touched_only(s) || (border && rim))) continue;
            ++found_.missing;
            leaks_ = leaks_ || !border;
        }
    }
    /// True if the ray meets both sides at this t and neither is in the list.
    [[nodiscard]] bool is_touched_only(std::size_t s) const {
        const auto& all = surfaces_.all();
        bool listed = false;
        for (std::size_t k = 0; k < all.size(); ++k) listed = listed || (all[k].place == all[s].place && times_[k] > 0);
        return all[s].touches && !listed;
    }
    [[nodiscard]] bool is_out_of_order() const {
        int last = -1;
        for (const std::size_t s : is_) {
            if (s == none) continue;
            if (surfaces_.all()[s].place < last) return true;
            last = surfaces_.all()[s].place;
        }
        return false;
    }

    const Ray<double>& ray_;
    std::span<const ListedHit> hits_;
    const MeshColumns& mesh_;
    const MeshContract& contract_;
    SurfaceCrossings surfaces_;
    std::vector<std::size_t> times_;  ///< how often each crossing is in the list
    std::vector<std::size_t> is_;     ///< the crossing that each hit is
    bool leaks_ = false;
    ListJudgement found_;
};

}  // namespace

ListJudgement judge_list(const Ray<double>& ray, std::span<const ListedHit> hits, const MeshCrossings& crossings,
                         const MeshColumns& mesh, const MeshContract& contract) {
    if (!crossings.is_resolved) return {.outcome = MeshOutcome::unresolved, .met = {hits.size(), nullptr}};
    return ListedHits(ray, hits, crossings, mesh, contract).judged();
}

MeshOutcome judge_count(const Ray<double>& ray, std::int32_t count, bool parity, const MeshCrossings& crossings,
                        const MeshColumns& mesh, const MeshContract& contract) {
    if (!crossings.is_resolved) return MeshOutcome::unresolved;
    const SurfaceCrossings surfaces(crossings, contract.facing);
    const auto counted = static_cast<std::size_t>(count), all = surfaces.all().size(), least = surfaces.certain();
    if (counted % 2 == all % 2 && (parity || (counted >= least && counted <= all))) return MeshOutcome::agree;
    if (all == 0) return MeshOutcome::false_hit;
    const bool border =
        std::ranges::all_of(surfaces.all(), [&](const Surface& s) { return is_at_border(ray, s, mesh); });
    if (counted % 2 != all % 2 && !border) return MeshOutcome::crack;
    return counted < all ? MeshOutcome::missing_hit : MeshOutcome::false_hit;
}

}  // namespace lostbits::measure::judge
