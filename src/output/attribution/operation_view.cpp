// Names and numbers of explained operations, and the rows of their table.
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
               ? fmt::format("{}", file::parse_number(fmt::format("{:.3g}", x)).value_or(x))
               : fmt::format("{:.2e}", x);
}

std::string number_phrase(double x) {
    if (std::isnan(x)) return "not a number";
    if (std::isinf(x)) return x < 0 ? "minus infinity" : "infinity";
    return file::decimal(x);
}

std::string ulps_or_nothing(double ulps) { return std::isfinite(ulps) ? short_number(ulps) + " ulp" : ""; }

namespace {

std::vector<bool> nodes_on_path(const Explanation& explanation) {
    std::vector<bool> on_path(explanation.tape.nodes.size());
    const auto mark = [&on_path](NodeId i) {
        if (i != no_node) on_path[i] = true;
    };

    // Begins with the outputs. In a miss, t is not an answer.
    mark(explanation.tape.outputs.hit);
    if (explanation.hit || explanation.tape.outputs.hit == no_node) mark(explanation.tape.outputs.t);

    // Visits every operation after all operations that use it.
    for (NodeId i = explanation.tape.size() - 1; i >= 0; --i) {
        if (explanation.attribution[i].is_live) mark(i);
        if (!on_path[i]) continue;
        const TapeNode& node = explanation.tape[i];
        if (node.op != TapeOp::select) {
            std::ranges::for_each(explanation.tape.operands_of(i), mark);
        } else {
            mark(node.operands[0]);
            mark(measure::attribution::chosen_side(explanation.tape, i));
        }
    }
    return on_path;
}

}  // namespace

OperationView::OperationView(const Explanation& explanation)
    : explanation_(explanation),
      text_(explanation.tape, explanation.input_names, measure::attribution::TapeText::TextStyle::pretty),
      ulp_(explanation.ulp_of_subject()),
      on_path_(nodes_on_path(explanation)) {
    for (NodeId i = 0; i < explanation.tape.size(); ++i) {
        if (is_given(explanation.tape[i].op) || (text_.is_number(i) && explanation.tape[i].label.empty())) continue;
        const std::string& name = text_.name(i);
        nodes_by_name_[name].push_back(i);
        if (const auto length = name.size(); length > 2 && name[length - 2] == '.')
            nodes_by_name_[name.substr(0, length - 2)].push_back(i);
    }
}

double OperationView::ulps_of_value(NodeId i, double error) const {
    return error / measure::attribution::ulp_at(error_of(i).exact == 0 ? explanation_.tape[i].value : error_of(i).exact,
                                                explanation_.tape.format_of(i));
}

std::string OperationView::cancellation(NodeId i) const {
    const int bits = error_of(i).cancelled_bits;
    return bits == 0 ? "" : fmt::format("{} {}", bits, error_of(i).operands_have_error ? "catastrophic" : "benign");
}

bool OperationView::is_shown(NodeId i, bool show_all) const {
    const TapeNode& node = explanation_.tape[i];
    if (text_.is_number(i) && node.label.empty() && error_of(i).rounding == 0) return false;
    if (show_all) return is_operation(node.op);
    if (!is_operation(node.op) || !error_of(i).is_live) return false;
    return !node.label.empty() || error_of(i).rounding != 0 || error_of(i).cancelled_bits > 1 ||
           i == explanation_.attribution.culprit;
}

std::vector<NodeId> OperationView::operations_named_in(NodeId i) const {
    const std::string& text = text_.expression(i);
    std::vector<NodeId> named;
    const auto is_name_char = [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) || std::strchr("_.'^", c);
    };
    for (std::size_t position = 0; position < text.size();) {
        std::size_t end = position;
        while (end < text.size() && is_name_char(text[end])) ++end;
        const auto entry = nodes_by_name_.find(std::string_view(text).substr(position, end - position));
        if (entry != nodes_by_name_.end()) named.insert(named.end(), entry->second.begin(), entry->second.end());
        position = std::max(end, position + 1);
    }
    return named;
}

