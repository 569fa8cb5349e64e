#include "output/choice/other_tables.hpp"

#include <fmt/format.h>

namespace lostbits::output::choice {

using file::number_or_missing;
using measure::choice::Input;
using measure::choice::Worth;

std::string name_of_inputs(const FloatFormat& format) {
    if (format == binary32) return "binary32";
    if (format == binary64) return "binary64";
    return fmt::format("p{}", format.precision);
}

table::Table<SafeOffsetRow> offset_table() {
    using R = SafeOffsetRow;
    return {{"side", "string", "", "outside: right for every ray away from the solid; both: also for those into it",
             &R::side},
            {"strategy", "string", "", "where the next ray starts", [](const R& r) { return r.safe.strategy->name; }},
            {"operations", "integer", "", "that one new ray costs, as the rule is written",
             [](const R& r) { return r.safe.operations; }},
            {"oversize_p50", "number", "1",
             "how many times longer than the smallest safe offset, the median; the larger of the sides; missing: none "
             "is needed",
             [](const R& r) { return number_or_missing(r.safe.oversize); }}};
}

std::vector<SafeOffsetRow> offset_rows(const measure::choice::SafeOffsets& offsets) {
    std::vector<SafeOffsetRow> rows;
    for (const auto& safe : offsets.outside) rows.push_back({"outside", safe});
    for (const auto& safe : offsets.both) rows.push_back({"both", safe});
    return rows;
}

table::Table<InputRow> input_table() {
    using R = InputRow;
    const auto format_of = [](Input input) {
        return [input](const R& r) {
            if (!r.trial->has(input)) return name_of_inputs(r.obstacle->base);
            return r.obstacle->wider_than_f64 ? std::string("exact") : name_of_inputs(binary64);
        };
    };
    const auto exact = [](const R& r) -> const Worth& { return r.trial->exact; };
    const auto form = [](const R& r) -> const std::optional<Worth>& { return r.trial->form; };
    const auto kept_bits = [](const Worth& w) { return number_or_missing(w.kept_bits); };
    table::Table<R> table{
        {"origin", "string", "", "format that the origins of the rays come in; exact: not rounded",
         format_of(Input::origin)},
        {"direction", "string", "", "the same of their directions", format_of(Input::direction)},
        {"place", "string", "", "the same of the centres of spheres and the corners of boxes", format_of(Input::place)},
        {"radius", "string", "", "the same of the radii of spheres", format_of(Input::radius)}};
    return table
        .add<Worth>(
            {{"rays", "integer", "", "whose truth is known", &Worth::rays},
             {"exact_wrong", "integer", "",
              "rays on which the truth of these inputs decides otherwise than that of the ideal ones", &Worth::wrong},
             {"exact_kept_bits", "number", "bits",
              "of 53: what exact arithmetic on these inputs keeps of the ideal truth, at the wish's share of the hits",
              kept_bits}},
            exact)
        .add<Worth>({{"f64_wrong", "integer", "",
                      "rays that the form nearest to the wish decides wrongly, in f64 on these inputs", &Worth::wrong},
                     {"f64_kept_bits", "number", "bits", "what it keeps there; missing: it was not asked", kept_bits}},
                    form);
}

}  // namespace lostbits::output::choice
