#include "measure/answer/against.hpp"

#include <cmath>

#include "measure/truth/lost_bits.hpp"
#include "measure/truth/missing.hpp"

namespace lostbits::measure::answer {
namespace {

bool is_same_t(double t, double other) { return t == other || (std::isnan(t) && std::isnan(other)); }

double signed_ulps(double t, double other, const FloatFormat& format) {
    if (is_same_t(t, other)) return 0;
    if (!std::isfinite(t) || !std::isfinite(other)) return HUGE_VAL;
    return truth::ulp_error(t, truth::as_certified(other), format);
}

AgainstOutcome classify_against(bool hit, bool other_hit, double t, double other, bool comparable) {
    if (!hit) return other_hit ? AgainstOutcome::other_alone_hits : AgainstOutcome::both_miss;
    if (!other_hit) return AgainstOutcome::alone_hits;
    if (!comparable) return AgainstOutcome::incomparable_t;
    return is_same_t(t, other) ? AgainstOutcome::same_t : AgainstOutcome::other_t;
}

}  // namespace

bool are_comparable(const intersect::Info& a, const intersect::Info& b) {
    return a.roots != intersect::Roots::none && b.roots != intersect::Roots::none && a.direction == b.direction;
}

void compare_against(const Answers& answers, const Answers& other, bool comparable, const FloatFormat& format,
                     std::span<double> outcomes, std::span<double> distances) {
    for (std::size_t i = 0; i < answers.hit.size(); ++i) {
        const bool hit = answers.hit[i] != 0, other_hit = other.hit[i] != 0;
        const AgainstOutcome outcome = classify_against(hit, other_hit, answers.t[i], other.t[i], comparable);
        if (!outcomes.empty()) outcomes[i] = static_cast<double>(outcome);
        if (!distances.empty())
            distances[i] =
                hit && other_hit && comparable ? signed_ulps(answers.t[i], other.t[i], format) : truth::missing;
    }
}

}  // namespace lostbits::measure::answer
