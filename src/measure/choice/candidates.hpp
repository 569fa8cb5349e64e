// Every form and format on the rays of a scene or of files: what it keeps, what it decides wrongly and what it costs,
// in one run.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "measure/evaluate/evaluate.hpp"
#include "measure/speed/scene_work.hpp"

namespace lostbits::measure::choice {

using speed::thinned;

/// What a user asks of an intersector.
struct Wish {
    double bits = 0;   ///< correct bits of t, at least
    double wrong = 0;  ///< share of the rays whose decision may be wrong: false or missed hits, NaN, another solid
    double quantile = 0.99;  ///< of the agreed hits, so many keep those bits; 1: every one
    double tolerance = std::numeric_limits<double>::infinity();  ///< `distance_error` of as many, at most

    [[nodiscard]] bool has_tolerance() const { return tolerance < std::numeric_limits<double>::infinity(); }
    /// What is measured for it: `lost_bits`, and where there is a tolerance `distance_error`.
    [[nodiscard]] std::vector<const metric::Metric*> metrics() const;
};

/// `p99`, `p99.9`, `max`: the share of the hits. InputError for any other word.
double quantile_named(const std::string& text);

/// What a row of a map is worth to a wish.
struct Worth {
    std::uint64_t rays = 0;                  ///< whose truth is known
    std::uint64_t wrong = 0;                 ///< of these, decided wrongly
    std::optional<answer::Outcome> first{};  ///< the most frequent way
    std::uint64_t of_first = 0;              ///< so many in that way
    double kept_bits = 0;    ///< p − lost bits, at the wish's quantile of the agreed hits; NaN where none is agreed
    std::uint64_t hits = 0;  ///< rays that truly hit
    double off = truth::missing;  ///< `distance_error` at the same quantile; NaN where the wish has no tolerance

    [[nodiscard]] double wrong_fraction() const {
        return rays == 0 ? 0 : static_cast<double>(wrong) / static_cast<double>(rays);
    }
    [[nodiscard]] bool decides(const Wish& wish) const { return wrong_fraction() <= wish.wrong; }
    [[nodiscard]] bool meets(const Wish& wish) const {
        return decides(wish) && kept_bits >= wish.bits && (!wish.has_tolerance() || off <= wish.tolerance);
    }
};

/// A form in a format, as it would be called.
struct Candidate {
    evaluate::TestedForm row;
    std::string_view isa = {};  ///< of the registers: `scalar`, `128`, ...
    speed::Timing time{};       ///< seconds a ray and solid
    Worth worth{};
};

struct FileRays;

struct ChoiceRequest {
    const scene::file::Scene* scene = nullptr;       ///< what the choice is for; null where it is for rays of files
    const FileRays* rays = nullptr;                  ///< judged for these rows and this wish
    std::vector<evaluate::TestedForm> rows = {};     ///< f32 and f64 alone
    std::vector<evaluate::TestedForm> untimed = {};  ///< in emulated formats: asked only what each pixel requires
    Wish wish{};
    bool single = false;  ///< one ray at a time, not a register full
    speed::TimingPlan plan{};
    truth::TruthLimit limit{};
    std::vector<evaluate::Show> shows = {};  ///< what `measure_candidates` shows its rows to, in their order; or none
    /// Rays and rows done; may throw to stop. The plan's own progress counts its measurements.
    std::function<void(std::uint64_t)> progress = [](std::uint64_t) {};

    /// Of the scene, or of the files: what results are called.
    [[nodiscard]] const std::string& id() const;
};

/// What a summary, of the wish's metrics, is worth to it.
Worth worth_of(const evaluate::FormSummary& summary, const evaluate::TestedForm& row, const Wish& wish);
/// The same of a row on a band.
Worth worth_on(const truth::Band& band, const evaluate::TestedForm& row, const Wish& wish);
/// And where the row is given other inputs than the band's.
Worth worth_on(const truth::Band& band, const truth::FormatInputs& inputs, const evaluate::TestedForm& row,
               const Wish& wish);

/// The worth of every row on the scene, at the scene's size; `progress` as above.
std::vector<Worth> worth_of(const ChoiceRequest& request);

/// The format that a row computes in: that of its inputs and answers, but where the formula goes to the wider one and
/// back on the plainest ray.
Format computes_in(const evaluate::TestedForm& row);

/// What was timed, see `speed::SceneWork`.
struct TimedRays {
    std::size_t rays = 0, solids = 0;
};

/// Every row, in the request's order: its worth, and its time on rays of the scene or of the files themselves.
std::vector<Candidate> measure_candidates(const ChoiceRequest& request, TimedRays& timed);

/// The places of all, cheapest first.
std::vector<std::size_t> by_price(const std::vector<Candidate>& all);

/// The fastest that meets the wish; the fastest and the most accurate of all (fewest wrong decisions, then most bits);
/// nothing where the list is empty or nothing meets it.
std::optional<std::size_t> cheapest(const std::vector<Candidate>& all, const Wish& wish);
std::optional<std::size_t> fastest(const std::vector<Candidate>& all);
std::optional<std::size_t> most_accurate(const std::vector<Candidate>& all);
/// What comes nearest to a wish that nothing meets: of those that decide well enough the one that keeps most bits; if
/// there is none, the one that decides fewest rays wrongly.
std::optional<std::size_t> nearest(const std::vector<Candidate>& all, const Wish& wish);

}  // namespace lostbits::measure::choice
