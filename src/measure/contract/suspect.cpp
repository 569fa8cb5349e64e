#include "measure/contract/suspect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <optional>

#include "measure/contract/suspect_reasons.hpp"

namespace lostbits::measure::contract {
namespace {

using AnswerTest = std::function<bool(const AnswerSample&)>;

std::size_t count_unexplained(const std::vector<AnswerSample>& answers, const AnswerTest& explains) {
    return answers.size() - static_cast<std::size_t>(std::ranges::count_if(answers, explains));
}

/// True if at least nine in ten of the answers are explained, and there is at least one answer.
bool explains_most(const std::vector<AnswerSample>& answers, const AnswerTest& explains) {
    return !answers.empty() && 10 * count_unexplained(answers, explains) <= answers.size();
}

/// Text of a factor. Factors are known to a relative 2^-8, so 1000.02 is written as 1000. If the factor is the ratio of
/// two known units, the text names them.
std::string factor_text(double factor) {
    for (const KnownUnits& units : known_units) {
        if (is_about(factor, units.factor))
            return fmt::format("{:.4g} times what is right: {}?", units.factor, units.text);
    }
    return fmt::format("{:.3g} times what is right", factor);
}

/// True for a factor between known units, and for a large power of two or ten: people write such factors on purpose.
bool is_round(double factor) {
    const auto is_power = [factor](double base) {
        return is_about(factor, std::pow(base, std::round(std::log(factor) / std::log(base))));
    };
    if (factor > 0 && std::fabs(std::log2(factor)) >= 3 && (is_power(2) || is_power(10))) return true;
    return std::ranges::any_of(known_units,
                               [factor](const KnownUnits& units) { return is_about(factor, units.factor); });
}

/// Text for wrong answers that no known mistake explains: their counts by kind, or what is wrong with a single wrong
/// answer.
std::string error_counts_text(const std::vector<AnswerSample>& wrong) {
    const bool is_single = wrong.size() == 1;
    std::size_t false_miss_count = 0, false_hit_count = 0, not_finite = 0;
    for (const AnswerSample& sample : wrong) {
        false_miss_count += !sample.hit;
        false_hit_count += sample.hit && !sample.truly_hits;
        not_finite += sample.hit && sample.truly_hits && !std::isfinite(sample.t);
    }

    std::string text;
    const auto add = [&](std::size_t n, const char* single_text, const char* one_text, const char* many_text) {
        if (n == 0) return;
        if (is_single) text = single_text;
        else text += fmt::format("{}{} {}", text.empty() ? "" : ", ", n, n == 1 ? one_text : many_text);
    };
    add(false_hit_count, "it hits what it should miss", "hits what it should miss", "hit what they should miss");
    add(false_miss_count, "it misses what it should hit", "misses what it should hit", "miss what they should hit");
    add(not_finite, "its t is not a finite number", "has a t that is not a finite number",
        "have a t that is not a finite number");
    add(wrong.size() - false_hit_count - false_miss_count - not_finite, "its t is off by more than 0.4%",
        "has a t that is off by more than 0.4%", "have a t that is off by more than 0.4%");
    return fmt::format("{}; no known mistake explains {}", text, is_single ? "it" : "nine in ten of them");
}

/// Answers to analyse: of the rays that hit or should hit, or of a part of these rays.
struct SuspectAnswers {
    std::vector<AnswerSample> all, wrong, right_misses;  ///< `all` does not contain the right misses
    std::uint64_t more_right_misses = 0;                 ///< right misses of which only the number is known

    SuspectAnswers() = default;
    template <class Belongs>
    SuspectAnswers(const std::vector<AnswerSample>& rays, const Belongs& belongs) {
        for (const AnswerSample& sample : rays) add(sample, belongs(sample));
    }
    explicit SuspectAnswers(const std::vector<AnswerSample>& rays)
        : SuspectAnswers(rays, [](const AnswerSample& sample) { return sample.hit || sample.truly_hits; }) {}

    void add(const AnswerSample& sample, bool belongs = true) {
        if (!sample.hit && !sample.truly_hits) return right_misses.push_back(sample);
        if (!belongs) return;
        all.push_back(sample);
        if (!is_right(sample)) wrong.push_back(sample);
    }

