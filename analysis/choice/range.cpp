#include "analysis/choice/range.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "number/error.hpp"

namespace lostbits::analysis::choice {

using measure::metric::Metric;
using measure::metric::Ramp;

namespace {

std::optional<double> number(std::string_view text) {
    double value = 0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool whole = error == std::errc{} && stop == text.data() + text.size() && std::isfinite(value);
    return whole ? std::optional(value) : std::nullopt;
}

}  // namespace

std::optional<output::map::BarRange> parse_range(const std::string& text, const std::vector<const Metric*>& drawn) {
    if (text.empty()) return std::nullopt;
    const std::size_t colon = text.find(':');
    const auto lo = number(std::string_view(text).substr(0, colon));
    const auto hi = colon == std::string::npos ? std::nullopt : number(std::string_view(text).substr(colon + 1));
    if (!lo || !hi || !(*lo < *hi))
        throw InputError(fmt::format(
            "--range {}: is not a range; write its ends in the unit of the metric, the lower one first, like 0:24",
            text));
    const Metric* first = nullptr;
    for (const Metric* m : drawn) {
        if (m->ramp == Ramp::categories) continue;
        if (first && (m->unit != first->unit || (m->ramp == Ramp::magnitude) != (first->ramp == Ramp::magnitude)))
            throw InputError(fmt::format("--range {}: {} and {} have different units; draw them in two runs", text,
                                         first->name, m->name));
        first = m;
    }
    if (!first) throw InputError(fmt::format("--range {}: what is drawn has names for colours, and no bar", text));
    if (first->ramp == Ramp::magnitude && !(*lo > 0))
        throw InputError(fmt::format("--range {}: the bar of {} is logarithmic, so both ends are above 0, like 1:1000",
                                     text, first->name));
    return output::map::BarRange{*lo, *hi};
}

}  // namespace lostbits::analysis::choice
