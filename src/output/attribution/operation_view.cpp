#include "output/attribution/operation_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <string_view>

#include "measure/attribution/operation_error.hpp"
#include "output/attribution/explain_text.hpp"
#include "output/file/number_text.hpp"

namespace lostbits::output::attribution {

std::string short_number(double x) {
    if (std::isnan(x)) return "nan";
    if (x == 0) return "0";
    return std::fabs(x) >= 0.01 && std::fabs(x) < 1e6
               ? fmt::format("{}", file::number_in(fmt::format("{:.3g}", x)).value_or(x))
               : fmt::format("{:.2e}", x);
}

std::string number_phrase(double x) {
    if (std::isnan(x)) return "not a number";
    if (std::isinf(x)) return x < 0 ? "minus infinity" : "infinity";
    return file::decimal(x);
}

std::string ulps_or_nothing(double ulps) { return std::isfinite(ulps) ? short_number(ulps) + " ulp" : ""; }

namespace {

std::vector<bool> nodes_on_way(const Explanation& x) {
    std::vector<bool> on_way(x.tape.nodes.size());
    const auto mark = [&on_way](NodeId i) {
        if (i != no_node) on_way[static_cast<std::size_t>(i)] = true;
    };
    mark(x.tape.outputs.hit);
    if (x.hit || x.tape.outputs.hit == no_node) mark(x.tape.outputs.t);
    for (NodeId i = x.tape.size() - 1; i >= 0; --i) {
        if (x.attribution[i].live) mark(i);
        if (!on_way[static_cast<std::size_t>(i)]) continue;
        const TapeNode& n = x.tape[i];
        if (n.op != TapeOp::select) {
            std::ranges::for_each(x.tape.operands_of(i), mark);
        } else {
            mark(n.operands[0]);
            mark(measure::attribution::side_taken(x.tape, i));
        }
    }
    return on_way;
}

}  // namespace

OperationView::OperationView(const Explanation& x)
    : x_(x),
      text_(x.tape, x.names, measure::attribution::TapeText::Style::pretty),
      ulp_(x.ulp_of_subject()),
      on_way_(nodes_on_way(x)) {
    for (NodeId i = 0; i < x.tape.size(); ++i) {
        if (is_given(x.tape[i].op)) continue;
        const std::string& name = text_.name(i);
        called_[name].push_back(i);
        if (const auto n = name.size(); n > 2 && name[n - 2] == '.') called_[name.substr(0, n - 2)].push_back(i);
    }
}

double OperationView::ulps_of_value(NodeId i, double error) const {
    return error /
           measure::attribution::ulp_at(of(i).exact == 0 ? x_.tape[i].value : of(i).exact, x_.tape.format_of(i));
}

std::string OperationView::cancellation(NodeId i) const {
    const int bits = of(i).cancelled;
    return bits == 0 ? "" : fmt::format("{} {}", bits, of(i).carried ? "catastrophic" : "benign");
}

bool OperationView::is_shown(NodeId i, bool all) const {
    const TapeNode& n = x_.tape[i];
    if (all) return is_operation(n.op);
    if (!is_operation(n.op) || !of(i).live) return false;
    return !n.label.empty() || of(i).rounding != 0 || of(i).cancelled > 1 || i == x_.attribution.culprit;
}

std::vector<NodeId> OperationView::named_in(NodeId i) const {
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

std::string OperationView::subject() const {
    const NodeId subject = x_.attribution.subject;
    if (subject == no_node || !is_decision(x_.tape[subject].op)) return "t";
    const TapeNode& n = x_.tape[subject];
    if (!is_comparison(n.op)) return "decision";
    for (const std::size_t k : {0U, 1U}) {
        if (x_.tape[n.operands[k]].op == TapeOp::constant) return text_.operand(n.operands[1 - k]);
    }
    return text_.expression(subject);
}

int digits_of(const FloatFormat& format) { return 1 + static_cast<int>(std::ceil(format.precision * 0.30103)); }

namespace {

OperationRow row_of(const Explanation& x, const OperationView& words, NodeId i, bool whole) {
    const measure::attribution::OperationError& e = words.of(i);
    const TapeNode& n = x.tape[i];
    const bool decides = is_decision(n.op);
    OperationRow row{.node = i,
                     .has_errors = whole,
                     .name = words.text().name(i),
                     .formula = whole ? words.text().expression(i) : "(an earlier sample)",
                     .computed = n.value,
                     .exact = e.exact,
                     .digits = decides ? 0 : digits_of(x.tape.format_of(i))};
    if (!whole) return row;
    row.culprit = i == culprit_operation(x);
    row.branch_flipped = e.turned && (decides || e.rounding != 0);
    row.off_path = !decides && !words.is_on_way(i);
    row.on_purpose = measure::attribution::is_on_purpose(n.op) && e.rounding != 0;
    if (decides) return row;
    const auto number = [](double ulps) { return std::isfinite(ulps) ? short_number(ulps) : ""; };
    row.error_ulps = number(words.ulps_of_value(i, e.error));
    row.cancelled = words.cancellation(i);
    if (e.local_bits != 0) row.local = fmt::format("{:.1f}", e.local_bits);
    if (e.rounding != 0) row.rounding_ulps = number(words.ulps_of_value(i, e.rounding));
    if (e.live && e.rounding != 0) row.contribution_ulps = number(words.contribution(i));
    return row;
}

/// The first node that the table shows. For a march it begins with the last samples, unless all are asked for.
NodeId first_shown(const Explanation& x, bool all) {
    const auto& samples = x.tape.samples;
    return all || samples.size() < 3 ? 0 : static_cast<NodeId>(samples[samples.size() - 3]);
}

}  // namespace

OperationTable operation_table(const Explanation& x, const OperationView& words, bool all) {
    OperationTable table{.first = first_shown(x, all)};
    // A row names other operations, and each of them has a row too. The last operations are visited first.
    std::vector<bool> shown(x.tape.nodes.size()), whole(x.tape.nodes.size());
    for (NodeId i = x.tape.size() - 1; i >= 0; --i) {
        const auto place = static_cast<std::size_t>(i);
        whole[place] = i == culprit_operation(x) || (i >= table.first && (shown[place] || words.is_shown(i, all)));
        shown[place] = shown[place] || whole[place];
        if (!whole[place]) continue;
        for (const NodeId named : words.named_in(i)) shown[static_cast<std::size_t>(named)] = true;
    }
    for (NodeId i = 0; i < x.tape.size(); ++i) {
        const auto place = static_cast<std::size_t>(i);
        if (shown[place]) table.rows.push_back(row_of(x, words, i, whole[place]));
    }
    return table;
}

}  // namespace lostbits::output::attribution
