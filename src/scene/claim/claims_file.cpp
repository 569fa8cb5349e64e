#include "scene/claim/claims_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>

#include "scene/file/beside.hpp"
#include "scene/sweep/convention.hpp"
#include "scene/toml/toml_reader.hpp"

namespace lostbits::scene::claim {

using file::Stage;
using toml::Node;
using toml::TableReader;

namespace {

using V = Claim::Verdict;
using S = Claim::Severity;
constexpr std::pair<std::string_view, V> verdicts[] = {
    {"holds", V::holds}, {"qualified", V::qualified}, {"refuted", V::refuted}};
constexpr std::pair<std::string_view, S> severities[] = {{"error", S::error}, {"warn", S::warn}};
constexpr long long most_draws = 1000;
constexpr std::pair<std::string_view, Claim::Profile> profiles[] = {
    {"results", Claim::Profile::results}, {"timing", Claim::Profile::timing}, {"libraries", Claim::Profile::libraries}};

using Evidence = Claim::Evidence;
constexpr std::pair<std::string_view, Evidence> evidences[] = {{"proof", Evidence::proof},
                                                               {"exhaustive", Evidence::exhaustive},
                                                               {"search", Evidence::search},
                                                               {"counterexample", Evidence::counterexample},
                                                               {"sample", Evidence::sample}};

/// What was found, and of a qualified sentence what it takes for it to be true.
void read_verdict(TableReader& table, Claim& claim) {
    claim.verdict = table.one_of<V>("verdict", verdicts);
    claim.condition = table.optional_string("condition").value_or("");
    if (claim.verdict == V::qualified && claim.condition.empty())
        table.fail_at("verdict",
                      "is qualified: say when the sentence is true, as condition = \"where touching is a miss\"");
    if (claim.verdict != V::qualified && !claim.condition.empty())
        table.fail_at("condition", "goes with verdict = \"qualified\": a sentence that is true where it is met");
}

/// What the verdict rests on, and whether the claim has that.
void read_evidence(TableReader& table, Claim& claim) {
    claim.evidence = table.optional_one_of<Evidence>("evidence", evidences).value_or(Evidence::none);
    claim.lemma = table.optional_string("lemma").value_or("");
    if (claim.evidence == Evidence::proof && claim.lemma.empty())
        table.fail_at("evidence", "is a proof: write its inequality, or where that stands, as lemma = \"...\"");
    if (claim.evidence != Evidence::proof && !claim.lemma.empty())
        table.fail_at("lemma", "goes with evidence = \"proof\", of which it is the inequality");
    if (claim.evidence == Evidence::counterexample && claim.verdict == V::holds)
        table.fail_at("evidence", "is a counterexample, which refutes a sentence: write verdict = \"refuted\"");
}

void read_timing(TableReader table, Claim& claim) {
    Claim::Timing timing;
    timing.work = table.string("timing");
    claim.form = table.string("form");
    timing.kernel = table.string("kernel");
    claim.format = table.string("format");
    timing.data = table.string("data");
    timing.all_processors = table.optional_boolean("all_processors").value_or(false);
    if (auto over = table.optional_table("over")) {
        if (timing.all_processors)
            table.reject("over", "cannot be combined with all_processors, which compares with one processor");
        timing.over_form = over->optional_string("form").value_or(claim.form);
        timing.over_kernel = over->optional_string("kernel").value_or(timing.kernel);
        over->reject_unknown_keys();
    } else if (!timing.all_processors) {
        toml::fail(table.where(),
                   "claim.given needs `over = { form = \"...\", kernel = \"...\" }`, whose speed is 1, or "
                   "`all_processors = true`");
    }
    claim.timing = std::move(timing);
    claim.requirements = table.optional_strings("requires").value_or(std::vector<std::string>{});
    table.reject_unknown_keys();
}

/// `bits` and `wrong` of a wish.
void read_wish(TableReader& table, double& bits, double& wrong) {
    bits = static_cast<double>(table.number("bits"));
    wrong = static_cast<double>(table.optional_number("wrong").value_or(Real(0)));
    if (!(bits >= 0 && bits <= 53)) table.fail_at("bits", "must lie in 0 to 53");
    if (!(wrong >= 0 && wrong <= 1)) table.fail_at("wrong", "is a share of the rays, 0 to 1");
}

/// `choose`: a wish on a scene, or a time over another's there.
void read_choice(TableReader table, Claim& claim) {
    Claim::Choice choice;
    choice.scene = file::beside(table.where().source, table.string("choose"));
    claim.form = table.string("form");
    claim.format = table.string("format");
    if (auto over = table.optional_table("over")) {
        for (const char* key : {"bits", "wrong", "at", "formats"})
            table.reject(key, "belongs to a wish, and `over` compares two times; write one of the two");
        choice.over_form = over->optional_string("form").value_or(claim.form);
        choice.over_format = over->optional_string("format").value_or(claim.format);
        over->reject_unknown_keys();
    } else {
        if (!table.has("bits"))
            toml::fail(table.where(),
                       "claim.given needs a wish, `bits = 18`, or `over = { form = \"...\", format = \"...\" }`, whose "
                       "time is 1");
        choice.bits.emplace();
        read_wish(table, *choice.bits, choice.wrong);
        choice.at = table.optional_string("at").value_or("p99");
        choice.formats = table.optional_strings("formats").value_or(std::vector<std::string>{"f32", "f64"});
    }
    claim.choice = std::move(choice);
    claim.requirements = table.optional_strings("requires").value_or(std::vector<std::string>{});
    table.reject_unknown_keys();
}

/// What is given of claims about times.
void read_timed(TableReader table, Claim& claim) {
    if (table.has("choose")) read_choice(std::move(table), claim);
    else read_timing(std::move(table), claim);
}

/// `mend`: a scene, the wish, and in which picture of it.
void read_mend(TableReader& table, Claim& claim) {
    Claim::Mend mend{.scene = file::beside(table.where().source, table.string("mend"))};
    read_wish(table, mend.bits, mend.wrong);
    mend.at = table.optional_string("at").value_or("max");
    if (table.has("size")) {
        const auto size = table.numbers("size", 2);
        const auto side = [&](const Real& x) {
            if (!(x >= 1 && x <= 4096)) table.fail_at("size", "must lie in 1 to 4096, as [width, height]");
            return static_cast<int>(x);
        };
        mend.size = {side(size[0]), side(size[1])};
    }
    claim.mend = std::move(mend);
    claim.form = table.string("form");
    claim.format = table.string("format");
    claim.requirements = table.optional_strings("requires").value_or(std::vector<std::string>{});
    table.reject_unknown_keys();
}

/// `strategy`, `side` and `points`, which go with `offsets`.
void read_offsets(TableReader& table, Claim& claim) {
    if (claim.offsets.empty()) {
        for (const char* key : {"strategy", "side", "points"})
            table.reject(key, "goes with offsets = \"...\", a scene whose respawned rays the claim is about");
        return;
    }
    for (const char* key : {"at", "case", "convention"})
        table.reject(key, "has no meaning for offsets of a scene; leave it out");
    claim.strategy = table.string("strategy");
    claim.side = table.optional_string("side").value_or("outside");
    claim.points = table.optional_string("points").value_or("computed");
}

/// `check`, which goes with `consistency`.
void read_consistency(TableReader& table, Claim& claim) {
    if (claim.consistency.empty())
        return table.reject("check", "goes with consistency = \"...\", a scene whose questions are put in two ways");
    for (const char* key : {"at", "case", "convention"})
        table.reject(key, "has no meaning for the consistency of a scene; leave it out");
    claim.check = table.string("check");
}

void read_given(TableReader table, Claim& claim) {
    if (table.has("mend")) return read_mend(table, claim);
    const auto named = [&table](const char* key) {
        return file::beside(table.where().source, table.optional_string(key).value_or(""));
    };
    claim.scene = named("scene");
    claim.sweep = named("sweep");
    claim.table = table.optional_string("table").value_or("");
    for (const char* key : {"timing", "choose"})
        table.reject(key, "needs `profile = \"timing\"` at the head of the file");
    claim.render = named("render");
    claim.offsets = named("offsets");
    claim.consistency = named("consistency");
    claim.search = named("search");
    const std::string* const subjects[] = {&claim.scene,   &claim.sweep,       &claim.table, &claim.render,
                                           &claim.offsets, &claim.consistency, &claim.search};
    if (std::ranges::count_if(subjects, [](const std::string* s) { return !s->empty(); }) != 1) {
        toml::fail(
            table.where(),
            "claim.given names a scene, a sweep, a search, a table, a scene to render or one of which offsets or "
            "consistency are measured; write one of them");
    }
    table.reject("size", "is the scene's own; write it there, or name a variant of the scene that has that size");
    read_offsets(table, claim);
    read_consistency(table, claim);
    if (!claim.search.empty()) {
        for (const char* key : {"at", "case", "convention"})
            table.reject(key, "has no meaning for a search, which draws its rays by itself; leave it out");
    }
    if (!claim.render.empty()) {
        for (const char* key : {"at", "case", "convention"})
            table.reject(key, "has no meaning for a rendered scene; leave it out");
        static constexpr std::pair<std::string_view, Stage> stages[] = {{"visible", Stage::visible},
                                                                        {"diffuse", Stage::diffuse},
                                                                        {"shadows", Stage::shadows},
                                                                        {"phong", Stage::phong}};
        claim.stage = table.optional_one_of<Stage>("stage", stages);
    } else {
        table.reject("stage", "needs a scene to render: render = \"raycast-course.pixels\"");
    }
    if (claim.table.empty()) claim.form = table.string("form");
    else claim.row = table.string("row");
    claim.format = table.string("format");
    if (table.has("at")) {
        if (!claim.scene.empty()) table.reject("at", "needs a sweep or a table: it is a place on their axes");
        if (table.node("at").kind == Node::Kind::array) {
            for (const Real& x : table.numbers("at")) claim.at.push_back(static_cast<double>(x));
        } else {
            claim.at.push_back(static_cast<double>(table.number("at")));
        }
    }
    if (!claim.table.empty() && claim.at.size() != 1)
        toml::fail(table.where(), "a table's row needs `at`, its argument");
    if (const auto name = table.optional_string("case")) {
        if (claim.sweep.empty() || !claim.at.empty()) table.reject("case", "needs a sweep of cases, and no `at`");
        claim.case_name = *name;
    }
    claim.exhaustive = table.optional_boolean("exhaustive").value_or(false);
    if (claim.exhaustive) {
        if (claim.sweep.empty() || !claim.at.empty() || !claim.case_name.empty())
            table.fail_at("exhaustive", "needs a sweep over every float, and neither `at` nor `case`");
        claim.ray = table.optional_string("ray").value_or("");
        claim.from = table.optional_number("from");
        claim.to = table.optional_number("to");
    } else {
        for (const char* key : {"ray", "from", "to"})
            table.reject(key, "goes with `exhaustive = true`: it is of a sweep over every float");
    }
    if (const auto step = table.optional_integer("step", 0, 100000)) {
        if (claim.scene.empty())
            table.reject("step", "needs a scene: it is a sample of the march along the scene's pixel (0, 0)");
        claim.step = static_cast<int>(*step);
    }
    claim.convention = sweep::read_convention(table);
    claim.requirements = table.optional_strings("requires").value_or(std::vector<std::string>{});
    table.reject_unknown_keys();
}

/// `operation = "c"`, or several.
void read_operations(TableReader& table, Claim& claim) {
    constexpr std::string_view share = "culprit_fraction", key = "operation";
    if (claim.metric != share)
        return table.reject(key, "goes with metric = \"culprit_fraction\", the share of that operation");
    if (!table.has(key))
        table.fail_at("metric",
                      "needs an operation: operation = \"c\", its name in the formula, or an expression as `lostbits "
                      "map --metric culprit` writes it");
    claim.quantity = table.where(key);
    claim.operations = table.node(key).kind == Node::Kind::array ? table.strings(key) : std::vector{table.string(key)};
    if (claim.operations.empty()) table.fail_at(key, "is empty; name an operation");
}

void read_expect(TableReader table, Claim& claim) {
    claim.metric = table.optional_string("metric").value_or("");
    claim.onset = table.optional_string("onset").value_or("");
    if (claim.metric.empty() == claim.onset.empty())
        toml::fail(table.where(), "claim.expect names either a metric or an onset; write one of them");
    if (!claim.onset.empty()) {
        if (claim.sweep.empty() || !claim.at.empty() || !claim.case_name.empty())
            table.fail_at("onset", "needs a sweep in claim.given, and no `at`");
        const char* const usual = claim.exhaustive && claim.onset == "lost_bits" ? "max" : "count";
        claim.statistic = table.optional_string("statistic").value_or(usual);
        if (claim.exhaustive && claim.statistic != usual)
            table.fail_at("statistic", "over every float is " + std::string(usual) + "; leave it out");
        claim.threshold = static_cast<double>(table.optional_number("threshold").value_or(Real(1)));
    } else if (!claim.sweep.empty() && claim.at.empty() && claim.case_name.empty() && !claim.exhaustive) {
        table.fail_at("metric", "along a sweep needs `at` in claim.given, the place on the axis, or `case`");
    }
    claim.quantity = table.where("metric");
    read_operations(table, claim);
    const auto ends = table.numbers("in", 2);
    claim.low = static_cast<double>(ends[0]);
    claim.high = static_cast<double>(ends[1]);
    if (!(claim.low <= claim.high)) table.fail_at("in", "must be [low, high] with low <= high");
    claim.criterion = read_criterion(table);
    if (claim.criterion) claim.criterion->demand(table, name_of(claim.verdict), claim.low, claim.high);
    claim.draws = static_cast<int>(table.optional_integer("draws", 2, most_draws).value_or(0));
    table.reject_unknown_keys();
}

}  // namespace

std::string_view name_of(Claim::Verdict verdict) {
    return std::ranges::find(verdicts, verdict, &std::pair<std::string_view, V>::second)->first;
}

std::string_view name_of(Claim::Profile profile) {
    return std::ranges::find(profiles, profile, &std::pair<std::string_view, Claim::Profile>::second)->first;
}

std::string_view name_of(Claim::Evidence evidence) {
    const auto found = std::ranges::find(evidences, evidence, &std::pair<std::string_view, Evidence>::second);
    return found == std::end(evidences) ? "" : found->first;
}

std::vector<Claim> read_claims(const std::filesystem::path& path) {
    const Node root = toml::read_toml(path);
    TableReader file(root);
    toml::require_schema(file, "lostbits-claims/1");
    const auto profile = file.optional_one_of<Claim::Profile>("profile", profiles).value_or(Claim::Profile::results);
    std::vector<Claim> claims;
    std::set<std::string> ids;
    for (TableReader& table : file.tables("claim")) {
        Claim claim;
        claim.where = table.where();
        claim.id = table.string("id");
        if (!ids.insert(claim.id).second) table.fail_at("id", "is given twice; each id may be used once");
        claim.statement = table.string("statement");
        claim.source = table.string("source");
        claim.note = table.optional_string("note").value_or("");
        read_verdict(table, claim);
        read_evidence(table, claim);
        claim.profile = profile;
        if (profile == Claim::Profile::timing && table.has("severity"))
            table.reject("severity", "has no meaning here: times never fail a check");
        claim.severity = table.optional_one_of<S>("severity", severities).value_or(S::error);
        if (profile == Claim::Profile::timing) read_timed(table.table("given"), claim);
        else read_given(table.table("given"), claim);
        read_expect(table.table("expect"), claim);
        table.reject_unknown_keys();
        claims.push_back(std::move(claim));
    }
    file.reject_unknown_keys();
    return claims;
}

std::vector<std::filesystem::path> claim_files(const std::filesystem::path& file_or_folder) {
    if (!std::filesystem::is_directory(file_or_folder)) return {file_or_folder};
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(file_or_folder)) {
        if (entry.path().extension() == ".toml") files.push_back(entry.path());
    }
    std::ranges::sort(files);
    return files;
}

}  // namespace lostbits::scene::claim
