#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <set>

#include "analysis/report/report_parts.hpp"
#include "analysis/selection/external.hpp"
#include "analysis/selection/options.hpp"
#include "analysis/selection/ray_numbers.hpp"
#include "analysis/selection/scenes.hpp"
#include "analysis/selection/select.hpp"
#include "analysis/study/studies_by_name.hpp"
#include "commands.hpp"
#include "measure/attribution/culprits.hpp"
#include "measure/trade/timing.hpp"
#include "number/error.hpp"
#include "output/file/atomic_file.hpp"
#include "scene/check/claims_file.hpp"
#include "scene/check/report_file.hpp"
#include "scene/sweep/case_file.hpp"
#include "scene/sweep/sweep_file.hpp"
#include "text/did_you_mean.hpp"

namespace lostbits::analysis {

using report::ChoiceWork;
using report::MapWork;
using report::SweepWork;

using measure::check::ClaimResult;
using measure::evaluate::TestedForm;
using measure::metric::Metric;

namespace {

using scene::check::Claim;
using scene::check::SceneSubject;
using scene::check::SweepSubject;

struct ReportOptions {
    std::vector<std::string> subjects, forms, formats, metrics, claims, choices, mends, offsets, studies;
    std::string size, out;
    bool all = false, no_claims = false, trade = false;
    int seeds = 2;
    intersect::process::StopToken stop = {};
    bool quiet = false;
};

/// The subjects of a report: files of scenes (some with one variant) and of sweeps.
struct Subjects {
    std::vector<scene::file::SceneName> scenes;
    std::vector<std::filesystem::path> sweeps;
};

std::vector<std::string> ids_in(const std::filesystem::path& folder) {
    std::vector<std::string> ids;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        if (entry.path().extension() == ".toml") ids.push_back(entry.path().stem().string());
    }
    std::ranges::sort(ids);
    return ids;
}

/// Adds the subject that `name` names: a path, or the name of a scene (with an optional variant) or of a sweep. If a
/// scene and a sweep have the same name, adds the scene.
void add_subject(Subjects& subjects, const std::string& name, const std::filesystem::path& data) {
    if (std::filesystem::is_regular_file(name)) {
        if (scene::sweep::is_sweep_file(name)) subjects.sweeps.push_back(name);
        else subjects.scenes.push_back({name});
        return;
    }
    auto names = ids_in(data / "scenes");
    const auto sweeps = ids_in(data / "sweeps");
    const auto contains_name = [&name](const std::vector<std::string>& list) {
        return std::ranges::find(list, name) != list.end();
    };
    const bool is_scene =
        std::ranges::any_of(names, [&name](const std::string& n) { return name == n || name.starts_with(n + "."); });
    if (is_scene) subjects.scenes.push_back(scene::file::find_scene(name, data));
    else if (contains_name(sweeps) || name.find('/') != std::string::npos)
        subjects.sweeps.push_back(scene::sweep::find_sweep(name, data));
    else {
        names.insert(names.end(), sweeps.begin(), sweeps.end());
        throw InputError(name + ": is neither a file, nor a scene or sweep in " + data.string() + "; " +
                         text::did_you_mean(name, names));
    }
}

Subjects select_subjects(const ReportOptions& options, const scene::check::ReportFile& defaults,
                         const std::filesystem::path& data) {
    Subjects subjects;
    for (const auto& name : options.subjects) add_subject(subjects, name, data);
    if (options.all) {
        for (const auto& path : scene::file::scene_files(data)) subjects.scenes.push_back({path});
        for (const auto& id : ids_in(data / "sweeps")) subjects.sweeps.push_back(data / "sweeps" / (id + ".toml"));
    } else if (options.subjects.empty()) {
        for (const auto& name : defaults.scenes) subjects.scenes.push_back(scene::file::find_scene(name, data));
        for (const auto& name : defaults.sweeps) subjects.sweeps.push_back(scene::sweep::find_sweep(name, data));
    }
    return subjects;
}

std::vector<Claim> read_all_claims(const std::filesystem::path& data) {
    std::vector<Claim> claims;
    for (const auto& path : scene::check::claim_files((data / "claims").string())) {
        for (Claim& claim : scene::check::read_claims(path)) {
            if (claim.profile == Claim::Profile::results) claims.push_back(std::move(claim));
        }
    }
    return claims;
}

bool is_about_scene(const Claim& c, const std::string& id) {
    return c.subject_if<SceneSubject>() && c.subject_name() == id;
}
bool is_about_sweep(const Claim& c, const std::string& id) {
    return c.subject_if<SweepSubject>() && std::filesystem::path(c.subject_name()).stem() == id;
}

bool has_tested_form(const std::vector<TestedForm>& tested_forms, const Claim& c) {
    const auto row = measure::check::tested_form_of(c);
    return std::ranges::any_of(tested_forms,
                               [&row](const TestedForm& r) { return r.form == row.form && r.format == row.format; });
}

/// Returns the selected forms and, if `with_claims`, those of the claims about the subject. External forms come first,
/// then the others in the order of the catalogue.
std::vector<TestedForm> tested_forms_for(const std::string& subject, std::vector<TestedForm> tested_forms,
                                         const std::vector<Claim>& claims, bool with_claims) {
    for (const Claim& c : claims) {
        if (!with_claims || !(is_about_scene(c, subject) || is_about_sweep(c, subject))) continue;
        if (!has_tested_form(tested_forms, c))
            tested_forms.push_back({measure::check::tested_form_of(c).form, measure::check::tested_form_of(c).format});
    }
    const auto sort_key = [](const TestedForm& tested_form) {
        if (tested_form.form->is_set()) return std::pair{true, PTRDIFF_MAX};
        const auto catalogue_size = static_cast<std::ptrdiff_t>(lostbits::intersect::table::catalogue().size());
        const auto index = tested_form.form - lostbits::intersect::table::intersectors().data();
        return std::pair{index < catalogue_size, index};
    };
    std::ranges::stable_sort(
        tested_forms, [&sort_key](const TestedForm& a, const TestedForm& b) { return sort_key(a) < sort_key(b); });
    return tested_forms;
}

/// The patterns of -i; without -i, all forms.
std::vector<std::string> form_patterns_of(const ReportOptions& options) {
    return options.forms.empty() ? std::vector<std::string>{"*"} : options.forms;
}

/// Returns the selected forms that can test a subject. A subject that the command names, and that none of the default
/// forms can test, gets all forms that can. With -i it gets none, and a message says that it is left out.
std::vector<TestedForm> forms_for_subject(const ReportOptions& options, std::vector<TestedForm> selected_forms,
                                          const std::vector<Format>& formats, const std::string& subject,
                                          const selection::ShapePredicate& can_test) {
    const auto patterns = form_patterns_of(options);
    auto forms = selection::tested_forms_handling({selected_forms, patterns, true}, subject, can_test);
    if (!forms.empty() || options.subjects.empty()) return forms;
    if (options.forms.empty()) {
        auto all_forms = selection::pair_forms_with_formats(selection::select_forms(patterns), formats);
        return selection::tested_forms_handling({all_forms, patterns, true}, subject, can_test);
    }
    if (!options.quiet) selection::note_left_out(selection::unhandled_text(subject, selected_forms, can_test));
    return forms;
}

/// The largest map, in rays, that has the culprit of each ray by default. Larger maps need `--metric culprit`.
constexpr std::size_t small_map_rays = 4096;

struct ReportWork {
    measure::metric::MetricSet metric_set;  ///< owns the metrics of the maps, so it must outlive them
    std::vector<MapWork> maps;
    std::vector<SweepWork> sweeps;
    std::vector<ChoiceWork> choices;
    std::vector<report::MendWork> mends;
    std::vector<scene::file::Scene> offsets;
    std::vector<report::StudyWork> studies;
    std::vector<Claim> claims;
    std::uint64_t units = 0;
};

void plan_sweep(ReportWork& work, const std::filesystem::path& path, const std::filesystem::path& data,
                const std::function<std::vector<TestedForm>(const selection::ShapePredicate&)>& forms_for,
                intersect::process::StopToken stop) {
    std::vector<TestedForm> handling_forms;
    const auto kind = scene::sweep::sweep_kind(path);
    // These kinds have no plots, only numbers, and take long.
    using enum scene::sweep::SweepKind;
    if (kind == search || kind == edge_search || kind == every_float) return;
    if (kind == scene::sweep::SweepKind::cases)
        handling_forms = forms_for([file = scene::sweep::CaseFile(path)](Shapes forms) { return file.accepts(forms); });
    else
        handling_forms = forms_for(
            [sweep = scene::sweep::SweepFile(path, data, {}, stop)](Shapes forms) { return sweep.accepts(forms); });
    if (!handling_forms.empty()) work.sweeps.push_back({path, data, handling_forms});
}

/// True if the page shows a claim. With --claims, these are the claims that it names. Without it they are all claims
/// or, if subjects are named, the claims about a subject and a form that the page shows.
bool is_chosen(const Claim& c, const ReportOptions& options, const ReportWork& work) {
    if (!options.claims.empty()) return selection::matches_any(options.claims, c.id);
    if (options.subjects.empty()) return true;
    return std::ranges::any_of(
               work.maps,
               [&](const MapWork& m) { return is_about_scene(c, m.scene.id) && has_tested_form(m.rows, c); }) ||
           std::ranges::any_of(work.sweeps, [&](const SweepWork& s) {
               return is_about_sweep(c, s.path.stem()) && has_tested_form(s.rows, c);
           });
}

/// The tested forms to time: the forms of -i in f32 and f64.
std::vector<TestedForm> timeable_forms(const ReportOptions& options) {
    return selection::pair_forms_with_formats(selection::select_forms(form_patterns_of(options)),
                                              selection::select_formats({"f32", "f64"}));
}

ReportWork plan_report(const ReportOptions& options, const std::filesystem::path& data) {
    const scene::check::ReportFile defaults = scene::check::read_report_file(data / "report.toml");
    const Subjects subjects = select_subjects(options, defaults, data);
    const auto claims = options.no_claims ? std::vector<Claim>{} : read_all_claims(data);
    for (const std::string& glob : options.claims) {
        if (std::ranges::none_of(claims, [&glob](const Claim& c) { return selection::matches_any({glob}, c.id); }))
            throw InputError(
                "--claims " + glob +
                ": no claim of the profile `results` has this id; `lostbits list claims` lists all claims");
    }
    const auto formats = selection::select_formats(options.formats.empty() ? defaults.formats : options.formats);
    const auto selected_forms = selection::pair_forms_with_formats(
        selection::select_forms(selection::form_patterns_or(options.forms, defaults.forms)), formats);
    ReportWork work;
    const std::vector<const Metric*> extra_metrics = selection::select_metrics(options.metrics, work.metric_set);
    for (const scene::file::SceneName& name : subjects.scenes) {
        scene::file::LoadOptions load_options{.variant = name.variant, .stop = options.stop};
        if (!options.size.empty()) load_options.size = selection::parse_size(options.size);
        for (scene::file::Scene& scene : scene::file::load_scene(name.path, load_options)) {
            auto handling_forms =
                forms_for_subject(options, tested_forms_for(scene.id, selected_forms, claims, options.forms.empty()),
                                  formats, scene.id, [&scene](Shapes forms) { return scene.accepts(forms); });
            if (handling_forms.empty()) continue;
            std::vector<const Metric*> metrics = extra_metrics;
            for (const char* metric : {"lost_bits", "ulp_error", "condition", "inherent_bits", "excess_bits"})
                metrics.push_back(measure::metric::find_metric(metric));
            if (scene.pixels() <= small_map_rays) metrics.push_back(measure::metric::find_metric("culprit"));
            auto form_metrics = work.metric_set.adapt_to_forms(
                selection::with_default_metrics(metrics, handling_forms), measure::evaluate::forms_of(handling_forms),
                [&scene] { return measure::attribution::OwnedSetting(scene); });
            // Leaves out `residual` by default: its layer of floats would be the largest part of most pages.
            std::erase_if(form_metrics, [&](const Metric* m) {
                return m->name == "residual" && std::ranges::find(extra_metrics, m) == extra_metrics.end();
            });
            work.units += scene.pixels() * handling_forms.size();
            std::string scene_arguments = selection::name_of_scene(scene, data),
                        name_in_claims = selection::scene_name_in_claims(scene, data);
            if (!options.size.empty()) scene_arguments += fmt::format(" --size {}x{}", scene.width, scene.height);
            work.maps.push_back({std::move(scene), std::move(handling_forms), std::move(form_metrics),
                                 options.size.empty(), std::move(scene_arguments), std::move(name_in_claims)});
        }
    }
    for (const auto& path : subjects.sweeps) {
        const std::string id = path.stem().string();
        const auto forms_for = [&](const selection::ShapePredicate& can_test) {
            return forms_for_subject(options, tested_forms_for(id, selected_forms, claims, options.forms.empty()),
                                     formats, id, can_test);
        };
        plan_sweep(work, path, data, forms_for, options.stop);
    }
    for (SweepWork& sweep : work.sweeps) sweep.further_draws = options.seeds;
    for (const std::string& text : options.choices) {
        auto timed = timeable_forms(options);
        work.choices.push_back(
            report::parse_choice(text, options.size, {timed, form_patterns_of(options), true}, data, options.stop));
    }
    for (const std::string& text : options.mends.empty() && options.subjects.empty() ? defaults.mends : options.mends)
        work.mends.push_back(report::parse_mend(text, options.size, data, options.stop));
    work.offsets =
        report::offset_scenes(options.offsets.empty() && options.subjects.empty() ? defaults.offsets : options.offsets,
                              options.size, data, options.stop);
    for (const std::string& text : options.studies)
        work.studies.push_back(report::parse_study(text, options.size, data, options.stop));
    for (const Claim& c : claims) {
        if (is_chosen(c, options, work)) work.claims.push_back(c);
    }
    if (work.maps.empty() && work.sweeps.empty())
        throw NothingSelected(
            "report: no selected form handles any of the selected scenes and sweeps; leave out -i, or name forms for "
            "their shapes");
    std::set<std::string> ids;
    for (const MapWork& m : work.maps) {
        if (!ids.insert(m.scene.id).second)
            throw InputError(
                fmt::format("scene \"{}\" is given twice, but a page shows it once; leave one out", m.scene.id));
    }
    return work;
}

Exit run(const ReportOptions& options, const CommonOptions& common) {
    require_folder(options.out);
    const auto data = selection::data_folder(common.data);
    ReportWork work = plan_report(options, data);
    std::vector<TestedForm> shown_rows;
    for (const MapWork& map : work.maps) shown_rows.insert(shown_rows.end(), map.rows.begin(), map.rows.end());
    for (const SweepWork& sweep : work.sweeps)
        shown_rows.insert(shown_rows.end(), sweep.rows.begin(), sweep.rows.end());
    selection::note_unmeasured(options.forms, shown_rows, common.quiet);
    const selection::ThreadLimit limit(common.threads);
    const auto folder = take_folder(options.out, common, common.typed_command.all_subjects(), {.is_shared = true});
    output::file::AtomicFile file(std::filesystem::path(options.out) / "index.html");
    // Units of progress: a sweep counts as a map of 100 x 100 pixels with ten rows, and all claims together as ten
    // sweeps.
    constexpr std::uint64_t sweep_units = 100'000, claims_units = 1'000'000;
    output::file::Progress progress(
        work.units + sweep_units * work.sweeps.size() + (work.claims.empty() ? 0 : claims_units), "report",
        common.progress, common.quiet);
    const auto advance = advance_callback(progress);
    output::report::Report report{.command = common.typed_command.text() + " -o out",
                                  .maps = {},
                                  .sweeps = {},
                                  .trades = {},
                                  .claims = work.claims,
                                  .results = {}};
    report.program = "lostbits " LOSTBITS_VERSION;
    std::uint64_t unresolved = 0;
    for (MapWork& map : work.maps) {
        report.maps.push_back(map_part(map, work.metric_set, advance, common.stop));
        unresolved += map.unresolved;
    }
    for (const SweepWork& sweep : work.sweeps) {
        report.sweeps.push_back(sweep_part(sweep, common.stop));
        advance(sweep_units);
    }
    const study::StudiesByName studies;
    if (!work.claims.empty())
        report.results = measure::check::measure_claims(
            work.claims, {.data_dir = data, .stop = common.stop, .further_draws = options.seeds, .studies = &studies});
    for (const report::StudyWork& study_work : work.studies)
        report.studies.push_back(study_part(study_work, options.forms, options.formats, common.stop));
    for (const scene::file::Scene& scene : work.offsets) {
        if (auto part = report::offset_part(scene, common.stop)) report.offsets.push_back(std::move(*part));
    }
    if (options.trade || !work.choices.empty()) report.processor = measure::trade::processor_name();
    for (const ChoiceWork& choice : work.choices) report.choices.push_back(choice_part(choice, common.stop));
    for (const report::MendWork& mend : work.mends) report.mends.push_back(mend_part(mend, common.stop));
    if (options.trade) {
        for (const ShapeRow& primitive : shape_rows) {
            const Shape shape = primitive.shape;
            const auto rows = selection::filter_tested_forms(timeable_forms(options),
                                                             [shape](Shapes forms) { return forms == shape; });
            if (!rows.empty()) report.trades.push_back(report::trade_part(shape, rows, common.stop));
        }
    }
    progress.finish();
    file.write(output::report::page(report));
    file.commit();
    complete_folder(folder);
    if (!common.quiet) fmt::print("{}\n", file.path().string());
    if (const Exit exit_code = report_unproved(unresolved); exit_code != Exit::done) return exit_code;
    const bool all_agree = std::ranges::all_of(report.results, [](const ClaimResult& r) {
        return r.state == ClaimResult::State::agrees || r.state == ClaimResult::State::skipped;
    });
    return all_agree ? Exit::done : Exit::answer_is_no;
}

}  // namespace

