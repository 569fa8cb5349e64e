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

Json tape_operation_json(const Explanation& explanation, const TapeText& text, NodeId i) {
    const TapeNode& node = explanation.tape[i];
    const measure::attribution::OperationError& operation_error = explanation.attribution[i];
    Json operands = Json::array();
    for (const NodeId operand : explanation.tape.operands_of(i)) operands.push_back(text.name(operand));
    Json json{{"name", text.name(i)},
              {"operation", std::string(name_of(node.op))},
              {"operands", operands},
              {"expression", text.expression(i)}};

    if (!node.label.empty()) json["label"] = std::string(node.label);
    json["turned"] = operation_error.decision_changed;

    // A decision has only its value.
    if (is_decision(node.op)) {
        json["computed"] = node.value != 0;
        json["exact"] = operation_error.exact != 0;
        return json;
    }

    json["precision"] = explanation.tape.format_of(i).precision;
    json["computed"] = exact_number(node.value);
    json["exact"] = json_number(operation_error.exact);
    json["error"] = json_number(operation_error.error);

    json["cancelled_bits"] = operation_error.cancelled_bits;
    if (operation_error.cancelled_bits > 0)
        json["cancellation"] = operation_error.operands_have_error ? "catastrophic" : "benign";
    json["local_error_bits"] = json_number(operation_error.local_bits);

    // The rounding of the operation itself, and what it adds to the error of the subject.
    json["rounding"] = json_number(operation_error.rounding);
    json["live"] = operation_error.is_live;
    json["on_purpose"] = measure::attribution::is_on_purpose(node.op);
    json["adjoint"] = json_number(operation_error.adjoint);
    json["derivative"] = json_number(operation_error.derivative);
    json["contribution"] = json_number(operation_error.contribution);
    return json;
}

std::string name_of_outcome(Outcome outcome) {
    return std::string(measure::answer::outcome_names[static_cast<std::size_t>(outcome)]);
}

Json form_result_json(const measure::attribution::FormResult& result) {
    return {{"form", std::string(result.form->info->name)},
            {"outcome", name_of_outcome(result.outcome)},
            {"t", json_number(result.t)},
            {"ulp_error", number_or_null(result.ulps)},
            {"lost_bits", number_or_null(result.lost_bits)},
            {"lost_bits_around", number_or_null(result.mean_lost_nearby)}};
}

/// Adds the numbers that the form gets, and the direction before it was normalised.
void add_inputs(Json& json, const Explanation& explanation) {
    for (std::size_t i = 0; i < explanation.input_values.size(); ++i)
        json["inputs"][explanation.input_names[i]] = exact_number(explanation.input_values[i]);
    json["open_ends"] = std::string(name_of(explanation.range.open_ends));
    json["inputs_rounded"] = explanation.has_rounded_inputs;

    const auto& direction = explanation.given_direction;
    json["given_direction"] =
        direction ? Json({json_number(direction->x), json_number(direction->y), json_number(direction->z)})
                  : Json(nullptr);
}

/// Adds the answer, the truth, and how far they are apart.
void add_answer(Json& json, const Explanation& explanation) {
    json["hit"] = explanation.hit;
    json["t"] = exact_number(explanation.result.t);
    json["truth"] = explanation.true_t ? Json(exact_number(*explanation.true_t)) : Json(nullptr);
    json["outcome"] = name_of_outcome(explanation.result.outcome);
    if (explanation.mesh_outcome) json["in_mesh"] = name_of_outcome(*explanation.mesh_outcome);

    json["ulp_error"] = number_or_null(explanation.result.ulps);
    json["lost_bits"] = number_or_null(explanation.result.lost_bits);
    json["wrong_root"] = is_wrong_root(explanation);
    json["condition"] = number_or_null(explanation.condition);
    json["inherent_bits"] = number_or_null(explanation.inherent_bits);
}

/// Adds the sentences of the verdict, and the operations that they name.
void add_verdict(Json& json, const Explanation& explanation, const ExplainedVerdict& verdict, const TapeText& text) {
    json["answer"] = verdict.answer;
    json["verdict"] = verdict.loss;
    json["sentence"] = verdict.blame;
    json["culprit"] = node_or_null(text, verdict.culprit);
    json["largest"] = node_or_null(text, explanation.attribution.culprit);
    json["largest_sentence"] = explanation.has_tape() ? Json(culprit_sentence(explanation)) : Json(nullptr);

    // The answers if only the culprit were exact, and if only the culprit rounded.
    const auto counterfactual_json = [](const measure::attribution::Counterfactual& counterfactual) {
        return Json{{"hit", counterfactual.hit},
                    {"error", counterfactual.hit ? json_number(counterfactual.error) : Json(nullptr)}};
    };
    const bool has_counterfactuals = explanation.culprit_alone && verdict.culprit != no_node;
    json["culprit_alone_exact"] =
        has_counterfactuals ? counterfactual_json(explanation.culprit_alone->only_exact) : Json(nullptr);
    json["culprit_alone_rounded"] =
        has_counterfactuals ? counterfactual_json(explanation.culprit_alone->only_rounded) : Json(nullptr);

    json["equals"] = Json::array();
    for (const NodeId i : explanation.attribution.equal_culprits) json["equals"].push_back(text.name(i));
}

/// The error of the subject and the sums of its contributions; null if there is no subject.
Json attribution_json(const Explanation& explanation, const TapeText& text) {
    const measure::attribution::Attribution& attribution = explanation.attribution;
    const auto of_subject = [&attribution](double v) {
        return attribution.subject == no_node ? Json(nullptr) : json_number(v);
    };
    return {{"subject", node_or_null(text, attribution.subject)},
            {"exact_hit", attribution.is_exact_hit},
            {"cut_short", attribution.loop_was_cut_short},
            {"error", of_subject(attribution.error)},
            {"explained", of_subject(attribution.contribution_sum)},
            {"first_order", of_subject(attribution.first_order_sum)},
            {"ulp", number_or_null(explanation.ulp_of_subject())},
            {"shadow_bits", attribution.exact_bits}};
}

}  // namespace

std::string explain_json(const Explanation& explanation, const std::optional<MarchEnd>& march) {
    const TapeText text(explanation.tape, explanation.input_names, TapeText::TextStyle::plain);
    Json json{{"schema", "lostbits-explanation/1"},
              {"form", std::string(explanation.form->info->name)},
              {"format", explanation.format.name},
              {"convention", std::string(intersect::convention_name(explanation.touching))},
              {"primitive", explanation.primitive_index},
              {"primitives", explanation.primitive_count}};
    add_inputs(json, explanation);
    add_answer(json, explanation);
    add_verdict(json, explanation, make_verdict(explanation, march), text);

    json["attribution"] = attribution_json(explanation, text);
    json["operations"] = Json::array();
    for (NodeId i = 0; i < explanation.tape.size(); ++i)
        json["operations"].push_back(tape_operation_json(explanation, text, i));

    json["lost_bits_around"] = number_or_null(explanation.result.mean_lost_nearby);
    json["better"] = Json::array();
    for (const measure::attribution::FormResult& form_result : explanation.better_forms)
        json["better"].push_back(form_result_json(form_result));
    return file::json_text(json);
}

}  // namespace lostbits::output::attribution
