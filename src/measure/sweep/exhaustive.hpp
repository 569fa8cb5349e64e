// Exhaustive sweep: runs every form on every ray at every float of an axis, binade by binade. The memory does not grow
// with the axis.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "measure/answer/outcome.hpp"
#include "measure/evaluate/evaluate.hpp"
#include "measure/shard/share.hpp"
#include "measure/truth/truth_columns.hpp"
#include "scene/sweep/exhaustive_file.hpp"

namespace lostbits::measure::sweep {

/// Event whose first float along an axis is recorded: an outcome, or a number of lost bits.
struct FirstEvent {
    answer::Outcome outcome;  ///< a wrong decision, or `agree_hit`
    int lost_bits = 0;        ///< 0: the event is the outcome; otherwise a loss of this many bits, with `agree_hit`
};
inline constexpr std::array<FirstEvent, 11> first_events{{{answer::Outcome::false_miss},
                                                          {answer::Outcome::false_hit},
                                                          {answer::Outcome::not_a_number},
                                                          {answer::Outcome::agree_hit, 1},
                                                          {answer::Outcome::agree_hit, 4},
                                                          {answer::Outcome::agree_hit, 8},
                                                          {answer::Outcome::agree_hit, 12},
                                                          {answer::Outcome::wrong_primitive},
                                                          {answer::Outcome::crack},
                                                          {answer::Outcome::double_hit},
                                                          {answer::Outcome::out_of_order}}};
/// True for an event that can happen if a ray has only one primitive to hit.
inline constexpr bool is_of_one_primitive(const FirstEvent& event) {
    return static_cast<std::size_t>(event.outcome) < answer::single_primitive_outcome_count;
}

/// Counts of a form on one ray over consecutive floats. A float is identified by its index among all floats
/// (scene/sweep/float_order).
struct FloatTally {
    /// Float with an error of the form.
    struct WorstError {
        std::uint32_t float_index;
        double ulps;  ///< (t − t*)/ulp(t*), signed
        friend bool operator==(const WorstError&, const WorstError&) = default;
    };
    /// Float with a wrong decision of the form.
    struct WrongDecision {
        std::uint32_t float_index;
        answer::Outcome outcome;
        friend bool operator==(const WrongDecision&, const WrongDecision&) = default;
    };

    /// A missed hit, and the padding of tmax, in u, with which the form would find it.
    struct Padding {
        std::uint32_t float_index;
        double u;
        friend bool operator==(const Padding&, const Padding&) = default;
    };

    std::array<std::uint64_t, answer::outcome_names.size()> outcomes{};
    /// First float with the largest |error| among the floats where form and truth hit; see `try_floats`.
    std::optional<WorstError> worst;
    /// Upper bound of |error| over all floats; −1 if there is no float where form and truth both hit.
    double error_bound = -1;
    std::optional<WrongDecision> first_wrong, last_wrong;
    /// Index of the float where each of `first_events` first happens.
    std::array<std::optional<std::uint32_t>, first_events.size()> first_floats;
    /// For a form that tests a box: among the hits that it misses, the first with the largest gap between slabs; empty
    /// if no missed hit has such a gap.
    std::optional<Padding> padding;

    [[nodiscard]] std::uint64_t count(answer::Outcome outcome) const {
        return outcomes[static_cast<std::size_t>(outcome)];
    }
    [[nodiscard]] std::uint64_t float_count() const;
    [[nodiscard]] std::uint64_t wrong_count() const;
    /// Adds the next float; the error is NaN unless form and truth hit.
    void add(std::uint32_t float_index, answer::Outcome outcome, double ulps);
    /// Appends the counts of the floats that come after these.
    void append(const FloatTally& next_part);
    friend bool operator==(const FloatTally&, const FloatTally&) = default;
};

/// Part of an axis that has a tally of its own: the floats of a range that lie in one binade, in the order of the
/// range.
struct BinadePart {
    std::size_t range;  ///< index in the file's ranges
    scene::sweep::Binade binade;
    scene::sweep::FloatRange floats;
};
std::vector<BinadePart> split_into_binades(const scene::sweep::ExhaustiveFile& sweep);

struct ExhaustiveRequest;

/// Progress of a run: all that is needed to continue it.
struct ExhaustiveState {
    /// Floats of the share tried so far, in order, each with every form on every ray.
    std::uint64_t tried_float_count = 0;
    std::vector<FloatTally> tallies;  ///< see `ExhaustiveRequest::tally_index`
    truth::StageCounts stages{};      ///< counts of truths; their sum depends on how often forms shared a truth

