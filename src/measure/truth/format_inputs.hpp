// What the forms of one format are given of a band, and the truth of that.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

#include "intersect/process/stop_token.hpp"
#include "intersect/table/table.hpp"
#include "measure/culling/culling.hpp"
#include "measure/truth/reach.hpp"
#include "measure/truth/truth_columns.hpp"
#include "scene/rays/rays.hpp"

namespace lostbits::measure::truth {

/// What forms in one format receive. Rays and spheres are numbers of the format, held in doubles.
struct FormatInputs {
    Format format;
    scene::rays::RayBlock rays = {};
    scene::rays::SolidList<double> solids = {};
    /// Where the scene has them; a form that marches is never asked without.
    std::optional<intersect::MarchConstants<double>> march = {};
    /// Directions normalised and rounded to the format; empty unless a form asks for them.
    scene::rays::RayBlock unit_rays = {};
    /// The truth of these inputs; empty where they are the ideal ones, or where no metric asks.
    RayTruths own_truth = {};
    /// The same by other conventions, by `key_of`, for the rays on which they matter.
    std::unordered_map<std::size_t, Truth> own_apart = {};
    /// By `Perturbed` and `Length`, of the closed solid's truth, see `truth::reach`; empty unless asked for.
    std::array<std::array<std::vector<double>, 2>, 2> reach = {};
    bool ideal = false;   ///< the inputs are exactly those of the truth
    bool paired = false;  ///< ray i is aimed at solid i alone
    /// Which of them forms are asked about: of spheres, and of other shapes ray by ray. Null: all.
    std::shared_ptr<const culling::SphereIndex> index = {};
    std::shared_ptr<const culling::CandidateLists> candidates = {};
    intersect::process::StopToken stop = {};  ///< of the band, for whoever asks forms about them

    [[nodiscard]] Truth own(std::size_t i, intersect::Convention convention) const;
    [[nodiscard]] const scene::rays::RayBlock& rays_for(const intersect::Info& info) const {
        return info.direction == intersect::Direction::unit ? unit_rays : rays;
    }
    /// What a form is aimed at: one of the solids, or all of them together. Keeps the one that it is about.
    class AimedAt {
    public:
        explicit AimedAt(const Solid<double>& one) : one_(one) {}
        AimedAt(std::span<const Solid<double>> all, const intersect::MarchConstants<double>& march)
            : all_(all), march_(&march) {}
        operator intersect::Target<double>() const {
            return march_ ? intersect::Target<double>(all_, *march_) : intersect::Target<double>(one_);
        }

    private:
        Solid<double> one_;
        std::span<const Solid<double>> all_;
        const intersect::MarchConstants<double>* march_ = nullptr;
    };
    [[nodiscard]] AimedAt target_for(const intersect::table::Intersector& form, std::size_t solid) const {
        return !is_solid(form.shape) ? AimedAt(solids.listed(), march.value()) : AimedAt(solids[solid]);
    }
};

/// One number for a ray and what is said of touching and of its origin.
[[nodiscard]] inline std::size_t key_of(std::size_t i, intersect::Convention convention) {
    return 4 * i + (convention.touching == intersect::Touching::miss ? 2 : 0) +
           (convention.at_origin == intersect::AtOrigin::miss ? 1 : 0);
}

struct BandNeeds {
    bool unit_rays = false;
    bool own_truth = false;
    std::array<std::array<bool, 2>, 2> reach = {};  ///< by `Perturbed` and `Length`

    void add_reach(Perturbed perturbed, Length length) {
        reach[static_cast<std::size_t>(perturbed)][static_cast<std::size_t>(length)] = true;
    }
};

}  // namespace lostbits::measure::truth
