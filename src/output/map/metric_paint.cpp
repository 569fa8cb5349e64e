// Legends, notes and short summaries of a metric in pictures.
#include "output/map/map_colour.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "measure/answer/against.hpp"
#include "measure/attribution/culprits.hpp"
#include "output/file/number_text.hpp"
#include "output/map/form_names.hpp"
#include "output/map/map_tables.hpp"
#include "text/count_with_noun.hpp"

namespace lostbits::output::map {

using image::LegendEntry;
using image::Rgb8;
using measure::metric::MetricDomain;

namespace {

std::string percent(std::uint64_t count, std::uint64_t total) {
    const double percentage = 100.0 * static_cast<double>(count) / static_cast<double>(total);
    if (percentage < 0.1) return "<0.1%";
    if (percentage > 99 && percentage < 100) return ">99%";
    return fmt::format(fmt::runtime(percentage < 10 ? "{:.1f}%" : "{:.0f}%"), percentage);
}

/// Formats a value for a text with little space.
std::string short_number(double x) { return file::short_decimal(x, 3); }

constexpr Rgb8 no_culprit_colour = image::outcome_colours[0];  ///< a hit to which no operation adds an error
constexpr const char* hit_without_value = "correct hit without a value";
constexpr const char* nothing_to_compare = "not both hit: nothing to compare";
constexpr std::size_t max_culprits = 6;              ///< culprits that a legend names
constexpr std::size_t max_culprit_letters = 44;      ///< letters of a culprit in a legend
constexpr std::size_t summary_culprit_letters = 48;  ///< letters of a culprit in a short summary

std::string shorten(std::string_view text, std::size_t letter_count) {
    return text.size() <= letter_count ? std::string(text) : std::string(text.substr(0, letter_count - 2)) + "..";
}

constexpr std::size_t two_line_letters = 50;  ///< letters that two lines below a cell of a sheet can hold

/// Wrong decisions as fractions of all pixels, the most frequent first. All are named if two lines hold them; otherwise
/// two are named, and the others are added up: `1.2% double hit, 1.0% crack, 0.3% other`.
std::string fault_fractions_text(const FormSummary& summary) {
    auto order = measure::evaluate::wrong_decisions;
    std::ranges::stable_sort(order, std::greater<>(), [&summary](Outcome o) { return summary.count(o); });
    const auto fraction_of_pixels = [&summary](std::uint64_t n, std::string_view name) {
        return fmt::format("{} {}", percent(n, summary.ray_count), name);
    };

    std::vector<std::string> faults;
    std::uint64_t less_frequent_count = 0;  // wrong decisions of all kinds but the first two
    for (const Outcome o : order) {
        const std::uint64_t n = summary.count(o);
        if (n == 0) continue;
        if (faults.size() >= 2) less_frequent_count += n;
        faults.push_back(fraction_of_pixels(n, o == Outcome::not_a_number ? "NaN" : outcome_in_words(o)));
    }

    std::string text = fmt::format("{}", fmt::join(faults, ", "));
    if (faults.size() > 2 && text.size() > two_line_letters)
        text = fmt::format("{}, {}, {}", faults[0], faults[1], fraction_of_pixels(less_frequent_count, "other"));
    return text;
}

/// Lost and kept bits in a text that fits below a cell of a sheet: `22.7 lost, 30.3/53 kept`. Kept bits are rounded
/// down, as in tables, and lost bits up.
std::string lost_and_kept(double lost, int precision) {
    const std::string kept = file::kept_bits_text(precision - lost);
    return fmt::format("{:.1f} lost, {}/{} kept", precision - file::parse_number(kept).value(), kept, precision);
}

/// Colour of a value that is one of the metric's categories.
Rgb8 category_colour(const Metric& metric, std::size_t category) {
    if (metric.categories.data() == intersect::stop_names.data()) return image::stop_colours[category];
    if (metric.domain == MetricDomain::pairs) return image::against_colours[category];
    if (metric.domain == MetricDomain::agreed_hits)
        return image::distinct_colour(category);  // slate is the colour of hits without a value
    return category == 0 ? no_culprit_colour : image::distinct_colour(category - 1);
}

}  // namespace

MetricPaint::MetricPaint(const Metric& metric, const FloatFormat& format, const std::optional<BarRange>& range)
    : metric_(&metric), precision_(format.precision), has_range_(range.has_value()) {
    auto& categories = look_.categories;

    // Categories with a value: one on the ramp, or those of the metric.
    if (metric.ramp != measure::metric::Ramp::categories) {
        look_.scale = metric_scale(metric, format, range);
        categories.push_back({""});
    }
    for (std::size_t c = 0; c < metric.categories.size(); ++c)
        categories.push_back({name_in_words(metric.categories[c]), category_colour(metric, c)});
    value_category_count_ = categories.size();

    // The outcomes.
    for (std::size_t o = 0; o < image::outcome_colours.size(); ++o) {
        const auto outcome = static_cast<Outcome>(o);
        const std::string name = outcome == Outcome::agree_hit ? hit_without_value : outcome_in_words(outcome);
        categories.push_back({is_of_hits() ? name : "", image::outcome_colours[o]});
    }

    // The last category has no value. For pairs of forms, which often do not both hit, its colour is inconspicuous.
    categories.push_back(
        {is_distance() ? nothing_to_compare : "",
         pixel::colour_of(metric.domain == MetricDomain::pairs ? Outcome::agree_miss : Outcome::not_a_number)});
    // Correct hits without a value come last of the outcomes in legends.
    std::rotate(categories.begin() + static_cast<std::ptrdiff_t>(value_category_count_),
                categories.begin() + static_cast<std::ptrdiff_t>(value_category_count_) + 1, categories.end() - 1);
}

bool MetricPaint::applies_to(const TestedForm& tested_form) const {
    // Distances exist only between values of t with the same meaning.
    if (metric_->domain == MetricDomain::pairs)
        return tested_form.against != nullptr &&
               (!metric_->categories.empty() ||
                measure::answer::are_comparable(*tested_form.form->info, *tested_form.against->info));
    const bool is_machine_format = !tested_form.format.is_emulated();
    if ((metric_->needs & measure::metric::needs_bound) && (tested_form.form->bounded == nullptr || !is_machine_format))
        return false;
    if ((metric_->needs & measure::metric::needs_deciding_arithmetic) &&
        tested_form.form->deciding_arithmetic == nullptr)
        return false;
    return metric_->domain != MetricDomain::marches || !is_primitive(tested_form.form->shape);
}

bool MetricPaint::shares_bar_with(const Metric& other) const {
    const Metric& m = *metric_;
    return m.unit == other.unit && m.ramp == other.ramp && m.low == other.low && m.high == other.high &&
           m.domain == other.domain && m.categories.data() == other.categories.data();
}

pixel::PixelValue MetricPaint::pixel(Outcome outcome, double value) const {
    if (!std::isnan(value) && (!is_of_hits() || outcome == Outcome::agree_hit)) {
        if (!look_.scale) return {static_cast<std::size_t>(value)};
        return {0, is_of_hits() ? std::fabs(value) : value};
    }
    const bool has_outcome_category = is_of_hits() || metric_->domain == MetricDomain::blamed ||
                                      (metric_->domain == MetricDomain::every && look_.scale);
    return {has_outcome_category ? index_of(outcome) : look_.categories.size() - 1};
}

pixel::Look MetricPaint::look(bool has_mesh) const {
    pixel::Look look = look_;
    if (metric_->depends_on_forms)
        look.make_legend = [*this](const pixel::CategoryCounts* counts, std::uint64_t pixels) {
            return counts ? make_culprit_legend(*counts) : make_widest_culprit_legend(pixels);
        };
    for (std::size_t o = measure::answer::outcome_count_without_mesh; !has_mesh && o < image::outcome_colours.size();
         ++o)
        look.categories[index_of(static_cast<Outcome>(o))].name.clear();
    return look;
}

std::vector<LegendEntry> MetricPaint::make_widest_culprit_legend(std::uint64_t pixels) const {
    const std::string count = pixel::widest_count(pixels);
    std::vector<LegendEntry> entries(max_culprits + 2,
                                     {std::string(max_culprit_letters, '+'), no_culprit_colour, count});
    for (const Outcome o : {Outcome::agree_miss, Outcome::not_a_number, Outcome::unresolved})
        entries.push_back({outcome_in_words(o), pixel::colour_of(o), count});
    return entries;
}

std::vector<LegendEntry> MetricPaint::make_culprit_legend(const pixel::CategoryCounts& category_counts) const {
    const pixel::CategoryCounts counts(category_counts.begin(),
                                       category_counts.begin() + static_cast<std::ptrdiff_t>(value_category_count_));
    const std::uint64_t blamed_ray_count = measure::attribution::count_rays_with_culprit(counts);

    // The most frequent culprits have an entry each; the others are counted together.
    std::vector<LegendEntry> entries;
    std::uint64_t other_ray_count = 0;
    for (const std::size_t c : culprits_by_count(counts)) {
        if (entries.size() < max_culprits)
            entries.push_back({shorten(metric_->categories[c], max_culprit_letters), category_colour(*metric_, c),
                               pixel::count_text(counts[c], blamed_ray_count)});
        else other_ray_count += counts[c];
    }

    if (counts.front() > 0)
        entries.push_back({shorten(metric_->categories.front(), max_culprit_letters), no_culprit_colour,
                           std::to_string(counts.front())});
    if (other_ray_count > 0)
        entries.push_back({"other operations, each in its own colour", image::style::background,
                           pixel::count_text(other_ray_count, blamed_ray_count)});

    // Rays with these outcomes have no culprit; all others may have one.
    for (const Outcome o : {Outcome::agree_miss, Outcome::not_a_number, Outcome::unresolved}) {
        if (const std::uint64_t n = category_counts[index_of(o)])
            entries.push_back({outcome_in_words(o), pixel::colour_of(o), std::to_string(n)});
    }
    return entries;
}

std::string MetricPaint::note(bool has_several_formats) const {
    if (metric_->depends_on_forms)
        return fmt::format("colour: {}; percentages are of the rays that have a culprit", metric_->meaning);
    if (!look_.scale) return fmt::format("colour: {}", metric_->meaning);

    // Metrics on a ramp: from where to where.
    const std::string name(metric_->name);
    if (has_range_)
        return fmt::format("colour: {} from {} to {}, as requested; values beyond have the colour of the end",
                           metric_->ramp == measure::metric::Ramp::magnitude ? "|" + name + "|" : name,
                           short_number(look_.scale->lo()), short_number(look_.scale->hi()));
    if (metric_->ramp == measure::metric::Ramp::magnitude)
        return fmt::format("colour: |{}|{}, clamped at both ends of the bar{}", name,
                           is_distance() ? ", where both forms hit" : "",
                           has_several_formats ? ", whose ends fit the format" : "");
    const std::string bits_phrase = has_several_formats
                                        ? std::string("all bits of each format's significand")
                                        : fmt::format("all {} bits of the format's significand", precision_);
    return fmt::format("colour: {} from 0 to {}{}", name, bits_phrase,
                       metric_->ramp == measure::metric::Ramp::lost
                           ? "; the bar is spaced by square roots, so that the first bits show"
                           : "");
}

std::string MetricPaint::quantile_note() const {
    if (!names_worst_ray()) return "";
    return fmt::format("p99: 99 of 100 agreed hits {} at most this much", metric_->name == "lost_bits"      ? "lose"
                                                                          : metric_->name == "correct_bits" ? "keep"
                                                                                                            : "have");
}

std::string MetricPaint::short_summary(const FormSummary& summary, std::size_t metric_index) const {
    if (metric_->depends_on_forms) return culprit_summary(summary.categories[metric_index]);
    if (!metric_->categories.empty()) return category_summary(summary.categories[metric_index], summary.ray_count);
    const measure::metric::Distribution& distribution = summary.metrics[metric_index];
    return is_of_hits() ? hit_summary(summary, distribution) : distribution_summary(distribution);
}

std::string MetricPaint::culprit_summary(const std::vector<std::uint64_t>& counts) const {
    const auto order = culprits_by_count(counts);
    if (order.empty()) return "no culprit";
    const std::uint64_t blamed_ray_count = measure::attribution::count_rays_with_culprit(counts);
    return fmt::format("{} of {} culprits:\n{}", percent(counts[order.front()], blamed_ray_count), blamed_ray_count,
                       shorten(metric_->categories[order.front()], summary_culprit_letters));
}

std::string MetricPaint::category_summary(const std::vector<std::uint64_t>& counts, std::uint64_t ray_count) const {
    std::vector<std::string> fractions;
    for (std::size_t c = 0; c < metric_->categories.size(); ++c) {
        if (const std::uint64_t n = counts[c])
            fractions.push_back(percent(n, ray_count) + " " + name_in_words(metric_->categories[c]));
    }
    return fmt::format("{}", fmt::join(fractions, "\n"));
}
std::string MetricPaint::unit_suffix() const { return metric_->unit == "1" ? "" : " " + std::string(metric_->unit); }

std::string MetricPaint::distribution_summary(const measure::metric::Distribution& distribution) const {
    if (distribution.count() == 0) return is_distance() ? "no ray that both forms hit" : "no value";
    return fmt::format("median {}{}\nlargest {}{}\nof {}{}", short_number(distribution.quantile(0.5)), unit_suffix(),
                       short_number(distribution.quantile(1)), unit_suffix(),
                       text::count_with_noun(distribution.count(), "ray"), is_distance() ? " that both forms hit" : "");
}

std::string MetricPaint::hit_summary(const FormSummary& summary,
                                     const measure::metric::Distribution& distribution) const {
    std::string text = fault_fractions_text(summary);
    const auto add = [&text](const std::string& line) { text += (text.empty() ? "" : "\n") + line; };

    // The errors of the agreed hits, or why there is no p99.
    const measure::metric::Agreement hits = summary.agreement();
    if (hits.agreed_count == 0) {
        add(hits.true_hit_count == 0 ? "no ray hits" : "no correct hit");
    } else if (!hits.is_enough()) {
        add("no p99: " + hits.too_few_text());
    } else if (distribution.count() == 0) {
        add("no value");
    } else {
        const double p99 = distribution.quantile(0.99);
        add("p99 " +
            (metric_->name == "lost_bits" ? lost_and_kept(p99, precision_) : short_number(p99) + unit_suffix()));
        add(measure::metric::Agreement{distribution.count(), hits.true_hit_count}.of_agreed_hits_text());
    }
    return text;
}

std::string MetricPaint::caption(const FormSummary& summary, std::size_t metric_index) const {
    std::string text;
    for (const char c : short_summary(summary, metric_index))
        text += c != '\n' ? std::string(1, c) : text.ends_with(':') ? " " : "; ";

    // A sheet explains `p99` once in its notes. The caption of a single picture has space to spell it out.
    constexpr std::string_view marker = "p99 ";
    const std::size_t position = text.find(marker);
    const bool is_word = position == 0 || (position != std::string::npos && text[position - 1] == ' ');
    if (is_word && !text.substr(0, position).ends_with("no "))
        text.replace(position, marker.size(), "99 of 100 hits: at most ");
    return text;
}

std::string MetricPaint::widest_caption(std::uint64_t pixels) const {
    if (metric_->depends_on_forms)
        return fmt::format("99% of {} culprits: {}", pixels, std::string(summary_culprit_letters, 'e'));
    if (!is_of_hits())
        return fmt::format("median 1.23×10^-10 {0}; largest 1.23×10^-10 {0}; of {1} rays that both forms hit",
                           metric_->unit, pixels);
    return fmt::format(
        "99% false miss, 99% false hit; 99 of 100 hits: at most 22.7 lost, 30.3/53 kept; of {} agreed hits", pixels);
}

}  // namespace lostbits::output::map