    /// Divides every kind of answer into two halves: a guess made from one half is tested on the other.
    [[nodiscard]] std::array<SuspectAnswers, 2> halves() const {
        std::array<SuspectAnswers, 2> parts;
        std::array<std::size_t, 8> counts{};  // of each kind
        const auto divide = [&](const std::vector<AnswerSample>& answers) {
            for (const AnswerSample& sample : answers) {
                const std::size_t kind =
                    (sample.hit ? 1U : 0U) + (sample.truly_hits ? 2U : 0U) + (is_right(sample) ? 4U : 0U);
                parts[counts[kind]++ % 2].add(sample);
            }
        };
        divide(all);
        divide(right_misses);
        for (SuspectAnswers& half : parts) half.more_right_misses = more_right_misses / 2;
        return parts;
    }

    [[nodiscard]] bool is_mostly_wrong() const { return !wrong.empty() && 2 * wrong.size() >= all.size(); }
    /// Text with the number of wrong answers. `conjunction` is "and" for the rays that hit and should hit, "or" for the
    /// rays that hit or should hit.
    [[nodiscard]] std::string count_text(const char* conjunction) const {
        if (all.size() == 1) return fmt::format("wrong on the only ray that hits {} should hit: ", conjunction);
        if (wrong.size() == all.size())
            return fmt::format("all {} rays that hit {} should hit are wrong; ", all.size(), conjunction);
        return fmt::format("wrong on {} of the {} rays that hit {} should hit: ", wrong.size(), all.size(),
                           conjunction);
    }
    /// True if a reason explains nine in ten of the wrong answers. A reason that would change right answers too has to
    /// explain nine in ten of all answers and of the hits, and right misses count against it.
    [[nodiscard]] bool is_explained_by(const SuspectedMistake& reason) const {
        using AffectedAnswers = SuspectedMistake::AffectedAnswers;
        if (!explains_most(wrong, reason.explains)) return false;
        if (reason.scope == AffectedAnswers::t || reason.scope == AffectedAnswers::wrong) return true;
        std::vector<AnswerSample> hits;
        std::ranges::copy_if(all, std::back_inserter(hits), [](const AnswerSample& sample) { return sample.hit; });
        const bool decides = reason.scope == AffectedAnswers::decisions;
        const std::size_t unexplained = count_unexplained(all, reason.explains) +
                                        count_unexplained(right_misses, reason.explains) +
                                        (decides ? more_right_misses : 0);
        return 10 * unexplained <= all.size() && explains_most(hits, reason.explains) &&
               2 * unexplained < unexplained_by_constants(hits, decides);
    }

private:
    /// Number of answers left unexplained by the better of two constants: "every ray misses", and "every ray hits where
    /// it truly does". A guess that does no better explains nothing.
    [[nodiscard]] std::size_t unexplained_by_constants(const std::vector<AnswerSample>& hits, bool decides) const {
        const std::size_t misses = all.size() - hits.size() + right_misses.size() + more_right_misses;
        const auto needs_no_t = [decides](const AnswerSample& sample) {
            return decides || std::isnan(sample.t) || is_right(sample);
        };
        return std::min(hits.size(), misses + count_unexplained(hits, needs_no_t));
    }
};

double median_of(std::vector<double> numbers) {
    const auto middle = numbers.begin() + static_cast<std::ptrdiff_t>(numbers.size() / 2);
    std::ranges::nth_element(numbers, middle);
    return *middle;
}

/// A factor and a constant, one of which may explain how t is off.
struct UnitGuess {
    double factor, offset;

