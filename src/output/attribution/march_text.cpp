// A march as a table of text.
#include <fmt/format.h>

#include "measure/truth/lost_bits.hpp"
#include "output/attribution/explain_text.hpp"
#include "output/file/number_text.hpp"

namespace lostbits::output::attribution {

using intersect::table::MarchLog;

namespace {

std::string answer_line(const intersect::table::Intersector& form, const Format& format,
                        const measure::answer::OneRay& ray, const MarchLog& log) {
    const measure::truth::Truth& truth = ray.find_truth(*form.info);
    const bool truly_hits = truth.decision == measure::truth::Truth::Decision::hit;
    const double true_t = truly_hits ? ray.rounded_truth(*form.info, binary64) : 0;
    const Outcome outcome = measure::answer::classify(truth.decision, log.hit.hit, log.hit.t);
    const std::string decision_line = decision_text("The form", outcome, log.hit.t, true_t);
    if (!decision_line.empty()) return decision_line;

    const measure::truth::CertifiedNumber& t = ray.true_t(*form.info);
    const double ulps = measure::truth::ulp_error(log.hit.t, t, format.parameters);
    return fmt::format(
        "The form reports a hit at {} ({}), and the true hit is at {}: {:.4g} ulp off, {:.1f} of {} bits lost.",
        file::decimal(log.hit.t), file::hex(log.hit.t), file::decimal(true_t), ulps,
        measure::truth::lost_bits(ulps, format.parameters.precision), format.parameters.precision);
}

/// Action at a sample: `hit`, `step by d`, `no step: t + d = t`, `miss: t > max_dist`, `miss: all n samples are used`
/// (after `no step: t + d = t; ` if the march stands still: `StopReason::stagnated`).
std::string action_of(const MarchLog& log, std::size_t step, const intersect::MarchConstants<double>& constants) {
    if (step + 1 < log.steps.size())
        return log.steps[step].is_stagnant ? "no step: t + d = t"
                                           : fmt::format("step by {:.4g}", log.steps[step + 1].t - log.steps[step].t);
    switch (log.stop) {
        case intersect::StopReason::hit: return "hit";
        case intersect::StopReason::max_dist: return fmt::format("miss: t > {}", file::decimal(constants.max_dist));
        case intersect::StopReason::stagnated:
            return fmt::format("no step: t + d = t; miss: all {} samples are used", constants.max_steps);
        case intersect::StopReason::max_steps: break;
    }
    return fmt::format("miss: all {} samples are used", constants.max_steps);
}

}  // namespace

std::optional<MarchEnd> find_march_end(const intersect::table::Intersector& form, const Format& format,
                                       const measure::answer::OneRay& ray) {
    if (!form.log) return {};
    return MarchEnd{measure::answer::record_march(form, format, ray),
                    ray.inputs(form, format).format_inputs.march.value()};
}

std::string march_samples(const MarchEnd& march, const Format& format) {
    const auto& [log, constants] = march;
    const int digits = digits_of(format.parameters), width = digits + 7;
    std::string text = fmt::format(
        "hit_eps {}, max_steps {}, max_dist {}, relative_eps {}, cone {}, over_relaxation {}\n\n",
        file::decimal(constants.hit_eps), constants.max_steps, file::decimal(constants.max_dist),
        file::decimal(constants.relative_eps), file::decimal(constants.cone), file::decimal(constants.over_relaxation));

    text += fmt::format("{0:>4} {2:>{1}} {3:>{1}} {4:>{1}} {5:>{1}} {6:>{1}} {7:>{1}}  {8}\n", "i", width, "t", "x",
                        "y", "z", "|p|", "d", "action");
    for (std::size_t i = 0; i < log.steps.size(); ++i) {
        const intersect::MarchStep& s = log.steps[i];
        const auto number = [&](double x) { return fmt::format("{:>{}.{}g}", x, width, digits); };
        text += fmt::format("{:>4} {} {} {} {} {} {}  {}\n", i, number(s.t), number(s.p.x), number(s.p.y),
                            number(s.p.z), number(s.size), number(s.d), action_of(log, i, constants));
    }
    return text;
}

std::string march_table(const intersect::table::Intersector& form, const Format& format,
                        const measure::answer::OneRay& ray) {
    const auto inputs = ray.inputs(form, format);
    const MarchEnd march{measure::answer::record_march(form, format, ray), inputs.format_inputs.march.value()};
    const Ray<double> r = inputs.ray(*form.info);
    return fmt::format("{} in {}\norigin    ({}, {}, {})\ndirection ({}, {}, {})\n{}\n{}\n", form.info->name,
                       format.name, file::hex(r.origin.x), file::hex(r.origin.y), file::hex(r.origin.z),
                       file::hex(r.direction.x), file::hex(r.direction.y), file::hex(r.direction.z),
                       march_samples(march, format), answer_line(form, format, ray, march.log));
}

}  // namespace lostbits::output::attribution
