// Sweeps, explained rays, studies, speed, choices and repaired forms.
#include <cmath>

#include "analysis/library/handles.hpp"
#include "analysis/selection/scenes.hpp"
#include "analysis/study/measurements.hpp"
#include "analysis/study/studies.hpp"
#include "measure/attribution/culprits.hpp"
#include "measure/choice/candidates.hpp"
#include "measure/repair/repair.hpp"
#include "measure/sweep/sweep.hpp"
#include "output/attribution/explain_text.hpp"
#include "output/choice/choice_files.hpp"
#include "output/repair/repair_files.hpp"
#include "output/speed/trade_files.hpp"
#include "output/sweep/sweep_files.hpp"
#include "scene/rays/composed_forms.hpp"
#include "scene/sweep/case_file.hpp"
#include "scene/sweep/sweep_file.hpp"

namespace lostbits::analysis::library {

using measure::evaluate::TestedForm;

namespace {

std::unique_ptr<lostbits_result> sweep_of(const std::filesystem::path& path, const std::string& data, Selection& chosen,
                                          CallRun& running) {
    if (scene::sweep::sweep_kind(path) != scene::sweep::SweepKind::axes)
        throw InputError(path.string() +
                         ": is not a sweep along axes: it has cases, a search or every float of a range; `lostbits "
                         "sweep` measures those");
    const scene::sweep::SweepFile sweep(path, data, {}, running.stop());
    chosen.keep_rows_for("sweep " + sweep.id, [&sweep](Shapes forms) { return sweep.meets(forms); });
    std::vector<const measure::metric::Metric*> metrics = chosen.extra_metrics;
    for (const char* name : {"inherent_bits", "excess_bits"}) metrics.push_back(measure::metric::find_metric(name));
    auto request = study::sweep_of(sweep, chosen.rows, std::move(metrics), chosen.metric_set, running.stop());
    output::sweep::SweepFiles::require_own_columns(request);
    request.progress = running.advance_callback(measure::sweep::sweep_units(request));
    const auto found = measure::sweep::measure_sweep(request);
    auto result = std::make_unique<lostbits_result>();
    result->add_table("samples", output::sweep::sample_table(request),
                      output::sweep::sample_rows(request, found.steps));
    if (sweep.axes.size() == 1) result->add_table("onsets", output::sweep::onset_table(request), found.onsets);
    return result;
}

/// The only chosen row. Throws InputError, which begins with `context`, if there are several, or if the operations of
/// its form are not known.
const TestedForm& only_row(const Selection& chosen, const std::string& context) {
    if (chosen.rows.size() != 1)
        throw InputError(context + ", and " + std::to_string(chosen.rows.size()) +
                         " pairs of form and format are chosen; name one form and one format");
    const TestedForm& form_row = chosen.rows.front();
    if (!form_row.form->is_template())
        throw InputError("form " + std::string(form_row.form->info->name) +
                         ": its operations are not known; give them with lostbits_form_write");
    return form_row;
}

std::unique_ptr<lostbits_result> explanation_of(const scene::file::Scene& scene, int x, int y, Selection& chosen) {
    chosen.keep_rows_for("scene " + scene.id, [&](Shapes forms) { return scene.meets(forms); });
    const TestedForm& form_row = only_row(chosen, "explain looks at one ray in one form and format");
    const auto* const generator = scene::rays::generator_of(*form_row.form);
    const scene::file::Scene generated = generator ? with_rays(scene, *generator) : scene;
    const measure::answer::OneRay ray(generated, x, y);
    const auto found = measure::attribution::explain(*form_row.form, form_row.format, ray, {},
                                                     measure::attribution::ScenePixel{&generated, x, y});
    const auto march = output::attribution::end_of_march(*form_row.form, form_row.format, ray);
    auto result = std::make_unique<lostbits_result>();
    result->texts = {output::attribution::explain_text(found, false, march),
                     output::attribution::explain_json(found, march)};
    return result;
}

/// Measures a study of a scene; the result has its summary.
template <class Adapter>
std::unique_ptr<lostbits_result> study_of(const scene::file::Scene& scene, const std::vector<std::string>& options,
                                          const lostbits_choice* choice, CallRun& running) {
    lostbits_choice given = choice ? *choice : lostbits_choice{};
    const std::vector<std::string> default_forms = Adapter::usual_forms();
    std::vector<const char*> forms(default_forms.size());
    std::ranges::transform(default_forms, forms.begin(), &std::string::c_str);
    if (given.forms.count == 0 && given.own_count == 0) given.forms = {forms.data(), forms.size()};
    if (given.formats.count == 0) given.formats = {&study::usual_format, 1};
    Selection chosen(&given);
    std::erase_if(chosen.rows, [](const TestedForm& form_row) { return !Adapter::can_measure(*form_row.form); });
    selection::refuse_generators(chosen.rows, Adapter::name);
    selection::refuse_generated_rays({scene}, Adapter::name);
    Adapter::require(scene);
    chosen.keep_rows_for("scene " + scene.id,
                         [&scene](Shapes shapes) { return selection::are_primitives(shapes) && scene.meets(shapes); });
    auto study =
        Adapter::make_study(scene, chosen.rows, study::study_values(Adapter::options(), options), running.stop());
    study.progress = running.advance_callback(scene.pixels() * study.rows.size());
    const auto summaries = measure::study::run_study(study);
    auto result = std::make_unique<lostbits_result>();
    result->add_table("summary", Adapter::View::summary_table(), Adapter::View::summary_rows(study, summaries));
    return result;
}

std::unique_ptr<lostbits_result> trade_of(const scene::file::Scene* scene, const std::string& shape, bool quick,
                                          Selection& chosen, CallRun& running) {
    auto request = study::trade_of(scene, shape, {chosen.rows, chosen.forms, true});
    if (quick) request.plan = study::quick_plan();
    request.limit.stop = request.plan.stop = running.stop();
    request.plan.progress = running.advance_callback(measure::speed::trade_units(request));
    const auto found = measure::speed::run_trade(request);
    auto result = std::make_unique<lostbits_result>();
    result->add_table("trade", output::speed::time_table(), output::speed::time_rows(request, found));
    result->add_table("pareto", output::speed::pareto_table(), output::speed::pareto_rows(request, found));
    result->texts.push_back(output::speed::trade_text(request, found));
    return result;
}

measure::choice::Requirement requirement_of(const lostbits_requirement& requirement, const char* default_at) {
    if (!(requirement.bits >= 0 && requirement.bits <= 53)) throw InputError("bits must be from 0 to 53");
    if (!(requirement.wrong >= 0 && requirement.wrong <= 1))
        throw InputError("wrong is a share of the rays and must be from 0 to 1");
    if (std::isnan(requirement.tolerance))
        throw InputError("tolerance is not a number; give a length, or a number below 0 for any");
    measure::choice::Requirement result{
        .bits = requirement.bits,
        .wrong = requirement.wrong,
        .quantile = measure::choice::quantile_named(requirement.at ? requirement.at : default_at)};
    if (requirement.tolerance >= 0) result.tolerance = requirement.tolerance;
    return result;
}

/// Fills the result. Returns true if any form meets the requirement.
bool mend_into(lostbits_result& result, const scene::file::Scene& scene,
               const measure::choice::Requirement& requirement, bool two_words, Selection& chosen, CallRun& running) {
    if (requirement.has_tolerance()) throw InputError("mend repairs a form to keep bits of t; give no tolerance");
    chosen.keep_rows_for("scene " + scene.id, [&](Shapes forms) { return scene.meets(forms); });
    if (scene.is_placed())
        throw InputError("the primitives of scene " + scene.id +
                         " are placed by matrices; only the command `lostbits mend` takes those");
    const TestedForm& form_row = only_row(chosen, "mend repairs one form in one format");
    if (selection::is_emulated(form_row.format)) throw InputError("mend works in f32 and f64 only; name one of them");
    selection::refuse_generators({form_row.form}, "mend");
    selection::refuse_generated_rays({scene}, "mend");
    measure::repair::RepairRequest request{
        .scene = &scene, .row = form_row, .requirement = requirement, .two_words = two_words};
    request.limit.stop = running.stop();
    request.progress = running.advance_callback(0);
    const auto repair = measure::repair::repair_form(request);
    const output::repair::RepairSummary found = output::repair::summarize_repair(request, repair);
    result.add_table("mend", output::repair::form_table(), output::repair::form_rows(found));
    result.add_table("minimal", output::repair::minimal_table(), output::repair::minimal_rows(found));
    result.add_table("probes", output::repair::probe_table(), output::repair::probe_rows(found));
    result.texts.push_back(output::repair::repair_text(found));
    const bool is_better = output::repair::best_proposal(output::repair::list_proposals(found), found) != nullptr;
    if (is_better) result.texts.push_back(output::repair::emitted_file_text(found, "mended.hpp", "lostbits_mend"));
    return repair.set || is_better;
}

/// Fills the result. Returns true if any form meets the requirement.
bool choose_into(lostbits_result& result, const scene::file::Scene& scene,
                 const measure::choice::Requirement& requirement, Selection& chosen, CallRun& running) {
    measure::choice::ChoiceRequest request;
    request.requirement = requirement;
    request.limit.stop = request.plan.stop = running.stop();
    request.scene = &scene;
    request.rows = selection::timed_on(scene.id, {chosen.rows, chosen.forms, true},
                                       [&scene](Shapes forms) { return scene.meets(forms); });
    std::erase_if(request.rows, [](const TestedForm& form_row) { return selection::is_emulated(form_row.format); });
    if (request.rows.empty())
        throw InputError(
            "choose compares f32 and f64 only: the time of an emulated format says nothing; name one of them");
    request.progress = running.advance_callback(scene.pixels() * request.rows.size());
    measure::choice::TimedRays timed_rays;
    const auto candidates = measure_candidates(request, timed_rays);
    const auto found = output::choice::choose_among(request, candidates, timed_rays);
    result.add_table("choose", output::choice::candidate_table(), output::choice::candidate_rows(found));
    result.add_table("room", output::choice::margin_table(), found.margins);
    result.texts.push_back(output::choice::choice_text(found));
    return found.cheapest_index.has_value();
}

/// The arguments of a call with a requirement.
struct RequirementArguments {
    const lostbits_scene* scene;
    const lostbits_requirement* requirement;
    const lostbits_choice* choice;
    const lostbits_run* run;
};
/// Calls `find`, which fills a new result and returns true if the answer is yes. `default_at` is the requirement's `at`
/// if none is given.
template <class Find>
Exit answer_to(const RequirementArguments& arguments, const char* default_at, lostbits_result** result,
               const Find& find) {
    require(arguments.scene, "scene");
    require(arguments.requirement, "requirement");
    require(result, "result");
    Selection chosen(arguments.choice);
    CallRun running(arguments.run);
    auto found = std::make_unique<lostbits_result>();
    const bool meets =
        find(*found, arguments.scene->scene, requirement_of(*arguments.requirement, default_at), chosen, running);
    return hand_over(std::move(found), result, meets ? Exit::done : Exit::answer_is_no);
}

}  // namespace
}  // namespace lostbits::analysis::library