    /// Appends the results of the next share.
    void append(const ExhaustiveState& next_share);
    /// Throws std::out_of_range if the state cannot be the result of `request`.
    void require_match(const ExhaustiveRequest& request) const;
};

struct ExhaustiveRequest {
    const scene::sweep::ExhaustiveFile& sweep;
    std::vector<evaluate::TestedForm> tested_forms = {};  ///< all in binary32
    truth::ProofLimit limit{};
    std::string scene = {};   ///< for a sweep across a mesh: the scene as a command line names it
    shard::Share share = {};  ///< share of the blocks into which every binade is cut
    /// Called with the number of further floats tried, each counted once per ray and form.
    std::function<void(std::uint64_t)> progress = [](std::uint64_t) {};
    /// Called between two parts of the work, when the state is complete.
    std::function<void(const ExhaustiveState&)> store_state = [](const ExhaustiveState&) {};

    /// Index of the tally of a form on a ray in a binade.
    [[nodiscard]] std::size_t tally_index(std::size_t binade, std::size_t ray, std::size_t form_index) const {
        return (binade * sweep.rays.size() + ray) * tested_forms.size() + form_index;
    }
};

/// Results of a form on a ray over all floats of a range.
struct RangeFinding {
    std::size_t range, ray, row;
    scene::sweep::FloatRange floats;
    FloatTally tally;  ///< over the floats that were tried, which may be fewer than the range has

    /// Float before another in the order of the range; empty for the first float.
    [[nodiscard]] std::optional<std::uint32_t> float_before(std::uint32_t float_index) const;
};

/// Findings by row, ray and range.
std::vector<RangeFinding> collect_findings(const ExhaustiveRequest& request, const ExhaustiveState& state);

/// Number of floats in a share.
std::uint64_t count_floats(const scene::sweep::ExhaustiveFile& sweep, shard::Share share);

/// Continues until every float of the share is tried. The result depends neither on the number of threads nor on how
/// often the run was stopped. If it throws, for example Interrupted, the state is complete: the last one that
/// `store_state` was called with, or a later one.
void run_exhaustive(const ExhaustiveRequest& request, ExhaustiveState& state);

/// Consecutive floats of an axis, on one of its rays.
struct FloatsOnRay {
    const ExhaustiveRequest& request;
    std::size_t ray = 0;
    scene::sweep::FloatRange floats;
};

/// Largest number of floats that one form refines in one block.
inline constexpr std::size_t max_refined_floats = 4096;

/// Runs the forms of the request on these floats; one tally per form.
///
/// The worst error is computed from the complete truth (`find_truth`) at its float. Floats that may be worse are
/// refined, so that no error exceeds the worst one by more than 2^-20 of the worst one or 2^-20 ulp, whichever is
/// larger. If thousands of neighbouring floats are equally bad to within 2^-8 ulp, for example because t* hardly
/// depends on the axis, at most `max_refined_floats` are refined. `error_bound` bounds the errors of the others. If the
/// columns leave open whether a loss reaches a number of bits, the complete truth decides.
std::vector<FloatTally> try_floats(const FloatsOnRay& floats_on_ray, truth::StageCounts& stages);

/// Padding of tmax, in u, with which no hit is missed because of a gap between slabs; 0 if no hit is missed for that
/// reason, NaN for a form that tests no box.
double max_padding(const evaluate::TestedForm& tested_form, const FloatTally& tally);

/// Like `try_floats`, for a sweep across a mesh. Every float is compared with the complete truth of its ray, and its
/// error is the metric `ulp_error`: nothing is left open.
std::vector<FloatTally> try_floats_as_rays(const FloatsOnRay& floats_on_ray, truth::StageCounts& stages);

/// Result of one form at one float.
struct FloatAnswer {
    answer::Outcome outcome = answer::Outcome::agree_miss;
    double t = truth::missing;      ///< the form's answer; NaN for a miss
    double truth = truth::missing;  ///< t* in the unit of the answer, correctly rounded to binary64; NaN for a miss
    double ulps = truth::missing;   ///< (t − t*)/ulp(t*); NaN unless both hit
};
FloatAnswer answer_at(const ExhaustiveRequest& request, std::size_t ray, std::size_t form_index,
                      std::uint32_t float_index);

}  // namespace lostbits::measure::sweep
