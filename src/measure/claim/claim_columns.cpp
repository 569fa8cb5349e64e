#include "measure/claim/claim_columns.hpp"

#include <algorithm>
#include <limits>
#include <map>

#include "measure/claim/claim.hpp"
#include "scene/toml/did_you_mean.hpp"

namespace lostbits::measure::claim {

using answer::Outcome;
using map::MapSummary;
using metric::Distribution;
using metric::Metric;

namespace {

using scene::claim::Claim;

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

struct Statistic {
    std::string name;
    double (*of)(const Distribution&);
};
const Statistic statistics[] = {{"_mean", [](const Distribution& d) { return d.mean(); }},
                                {"_p50", [](const Distribution& d) { return d.quantile(0.5); }},
                                {"_p99", [](const Distribution& d) { return d.quantile(0.99); }},
                                {"_max", [](const Distribution& d) { return d.quantile(1); }}};

double share(std::uint64_t part, std::uint64_t whole) {
    return whole == 0 ? missing : static_cast<double>(part) / static_cast<double>(whole);
}

/// `contribution_c` of `contribution:c`.
std::string column_of(const Metric& metric) {
    std::string name(metric.name);
    std::ranges::replace(name, ':', '_');
    return name;
}

std::map<std::string, double> columns_of(const MapSummary& s, const std::vector<const Metric*>& metrics) {
    std::map<std::string, double> columns;
    for (std::size_t o = 0; o < answer::outcome_names.size(); ++o)
        columns[std::string(answer::outcome_names[o])] = static_cast<double>(s.outcomes[o]);
    columns["rays"] = static_cast<double>(s.rays);
    columns["wrong_object"] = static_cast<double>(s.wrong_object);
    columns["false_hit_fraction"] =
        share(s.count(Outcome::false_hit), s.rays - s.true_hits - s.count(Outcome::unresolved));
    columns["false_miss_fraction"] = share(s.count(Outcome::false_miss), s.true_hits);
    columns["not_a_number_fraction"] = share(s.count(Outcome::not_a_number), s.rays);
    for (std::size_t m = 0; m < metrics.size(); ++m) {
        if (metrics[m]->by_run()) continue;  // by operation: `culprits`
        const std::string name = column_of(*metrics[m]);
        for (std::size_t c = 0; c < metrics[m]->categories.size(); ++c) {
            columns[name + "_" + std::string(metrics[m]->categories[c])] = static_cast<double>(s.categories[m][c]);
            columns[name + "_" + std::string(metrics[m]->categories[c]) + "_fraction"] =
                share(s.categories[m][c], s.rays);
        }
        if (!metrics[m]->categories.empty()) continue;
        for (const Statistic& statistic : statistics) columns[name + statistic.name] = statistic.of(s.metrics[m]);
    }
    return columns;
}

/// What else a claim could have meant: columns of metrics that no claim about this subject names.
void add_columns_of_the_others(std::vector<std::string>& names) {
    for (const Metric& m : metric::metrics()) {
        if (m.by_run()) names.emplace_back("culprit_fraction");
        else if (m.categories.empty())
            for (const Statistic& statistic : statistics) names.push_back(column_of(m) + statistic.name);
    }
}

/// What the formula calls an operation: `c` of `c = dot(o - centre, o - centre) - radius*radius`; empty where the
/// formula has no name for it.
std::string label_in(const std::string& operation) {
    const auto equals = operation.find(" = ");
    return equals == std::string::npos ? "" : operation.substr(0, equals);
}

/// The operations of a form that a word stands for: that expression, or those of that label. InputError with
/// did-you-mean.
std::vector<std::string> meant_by(const std::string& word, const Claim& claim, const blame::Setting& setting) {
    const auto operations = operations_of(*claim_row(claim).form, setting);
    std::vector<std::string> meant, known;
    for (const std::string& operation : operations) {
        const std::string label = label_in(operation);
        if (operation == word || (!label.empty() && label == word)) meant.push_back(operation);
        if (!label.empty()) known.push_back(label);
    }
    if (!meant.empty()) return meant;
    known.insert(known.end(), operations.begin(), operations.end());
    scene::toml::fail(claim.quantity,
                      claim.form + " has no operation \"" + word + "\"; " + scene::toml::did_you_mean(word, known));
}

}  // namespace

bool asks_for_attribution(const Claim& claim) {
    return std::ranges::any_of(std::initializer_list<const char*>{"culprit_", "cancellation", "contribution"},
                               [&](const char* start) { return claim.metric.starts_with(start); });
}

ClaimColumns::ClaimColumns(const std::vector<Claim>& claims, const std::vector<map::MapRow>& rows,
                           const blame::Setting& setting)
    : setting_(setting) {
    for (const Metric& m : lostbits::measure::metric::metrics()) {
        const bool named = std::ranges::any_of(
            claims, [&](const Claim& c) { return c.metric.starts_with(std::string(m.name) + "_"); });
        if (m.by_default || named) metrics_.push_back(&m);
    }
    for (const Claim& claim : claims) {
        for (const std::string& word : claim.operations) meant_by(word, claim, setting_);  // refused before the work
        add_labelled(claim);
    }
    blame::bind_to_run(metrics_, map::forms_of(rows), setting_);
}

/// `contribution_c_p50`, `cancellation_disc_max`: of what the claim's form names.
void ClaimColumns::add_labelled(const Claim& claim) {
    std::vector<std::string> names;
    for (const char* kind : {"contribution", "cancellation"}) {
        if (!claim.metric.starts_with(kind)) continue;
        for (const std::string_view label : blame::labels_of(*claim_row(claim).form, setting_)) {
            const Metric* const metric = blame::labelled_metric(std::string(kind) + ":" + std::string(label));
            for (const Statistic& statistic : statistics) {
                names.push_back(column_of(*metric) + statistic.name);
                if (names.back() != claim.metric) continue;
                if (std::ranges::find(metrics_, metric) == metrics_.end()) metrics_.push_back(metric);
                return;
            }
        }
    }
    for (const Statistic& statistic : statistics) {
        if (claim.metric == "cancellation" + statistic.name) return;
        if (!names.empty()) names.push_back("cancellation" + statistic.name);
    }
    if (!names.empty())
        scene::toml::fail(claim.quantity, "unknown metric \"" + claim.metric + "\" of " + claim.form + "; " +
                                              scene::toml::did_you_mean(claim.metric, names));
}

double ClaimColumns::culprits(const Claim& claim, const MapSummary& summary) const {
    const auto m = static_cast<std::size_t>(std::ranges::find_if(metrics_, &Metric::by_run) - metrics_.begin());
    const auto categories = metrics_[m]->categories;
    std::vector<std::size_t> places;
    for (const std::string& word : claim.operations) {
        for (const std::string& operation : meant_by(word, claim, setting_)) {
            const auto place = static_cast<std::size_t>(std::ranges::find(categories, operation) - categories.begin());
            if (std::ranges::find(places, place) == places.end()) places.push_back(place);
        }
    }
    return blame::culprit_share(summary.categories[m], places);
}

double ClaimColumns::value(const Claim& claim, const MapSummary& summary) const {
    if (!claim.operations.empty()) return culprits(claim, summary);
    const auto columns = columns_of(summary, metrics_);
    const auto found = columns.find(claim.metric);
    if (found != columns.end()) return found->second;
    std::vector<std::string> names;
    for (const auto& [name, value] : columns) names.push_back(name);
    add_columns_of_the_others(names);
    scene::toml::fail(claim.quantity,
                      "unknown metric \"" + claim.metric + "\"; " + scene::toml::did_you_mean(claim.metric, names));
}

}  // namespace lostbits::measure::claim
