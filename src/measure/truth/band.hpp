// A band of a picture: rays made once, their truth found once, and the same numbers handed to every form and format.
#pragma once

#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

#include "intersect/table/table.hpp"
#include "measure/truth/culling.hpp"
#include "measure/truth/truth.hpp"
#include "scene/file/scene.hpp"
#include "scene/rays/family.hpp"
#include "scene/rays/rays.hpp"

namespace lostbits::measure::truth {

/// What forms in one format receive. Rays and spheres are numbers of the format, held in doubles.
struct FormatInputs {
    Format format;
    scene::rays::RayBlock rays;
    std::vector<Solid<double>> solids;
    /// Where the scene has them; a form that marches is never asked without.
    std::optional<intersect::MarchConstants<double>> march = {};
    /// Directions normalised and rounded to the format; empty unless a form asks for them.
    scene::rays::RayBlock unit_rays;
    /// The truth of these inputs; empty where they are the ideal ones, or where no metric asks.
    std::vector<Truth> own_truth;
    bool ideal = false;                             ///< the inputs are exactly those of the truth
    std::shared_ptr<const SphereIndex> index = {};  ///< candidates among the solids for each ray; null: all of them

    [[nodiscard]] const scene::rays::RayBlock& rays_for(const intersect::Info& info) const {
        return info.direction == intersect::Direction::unit ? unit_rays : rays;
    }
    /// What a form is aimed at: one of the solids, or all of them together.
    [[nodiscard]] intersect::Target<double> target_for(const intersect::table::Intersector& form,
                                                       std::size_t solid) const {
        return form.shape == Shape::sdf ? intersect::Target<double>(solids, march.value())
                                        : intersect::Target<double>(solids[solid]);
    }
};

struct BandNeeds {
    bool unit_rays = false;
    bool own_truth = false;
};

/// Rows [y0, y1) of a scene.
class Band {
public:
    /// Finds the truth of every pixel, in parallel over the pixels. `culler`, of the same scene, spares the solids that
    /// cannot matter; it outlives the band.
    Band(const scene::file::Scene& scene, int y0, int y1, TruthLimit limit = {}, Culler* culler = nullptr);
    /// Rays that are already stored numbers, with their solids: what a step of a sweep evaluates.
    Band(scene::rays::RayBlock rays, std::vector<Solid<double>> solids, TruthLimit limit = {})
        : Band(scene::rays::RayGroup{std::move(rays), std::move(solids)}, limit) {}
    explicit Band(scene::rays::RayGroup group, TruthLimit limit = {});
    /// Finds κ of every hit, in parallel.
    void find_condition();
    /// κ of ray i after `find_condition`; NaN for a miss.
    [[nodiscard]] double condition(std::size_t i, intersect::Touching touching) const;
    /// The inputs of one format; parallel over the pixels where it computes.
    [[nodiscard]] FormatInputs inputs(const Format& format, BandNeeds needs) const;

    [[nodiscard]] int y0() const { return y0_; }
    [[nodiscard]] int rows() const { return rows_; }
    [[nodiscard]] std::size_t pixels() const { return truth_.size(); }
    /// The truth of ray i by the convention of a form: whether merely touching is a hit.
    [[nodiscard]] const Truth& truth(std::size_t i, intersect::Touching touching) const;
    /// The truth of ray i (a hit), correctly rounded to the format: as t, or as a distance.
    [[nodiscard]] double rounded_truth(std::size_t i, const FloatFormat& format, intersect::Direction unit_of,
                                       intersect::Touching touching) const;

private:
    void find_truth_of_all();

    [[nodiscard]] Truth find_truth_of(std::size_t i, intersect::Touching touching) const;

    Culler* culler_ = nullptr;
    const scene::file::Scene* scene_ = nullptr;  ///< for own inputs, whose solids each format rounds itself
    int y0_ = 0, rows_ = 0;
    TruthLimit limit_;
    scene::rays::RayBlock shared_;  ///< inputs = shared
    std::vector<Solid<double>> shared_solids_;
    std::optional<scene::rays::IdealRayBlock> ideal_;  ///< inputs = own
    std::vector<Solid<Real>> ideal_solids_;
    std::optional<intersect::MarchConstants<double>> shared_march_;
    struct Open {
        Truth truth;
        double condition = 0;
    };
    template <class Function>
    auto with_ray(std::size_t i, Function&& function) const;

    std::vector<Truth> truth_;
    std::vector<double> condition_;
    std::unordered_map<std::size_t, Open> open_;  ///< where touching makes a difference
};

/// The answers of one form in one format to a band: the nearest hit over all solids, found in the format.
struct Answers {
    std::vector<double> t;
    std::vector<std::uint8_t> hit;
    std::vector<std::int32_t>
        object;  ///< −1 where there is no hit; of a field, the solid whose surface is nearest to the answer
    std::vector<intersect::MarchRecord> march = {};  ///< of the forms that march, for every ray; empty for the others
};

/// Evaluates a row of the table. A hit at NaN never beats another hit; alone it stays, for the outcome to show.
Answers evaluate(const intersect::table::Intersector& form, const FormatInputs& inputs);

}  // namespace lostbits::measure::truth
