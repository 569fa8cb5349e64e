// Writes an explanation as a JSON object (see `explain_json`).
#include <cmath>

#include "measure/attribution/operation_error.hpp"
#include "measure/attribution/tape_text.hpp"
#include "output/attribution/explain_text.hpp"
#include "output/file/json.hpp"

namespace lostbits::output::attribution {

namespace {

using Json = file::OrderedJson;
using file::json_number;

/// A number, or null for NaN, which stands for a missing value.
Json number_or_null(double x) { return std::isnan(x) ? Json(nullptr) : json_number(x); }
Json exact_number(double x) { return {{"decimal", json_number(x)}, {"hex", file::hex(x)}}; }
Json node_or_null(const TapeText& text, NodeId i) { return i == no_node ? Json(nullptr) : Json(text.name(i)); }

Json operation(const Explanation& x, const TapeText& text, NodeId i) {
    const TapeNode& n = x.tape[i];
    const measure::attribution::OperationError& e = x.attribution[i];
    Json operands = Json::array();
    for (const NodeId operand : x.tape.operands_of(i)) operands.push_back(text.name(operand));
    Json j{{"name", text.name(i)},
           {"operation", std::string(name_of(n.op))},
           {"operands", operands},
           {"expression", text.expression(i)}};
    if (!n.label.empty()) j["label"] = std::string(n.label);
    j["turned"] = e.decision_changed;
    if (is_decision(n.op)) {
        j["computed"] = n.value != 0;
        j["exact"] = e.exact != 0;
        return j;
    }
    j["precision"] = x.tape.format_of(i).precision;
    j["computed"] = exact_number(n.value);
    j["exact"] = json_number(e.exact);
    j["error"] = json_number(e.error);
    j["cancelled_bits"] = e.cancelled_bits;
    if (e.cancelled_bits > 0) j["cancellation"] = e.operands_have_error ? "catastrophic" : "benign";
    j["local_error_bits"] = json_number(e.local_bits);
    j["rounding"] = json_number(e.rounding);
    j["live"] = e.is_live;
    j["on_purpose"] = measure::attribution::is_on_purpose(n.op);
    j["adjoint"] = json_number(e.adjoint);
    j["derivative"] = json_number(e.derivative);
    j["contribution"] = json_number(e.contribution);
    return j;
}

Json form_result_json(const measure::attribution::FormResult& result) {
    return {{"form", std::string(result.form->info->name)},
            {"outcome", std::string(measure::answer::outcome_names[static_cast<std::size_t>(result.outcome)])},
            {"t", json_number(result.t)},
            {"ulp_error", number_or_null(result.ulps)},
            {"lost_bits", number_or_null(result.lost_bits)},
            {"lost_bits_around", number_or_null(result.mean_lost_nearby)}};
}

}  // namespace

std::string explain_json(const Explanation& x, const std::optional<MarchEnd>& march) {
    const TapeText text(x.tape, x.input_names, TapeText::Style::plain);
    const measure::attribution::Attribution& a = x.attribution;
    const ExplainedVerdict verdict = verdict_of(x, march);
    Json j{{"schema", "lostbits-explanation/1"},
           {"form", std::string(x.form->info->name)},
           {"format", x.format.name},
           {"convention", std::string(intersect::convention_name(x.touching))},
           {"primitive", x.primitive_index},
           {"primitives", x.primitive_count}};
    for (std::size_t i = 0; i < x.input_values.size(); ++i)
        j["inputs"][x.input_names[i]] = exact_number(x.input_values[i]);
    j["open_ends"] = std::string(name_of(x.range.open));
    j["inputs_rounded"] = x.rounded_inputs;
    j["given_direction"] = x.given_direction
                               ? Json({json_number(x.given_direction->x), json_number(x.given_direction->y),
                                       json_number(x.given_direction->z)})
                               : Json(nullptr);
    j["hit"] = x.hit;
    j["t"] = exact_number(x.result.t);
    j["truth"] = x.true_t ? Json(exact_number(*x.true_t)) : Json(nullptr);
    j["outcome"] = std::string(measure::answer::outcome_names[static_cast<std::size_t>(x.result.outcome)]);
    if (x.mesh_outcome)
        j["in_mesh"] = std::string(measure::answer::outcome_names[static_cast<std::size_t>(*x.mesh_outcome)]);
    j["ulp_error"] = number_or_null(x.result.ulps);
    j["lost_bits"] = number_or_null(x.result.lost_bits);
    j["wrong_root"] = is_wrong_root(x);
    j["condition"] = number_or_null(x.condition);
    j["inherent_bits"] = number_or_null(x.inherent_bits);
    j["answer"] = verdict.answer;
    j["verdict"] = verdict.loss;
    j["sentence"] = verdict.blame;
    j["culprit"] = node_or_null(text, verdict.culprit);
    j["largest"] = node_or_null(text, a.culprit);
    j["largest_sentence"] = x.has_tape() ? Json(culprit_sentence(x)) : Json(nullptr);
    const auto counterfactual = [](const measure::attribution::Counterfactual& c) {
        return Json{{"hit", c.hit}, {"error", c.hit ? json_number(c.error) : Json(nullptr)}};
    };
    const bool has_counterfactuals = x.culprit_alone && verdict.culprit != no_node;
    j["culprit_alone_exact"] = has_counterfactuals ? counterfactual(x.culprit_alone->only_exact) : Json(nullptr);
    j["culprit_alone_rounded"] = has_counterfactuals ? counterfactual(x.culprit_alone->only_rounded) : Json(nullptr);
    j["equals"] = Json::array();
    for (const NodeId i : a.equal_culprits) j["equals"].push_back(text.name(i));
    const auto of_subject = [&a](double v) { return a.subject == no_node ? Json(nullptr) : json_number(v); };
    j["attribution"] = {{"subject", node_or_null(text, a.subject)},    {"exact_hit", a.exact_hit},
                        {"cut_short", a.loop_was_cut_short},           {"error", of_subject(a.error)},
                        {"explained", of_subject(a.contribution_sum)}, {"first_order", of_subject(a.first_order_sum)},
                        {"ulp", number_or_null(x.ulp_of_subject())},   {"shadow_bits", a.exact_bits}};
    j["operations"] = Json::array();
    for (NodeId i = 0; i < x.tape.size(); ++i) j["operations"].push_back(operation(x, text, i));
    j["lost_bits_around"] = number_or_null(x.result.mean_lost_nearby);
    j["better"] = Json::array();
    for (const measure::attribution::FormResult& form_result : x.better_forms)
        j["better"].push_back(form_result_json(form_result));
    return file::json_text(j);
}

}  // namespace lostbits::output::attribution
