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
void add_once(std::vector<T>& list, const std::type_identity_t<T>& item) {
    if (std::ranges::find(list, item) == list.end()) list.push_back(item);
}

/// The forms whose names match any of the patterns (`sphere.*`, `*press*`), in the order of the catalogue. After them
/// come the sets of words such as `sphere.press+box.*` (`select_sets`) and the rows of words such as `sphere.*@pbrt`
/// and `sphere.*^box.signs` (`select_composed`). Throws InputError, which names the `option` and suggests a name, for
/// an unknown name, and NothingSelected for a pattern that matches nothing.
std::vector<const intersect::table::Intersector*> select_forms(const std::vector<std::string>& globs,
                                                               const char* option = "-i");

/// True if the text has characters of a pattern: `*`, `?` or `[`.
bool is_glob(const std::string& text);

/// Returns the indices of the names that match one of the patterns. `noun` names one item, such as `form`; the plural
/// of its last word is the list of `lostbits list` that a message advises. Throws InputError, which names the `option`
/// and suggests a name, for an unknown name, and NothingSelected for a pattern that matches nothing.
std::vector<std::size_t> find_indices(const std::vector<std::string>& patterns, const std::vector<std::string>& names,
                                      const std::string& noun, const char* option);

/// The items of a list, such as `intersect::transform::transform_methods()`, that the patterns name, in the order of
/// the list.
template <class Row>
std::vector<const Row*> select_rows(std::span<const Row> list, const std::vector<std::string>& patterns,
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
std::vector<const measure::metric::Metric*> select_metrics(const std::vector<std::string>& globs,
                                                           measure::metric::MetricSet& metric_set);

/// The metrics that apply to at least one of the rows: metrics of marches are dropped if no row marches. Throws
/// InputError if none is left. `subject` names the scene or sweep.
std::vector<const measure::metric::Metric*> applicable_metrics(
    std::vector<const measure::metric::Metric*> metrics, const std::vector<measure::evaluate::TestedForm>& tested_forms,
    const std::string& subject);

/// Sets the form, by name, that each row is compared with. Drops rows of other shapes, and rows in formats in which the
/// form does not exist. Throws InputError if no row is left. Prints on stderr, unless `quiet`, which rows can only be
/// compared by their decisions.
void compare_against(std::vector<measure::evaluate::TestedForm>& tested_forms, const std::string& form, bool quiet);

/// Adds the metrics that compare a row with another form, if they are not in the list yet.
void add_comparison_metrics(std::vector<const measure::metric::Metric*>& metrics);

/// Prints on stderr which metrics leave out which forms because the operations of the forms are not known. Throws
/// InputError if a metric leaves out all rows.
void note_without_formula(const std::vector<const measure::metric::Metric*>& metrics,
                          const std::vector<measure::evaluate::TestedForm>& tested_forms, bool quiet);

/// The default metrics and the given ones, as far as they apply, in the order of the table.
std::vector<const measure::metric::Metric*> measured_metrics(
    const std::vector<const measure::metric::Metric*>& given,
    const std::vector<measure::evaluate::TestedForm>& tested_forms);

/// The formats in which a form exists, in words: `all`, `f32`, `f64`, `f32 and f64`.
std::string formats_of(const intersect::table::Intersector& form);

/// Every selected form in every selected format in which it exists. Throws NothingSelected if there are none.
std::vector<measure::evaluate::TestedForm> cross(const std::vector<const intersect::table::Intersector*>& forms,
                                                 const std::vector<Format>& formats);

/// The rows whose forms are for shapes that `meets(Shapes)` accepts.
template <class ShapePredicate>
std::vector<measure::evaluate::TestedForm> fitting_rows(const std::vector<measure::evaluate::TestedForm>& tested_forms,
                                                        const ShapePredicate& meets) {
    std::vector<measure::evaluate::TestedForm> chosen;
    std::ranges::copy_if(
        tested_forms, std::back_inserter(chosen),
        [&](const measure::evaluate::TestedForm& tested_form) { return meets(tested_form.form->shapes()); });
    return chosen;
}

/// Drops the subjects (scenes or sweeps) that no selected form handles, and prints each on stderr unless quiet.
/// `meets(subject, shapes)` is true if forms for these shapes can handle a subject; `name_of` returns its name. For
/// subjects with several shapes it first adds sets of forms (`rows_meeting`). Returns the rows that can handle one of
/// the subjects that are left. Throws NothingSelected if none is left.
template <class Subjects, class MeetsSubject, class NameOf>
std::vector<measure::evaluate::TestedForm> drop_unfitting(Subjects& subjects, const SelectedRows& chosen,
                                                          MeetsSubject meets, NameOf name_of) {
    const std::vector<measure::evaluate::TestedForm>& tested_forms = chosen.rows;
    std::vector<std::string> messages;
    std::erase_if(subjects, [&](const auto& subject) {
        const ShapePredicate meets_subject = [&](Shapes forms) { return meets(subject, forms); };
        if (!rows_meeting(chosen, std::string(name_of(subject)), meets_subject).empty()) return false;
        messages.push_back("no selected form handles " + std::string(name_of(subject)) +
                           fitting_forms_advice(tested_forms, meets_subject));
        return true;
    });
    if (subjects.empty()) throw NothingSelected(messages.front());
    for (const std::string& message : messages) {
        if (!chosen.quiet) std::fprintf(stderr, "lostbits: left out: %s\n", message.c_str());
    }
    return fitting_rows(tested_forms, [&](Shapes forms) {
        return std::ranges::any_of(subjects, [&](const auto& subject) { return meets(subject, forms); });
    });
}

/// Limits every parallel loop to `threads` threads while it lives; 0 is one per core.
class ThreadLimit {
public:
    explicit ThreadLimit(int threads);
    ~ThreadLimit();
    ThreadLimit(const ThreadLimit&) = delete;
    ThreadLimit& operator=(const ThreadLimit&) = delete;

private:
    struct Control;
    std::unique_ptr<Control> control_;
};

/// Throws InputError for a form with a ray generator, in a command that gives forms the rays of the camera.
void refuse_generators(const std::vector<const intersect::table::Intersector*>& forms, const char* command);
void refuse_generators(const std::vector<measure::evaluate::TestedForm>& tested_forms, const char* command);
/// Throws InputError for FORM+fma, whose time cannot be measured.
void refuse_contracted(const std::vector<measure::evaluate::TestedForm>& tested_forms, const char* command);

/// Throws InputError for a scene whose rays are made in each format, in a command that rounds exact rays.
void refuse_generated_rays(const std::vector<scene::file::Scene>& scenes, const char* command);

/// Prints on stderr which lengths of the scene vanish or overflow in a format and, if a row marches, which constants of
/// its march do.
void note_lost_numbers(const scene::file::Scene& scene, const std::vector<measure::evaluate::TestedForm>& tested_forms);

/// Prints on stderr which lengths, and which constants of a march, vanish or overflow in a format at any step of a
/// sweep. It makes the rays of every step, which takes 4 s for 4000 steps of 1024 views.
void note_lost_numbers(const scene::sweep::SweepFile& sweep,
                       const std::vector<measure::evaluate::TestedForm>& tested_forms,
                       intersect::process::StopToken stop);

/// Prints on stderr which lengths of any case vanish or overflow in a format. Words such as `tiny` stand for numbers of
/// each format and are never lost.
void note_lost_numbers(const scene::sweep::CaseFile& file,
                       const std::vector<measure::evaluate::TestedForm>& tested_forms);

/// Prints on stderr which assignments of `--set` change nothing: constants of a march if no row marches.
void note_idle_settings(const std::vector<std::string>& set, const std::string& id,
                        const std::vector<measure::evaluate::TestedForm>& tested_forms);

/// Calls `note_lost_numbers` and `note_idle_settings` for a scene that `set` has changed; does nothing if `quiet`.
void note_numbers(const scene::file::Scene& scene, const std::vector<std::string>& set,
                  const std::vector<measure::evaluate::TestedForm>& tested_forms, bool quiet);

/// A line `FORM FORMAT: text` for each row whose form is not in the catalogue and for which `suspicion` returns a text.
/// It returns an empty text if nothing seems wrong (`measure::contract::suspicion`).
std::vector<std::string> suspicions_of(
    const std::vector<measure::evaluate::TestedForm>& tested_forms,
    const std::function<std::string(const measure::evaluate::TestedForm&)>& suspicion);

}  // namespace lostbits::analysis::selection
