// The verdict on an explained ray: the answer, the cause of the loss, the operation to blame, and forms that do better.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "measure/attribution/explanation.hpp"
#include "measure/stability/stability.hpp"
#include "measure/tape/tape_form.hpp"
#include "output/attribution/explain_command.hpp"
#include "output/attribution/explain_text.hpp"
#include "output/attribution/operation_view.hpp"
#include "output/file/number_text.hpp"
#include "shapes/number_names.hpp"

namespace lostbits::output::attribution {

using intersect::Stop;

namespace {

/// Sentence for a form that answers yes or no.
std::string decision_sentence(const Explanation& x) {
    const Outcome o = x.result.outcome;
    const bool yes = o == Outcome::agree_hit || o == Outcome::false_hit;
    const bool right = o == Outcome::agree_hit || o == Outcome::agree_miss;
    if (!right && !yes && o != Outcome::false_miss) return "The true answer for this ray could not be proved.";
    return fmt::format("{} answers {}, {} the ray {}: a {} {}.", x.form->info->name, yes ? "yes" : "no",
                       right ? "and" : "but", x.true_t ? fmt::format("hits at {}", number_phrase(*x.true_t)) : "misses",
                       right ? "correct" : "false", yes ? "hit" : "miss");
}

std::string outcome_sentence(const Explanation& x) {
    const std::string form(x.form->info->name);
    const double t = x.result.t, true_t = x.true_t.value_or(0);
    if (!x.tells_t()) return decision_sentence(x);
    if (x.result.outcome == Outcome::wrong_primitive)
        return fmt::format("{} reports a hit at {}, on another primitive than the one that the ray meets first, at {}.",
                           form, number_phrase(t), number_phrase(true_t));
    const std::string decided = decision_text(form, x.result.outcome, t, true_t);
    if (!decided.empty()) return decided;
    if (!std::isfinite(x.result.ulps))
        return fmt::format("t is {}, the true t is {}: all {} bits lost.", number_phrase(t), number_phrase(true_t),
                           x.format.parameters.precision);
    return fmt::format("t = {} ({}), the true t is {}: {:.4g} ulp off, {:.1f} of {} bits lost.{}", file::decimal(t),
                       file::hex(t), file::decimal(true_t), x.result.ulps, x.result.lost, x.format.parameters.precision,
                       is_wrong_root(x) ? " A wrong root: the line also crosses the same primitive there." : "");
}

/// `beyond tmax = 3.9`, `before tmin = 5`; at an open end, or if the ray ends on a surface, `at tmax = 4`.
std::string outside_phrase(double t, const char* beyond, const char* name, double end, bool open) {
    if (t != end) return fmt::format("{} {} = {}", beyond, name, number_phrase(end));
    return fmt::format("at {} = {}, {}", name, number_phrase(end),
                       open ? "which is open" : "where touching is not a hit");
}

/// For a ray that misses only because of its range: where it would hit.
std::string range_sentence(const Explanation& x) {
    std::vector<std::string> lies;
    const auto add = [&](const std::optional<double>& t, const char* beyond, const char* name, double end, bool open) {
        if (t)
            lies.push_back(
                fmt::format("at t = {} lies {}", number_phrase(*t), outside_phrase(*t, beyond, name, end, open)));
    };
    add(x.before_begin, "before", "tmin", x.range.tmin, x.range.open.tmin);
    add(x.beyond_end, "beyond", "tmax", x.range.tmax, x.range.open.tmax);
    if (lies.empty()) return "";
    return fmt::format(" The exact hit {}{}.", lies.front(), lies.size() > 1 ? ", and that " + lies.back() : "");
}

/// Text for a hit of another primitive than the ray's: which one, the form's answer for the right one, and the command
/// that explains that.
std::string wrong_primitive_sentence(const Explanation& x) {
    const measure::attribution::TruePrimitive& missed = *x.missed;
    const std::string says = missed.hit ? fmt::format("a hit at {}, {}", number_phrase(missed.t),
                                                      missed.t > x.result.t ? "behind" : "which is not before")
                                        : "a miss";
    const Shape other = missed.alone.primitives.front().shape;
    const auto named = [&x](int primitive, Shape shape) {
        return x.form->is_set() ? fmt::format("{}, {}", primitive, with_article(shape)) : std::to_string(primitive);
    };
    return fmt::format(
        "The wrong primitive: the form hits primitive {}, but the ray first meets primitive {} (counted from 0). For "
        "that primitive "
        "alone it reports {}. The text below is about primitive {}; the command for the other one is: {}\n",
        named(x.primitive, x.shape), named(missed.primitive, other), says, x.primitive,
        explain_command(name_of_ray(&missed.alone), {&x.form->of(other), x.format, x.judged}));
}

/// Part of the error that is due to rounding, in ulps; NaN if that is not asked.
double rounding_ulps(const Explanation& x) {
    if (x.result.outcome != Outcome::agree_hit || !x.has_tape() || x.attribution.subject != x.tape.outputs.t)
        return NAN;
    return x.attribution.error / x.ulp_of_subject();
}

/// True if less than a bit of the loss is due to rounding: rounding makes less than an ulp, or without it more than
/// half of the error would remain.
bool rounds_little(const Explanation& x) {
    return std::fabs(rounding_ulps(x)) < std::max(1.0, std::fabs(x.result.ulps) / 2);
}

bool is_not_roundings(const Explanation& x) { return x.result.lost >= worth_saying && rounds_little(x); }

/// Three digits of a number, or the name of a number that is not finite.
std::string size_phrase(double x) { return std::isfinite(x) ? short_number(x) : number_phrase(x); }

/// Sentence on an answer that a march gave or did not reach.
std::string march_sentence(const Explanation& x, const MarchEnd& march) {
    const auto& [log, c] = march;
    const std::size_t samples = log.steps.size();
    const double d = samples > 0 ? log.steps.back().d : NAN;
    if (x.result.outcome == Outcome::agree_hit) {
        const double short_of = x.result.t - x.true_t.value_or(NAN);
        return fmt::format(
            "The march ended at sample {} of at most {}, where the field is {}: {} {} the surface. This is intended "
            "({}) and not due to rounding.",
            samples, c.max_steps, size_phrase(d), size_phrase(std::fabs(short_of)),
            short_of < 0 ? "short of" : "behind", x.form->info->title);
    }
    if (x.result.outcome != Outcome::false_miss) return "";
    switch (log.stop) {
        case Stop::max_steps:
            return fmt::format("The march used all its {} samples and was then {} away from a surface.", c.max_steps,
                               size_phrase(d));
        case Stop::stagnated:
            return fmt::format(
                "The march stood still: a step of {} does not change t in {}, so no further sample would help.",
                size_phrase(d), x.format.name);
        case Stop::max_dist: return fmt::format("The march went past max_dist = {}.", file::decimal(c.max_dist));
        case Stop::hit: break;
    }
    return "";
}

/// The cause of the loss. `envelope_sentence` weighs the problem against the formula; for a march neither may be to
/// blame.
std::string cause_sentence(const Explanation& x, const std::optional<MarchEnd>& march) {
    const bool stopped = x.result.outcome == Outcome::agree_hit && is_not_roundings(x) && x.excess() >= worth_saying;
    if (march && (stopped || x.result.outcome == Outcome::false_miss)) {
        const std::string sentence = march_sentence(x, *march);
        if (!sentence.empty()) return sentence;
    }
    return envelope_sentence(x);
}

/// Text for a hit of another primitive than the ray meets first that rounding caused.
std::string turned_order_sentence(const Explanation& x) {
    const measure::attribution::Attribution& a = x.attribution;
    const auto exactly = [](bool hit, double t) {
        return hit ? fmt::format("is hit at {}", number_phrase(t)) : std::string("is missed");
    };
    const std::string order =
        fmt::format("Rounding changed which primitive comes first: without it primitive {} {}, and primitive {} {}.",
                    x.missed->primitive, exactly(true, x.missed->exact_t), x.primitive,
                    exactly(a.exact_hit, a[x.tape.outputs.t].exact));
    return order + (culprit_operation(x) == no_node
                        ? fmt::format(" The larger error is that of primitive {}, which the command above explains.",
                                      x.missed->primitive)
                        : " " + culprit_sentence(x));
}

/// Reason why no operation is to blame for the decision or the loss.
std::string no_blame_sentence(const Explanation& x, bool marches) {
    const measure::attribution::Attribution& a = x.attribution;
    const bool hit = x.result.outcome == Outcome::agree_hit, right = x.result.is_right();
    const bool turned = x.hit != a.exact_hit && !a.cut_short;
    if (right && turned)
        return fmt::format("No operation is to blame: the decision is right. Without rounding the form would {}.",
                           a.exact_hit ? "hit" : "miss");
    if (!x.tells_t() && right) return "No operation is to blame: the decision is right.";
    if (a.subject == no_node || a.culprit == no_node) return culprit_sentence(x);
    if (x.result.outcome == Outcome::not_a_number && std::isnan(x.tape[a.culprit].value)) return culprit_sentence(x);
    if (x.hit != a.exact_hit && a.cut_short)
        return "No single operation is to blame: without rounding the march would have gone on.";
    if (!hit && turned) return "The true answer is not proved, so no operation is to blame.";
    if (!hit) return "The decision is the same without rounding, so no operation is to blame.";
    if (!std::isfinite(x.tape[a.culprit].value)) return culprit_sentence(x);
    if (x.result.lost < worth_saying) return "No operation is to blame: less than a bit is lost.";
    if (!rounds_little(x)) return "No operation is to blame: none of the roundings reaches t.";
    const bool inputs = x.rounded_inputs && !(x.excess() >= worth_saying);
    const char* const rest = x.missed  ? "the answer is for another primitive"
                             : inputs  ? "the rest comes from inputs that the format cannot hold"
                             : marches ? "the rest comes from where the march ended"
                                       : "the rest comes from what the form assumes";
    const std::string all = ulps_or_nothing(x.result.ulps);
    return fmt::format("No operation is to blame: rounding inside the form causes {}{}, and {}.",
                       short_number(rounding_ulps(x)), all.empty() ? " ulp" : " of the " + all, rest);
}

/// The culprit, or why there is none.
std::string culprit_paragraph(const Explanation& x, bool marches) {
    if (!x.has_tape())
        return "Its operations are not known, because a compiled function is a black box; write it as a form over any "
               "number to see them (docs/your-own-form.md).";
    if (x.missed && x.rounding_turned_order()) return turned_order_sentence(x);
    if (culprit_operation(x) == no_node) return no_blame_sentence(x, marches);
    const std::string alone = counterfactual_sentence(x);
    return culprit_sentence(x) + (alone.empty() ? "" : " " + alone);
}

/// `a correct miss`, `4.6 bits lost`.
std::string outcome_text(const measure::attribution::FormResult& s) {
    switch (s.outcome) {
        case Outcome::agree_hit: return std::isnan(s.lost) ? "a correct hit" : fmt::format("{:.1f} bits lost", s.lost);
        case Outcome::agree_miss: return "a correct miss";
        case Outcome::false_hit: return "a false hit";
        case Outcome::false_miss: return "a false miss";
        case Outcome::not_a_number: return "a hit at NaN";
        case Outcome::wrong_primitive: return "a hit of the wrong primitive";
        case Outcome::crack: return "a crack in the mesh";
        case Outcome::double_hit: return "a double hit";
        case Outcome::wrong_neighbour: return "a hit of the neighbouring triangle";
        case Outcome::out_of_order: return "two triangles out of order";
        case Outcome::unresolved: break;
    }
    return "its true answer could not be proved";
}

/// Forms named with `--beside` that are not already listed as better.
std::string beside_sentences(const Explanation& x, const std::vector<const intersect::table::Intersector*>& told) {
    std::string text;
    for (const measure::attribution::FormResult& s : x.compared) {
        const auto& name = s.form->info->name;
        if (s.other_question)
            text += fmt::format(
                "{} has another contract, so another answer is right for this ray. By its own contract: {}.\n", name,
                outcome_text(s));
        else if (std::ranges::find(told, s.form) == told.end())
            text += fmt::format("{} does no better on this ray and around it{}: {}.\n", name,
                                s.lost_nearby < x.result.lost_nearby ? ", by a bit or more" : "", outcome_text(s));
    }
    for (const auto* form : x.not_comparable)
        text += !(form->shapes() == x.form->shapes())
                    ? fmt::format("{} is a form for another shape, so it was not tried.\n", form->info->name)
                    : fmt::format("{} does not exist in {}, so it was not tried.\n", form->info->name, x.format.name);
    return text;
}

}  // namespace

std::string better_sentences(const Explanation& x) {
    std::string text;
    constexpr std::size_t most = 6;
    std::vector<const intersect::table::Intersector*> told;
    std::size_t left = 0;
    const std::string around = x.pixels_around > 0
                                   ? fmt::format("{} pixels around it", x.pixels_around)
                                   : fmt::format("{} rays around it, with each number within an ulp of its own value",
                                                 measure::attribution::neighbours);
    for (const measure::attribution::FormResult& s : x.better) {
        if (x.result.is_right() && !(x.result.lost_nearby - s.lost_nearby >= worth_saying)) continue;
        const bool named =
            std::ranges::find(x.compared, s.form, &measure::attribution::FormResult::form) != x.compared.end();
        if (told.size() >= most && !named) {
            ++left;
            continue;
        }
        text += fmt::format("{} {} ({}, {:.1f} around)", told.empty() ? "" : ",", s.form->info->name, outcome_text(s),
                            s.lost_nearby);
        told.push_back(s.form);
    }
    if (told.empty())
        text = fmt::format("No other form that was tried does better on this ray in this format and around it{}.\n",
                           x.better.empty() ? "" : ", by a bit or more");
    else
        text = fmt::format(
            "Better on this ray and around it:{}{}.\nOn {}, {} loses {:.1f} bits on average; a wrong decision counts "
            "as all {}.\n",
            text, left > 0 ? fmt::format(" and {} more", left) : "", around, x.form->info->name, x.result.lost_nearby,
            x.format.parameters.precision);
    return text + beside_sentences(x, told);
}

std::string decision_text(const std::string& form, Outcome outcome, double t, double true_t) {
    switch (outcome) {
        case Outcome::agree_miss: return form + " misses, and so does the exact ray: a correct miss.";
        case Outcome::false_hit:
            return fmt::format("{} reports a hit at {}, but the ray misses: a false hit.", form, number_phrase(t));
        case Outcome::false_miss:
            return fmt::format("{} reports a miss, but the ray hits at {}: a false miss.", form, number_phrase(true_t));
        case Outcome::not_a_number: return form + " reports a hit at NaN.";
        case Outcome::unresolved: return "The true answer for this ray could not be proved.";
        default: return "";  // outcomes of a whole mesh: the explained answer is that of one primitive
    }
}

bool is_wrong_root(const Explanation& x) {
    const bool far_off = x.result.outcome == Outcome::agree_hit && std::fabs(x.result.ulps) > 8;
    if (!far_off || !x.true_t || !is_primitive(x.form->shape) || x.missed) return false;
    const Primitive<double> primitive(x.shape);
    const std::size_t ends = x.range.is_whole() ? 1 : 2;
    if (x.inputs.size() != 6 + primitive.used().size() + ends) return false;  // under a matrix
    return measure::stability::is_wrong_root(measure::tape::ray_of(x.inputs),
                                             measure::tape::primitive_of(x.inputs, primitive),
                                             measure::truth::exactly(*x.true_t), x.result.t);
}

NodeId culprit_operation(const Explanation& x) {
    const measure::attribution::Attribution& a = x.attribution;
    if (a.subject == no_node || a.culprit == no_node || measure::attribution::is_plain_miss(x.tape, a)) return no_node;
    const Outcome outcome = x.result.outcome;
    const bool of_decision = is_decision(x.tape[a.subject].op), lost = x.result.lost >= worth_saying;
    const bool overflowed = !std::isfinite(x.tape[a.culprit].value);
    if (outcome == Outcome::unresolved || (a[a.culprit].contribution == 0 && !overflowed)) return no_node;
    bool blamed = false;
    if (of_decision) blamed = !x.result.is_right();
    else if (outcome == Outcome::agree_hit) blamed = lost && (overflowed || !rounds_little(x));
    else if (outcome == Outcome::wrong_primitive && x.rounding_turned_order() && a.exact_hit)
        blamed = std::fabs(a.error) >= std::fabs(x.missed->hit ? x.missed->t - x.missed->exact_t : HUGE_VAL);
    else blamed = overflowed && outcome == Outcome::not_a_number && !std::isnan(a[a.culprit].exact);
    return blamed ? a.culprit : no_node;
}

bool rounding_explains(const Explanation& x) { return std::fabs(x.result.ulps - rounding_ulps(x)) <= 1; }

/// Outcome for all triangles of a mesh together, as in a map: docs/meshes.md.
std::string mesh_sentence(const Explanation& x) {
    switch (x.in_mesh.value_or(Outcome::agree_hit)) {
        case Outcome::crack:
            return "In the mesh this is a crack: the form claims neither the triangle that the ray meets first nor a "
                   "neighbour of it, and the number of crossings is wrong by an odd number.\n";
        case Outcome::double_hit:
            return "In the mesh this is a double hit: the form also claims a neighbouring triangle, although the ray "
                   "crosses "
                   "the mesh once.\n";
        case Outcome::wrong_neighbour:
            return "In the mesh this is a wrong neighbour, which is not a wrong decision: the triangles share a "
                   "vertex.\n";
        case Outcome::out_of_order:
            return "In the mesh this is out of order: the form claims a triangle that the ray truly meets before this "
                   "one, but its t there is not the smaller one.\n";
        case Outcome::agree_hit:
            return x.in_mesh ? "In the mesh this is a correct hit: the ray meets both triangles at the same t.\n" : "";
        default: return "";
    }
}

std::string ExplainedVerdict::text() const { return answer + "\n" + loss + "\n" + blame + "\n"; }

ExplainedVerdict verdict_of(const Explanation& x, const std::optional<MarchEnd>& march) {
    std::string answer = outcome_sentence(x) + range_sentence(x) + "\n" +
                         (x.missed ? wrong_primitive_sentence(x) : "") + mesh_sentence(x);
    answer.pop_back();
    return {.answer = std::move(answer),
            .loss = cause_sentence(x, march),
            .blame = culprit_paragraph(x, march.has_value()),
            .culprit = culprit_operation(x)};
}

}  // namespace lostbits::output::attribution
