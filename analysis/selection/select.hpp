// Selects forms, formats and metrics by names and patterns of the command line. Prints notes on stderr about numbers
// that the formats cannot represent.
#pragma once

#include <algorithm>
#include <cstdio>
#include <functional>
#include <iterator>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "analysis/selection/scenes.hpp"
#include "analysis/selection/sets.hpp"
#include "intersect/bounding_box/behind.hpp"
#include "intersect/process/stop_token.hpp"
#include "intersect/table/table.hpp"
#include "intersect/transform/transform_method.hpp"
#include "measure/evaluate/evaluate.hpp"
#include "measure/metric/metric_set.hpp"
#include "number/error.hpp"
#include "number/format.hpp"
#include "scene/file/scene.hpp"
#include "scene/sweep/case_file.hpp"
#include "scene/sweep/sweep_file.hpp"

namespace lostbits::analysis::selection {

/// Appends an item that is not in the list yet.
template <class T>
void append_if_missing(std::vector<T>& list, const std::type_identity_t<T>& item) {
    if (std::ranges::find(list, item) == list.end()) list.push_back(item);
}

/// The forms whose names match any of the patterns (`sphere.*`, `*press*`), in the order of the catalogue. After them
/// come the sets that patterns such as `sphere.press+box.*` expand to (`select_sets`), and the forms that patterns such
/// as `sphere.*@pbrt` and `sphere.*^box.signs` expand to (`select_composed`). Throws InputError, which names the
/// `option` and suggests a name, for an unknown name, and NothingSelected for a pattern that matches nothing.
std::vector<const intersect::table::Intersector*> select_forms(const std::vector<std::string>& patterns,
                                                               const char* option = "-i");

/// True if the text has characters of a pattern: `*`, `?` or `[`.
bool is_pattern(const std::string& text);

/// Returns the indices of the names that match one of the patterns. `noun` names one item, such as `form`; its
/// plural names the `lostbits list` topic that a message suggests. Throws InputError, which names the `option`
/// and suggests a name, for an unknown name, and NothingSelected for a pattern that matches nothing.
std::vector<std::size_t> find_indices(const std::vector<std::string>& patterns, const std::vector<std::string>& names,
                                      const std::string& noun, const char* option);

/// The items of a list, such as `intersect::transform::transform_methods()`, that the patterns name, in the order of
/// the list.
template <class Row>
std::vector<const Row*> select_items(std::span<const Row> list, const std::vector<std::string>& patterns,
                                     const char* noun, const char* option) {
    std::vector<std::string> names;
    for (const Row& row : list) {
        if constexpr (requires { row.info->name; }) names.emplace_back(row.info->name);
        else names.emplace_back(row.name);
    }
    std::vector<const Row*> rows;
    for (const std::size_t index : find_indices(patterns, names, noun, option)) rows.push_back(&list[index]);
    return rows;
}

/// The formats of names and ranges `p5..p12`, each once. Throws InputError, which suggests a name, for an unknown one.
std::vector<Format> select_formats(const std::vector<std::string>& names, const char* option = "-f");

/// The metrics of names and patterns, in the given order. `metric_set` owns the metrics that are made for labels.
/// Throws InputError, which suggests a name, for an unknown one.
std::vector<const measure::metric::Metric*> select_metrics(const std::vector<std::string>& patterns,
                                                           measure::metric::MetricSet& metric_set);

/// The metrics that apply to at least one tested form: metrics of marches are dropped if no form marches. Throws
/// InputError if none is left. `subject` names the scene or sweep.
std::vector<const measure::metric::Metric*> applicable_metrics(
    std::vector<const measure::metric::Metric*> metrics, const std::vector<measure::evaluate::TestedForm>& tested_forms,
    const std::string& subject);

/// Throws InputError if there are metrics but none of them applies to a tested form.
void require_applicable_metrics(const std::vector<const measure::metric::Metric*>& metrics,
                                const std::vector<measure::evaluate::TestedForm>& tested_forms,
                                const std::string& subject);

/// Sets the form, by name, that each tested form is compared with. Drops tested forms for other shapes, and those in
/// formats in which that form does not exist. Throws InputError if none is left. Prints on stderr, unless `quiet`,
/// which tested forms can only be compared by their decisions.
void compare_against(std::vector<measure::evaluate::TestedForm>& tested_forms, const std::string& form, bool quiet);

/// Adds the metrics that compare a form with another one, if they are not in the list yet.
void add_comparison_metrics(std::vector<const measure::metric::Metric*>& metrics);

/// Prints on stderr which metrics leave out which forms because the operations of the forms are not known. Throws
/// InputError if a metric leaves out all forms.
void note_forms_without_formula(const std::vector<const measure::metric::Metric*>& metrics,
                                const std::vector<measure::evaluate::TestedForm>& tested_forms, bool quiet);

/// The default metrics and the given ones, as far as they apply, in the order of `measure::metric::metrics()`.
std::vector<const measure::metric::Metric*> with_default_metrics(
    const std::vector<const measure::metric::Metric*>& given,
    const std::vector<measure::evaluate::TestedForm>& tested_forms);

/// The formats in which a form exists, in words: `all`, `f32`, `f64`, `f32 and f64`.
std::string formats_text(const intersect::table::Intersector& form);

/// Every selected form in every selected format in which it exists. Throws NothingSelected if no form exists in a
/// selected format.
std::vector<measure::evaluate::TestedForm> pair_forms_with_formats(
    const std::vector<const intersect::table::Intersector*>& forms, const std::vector<Format>& formats);

/// The tested forms for shapes that `can_test(Shapes)` accepts.
template <class ShapePredicate>
std::vector<measure::evaluate::TestedForm> filter_tested_forms(
    const std::vector<measure::evaluate::TestedForm>& tested_forms, const ShapePredicate& can_test) {
    std::vector<measure::evaluate::TestedForm> chosen;
    std::ranges::copy_if(
        tested_forms, std::back_inserter(chosen),
        [&](const measure::evaluate::TestedForm& tested_form) { return can_test(tested_form.form->shapes()); });
    return chosen;
}

/// Drops the subjects (scenes or sweeps) that no selected form handles, and prints each on stderr unless quiet.
/// `can_test(subject, shapes)` is true if forms for these shapes can handle a subject; `name_of` returns its name. For
/// subjects with several shapes it first adds sets of forms (`tested_forms_handling`). Returns the tested forms that
/// can handle one of the subjects that are left. Throws NothingSelected if none is left.
template <class Subjects, class CanTestSubject, class NameOf>
std::vector<measure::evaluate::TestedForm> drop_unhandled(Subjects& subjects, const SelectedForms& chosen,
                                                          CanTestSubject can_test, NameOf name_of) {
    const std::vector<measure::evaluate::TestedForm>& tested_forms = chosen.tested_forms;
    std::vector<std::string> messages;
    std::erase_if(subjects, [&](const auto& subject) {
        const ShapePredicate can_test_subject = [&](Shapes forms) { return can_test(subject, forms); };
        if (!tested_forms_handling(chosen, std::string(name_of(subject)), can_test_subject).empty()) return false;
        messages.push_back(unhandled_text(std::string(name_of(subject)), tested_forms, can_test_subject));
        return true;
    });
    if (subjects.empty()) throw NothingSelected(messages.front());
    if (!chosen.quiet) std::ranges::for_each(messages, note_left_out);
    return filter_tested_forms(tested_forms, [&](Shapes forms) {
        return std::ranges::any_of(subjects, [&](const auto& subject) { return can_test(subject, forms); });
    });
}

/// Limits every parallel loop to `threads` threads while it lives; 0 means one per core.
class ThreadLimit {
public:
    explicit ThreadLimit(int thread_count);
    ~ThreadLimit();
    ThreadLimit(const ThreadLimit&) = delete;
    ThreadLimit& operator=(const ThreadLimit&) = delete;

private:
    struct Control;
    std::unique_ptr<Control> control_;
};

/// Throws InputError for a form with a ray generator, in a command that gives forms the rays of the camera.
void require_no_generators(const std::vector<const intersect::table::Intersector*>& forms, const char* command);
void require_no_generators(const std::vector<measure::evaluate::TestedForm>& tested_forms, const char* command);
/// Throws InputError for FORM+fma, whose time cannot be measured.
void require_no_contracted_forms(const std::vector<measure::evaluate::TestedForm>& tested_forms, const char* command);

/// Throws InputError for a scene whose rays are made in each format, in a command that rounds exact rays.
void require_no_generated_rays(const std::vector<scene::file::Scene>& scenes, const char* command);

/// Prints on stderr which lengths of the scene vanish or overflow in a format and, if a form marches, which constants
/// of its march do.
void note_unrepresentable_numbers(const scene::file::Scene& scene,
                                  const std::vector<measure::evaluate::TestedForm>& tested_forms);

/// Prints on stderr which lengths, and which constants of a march, vanish or overflow in a format at any step of a
/// sweep. It makes the rays of every step, which takes 4 s for 4000 steps of 1024 views.
void note_unrepresentable_numbers(const scene::sweep::SweepFile& sweep,
                                  const std::vector<measure::evaluate::TestedForm>& tested_forms,
                                  intersect::process::StopToken stop);

/// Prints on stderr which lengths of any case vanish or overflow in a format. Words such as `tiny` stand for numbers of
/// each format and never vanish or overflow.
void note_unrepresentable_numbers(const scene::sweep::CaseFile& file,
                                  const std::vector<measure::evaluate::TestedForm>& tested_forms);

/// Prints on stderr which assignments of `--set` change nothing: constants of a march if no form marches.
void note_ineffective_settings(const std::vector<std::string>& set, const std::string& id,
                               const std::vector<measure::evaluate::TestedForm>& tested_forms);

/// Calls `note_unrepresentable_numbers` and `note_ineffective_settings` for a scene that `set` has changed; does
/// nothing if `quiet`.
void warn_of_ineffective_numbers(const scene::file::Scene& scene, const std::vector<std::string>& set,
                                 const std::vector<measure::evaluate::TestedForm>& tested_forms, bool quiet);

/// A line `FORM FORMAT: text` for each tested form that is not in the catalogue and for which `suspicion` returns a
/// text. `suspicion` returns an empty text if nothing seems wrong (`measure::contract::suspicion_text`).
std::vector<std::string> list_suspicions(
    const std::vector<measure::evaluate::TestedForm>& tested_forms,
    const std::function<std::string(const measure::evaluate::TestedForm&)>& suspicion);

}  // namespace lostbits::analysis::selection
