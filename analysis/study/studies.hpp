// The list of studies. The program and the library take them from here.
#pragma once

#include <string>
#include <tuple>
#include <vector>

#include "analysis/study/consistency.hpp"
#include "analysis/study/offsets.hpp"
#include "analysis/study/render.hpp"

namespace lostbits::analysis::study {

/// An adapter of a study for the command line and the library: a struct with its presentation, its name, its options,
/// its forms where none is named, and
///   can_measure(form)             true for a form that can be measured; `no_form_message` is the message if none can
///   require(scene)                throws InputError for a scene that cannot be measured
///   make_study(scene, tested_forms, values, stop)  the study of a scene with these forms. Throws InputError
///   title, kinds, form_help, example    texts of the help: the command; the scenes that it takes; the forms that -i
///                                 selects by default; an assignment for --set
///   examples()                    two command lines for the help, which a test runs
///   print_results(study, summaries, verbose)  prints the results of a scene
///   unproved_count(summaries), unproved_count(row)  the number of pixels without a proof, of all forms and of one row
///   witness(row, column)          optional: a ray behind a number of a row of the summary, for claims
///   skip_unneeded_work(study, columns)  optional: skips the work that these columns of the summary do not need
///   print_missing_stages(scene, values)  optional: prints a note before the work
using Studies = std::tuple<ConsistencyAdapter, OffsetsAdapter, RenderAdapter>;

/// Throws InputError for a study that does not exist.
[[noreturn]] void fail_unknown_study(const std::string& name, const std::vector<std::string>& names);

/// Returns `act(Adapter{})` for the study of this name. Throws InputError for an unknown one.
template <class Act>
auto with_study(const std::string& name, const Act& act) {
    return std::apply(
        [&](auto first, auto... others) {
            decltype(act(first)) result{};
            const auto is_it = [&](auto adapter) {
                if (name != adapter.name) return false;
                result = act(adapter);
                return true;
            };
            if (!is_it(first) && !(is_it(others) || ...)) fail_unknown_study(name, {first.name, others.name...});
            return result;
        },
        Studies());
}

}  // namespace lostbits::analysis::study
