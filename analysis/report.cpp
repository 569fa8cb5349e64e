#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <set>

#include "analysis/report/report_sections.hpp"
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

using report::PlannedChoice;
using report::PlannedMap;
using report::PlannedSweep;

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

std::vector<std::string> list_ids(const std::filesystem::path& folder) {
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

    auto names = list_ids(data / "scenes");
    const auto sweeps = list_ids(data / "sweeps");
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
        throw InputError("no scene or sweep \"" + name + "\" in " + data.string() + "; " +
                         text::did_you_mean(name, names) + " (a path to a .toml file works too)");
    }
}

Subjects select_subjects(const ReportOptions& options, const scene::check::ReportFile& defaults,
                         const std::filesystem::path& data) {
    Subjects subjects;
    for (const auto& name : options.subjects) add_subject(subjects, name, data);
    if (options.all) {
        for (const auto& path : scene::file::list_scene_files(data)) subjects.scenes.push_back({path});
        for (const auto& id : list_ids(data / "sweeps")) subjects.sweeps.push_back(data / "sweeps" / (id + ".toml"));
    } else if (options.subjects.empty()) {
        for (const auto& name : defaults.scenes) subjects.scenes.push_back(scene::file::find_scene(name, data));
        for (const auto& name : defaults.sweeps) subjects.sweeps.push_back(scene::sweep::find_sweep(name, data));
    }
    return subjects;
}

std::vector<Claim> read_all_claims(const std::filesystem::path& data) {
    std::vector<Claim> claims;
    for (const auto& path : scene::check::list_claim_files((data / "claims").string())) {
        for (Claim& claim : scene::check::read_claims(path)) {
            if (claim.profile == Claim::Profile::results) claims.push_back(std::move(claim));
        }
    }
    return claims;
}

bool is_about_scene(const Claim& claim, const std::string& id) {
    return claim.subject_if<SceneSubject>() && claim.subject_name() == id;
}
bool is_about_sweep(const Claim& claim, const std::string& id) {
    return claim.subject_if<SweepSubject>() && std::filesystem::path(claim.subject_name()).stem() == id;
}

bool has_tested_form(const std::vector<TestedForm>& tested_forms, const Claim& claim) {
    const auto row = measure::check::tested_form_of(claim);
    return std::ranges::any_of(tested_forms, [&row](const TestedForm& tested_form) {
        return tested_form.form == row.form && tested_form.format == row.format;
    });
}

