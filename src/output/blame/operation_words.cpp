#include "output/blame/operation_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <string_view>

#include "measure/blame/operation_error.hpp"
#include "output/file/number_text.hpp"

namespace lostbits::output::blame {

std::string short_number(double x) {
    if (std::isnan(x)) return "nan";
    if (x == 0) return "0";
    return std::fabs(x) >= 0.01 && std::fabs(x) < 1e6
               ? fmt::format("{}", file::number_in(fmt::format("{:.3g}", x)).value_or(x))
               : fmt::format("{:.2e}", x);
}

OperationWords::OperationWords(const measure::blame::Explanation& x)
    : x_(x), text_(x.tape, x.names, measure::blame::TapeText::Style::pretty), ulp_(x.ulp_of_subject()) {
    for (NodeId i = 0; i < x.tape.size(); ++i) {
        if (is_given(x.tape[i].op)) continue;
        const std::string& name = text_.name(i);
        called_[name].push_back(i);
        if (const auto n = name.size(); n > 2 && name[n - 2] == '.') called_[name.substr(0, n - 2)].push_back(i);
    }
}

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

std::vector<NodeId> OperationWords::named_in(NodeId i) const {
    const std::string& text = text_.expression(i);
    std::vector<NodeId> named;
    const auto is_part = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || std::strchr("_.'^", c); };
    for (std::size_t at = 0; at < text.size();) {
        std::size_t end = at;
        while (end < text.size() && is_part(text[end])) ++end;
        const auto found = called_.find(std::string_view(text).substr(at, end - at));
        if (found != called_.end()) named.insert(named.end(), found->second.begin(), found->second.end());
        at = std::max(end, at + 1);
    }
    return named;
}

}  // namespace lostbits::output::blame
