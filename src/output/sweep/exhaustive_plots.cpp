#include "output/sweep/exhaustive_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "measure/truth/lost_bits.hpp"
#include "measure/truth/missing.hpp"
#include "output/map/row_names.hpp"
#include "output/plot/form_look.hpp"
#include "output/sweep/sweep_plots.hpp"

namespace lostbits::output::sweep {

using measure::sweep::BinadePart;
using measure::sweep::FloatTally;

namespace {

/// Value of a binade for the plot; NaN if it has none.
using OfTally = std::function<double(const FloatTally&)>;

/// Zeros, infinities and NaNs are not on an axis of sizes.
bool has_place(const BinadePart& part) {
    using K = scene::sweep::Binade::Kind;
    return part.binade.kind == K::normal || part.binade.kind == K::subnormal;
}

/// Sizes of the smallest and the largest float of a binade that were tried.
struct Sizes {
    double low, high;
};
Sizes sizes_of(const BinadePart& part) {
    const auto size = [](std::uint32_t place) { return static_cast<double>(std::fabs(scene::sweep::float_at(place))); };
    const auto [low, high] = std::minmax({size(part.floats.first), size(part.floats.last)});
    return {low, high};
}

/// One sign of the axis, for one form and ray.
struct AxisHalf {
    std::size_t row, ray;
    bool negative;
};

/// The binades that are drawn, and their labels.
class DrawnBinades {
public:
    DrawnBinades(const ExhaustiveRequest& request, const ExhaustiveState& state)
        : request_(request), state_(state), parts_(measure::sweep::binades_of(request.sweep)) {
        for (const BinadePart& part : parts_) {
            if (!has_place(part)) {
                lacks_ = true;
                continue;
            }
            ++(part.binade.negative ? below_ : above_);
            const auto [low, high] = sizes_of(part);
            sizes_ = {std::min(sizes_.low, low), std::max(sizes_.high, high)};
        }
    }

    [[nodiscard]] bool worthwhile() const { return std::max(below_, above_) >= 2; }

    /// A line that is level in each binade, by rising size.
    [[nodiscard]] plot::Series series(const AxisHalf& half, const OfTally& value) const {
        plot::Series series{.label = label(half), .look = plot::form_look(*request_.rows[half.row].form)};
        for (std::size_t b = 0; b < parts_.size(); ++b) {
            if (!has_place(parts_[b]) || parts_[b].binade.negative != half.negative) continue;
            const auto [low, high] = sizes_of(parts_[b]);
            const double y = value(state_.tallies[request_.place(b, half.ray, half.row)]);
            const bool rises = series.x.empty() || series.x.back() < low;
            series.x.insert(rises ? series.x.end() : series.x.begin(), {low, high});
            series.y.insert(rises ? series.y.end() : series.y.begin(), {y, y});
        }
        return series;
    }

    [[nodiscard]] plot::AxisSpec axis() const {
        const auto& axis = request_.sweep.axis;
        // Less than two octaves have too few powers of two for ticks.
        const bool few = sizes_.high < 4 * sizes_.low;
        return {axis.label + (below_ == 0   ? ""
                              : above_ == 0 ? ", below 0, in size"
                                            : ", in size"),
                few ? plot::AxisSpec::Scale::linear : plot::AxisSpec::Scale::log2, sizes_.low, sizes_.high};
    }

    [[nodiscard]] std::vector<std::string> subtitle() const {
        std::vector<std::string> lines{request_.sweep.title, "every float in each binade was tried"};
        if (const auto judged = request_.sweep.convention)
            lines.front() += fmt::format(", judged by the {} primitive", intersect::convention_name(judged));
        if (lacks_) lines.back() += "; zeros, infinities and NaNs are only in the tables";
        return lines;
    }

    [[nodiscard]] std::vector<AxisHalf> halves() const {
        std::vector<AxisHalf> all;
        for (std::size_t row = 0; row < request_.rows.size(); ++row) {
            for (std::size_t ray = 0; ray < request_.sweep.rays.size(); ++ray) {
                if (above_ > 0) all.push_back({row, ray, false});
                if (below_ > 0) all.push_back({row, ray, true});
            }
        }
        return all;
    }

private:
    /// `signs`, `signs (half)`, `signs (half, x < 0)`.
    [[nodiscard]] std::string label(const AxisHalf& half) const {
        const auto& sweep = request_.sweep;
        std::string of = sweep.rays.size() > 1 ? sweep.rays[half.ray].name : "";
        if (below_ > 0 && above_ > 0)
            of += fmt::format("{}{} {} 0", of.empty() ? "" : ", ", sweep.axis.name, half.negative ? '<' : '>');
        const std::string name = map::short_name(*request_.rows[half.row].form->info);
        return of.empty() ? name : fmt::format("{} ({})", name, of);
    }

    const ExhaustiveRequest& request_;
    const ExhaustiveState& state_;
    std::vector<BinadePart> parts_;
    int below_ = 0, above_ = 0;  ///< number of binades of each sign that are drawn
    bool lacks_ = false;         ///< some floats are not on the axis
    Sizes sizes_{std::numeric_limits<double>::infinity(), 0};
};

}  // namespace

std::optional<ExhaustivePlots> exhaustive_plots(const ExhaustiveRequest& request, const ExhaustiveState& state) {
    const DrawnBinades drawn(request, state);
    if (!drawn.worthwhile()) return std::nullopt;
    using S = plot::AxisSpec::Scale;
    plot::LinePlotSpec lost{.title = "Lost bits of the worst float in f32",
                            .subtitle = drawn.subtitle(),
                            .x = drawn.axis(),
                            .y = lost_bits_axis(binary32, "f32")};
    plot::LinePlotSpec wrong{.title = "Floats with a wrong decision in f32",
                             .subtitle = drawn.subtitle(),
                             .x = drawn.axis(),
                             .y = {"share of the tried floats in the binade", S::log2, least_share, 1.0, true}};
    wrong.subtitle.emplace_back("a line at 0, below the log scale, means no such float in that binade");
    for (const AxisHalf& half : drawn.halves()) {
        lost.series.push_back(drawn.series(half, [](const FloatTally& t) {
            return t.worst ? measure::truth::lost_bits(t.worst->ulps, binary32.precision) : measure::truth::missing;
        }));
        wrong.series.push_back(
            drawn.series(half, [](const FloatTally& t) { return measure::truth::fraction(t.wrong(), t.floats()); }));
    }
    return ExhaustivePlots{std::move(lost), std::move(wrong)};
}

}  // namespace lostbits::output::sweep
