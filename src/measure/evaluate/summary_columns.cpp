#include "measure/evaluate/summary_columns.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include "measure/answer/against.hpp"
#include "measure/truth/missing.hpp"
#include "shapes/number_names.hpp"

namespace lostbits::measure::evaluate {

using answer::Outcome;
using metric::Metric;
using truth::fraction;
using truth::missing;

namespace {

using Columns = std::vector<SummaryColumn>;
using Kind = SummaryColumn::Kind;
using S = FormSummary;

double to_double(std::uint64_t n) { return static_cast<double>(n); }

template <Outcome o>
double fraction_of_hits(const S& s) {
    return fraction(s.count(o), s.true_hit_count);
}

/// Files in which a column of outcomes appears: all, those of scenes with meshes, or claims alone.
enum class Shown { always, for_meshes, in_claims };

/// Columns of every summary, whatever is measured. An answer at NaN is counted neither as a false hit nor as a false
/// miss, although its ray truly hits or misses.
Columns make_outcome_columns() {
    Columns columns{
        {"rays", Kind::count, "", "rays, one per pixel", [](const S& s) { return to_double(s.ray_count); }}};
    const auto add_count = [&columns](Outcome o, const char* meaning, Shown shown = Shown::always) {
        columns.push_back({.name = std::string(answer::outcome_names[static_cast<std::size_t>(o)]),
                           .kind = Kind::count,
                           .unit = "",
                           .meaning = meaning,
                           .value = [o](const S& s) { return to_double(s.count(o)); },
                           .only_for_meshes = shown == Shown::for_meshes});
    };
    const auto add_fraction = [&columns](const char* name, const char* meaning, double (*value)(const S&),
                                         Shown shown) {
        columns.push_back({.name = name,
                           .kind = Kind::number,
                           .unit = "1",
                           .meaning = meaning,
                           .value = value,
                           .is_in_tables = shown != Shown::in_claims,
                           .only_for_meshes = shown == Shown::for_meshes});
    };

    // Counts of the outcomes of every scene.
    add_count(Outcome::agree_hit,
              "correct hits: form and truth agree that the ray hits, and which primitive it hits first");
    add_count(Outcome::agree_miss, "correct misses: form and truth agree that the ray misses");
    add_count(Outcome::false_hit, "rays that the form hits and the truth misses");
    add_count(Outcome::false_miss, "rays that the form misses and the truth hits");
    add_count(Outcome::not_a_number, "rays on which the form reports a hit at NaN");
    add_count(Outcome::unresolved, "rays whose truth was not proved within the stated limit");

    // Fractions of them.
    add_fraction(
        "false_hit_fraction", "false_hit among the rays that truly miss",
        [](const S& s) { return fraction(s.count(Outcome::false_hit), s.true_miss_count()); }, Shown::always);
    add_fraction("false_miss_fraction", "false_miss among the rays that truly hit",
                 fraction_of_hits<Outcome::false_miss>, Shown::always);
    add_fraction(
        "not_a_number_fraction", "not_a_number among all rays",
        [](const S& s) { return fraction(s.count(Outcome::not_a_number), s.ray_count); }, Shown::in_claims);

    // Wrong primitives, and all wrong decisions together.
    add_count(Outcome::wrong_primitive,
              "wrong primitives: form and truth hit, but the form hits another primitive first");
    add_fraction("wrong_primitive_fraction", "wrong_primitive among the rays that truly hit",
                 fraction_of_hits<Outcome::wrong_primitive>, Shown::in_claims);
    add_fraction(
        "wrong_fraction",
        "not_a_number, false_hit, false_miss, wrong_primitive, crack, double_hit and out_of_order among all rays whose "
        "truth is known",
        [](const S& s) { return fraction(s.wrong_count(), s.ray_count - s.count(Outcome::unresolved)); },
        Shown::in_claims);

    // Outcomes of scenes with meshes.
    add_count(Outcome::crack,
              "rays that the form lets through a mesh: it claims neither the triangle met nor a neighbour",
              Shown::for_meshes);
    add_count(Outcome::double_hit, "rays that cross a mesh once where the form claims two neighbouring triangles",
              Shown::for_meshes);
    add_count(Outcome::wrong_neighbour,
              "rays on which the form hits a neighbour of the triangle met; not a wrong decision", Shown::for_meshes);
    add_count(Outcome::out_of_order,
              "rays on which the form accepts a triangle and answers one that is truly behind it and not its neighbour",
              Shown::for_meshes);
    add_fraction("crack_fraction", "crack among the rays that truly hit", fraction_of_hits<Outcome::crack>,
                 Shown::for_meshes);
    add_fraction("double_hit_fraction", "double_hit among the rays that truly hit",
                 fraction_of_hits<Outcome::double_hit>, Shown::for_meshes);
    add_fraction("out_of_order_fraction", "out_of_order among the rays that truly hit",
                 fraction_of_hits<Outcome::out_of_order>, Shown::for_meshes);
    return columns;
}

std::uint64_t sum(const std::vector<std::uint64_t>& counts) {
    return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

/// Index of the most frequent culprit; NaN if no ray has a culprit.
double most_frequent_culprit(const std::vector<std::uint64_t>& counts) {
    const auto largest = std::max_element(counts.begin() + 1, counts.end());
    return largest == counts.end() || *largest == 0 ? missing
                                                    : to_double(static_cast<std::uint64_t>(largest - counts.begin()));
}

void add_culprit(const Metric& metric, std::size_t m, Columns& columns) {
    columns.push_back({.name = column_name(metric),
                       .kind = Kind::category,
                       .unit = "",
                       .meaning = std::string(metric.meaning) + ": the most frequent",
                       .value = [m](const S& s) { return most_frequent_culprit(s.categories[m]); },
                       .categories = metric.categories});
    columns.push_back({column_name(metric) + "_fraction", Kind::number, "1",
                       "its share of the rays that have a culprit", [m](const S& s) {
                           const double culprit = most_frequent_culprit(s.categories[m]);
                           if (std::isnan(culprit)) return missing;
                           return attribution::culprit_fraction(s.categories[m],
                                                                std::array{static_cast<std::size_t>(culprit)});
                       }});
}

/// Adds the counts of a metric's categories. If no ray has a category, as for a form that does not march, they are
/// missing, not zero.
void add_categories(const Metric& metric, std::size_t m, Columns& columns) {
    const std::string name = column_name(metric);
    for (std::size_t c = 0; c < metric.categories.size(); ++c) {
        const std::string category(metric.categories[c]);
        columns.push_back({name + "_" + category, Kind::count, "",
                           "rays whose " + name + " is " + category + ": " + std::string(metric.meaning),
                           [m, c](const S& s) {
                               const auto& counts = s.categories[m];
                               return sum(counts) == 0 ? missing : to_double(counts[c]);
                           }});
        columns.push_back({.name = name + "_" + category + "_fraction",
                           .kind = Kind::number,
                           .unit = "1",
                           .meaning = "their share of all rays",
                           .value = [m, c](const S& s) { return fraction(s.categories[m][c], sum(s.categories[m])); },
                           .is_in_tables = false});
    }
}

/// Adds the number of rays that both forms of `against` hit, whatever their t.
void add_both_hit(std::size_t m, Columns& columns) {
    using answer::AgainstOutcome;
    columns.push_back({"against_both_hit", Kind::count, "",
                       "rays that both hit: the sum of against_same_t, against_other_t and against_incomparable_t",
                       [m](const S& s) {
                           const auto& counts = s.categories[m];
                           if (sum(counts) == 0) return missing;
                           std::uint64_t both_hit = 0;
                           for (const AgainstOutcome a :
                                {AgainstOutcome::same_t, AgainstOutcome::other_t, AgainstOutcome::incomparable_t})
                               both_hit += counts[static_cast<std::size_t>(a)];
                           return to_double(both_hit);
                       }});
}

/// Rays that the statistics of a metric are about, for their meaning.
std::string_view population_of(metric::MetricDomain domain) {
    using metric::MetricDomain;
    if (domain == MetricDomain::marches || domain == MetricDomain::every) return " over all rays";
    return domain == MetricDomain::pairs ? " over the rays that both hit" : " over agree_hit";
}

void add_statistics(const Metric& metric, std::size_t m, Columns& columns) {
    const std::string name = column_name(metric), population(population_of(metric.domain));
    for (const metric::Statistic& statistic : metric::statistics) {
        const bool is_bucketed = statistic.q > 0 && statistic.q < 1;
        columns.push_back({column_name(metric, statistic), Kind::number, std::string(metric.unit),
                           std::string(statistic.meaning) + (is_bucketed ? " (to 2^-11 of itself)" : "") + " of |" +
                               name + "|" + population,
                           [m, statistic](const S& s) { return statistic.of(s.metrics[m]); }});
    }

    // These bounds are valid only for random rays: the rays of a picture are not independent.
    const auto add_bound = [&](const char* suffix, double metric::Bounds::*bound) {
        columns.push_back({.name = name + "_p99" + suffix,
                           .kind = Kind::number,
                           .unit = std::string(metric.unit),
                           .meaning = "end of the interval that holds the 99th percentile of all such rays with 95 % "
                                      "confidence, for independent rays",
                           .value = [m, bound](const S& s) { return s.metrics[m].p99_bounds().*bound; },
                           .is_in_tables = false});
    };
    add_bound("_low", &metric::Bounds::low);
    add_bound("_high", &metric::Bounds::high);
}

/// Returns a function that computes `part` of the worst ray; NaN if no hit is correct.
template <class Part>
std::function<double(const S&)> value_of_worst_ray(const Part& part) {
    return [part](const S& s) { return s.worst.x < 0 ? missing : part(s.worst); };
}
/// Returns a function that computes `part` of the first ray with the most frequent wrong decision; NaN if every
/// decision is right.
template <class Part>
std::function<double(const S&)> value_of_first_fault(const Part& part) {
    return [part](const S& s) { return s.first_fault() == nullptr ? missing : part(*s.first_fault()); };
}

/// Adds a number twice: as a decimal, and exactly as a hexadecimal float.
void add_decimal_and_hex(Columns& columns, const std::string& name, const std::string& meaning,
                         const std::function<double(const S&)>& value) {
    columns.push_back({name, Kind::number, "t", meaning, value});
    columns.push_back({name + "_hex", Kind::hex, "t", "the same, exactly, as a C hexadecimal float", value});
}

}  // namespace

std::string column_name(const Metric& metric) {
    std::string name(metric.name);
    std::ranges::replace(name, ':', '_');
    return name;
}

std::string column_name(const Metric& metric, const metric::Statistic& statistic) {
    return column_name(metric) + "_" + std::string(statistic.name);
}

Columns make_summary_columns(const std::vector<const Metric*>& metrics) {
    Columns columns = make_outcome_columns();
    for (std::size_t m = 0; m < metrics.size(); ++m) {
        if (metrics[m]->depends_on_forms) add_culprit(*metrics[m], m, columns);
        else if (!metrics[m]->categories.empty()) add_categories(*metrics[m], m, columns);
        else add_statistics(*metrics[m], m, columns);
        if (metrics[m]->name == "against") add_both_hit(m, columns);
    }
    return columns;
}

Columns make_worst_columns(const std::vector<Shape>& shapes) {
    using W = WorstRay;
    Columns columns{
        {"worst_x", Kind::count, "pixel", "column of the largest |ulp_error|, the first if several are equal",
         value_of_worst_ray([](const W& w) { return static_cast<double>(w.x); })},
        {"worst_y", Kind::count, "pixel", "row of the same", value_of_worst_ray([](const W& w) { return w.y; })},
        {"worst_object", Kind::count, "", "primitive that the form hit there, from 0",
         value_of_worst_ray([](const W& w) { return static_cast<double>(w.primitive_index); })},
        {"worst_ulp_error", Kind::number, "ulp", "(t - t*)/ulp(t*) there, with its sign",
         value_of_worst_ray([](const W& w) { return w.ulps; })}};
    add_decimal_and_hex(columns, "worst_t", "the form's answer there, in its own unit",
                        value_of_worst_ray([](const W& w) { return w.t; }));
    add_decimal_and_hex(columns, "worst_truth", "t* there, correctly rounded to binary64, in the same unit",
                        value_of_worst_ray([](const W& w) { return w.truth; }));

    // The numbers of the ray.
    const auto add_hex = [&columns](const std::string& name, std::function<double(const S&)> value) {
        columns.push_back({"worst_" + name + "_hex", Kind::hex, "",
                           "the worst ray as the format holds it (before any normalisation), or the primitive that the "
                           "form hit, exactly, as a C hexadecimal float",
                           std::move(value)});
    };
    const char* const axes[] = {"x", "y", "z"};
    for (int k = 0; k < 3; ++k)
        add_hex(std::string("origin_") + axes[k], value_of_worst_ray([k](const W& w) { return w.ray.origin[k]; }));
    for (int k = 0; k < 3; ++k)
        add_hex(std::string("direction_") + axes[k],
                value_of_worst_ray([k](const W& w) { return w.ray.direction[k]; }));

    // Shapes may share the name of a number: its column has the number of the primitive that was hit.
    std::vector<std::string> names;
    for (const Shape shape : shapes)
        for (const std::string& name : number_names(shape))
            if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    for (const std::string& name : names) {
        add_hex(name, value_of_worst_ray([name](const W& w) {
                    const auto own_names = number_names(w.primitive.shape);
                    const auto name_position = std::ranges::find(own_names, name);
                    return name_position == own_names.end() ? missing
                                                            : w.primitive.numbers[name_position - own_names.begin()];
                }));
    }
    return columns;
}

Columns make_wrong_decision_columns() {
    using W = WorstRay;
    Columns columns{
        {.name = "fault_outcome",
         .kind = Kind::category,
         .unit = "",
         .meaning = "the most frequent wrong decision: false_hit, false_miss, not_a_number, wrong_primitive or, for "
                    "meshes, crack, double_hit or out_of_order; the other columns of a fault are about its first ray",
         .value = value_of_first_fault([](const W& w) { return static_cast<double>(w.outcome); }),
         .categories = answer::outcome_names}};
    add_decimal_and_hex(columns, "fault_t",
                        "the form's answer there, in its own unit; missing where it misses or is not a number",
                        value_of_first_fault([](const W& w) { return w.t; }));
    add_decimal_and_hex(columns, "fault_truth",
                        "t* there, correctly rounded to binary64; missing where the ray truly misses",
                        value_of_first_fault([](const W& w) { return w.truth; }));
    return columns;
}

const SummaryColumn* find_column(const Columns& columns, std::string_view name) {
    const auto found = std::ranges::find(columns, name, &SummaryColumn::name);
    return found == columns.end() ? nullptr : &*found;
}

}  // namespace lostbits::measure::evaluate