/// Returns the selected forms and, if `includes_claims`, those of the claims about the subject. External forms come
/// first, then the others in the order of the catalogue.
std::vector<TestedForm> tested_forms_for(const std::string& subject, std::vector<TestedForm> tested_forms,
                                         const std::vector<Claim>& claims, bool includes_claims) {
    for (const Claim& claim : claims) {
        if (!includes_claims || !(is_about_scene(claim, subject) || is_about_sweep(claim, subject))) continue;
        if (!has_tested_form(tested_forms, claim))
            tested_forms.push_back(
                {measure::check::tested_form_of(claim).form, measure::check::tested_form_of(claim).format});
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

struct PlannedReport {
    measure::metric::MetricSet metric_set;  ///< owns the metrics of the maps, so it must outlive them
    std::vector<PlannedMap> maps;
    std::vector<PlannedSweep> sweeps;
    std::vector<PlannedChoice> choices;
    std::vector<report::PlannedMend> mends;
    std::vector<scene::file::Scene> offsets;
    std::vector<report::PlannedStudy> studies;
    std::vector<Claim> claims;
    std::uint64_t units = 0;
};

/// True if the page shows a claim. With --claims, these are the claims that it names. Without it they are all claims
/// or, if subjects are named, the claims about a subject and a form that the page shows.
bool is_chosen(const Claim& claim, const ReportOptions& options, const PlannedReport& planned) {
    if (!options.claims.empty()) return selection::matches_any(options.claims, claim.id);
    if (options.subjects.empty()) return true;
    return std::ranges::any_of(planned.maps,
                               [&](const PlannedMap& m) {
                                   return is_about_scene(claim, m.scene.id) && has_tested_form(m.tested_forms, claim);
                               }) ||
           std::ranges::any_of(planned.sweeps, [&](const PlannedSweep& s) {
               return is_about_sweep(claim, s.path.stem()) && has_tested_form(s.tested_forms, claim);
           });
}

/// The tested forms to time: the forms of -i in f32 and f64.
std::vector<TestedForm> select_timeable_forms(const ReportOptions& options) {
    return selection::pair_forms_with_formats(selection::select_forms(form_patterns_of(options)),
                                              selection::select_formats({"f32", "f64"}));
}

/// Throws InputError if a pattern of --claims names no claim.
void require_known_claims(const std::vector<std::string>& patterns, const std::vector<Claim>& claims) {
    for (const std::string& glob : patterns) {
        if (std::ranges::none_of(claims,
                                 [&glob](const Claim& claim) { return selection::matches_any({glob}, claim.id); }))
            throw InputError(
                "--claims " + glob +
                ": no claim of the profile `results` has this id; `lostbits list claims` lists all claims");
    }
}

/// The forms, formats and claims of a report, from which each of its subjects takes those that fit.
struct ReportForms {
    const ReportOptions& options;
    std::vector<Format> formats;
    std::vector<TestedForm> selected_forms;
    const std::vector<Claim>& claims;

    /// The forms for a subject of this name, see `forms_for_subject`, with those of the claims about it.
    [[nodiscard]] std::vector<TestedForm> select_for(const std::string& subject,
                                                     const selection::ShapePredicate& can_test) const {
        return forms_for_subject(options, tested_forms_for(subject, selected_forms, claims, options.forms.empty()),
                                 formats, subject, can_test);
    }
};

/// The metrics of the map of a scene, made for these forms.
std::vector<const Metric*> select_map_metrics(const scene::file::Scene& scene,
                                              const std::vector<TestedForm>& tested_forms,
                                              const std::vector<const Metric*>& extra_metrics,
                                              measure::metric::MetricSet& metric_set) {
    std::vector<const Metric*> metrics = extra_metrics;
    for (const char* metric : {"lost_bits", "ulp_error", "condition", "inherent_bits", "excess_bits"})
        metrics.push_back(measure::metric::find_metric(metric));
    if (scene.pixel_count() <= small_map_rays) metrics.push_back(measure::metric::find_metric("culprit"));
    auto form_metrics = metric_set.adapt_to_forms(selection::with_default_metrics(metrics, tested_forms),
                                                  measure::evaluate::forms_of(tested_forms),
                                                  [&scene] { return measure::attribution::OwnedSetting(scene); });
    // Leaves out `residual` by default: its layer of floats would be the largest part of most pages.
    std::erase_if(form_metrics, [&](const Metric* m) {
        return m->name == "residual" && std::ranges::find(extra_metrics, m) == extra_metrics.end();
    });
    return form_metrics;
}

/// Plans a map of each variant of the scene that some form can test.
void plan_maps(PlannedReport& planned, const scene::file::SceneName& name, const ReportForms& forms,
               const std::vector<const Metric*>& extra_metrics, const std::filesystem::path& data) {
    const ReportOptions& options = forms.options;
    scene::file::LoadOptions load_options{.variant = name.variant, .stop = options.stop};
    if (!options.size.empty()) load_options.size = selection::parse_size(options.size);
    for (scene::file::Scene& scene : scene::file::load_scene(name.path, load_options)) {
        auto handling_forms = forms.select_for(scene.id, [&scene](Shapes shapes) { return scene.accepts(shapes); });
        if (handling_forms.empty()) continue;
        auto metrics = select_map_metrics(scene, handling_forms, extra_metrics, planned.metric_set);
        planned.units += scene.pixel_count() * handling_forms.size();

        // The names of the scene in later commands and in claims.
        std::string scene_arguments = selection::scene_arguments(scene, data);
        std::string name_in_claims = selection::scene_name_in_claims(scene, data);
        if (!options.size.empty()) scene_arguments += fmt::format(" --size {}x{}", scene.width, scene.height);
        planned.maps.push_back({std::move(scene), std::move(handling_forms), std::move(metrics), options.size.empty(),
                                std::move(scene_arguments), std::move(name_in_claims)});
    }
}

/// Plans a sweep along axes or a file of cases that some form can test.
void plan_sweep(PlannedReport& planned, const std::filesystem::path& path, const std::filesystem::path& data,
                const ReportForms& forms) {
    const auto kind = scene::sweep::read_sweep_kind(path);
    // These kinds have no plots, only numbers, and take long.
    using enum scene::sweep::SweepKind;
    if (kind == search || kind == edge_search || kind == every_float) return;

    const std::string id = path.stem().string();
    std::vector<TestedForm> handling_forms;
    if (kind == scene::sweep::SweepKind::cases)
        handling_forms =
            forms.select_for(id, [file = scene::sweep::CaseFile(path)](Shapes shapes) { return file.accepts(shapes); });
    else
        handling_forms = forms.select_for(id, [sweep = scene::sweep::SweepFile(path, data, {}, forms.options.stop)](
                                                  Shapes shapes) { return sweep.accepts(shapes); });
    if (!handling_forms.empty()) planned.sweeps.push_back({path, data, handling_forms, forms.options.seeds});
}

/// Plans the sections that options ask for: choices, repairs, offsets and studies. Repairs and offsets have defaults
/// where no subject is named.
void plan_requested_sections(PlannedReport& planned, const ReportOptions& options,
                             const scene::check::ReportFile& defaults, const std::filesystem::path& data) {
    for (const std::string& text : options.choices) {
        auto timed = select_timeable_forms(options);
        planned.choices.push_back(
            report::parse_choice(text, options.size, {timed, form_patterns_of(options), true}, data, options.stop));
    }
    for (const std::string& text : options.mends.empty() && options.subjects.empty() ? defaults.mends : options.mends)
        planned.mends.push_back(report::parse_mend(text, options.size, data, options.stop));
    planned.offsets = report::load_offset_scenes(
        options.offsets.empty() && options.subjects.empty() ? defaults.offsets : options.offsets, options.size, data,
        options.stop);
    for (const std::string& text : options.studies)
        planned.studies.push_back(report::parse_study(text, options.size, data, options.stop));
}

/// Throws NothingSelected for a report without maps and sweeps, and InputError for a scene that is given twice.
void require_valid_subjects(const PlannedReport& planned) {
    if (planned.maps.empty() && planned.sweeps.empty())
        throw NothingSelected(
            "report: no selected form handles any of the selected scenes and sweeps; leave out -i, or name forms for "
            "their shapes");
    std::set<std::string> ids;
    for (const PlannedMap& map : planned.maps) {
        if (!ids.insert(map.scene.id).second)
            throw InputError(
                fmt::format("scene \"{}\" is given twice, but a page shows it once; leave one out", map.scene.id));
    }
}

PlannedReport plan_report(const ReportOptions& options, const std::filesystem::path& data) {
    const scene::check::ReportFile defaults = scene::check::read_report_file(data / "report.toml");
    const Subjects subjects = select_subjects(options, defaults, data);
    const auto claims = options.no_claims ? std::vector<Claim>{} : read_all_claims(data);
    require_known_claims(options.claims, claims);
    const auto formats = selection::select_formats(options.formats.empty() ? defaults.formats : options.formats);
    const ReportForms forms{
        options, formats,
        selection::pair_forms_with_formats(
            selection::select_forms(selection::form_patterns(options.forms, defaults.forms)), formats),
        claims};

    PlannedReport planned;
    const std::vector<const Metric*> extra_metrics = selection::select_metrics(options.metrics, planned.metric_set);
    for (const scene::file::SceneName& name : subjects.scenes) plan_maps(planned, name, forms, extra_metrics, data);
    for (const auto& path : subjects.sweeps) plan_sweep(planned, path, data, forms);
    plan_requested_sections(planned, options, defaults, data);
    for (const Claim& claim : claims) {
        if (is_chosen(claim, options, planned)) planned.claims.push_back(claim);
    }
    require_valid_subjects(planned);
    return planned;
}

/// Prints which forms of -i no map and no sweep of the report shows.
void note_forms_not_shown(const PlannedReport& planned, const ReportOptions& options, bool quiet) {
    std::vector<TestedForm> shown_rows;
    for (const PlannedMap& map : planned.maps)
        shown_rows.insert(shown_rows.end(), map.tested_forms.begin(), map.tested_forms.end());
    for (const PlannedSweep& sweep : planned.sweeps)
        shown_rows.insert(shown_rows.end(), sweep.tested_forms.begin(), sweep.tested_forms.end());
    selection::note_unmeasured(options.forms, shown_rows, quiet);
}

// Units of progress: a sweep counts as a map of 100 x 100 pixels with ten rows, and all claims together as ten sweeps.
constexpr std::uint64_t sweep_units = 100'000, claims_units = 1'000'000;

/// Measures the maps, sweeps and claims. Returns the number of rays of the maps without a proved truth.
std::uint64_t measure_subjects(output::report::Report& report, PlannedReport& planned, const ReportOptions& options,
                               const std::filesystem::path& data, const std::function<void(std::uint64_t)>& advance) {
    std::uint64_t unresolved = 0;
    for (PlannedMap& map : planned.maps) {
        report.maps.push_back(measure_map_section(map, planned.metric_set, advance, options.stop));
        unresolved += map.unresolved;
    }
    for (const PlannedSweep& sweep : planned.sweeps) {
        report.sweeps.push_back(measure_sweep_section(sweep, options.stop));
        advance(sweep_units);
    }
    const study::StudiesByName studies;
    if (!planned.claims.empty())
        report.results = measure::check::measure_claims(
            planned.claims,
            {.data_dir = data, .stop = options.stop, .further_draw_count = options.seeds, .studies = &studies});
    return unresolved;
}

/// Measures speed and accuracy of the forms of -i, shape by shape.
void measure_trades(output::report::Report& report, const ReportOptions& options) {
    for (const ShapeRow& primitive : shape_rows) {
        const Shape shape = primitive.shape;
        const auto rows = selection::filter_tested_forms(select_timeable_forms(options),
                                                         [shape](Shapes forms) { return forms == shape; });
        if (!rows.empty()) report.trades.push_back(report::measure_trade_section(shape, rows, options.stop));
    }
}

/// Measures the sections that options ask for.
void measure_requested_sections(output::report::Report& report, const PlannedReport& planned,
                                const ReportOptions& options) {
    for (const report::PlannedStudy& planned_study : planned.studies)
        report.studies.push_back(measure_study_section(planned_study, options.forms, options.formats, options.stop));
    for (const scene::file::Scene& scene : planned.offsets) {
        if (auto section = study::measure_offset_section(scene, options.stop))
            report.offsets.push_back(std::move(*section));
    }
    if (options.trade || !planned.choices.empty()) report.processor = measure::trade::read_processor_name();
    for (const PlannedChoice& choice : planned.choices)
        report.choices.push_back(measure_choice_section(choice, options.stop));
    for (const report::PlannedMend& mend : planned.mends)
        report.mends.push_back(measure_mend_section(mend, options.stop));
    if (options.trade) measure_trades(report, options);
}

ExitStatus run(const ReportOptions& options, const CommonOptions& common) {
    require_folder(options.out);
    const auto data = selection::data_folder(common.data);
    PlannedReport planned = plan_report(options, data);
    note_forms_not_shown(planned, options, common.quiet);

    const selection::ThreadLimit limit(common.threads);
    const auto folder = lock_folder(options.out, common, common.typed_command.all_subjects(), {.is_shared = true});
    output::file::AtomicFile file(std::filesystem::path(options.out) / "index.html");
    output::file::Progress progress(
        planned.units + sweep_units * planned.sweeps.size() + (planned.claims.empty() ? 0 : claims_units), "report",
        common.progress, common.quiet);
    output::report::Report report{.command = common.typed_command.text() + " -o out",
                                  .maps = {},
                                  .sweeps = {},
                                  .trades = {},
                                  .claims = planned.claims,
                                  .results = {}};
    report.program = "lostbits " LOSTBITS_VERSION;
    const std::uint64_t unresolved = measure_subjects(report, planned, options, data, advance_callback(progress));
    measure_requested_sections(report, planned, options);
    progress.finish();

    file.write(output::report::page(report));
    file.commit();
    complete_folder(folder);
    if (!common.quiet) fmt::print("{}\n", file.path().string());
    if (const ExitStatus exit_code = report_unproved(unresolved); exit_code != ExitStatus::done) return exit_code;
    const bool all_agree = std::ranges::all_of(report.results, [](const ClaimResult& result) {
        return result.state == ClaimResult::State::agrees || result.state == ClaimResult::State::skipped;
    });
    return all_agree ? ExitStatus::done : ExitStatus::answer_is_no;
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
    command.add_list("--metric", options->metrics, "Metrics in addition to the default ones, by name or glob");
    command.add("--size", options->size, "Picture size, WxH in pixels (default: each scene's)");
    command.add_list("--claims", options->claims, "Claims, by id or glob (default: all, or those about the SUBJECTs)");

    // Sections of the page.
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
