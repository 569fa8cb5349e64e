// What the tape of one ray says of the operations of its form: which one is to blame, by name.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "intersect/table/table.hpp"
#include "measure/blame/attribution.hpp"
#include "measure/blame/rerun.hpp"
#include "scene/file/scene.hpp"
#include "scene/rays/made_rays.hpp"
#include "scene/rays/rays.hpp"

namespace lostbits::measure::blame {

/// What is known of a ray whose tape was walked.
struct Blame {
    double culprit = 0;  ///< its place in the categories of the run; NaN where there is none to name
    const Tape* tape = nullptr;
    const Attribution* attribution = nullptr;
    double ulp = 0;                                     ///< of the format at the exact value of the subject
    std::optional<Counterfactuals> culprit_alone = {};  ///< of a culprit of t, where they are asked for
};

/// The solids and constants that the forms of a run are given; a view.
struct Setting {
    std::span<const Solid<double>> solids;
    const intersect::MarchConstants<double>* march = nullptr;  ///< null: no form that marches is asked
    const scene::file::Scene* scene = nullptr;                 ///< whose camera's rays formats may make
    bool ranged = false;                                       ///< rays have ranges
};

/// A scene's or a step's solids and constants as a `Setting`, kept while it lives; a scene outlives it.
class SettingOf {
public:
    explicit SettingOf(const scene::file::Scene& scene);
    explicit SettingOf(const scene::rays::RayGroup& rays)
        : solids_(rays.solids), march_(rays.march), scene_(rays.scene), ranged_(rays.rays.have_ranges()) {}
    [[nodiscard]] Setting get() const { return {solids_, march_ ? &*march_ : nullptr, scene_.get(), ranged_}; }

private:
    std::vector<Solid<double>> solids_;
    std::optional<intersect::MarchConstants<double>> march_;
    std::shared_ptr<const scene::file::Scene> scene_;
    bool ranged_ = false;
};

/// Every operation of a form that can round or choose, in the order of its tape, each once, as maps and claims call it;
/// empty where the form cannot be asked.
std::vector<std::string> operation_names(const intersect::table::Intersector& form, const Setting& setting);

/// Every label of a form, in the order of its tape; empty where the form cannot handle the setting.
std::vector<std::string_view> labels_of(const intersect::table::Intersector& form, const Setting& setting);

/// What the inputs of a form's tape are called, behind that of what made its ray (null: nothing did).
std::vector<std::string> names_of_inputs(const intersect::table::Intersector& form,
                                         const intersect::Target<double>& target, const scene::rays::RecordedRay* made);

/// Rays that have a culprit, by the counts of `culprit`'s categories: what shares of culprits are shares of.
std::uint64_t rays_with_culprit(std::span<const std::uint64_t> counts);

/// The share of one category, or of several, in the rays that have a culprit, by the counts of `culprit`'s categories;
/// NaN where no ray has one. Rays on which nothing rounds have none.
double culprit_share(std::span<const std::uint64_t> counts, std::span<const std::size_t> places);

/// The contributions of the operations that make up what the formula calls `label`: that operation and the unnamed ones
/// that lead to it first, summed; NaN where none has that name.
double contribution_of(const Tape& tape, const Attribution& attribution, std::string_view label);

/// The bits of the largest cancellation among the live operations whose operands carry error.
int worst_cancellation(const Attribution& attribution);

/// The same among the operations of that name; NaN where none has it.
double cancellation_of(const Tape& tape, const Attribution& attribution, std::string_view label);

/// Walks the tape of one ray after another for one form. Not for several threads at once.
class Blamer {
public:
    /// `categories` are those of the run's `culprit`; empty where it is not asked for.
    Blamer(const intersect::table::Intersector& form, const Format& format,
           std::span<const std::string_view> categories, bool with_counterfactuals = false)
        : form_(form), format_(format), categories_(categories), with_counterfactuals_(with_counterfactuals) {}

    /// `made`: where a format made the ray.
    Blame of(const Ray<double>& ray, const intersect::Target<double>& target, const Range<double>& range = {},
             const std::optional<scene::rays::RecordedRay>& made = {});

private:
    /// A category for each node of the tape, whose inputs have these names: of all tapes of the same structure.
    const std::vector<std::int32_t>& places(const std::function<std::vector<std::string>()>& names);

    const intersect::table::Intersector& form_;
    const Format& format_;
    std::span<const std::string_view> categories_;
    bool with_counterfactuals_;
    Tape tape_;
    Attribution attribution_;
    std::unordered_map<std::uint64_t, std::vector<std::int32_t>> known_;
};

}  // namespace lostbits::measure::blame
