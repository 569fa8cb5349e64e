#include "output/blame/verdict_text.hpp"

#include <fmt/format.h>

#include <cmath>

#include "output/blame/culprit_text.hpp"
#include "output/blame/explain_command.hpp"
#include "output/blame/explain_text.hpp"
#include "output/blame/operation_words.hpp"
#include "output/file/number_text.hpp"

namespace lostbits::output::blame {

using intersect::Stop;
using measure::answer::Outcome;
using measure::blame::Explanation;

namespace {

std::string outcome_sentence(const Explanation& x) {
    const std::string form(x.form->info->name);
    switch (x.standing.outcome) {
        case Outcome::agree_miss: return fmt::format("{} misses, and so does the exact ray: a correct miss.", form);
        case Outcome::false_hit:
            return fmt::format("{} reports a hit at {}, but the ray misses: a false hit.", form,
                               file::decimal(x.standing.t));
        case Outcome::false_miss:
            return fmt::format("{} reports a miss, but the ray hits at {}: a false miss.", form,
                               file::decimal(x.true_t.value_or(0)));
        case Outcome::not_a_number: return fmt::format("{} reports a hit at NaN.", form);
        case Outcome::unresolved: return "The true answer for this ray could not be proved.";
        case Outcome::wrong_object:
            return fmt::format("{} reports a hit at {}, on another solid than the ray meets first, at {}.", form,
                               file::decimal(x.standing.t), file::decimal(x.true_t.value_or(0)));
        case Outcome::agree_hit: break;
    }
    return fmt::format("t = {} ({}), the true t is {}: {:.4g} ulp off, {:.1f} of {} bits lost.",
                       file::decimal(x.standing.t), file::hex(x.standing.t), file::decimal(x.true_t.value_or(0)),
                       x.standing.ulps, x.standing.lost, x.format.shape.precision);
}

/// The form hits another solid than the ray: which, what it says of the right one, and how to look at that.
std::string wrong_solid_sentence(const Explanation& x) {
    const measure::blame::TrueSolid& missed = *x.missed;
    const std::string says = missed.hit ? fmt::format("a hit at {}, {}", file::decimal(missed.t),
                                                      missed.t > x.standing.t ? "behind" : "which is not before")
                                        : "a miss";
    return fmt::format(
        "The wrong solid: the form hits solid {}, but the ray first meets solid {} (counted from 0). Of that solid "
        "alone it reports {}. What follows is about solid {}; the other one: {}\n",
        x.solid, missed.solid, says, x.solid,
        explain_command(name_of_ray(&missed.alone), {x.form, x.format, x.judged}));
}

/// How much of the error is rounding's, in ulps; NaN where that is not asked.
double rounding_ulps(const Explanation& x) {
    if (x.standing.outcome != Outcome::agree_hit || !x.has_tape() || x.attribution.subject != x.tape.outputs.t)
        return NAN;
    return x.attribution.error / x.ulp_of_subject();
}

/// Whether rounding inside the form is less than a bit of what is lost.
bool is_not_roundings(const Explanation& x) {
    return x.standing.lost >= worth_saying && std::fabs(rounding_ulps(x)) < 1;
}

/// Of an answer that a march gave, or did not reach.
std::string march_sentence(const Explanation& x, const MarchEnd& march) {
    const auto& [log, c] = march;
    const std::size_t samples = log.steps.size();
    const double d = samples > 0 ? log.steps.back().d : NAN;
    if (x.standing.outcome == Outcome::agree_hit) {
        const double short_of = x.standing.t - x.true_t.value_or(NAN);
        return fmt::format(
            "The march ended at sample {} of at most {}, where the field is {}: {} {} the surface, which is how it is "
            "meant ({}), not what rounding lost.",
            samples, c.max_steps, short_number(d), short_number(std::fabs(short_of)),
            short_of < 0 ? "short of" : "behind", x.form->info->title);
    }
    if (x.standing.outcome != Outcome::false_miss) return "";
    switch (log.stop) {
        case Stop::max_steps:
            return fmt::format("The march used all its {} samples and was {} away from a surface then.", c.max_steps,
                               short_number(d));
        case Stop::stagnated:
            return fmt::format(
                "The march stood still: a step of {} does not change t in {}, so that no further sample would help.",
                short_number(d), x.format.name);
        case Stop::max_dist: return fmt::format("The march went past max_dist = {}.", file::decimal(c.max_dist));
        case Stop::hit: break;
    }
    return "";
}

/// Whose the loss is. `verdict` holds the problem against the formula; of a march neither may be to blame.
std::string whose_loss(const Explanation& x, const std::optional<MarchEnd>& march) {
    const bool stopped = x.standing.outcome == Outcome::agree_hit && is_not_roundings(x) && x.excess() >= worth_saying;
    if (march && (stopped || x.standing.outcome == Outcome::false_miss)) {
        const std::string sentence = march_sentence(x, *march);
        if (!sentence.empty()) return sentence;
    }
    return verdict(x);
}

/// The culprit, or why there is none to name.
std::string blame_sentence(const Explanation& x, bool marches) {
    if (!x.has_tape())
        return "Its operations cannot be looked at, since it is compiled elsewhere; written as a form over any number "
               "they can (docs/your-own-form.md).";
    if (names_culprit(x)) return culprit_sentence(x);
    const bool hit = x.standing.outcome == Outcome::agree_hit;
    if (!hit || x.attribution.subject == no_node || x.attribution.culprit == no_node) {
        const bool silent = x.attribution.culprit != no_node;
        return silent ? "The decision is the same without rounding, so no operation is to blame." : culprit_sentence(x);
    }
    if (x.standing.lost < worth_saying) return "No operation is to blame: what is lost is less than a bit.";
    const double rounding = rounding_ulps(x);
    if (!(std::fabs(rounding) < 1)) return "No operation is to blame: none of their roundings reaches t.";
    const char* const rest = x.missed           ? "the answer is of another solid"
                             : x.rounded_inputs ? "the rest comes from inputs that the format cannot hold"
                             : marches          ? "the rest is where the march ended"
                                                : "the rest is there without it, from what the form assumes";
    return fmt::format("No operation is to blame: rounding inside the form makes {} of the {} ulp, and {}.",
                       short_number(rounding), short_number(x.standing.ulps), rest);
}

std::string better_sentence(const Explanation& x) {
    std::string text;
    constexpr std::size_t most = 6;
    std::size_t told = 0, left = 0;
    for (const measure::blame::Standing& s : x.better) {
        if (x.standing.is_right() && !(x.standing.lost - s.lost >= worth_saying)) continue;
        if (told == most) {
            ++left;
            continue;
        }
        text +=
            fmt::format("{} {} ({})", told++ ? "," : "", s.form->info->name,
                        s.outcome == Outcome::agree_hit ? fmt::format("{:.1f} bits lost", s.lost) : "a correct miss");
    }
    if (told == 0)
        return fmt::format("No other form that was asked does better on this ray in this format{}.\n",
                           x.better.empty() ? "" : ", by a bit or more");
    return "Better on this ray:" + text + (left > 0 ? fmt::format(" and {} more.\n", left) : ".\n");
}

}  // namespace

bool names_culprit(const Explanation& x) {
    const measure::blame::Attribution& a = x.attribution;
    if (a.subject == no_node || a.culprit == no_node || measure::blame::is_plain_miss(x.tape, a)) return false;
    const measure::blame::OperationError& e = a.of[static_cast<std::size_t>(a.culprit)];
    if (!std::isfinite(x.tape[a.culprit].value)) return true;
    if (e.contribution == 0) return false;
    if (is_decision(x.tape[a.subject].op)) return true;
    return x.standing.outcome == Outcome::agree_hit && x.standing.lost >= worth_saying &&
           !(std::fabs(rounding_ulps(x)) < 1);
}

bool rounding_explains(const Explanation& x) { return std::fabs(x.standing.ulps - rounding_ulps(x)) <= 1; }

std::string verdict_text(const Explanation& x, const std::optional<MarchEnd>& march) {
    return outcome_sentence(x) + "\n" + (x.missed ? wrong_solid_sentence(x) : "") + whose_loss(x, march) + "\n" +
           blame_sentence(x, march.has_value()) + "\n" + better_sentence(x);
}

}  // namespace lostbits::output::blame