    [[nodiscard]] bool is_off_by_factor(const AnswerSample& sample) const {
        return sample.hit && sample.truly_hits && is_about(sample.t, factor * sample.true_t);
    }
    [[nodiscard]] bool is_off_by_offset(const AnswerSample& sample) const {
        return sample.hit && sample.truly_hits && is_about(sample.t, sample.true_t + offset);
    }
};

/// Guesses from the medians of some wrong answers; nothing if none has a t that can be compared.
std::optional<UnitGuess> guess_units(const std::vector<AnswerSample>& wrong) {
    std::vector<double> factors, offsets;
    for (const AnswerSample& sample : wrong) {
        if (!sample.hit || !sample.truly_hits || !(sample.true_t > 0) || !std::isfinite(sample.t) || sample.t == 0)
            continue;
        factors.push_back(sample.t / sample.true_t);
        offsets.push_back(sample.t - sample.true_t);
    }
    if (factors.empty()) return std::nullopt;
    return UnitGuess{median_of(factors), median_of(offsets)};
}

/// Finds a factor by which t is off in nine in ten of the wrong hits, false hits included. Returns a text about it;
/// empty if no factor fits. The factor is the median of one half of the answers and must hold for both halves. It is
/// not accepted if all answers have the same t. A factor that is not round is accepted only if the true t differ by
/// more than a twentieth, and if adding a constant to the true t does not explain nine in ten as well. Near 1, and
/// where all t are about the same, a factor and a constant cannot be told apart.
std::string units_text(const std::array<SuspectAnswers, 2>& halves) {
    const std::optional<UnitGuess> guess = guess_units(halves.front().wrong);
    if (!guess) return "";
    const auto is_off_by_factor = [&guess](const AnswerSample& sample) { return guess->is_off_by_factor(sample); };
    const auto is_off_by_offset = [&guess](const AnswerSample& sample) { return guess->is_off_by_offset(sample); };
    const auto holds_in_both = [&halves](const AnswerTest& test) {
        return std::ranges::all_of(halves,
                                   [&test](const SuspectAnswers& half) { return explains_most(half.wrong, test); });
    };
    if (!holds_in_both(is_off_by_factor)) return "";

    // Tells a factor from a constant, and from an answer that is always the same, by the t that the factor explains.
    std::vector<double> true_ts, answers;
    for (const SuspectAnswers& half : halves) {
        for (const AnswerSample& sample : half.wrong) {
            if (!is_off_by_factor(sample)) continue;
            true_ts.push_back(sample.true_t);
            answers.push_back(sample.t);
        }
    }
    const auto [smallest, largest] = std::ranges::minmax(true_ts);
    const auto [lowest, highest] = std::ranges::minmax(answers);
    const bool is_not_offset = largest > 1.05 * smallest && !holds_in_both(is_off_by_offset);
    if (lowest == highest || !(is_round(guess->factor) || is_not_offset)) return "";
    return "t is in other units: it is " + factor_text(guess->factor);
}

}  // namespace

std::string suspicion_text(const std::vector<AnswerSample>& rays, AnswerSource source, std::uint64_t more_miss_count) {
    SuspectAnswers suspects(rays);
    suspects.more_right_misses = more_miss_count;
    if (!suspects.is_mostly_wrong()) return "";

    // If enough rays both hit and should hit, mistakes about t are tested on those rays only.
    const SuspectAnswers both_hit(rays, [](const AnswerSample& sample) { return sample.hit && sample.truly_hits; });
    const bool can_test_t = 2 * both_hit.all.size() >= suspects.all.size() && both_hit.is_mostly_wrong();

    // Finds the first known mistake that explains both halves of the answers.
    const std::array<SuspectAnswers, 2> halves = suspects.halves(), both_hit_halves = both_hit.halves();
    for (const SuspectedMistake& reason : reasons()) {
        const bool is_about_t = reason.scope == SuspectedMistake::AffectedAnswers::t;
        if (is_about_t && !can_test_t) continue;
        const auto is_explained = [&reason](const SuspectAnswers& half) { return half.is_explained_by(reason); };
        if (!std::ranges::all_of(is_about_t ? both_hit_halves : halves, is_explained)) continue;
        return fmt::format("{}{}; {}", is_about_t ? both_hit.count_text("and") : suspects.count_text("or"),
                           reason.mistake, source == AnswerSource::file ? reason.file_remedy : reason.library_remedy);
    }

    // Otherwise t may be in other units.
    const SuspectAnswers hits(rays, [](const AnswerSample& sample) { return sample.hit; });
    if (const std::string units = can_test_t ? units_text(hits.halves()) : ""; !units.empty())
        return both_hit.count_text("and") + units;
    return suspects.count_text("or") + error_counts_text(suspects.wrong);
}

}  // namespace lostbits::measure::contract
