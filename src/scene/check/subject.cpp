#include "scene/check/subject.hpp"

#include <algorithm>
#include <optional>

#include "scene/check/claims_file.hpp"
#include "scene/file/scene.hpp"
#include "scene/sweep/sweep_head.hpp"

namespace lostbits::scene::check {

using toml::Node;
using toml::TableReader;

namespace {

constexpr std::string_view needs_cases = "needs a sweep of cases, and no `at`";

void read_row(TableReader& table, Claim& claim) {
    claim.form = table.string("form");
    claim.format = table.string("format");
}

/// Marks the keys of a position as known, for every subject that is neither timed nor repaired. The readers of these
/// keys check whether the subject allows them.
void mark_position_keys(TableReader& table) {
    for (const char* key : {"at", "case", "exhaustive", "step", "pixel", "convention"})
        static_cast<void>(table.has(key));
}

/// Reads `bits`, `wrong` and `at`.
RequiredBits read_requirement(TableReader& table, const char* default_at) {
    RequiredBits requirement{static_cast<double>(table.number("bits")),
                             static_cast<double>(table.optional_number("wrong").value_or(Real(0))), ""};
    if (!(requirement.bits >= 0 && requirement.bits <= 53)) table.fail_at("bits", "must lie between 0 and 53");
    if (!(requirement.max_wrong_fraction >= 0 && requirement.max_wrong_fraction <= 1))
        table.fail_at("wrong", "is a share of the rays; write 0 to 1");
    requirement.quantile = table.optional_string("at").value_or(default_at);
    return requirement;
}

Subject read_timing(TableReader& table, Claim& claim, std::string name) {
    TimingSubject timing{.name = std::move(name)};
    claim.form = table.string("form");
    timing.kernel = table.string("kernel");
    claim.format = table.string("format");
    timing.data = table.string("data");
    timing.uses_all_processors = table.optional_boolean("all_processors").value_or(false);
    if (auto over = table.optional_table("over")) {
        if (timing.uses_all_processors)
            table.reject("over", "cannot be combined with all_processors, which compares with one processor");
        timing.baseline_form = over->optional_string("form").value_or(claim.form);
        timing.baseline_kernel = over->optional_string("kernel").value_or(timing.kernel);
        over->require_known_keys();
    } else if (!timing.uses_all_processors) {
        toml::fail(table.where(),
                   "claim.given needs `over = { form = \"...\", kernel = \"...\" }`, whose speed is 1, or "
                   "`all_processors = true`");
    }
    return timing;
}

/// Reads a requirement on a scene, or a time relative to that of another form and format on this scene.
Subject read_choice(TableReader& table, Claim& claim, std::string name) {
    ChoiceSubject choice{.name = std::move(name)};
    read_row(table, claim);
    if (auto over = table.optional_table("over")) {
        for (const char* key : {"bits", "wrong", "at", "formats"})
            table.reject(key, "belongs to a requirement, but `over` compares two times; write one of the two");
        choice.against = ChoiceSubject::RelativeTime{over->optional_string("form").value_or(claim.form),
                                                     over->optional_string("format").value_or(claim.format)};
        over->require_known_keys();
    } else {
        if (!table.has("bits"))
            toml::fail(
                table.where(),
                "claim.given needs a requirement, `bits = 18`, or `over = { form = \"...\", format = \"...\" }`, whose "
                "time is 1");
        const RequiredBits requirement = read_requirement(table, "p99");
        choice.against = ChoiceSubject::OtherForms{
            requirement, table.optional_strings("formats").value_or(std::vector<std::string>{"f32", "f64"})};
    }
    return choice;
}

Subject read_repair(TableReader& table, Claim& claim, std::string name) {
    MendSubject repair{.name = std::move(name), .requirement = read_requirement(table, "max")};
    if (table.has("size")) {
        const auto size = table.numbers("size", 2);
        const auto side = [&](const Real& x) {
            if (!(x >= 1 && x <= 4096)) table.fail_at("size", "must be [width, height], each from 1 to 4096");
            return static_cast<int>(x);
        };
        repair.size = {side(size[0]), side(size[1])};
    }
    read_row(table, claim);
    return repair;
}

std::optional<int> read_step(TableReader& table) {
    const auto step = table.optional_integer("step", 0, 100000);
    return step ? std::optional(static_cast<int>(*step)) : std::nullopt;
}

Subject read_scene(TableReader& table, Claim& claim, std::string name) {
    read_row(table, claim);
    mark_position_keys(table);
    table.reject("at", "needs a sweep or a table: it is a position on their axes");
    SceneSubject subject{std::move(name), read_step(table)};
    if (subject.step)
        table.reject("pixel", "is given together with step, which is at pixel (0, 0); leave one of the two out");
    constexpr long long last = 65535;
    if (const auto pixel = table.optional_integers("pixel", 2, 0, last))
        subject.pixel = {static_cast<int>((*pixel)[0]), static_cast<int>((*pixel)[1])};
    return subject;
}

/// Reads `exhaustive` and its keys. `is_allowed` is true if the claim is about a sweep without `at` and `case`.
std::optional<SweepSubject::EveryFloat> read_every_float(TableReader& table, bool is_allowed) {
    if (!table.optional_boolean("exhaustive").value_or(false)) {
        for (const char* key : {"ray", "from", "to"})
            table.reject(key, "needs `exhaustive = true`, for a sweep over every float");
        return std::nullopt;
    }
    if (!is_allowed) table.fail_at("exhaustive", "needs a sweep over every float, and neither `at` nor `case`");
    return SweepSubject::EveryFloat{table.optional_string("ray").value_or(""), table.optional_number("from"),
                                    table.optional_number("to")};
}

std::vector<double> read_at(TableReader& table) {
    std::vector<double> values;
    if (table.node("at").kind != Node::Kind::array) return {static_cast<double>(table.number("at"))};
    for (const Real& x : table.numbers("at")) values.push_back(static_cast<double>(x));
    return values;
}

Subject read_sweep(TableReader& table, Claim& claim, std::string name) {
    SweepSubject sweep{.name = std::move(name)};
    read_row(table, claim);
    const bool has_position = table.has("at");
    if (has_position) sweep.part = SweepSubject::SweepPosition{read_at(table)};
    const std::string case_name = table.optional_string("case").value_or("");
    if (has_position) table.reject("case", needs_cases);
    if (!case_name.empty()) sweep.part = SweepSubject::Case{case_name};
    if (auto every_float = read_every_float(table, !has_position && case_name.empty()))
        sweep.part = std::move(*every_float);
    return sweep;
}

Subject read_table(TableReader& table, Claim& claim, std::string name) {
    TableSubject row{.name = std::move(name), .row = table.string("row")};
    claim.format = table.string("format");
    const auto values = table.has("at") ? read_at(table) : std::vector<double>{};
    if (values.size() != 1) toml::fail(table.where(), "a table's row needs `at`, its argument");
    row.argument = values.front();
    return row;
}

/// Reads a table of texts by name: `{ check = "reverse" }`.
std::map<std::string, std::string> read_texts(TableReader& table, std::string_view key) {
    std::map<std::string, std::string> texts;
    if (auto text_table = table.optional_table(key))
        for (const std::string& name : text_table->keys()) texts[name] = text_table->string(name);
    return texts;
}

/// Reads a study by its name, with the scene in a key of its own.
Subject read_study(TableReader& table, Claim& claim, std::string name) {
    StudySubject study{.name = std::move(name), .study = table.string("study")};
    study.options = read_texts(table, "options");
    study.where = read_texts(table, "where");
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
    /// Message that `at`, `case` and `convention` have no meaning for this subject.
    std::string_view no_position_reason = {};
};

constexpr Kind timing_kind{"timing", read_timing}, choice_kind{"choose", read_choice}, repair_kind{"mend", read_repair};
constexpr std::string_view study_has_no_position = "has no meaning for a study of a scene; leave it out";
constexpr Kind study_kind{"scene", read_study, study_has_no_position};
constexpr Kind measured_kinds[] = {
    {"scene", read_scene},
    {"sweep", read_sweep},
    {"table", read_table},
    {"render", read_render, study_has_no_position},
    {"offsets", read_offsets, study_has_no_position},
    {"consistency", read_consistency, study_has_no_position},
    {"search", read_search, "has no meaning for a search, which draws its own rays; leave it out"}};

/// A key of one kind, and the message if it is given for another kind.
struct OwnKey {
    std::string_view key, kind, message;
};
constexpr std::string_view needs_study = "needs study = \"...\" beside scene = \"...\"";
constexpr std::string_view needs_offsets = "needs offsets = \"...\", a scene whose next rays the claim is about";
constexpr OwnKey own_keys[] = {
    {"size", "", "is the scene's own; write it there, or name a variant of the scene that has that size"},
    {"strategy", "offsets", needs_offsets},
    {"side", "offsets", needs_offsets},
    {"points", "offsets", needs_offsets},
    {"check", "consistency", "needs consistency = \"...\", a scene whose questions are asked in two ways"},
    {"stage", "render", "needs a scene to render: render = \"raycast-course.pixels\""},
    {"options", "study", needs_study},
    {"where", "study", needs_study}};

/// Finds the one kind of subject that a claim names, and the name.
std::pair<const Kind*, std::string> find_named_subject(TableReader& table, bool is_study) {
    std::vector<std::pair<const Kind*, std::string>> named_subjects;
    for (const Kind& candidate : measured_kinds) {
        const Kind& kind = is_study && candidate.key == study_kind.key ? study_kind : candidate;
        const std::string name = table.optional_string(kind.key).value_or("");
        if (!name.empty()) named_subjects.emplace_back(&kind, file::resolve_beside(table.where().source, name));
    }
    if (named_subjects.size() != 1)
        toml::fail(
            table.where(),
            "claim.given needs a scene, a sweep, a search, a table, a scene to render, or a scene for offsets or "
            "consistency; write one of them. A study needs a scene besides its name");
    return std::move(named_subjects.front());
}

/// Rejects the keys that have a meaning only for subjects of other kinds.
void require_no_foreign_keys(TableReader& table, const Kind& kind, bool is_study) {
    if (!kind.no_position_reason.empty()) {
        for (const char* key : {"at", "case", "convention"}) table.reject(key, kind.no_position_reason);
    }
    for (const OwnKey& own_key : own_keys) {
        if (own_key.kind != (is_study ? "study" : kind.key)) table.reject(own_key.key, own_key.message);
    }
}

/// Rejects the keys of a position that does not fit the subject.
void require_no_foreign_positions(TableReader& table, const Subject& subject) {
    if (!std::holds_alternative<SweepSubject>(subject)) {
        if (table.optional_string("case")) table.reject("case", needs_cases);
        read_every_float(table, false);
    }
    if (!std::holds_alternative<SceneSubject>(subject) && read_step(table))
        table.reject("step", "needs a scene: it is a sample of the march along the scene's pixel (0, 0)");
    if (!std::holds_alternative<SceneSubject>(subject))
        table.reject("pixel", "needs a scene: it is the column and the row of one of its rays");
}

/// Reads a subject that is neither timed nor repaired: a form, and rays of a scene, a sweep or another source.
Subject read_measured(TableReader& table, Claim& claim) {
    for (const Kind& timed_kind : {timing_kind, choice_kind})
        table.reject(timed_kind.key, "needs `profile = \"timing\"` at the head of the file");
    const bool is_study = table.has("study");
    auto [kind, name] = find_named_subject(table, is_study);
    require_no_foreign_keys(table, *kind, is_study);

    Subject subject = kind->read(table, claim, std::move(name));
    mark_position_keys(table);
    require_no_foreign_positions(table, subject);
    claim.convention = sweep::read_convention(table);
    return subject;
}

}  // namespace

void read_given(TableReader table, Claim& claim) {
    const auto read_subject = [&](const Kind& kind) {
        return kind.read(table, claim, file::resolve_beside(table.where().source, table.string(kind.key)));
    };
    if (claim.profile == Claim::Profile::timing)
        claim.subject = read_subject(table.has(choice_kind.key) ? choice_kind : timing_kind);
    else if (table.has(repair_kind.key)) claim.subject = read_subject(repair_kind);
    else claim.subject = read_measured(table, claim);
    claim.requirements = table.optional_strings("requires").value_or(std::vector<std::string>{});
    table.require_known_keys();
}

}  // namespace lostbits::scene::check