std::string OperationView::subject() const {
    const NodeId subject = explanation_.attribution.subject;
    if (subject == no_node || !is_decision(explanation_.tape[subject].op)) return "t";
    const TapeNode& node = explanation_.tape[subject];
    if (!is_comparison(node.op)) return "decision";
    for (const std::size_t k : {0U, 1U}) {
        if (explanation_.tape[node.operands[k]].op == TapeOp::constant) return text_.operand(node.operands[1 - k]);
    }
    return text_.expression(subject);
}

int digits_of(const FloatFormat& format) { return 1 + static_cast<int>(std::ceil(format.precision * 0.30103)); }

namespace {

/// Fills in the texts on the error of an operation that is not a decision.
void add_error_texts(OperationRow& operation_row, const OperationView& view) {
    const NodeId i = operation_row.node;
    const measure::attribution::OperationError& operation_error = view.error_of(i);
    const auto text_or_empty = [](double ulps) { return std::isfinite(ulps) ? short_number(ulps) : ""; };
    operation_row.error_ulps = text_or_empty(view.ulps_of_value(i, operation_error.error));
    operation_row.cancelled = view.cancellation(i);
    if (operation_error.local_bits != 0) operation_row.local_bits = fmt::format("{:.1f}", operation_error.local_bits);

    if (operation_error.rounding == 0) return;
    operation_row.rounding_ulps = text_or_empty(view.ulps_of_value(i, operation_error.rounding));
    if (operation_error.is_live) operation_row.contribution_ulps = text_or_empty(view.contribution(i));
}

OperationRow table_row(const Explanation& explanation, const OperationView& view, NodeId i, bool shows_errors) {
    const measure::attribution::OperationError& operation_error = view.error_of(i);
    const TapeNode& node = explanation.tape[i];
    const bool is_decision_row = is_decision(node.op);
    OperationRow operation_row{.node = i,
                               .shows_errors = shows_errors,
                               .name = view.text().name(i),
                               .formula = shows_errors ? view.text().expression(i) : "(an earlier sample)",
                               .computed = node.value,
                               .exact = operation_error.exact,
                               .digits = is_decision_row ? 0 : digits_of(explanation.tape.format_of(i))};
    if (!shows_errors) return operation_row;

    operation_row.is_culprit = i == culprit_operation(explanation);
    operation_row.is_branch_flipped =
        operation_error.decision_changed && (is_decision_row || operation_error.rounding != 0);
    operation_row.is_off_path = !is_decision_row && !view.is_on_path(i);
    operation_row.is_on_purpose = measure::attribution::is_on_purpose(node.op) && operation_error.rounding != 0;

    if (!is_decision_row) add_error_texts(operation_row, view);
    return operation_row;
}

/// The first node that the table shows. Without `show_all`, the table of a march begins with the last samples.
NodeId first_shown_node(const Explanation& explanation, bool show_all) {
    const auto& samples = explanation.tape.sample_ends;
    return show_all || samples.size() < 3 ? 0 : static_cast<NodeId>(samples[samples.size() - 3]);
}

}  // namespace

OperationTable operation_table(const Explanation& explanation, const OperationView& view, bool show_all) {
    OperationTable table{.first_node = first_shown_node(explanation, show_all)};
    // A row can name other operations, and each of them needs a row too. The last operations are visited first.
    std::vector<bool> has_row(explanation.tape.nodes.size()), shows_errors(explanation.tape.nodes.size());
    for (NodeId i = explanation.tape.size() - 1; i >= 0; --i) {
        shows_errors[i] = i == culprit_operation(explanation) ||
                          (i >= table.first_node && (has_row[i] || view.is_shown(i, show_all)));
        has_row[i] = has_row[i] || shows_errors[i];
        if (!shows_errors[i]) continue;
        for (const NodeId named : view.operations_named_in(i)) has_row[named] = true;
    }

    for (NodeId i = 0; i < explanation.tape.size(); ++i) {
        if (has_row[i]) table.rows.push_back(table_row(explanation, view, i, shows_errors[i]));
    }
    return table;
}

}  // namespace lostbits::output::attribution
