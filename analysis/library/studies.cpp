// Sweeps, explained rays, studies, speed, choices and repaired forms.
#include <cmath>

#include "analysis/library/handles.hpp"
#include "analysis/selection/scenes.hpp"
#include "analysis/study/measurements.hpp"
#include "analysis/study/studies.hpp"
#include "measure/attribution/culprits.hpp"
#include "measure/choose/candidates.hpp"
#include "measure/repair/repair.hpp"
#include "measure/sweep/sweep.hpp"
#include "output/attribution/explain_text.hpp"
#include "output/choose/choice_files.hpp"
#include "output/repair/repair_files.hpp"
#include "output/sweep/sweep_files.hpp"
#include "output/trade/trade_files.hpp"
#include "scene/rays/composed_forms.hpp"
#include "scene/sweep/case_file.hpp"
#include "scene/sweep/sweep_file.hpp"

namespace lostbits::analysis::library {

using measure::evaluate::TestedForm;

namespace {

std::unique_ptr<lostbits_result> make_sweep_result(const std::filesystem::path& path, const std::string& data,
                                                   CallSelection& chosen, CallSettings& settings) {
    if (scene::sweep::read_sweep_kind(path) != scene::sweep::SweepKind::axes)
        throw InputError(path.string() +
                         ": is not a sweep along axes: it has cases, a search or every float of a range; `lostbits "
                         "sweep` measures those");
    const scene::sweep::SweepFile sweep(path, data, {}, settings.stop());
    chosen.keep_forms_for("sweep " + sweep.id, [&sweep](Shapes forms) { return sweep.accepts(forms); });
    std::vector<const measure::metric::Metric*> metrics = chosen.extra_metrics;
    for (const char* name : {"inherent_bits", "excess_bits"}) metrics.push_back(measure::metric::find_metric(name));
    auto request =
        study::sweep_request(sweep, chosen.tested_forms, std::move(metrics), chosen.metric_set, settings.stop());
    output::sweep::SweepWriter::require_own_columns(request);
    request.progress = settings.advance_callback(measure::sweep::count_sweep_units(request));
    const auto measured_sweep = measure::sweep::measure_sweep(request);
    auto result = std::make_unique<lostbits_result>();
    result->add_table("samples", output::sweep::sample_table(request),
                      output::sweep::sample_rows(request, measured_sweep.steps));
    if (sweep.axes.size() == 1)
        result->add_table("onsets", output::sweep::make_onset_table(request), measured_sweep.onsets);
    return result;
}

/// The only chosen form in a format. Throws InputError, which begins with `message_prefix`, if there are several, or if
/// the operations of its form are not known.
const TestedForm& only_tested_form(const CallSelection& chosen, const std::string& message_prefix) {
    if (chosen.tested_forms.size() != 1)
        throw InputError(message_prefix + ", and " + std::to_string(chosen.tested_forms.size()) +
                         " pairs of form and format are chosen; name one form and one format");
    const TestedForm& tested_form = chosen.tested_forms.front();
    if (!tested_form.form->is_template())
        throw InputError("form " + std::string(tested_form.form->info->name) +
                         ": its operations are not known; give them with lostbits_form_write");
    return tested_form;
}

std::unique_ptr<lostbits_result> make_explanation_result(const scene::file::Scene& scene, int x, int y,
                                                         CallSelection& chosen) {
    chosen.keep_forms_for("scene " + scene.id, [&](Shapes forms) { return scene.accepts(forms); });
    const TestedForm& tested_form = only_tested_form(chosen, "explain looks at one ray in one form and format");
    const auto* const generator = scene::rays::generator_of(*tested_form.form);
    const scene::file::Scene generated = generator ? with_ray_generator(scene, *generator) : scene;
    const measure::answer::OneRay ray(generated, x, y);
    const auto explanation = measure::attribution::explain(*tested_form.form, tested_form.format, ray, {},
                                                           measure::attribution::ScenePixel{&generated, x, y});
    const auto march = output::attribution::find_march_end(*tested_form.form, tested_form.format, ray);
    auto result = std::make_unique<lostbits_result>();
    result->texts = {output::attribution::explain_text(explanation, false, march),
                     output::attribution::explain_json(explanation, march)};
    return result;
}

/// Measures a study of a scene; the result has its summary.
template <class Adapter>
std::unique_ptr<lostbits_result> make_study_result(const scene::file::Scene& scene,
                                                   const std::vector<std::string>& options,
                                                   const lostbits_choice* choice, CallSettings& settings) {
    // A call that names no forms or formats gets the usual ones of the study.
    lostbits_choice given = choice ? *choice : lostbits_choice{};
    const std::vector<std::string> default_forms = Adapter::usual_forms();
    std::vector<const char*> forms(default_forms.size());
    std::ranges::transform(default_forms, forms.begin(), &std::string::c_str);
    if (given.forms.count == 0 && given.own_count == 0) given.forms = {forms.data(), forms.size()};
    if (given.formats.count == 0) given.formats = {&study::usual_format, 1};

    // Keeps the forms that the study and the scene take.
    CallSelection chosen(&given);
    std::erase_if(chosen.tested_forms,
                  [](const TestedForm& tested_form) { return !Adapter::can_measure(*tested_form.form); });
    selection::require_no_generators(chosen.tested_forms, Adapter::name);
    selection::require_no_generated_rays({scene}, Adapter::name);
    Adapter::require(scene);
    chosen.keep_forms_for("scene " + scene.id, [&scene](Shapes shapes) {
        return selection::are_primitives(shapes) && scene.accepts(shapes);
    });

    auto study = Adapter::make_study(scene, chosen.tested_forms, study::study_values(Adapter::options(), options),
                                     settings.stop());
    study.progress = settings.advance_callback(scene.pixel_count() * study.tested_forms.size());
    const auto summaries = measure::study::run_study(study);
    auto result = std::make_unique<lostbits_result>();
    result->add_table("summary", Adapter::Presentation::make_summary_table(),
                      Adapter::Presentation::make_summary_rows(study, summaries));
    return result;
}

std::unique_ptr<lostbits_result> make_trade_result(const scene::file::Scene* scene, const std::string& shape,
                                                   bool quick, CallSelection& chosen, CallSettings& settings) {
    auto request = study::trade_request(scene, shape, {chosen.tested_forms, chosen.forms, true});
    if (quick) request.plan = study::quick_plan();
    request.limit.stop = request.plan.stop = settings.stop();
    request.plan.progress = settings.advance_callback(measure::trade::count_trade_units(request));
    const auto measured_trade = measure::trade::run_trade(request);
    auto result = std::make_unique<lostbits_result>();
    result->add_table("trade", output::trade::make_time_table(),
                      output::trade::make_time_rows(request, measured_trade));
    result->add_table("pareto", output::trade::make_pareto_table(),
                      output::trade::make_pareto_rows(request, measured_trade));
    result->texts.push_back(output::trade::trade_text(request, measured_trade));
    return result;
}

measure::choose::Requirement parse_requirement(const lostbits_requirement& requirement, const char* default_at) {
    if (!(requirement.bits >= 0 && requirement.bits <= 53)) throw InputError("bits must be from 0 to 53");
    if (!(requirement.wrong >= 0 && requirement.wrong <= 1))
        throw InputError("wrong is a share of the rays and must be from 0 to 1");
    if (std::isnan(requirement.tolerance))
        throw InputError("tolerance is not a number; give a length, or a number below 0 for any");
    measure::choose::Requirement result{
        .bits = requirement.bits,
        .max_wrong_fraction = requirement.wrong,
        .quantile = measure::choose::parse_quantile(requirement.at ? requirement.at : default_at)};
    if (requirement.tolerance >= 0) result.tolerance = requirement.tolerance;
    return result;
}

/// Fills the result. Returns true if any form meets the requirement.
bool mend_into(lostbits_result& result, const scene::file::Scene& scene,
               const measure::choose::Requirement& requirement, bool two_words, CallSelection& chosen,
               CallSettings& settings) {
    if (requirement.has_tolerance()) throw InputError("mend takes bits, not a tolerance");
    chosen.keep_forms_for("scene " + scene.id, [&](Shapes forms) { return scene.accepts(forms); });
    if (scene.has_transform())
        throw InputError("the primitives of scene " + scene.id +
                         " have transforms; only the command `lostbits mend` takes those");
    const TestedForm& tested_form = only_tested_form(chosen, "mend repairs one form in one format");
    if (tested_form.format.is_emulated()) throw InputError("mend works in f32 and f64 only; name one of them");
    selection::require_no_generators({tested_form.form}, "mend");
    selection::require_no_generated_rays({scene}, "mend");

    measure::repair::RepairRequest request{
        .scene = &scene, .tested_form = tested_form, .requirement = requirement, .two_words = two_words};
    request.limit.stop = settings.stop();
    request.progress = settings.advance_callback(0);
    const auto repair = measure::repair::repair_form(request);
    const output::repair::RepairSummary repair_summary = output::repair::summarise_repair(request, repair);

    result.add_table("mend", output::repair::make_form_table(), output::repair::make_form_rows(repair_summary));
    result.add_table("minimal", output::repair::make_minimal_table(),
                     output::repair::make_minimal_rows(repair_summary));
    result.add_table("probes", output::repair::probe_table(), output::repair::probe_rows(repair_summary));
    result.texts.push_back(output::repair::repair_text(repair_summary));
    const bool is_better =
        output::repair::best_proposal(output::repair::list_proposals(repair_summary), repair_summary) != nullptr;
    if (is_better)
        result.texts.push_back(output::repair::emitted_file_text(repair_summary, "mended.hpp", "lostbits_mend"));
    return repair.wider_set || is_better;
}

/// Fills the result. Returns true if any form meets the requirement.
bool choose_into(lostbits_result& result, const scene::file::Scene& scene,
                 const measure::choose::Requirement& requirement, CallSelection& chosen, CallSettings& settings) {
    measure::choose::ChoiceRequest request;
    request.requirement = requirement;
    request.limit.stop = request.plan.stop = settings.stop();
    request.scene = &scene;
    request.tested_forms = selection::select_timed_forms(scene.id, {chosen.tested_forms, chosen.forms, true},
                                                         [&scene](Shapes forms) { return scene.accepts(forms); });
    std::erase_if(request.tested_forms, [](const TestedForm& tested_form) { return tested_form.format.is_emulated(); });
    if (request.tested_forms.empty())
        throw InputError(
            "choose compares f32 and f64 only: the time of an emulated format says nothing; name one of them");
    request.progress = settings.advance_callback(scene.pixel_count() * request.tested_forms.size());

    measure::choose::TimedRays timed_rays;
    const auto candidates = measure_candidates(request, timed_rays);
    const auto choice = output::choose::choose_among(request, candidates, timed_rays);
    result.add_table("choose", output::choose::make_candidate_table(), output::choose::make_candidate_rows(choice));
    result.add_table("room", output::choose::make_margin_table(), choice.margins);
    result.texts.push_back(output::choose::choice_text(choice));
    return choice.cheapest_index.has_value();
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
ExitStatus run_with_requirement(const RequirementArguments& arguments, const char* default_at, lostbits_result** result,
                                const Find& find) {
    require(arguments.scene, "scene");
    require(arguments.requirement, "requirement");
    require(result, "result");
    CallSelection chosen(arguments.choice);
    CallSettings settings(arguments.run);
    auto answer = std::make_unique<lostbits_result>();
    const bool meets_requirement =
        find(*answer, arguments.scene->scene, parse_requirement(*arguments.requirement, default_at), chosen, settings);
    return hand_over(std::move(answer), result, meets_requirement ? ExitStatus::done : ExitStatus::answer_is_no);
}

}  // namespace
}  // namespace lostbits::analysis::library

using namespace lostbits;
using namespace lostbits::analysis;
using namespace lostbits::analysis::library;

extern "C" {

int lostbits_sweep(const char* sweep, int is_text, const char* data, const lostbits_choice* choice,
                   const lostbits_run* run, lostbits_result** result, lostbits_error* error) {
    return run_guarded(error, [&] {
        require(sweep, "sweep");
        require(result, "result");
        CallSelection chosen(choice);
        CallSettings settings(run);
        const std::string folder = selection::data_folder(data ? data : "").string();
        if (is_text == 0)
            return hand_over(make_sweep_result(scene::sweep::find_sweep(sweep, folder), folder, chosen, settings),
                             result);
        const TextFile file(sweep);
        return hand_over(
            file.run_with_text_positions([&] { return make_sweep_result(file.path(), folder, chosen, settings); }),
            result);
    });
}

int lostbits_explain(const lostbits_scene* scene, int x, int y, const lostbits_choice* choice, lostbits_result** result,
                     lostbits_error* error) {
    return run_guarded(error, [&] {
        require(scene, "scene");
        require(result, "result");
        CallSelection chosen(choice);
        return hand_over(make_explanation_result(scene->scene, x, y, chosen), result);
    });
}

int lostbits_study(const char* study, const lostbits_scene* scene, const lostbits_words* options,
                   const lostbits_choice* choice, const lostbits_run* run, lostbits_result** result,
                   lostbits_error* error) {
    return run_guarded(error, [&] {
        require(study, "study");
        require(scene, "scene");
        require(result, "result");
        const auto option_texts = options ? to_strings(*options, "options") : std::vector<std::string>{};
        CallSettings settings(run);
        auto study_tables = study::with_study(study, [&](auto adapter) {
            return make_study_result<decltype(adapter)>(scene->scene, option_texts, choice, settings);
        });
        return hand_over(std::move(study_tables), result);
    });
}

int lostbits_trade(const lostbits_scene* scene, const char* shape, int quick, const lostbits_choice* choice,
                   const lostbits_run* run, lostbits_result** result, lostbits_error* error) {
    return run_guarded(error, [&] {
        require(result, "result");
        if (scene != nullptr && shape != nullptr)
            throw InputError("shape: a scene is given, which has its own shapes; pass NULL for one of the two");
        if (shape != nullptr && *shape == '\0') throw InputError("shape is empty; name one, or pass NULL for a sphere");
        CallSelection chosen(choice);
        CallSettings settings(run);
        return hand_over(
            make_trade_result(scene ? &scene->scene : nullptr, shape ? shape : "", quick != 0, chosen, settings),
            result);
    });
}

int lostbits_choose(const lostbits_scene* scene, const lostbits_requirement* requirement, const lostbits_choice* choice,
                    const lostbits_run* run, lostbits_result** result, lostbits_error* error) {
    return run_guarded(error, [&] {
        return run_with_requirement({scene, requirement, choice, run}, "p99", result, choose_into);
    });
}

int lostbits_mend(const lostbits_scene* scene, const lostbits_requirement* requirement, int two_words,
                  const lostbits_choice* choice, const lostbits_run* run, lostbits_result** result,
                  lostbits_error* error) {
    return run_guarded(error, [&] {
        return run_with_requirement({scene, requirement, choice, run}, "max", result,
                                    [&](auto& filled_result, const auto& target_scene, const auto& asked_requirement,
                                        CallSelection& chosen, CallSettings& settings) {
                                        return mend_into(filled_result, target_scene, asked_requirement, two_words != 0,
                                                         chosen, settings);
                                    });
    });
}
}
