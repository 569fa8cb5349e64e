#include "scene/check/claims_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <set>
#include <sstream>
#include <string>

#include "number/real.hpp"
#include "scene/toml/parse_number.hpp"

namespace lostbits::scene::check {

using toml::Node;
using toml::TableReader;

namespace {

using V = Claim::Verdict;
using S = Claim::Severity;
constexpr std::pair<std::string_view, V> verdicts[] = {
    {"holds", V::holds}, {"qualified", V::qualified}, {"refuted", V::refuted}};
constexpr std::pair<std::string_view, S> severities[] = {{"error", S::error}, {"warn", S::warn}};
constexpr long long max_draws = 1000;
constexpr std::pair<std::string_view, Claim::Profile> profiles[] = {
    {"results", Claim::Profile::results}, {"timing", Claim::Profile::timing}, {"libraries", Claim::Profile::libraries}};

using Evidence = Claim::Evidence;
constexpr std::pair<std::string_view, Evidence> evidences[] = {{"proof", Evidence::proof},
                                                               {"exhaustive", Evidence::exhaustive},
                                                               {"search", Evidence::search},
                                                               {"counterexample", Evidence::counterexample},
                                                               {"sample", Evidence::sample}};

/// Returns an empty name for values that files cannot name.
template <class E, std::size_t n>
std::string_view find_name(const std::pair<std::string_view, E> (&names)[n], E value) {
    const auto found = std::ranges::find(names, value, &std::pair<std::string_view, E>::second);
    return found == std::end(names) ? "" : found->first;
}

/// Reads the source and the words quoted from it. Few words keep a quotation to the point, and to what may be copied.
void read_source(TableReader& table, Claim& claim) {
    constexpr std::ptrdiff_t max_words = 12;
    claim.source = table.string("source");
    claim.quotation = table.optional_string("quotation").value_or("");
    if (!table.has("quotation")) return;
    if (!claim.is_sourced())
        table.fail_at("quotation", "needs a source; the statement is our own (source = \"-\"), so leave it out");
    std::istringstream text(claim.quotation);
    const auto words = std::distance(std::istream_iterator<std::string>(text), std::istream_iterator<std::string>());
    if (words == 0) table.fail_at("quotation", "is empty; copy the words of the source that state the claim");
    if (words > max_words)
        table.fail_at("quotation", fmt::format("has {} words; quote at most {} of the source, those that state the "
                                               "claim",
                                               words, max_words));
}

/// Reads the verdict and, if it is qualified, the condition for it.
void read_verdict(TableReader& table, Claim& claim) {
    claim.verdict = table.one_of<V>("verdict", verdicts);
    claim.condition = table.optional_string("condition").value_or("");
    if (claim.verdict == V::qualified && claim.condition.empty())
        table.fail_at("verdict",
                      "is qualified; say when the sentence is true, as in condition = \"where touching is a miss\"");
    if (claim.verdict != V::qualified && !claim.condition.empty())
        table.fail_at("condition",
                      "needs verdict = \"qualified\", for a sentence that is true if the condition is met");
}

/// Reads the evidence for the verdict, and checks that the claim has it.
void read_evidence(TableReader& table, Claim& claim) {
    claim.evidence = table.optional_one_of<Evidence>("evidence", evidences).value_or(Evidence::none);
    claim.lemma = table.optional_string("lemma").value_or("");
    if (claim.evidence == Evidence::proof && claim.lemma.empty())
        table.fail_at("evidence", "is a proof; write its inequality, or where to find it, as lemma = \"...\"");
    if (claim.evidence != Evidence::proof && !claim.lemma.empty())
        table.fail_at("lemma", "needs evidence = \"proof\", because it is the inequality of a proof");
    if (claim.evidence == Evidence::counterexample && claim.verdict == V::holds)
        table.fail_at("evidence", "is a counterexample, which refutes a sentence; write verdict = \"refuted\"");
}

/// Reads `operation = "c"`, or a list of operations.
void read_operations(TableReader& table, Claim& claim) {
    constexpr std::string_view metric = "culprit_fraction", key = "operation";
    if (claim.metric != metric)
        return table.reject(key, "needs metric = \"culprit_fraction\", the share of that operation");
    if (!table.has(key))
        table.fail_at("metric",
                      "needs an operation: operation = \"c\", its name in the formula, or an expression as `lostbits "
                      "map --metric culprit` writes it");
    claim.quantity = table.where(key);
    claim.operations = table.node(key).kind == Node::Kind::array ? table.strings(key) : std::vector{table.string(key)};
    if (claim.operations.empty()) table.fail_at(key, "is empty; name an operation");
}

constexpr double infinite = std::numeric_limits<double>::infinity();

/// Returns the comparison in front of the number, as in `> 0`.
std::string comparison_of(const std::string& text) {
    for (const char* comparison : {"<=", ">=", "<", ">", "="}) {
        if (text.starts_with(comparison)) return comparison;
    }
    return "";
}

Criterion parse_comparison(TableReader& table, const std::string& text) {
    const std::string comparison = comparison_of(text);
    const auto digits = text.find_first_not_of(' ', comparison.size());
    if (comparison.empty() || digits == std::string::npos)
        table.fail_at("criterion", "is \"" + text +
                                       "\"; write what the sentence says of the number, such as \"= 0\", \"> 0\" or "
                                       "\">= 10\", or the ends of an interval, [0.4, 0.6]");
    const auto parsed = toml::parse_number(std::string_view(text).substr(digits));
    if (const auto* fault = std::get_if<toml::NumberFault>(&parsed))
        table.fail_at("criterion", "is \"" + text + "\", in which " + text.substr(digits) + " " + fault->why);
    const auto x = static_cast<double>(std::get<Real>(parsed));
    const std::string normalised_text = comparison + " " + text.substr(digits);
    if (comparison == "=") return {x, x, normalised_text};
    if (comparison == ">") return {std::nextafter(x, infinite), infinite, normalised_text};
    if (comparison == ">=") return {x, infinite, normalised_text};
    return {-infinite, comparison == "<" ? std::nextafter(x, -infinite) : x, normalised_text};
}

/// Reads the key `criterion`: a comparison ("= 0", "< 1", "<= 1", "> 0", ">= 10"), or the two ends of an interval.
/// Throws InputError for anything else.
std::optional<Criterion> read_criterion(TableReader& table) {
    if (!table.has("criterion")) return std::nullopt;
    if (table.node("criterion").kind != Node::Kind::array) return parse_comparison(table, table.string("criterion"));
    const auto ends = table.numbers("criterion", 2);
    const auto low = static_cast<double>(ends[0]), high = static_cast<double>(ends[1]);
    if (!(low <= high)) table.fail_at("criterion", "must be [low, high] with low <= high");
    return Criterion{low, high, fmt::format("[{}, {}]", low, high)};
}

/// Reads the onset that a claim is about: its event along the sweep, its statistic and its threshold.
void read_onset(TableReader& table, bool is_whole_sweep, bool is_every_float, Claim& claim) {
    if (!is_whole_sweep && !is_every_float) table.fail_at("onset", "needs a sweep in claim.given, and no `at`");
    const char* const usual_statistic = is_every_float && claim.onset == "lost_bits" ? "max" : "count";
    claim.statistic = table.optional_string("statistic").value_or(usual_statistic);
    if (is_every_float && claim.statistic != usual_statistic)
        table.fail_at("statistic",
                      "must be " + std::string(usual_statistic) + " for a sweep over every float; leave it out");
    claim.threshold = static_cast<double>(table.optional_number("threshold").value_or(Real(1)));
}

void read_expect(TableReader table, Claim& claim) {
    claim.metric = table.optional_string("metric").value_or("");
    claim.onset = table.optional_string("onset").value_or("");
    if (claim.metric.empty() == claim.onset.empty())
        toml::fail(table.where(), "claim.expect names either a metric or an onset; write one of them");

    const auto* const sweep = claim.subject_if<SweepSubject>();
    const bool is_whole_sweep = sweep && sweep->part_if<SweepSubject::WholeSweep>(),
               is_every_float = sweep && sweep->part_if<SweepSubject::EveryFloat>();
    if (!claim.onset.empty()) read_onset(table, is_whole_sweep, is_every_float, claim);
    else if (is_whole_sweep)
        table.fail_at("metric", "along a sweep needs the position on the axis, `at` in claim.given, or a `case`");
    claim.quantity = table.where("metric");
    read_operations(table, claim);

    // The interval that the number must be in, and the criterion that the statement sets for it.
    const auto bounds = table.numbers("in", 2);
    claim.low = static_cast<double>(bounds[0]);
    claim.high = static_cast<double>(bounds[1]);
    if (!(claim.low <= claim.high)) table.fail_at("in", "must be [low, high] with low <= high");
    claim.criterion = read_criterion(table);
    if (claim.criterion) claim.criterion->require_verdict(table, name_of(claim.verdict), claim.low, claim.high);
    claim.draws = static_cast<int>(table.optional_integer("draws", 2, max_draws).value_or(0));
    table.require_known_keys();
}

Claim read_claim(TableReader& table, Claim::Profile profile) {
    Claim claim;
    claim.where = table.where();
    claim.id = table.string("id");
    claim.statement = table.string("statement");
    read_source(table, claim);
    claim.note = table.optional_string("note").value_or("");
    read_verdict(table, claim);
    read_evidence(table, claim);
    claim.profile = profile;
    if (profile == Claim::Profile::timing && table.has("severity"))
        table.reject("severity", "has no meaning here: times never fail a check");
    claim.severity = table.optional_one_of<S>("severity", severities).value_or(S::error);

    read_given(table.table("given"), claim);
    read_expect(table.table("expect"), claim);
    table.require_known_keys();
    return claim;
}

}  // namespace

void Criterion::require_verdict(const toml::TableReader& table, std::string_view verdict, double from,
                                double to) const {
    const bool is_met = is_met_by(from, to), is_failed = is_failed_by(from, to);
    if (verdict == "holds" ? is_met : verdict == "refuted" ? is_failed : is_met || is_failed) return;
    table.fail_at("criterion", fmt::format("is {}, which is {} of the numbers in [{}, {}]: the verdict \"{}\" does not "
                                           "follow; change the verdict, the sentence or the interval",
                                           text,
                                           is_met      ? "true"
                                           : is_failed ? "false"
                                                       : "true of some and false of others",
                                           from, to, verdict));
}

std::string_view name_of(Claim::Verdict verdict) { return find_name(verdicts, verdict); }
std::string_view name_of(Claim::Profile profile) { return find_name(profiles, profile); }
std::string_view name_of(Claim::Evidence evidence) { return find_name(evidences, evidence); }

const std::string& Claim::subject_name() const {
    return std::visit([](const auto& kind) -> const std::string& { return kind.name; }, subject);
}

const std::string& Claim::tested_name() const {
    const auto* const table = subject_if<TableSubject>();
    return table ? table->row : form;
}

std::vector<Claim> read_claims(const std::filesystem::path& path) {
    const Node root = toml::read_toml(path);
    TableReader file(root);
    toml::require_schema(file, "lostbits-claims/1");
    const auto profile = file.optional_one_of<Claim::Profile>("profile", profiles).value_or(Claim::Profile::results);
    std::vector<Claim> claims;
    std::set<std::string> ids;
    for (TableReader& table : file.tables("claim")) {
        if (!ids.insert(table.string("id")).second) table.fail_at("id", "is given twice; each id may be used once");
        claims.push_back(read_claim(table, profile));
    }
    file.require_known_keys();
    return claims;
}

std::vector<std::filesystem::path> list_claim_files(const std::filesystem::path& file_or_folder) {
    if (!std::filesystem::is_directory(file_or_folder)) return {file_or_folder};
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(file_or_folder)) {
        if (entry.path().extension() == ".toml") files.push_back(entry.path());
    }
    std::ranges::sort(files);
    return files;
}

}  // namespace lostbits::scene::check
