#include "measure/truth/truth_columns.hpp"

#include <cmath>

#include "measure/truth/missing.hpp"

namespace lostbits::measure::truth {
namespace {

template <class S>
double number(std::span<const S> column, std::size_t i) {
    return static_cast<double>(column[column.size() == 1 ? 0 : i]);
}

template <class S>
Ray<double> ray_at(const ProblemColumns<S>& p, std::size_t i) {
    const auto at = [&](std::size_t k) { return number(p.ray[k], i); };
    return {{at(0), at(1), at(2)}, {at(3), at(4), at(5)}};
}

template <class S>
Solid<double> solid_at(const ProblemColumns<S>& p, std::size_t i) {
    Solid<double> solid;
    solid.shape = p.shape;
    for (std::size_t k = 0; k < solid.used().size(); ++k) solid.numbers[k] = number(p.solid[k], i);
    return solid;
}

/// Ray i by itself, into its place in the columns.
template <class S>
void find_alone(const ProblemColumns<S>& problems, const ColumnTerms& terms, std::size_t i, TruthColumns& out) {
    const Truth truth = find_truth(ray_at(problems, i), solid_at(problems, i), terms.limit, terms.convention,
                                   problems.tmax.empty() ? HUGE_VAL : number(problems.tmax, i));
    out.decision[i] = truth.decision;
    out.hi[i] = out.lo[i] = out.bound[i] = 0;
    if (truth.is_hit()) {
        const Certified& t = terms.length == Length::parameter ? truth.t : truth.distance;
        const bool in_range = t.is_zero() || (t.exponent >= -900 && t.exponent < 900);
        const auto scaled = [&](double x) { return in_range ? std::ldexp(x, static_cast<int>(t.exponent)) : missing; };
        out.hi[i] = scaled(t.hi);
        out.lo[i] = scaled(t.lo);
        out.bound[i] = scaled(t.bound);
    }
    ++(truth.bits <= 106 ? out.stages.ball : out.stages.interval);
    out.alone.emplace_back(i, truth);
}

template <class S>
void find_columns(const ProblemColumns<S>& problems, const ColumnTerms& terms, TruthColumns& out) {
    out.decision.resize(problems.size);
    for (auto* column : {&out.hi, &out.lo, &out.bound}) column->resize(problems.size);
    out.alone.clear();
    out.stages = {};
    for (std::size_t i = 0; i < problems.size; ++i) find_alone(problems, terms, i, out);
}

}  // namespace

void find_truth_columns(const ProblemColumns<float>& problems, const ColumnTerms& terms, TruthColumns& out) {
    find_columns(problems, terms, out);
}
void find_truth_columns(const ProblemColumns<double>& problems, const ColumnTerms& terms, TruthColumns& out) {
    find_columns(problems, terms, out);
}

}  // namespace lostbits::measure::truth