void add_report(const shell::Command& program, const CommonOptions& common) {
    auto command = program.add_command("report",
                                       "Make one HTML page of maps, sweeps and claims that opens from a "
                                       "file");
    const auto options = std::make_shared<ReportOptions>();
    options->stop = common.stop;
    command.add("SUBJECT", options->subjects,
                "Scenes and sweeps, by file or name (default: those of data/report.toml)");
    command.add_list("-i,--form", options->forms,
                     "Forms, by name or glob (default: those of data/report.toml, those that claims name, and those "
                     "of --plugin, --pipe and --shader; for a SUBJECT that none of them can test, all that can)");
    selection::add_formats(command, options->formats, "f32 f64");
    command.add_list("--metric", options->metrics, "Metrics in addition to the default ones; globs");
    command.add("--size", options->size, "Picture size, WxH in pixels (default: each scene's)");
    command.add_list("--claims", options->claims, "Claims by id; globs (default: all, or those about the SUBJECTs)");
    command.add("--seeds", options->seeds,
                "Measure claims and onsets of random rays on this many further draws too (default: 2)",
                shell::whole_number_between(0, 1000));
    command.add("--no-claims", options->no_claims, "Leave claims out");
    command.add("--all", options->all, "Every scene and sweep under data");
    command.add("--trade", options->trade, "Also measure speed, briefly; the page then differs from run to run");
    command.add_list(
        "--choose", options->choices,
        "Also show the cheapest form for a scene and a requirement: SCENE:BITS, or SCENE:BITS:max for bits of every "
        "hit; the page then differs from run to run");
    command.add_list("--mend", options->mends,
                     "Also show what to change in a form so that it keeps BITS bits of every hit of a scene: "
                     "SCENE:FORM:BITS, or SCENE:FORM:BITS:p99 (default: none, or those of data/report.toml where no "
                     "SUBJECT is named)");
    command.add_list("--offsets", options->offsets,
                     "Scenes on which every offset strategy is tried for the next rays (default: none, or those of "
                     "data/report.toml where no SUBJECT is named)");
    command.add_list(
        "--study", options->studies,
        "Also show a study of a scene: STUDY:SCENE, such as consistency:near-benign (with the forms of -i, or the "
        "study's usual ones)");
    selection::add_out(command, options->out, "index.html");
    command.set_action([options, &common] {
        options->quiet = common.quiet;  // known once the command line is read
        return run(*options, common);
    });
}

}  // namespace lostbits::analysis
