// Tables and sentences of an exhaustive sweep.
#include "output/sweep/exhaustive_files.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <bit>
#include <cmath>

#include "measure/truth/lost_bits.hpp"
#include "output/attribution/explain_command.hpp"
#include "output/image/figure.hpp"
#include "output/map/form_names.hpp"
#include "output/table/shared_columns.hpp"
#include "text/count_with_noun.hpp"

namespace lostbits::output::sweep {

using measure::answer::Outcome;
using measure::sweep::first_events;
using measure::sweep::FloatTally;
using scene::sweep::float_at;
using table::Table;

/// Answers of a form in a format, on one ray, for the floats of one range.
struct FloatsRow {
    struct WorstFloat {
        std::uint32_t float_index;
        double ulps, error_bound;
        measure::sweep::FloatAnswer answer;
    };
    /// Finds the worst float by asking the form again.
    void find_worst() {
        if (const auto& w = tally.worst)
            worst = {w->float_index, w->ulps, tally.error_bound, answer_at(request, ray, row, w->float_index)};
    }
    /// The command that explains the form on the ray at a float.
    [[nodiscard]] std::string explain(std::uint32_t float_index) const {
        const scene::rays::RayGroup group = request.sweep.group_at(ray, float_at(float_index));
        const std::string scene = request.sweep.mesh ? request.scene + " " : "";
        return attribution::explain_command(scene + attribution::explain_ray_arguments(&group),
                                            request.tested_forms[row]);
    }

    const ExhaustiveRequest& request;
    std::size_t ray, row;
    scene::sweep::FloatRange floats;
    const FloatTally& tally;
    std::optional<WorstFloat> worst = {};
    std::string binade = {}, statement = {};
    std::optional<std::string> right_up_to = {};
};

/// The first float of a range at which an event happens, if there is one.
struct FloatEventRow {
    FloatsRow floats_row;
    std::size_t event;
    std::optional<std::uint32_t> first_bad, last_good;  ///< the first float with the event, and the float before it

