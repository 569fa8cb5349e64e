#include "scene/claim/subject.hpp"

#include <algorithm>
#include <optional>

#include "scene/claim/claims_file.hpp"
#include "scene/file/scene.hpp"
#include "scene/sweep/sweep_head.hpp"

namespace lostbits::scene::claim {

using toml::Node;
using toml::TableReader;

namespace {

constexpr std::string_view needs_cases = "needs a sweep of cases, and no `at`";

void read_row(TableReader& table, Claim& claim) {
    claim.form = table.string("form");
    claim.format = table.string("format");
}

/// Marks the keys of a position as known for every subject that is not timed or mended. Their own readers check what
/// they need.
void expect_place(TableReader& table) {
    for (const char* key : {"at", "case", "exhaustive", "step", "pixel", "convention"})
        static_cast<void>(table.has(key));
}

/// Reads `bits`, `wrong` and `at`.
RequiredBits read_requirement(TableReader& table, const char* usually_at) {
    RequiredBits requirement{static_cast<double>(table.number("bits")),
                             static_cast<double>(table.optional_number("wrong").value_or(Real(0))), ""};
    if (!(requirement.bits >= 0 && requirement.bits <= 53)) table.fail_at("bits", "must lie between 0 and 53");
    if (!(requirement.wrong >= 0 && requirement.wrong <= 1))
        table.fail_at("wrong", "is a share of the rays; write 0 to 1");
    requirement.at = table.optional_string("at").value_or(usually_at);
    return requirement;
}

Subject read_timing(TableReader& table, Claim& claim, std::string name) {
    TimingSubject timing{.name = std::move(name)};
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
    return timing;
}

/// Reads a requirement on a scene, or a time relative to another one there.
Subject read_choice(TableReader& table, Claim& claim, std::string name) {
    ChoiceSubject choice{.name = std::move(name)};
    read_row(table, claim);
    if (auto over = table.optional_table("over")) {
        for (const char* key : {"bits", "wrong", "at", "formats"})
            table.reject(key, "belongs to a requirement, but `over` compares two times; write one of the two");
        choice.against = ChoiceSubject::RelativeTime{over->optional_string("form").value_or(claim.form),
                                                     over->optional_string("format").value_or(claim.format)};
        over->reject_unknown_keys();
    } else {
        if (!table.has("bits"))
            toml::fail(
                table.where(),
                "claim.given needs a requirement, `bits = 18`, or `over = { form = \"...\", format = \"...\" }`, whose "
                "time is 1");
        const RequiredBits requirement = read_requirement(table, "p99");
        choice.against = ChoiceSubject::Others{
            requirement, table.optional_strings("formats").value_or(std::vector<std::string>{"f32", "f64"})};
    }
    return choice;
}

Subject read_mend(TableReader& table, Claim& claim, std::string name) {
    MendSubject mend{.name = std::move(name), .requirement = read_requirement(table, "max")};
    if (table.has("size")) {
        const auto size = table.numbers("size", 2);
        const auto side = [&](const Real& x) {
            if (!(x >= 1 && x <= 4096)) table.fail_at("size", "must be [width, height], each from 1 to 4096");
            return static_cast<int>(x);
        };
        mend.size = {side(size[0]), side(size[1])};
    }
    read_row(table, claim);
    return mend;
}

std::optional<int> read_step(TableReader& table) {
    const auto step = table.optional_integer("step", 0, 100000);
    return step ? std::optional(static_cast<int>(*step)) : std::nullopt;
}

Subject read_scene(TableReader& table, Claim& claim, std::string name) {
    read_row(table, claim);
    expect_place(table);
    table.reject("at", "needs a sweep or a table: it is a position on their axes");
    SceneSubject on{std::move(name), read_step(table)};
    if (on.step)
        table.reject("pixel", "is given together with step, which is at pixel (0, 0); leave one of the two out");
    constexpr long long last = 65535;
    if (const auto pixel = table.optional_integers("pixel", 2, 0, last))
        on.pixel = {static_cast<int>((*pixel)[0]), static_cast<int>((*pixel)[1])};
    return on;
}

/// Reads `exhaustive` and its keys. `may`: the claim is about a sweep of which nothing else is named.
std::optional<SweepSubject::EveryFloat> read_every_float(TableReader& table, bool may) {
    if (!table.optional_boolean("exhaustive").value_or(false)) {
        for (const char* key : {"ray", "from", "to"})
            table.reject(key, "needs `exhaustive = true`, for a sweep over every float");
        return std::nullopt;
    }
    if (!may) table.fail_at("exhaustive", "needs a sweep over every float, and neither `at` nor `case`");
    return SweepSubject::EveryFloat{table.optional_string("ray").value_or(""), table.optional_number("from"),
                                    table.optional_number("to")};
}

std::vector<double> read_at(TableReader& table) {
    std::vector<double> at;
    if (table.node("at").kind != Node::Kind::array) return {static_cast<double>(table.number("at"))};
    for (const Real& x : table.numbers("at")) at.push_back(static_cast<double>(x));
    return at;
}

Subject read_sweep(TableReader& table, Claim& claim, std::string name) {
    SweepSubject sweep{.name = std::move(name)};
    read_row(table, claim);
    const bool placed = table.has("at");
    if (placed) sweep.part = SweepSubject::At{read_at(table)};
    const std::string of_case = table.optional_string("case").value_or("");
    if (placed) table.reject("case", needs_cases);
    if (!of_case.empty()) sweep.part = SweepSubject::Case{of_case};
    if (auto every = read_every_float(table, !placed && of_case.empty())) sweep.part = std::move(*every);
    return sweep;
}

Subject read_table(TableReader& table, Claim& claim, std::string name) {
    TableSubject row{.name = std::move(name), .row = table.string("row")};
    claim.format = table.string("format");
    const auto at = table.has("at") ? read_at(table) : std::vector<double>{};
    if (at.size() != 1) toml::fail(table.where(), "a table's row needs `at`, its argument");
    row.at = at.front();
    return row;
}

/// Reads a table of words: `{ check = "reverse" }`.
std::map<std::string, std::string> read_words(TableReader& table, std::string_view key) {
    std::map<std::string, std::string> words;
    if (auto given = table.optional_table(key))
        for (const std::string& name : given->keys()) words[name] = given->string(name);
    return words;
}

/// Reads a study by its name, with the scene in a key of its own.
Subject read_study(TableReader& table, Claim& claim, std::string name) {
    StudySubject study{.name = std::move(name), .study = table.string("study")};
    study.options = read_words(table, "options");
    study.where = read_words(table, "where");
    read_row(table, claim);
    return study;
}

Subject read_render(TableReader& table, Claim& claim, std::string name) {
    StudySubject render{.name = std::move(name), .study = "render"};
    if (const auto stage = table.optional_string("stage")) render.options["stage"] = *stage;
    read_row(table, claim);
    return render;
}

Subject read_offsets(TableReader& table, Claim& claim, std::string name) {
    const std::string points = table.optional_string("points").value_or("computed");
    StudySubject offsets{.name = std::move(name),
                         .study = "offsets",
                         .options = {{"strategy", table.string("strategy")}, {"points", points}},
                         .where = {{"side", table.optional_string("side").value_or("outside")}, {"point", points}}};
    read_row(table, claim);
    return offsets;
}

Subject read_consistency(TableReader& table, Claim& claim, std::string name) {
    StudySubject consistency{
        .name = std::move(name), .study = "consistency", .options = {{"check", table.string("check")}}};
    read_row(table, claim);
    return consistency;
}

Subject read_search(TableReader& table, Claim& claim, std::string name) {
    read_row(table, claim);
    return SearchSubject{std::move(name)};
}

/// A kind of subject, named by its key.
struct Kind {
    std::string_view key;
    Subject (*read)(TableReader& table, Claim& claim, std::string name);
    std::string_view no_place = {};  ///< says why `at`, `case` and `convention` have no meaning there
};

constexpr Kind timing{"timing", read_timing}, choice{"choose", read_choice}, mend{"mend", read_mend};
constexpr std::string_view no_place = "has no meaning for a study of a scene; leave it out";
constexpr Kind study{"scene", read_study, no_place};
constexpr Kind measured[] = {
    {"scene", read_scene},
    {"sweep", read_sweep},
    {"table", read_table},
    {"render", read_render, no_place},
    {"offsets", read_offsets, no_place},
    {"consistency", read_consistency, no_place},
    {"search", read_search, "has no meaning for a search, which draws its own rays; leave it out"}};

/// A key of one kind, and the message if it is given for another kind.
struct OwnKey {
    std::string_view key, kind, why;
};
constexpr std::string_view of_study = "needs study = \"...\" beside scene = \"...\"";
constexpr std::string_view of_offsets = "needs offsets = \"...\", a scene whose next rays the claim is about";
constexpr OwnKey own_keys[] = {
    {"size", "", "is the scene's own; write it there, or name a variant of the scene that has that size"},
    {"strategy", "offsets", of_offsets},
    {"side", "offsets", of_offsets},
    {"points", "offsets", of_offsets},
    {"check", "consistency", "needs consistency = \"...\", a scene whose questions are asked in two ways"},
    {"stage", "render", "needs a scene to render: render = \"raycast-course.pixels\""},
    {"options", "study", of_study},
    {"where", "study", of_study}};

/// Reads a subject that is neither timed nor mended: a form and the rays of one thing.
Subject read_measured(TableReader& table, Claim& claim) {
    for (const Kind& other : {timing, choice})
        table.reject(other.key, "needs `profile = \"timing\"` at the head of the file");
    std::vector<std::pair<const Kind*, std::string>> given;
    const bool is_study = table.has("study");
    for (const Kind& each : measured) {
        const Kind& kind = is_study && each.key == study.key ? study : each;
        const std::string name = table.optional_string(kind.key).value_or("");
        if (!name.empty()) given.emplace_back(&kind, file::beside(table.where().source, name));
    }
    if (given.size() != 1)
        toml::fail(
            table.where(),
            "claim.given needs a scene, a sweep, a search, a table, a scene to render, or a scene for offsets or "
            "consistency; write one of them. A study needs a scene beside its name");
    auto& [kind, name] = given.front();
    if (!kind->no_place.empty()) {
        for (const char* key : {"at", "case", "convention"}) table.reject(key, kind->no_place);
    }
    for (const OwnKey& own : own_keys) {
        if (own.kind != (is_study ? "study" : kind->key)) table.reject(own.key, own.why);
    }
    Subject subject = kind->read(table, claim, std::move(name));
    expect_place(table);
    if (!std::holds_alternative<SweepSubject>(subject)) {
        if (table.optional_string("case")) table.reject("case", needs_cases);
        read_every_float(table, false);
    }
    if (!std::holds_alternative<SceneSubject>(subject) && read_step(table))
        table.reject("step", "needs a scene: it is a sample of the march along the scene's pixel (0, 0)");
    if (!std::holds_alternative<SceneSubject>(subject))
        table.reject("pixel", "needs a scene: it is the column and the row of one of its rays");
    claim.convention = sweep::read_convention(table);
    return subject;
}

}  // namespace

void read_given(TableReader table, Claim& claim) {
    const auto whole = [&](const Kind& kind) {
        return kind.read(table, claim, file::beside(table.where().source, table.string(kind.key)));
    };
    if (claim.profile == Claim::Profile::timing) claim.subject = whole(table.has(choice.key) ? choice : timing);
    else if (table.has(mend.key)) claim.subject = whole(mend);
    else claim.subject = read_measured(table, claim);
    claim.requirements = table.optional_strings("requires").value_or(std::vector<std::string>{});
    table.reject_unknown_keys();
}

}  // namespace lostbits::scene::claim
