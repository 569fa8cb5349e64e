#include "output/choice/other_tables.hpp"

#include <fmt/format.h>

namespace lostbits::output::choice {

using file::Cell;
using file::Column;
using file::number_or_missing;
using measure::choice::Input;
using measure::choice::InputTrial;

std::string name_of_inputs(const FloatFormat& format) {
    if (format == binary32) return "binary32";
    if (format == binary64) return "binary64";
    return fmt::format("p{}", format.precision);
}

std::vector<Column> offset_columns() {
    return {{"side", "string", "", "outside: right for every ray away from the solid; both: also for those into it"},
            {"strategy", "string", "", "where the next ray starts"},
            {"operations", "integer", "", "that one new ray costs, as the rule is written"},
            {"oversize_p50", "number", "1",
             "how many times longer than the smallest safe offset, the median; the larger of the sides; missing: none "
             "is needed"}};
}

void add_offsets(file::CsvWriter& csv, const measure::choice::SafeOffsets& offsets) {
    const auto add = [&csv](const char* side, const std::vector<measure::offset::SafeStrategy>& all) {
        for (const auto& [strategy, operations, oversize] : all) {
            csv.add(side).add(strategy->name).add(operations).add(number_or_missing(oversize));
            csv.end_row();
        }
    };
    add("outside", offsets.outside);
    add("both", offsets.both);
}

std::vector<Column> input_columns() {
    return {
        {"origin", "string", "", "format that the origins of the rays come in; exact: not rounded"},
        {"direction", "string", "", "the same of their directions"},
        {"place", "string", "", "the same of the centres of spheres and the corners of boxes"},
        {"radius", "string", "", "the same of the radii of spheres"},
        {"rays", "integer", "", "whose truth is known"},
        {"exact_wrong", "integer", "",
         "rays on which the truth of these inputs decides otherwise than that of the ideal ones"},
        {"exact_kept_bits", "number", "bits",
         "of 53: what exact arithmetic on these inputs keeps of the ideal truth, at the wish's share of the hits"},
        {"f64_wrong", "integer", "", "rays that the form nearest to the wish decides wrongly, in f64 on these inputs"},
        {"f64_kept_bits", "number", "bits", "what it keeps there; missing: it was not asked"}};
}

void add_inputs(file::CsvWriter& csv, const measure::choice::Obstacle& obstacle) {
    const auto format_of = [&obstacle](const InputTrial& trial, Input input) {
        if (!trial.has(input)) return name_of_inputs(obstacle.base);
        return obstacle.wider_than_f64 ? std::string("exact") : name_of_inputs(binary64);
    };
    for (const InputTrial& trial : obstacle.trials) {
        for (const Input input : measure::choice::input_kinds) csv.add(format_of(trial, input));
        csv.add(trial.exact.rays).add(trial.exact.wrong).add(number_or_missing(trial.exact.kept_bits));
        csv.add(trial.form ? Cell(trial.form->wrong) : Cell());
        csv.add(trial.form ? number_or_missing(trial.form->kept_bits) : Cell());
        csv.end_row();
    }
}

}  // namespace lostbits::output::choice
