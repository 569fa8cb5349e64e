// Inputs that a band gives to the forms of one format, and the truth of these inputs.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "intersect/process/stop_token.hpp"
#include "intersect/table/table.hpp"
#include "measure/culling/culling.hpp"
#include "measure/truth/reach.hpp"
#include "measure/truth/truth_columns.hpp"
#include "scene/rays/rays.hpp"

namespace lostbits::measure::truth {

/// Inputs of the forms in one format. Rays and spheres are numbers of the format, held in doubles.
struct FormatInputs {
    Format format;
    scene::rays::RayBlock rays = {};
    scene::rays::PrimitiveList<double> primitives = {};
    /// Constants of a march, if the scene has them; a form that marches is never run without them.
    std::optional<intersect::MarchConstants<double>> march = {};
    /// Directions normalised and rounded to the format; empty unless a form asks for them.
    scene::rays::RayBlock unit_rays = {};
    /// Truth of these inputs; empty if they are the ideal inputs, or if no metric needs it.
    RayTruths stored_truth = {};
    /// Index by which `stored_truth` was found; null: none.
    std::shared_ptr<const culling::PrimitiveIndex> truth_index = {};
    /// Reach of the closed primitive's truth by `Perturbation` and `Length` (see `truth::reach`); empty unless
    /// requested.
    std::array<std::array<std::vector<double>, 2>, 2> reach = {};
    bool is_ideal = false;   ///< the inputs are exactly those of the truth
    bool is_paired = false;  ///< ray i is tested only against primitive i
    /// Index of the primitives that forms are tested against. It is for spheres; other shapes have `candidates` ray by
    /// ray. If both are null, forms are tested against all primitives.
    std::shared_ptr<const culling::SphereIndex> index = {};
    std::shared_ptr<const culling::CandidateLists> candidates = {};
    intersect::process::StopToken stop = {};  ///< the band's token, for code that runs forms on the inputs

    /// Truth of these inputs of ray i by a convention. Needs `stored_truth`.
    [[nodiscard]] Truth find_stored_truth(std::size_t i, intersect::Convention convention) const;
    [[nodiscard]] const scene::rays::RayBlock& rays_for(const intersect::Info& info) const {
        return info.direction == intersect::Direction::unit ? unit_rays : rays;
    }
    /// Target of a ray: a copy of one primitive, or all primitives together, with the constants of a march.
    class OwnedTarget {
    public:
        explicit OwnedTarget(const Primitive<double>& single) : single_(single) {}
        OwnedTarget(std::span<const Primitive<double>> all, const intersect::MarchConstants<double>& march)
            : all_(all), march_(&march) {}
        operator intersect::Target<double>() const {
            return march_ ? intersect::Target<double>(all_, *march_) : intersect::Target<double>(single_);
        }

    private:
        Primitive<double> single_;
        std::span<const Primitive<double>> all_;
        const intersect::MarchConstants<double>* march_ = nullptr;
    };
    [[nodiscard]] OwnedTarget target_for(const intersect::table::Intersector& form, std::size_t primitive) const {
        return !is_primitive(form.shape) ? OwnedTarget(primitives.listed_primitives(), march.value())
                                         : OwnedTarget(primitives[primitive]);
    }
};

/// Optional parts of the inputs of a format that a measurement needs.
struct BandNeeds {
    bool unit_rays = false;
    bool stored_truth = false;
    bool without_forms = false;                     ///< all answers are given, so candidates for forms are not needed
    std::array<std::array<bool, 2>, 2> reach = {};  ///< by `Perturbation` and `Length`

    void add_reach(Perturbation perturbation, Length length) {
        reach[static_cast<std::size_t>(perturbation)][static_cast<std::size_t>(length)] = true;
    }
};

}  // namespace lostbits::measure::truth
