// From names and globs on the command line to forms, formats and metrics; and what is said on stderr of numbers that
// the formats cannot hold.
#pragma once

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "analysis/selection/scenes.hpp"
#include "analysis/selection/sets.hpp"
#include "intersect/hull/behind.hpp"
#include "intersect/process/stop_token.hpp"
#include "intersect/space/space.hpp"
#include "intersect/table/table.hpp"
#include "measure/evaluate/evaluate.hpp"
#include "measure/metric/metric_set.hpp"
#include "number/error.hpp"
#include "number/format.hpp"
#include "scene/file/scene.hpp"
#include "scene/sweep/case_file.hpp"
#include "scene/sweep/sweep_file.hpp"

namespace lostbits::analysis::selection {

/// At the end, where it is not among them already.
template <class T>
void add_once(std::vector<T>& all, const std::type_identity_t<T>& one) {
    if (std::ranges::find(all, one) == all.end()) all.push_back(one);
}

/// Forms whose name matches any of the globs (`sphere.*`, `*press*`), in the catalogue's order, and then the sets of
/// words such as `sphere.press+box.*` (`sets_named`) and the rows of words such as `sphere.*@pbrt` and
/// `sphere.*^box.signs` (`made_named`). A name without a glob character that is unknown is bad input, with
/// did-you-mean, of the `option`; a glob that matches nothing selects nothing (exit 4).
std::vector<const intersect::table::Intersector*> select_forms(const std::vector<std::string>& globs,
                                                               const char* option = "-i");

/// Whether a word stands for all names that it fits.
bool is_glob(const std::string& text);

/// The places of the names that any of the words is or, as a glob, fits. InputError with did-you-mean, of the `option`,
/// and NothingSelected for a glob that fits none; `what` is what one is called: `lostbits list` knows it in the plural.
std::vector<std::size_t> places_named(const std::vector<std::string>& words, const std::vector<std::string>& names,
                                      const std::string& what, const char* option);

/// The rows of a list, such as `intersect::space::spaces()`, in its order, by their names.
template <class Row>
std::vector<const Row*> select_rows(std::span<const Row> list, const std::vector<std::string>& words, const char* what,
                                    const char* option) {
    std::vector<std::string> names;
    for (const Row& row : list) {
        if constexpr (requires { row.info->name; }) names.emplace_back(row.info->name);
        else names.emplace_back(row.name);
    }
    std::vector<const Row*> rows;
    for (const std::size_t place : places_named(words, names, what, option)) rows.push_back(&list[place]);
    return rows;
}

/// Formats by name, or ranges `p5..p12`; duplicates are dropped. InputError with did-you-mean.
std::vector<Format> select_formats(const std::vector<std::string>& names, const char* option = "-f");

/// Metrics by name or glob, in the order asked for; `made` keeps those of labels. InputError with did-you-mean.
std::vector<const measure::metric::Metric*> select_metrics(const std::vector<std::string>& globs,
                                                           measure::metric::MetricSet& made);

/// Those of the metrics that any of the rows has: the ones of marches go where no row marches. InputError where that
/// leaves none; `what` is the scene or sweep.
std::vector<const measure::metric::Metric*> applicable_metrics(std::vector<const measure::metric::Metric*> asked,
                                                               const std::vector<measure::evaluate::TestedForm>& rows,
                                                               const std::string& what);

/// Each row is compared with a form, by name; rows of other shapes go, and of formats that it does not exist in.
/// InputError where that leaves none; says so on stderr, unless `quiet`, where only decisions can be compared.
void compare_against(std::vector<measure::evaluate::TestedForm>& rows, const std::string& form, bool quiet);

/// What is measured of rows that are held against a form, where it is not asked for already.
void add_pairs(std::vector<const measure::metric::Metric*>& metrics);

/// Says on stderr which of the metrics leave out which rows, because nothing is known there of how the answer came
/// about. InputError where that leaves out all rows.
void note_without_formula(const std::vector<const measure::metric::Metric*>& asked,
                          const std::vector<measure::evaluate::TestedForm>& rows, bool quiet);

/// The default metrics and those that were asked for, as far as they apply, in the table's order.
std::vector<const measure::metric::Metric*> measured(const std::vector<const measure::metric::Metric*>& asked,
                                                     const std::vector<measure::evaluate::TestedForm>& rows);

/// The formats that a form exists in, in words: `all`, `f32`, `f64`, `f32 and f64`.
std::string formats_of(const intersect::table::Intersector& form);

/// Every selected form in every selected format that it exists in. NothingSelected where that leaves none.
std::vector<measure::evaluate::TestedForm> cross(const std::vector<const intersect::table::Intersector*>& forms,
                                                 const std::vector<Format>& formats);

/// The rows whose forms are for shapes that `meets(Shapes)` accepts.
template <class Meets>
std::vector<measure::evaluate::TestedForm> fitting(const std::vector<measure::evaluate::TestedForm>& rows,
                                                   const Meets& meets) {
    std::vector<measure::evaluate::TestedForm> chosen;
    std::ranges::copy_if(rows, std::back_inserter(chosen),
                         [&](const measure::evaluate::TestedForm& row) { return meets(row.form->shapes()); });
    return chosen;
}

/// Adds the sets of forms that things with solids of several shapes are measured by (`rows_meeting`). Drops what no
/// selected form handles then and says so on stderr unless quiet; `meets(thing, Shapes)` tells which forms can handle a
/// thing, `name_of` its name. Returns the rows that can handle something of what stays. NothingSelected where nothing
/// does.
template <class Things, class MeetsThing, class NameOf>
std::vector<measure::evaluate::TestedForm> drop_unfitting(Things& things, const ChosenRows& chosen, MeetsThing meets,
                                                          NameOf name_of) {
    const std::vector<measure::evaluate::TestedForm>& rows = chosen.rows;
    std::vector<std::string> left_out;
    std::erase_if(things, [&](const auto& thing) {
        const Meets can = [&](Shapes forms) { return meets(thing, forms); };
        if (!rows_meeting(chosen, std::string(name_of(thing)), can).empty()) return false;
        left_out.push_back("no selected form handles " + std::string(name_of(thing)) + words_to_meet(rows, can));
        return true;
    });
    if (things.empty()) throw NothingSelected(left_out.front());
    for (const std::string& each : left_out) {
        if (!chosen.quiet) std::fprintf(stderr, "lostbits: left out: %s\n", each.c_str());
    }
    return fitting(rows, [&](Shapes forms) {
        return std::ranges::any_of(things, [&](const auto& thing) { return meets(thing, forms); });
    });
}

/// Limits every parallel loop to that many threads while it lives; 0 stands for one per core.
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

/// InputError for a form with a way to make rays, of a command that gives forms the camera's own.
void refuse_makers(const std::vector<const intersect::table::Intersector*>& forms, const char* command);
void refuse_makers(const std::vector<measure::evaluate::TestedForm>& rows, const char* command);
/// InputError for FORM+fma, whose time is not measured.
void refuse_contracted(const std::vector<measure::evaluate::TestedForm>& rows, const char* command);

/// InputError for a scene whose rays each format makes, of a command that rounds them.
void refuse_made_rays(const std::vector<scene::file::Scene>& scenes, const char* command);

/// The constants of its march, where a row marches, and its lengths.
void note_lost_numbers(const scene::file::Scene& scene, const std::vector<measure::evaluate::TestedForm>& rows);

/// The same at every step of a sweep, whose rays are made for it: 4 s for 4000 steps of 1024 views.
void note_lost_numbers(const scene::sweep::SweepFile& sweep, const std::vector<measure::evaluate::TestedForm>& rows,
                       intersect::process::StopToken stop);

/// The lengths of all cases. Words such as `tiny` are numbers of every format and never lost.
void note_lost_numbers(const scene::sweep::CaseFile& file, const std::vector<measure::evaluate::TestedForm>& rows);

/// Says which assignments of `--set` change nothing: the constants of a march where no row marches.
void note_idle_settings(const std::vector<std::string>& set, const std::string& id,
                        const std::vector<measure::evaluate::TestedForm>& rows);

/// Both, of a scene that `set` has changed; nothing where `quiet`.
void note_numbers(const scene::file::Scene& scene, const std::vector<std::string>& set,
                  const std::vector<measure::evaluate::TestedForm>& rows, bool quiet);

}  // namespace lostbits::analysis::selection
