// Finds the operation of a form that is to blame on one ray, from the ray's tape, and names it.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "intersect/table/table.hpp"
#include "measure/attribution/attribution.hpp"
#include "measure/attribution/rerun.hpp"
#include "scene/file/scene.hpp"
#include "scene/rays/generated_rays.hpp"
#include "scene/rays/rays.hpp"

namespace lostbits::measure::attribution {

/// Result of an `Attributor` for one ray. The pointers are valid until its next ray.
struct RayAttribution {
    double culprit = 0;  ///< index into the categories of the run; NaN if there is no culprit to name
    const Tape* tape = nullptr;
    const Attribution* attribution = nullptr;
    double ulp = 0;                                     ///< ulp of the format at the exact value of the subject
    std::optional<Counterfactuals> culprit_alone = {};  ///< for a culprit of t, if requested
};

/// Primitives and constants of the forms of a run; a view.
struct Setting {
    std::span<const Primitive<double>> primitives;
    const intersect::MarchConstants<double>* march = nullptr;  ///< null: no form that marches is evaluated
    const scene::file::Scene* scene = nullptr;                 ///< scene whose camera's rays formats may make
    bool rays_have_ranges = false;
};

/// Primitives and constants of a scene or a step as a `Setting`. They live as long as this object; a scene must outlive
/// it.
class OwnedSetting {
public:
    explicit OwnedSetting(const scene::file::Scene& scene);
    explicit OwnedSetting(const scene::rays::RayGroup& rays)
        : primitives_(rays.primitives),
          march_(rays.march),
          scene_(rays.scene),
          rays_have_ranges_(rays.rays.have_ranges()) {}
    [[nodiscard]] Setting get() const {
        return {primitives_, march_ ? &*march_ : nullptr, scene_.get(), rays_have_ranges_};
    }

private:
    std::vector<Primitive<double>> primitives_;
    std::optional<intersect::MarchConstants<double>> march_;
    std::shared_ptr<const scene::file::Scene> scene_;
    bool rays_have_ranges_ = false;
};

/// Names of all operations of a form that can round or choose, as maps and claims write them, in the order of its tape
/// and each once. Empty if the form has no tape for the setting.
std::vector<std::string> operation_names(const intersect::table::Intersector& form, const Setting& setting);

/// Labels of a form, in the order of its tape; empty if the form cannot handle the setting.
std::vector<std::string_view> labels_of(const intersect::table::Intersector& form, const Setting& setting);

/// Names of the inputs of a form's tape. `recorded_ray` is the recording of the operations that made the ray, whose
/// inputs come first; null if the ray was not recorded.
std::vector<std::string> names_of_inputs(const intersect::table::Intersector& form,
                                         const intersect::Target<double>& target,
                                         const scene::rays::RecordedRay* recorded_ray);

/// Number of rays that have a culprit, from the counts of `culprit`'s categories. Shares of culprits are relative to
/// this number.
std::uint64_t count_rays_with_culprit(std::span<const std::uint64_t> counts);

/// Share of some categories in the rays that have a culprit, from the counts of `culprit`'s categories. NaN if no ray
/// has a culprit. Rays without rounding errors have none.
double culprit_fraction(std::span<const std::uint64_t> counts, std::span<const std::size_t> categories);

/// Sum of the contributions of the operation that the formula calls `label` and of the unnamed operations that lead to
/// it first; NaN if no operation has that label.
double contribution_of(const Tape& tape, const Attribution& attribution, std::string_view label);

/// Bits of the largest cancellation among the live operations whose operands carry error.
int worst_cancellation(const Attribution& attribution);

/// Bits of the largest such cancellation among the operations with this label; NaN if no operation has the label.
double cancellation_of(const Tape& tape, const Attribution& attribution, std::string_view label);

/// Walks the tapes of the rays of one form, one after another. Not for use by several threads at once.
class Attributor {
public:
    /// `categories` are those of the run's `culprit`; empty if it is not requested.
    Attributor(const intersect::table::Intersector& form, const Format& format,
               std::span<const std::string_view> categories, bool with_counterfactuals = false)
        : form_(form), format_(format), categories_(categories), with_counterfactuals_(with_counterfactuals) {}

    /// `recorded_ray`: the recording of the operations that made the ray; empty if no format made it.
    RayAttribution attribute_ray(const Ray<double>& ray, const intersect::Target<double>& target,
                                 const Range<double>& range = {},
                                 const std::optional<scene::rays::RecordedRay>& recorded_ray = {});

private:
    /// Category of each node of the tape; `names` are those of its inputs. Cached for all tapes of the same structure.
    const std::vector<std::int32_t>& categories_of_nodes(const std::function<std::vector<std::string>()>& names);

    const intersect::table::Intersector& form_;
    const Format& format_;
    std::span<const std::string_view> categories_;
    bool with_counterfactuals_;
    Tape tape_;
    Attribution attribution_;
    std::unordered_map<std::uint64_t, std::vector<std::int32_t>> categories_by_structure_;
};

}  // namespace lostbits::measure::attribution