using namespace lostbits;
using namespace lostbits::analysis;
using namespace lostbits::analysis::library;

extern "C" {

int lostbits_sweep(const char* sweep, int is_text, const char* data, const lostbits_choice* choice,
                   const lostbits_run* run, lostbits_result** result, lostbits_error* error) {
    return guarded(error, [&] {
        require(sweep, "sweep");
        require(result, "result");
        Selection chosen(choice);
        CallRun running(run);
        const std::string folder = selection::data_folder(data ? data : "").string();
        if (is_text == 0)
            return hand_over(sweep_of(scene::sweep::find_sweep(sweep, folder), folder, chosen, running), result);
        const TextFile file(sweep);
        return hand_over(file.with_places([&] { return sweep_of(file.path(), folder, chosen, running); }), result);
    });
}

int lostbits_explain(const lostbits_scene* scene, int x, int y, const lostbits_choice* choice, lostbits_result** result,
                     lostbits_error* error) {
    return guarded(error, [&] {
        require(scene, "scene");
        require(result, "result");
        Selection chosen(choice);
        return hand_over(explanation_of(scene->scene, x, y, chosen), result);
    });
}

int lostbits_study(const char* study, const lostbits_scene* scene, const lostbits_words* options,
                   const lostbits_choice* choice, const lostbits_run* run, lostbits_result** result,
                   lostbits_error* error) {
    return guarded(error, [&] {
        require(study, "study");
        require(scene, "scene");
        require(result, "result");
        const auto option_texts = options ? texts_of(*options, "options") : std::vector<std::string>{};
        CallRun running(run);
        auto found = study::with_study(study, [&](auto adapter) {
            return study_of<decltype(adapter)>(scene->scene, option_texts, choice, running);
        });
        return hand_over(std::move(found), result);
    });
}

int lostbits_trade(const lostbits_scene* scene, const char* shape, int quick, const lostbits_choice* choice,
                   const lostbits_run* run, lostbits_result** result, lostbits_error* error) {
    return guarded(error, [&] {
        require(result, "result");
        if (scene != nullptr && shape != nullptr)
            throw InputError("shape: a scene is given, which has its own shapes; pass NULL for one of the two");
        if (shape != nullptr && *shape == '\0') throw InputError("shape is empty; name one, or pass NULL for a sphere");
        Selection chosen(choice);
        CallRun running(run);
        return hand_over(trade_of(scene ? &scene->scene : nullptr, shape ? shape : "", quick != 0, chosen, running),
                         result);
    });
}

int lostbits_choose(const lostbits_scene* scene, const lostbits_requirement* requirement, const lostbits_choice* choice,
                    const lostbits_run* run, lostbits_result** result, lostbits_error* error) {
    return guarded(error, [&] { return answer_to({scene, requirement, choice, run}, "p99", result, choose_into); });
}

int lostbits_mend(const lostbits_scene* scene, const lostbits_requirement* requirement, int two_words,
                  const lostbits_choice* choice, const lostbits_run* run, lostbits_result** result,
                  lostbits_error* error) {
    return guarded(error, [&] {
        return answer_to({scene, requirement, choice, run}, "max", result,
                         [&](auto& found, const auto& target_scene, const auto& asked_requirement, Selection& chosen,
                             CallRun& running) {
                             return mend_into(found, target_scene, asked_requirement, two_words != 0, chosen, running);
                         });
    });
}
}
