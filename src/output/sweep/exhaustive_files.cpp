#include "output/sweep/exhaustive_files.hpp"

#include <cmath>
#include <span>

#include "measure/truth/lost_bits.hpp"
#include "output/file/datapackage.hpp"
#include "output/file/number_text.hpp"
#include "output/sweep/exhaustive_plots.hpp"
#include "output/sweep/exhaustive_text.hpp"

namespace lostbits::output::sweep {

using file::Cell;
using file::Column;
using file::CsvWriter;
using measure::answer::Outcome;
using measure::sweep::BinadePart;
using measure::sweep::ExhaustiveRequest;
using measure::sweep::ExhaustiveState;
using measure::sweep::first_events;
using measure::sweep::FloatAnswer;
using measure::sweep::FloatTally;
using measure::sweep::RangeFinding;
using scene::sweep::float_at;

namespace {

/// What a row of each table is about.
void put_subject(std::vector<Column>& columns, const std::string& of) {
    columns = {
        {"form", "string", "", "form under test"},
        {"format", "string", "", "format it computes in"},
        {"ray", "string", "", "name of the ray"},
        {"axis", "string", "", "the number that takes every float; numbers with a unit of their own are its values"},
        {"from_hex", "string", of, "the first float that was tried, exactly"},
        {"to_hex", "string", of, "the last"}};
}

/// Of those that can occur.
std::size_t outcomes_of(const ExhaustiveRequest& request) {
    return request.sweep->mesh ? measure::answer::outcome_names.size() : measure::answer::outcomes_of_one_solid;
}

void put_outcomes(std::vector<Column>& columns, const ExhaustiveRequest& request) {
    columns.push_back({"floats", "integer", "", "how many were tried: counted"});
    for (const auto name : std::span(measure::answer::outcome_names).first(outcomes_of(request)))
        columns.push_back({std::string(name), "integer", "", "floats with this outcome"});
}

void put_worst(std::vector<Column>& columns, const ExhaustiveRequest& request) {
    const std::string& unit = request.sweep->axis.unit;
    columns.insert(columns.end(),
                   {{"lost_bits_max", "number", "bits", "of the worst float; missing where no float is a hit for both"},
                    {"worst_ulp_error", "number", "ulp",
                     "(t − t*)/ulp(t*) of the float with the largest in size, by its whole truth"},
                    {"ulp_error_at_most", "number", "ulp",
                     "no float's error is larger in size: next to the worst, and above it by no more than 2^-8 ulp "
                     "where thousands "
                     "of floats are as bad"},
                    {"worst_at", "number", unit, "that float"},
                    {"worst_hex", "string", unit, "the same, exactly"},
                    {"worst_bits", "string", "", "its bits"},
                    {"worst_t_hex", "string", "t", "the form's answer there"},
                    {"worst_truth_hex", "string", "t", "t*, correctly rounded to binary64"},
                    {"worst_explain", "string", "", "the command that explains it"}});
}

void put_wrong(std::vector<Column>& columns, const std::string& unit) {
    for (const char* which : {"first", "last"}) {
        const std::string w = which;
        columns.push_back({w + "_wrong_hex", "string", unit, "the " + w + " float with a wrong decision, exactly"});
        columns.push_back({w + "_wrong_bits", "string", "", "its bits"});
        columns.push_back({w + "_wrong_outcome", "string", "", "what became of it"});
    }
    columns.push_back({"fault_explain", "string", "", "the command that explains the first"});
    columns.push_back({"padding_max", "number", "u",
                       "of a form that asks a box: the padding of tmax that no hit it misses would need more of, which "
                       "is the metric padding; 0 where it misses none whose slabs come apart"});
    columns.push_back({"padding_hex", "string", unit, "the float that needs it, exactly"});
}

std::vector<Column> binade_columns(const ExhaustiveRequest& request) {
    std::vector<Column> columns;
    put_subject(columns, request.sweep->axis.unit);
    columns.insert(columns.begin() + 4,
                   {"binade", "string", "",
                    "sign and power of two of its floats; zeros, subnormals, infinities and NaNs stand apart"});
    put_outcomes(columns, request);
    put_worst(columns, request);
    put_wrong(columns, request.sweep->axis.unit);
    return columns;
}

std::vector<Column> statement_columns(const ExhaustiveRequest& request) {
    std::vector<Column> columns;
    put_subject(columns, request.sweep->axis.unit);
    put_outcomes(columns, request);
    columns.push_back({"right_up_to_hex", "string", request.sweep->axis.unit,
                       "the last float before the first wrong decision; missing where none is wrong, or the first is"});
    put_wrong(columns, request.sweep->axis.unit);
    put_worst(columns, request);
    columns.push_back({"statement", "string", "", "the same in words"});
    return columns;
}

std::vector<Column> onset_columns(const ExhaustiveRequest& request) {
    const std::string& unit = request.sweep->axis.unit;
    std::vector<Column> columns;
    put_subject(columns, unit);
    columns.insert(columns.end(),
                   {{"event", "string", "", "what first happens: lost_bits reach the threshold, or an outcome occurs"},
                    {"threshold", "number", "bits", "of the lost bits; 1 for an outcome"},
                    {"found", "boolean", "", "whether it happens at any of the floats"},
                    {"last_good", "number", unit, "the float before it; missing where the first float is bad already"},
                    {"first_bad", "number", unit, "the first float at which it happens: its neighbour"},
                    {"last_good_hex", "string", unit, "the same, exactly"},
                    {"first_bad_hex", "string", unit, "the same, exactly"},
                    {"first_bad_bits", "string", "", "its bits"},
                    {"ulp_error", "number", "ulp", "(t − t*)/ulp(t*) there; missing for an outcome"},
                    {"floats", "integer", "", "how many were tried: counted"},
                    {"explain", "string", "", "the command that explains the first bad float"}});
    return columns;
}

void add_subject(CsvWriter& csv, const ExhaustiveRequest& request, std::size_t ray, std::size_t row) {
    csv.add(request.rows[row].form->info->name)
        .add(request.rows[row].format.name)
        .add(request.sweep->rays[ray].name)
        .add(request.sweep->axis.name);
}

Cell hex_cell(std::uint32_t place) { return file::hex(static_cast<double>(float_at(place))); }

void add_ends(CsvWriter& csv, const scene::sweep::FloatRange& floats) {
    csv.add(hex_cell(floats.first)).add(hex_cell(floats.last));
}

void add_outcomes(CsvWriter& csv, const ExhaustiveRequest& request, const FloatTally& tally) {
    csv.add(tally.floats());
    for (const std::uint64_t n : std::span(tally.outcomes).first(outcomes_of(request))) csv.add(n);
}

/// A ray and a form.
struct Subject {
    std::size_t ray, row;
};

void add_worst(CsvWriter& csv, const ExhaustiveRequest& request, Subject of, const FloatTally& tally) {
    if (!tally.worst) {
        for (int k = 0; k < 9; ++k) csv.add(Cell());
        return;
    }
    const auto [place, ulps] = *tally.worst;
    const FloatAnswer there = measure::sweep::answer_at(request, of.ray, of.row, place);
    csv.add(measure::truth::lost_bits(ulps, binary32.precision))
        .add(ulps)
        .add(tally.at_most)
        .add(float_at(place))
        .add(hex_cell(place))
        .add(float_bits(place))
        .add(file::hex(static_cast<double>(there.t)))
        .add(file::hex(there.truth))
        .add(explain_float(request, of.ray, of.row, place));
}

void add_wrong(CsvWriter& csv, const ExhaustiveRequest& request, Subject of, const FloatTally& tally) {
    for (const auto& wrong : {tally.first_wrong, tally.last_wrong}) {
        if (!wrong) {
            csv.add(Cell()).add(Cell()).add(Cell());
            continue;
        }
        csv.add(hex_cell(wrong->place))
            .add(float_bits(wrong->place))
            .add(measure::answer::outcome_names[static_cast<std::size_t>(wrong->outcome)]);
    }
    csv.add(tally.first_wrong ? Cell(explain_float(request, of.ray, of.row, tally.first_wrong->place)) : Cell());
    const double padding = measure::sweep::padding_max(request.rows[of.row], tally);
    csv.add(padding >= 0 ? Cell(padding) : Cell()).add(tally.padding ? hex_cell(tally.padding->place) : Cell());
}

}  // namespace

ExhaustiveFiles::ExhaustiveFiles(const ExhaustiveRequest& request, const std::filesystem::path& folder)
    : request_(request),
      folder_(folder),
      binades_(folder / "binades.csv", binade_columns(request)),
      onsets_(folder / "onsets.csv", onset_columns(request)),
      statements_(folder / "statements.csv", statement_columns(request)) {}

void ExhaustiveFiles::write_binades(const ExhaustiveState& state) {
    const auto binades = measure::sweep::binades_of(*request_.sweep);
    for (std::size_t row = 0; row < request_.rows.size(); ++row) {
        for (std::size_t ray = 0; ray < request_.sweep->rays.size(); ++ray) {
            for (std::size_t b = 0; b < binades.size(); ++b) {
                const FloatTally& tally = state.tallies[request_.place(b, ray, row)];
                add_subject(binades_, request_, ray, row);
                binades_.add(binades[b].binade.name());
                add_ends(binades_, binades[b].floats);
                add_outcomes(binades_, request_, tally);
                add_worst(binades_, request_, {ray, row}, tally);
                add_wrong(binades_, request_, {ray, row}, tally);
                binades_.end_row();
            }
        }
    }
}

void ExhaustiveFiles::write_onsets(const RangeFinding& f) {
    for (std::size_t e = 0; e < first_events.size(); ++e) {
        if (!request_.sweep->mesh && !is_of_one_solid(first_events[e])) continue;
        const bool bits = first_events[e].lost_bits > 0;
        add_subject(onsets_, request_, f.ray, f.row);
        add_ends(onsets_, f.floats);
        onsets_.add(bits ? std::string_view("lost_bits")
                         : measure::answer::outcome_names[static_cast<std::size_t>(first_events[e].outcome)]);
        onsets_.add(bits ? first_events[e].lost_bits : 1).add(f.tally.first[e].has_value());
        if (const auto bad = f.tally.first[e]) {
            const auto good = f.before(*bad);
            onsets_.add(good ? Cell(float_at(*good)) : Cell()).add(float_at(*bad));
            onsets_.add(good ? hex_cell(*good) : Cell()).add(hex_cell(*bad)).add(float_bits(*bad));
            onsets_.add(bits ? Cell(measure::sweep::answer_at(request_, f.ray, f.row, *bad).ulps) : Cell());
        } else {
            for (int k = 0; k < 6; ++k) onsets_.add(Cell());
        }
        onsets_.add(f.tally.floats());
        onsets_.add(f.tally.first[e] ? Cell(explain_float(request_, f.ray, f.row, *f.tally.first[e])) : Cell());
        onsets_.end_row();
    }
}

void ExhaustiveFiles::write_statement(const RangeFinding& f) {
    add_subject(statements_, request_, f.ray, f.row);
    add_ends(statements_, f.floats);
    add_outcomes(statements_, request_, f.tally);
    const auto good = f.tally.first_wrong ? f.before(f.tally.first_wrong->place) : std::nullopt;
    statements_.add(good ? hex_cell(*good) : Cell());
    add_wrong(statements_, request_, {f.ray, f.row}, f.tally);
    add_worst(statements_, request_, {f.ray, f.row}, f.tally);
    statements_.add(statement(request_, f));
    statements_.end_row();
}

void ExhaustiveFiles::finish(const ExhaustiveState& state, const std::vector<RangeFinding>& findings) {
    write_binades(state);
    for (const RangeFinding& finding : findings) {
        write_onsets(finding);
        write_statement(finding);
    }
    write_exhaustive_plots(folder_, request_, state);
    file::write_datapackage(
        folder_ / "datapackage.json", request_.sweep->title,
        {{"binades.csv", "One row per form, ray and binade of the axis", binade_columns(request_)},
         {"onsets.csv", "One row per form, ray, range of floats and event", onset_columns(request_)},
         {"statements.csv", "One row per form, ray and range of floats", statement_columns(request_)}});
    binades_.close();
    onsets_.close();
    statements_.close();
}

}  // namespace lostbits::output::sweep
