#include "measure/evaluate/outcome_columns.hpp"

#include <algorithm>
#include <array>

#include "measure/truth/missing.hpp"

namespace lostbits::measure::evaluate {

using answer::Outcome;
using truth::missing;
using truth::Truth;

namespace {

/// Every case of the three things that an outcome depends on, so that no ray has to wait for a branch.
class Cases {
public:
    explicit Cases(bool tells_t) {
        for (const auto decision : {Truth::Decision::miss, Truth::Decision::hit, Truth::Decision::unresolved})
            for (const bool met : {false, true})
                for (const double t : {0.0, missing})
                    cases_[place(decision, met, t)] = answer::classify(decision, met, tells_t ? t : 0);
    }
    [[nodiscard]] Outcome of(Truth::Decision decision, bool met, double t) const {
        return cases_[place(decision, met, t)];
    }

private:
    static std::size_t place(Truth::Decision decision, bool met, double t) {
        return 4 * static_cast<std::size_t>(decision) + 2 * static_cast<std::size_t>(met) +
               static_cast<std::size_t>(t != t);
    }
    std::array<Outcome, 12> cases_;
};

}  // namespace

void find_outcomes(const answer::BandAnswers& of, const columns::TrueLengths& truth, bool tells_t,
                   const OutcomeColumns& out, FormSummary& summary) {
    const answer::Answers& answers = of.answers;
    const std::size_t n = truth.decision.size();
    const Cases cases(tells_t);
    out.measured.resize(n);
    std::uint64_t true_hits = 0;
    Outcome* const outcomes = out.outcomes.data();
    double* const measured = out.measured.data();
    for (std::size_t i = 0; i < n; ++i) outcomes[i] = cases.of(truth.decision[i], answers.hit[i] != 0, answers.t[i]);
    for (std::size_t i = 0; i < n; ++i) {
        const bool other = tells_t & (outcomes[i] == Outcome::agree_hit) & (answers.object[i] != truth.object[i]);
        outcomes[i] = other ? Outcome::wrong_object : outcomes[i];
    }
    if (tells_t) take_meshes_apart(of, truth, out.outcomes);
    for (std::size_t i = 0; i < n; ++i) {
        measured[i] = (tells_t & (outcomes[i] == Outcome::agree_hit)) ? answers.t[i] : missing;
    }
    for (const Truth::Decision decision : truth.decision)
        true_hits += static_cast<std::uint64_t>(decision == Truth::Decision::hit);
    for (std::size_t o = 0; o < summary.outcomes.size(); ++o)
        summary.outcomes[o] += static_cast<std::uint64_t>(std::ranges::count(out.outcomes, static_cast<Outcome>(o)));
    summary.true_hits += true_hits;
    summary.rays += n;
}

}  // namespace lostbits::measure::evaluate
