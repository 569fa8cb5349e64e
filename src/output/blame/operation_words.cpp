#include "output/blame/operation_words.hpp"

#include <fmt/format.h>

#include <cmath>

#include "measure/blame/operation_error.hpp"

namespace lostbits::output::blame {

std::string short_number(double x) {
    if (std::isnan(x)) return "nan";
    if (x == 0) return "0";
    return std::fabs(x) >= 0.01 && std::fabs(x) < 1e6 ? fmt::format("{}", std::stod(fmt::format("{:.3g}", x)))
                                                      : fmt::format("{:.2e}", x);
}

OperationWords::OperationWords(const measure::blame::Explanation& x)
    : x_(x), text_(x.tape, x.names, measure::blame::TapeText::Style::pretty), ulp_(x.ulp_of_subject()) {}

double OperationWords::own_ulps(NodeId i, double error) const {
    return error / measure::blame::ulp_at(of(i).exact == 0 ? x_.tape[i].value : of(i).exact, x_.tape.format_of(i));
}

std::string OperationWords::cancellation(NodeId i) const {
    const int bits = of(i).cancelled;
    return bits == 0 ? "" : fmt::format("{} {}", bits, of(i).carried ? "catastrophic" : "benign");
}

bool OperationWords::is_shown(NodeId i, bool all) const {
    const TapeNode& n = x_.tape[i];
    if (all) return is_operation(n.op);
    if (!is_operation(n.op) || !of(i).live) return false;
    return !n.label.empty() || of(i).rounding != 0 || of(i).cancelled > 1 || i == x_.attribution.culprit;
}

}  // namespace lostbits::output::blame
