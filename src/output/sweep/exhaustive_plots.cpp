// Plots of an exhaustive sweep over the binades.
#include "output/sweep/exhaustive_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "measure/truth/lost_bits.hpp"
#include "measure/truth/missing.hpp"
#include "output/map/form_names.hpp"
#include "output/plot/form_look.hpp"
#include "output/sweep/sweep_plots.hpp"

namespace lostbits::output::sweep {

using measure::sweep::BinadePart;
using measure::sweep::FloatTally;

namespace {

/// Value of a binade for the plot; NaN if it has none.
using TallyValue = std::function<double(const FloatTally&)>;

/// True if the floats of a binade are on the axis, which shows sizes. Zeros, infinities and NaNs are not on it.
bool is_on_axis(const BinadePart& part) {
    using K = scene::sweep::Binade::Kind;
    return part.binade.kind == K::normal || part.binade.kind == K::subnormal;
}

/// Sizes of the smallest and the largest float of a binade that were tried.
struct SizeRange {
    double low, high;
};
SizeRange size_range_of(const BinadePart& part) {
    const auto size = [](std::uint32_t float_index) {
        return static_cast<double>(std::fabs(scene::sweep::float_at(float_index)));
    };
    const auto [low, high] = std::minmax({size(part.floats.first), size(part.floats.last)});
    return {low, high};
}

/// One sign of the axis, for one form and ray.
struct AxisHalf {
    std::size_t row, ray;
    bool is_negative;
};

/// The binades that are drawn, and the labels of their lines and axes.
class DrawnBinades {
public:
    DrawnBinades(const ExhaustiveRequest& request, const ExhaustiveState& state)
        : request_(request), state_(state), parts_(measure::sweep::split_into_binades(request.sweep)) {
        for (const BinadePart& part : parts_) {
            if (!is_on_axis(part)) {
                omits_floats_ = true;
                continue;
            }
            ++(part.binade.negative ? negative_count_ : positive_count_);
            const auto [low, high] = size_range_of(part);
            size_range_ = {std::min(size_range_.low, low), std::max(size_range_.high, high)};
        }
    }

    [[nodiscard]] bool is_worth_drawing() const { return std::max(negative_count_, positive_count_) >= 2; }

    /// A line over the sizes, with one value for each binade.
    [[nodiscard]] plot::Series series(const AxisHalf& half, const TallyValue& value) const {
        plot::Series series{.label = label(half), .look = plot::form_look(*request_.tested_forms[half.row].form)};
        for (std::size_t b = 0; b < parts_.size(); ++b) {
            if (!is_on_axis(parts_[b]) || parts_[b].binade.negative != half.is_negative) continue;
            const auto [low, high] = size_range_of(parts_[b]);
            const double y = value(state_.tallies[request_.tally_index(b, half.ray, half.row)]);
            const bool goes_last = series.x.empty() || series.x.back() < low;
            series.x.insert(goes_last ? series.x.end() : series.x.begin(), {low, high});
            series.y.insert(goes_last ? series.y.end() : series.y.begin(), {y, y});
        }
        return series;
    }

    [[nodiscard]] plot::AxisSpec axis() const {
        const auto& axis = request_.sweep.axis;
        // Less than two octaves have too few powers of two for ticks.
        const bool has_few_octaves = size_range_.high < 4 * size_range_.low;
        return {.title = axis.label + (negative_count_ == 0   ? ""
                                       : positive_count_ == 0 ? ", below 0, in size"
                                                              : ", in size"),
                .scale = has_few_octaves ? plot::AxisSpec::Scale::linear : plot::AxisSpec::Scale::log2,
                .low = size_range_.low,
                .high = size_range_.high};
    }

    [[nodiscard]] std::vector<std::string> subtitle() const {
        std::vector<std::string> lines{request_.sweep.title, "every float in each binade was tried"};
        if (const auto touching = request_.sweep.convention)
            lines.front() += fmt::format(", judged by the {} primitive", intersect::convention_name(touching));
        if (omits_floats_) lines.back() += "; zeros, infinities and NaNs are only in the tables";
        return lines;
    }

    [[nodiscard]] std::vector<AxisHalf> halves() const {
        std::vector<AxisHalf> list;
        for (std::size_t form_index = 0; form_index < request_.tested_forms.size(); ++form_index) {
            for (std::size_t ray = 0; ray < request_.sweep.rays.size(); ++ray) {
                if (positive_count_ > 0) list.push_back({.row = form_index, .ray = ray, .is_negative = false});
                if (negative_count_ > 0) list.push_back({.row = form_index, .ray = ray, .is_negative = true});
            }
        }
        return list;
    }

private:
    /// `signs`, `signs (half)`, `signs (half, x < 0)`.
    [[nodiscard]] std::string label(const AxisHalf& half) const {
        const auto& sweep = request_.sweep;
        std::string qualifier = sweep.rays.size() > 1 ? sweep.rays[half.ray].name : "";
        if (negative_count_ > 0 && positive_count_ > 0)
            qualifier +=
                fmt::format("{}{} {} 0", qualifier.empty() ? "" : ", ", sweep.axis.name, half.is_negative ? '<' : '>');
        const std::string name = map::short_name(*request_.tested_forms[half.row].form->info);
        return qualifier.empty() ? name : fmt::format("{} ({})", name, qualifier);
    }

    const ExhaustiveRequest& request_;
    const ExhaustiveState& state_;
    std::vector<BinadePart> parts_;
    int negative_count_ = 0, positive_count_ = 0;  ///< number of binades of each sign that are drawn
    bool omits_floats_ = false;                    ///< some floats are not on the axis
    SizeRange size_range_{std::numeric_limits<double>::infinity(), 0};
};

}  // namespace

std::optional<ExhaustivePlots> exhaustive_plots(const ExhaustiveRequest& request, const ExhaustiveState& state) {
    const DrawnBinades binades(request, state);
    if (!binades.is_worth_drawing()) return std::nullopt;

    using S = plot::AxisSpec::Scale;
    plot::LinePlotSpec lost{.title = "Lost bits of the worst float in f32",
                            .subtitle = binades.subtitle(),
                            .x = binades.axis(),
                            .y = lost_bits_axis(binary32, "f32")};
    plot::LinePlotSpec wrong{.title = "Floats with a wrong decision in f32",
                             .subtitle = binades.subtitle(),
                             .x = binades.axis(),
                             .y = {.title = "share of the tried floats in the binade",
                                   .scale = S::log2,
                                   .low = smallest_fraction,
                                   .high = 1.0,
                                   .shows_zero = true}};
    wrong.subtitle.emplace_back("a line at 0, below the log scale, means no such float in that binade");

    for (const AxisHalf& half : binades.halves()) {
        lost.series.push_back(binades.series(half, [](const FloatTally& t) {
            return t.worst ? measure::truth::lost_bits(t.worst->ulps, binary32.precision) : measure::truth::missing;
        }));
        wrong.series.push_back(binades.series(
            half, [](const FloatTally& t) { return measure::truth::fraction(t.wrong_count(), t.float_count()); }));
    }
    return ExhaustivePlots{std::move(lost), std::move(wrong)};
}

}  // namespace lostbits::output::sweep