    [[nodiscard]] bool is_about_lost_bits() const { return first_events[event].lost_bits > 0; }
};

namespace {

/// The 32 bits of a float: `0x40400000`.
std::string float_bits(std::uint32_t float_index) {
    return fmt::format("{:#010x}", std::bit_cast<std::uint32_t>(float_at(float_index)));
}

std::string hex_of(std::uint32_t float_index) { return file::hex(static_cast<double>(float_at(float_index))); }

std::string_view outcome_name(Outcome o) { return measure::answer::outcome_names[static_cast<std::size_t>(o)]; }

/// Columns that identify a row in each table.
Table<FloatsRow> make_subject_columns() {
    using R = FloatsRow;
    Table<R> table;
    table.add(
        table::make_subject_columns(), [](const R& r) -> const auto& { return r.request.tested_forms[r.row]; });
    return table.add(
        {{"ray", "name of the ray", [](const R& r) { return r.request.sweep.rays[r.ray].name; }},
         {"axis", "name of the number that takes every float; columns in the unit of the axis are values of it",
          [](const R& r) { return r.request.sweep.axis.name; }}});
}

Table<FloatsRow> end_columns(const std::string& unit) {
    return {{"from_hex", unit, "the first float that was tried, exactly",
             [](const FloatsRow& row) { return hex_of(row.floats.first); }},
            {"to_hex", unit, "the last float that was tried, exactly",
             [](const FloatsRow& row) { return hex_of(row.floats.last); }}};
}

table::TableColumn<FloatsRow> count_column() {
    return {"floats", "number of floats that were tried, by counting",
            [](const FloatsRow& row) { return row.tally.float_count(); }};
}

/// Columns with the number of floats for each outcome that can occur.
Table<FloatsRow> make_outcome_columns(const ExhaustiveRequest& request) {
    Table<FloatsRow> table{count_column()};
    const std::size_t outcome_count =
        request.sweep.mesh ? measure::answer::outcome_names.size() : measure::answer::single_primitive_outcome_count;
    for (std::size_t o = 0; o < outcome_count; ++o)
        table.add({std::string(measure::answer::outcome_names[o]), "floats with this outcome",
                   [o](const FloatsRow& row) { return row.tally.outcomes[o]; }});
    return table;
}

Table<FloatsRow> make_worst_columns(const std::string& unit) {
    using W = FloatsRow::WorstFloat;
    Table<FloatsRow> table;
    table.add<W>(
        {// the error
         {"lost_bits_max", "bits", "lost bits of the worst float; missing if no float is a hit for both form and truth",
          [](const W& w) { return measure::truth::lost_bits(w.ulps, binary32.precision); }},
         {"worst_ulp_error", "ulp",
          "(t − t*)/ulp(t*) of the float at which it is largest in size, by the unrounded truth", &W::ulps},
         {"ulp_error_at_most", "ulp",
          "bound on the size of the error of every float: close to the worst, and above it by at most 2^-8 ulp "
          "if thousands of floats are equally bad",
          &W::error_bound},
         // the float
         {"worst_at", unit, "the worst float", [](const W& w) { return float_at(w.float_index); }},
         {"worst_hex", unit, "the worst float, exactly", [](const W& w) { return hex_of(w.float_index); }},
         {"worst_bits", "bits of the worst float", [](const W& w) { return float_bits(w.float_index); }},
         // the answer there, and the truth
         {"worst_t_hex", "t", "the form's answer at the worst float", [](const W& w) { return file::hex(w.answer.t); }},
         {"worst_truth_hex", "t", "t*, correctly rounded to binary64",
          [](const W& w) { return file::hex(w.answer.truth); }}},
        &FloatsRow::worst);
    return table.add({"worst_explain", "the command that explains the worst float",
                      [](const FloatsRow& row) { return row.worst ? row.explain(row.worst->float_index) : ""; }});
}

Table<FloatsRow> make_wrong_columns(const std::string& unit) {
    using R = FloatsRow;
    using WrongDecision = FloatTally::WrongDecision;
    Table<R> table;

    // The first and the last float with a wrong decision.
    const auto add = [&](const std::string& position, std::optional<WrongDecision> FloatTally::*member) {
        table.add<WrongDecision>(
            {{position + "_wrong_hex", unit, "the " + position + " float with a wrong decision, exactly",
              [](const WrongDecision& decision) { return hex_of(decision.float_index); }},
             {position + "_wrong_bits", "bits of that float",
              [](const WrongDecision& decision) { return float_bits(decision.float_index); }},
             {position + "_wrong_outcome", "outcome of that float",
              [](const WrongDecision& decision) { return outcome_name(decision.outcome); }}},
            [member](const R& r) -> const auto& { return r.tally.*member; });
    };
    add("first", &FloatTally::first_wrong);
    add("last", &FloatTally::last_wrong);

    // How to explain the first one, and the padding that a box would need.
    return table.add(
        {{"fault_explain", "the command that explains the first float with a wrong decision",
          [](const R& r) { return r.tally.first_wrong ? r.explain(r.tally.first_wrong->float_index) : ""; }},
         {"padding_max", "u",
          "for a form that tests a box: the largest padding of tmax that any hit it misses would need, which is the "
          "metric padding; 0 if it misses none whose slab intervals come apart",
          [](const R& r) {
              const double padding = measure::sweep::max_padding(r.request.tested_forms[r.row], r.tally);
              return table::when(padding >= 0, padding);
          }},
         {"padding_hex", unit, "the float that needs this padding, exactly", [](const R& r) {
              return r.tally.padding ? std::optional(hex_of(r.tally.padding->float_index)) : std::nullopt;
          }}});
}

Table<FloatsRow> make_binade_table(const ExhaustiveRequest& request) {
    const std::string& unit = request.sweep.axis.unit;
    return make_subject_columns()
        .add({"binade",
              "sign and power of two of its floats; zeros, subnormals, infinities and NaNs have rows of their own",
              &FloatsRow::binade})
        .add(end_columns(unit))
        .add(make_outcome_columns(request))
        .add(make_worst_columns(unit))
        .add(make_wrong_columns(unit));
}

Table<FloatsRow> make_statement_table(const ExhaustiveRequest& request) {
    const std::string& unit = request.sweep.axis.unit;
    return make_subject_columns()
        .add(end_columns(unit))
        .add(make_outcome_columns(request))
        .add({"right_up_to_hex", unit,
              "the last float before the first wrong decision; missing if no decision is wrong, or the first one is",
              &FloatsRow::right_up_to})
        .add(make_wrong_columns(unit))
        .add(make_worst_columns(unit))
        .add({"statement", "the row in words", &FloatsRow::statement});
}

Table<FloatEventRow> make_onset_table(const ExhaustiveRequest& request) {
    using R = FloatEventRow;
    const std::string& unit = request.sweep.axis.unit;
    const auto float_value = [](std::uint32_t float_index) { return float_at(float_index); };
    Table<R> table;
    table.add(make_subject_columns().add(end_columns(unit)), &R::floats_row);

    // The event.
    table.add({{"event", "the event: lost_bits reach the threshold, or an outcome occurs",
                [](const R& r) {
                    return r.is_about_lost_bits() ? std::string_view("lost_bits")
                                                  : outcome_name(first_events[r.event].outcome);
                }},
               {"threshold", "bits", "threshold of the lost bits; 1 for an outcome",
                [](const R& r) { return r.is_about_lost_bits() ? first_events[r.event].lost_bits : 1; }},
               {"found", "true if the event happens at any of the floats",
                [](const R& r) { return r.first_bad.has_value(); }}});

    // The two neighbouring floats between which it happens, as decimals, exactly and as bits.
    using P = std::uint32_t;
    table.add<P>(
        {{"last_good", unit, "the float before the event; missing if the first float is bad already", float_value}},
        &R::last_good);
    table.add<P>({{"first_bad", unit, "the first float at which it happens, the neighbour of last_good", float_value}},
                 &R::first_bad);
    table.add<P>({{"last_good_hex", unit, "last_good, exactly", hex_of}}, &R::last_good);
    table.add<P>(
        {{"first_bad_hex", unit, "first_bad, exactly", hex_of}, {"first_bad_bits", "bits of first_bad", float_bits}},
        &R::first_bad);

    // The error there, the size of the range, and the command that explains the float.
    table.add({"ulp_error", "ulp", "(t − t*)/ulp(t*) at first_bad; missing for an outcome",
               [](const R& r) -> std::optional<double> {
                   if (!r.first_bad || !r.is_about_lost_bits()) return {};
                   return answer_at(r.floats_row.request, r.floats_row.ray, r.floats_row.row, *r.first_bad).ulps;
               }});
    table.add(Table<FloatsRow>{count_column()}, &R::floats_row);
    return table.add({"explain", "the command that explains the first bad float",
                      [](const R& r) { return r.first_bad ? r.floats_row.explain(*r.first_bad) : ""; }});
}

}  // namespace

namespace {

std::string_view failure_phrase(Outcome o) {
    switch (o) {
        case Outcome::false_hit: return "a false hit";
        case Outcome::false_miss: return "a false miss";
        case Outcome::wrong_primitive: return "a hit of another triangle";
        case Outcome::crack: return "a crack";
        case Outcome::double_hit: return "a double hit";
        case Outcome::out_of_order: return "two triangles out of order";
        default: return "a hit at a t that is not a number";
    }
}

/// ` (12 crack, 3 double hit)`.
std::string kinds_text(const FloatTally& tally) {
    std::vector<std::string> kinds;
    for (const Outcome o : measure::answer::wrong_decisions) {
        if (tally.count(o) == 0) continue;
        kinds.push_back(fmt::format("{} {}", tally.count(o), map::name_in_words(outcome_name(o))));
    }
    return fmt::format(" ({})", fmt::join(kinds, ", "));
}

/// `0x1.8p+1 (3)`; a NaN with its bits: `nan (0x7fc00000)`.
std::string float_text(std::uint32_t float_index) {
    const float x = float_at(float_index);
    if (std::isnan(x)) return fmt::format("nan ({})", float_bits(float_index));
    const std::string hex = file::hex(static_cast<double>(x));
    const std::string decimal = file::decimal(x);
    return std::isinf(x) ? hex : fmt::format("{} ({})", hex, decimal);
}

/// The floats that were tried, the form, its convention and the ray: the subject of a statement.
std::string statement_subject(const ExhaustiveRequest& request, const RangeFinding& finding) {
    const auto& sweep = request.sweep;
    const FloatTally& tally = finding.tally;
    std::string text =
        fmt::format("all {} between {} and {} were tried: {}", text::count_with_noun(tally.float_count(), "float"),
                    float_text(finding.floats.first), float_text(finding.floats.last),
                    request.tested_forms[finding.row].form->info->name);
    if (const auto touching = request.tested_forms[finding.row].touching)
        text += fmt::format(", judged by the {} primitive,", intersect::convention_name(touching));
    if (sweep.rays.size() > 1) text += fmt::format(" on the ray {}", sweep.rays[finding.ray].name);
    return text;
}

}  // namespace

std::string statement(const ExhaustiveRequest& request, const RangeFinding& finding) {
    const FloatTally& tally = finding.tally;
    std::string text = statement_subject(request, finding);
    if (!tally.first_wrong)
        return text + (tally.count(Outcome::unresolved) == 0
                           ? " decides correctly for every one of them"
                           : fmt::format(" decides correctly for all but {} whose truth is not proved",
                                         tally.count(Outcome::unresolved)));

    // The first float that fails.
    const auto& wrong = *tally.first_wrong;
    const auto last_right = finding.float_before(wrong.float_index);
    text += last_right ? fmt::format(" decides correctly for every float {} {}, and first fails at {}: {}",
                                     finding.floats.falls() ? "down to" : "up to", float_text(*last_right),
                                     float_text(wrong.float_index), failure_phrase(wrong.outcome))
                       : fmt::format(" already fails at the first of them: {}", failure_phrase(wrong.outcome));

    // How often it fails, and what would help.
    text += fmt::format("; it is wrong for {} in all{}, the last at {}",
                        text::count_with_noun(tally.wrong_count(), "float"),
                        request.sweep.mesh ? kinds_text(tally) : "", float_text(tally.last_wrong->float_index));
    if (tally.padding)
        text += fmt::format("; to miss none it needs {} u more padding", file::decimal(tally.padding->u));
    return text;
}

ExhaustiveWriter::ExhaustiveWriter(const ExhaustiveRequest& request, const std::filesystem::path& folder)
    : request_(request),
      folder_(folder),
      binades_(folder, "binades.csv", "One row per form, ray and binade of the axis", make_binade_table(request)),
      statements_(folder, "statements.csv", "One row per form, ray and range of floats", make_statement_table(request)),
      onsets_(folder, "onsets.csv", "One row per form, ray, range of floats and event", make_onset_table(request)) {}

void ExhaustiveWriter::add_binades(const ExhaustiveState& state) {
    const auto binades = measure::sweep::split_into_binades(request_.sweep);
    for (std::size_t form_index = 0; form_index < request_.tested_forms.size(); ++form_index) {
        for (std::size_t ray = 0; ray < request_.sweep.rays.size(); ++ray) {
            for (std::size_t b = 0; b < binades.size(); ++b) {
                FloatsRow floats_row{request_, ray, form_index, binades[b].floats,
                                     state.tallies[request_.tally_index(b, ray, form_index)]};
                floats_row.find_worst();
                floats_row.binade = binades[b].binade.name();
                binades_.add(floats_row);
            }
        }
    }
}

void ExhaustiveWriter::add_onsets(const RangeFinding& finding) {
    for (std::size_t e = 0; e < first_events.size(); ++e) {
        if (!request_.sweep.mesh && !is_of_one_primitive(first_events[e])) continue;
        const auto first_bad = finding.tally.first_floats[e];
        onsets_.add({{request_, finding.ray, finding.row, finding.floats, finding.tally},
                     e,
                     first_bad,
                     first_bad ? finding.float_before(*first_bad) : std::nullopt});
    }
}

void ExhaustiveWriter::add_statement(const RangeFinding& finding) {
    FloatsRow floats_row{request_, finding.ray, finding.row, finding.floats, finding.tally};
    floats_row.find_worst();
    if (const auto& wrong = finding.tally.first_wrong)
        if (const auto last_right = finding.float_before(wrong->float_index))
            floats_row.right_up_to = hex_of(*last_right);
    floats_row.statement = statement(request_, finding);
    statements_.add(floats_row);
}

void ExhaustiveWriter::finish(const ExhaustiveState& state, const std::vector<RangeFinding>& findings) {
    add_binades(state);
    for (const RangeFinding& finding : findings) {
        add_onsets(finding);
        add_statement(finding);
    }
    if (const auto plots = exhaustive_plots(request_, state)) {
        image::save_figure(folder_ / "lost_bits_max.png", plot::draw_line_plot(plots->lost_bits));
        image::save_figure(folder_ / "wrong.png", plot::draw_line_plot(plots->wrong));
    }
    table::close_tables(folder_, request_.sweep.title, binades_, onsets_, statements_);
}

}  // namespace lostbits::output::sweep
