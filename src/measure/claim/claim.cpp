#include "measure/claim/claim.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "intersect/simd/packed.hpp"
#include "measure/answer/one_ray.hpp"
#include "measure/claim/arithmetic.hpp"
#include "measure/claim/claim_columns.hpp"
#include "measure/claim/claim_timing.hpp"
#include "measure/claim/closest.hpp"
#include "measure/picture/render.hpp"
#include "measure/speed/timing_threads.hpp"
#include "measure/sweep/cases.hpp"
#include "number/error.hpp"
#include "scene/toml/did_you_mean.hpp"

namespace lostbits::measure::claim {

using blame::SettingOf;
using map::MapRow;
using scene::sweep::SweepKind;

namespace {

using scene::claim::Claim;

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

Format format_of(const Claim& claim) {
    const auto format = find_format(claim.format);
    if (!format)
        scene::toml::fail(claim.where,
                          "unknown format \"" + claim.format + "\"; write f32, f64, fp16, bf16, tf32 or pN");
    return *format;
}

/// The claims about one scene or sweep: their places in the list.
using Places = std::vector<std::size_t>;

/// The rows of several claims, each once: its place.
std::size_t place_in(std::vector<MapRow>& rows, const MapRow& row) {
    const auto found = std::ranges::find(rows, row);
    if (found != rows.end()) return static_cast<std::size_t>(found - rows.begin());
    rows.push_back(row);
    return rows.size() - 1;
}

std::vector<Claim> those_at(const std::vector<Claim>& claims, const Places& places) {
    std::vector<Claim> some;
    for (const std::size_t i : places) some.push_back(claims[i]);
    return some;
}

ClaimResult judge(const Claim& claim, double measured, const map::MapSummary* summary) {
    ClaimResult result;
    result.measured = measured;
    if (summary) result.witness = summary->worst;
    if (summary && summary->count(answer::Outcome::unresolved) > 0) {
        result.trouble = std::to_string(summary->count(answer::Outcome::unresolved)) + " rays have no proved truth";
    } else if (std::isnan(measured)) {
        result.trouble = "there is no ray to measure it on";
    } else {
        result.state = measured >= claim.low && measured <= claim.high ? ClaimResult::State::agrees
                                                                       : ClaimResult::State::disagrees;
    }
    return result;
}

/// The form and format of a claim about a scene or sweep that the form can handle.
template <class Subject>
MapRow row_for(const Claim& claim, const Subject& subject) {
    const MapRow row = claim_row(claim);
    if (subject.meets(row.form->shape)) return row;
    scene::toml::fail(claim.where, claim.subject() + " is not handled by " + claim.form + ": it has " +
                                       (row.form->shape == Shape::sdf ? "no [march] table" : "other solids") +
                                       "; name another form, or another scene or sweep");
}

/// What `find` finds for a claim; an unknown name is the claim's fault, so its place starts the message.
template <class Find>
auto find_for(const Claim& claim, const Find& find) {
    try {
        return find();
    } catch (const InputError& error) {
        scene::toml::fail(claim.where, error.what());
    }
}

/// One number of one sample of a march along the scene's first pixel.
double trace_value(const Claim& claim, const scene::file::Scene& scene) {
    const MapRow row = row_for(claim, scene);
    if (!row.form->log)
        scene::toml::fail(claim.where, claim.form + " does not march; `step` is for the forms of sdf.*");
    const intersect::table::MarchLog log = answer::march_log(*row.form, row.format, answer::OneRay(scene, 0, 0));
    if (claim.metric == "steps") return static_cast<double>(log.steps.size());
    if (claim.metric == "hit") return log.hit.hit ? 1 : 0;
    if (claim.metric == "end") return log.hit.t;
    if (static_cast<std::size_t>(*claim.step) >= log.steps.size()) return missing;
    const intersect::MarchStep& s = log.steps[static_cast<std::size_t>(*claim.step)];
    const std::map<std::string, double> columns{{"t", s.t},   {"x", s.p.x},       {"y", s.p.y},
                                                {"z", s.p.z}, {"length", s.size}, {"d", s.d}};
    const auto found = columns.find(claim.metric);
    if (found == columns.end())
        scene::toml::fail(claim.where,
                          "unknown metric \"" + claim.metric +
                              "\"; a step has t, x, y, z, length and d, and a march has steps, hit and end");
    return found->second;
}

void measure_scene(const std::vector<Claim>& claims, const Places& places, const std::filesystem::path& data_dir,
                   std::vector<ClaimResult>& results) {
    const Claim& first = claims[places.front()];
    const auto name = find_for(first, [&] { return scene::file::find_scene(first.scene, data_dir); });
    const auto scenes = scene::file::load_scene(name.path, {.variant = name.variant});
    if (scenes.size() != 1)
        scene::toml::fail(
            first.where, "scene \"" + first.scene + "\" has variants; name one, such as \"" + scenes.front().id + "\"");
    Places pictures;
    for (const std::size_t i : places) {
        if (claims[i].step) results[i] = judge(claims[i], trace_value(claims[i], scenes.front()), nullptr);
        else pictures.push_back(i);
    }
    if (pictures.empty()) return;
    map::MapRequest request{.scene = &scenes.front(), .rows = {}, .metrics = {}};
    std::vector<std::size_t> rows;
    for (const std::size_t i : pictures) rows.push_back(place_in(request.rows, row_for(claims[i], scenes.front())));
    const SettingOf setting(scenes.front());
    const ClaimColumns columns(those_at(claims, pictures), request.rows, setting.get());
    request.metrics = columns.metrics();
    const auto summaries = map::run_map(request, {});
    for (std::size_t k = 0; k < pictures.size(); ++k) {
        const Claim& claim = claims[pictures[k]];
        results[pictures[k]] = judge(claim, columns.value(claim, summaries[rows[k]]), &summaries[rows[k]]);
    }
}

/// What a picture can be made by.
struct SpheresAlone {
    [[nodiscard]] static bool meets(Shape shape) { return shape == Shape::sphere; }
};

/// The claims about one rendered scene: one run, all stages that they name.
void measure_render(const std::vector<Claim>& claims, const Places& places, const std::filesystem::path& data_dir,
                    std::vector<ClaimResult>& results) {
    const Claim& first = claims[places.front()];
    const auto name = find_for(first, [&] { return scene::file::find_scene(first.render, data_dir); });
    const auto scenes = scene::file::load_scene(name.path, {.variant = name.variant});
    if (scenes.size() != 1)
        scene::toml::fail(first.where, "scene \"" + first.render + "\" has variants; name one, such as \"" +
                                           scenes.front().id + "\"");
    if (!scenes.front().meets(Shape::sphere))
        scene::toml::fail(first.where, "scene \"" + first.render + "\" has no spheres to render");
    const scene::file::Appearance& look = scenes.front().appearance;
    picture::RenderRequest request{.scene = &scenes.front(), .stages = {}, .rows = {}};
    std::set<scene::file::Stage> stages;
    for (const std::size_t i : places) {
        const scene::file::Stage stage = claims[i].stage.value_or(look.furthest());
        if (!look.asks_for(stage))
            scene::toml::fail(claims[i].where,
                              "scene \"" + first.render + "\" has no stage " + std::string(name_of(stage)));
        stages.insert(stage);
        request.rows.push_back(row_for(claims[i], SpheresAlone{}));
    }
    request.stages.assign(stages.begin(), stages.end());
    const auto summaries = picture::run_render(request);
    for (std::size_t k = 0; k < places.size(); ++k) {
        const Claim& claim = claims[places[k]];
        const auto stage =
            std::ranges::find(request.stages, claim.stage.value_or(look.furthest())) - request.stages.begin();
        const picture::RenderSummary& s = summaries[k * request.stages.size() + static_cast<std::size_t>(stage)];
        ClaimResult& result = results[places[k]] =
            judge(claim, picture::render_value(s, claim.metric, claim.where.text()), nullptr);
        if (s.unresolved() == 0) continue;
        result.state = ClaimResult::State::broken;
        result.trouble = std::to_string(s.unresolved()) + " pixels are not proved";
    }
}

void measure_cases(const std::vector<Claim>& claims, const Places& places, const std::filesystem::path& path,
                   std::vector<ClaimResult>& results) {
    const scene::sweep::CaseFile file(path);
    sweep::CaseRequest request{.file = &file, .rows = {}, .metrics = {}};
    for (const std::size_t i : places) request.rows.push_back(row_for(claims[i], file));
    const SettingOf setting(file.rays(0, binary64).front());
    const ClaimColumns columns(those_at(claims, places), request.rows, setting.get());
    request.metrics = columns.metrics();
    for (std::size_t k = 0; k < places.size(); ++k) {
        const Claim& claim = claims[places[k]];
        if (claim.case_name.empty())
            scene::toml::fail(claim.where, "sweep \"" + claim.sweep +
                                               "\" has cases, not axes; write `case = \"...\"` in claim.given");
        const auto summary = sweep::run_cases_together(request, k, file.matching(claim.case_name, claim.where));
        results[places[k]] = judge(claim, columns.value(claim, summary), &summary);
    }
}

double arithmetic_value(const Claim& claim) {
    const auto rows = arithmetic_rows();
    const auto row = std::ranges::find(rows, claim.row, &ArithmeticRow::name);
    if (row != rows.end()) return row->fraction(format_of(claim).shape, claim.at.front());
    std::vector<std::string> names;
    for (const ArithmeticRow& r : rows) names.emplace_back(r.name);
    scene::toml::fail(claim.where, "unknown row \"" + claim.row + "\"; " + scene::toml::did_you_mean(claim.row, names));
}

double closest_value(const Claim& claim) {
    Claim form = claim;
    form.form = claim.row;
    return find_for(claim, [&] { return differs_with_closest(claim_row(form), claim.at.front()); });
}

void measure_table(const std::vector<Claim>& claims, const Places& places, std::vector<ClaimResult>& results) {
    for (const std::size_t i : places) {
        const Claim& claim = claims[i];
        if (claim.table != "arithmetic" && claim.table != "closest_as_tmax") {
            scene::toml::fail(claim.where,
                              "unknown table \"" + claim.table +
                                  "\"; there are \"arithmetic\" and \"closest_as_tmax\", whose rows are box forms");
        }
        if (claim.metric != "fraction")
            scene::toml::fail(claim.where,
                              "unknown metric \"" + claim.metric + "\"; the only metric of a table is fraction");
        results[i] =
            judge(claim, claim.table == "arithmetic" ? arithmetic_value(claim) : closest_value(claim), nullptr);
    }
}

/// What this machine lacks of what a claim requires; empty: nothing.
std::string missing_for(const Claim& claim) {
    for (const std::string& need : claim.requirements) {
        if (need == "processors-2") {
            if (speed::allowed_processors().size() < 2) return "this program may use only one processor";
            continue;
        }
        const auto isa = need.starts_with("isa-") ? intersect::simd::isa_named(need.substr(4)) : std::nullopt;
        if (!isa)
            scene::toml::fail(claim.where, "unknown requirement \"" + need +
                                               "\"; there are isa-128, isa-256, isa-512 and processors-2");
        const auto there = intersect::simd::available_isas();
        if (std::ranges::find(there, *isa) == there.end()) return "this machine has no " + need;
    }
    return "";
}

void measure_sweep(const std::vector<Claim>& claims, const Places& places, const std::filesystem::path& data_dir,
                   std::vector<ClaimResult>& results) {
    const Claim& first = claims[places.front()];
    const auto path = find_for(first, [&] { return scene::sweep::find_sweep(first.sweep, data_dir); });
    switch (scene::sweep::sweep_kind(path)) {
        case SweepKind::cases: return measure_cases(claims, places, path, results);
        case SweepKind::search:
            scene::toml::fail(first.where, "sweep \"" + first.sweep + "\" is a search; claims are about axes or cases");
        case SweepKind::axes: break;
    }
    const scene::sweep::SweepFile sweep(path, data_dir);
    sweep::SweepRequest request{.sweep = &sweep, .rows = {}, .metrics = {}};
    std::vector<std::size_t> rows;
    bool onsets_wanted = false;
    for (const std::size_t i : places) {
        MapRow row = row_for(claims[i], sweep);
        if (!claims[i].convention) row.judged = sweep.convention;
        rows.push_back(place_in(request.rows, row));
        onsets_wanted |= !claims[i].onset.empty();
    }
    const SettingOf setting(sweep.first_rays());
    const ClaimColumns columns(those_at(claims, places), request.rows, setting.get());
    request.metrics = columns.metrics();
    std::vector<sweep::Onset> onsets;
    if (onsets_wanted) onsets = sweep::find_onsets(request, sweep::run_sweep(request));
    for (std::size_t k = 0; k < places.size(); ++k) {
        const Claim& claim = claims[places[k]];
        if (claim.onset.empty()) {
            if (claim.at.size() != sweep.axes.size()) {
                scene::toml::fail(claim.where, "sweep \"" + claim.sweep + "\" has " +
                                                   std::to_string(sweep.axes.size()) +
                                                   " axes; write as many values in `at`");
            }
            for (std::size_t a = 0; a < claim.at.size(); ++a) {
                const auto [low, high] = std::minmax(sweep.axes[a].from, sweep.axes[a].to);
                if (claim.at[a] < low || claim.at[a] > high)
                    scene::toml::fail(claim.where, "`at` lies outside the axis " + sweep.axes[a].name + " of sweep \"" +
                                                       claim.sweep + "\"; write a value between its ends");
            }
            const auto summary = sweep::run_place(request, rows[k], claim.at);
            results[places[k]] = judge(claim, columns.value(claim, summary), &summary);
            continue;
        }
        const auto found = std::ranges::find_if(onsets, [&](const sweep::Onset& o) {
            return o.row == rows[k] && o.event == claim.onset && o.statistic == claim.statistic &&
                   o.threshold == claim.threshold;
        });
        if (found == onsets.end()) {
            scene::toml::fail(
                claim.where,
                "no onset of \"" + claim.onset + "\" by \"" + claim.statistic +
                    "\" at that threshold; events are lost_bits (p50, p99, max; 1, 4, 8, p/2, p), false_hit, "
                    "false_miss, not_a_number and, of marches, max_dist, max_steps, stagnated (count; 1)");
        }
        results[places[k]] = judge(claim, found->found ? found->first_bad : missing, nullptr);
        if (!found->found) results[places[k]].trouble = "it does not happen within the sweep";
    }
}

}  // namespace

MapRow claim_row(const Claim& claim) {
    std::vector<std::string> names;
    for (const intersect::table::Intersector& i : intersect::table::intersectors()) {
        names.emplace_back(i.info->name);
        if (i.info->name != claim.form) continue;
        const Format format = format_of(claim);
        if (!i.exists_in(format))
            scene::toml::fail(claim.where,
                              claim.form + " does not exist in " + claim.format + "; it exists in f32 only");
        return {&i, format, claim.convention};
    }
    scene::toml::fail(claim.where,
                      "unknown form \"" + claim.form + "\"; " + scene::toml::did_you_mean(claim.form, names));
}

std::vector<ClaimResult> measure_claims(const std::vector<Claim>& claims, const std::filesystem::path& data_dir,
                                        const std::function<void()>& done) {
    std::vector<ClaimResult> results(claims.size());
    enum class Kind { scene, sweep, render, table, timing };
    // Apart from the others those that need the tape of every ray: it costs more than all the rest of a map.
    std::map<std::tuple<Kind, std::string, bool>, Places> subjects;
    for (std::size_t i = 0; i < claims.size(); ++i) {
        results[i].trouble = missing_for(claims[i]);
        if (!results[i].trouble.empty()) {
            results[i].state = ClaimResult::State::skipped;
            continue;
        }
        const Claim& c = claims[i];
        const Kind kind = c.timing            ? Kind::timing
                          : !c.scene.empty()  ? Kind::scene
                          : !c.sweep.empty()  ? Kind::sweep
                          : !c.render.empty() ? Kind::render
                                              : Kind::table;
        subjects[{kind, c.subject(), asks_for_attribution(c)}].push_back(i);
    }
    for (const auto& [subject, places] : subjects) {
        const Kind kind = std::get<Kind>(subject);
        if (kind == Kind::scene) measure_scene(claims, places, data_dir, results);
        else if (kind == Kind::sweep) measure_sweep(claims, places, data_dir, results);
        else if (kind == Kind::render) measure_render(claims, places, data_dir, results);
        else if (kind == Kind::table) measure_table(claims, places, results);
        else
            for (const std::size_t i : places) results[i] = judge(claims[i], timed_ratio(claims[i], done), nullptr);
        done();
    }
    return results;
}

}  // namespace lostbits::measure::claim
