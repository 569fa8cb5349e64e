#include "output/map/map_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "measure/blame/culprits.hpp"
#include "output/file/number_text.hpp"

namespace lostbits::output::map {

using file::Cell;
using file::Column;
using measure::answer::Outcome;
using measure::map::WorstRay;
using measure::metric::Distribution;
using measure::metric::Metric;

namespace {

struct Statistic {
    const char* name;
    const char* meaning;
    double (*of)(const Distribution&);
};
constexpr Statistic statistics[] = {
    {"mean", "mean", [](const Distribution& d) { return d.mean(); }},
    {"p50", "median (to 2^-11 of itself)", [](const Distribution& d) { return d.quantile(0.5); }},
    {"p99", "99th percentile (to 2^-11 of itself)", [](const Distribution& d) { return d.quantile(0.99); }},
    {"max", "largest", [](const Distribution& d) { return d.quantile(1); }},
};

/// `contribution_c` of `contribution:c`.
std::string column_name(const Metric& metric) {
    std::string name(metric.name);
    std::ranges::replace(name, ':', '_');
    return name;
}

Cell number_or_missing(double x) { return std::isnan(x) ? Cell() : Cell(x); }

Cell fraction(std::uint64_t part, std::uint64_t whole) {
    return whole == 0 ? Cell() : Cell(static_cast<double>(part) / static_cast<double>(whole));
}

/// The numbers of a worst ray, in the order of its columns.
struct HexPart {
    const char* name;
    double (*of)(const WorstRay&);
};
constexpr HexPart worst_parts[] = {
    {"worst_t_hex", [](const WorstRay& w) { return w.t; }},
    {"worst_origin_x_hex", [](const WorstRay& w) { return w.ray.origin.x; }},
    {"worst_origin_y_hex", [](const WorstRay& w) { return w.ray.origin.y; }},
    {"worst_origin_z_hex", [](const WorstRay& w) { return w.ray.origin.z; }},
    {"worst_direction_x_hex", [](const WorstRay& w) { return w.ray.direction.x; }},
    {"worst_direction_y_hex", [](const WorstRay& w) { return w.ray.direction.y; }},
    {"worst_direction_z_hex", [](const WorstRay& w) { return w.ray.direction.z; }},
};

const char* outcome_meaning(Outcome o) {
    switch (o) {
        case Outcome::agree_hit: return "correct hits: form and truth agree that there is a hit";
        case Outcome::agree_miss: return "correct misses: form and truth agree that there is none";
        case Outcome::false_hit: return "rays that the form hits and the truth misses";
        case Outcome::false_miss: return "rays that the form misses and the truth hits";
        case Outcome::not_a_number: return "rays on which the form reports a hit at NaN";
        case Outcome::unresolved: return "rays whose truth was not proved within the stated limit";
    }
    return "";
}

}  // namespace

std::vector<Column> SummaryTable::columns() const {
    std::vector<Column> columns{{"form", "string", "", "form under test"},
                                {"format", "string", "", "format it computes in"},
                                {"rays", "integer", "", "rays, one per pixel"}};
    for (std::size_t o = 0; o < measure::answer::outcome_names.size(); ++o) {
        columns.push_back(
            {std::string(measure::answer::outcome_names[o]), "integer", "", outcome_meaning(static_cast<Outcome>(o))});
    }
    columns.push_back({"false_hit_fraction", "number", "1", "false_hit among the rays that truly miss"});
    columns.push_back({"false_miss_fraction", "number", "1", "false_miss among the rays that truly hit"});
    columns.push_back({"wrong_object", "integer", "", "agree_hit, but the form found another solid first"});
    for (const Metric* m : metrics) {
        const std::string name = column_name(*m),
                          over = m->over == measure::metric::Over::marches ? " over all rays" : " over agree_hit";
        if (m->by_run()) {
            columns.push_back({name, "string", "", std::string(m->meaning) + ": the most frequent"});
            columns.push_back({name + "_fraction", "number", "1", "its share of the rays that have a culprit"});
            continue;
        }
        for (const std::string_view category : m->categories) {
            columns.push_back({fmt::format("{}_{}", name, category), "integer", "",
                               fmt::format("rays whose {} is {}: {}", name, category, m->meaning)});
        }
        if (!m->categories.empty()) continue;
        for (const Statistic& s : statistics)
            columns.push_back({name + "_" + s.name, "number", std::string(m->unit),
                               std::string(s.meaning) + " of |" + name + "|" + over});
    }
    columns.push_back(
        {"worst_x", "integer", "pixel", "column of the largest |ulp_error|, the first if several are equal"});
    columns.push_back({"worst_y", "integer", "pixel", "row of the same"});
    columns.push_back({"worst_object", "integer", "", "solid that the form hit there, from 0"});
    const char* const meaning =
        "the worst ray in the format (before any normalisation) and the form's answer, exactly, as a C hexadecimal "
        "float";
    for (const HexPart& p : worst_parts) columns.push_back({p.name, "string", "", meaning});
    for (const Shape shape : shapes) {
        for (const auto name : number_names(shape))
            columns.push_back({fmt::format("worst_{}_hex", name), "string", "", meaning});
    }
    return columns;
}

void SummaryTable::add(file::CsvWriter& csv, const measure::map::MapRow& row, const measure::map::MapSummary& s) const {
    csv.add(row.form->info->name).add(row.format.name).add(s.rays);
    for (const std::uint64_t count : s.outcomes) csv.add(count);
    // A NaN is an answer to a ray that truly hits or truly misses; it is in neither fraction's numerator.
    const std::uint64_t true_misses = s.rays - s.true_hits - s.count(Outcome::unresolved);
    csv.add(fraction(s.count(Outcome::false_hit), true_misses))
        .add(fraction(s.count(Outcome::false_miss), s.true_hits))
        .add(s.wrong_object);
    for (std::size_t m = 0; m < metrics.size(); ++m) {
        if (metrics[m]->by_run()) {
            const auto& counts = s.categories[m];
            const std::size_t most =
                static_cast<std::size_t>(std::max_element(counts.begin() + 1, counts.end()) - counts.begin());
            const double share = measure::blame::culprit_share(counts, std::array{most});
            csv.add(std::isnan(share) ? Cell() : Cell(metrics[m]->categories[most])).add(number_or_missing(share));
            continue;
        }
        // A form that does not march has none of these: missing, not zero.
        for (const std::uint64_t count : s.categories[m]) csv.add(row.form->shape == Shape::sdf ? Cell(count) : Cell());
        if (!metrics[m]->categories.empty()) continue;
        for (const Statistic& statistic : statistics) csv.add(number_or_missing(statistic.of(s.metrics[m])));
    }
    const bool any = s.worst.x >= 0;
    csv.add(any ? Cell(s.worst.x) : Cell())
        .add(any ? Cell(s.worst.y) : Cell())
        .add(any ? Cell(s.worst.object) : Cell());
    for (const HexPart& p : worst_parts) csv.add(any ? Cell(file::hex(p.of(s.worst))) : Cell());
    for (const Shape shape : shapes) {
        const bool of_it = any && s.worst.solid.shape == shape;
        for (std::size_t i = 0; i < number_names(shape).size(); ++i)
            csv.add(of_it ? Cell(file::hex(s.worst.solid.numbers[i])) : Cell());
    }
}

std::vector<Column> pixel_columns(const measure::map::MapRequest& request) {
    std::vector<Column> columns{{"x", "integer", "pixel", "column, from the left"},
                                {"y", "integer", "pixel", "row, from the top"},
                                {"outcome", "string", "", "outcome of the ray"},
                                {"object", "integer", "", "solid that the form hit, from 0"},
                                {"truth_object", "integer", "", "solid that the ray truly hits first"},
                                {"t", "number", "t", "the form's answer, in its own unit"},
                                {"t_hex", "string", "t", "the same, exactly"},
                                {"truth", "number", "t", "t*, correctly rounded to binary64, in the same unit"},
                                {"truth_hex", "string", "t", "the same, exactly"}};
    for (const Metric* m : request.metrics)
        columns.push_back({column_name(*m), m->categories.empty() ? "number" : "string", std::string(m->unit),
                           std::string(m->meaning)});
    return columns;
}

void write_pixels(file::CsvWriter& csv, const measure::map::MapRequest& request, const measure::map::MapRow& row,
                  const measure::map::BandResult& result) {
    for (std::size_t i = 0; i < result.outcomes.size(); ++i) {
        const auto width = static_cast<std::size_t>(result.width);
        csv.add(i % width).add(static_cast<std::size_t>(result.y0) + i / width);
        csv.add(measure::answer::outcome_names[static_cast<std::size_t>(result.outcomes[i])]);
        const bool hit = result.answers->hit[i] != 0;
        const measure::truth::Truth& truth = result.truth(i);
        csv.add(hit ? Cell(result.answers->object[i]) : Cell()).add(truth.is_hit() ? Cell(truth.object) : Cell());
        const auto exact = [&](bool there, double x) {
            csv.add(there ? Cell(x) : Cell()).add(there ? Cell(file::hex(x)) : Cell());
        };
        exact(hit, result.answers->t[i]);
        exact(truth.is_hit(),
              truth.is_hit() ? result.band->rounded_truth(i, binary64, row.form->info->direction, result.touching) : 0);
        for (std::size_t m = 0; m < request.metrics.size(); ++m) {
            const double value = result.metrics[m][i];
            const auto categories = request.metrics[m]->categories;
            csv.add(std::isnan(value)    ? Cell()
                    : categories.empty() ? Cell(value)
                                         : Cell(categories[static_cast<std::size_t>(value)]));
        }
        csv.end_row();
    }
}

}  // namespace lostbits::output::map
