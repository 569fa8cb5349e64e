#include "output/map/metric_paint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "measure/answer/against.hpp"
#include "output/map/culprit_table.hpp"

namespace lostbits::output::map {

using image::LegendEntry;
using image::Rgb8;
using measure::answer::Outcome;
using measure::map::MapSummary;
using measure::metric::Metric;
using measure::metric::Over;

namespace {

std::string percent(std::uint64_t part, std::uint64_t whole) {
    const double share = 100.0 * static_cast<double>(part) / static_cast<double>(whole);
    if (share < 0.1) return "<0.1%";
    if (share > 99 && share < 100) return ">99%";
    return fmt::format(fmt::runtime(share < 10 ? "{:.1f}%" : "{:.0f}%"), share);
}

std::string in_words(std::string_view name) {
    std::string words(name);
    std::ranges::replace(words, '_', ' ');
    return words;
}

std::string short_number(double x) {
    return std::fabs(x) >= 0.01 && std::fabs(x) < 10000 ? fmt::format("{:.3g}", x) : fmt::format("{:.1e}", x);
}

constexpr Rgb8 no_culprit{120, 90, 60};      ///< a hit to which no operation adds an error
constexpr std::size_t most_culprits = 6;     ///< that a legend names
constexpr std::size_t longest_culprit = 44;  ///< letters

std::string shortened(std::string_view text, std::size_t letters) {
    return text.size() <= letters ? std::string(text) : std::string(text.substr(0, letters - 2)) + "..";
}

/// Wrong decisions as shares of the rays that could be wrong so.
std::vector<std::string> faults_of(const MapSummary& s) {
    const std::uint64_t true_misses = s.rays - s.true_hits - s.count(Outcome::unresolved);
    std::vector<std::string> faults;
    if (const auto n = s.count(Outcome::false_miss)) faults.push_back(percent(n, s.true_hits) + " false miss");
    if (const auto n = s.count(Outcome::false_hit)) faults.push_back(percent(n, true_misses) + " false hit");
    if (const auto n = s.count(Outcome::not_a_number)) faults.push_back(percent(n, s.rays) + " NaN");
    return faults;
}

}  // namespace

MetricPaint::MetricPaint(const Metric& metric, std::span<const measure::map::MapRow> rows, image::ImageBackend& backend)
    : metric_(&metric) {
    if (metric.ramp != measure::metric::Ramp::categories) scale_ = metric_scale(metric, rows, backend);
}

bool MetricPaint::applies_to(const measure::map::MapRow& row) const {
    if (metric_->over == Over::pairs)  // how far apart: of t that mean the same alone
        return row.against != nullptr &&
               (!metric_->categories.empty() || measure::answer::are_comparable(*row.form->info, *row.against->info));
    return metric_->over != Over::marches || row.form->shape == Shape::sdf;
}

bool MetricPaint::shares_with(const Metric& other) const {
    const Metric& m = *metric_;
    return m.unit == other.unit && m.ramp == other.ramp && m.low == other.low && m.high == other.high &&
           m.over == other.over && m.categories.data() == other.categories.data();
}

Rgb8 MetricPaint::category_colour(std::size_t category) const {
    if (metric_->by_run()) return category == 0 ? no_culprit : image::distinct_colour(category - 1);
    if (metric_->categories.data() == intersect::stop_names.data()) return image::stop_colours[category];
    return image::object_colour(static_cast<std::uint32_t>(category + 1));
}

Rgb8 MetricPaint::colour(Outcome outcome, double value) const {
    if (metric_->over == Over::agreed_hits) return pixel_colour(*scale_, outcome, value);
    if (metric_->over == Over::blamed && std::isnan(value))
        return outcome == Outcome::agree_hit ? no_culprit : image::outcome_colours[static_cast<std::size_t>(outcome)];
    if (!scale_) return category_colour(static_cast<std::size_t>(value));
    return std::isnan(value) ? image::outcome_colours[static_cast<std::size_t>(Outcome::not_a_number)]
                             : scale_->map(value);
}

std::vector<LegendEntry> MetricPaint::widest(std::uint64_t pixels) const {
    if (metric_->over == Over::agreed_hits) return widest_legend(pixels);
    if (metric_->by_run()) {
        std::vector<LegendEntry> entries(
            most_culprits + 2, {std::string(longest_culprit, 'e'), no_culprit, fmt::format("{} (>99.9%)", pixels)});
        for (const Outcome o : {Outcome::agree_miss, Outcome::not_a_number, Outcome::unresolved})
            entries.push_back({plain_name(o), image::outcome_colours[static_cast<std::size_t>(o)],
                               fmt::format("{} (>99.9%)", pixels)});
        return entries;
    }
    std::vector<LegendEntry> entries;
    for (std::size_t c = 0; c < metric_->categories.size(); ++c)
        entries.push_back({in_words(metric_->categories[c]), category_colour(c), fmt::format("{} (>99.9%)", pixels)});
    return entries;
}

std::vector<LegendEntry> MetricPaint::legend(const MapSummary& summary, std::size_t m) const {
    if (metric_->over == Over::agreed_hits) return outcome_legend(summary);
    if (metric_->by_run()) return culprit_legend(summary, m);
    std::vector<LegendEntry> entries;
    for (std::size_t c = 0; c < metric_->categories.size(); ++c) {
        const std::uint64_t n = summary.categories[m][c];
        if (n > 0)
            entries.push_back({in_words(metric_->categories[c]), category_colour(c), count_text(n, summary.rays)});
    }
    return entries;
}

std::vector<LegendEntry> MetricPaint::culprit_legend(const MapSummary& summary, std::size_t m) const {
    const auto& counts = summary.categories[m];
    std::vector<LegendEntry> entries;
    std::uint64_t rest = 0;
    for (const std::size_t c : culprits_by_count(counts)) {
        if (entries.size() < most_culprits)
            entries.push_back({shortened(metric_->categories[c], longest_culprit), category_colour(c),
                               count_text(counts[c], summary.rays)});
        else rest += counts[c];
    }
    if (counts.front() > 0)
        entries.push_back({shortened(metric_->categories.front(), longest_culprit), no_culprit,
                           count_text(counts.front(), summary.rays)});
    if (rest > 0)
        entries.push_back(
            {"other operations, each in its own colour", image::style::page, count_text(rest, summary.rays)});
    for (std::size_t o = 0; o < summary.outcomes.size(); ++o) {
        const auto outcome = static_cast<Outcome>(o);
        if (summary.outcomes[o] == 0 || outcome == Outcome::agree_hit || outcome == Outcome::false_hit ||
            outcome == Outcome::false_miss)
            continue;
        entries.push_back(
            {plain_name(outcome), image::outcome_colours[o], count_text(summary.outcomes[o], summary.rays)});
    }
    return entries;
}

std::string MetricPaint::note() const {
    if (!scale_) return fmt::format("colour: {}", metric_->meaning);
    if (metric_->ramp == measure::metric::Ramp::magnitude)
        return fmt::format("colour: |{}|, clamped at both ends of the bar", metric_->name);
    return fmt::format("colour: {} from 0 to {:g}; more is drawn as {:g}", metric_->name, scale_->hi(), scale_->hi());
}

std::string MetricPaint::glance(const MapSummary& s, std::size_t m) const {
    if (metric_->by_run()) {
        const auto order = culprits_by_count(s.categories[m]);
        if (order.empty()) return "no culprit";
        return fmt::format("{}\n{}", percent(s.categories[m][order.front()], s.rays),
                           shortened(metric_->categories[order.front()], 48));
    }
    if (!metric_->categories.empty()) {
        std::vector<std::string> shares;
        for (std::size_t c = 0; c < metric_->categories.size(); ++c) {
            if (const std::uint64_t n = s.categories[m][c])
                shares.push_back(percent(n, s.rays) + " " + in_words(metric_->categories[c]));
        }
        return fmt::format("{}", fmt::join(shares, "\n"));
    }
    const measure::metric::Distribution& d = s.metrics[m];
    if (metric_->over == Over::marches || metric_->over == Over::pairs)
        return fmt::format("median {}\nlargest {}", short_number(d.quantile(0.5)), short_number(d.quantile(1)));
    const auto faults = faults_of(s);
    if (s.count(Outcome::agree_hit) == 0 && faults.empty()) return "no hits";
    std::string text = "no correct hit";
    if (s.count(Outcome::agree_hit) > 0) {
        if (metric_->name == "lost_bits") text = fmt::format("p99 {:.1f} bits lost", d.quantile(0.99));
        else
            text =
                d.count() == 0 ? "no value" : fmt::format("p99 {} {}", short_number(d.quantile(0.99)), metric_->unit);
    }
    return fmt::format("{}{}{}", text, faults.empty() ? "" : "\n", fmt::join(faults, "\n"));
}

}  // namespace lostbits::output::map
