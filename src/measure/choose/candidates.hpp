// Measures every form and format on the rays of a scene or of files in one run: bits kept, wrong decisions, and time.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "measure/evaluate/evaluate.hpp"
#include "measure/trade/scene_work.hpp"

namespace lostbits::measure::choose {

using trade::with_smaller_picture;

/// Requirement of a user on an intersector.
struct Requirement {
    double bits = 0;  ///< least number of correct bits of t
    /// Fraction of the rays whose decision may be wrong: false or missed hits, NaN, another primitive.
    double max_wrong_fraction = 0;
    double quantile = 0.99;  ///< fraction of the hits on which form and truth agree that must keep these bits; 1: all
    double tolerance = std::numeric_limits<double>::infinity();  ///< largest `distance_error` of the same hits

    [[nodiscard]] bool has_tolerance() const { return tolerance < std::numeric_limits<double>::infinity(); }
    /// Metrics to measure: `lost_bits`, and `distance_error` if there is a tolerance.
    [[nodiscard]] std::vector<const metric::Metric*> metrics() const;
};

/// Converts `p99`, `p99.9` or `max` to a quantile. Throws InputError for any other text.
double parse_quantile(const std::string& text);

/// Measurements of a form, as far as a requirement needs them.
struct FormQuality {
    std::uint64_t ray_count = 0;                  ///< rays whose truth is known
    std::uint64_t wrong_count = 0;                ///< number of these rays that are decided wrongly
    std::optional<answer::Outcome> main_fault{};  ///< most frequent wrong outcome
    std::uint64_t main_fault_count = 0;           ///< number of rays with that outcome
    double kept_bits = 0;  ///< p − lost bits, at the requirement's quantile of agreed hits; NaN without hits
    std::uint64_t true_hit_count = 0;        ///< rays that truly hit
    double distance_error = truth::missing;  ///< `distance_error` at the same quantile; NaN without a tolerance

    [[nodiscard]] double wrong_fraction() const {
        return ray_count == 0 ? 0 : static_cast<double>(wrong_count) / static_cast<double>(ray_count);
    }
    [[nodiscard]] bool decides_as_required(const Requirement& requirement) const {
        return wrong_fraction() <= requirement.max_wrong_fraction;
    }
    [[nodiscard]] bool meets(const Requirement& requirement) const {
        return decides_as_required(requirement) && kept_bits >= requirement.bits &&
               (!requirement.has_tolerance() || distance_error <= requirement.tolerance);
    }
};

/// A form in a format, as a program would call it.
struct Candidate {
    evaluate::TestedForm tested_form;
    std::string_view isa = {};  ///< register width: `scalar`, `128`, ...
    trade::Timing time{};       ///< seconds for one ray and primitive
    FormQuality quality{};
};

struct FileRays;

struct ChoiceRequest {
    const scene::file::Scene* scene = nullptr;  ///< scene to choose for; null for rays of files
    const FileRays* rays = nullptr;             ///< rays of files, judged for `tested_forms` and `requirement`
    std::vector<evaluate::TestedForm> tested_forms = {};   ///< in f32 and f64 only
    std::vector<evaluate::TestedForm> untimed_forms = {};  ///< in emulated formats; used only for the requirement
                                                           ///< of each pixel
    Requirement requirement{};
    bool times_single_rays = false;  ///< time kernels of one ray at a time instead of a register of rays
    trade::TimingPlan plan{};
    truth::ProofLimit limit{};
    evaluate::ShowForms show = {};  ///< receives the results of `measure_candidates`; may be empty
    /// Receives the number of (ray, form) pairs done since the last call; may throw to stop. The plan's own progress
    /// counts its measurements.
    std::function<void(std::uint64_t)> progress = [](std::uint64_t) {};

    /// Id of the scene or of the files, which names the results.
    [[nodiscard]] const std::string& id() const;
};

/// Converts a summary whose metrics are those of the requirement.
FormQuality to_quality(const evaluate::FormSummary& summary, const evaluate::TestedForm& tested_form,
                       const Requirement& requirement);
/// Measures a form on a band.
FormQuality measure_quality_on(const truth::Band& band, const evaluate::TestedForm& tested_form,
                               const Requirement& requirement);
/// Measures a form that receives these inputs instead of those of the band.
FormQuality measure_quality_on(const truth::Band& band, const truth::FormatInputs& inputs,
                               const evaluate::TestedForm& tested_form, const Requirement& requirement);

/// Measures every form on the scene, at the scene's size, and calls the request's `progress`.
std::vector<FormQuality> measure_quality(const ChoiceRequest& request);

/// Returns the format in which a form computes: the format of its inputs and answers, or f64 if they are f32 and the
/// formula converts them to f64 and back.
Format computing_format(const evaluate::TestedForm& tested_form);

/// Numbers of rays and primitives that were timed, see `trade::SceneWork`.
struct TimedRays {
    std::size_t ray_count = 0, primitive_count = 0;
};

/// Measures every form, in the request's order, and times it on rays of the scene or of the files.
std::vector<Candidate> measure_candidates(const ChoiceRequest& request, TimedRays& timed);

/// Returns the indices of all candidates, cheapest first.
std::vector<std::size_t> order_by_price(const std::vector<Candidate>& candidates);

/// `find_cheapest` is the fastest candidate that meets the requirement. `find_fastest` and `find_most_accurate` (fewest
/// wrong decisions, then most bits) consider all. Nothing if the list is empty or nothing meets the requirement.
std::optional<std::size_t> find_cheapest(const std::vector<Candidate>& candidates, const Requirement& requirement);
std::optional<std::size_t> find_fastest(const std::vector<Candidate>& candidates);
std::optional<std::size_t> find_most_accurate(const std::vector<Candidate>& candidates);
/// The candidate nearest to a requirement that nothing meets. Among those with few enough wrong decisions, it is the
/// one with the most bits; with a tolerance, the one with the most of the required bits, and then the smallest distance
/// error. If none has few enough wrong decisions, it is the one with the fewest.
std::optional<std::size_t> find_nearest_candidate(const std::vector<Candidate>& candidates,
                                                  const Requirement& requirement);

}  // namespace lostbits::measure::choose
