#include "measure/repair/patch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <set>
#include <stdexcept>

#include "intersect/device/temporary_folder.hpp"
#include "intersect/function/function.hpp"
#include "intersect/source_text/source_tokens.hpp"
#include "measure/attribution/operation.hpp"
#include "measure/choose/candidates.hpp"
#include "measure/repair/matcher.hpp"
#include "measure/repair/repair.hpp"
#include "measure/repair/source_words.hpp"
#include "measure/repair/text_change.hpp"
#include "number/error.hpp"

namespace lostbits::measure::repair {

using intersect::function::FileLanguage;
using intersect::function::NamedNumber;
using intersect::function::SourcePlace;
using intersect::function::UserFunction;
using intersect::source_text::SourceTokens;
using intersect::source_text::TextSpan;

namespace {

/// Thrown for a change that cannot be written. Its text ends a sentence.
struct UnwritableChange : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Name of a value, valid from the offset `begin` of the text on.
struct VisibleName {
    std::size_t begin;
    std::string text;
    int value_index;
};

/// The part of the text that computes a node.
struct ComputedText {
    TextSpan span;
    bool is_statement = false;  ///< the whole value of a variable
};

bool is_identifier(const std::string& text) {
    return std::ranges::all_of(text,
                               [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; });
}

}  // namespace

class Patcher::Writer {
public:
    Writer(const RepairRequest& request, const Tape& old_tape, const UserFunction& function)
        : request_(request), old_tape_(old_tape), function_(function), text_(function.source), tokens_(text_) {
        for (std::size_t position = 0; position != std::string::npos && position < text_.size();) {
            line_begins_.push_back(position);
            position = text_.find('\n', position);
            if (position != std::string::npos) ++position;
        }
        if (request.scene) smaller_scene_ = choose::with_smaller_picture(*request.scene, few_rays_count);
        if (smaller_scene_) measurer_.emplace(request, *smaller_scene_);
        else measurer_.emplace(request);
        locate_nodes();
    }

    Patch make_patch(const Tape& new_tape) {
        Patch patch{.diff = {}, .reason = {}, .file = function_.path};
        try {
            if (function_.language == FileLanguage::other)
                throw UnwritableChange("it is not a file of C, C++, Rust, GLSL or HLSL");
            const bool is_double = request_.tested_form.format.engine == Format::Engine::native64;
            if (is_double != (function_.bits == 64))
                throw UnwritableChange(fmt::format("the function computes in {}, and this is a change in {}",
                                                   is_double ? "float" : "double", request_.tested_form.format.name));
            for (const bool shares_values : {true, false}) {
                patch.diff = make_diff(new_tape, shares_values);
                if (!patch.diff.empty()) return patch;
            }
            throw UnwritableChange("the changed file does not compute these operations where the old one did");
        } catch (const UnwritableChange& reason) {
            patch.reason = reason.what();
        }
        return patch;
    }

private:
    [[nodiscard]] bool is_in_file(int place_index) const {
        if (place_index < 0) return false;
        const SourcePlace& p = function_.places[place_index];
        return p.file == function_.path && p.line > 0 && static_cast<std::size_t>(p.line) <= line_begins_.size();
    }
    /// Index of the place in the function itself from which the code at this place was called; −1 if that is not in the
    /// file.
    [[nodiscard]] int outermost_place(int place_index) const {
        while (place_index >= 0 && is_in_file(function_.places[place_index].caller))
            place_index = function_.places[place_index].caller;
        return is_in_file(place_index) ? place_index : -1;
    }
    [[nodiscard]] std::size_t line_begin(int line) const {
        return line < 1 || static_cast<std::size_t>(line) > line_begins_.size() ? text_.size() : line_begins_[line - 1];
    }

    /// Finds where the text computes each node of the tape, and from which offset on a variable holds a node.
    void locate_nodes() {
        const std::vector<NodeId> tape_nodes = function_.written->find_nodes_on_tape(request_.tested_form.format);
        locate_expressions(tape_nodes);
        locate_variables(tape_nodes);
    }

    void locate_expressions(const std::vector<NodeId>& tape_nodes) {
        std::map<std::pair<int, int>, std::vector<NodeId>> nodes_by_position;
        for (std::size_t k = 0; k < tape_nodes.size(); ++k) {
            const int place_index = function_.place_of_operation[k];
            if (!is_in_file(place_index) || outermost_place(place_index) != place_index ||
                tape_nodes[k] >= old_tape_.size() || is_given(old_tape_[tape_nodes[k]].op))
                continue;
            const SourcePlace& p = function_.places[place_index];
            if (p.column > 0) nodes_by_position[{p.line, p.column}].push_back(tape_nodes[k]);
        }

        // rustc gives the beginning of an expression, so several expressions can have the same place. The last one is
        // the whole expression.
        const bool columns_are_starts = function_.language == FileLanguage::rust;
        for (const auto& [position, nodes] : nodes_by_position) {
            if (nodes.size() > 1 && !columns_are_starts) continue;
            const std::size_t offset = line_begin(position.first) + static_cast<std::size_t>(position.second - 1);
            computed_[*std::ranges::max_element(nodes)] = {
                columns_are_starts ? tokens_.find_expression_from(offset) : tokens_.find_expression_at(offset), false};
        }
    }

    void locate_variables(const std::vector<NodeId>& tape_nodes) {
        for (const NamedNumber& named_number : function_.names) {
            if (named_number.operation == no_node) continue;
            const NodeId node = tape_nodes[named_number.operation];
            const int place_index = outermost_place(named_number.place);
            if (place_index < 0 || node >= old_tape_.size()) continue;

            // The value may be assigned at the place itself, or where the variable is declared.
            const int line = function_.places[place_index].line;
            std::optional<TextSpan> value;
            for (const int first_line : {line, named_number.declaration_line})
                if (!value && first_line > 0 && is_identifier(named_number.text))
                    value = tokens_.value_of(named_number.text, line_begin(first_line), line_begin(first_line + 1));

            // A variable holds its value from the end of the assignment on, or from the next line.
            if (value && !is_given(old_tape_[node].op)) computed_[node] = {*value, true};
            stored_nodes_.push_back({value ? value->end : line_begin(line + 1), named_number.text, node});
        }
    }

    std::string make_diff(const Tape& new_tape, bool shares_values);
    void write_expression(NodeId old_node, NodeId new_node, bool shares_values);
    std::string declare_shared_values(NodeId n, const SourceTokens::Statement& statement, bool shares_values);
    void begin_patch(Matcher& matcher, const Tape& new_tape);
    void add_visible_names(const std::map<NodeId, NodeId>& replacements);
    void count_uses(const std::map<NodeId, NodeId>& replacements);
    std::vector<NodeId> nodes_needed_by(NodeId n) const;
    std::string operand_text(NodeId n, SourcePrecedence required) const;
    std::string expression_text(NodeId n, SourcePrecedence& precedence) const;
    [[nodiscard]] const std::string* name_of(NodeId n) const;
    void collect_visible_names(std::size_t offset);
    std::string make_name(NodeId n);
    bool answers_like_tape(const std::string& text, const Tape& new_tape);
    [[nodiscard]] bool is_double(const Tape& tape, NodeId i) const { return tape.format_of(i) == binary64; }

    const RepairRequest& request_;
    const Tape& old_tape_;
    const UserFunction& function_;
    const std::string& text_;
    SourceTokens tokens_;
    std::vector<std::size_t> line_begins_;
    std::optional<scene::file::Scene> smaller_scene_;
    std::optional<QualityMeasurer> measurer_;
    std::map<NodeId, ComputedText> computed_;
    struct StoredNode {
        std::size_t begin;
        std::string text;
        NodeId node;
    };
    std::vector<StoredNode> stored_nodes_;

    // State of the patch that is being written
    Matcher* matcher_ = nullptr;
    const Tape* new_tape_ = nullptr;
    std::vector<VisibleName> visible_names_;
    /// Names that are visible where the text is written, by the indices of their values in `Matcher::shared`.
    std::map<int, std::string> names_by_value_;
    std::map<NodeId, int> use_counts_;
    std::set<std::string> used_names_;
    std::vector<TextChange> changes_;
};

/// Collects the names that can be read at an offset, each with its last value before the offset.
void Patcher::Writer::collect_visible_names(std::size_t offset) {
    std::map<std::string, int> last_value_indices;
    for (const VisibleName& v : visible_names_)
        if (v.begin <= offset) last_value_indices[v.text] = v.value_index;
    names_by_value_.clear();
    for (const auto& [text, value_index] : last_value_indices) {
        std::string& name = names_by_value_[value_index];
        if (name.empty() || text.size() < name.size()) name = text;
    }
}

const std::string* Patcher::Writer::name_of(NodeId n) const {
    const auto found = names_by_value_.find(matcher_->value_of_new(n));
    return found == names_by_value_.end() ? nullptr : &found->second;
}

/// The nodes that an expression for node n has to compute, in order.
std::vector<NodeId> Patcher::Writer::nodes_needed_by(NodeId n) const {
    std::vector<NodeId> pending{n};
    std::set<NodeId> needed;
    while (!pending.empty()) {
        const NodeId i = pending.back();
        pending.pop_back();
        const bool is_known = is_given((*new_tape_)[i].op) || (i != n && name_of(i) != nullptr) ||
                              matcher_->shared().constant_of(matcher_->value_of_new(i)) != nullptr;
        if (is_known || !needed.insert(i).second) continue;
        for (const NodeId k : new_tape_->operands_of(i)) pending.push_back(k);
    }
    return {needed.begin(), needed.end()};
}

std::string Patcher::Writer::operand_text(NodeId n, SourcePrecedence required) const {
    if (const std::string* const name = name_of(n)) return *name;
    SourcePrecedence precedence = SourcePrecedence::call;
    const std::string text = expression_text(n, precedence);
    return precedence < required ? "(" + text + ")" : text;
}

/// Returns an expression for node n; sets `precedence` to that of the expression.
std::string Patcher::Writer::expression_text(NodeId n, SourcePrecedence& precedence) const {
    const TapeNode& node = (*new_tape_)[n];
    const bool is_wide = is_double(*new_tape_, n);
    if (const double* const x = matcher_->shared().constant_of(matcher_->value_of_new(n))) {
        const std::string digits = literal_in(function_.language, *x, is_wide);
        if (digits.empty()) throw UnwritableChange("it has a number that is not finite");
        precedence = digits.starts_with('-') ? SourcePrecedence::sign : SourcePrecedence::call;
        return digits;
    }
    if (node.op == TapeOp::input) throw UnwritableChange("it needs a number that no variable of the function holds");
    const bool is_of_double = is_double(*new_tape_, is_comparison(node.op) ? node.operands[0] : n);
    const SourcePattern source_pattern = node.op == TapeOp::convert
                                             ? conversion_in(function_.language, is_wide)
                                             : operation_pattern(function_.language, node.op, is_of_double);
    if (source_pattern.pattern.empty())
        throw UnwritableChange(
            fmt::format("it needs {}, which the language does not have", lostbits::name_of(node.op)));
    precedence = source_pattern.precedence;
    return attribution::fill_pattern(source_pattern.pattern, [&](std::size_t k, int level) {
        return operand_text(node.operands[k], SourcePrecedence{level});
    });
}

std::string Patcher::Writer::make_name(NodeId n) {
    std::string name;
    for (const char c : (*new_tape_)[n].label) {
        if (std::isalnum(static_cast<unsigned char>(c)) != 0) name += c;
        else if (!name.ends_with('_')) name += '_';
    }
    while (name.ends_with('_')) name.pop_back();
    const bool is_named = !name.empty() && std::isdigit(static_cast<unsigned char>(name[0])) == 0;
    for (int k = 1;; ++k) {
        const std::string candidate =
            is_named ? (k == 1 ? name : fmt::format("{}_{}", name, k)) : fmt::format("part{}", k);
        if (!tokens_.has_word(candidate) && used_names_.insert(candidate).second) return candidate;
    }
}

/// Counts how often the new expressions use each node.
void Patcher::Writer::count_uses(const std::map<NodeId, NodeId>& replacements) {
    use_counts_.clear();
    for (const auto& [old_node, new_node] : replacements) {
        collect_visible_names(computed_.at(old_node).span.begin);
        ++use_counts_[new_node];
        for (const NodeId i : nodes_needed_by(new_node))
            for (const NodeId k : new_tape_->operands_of(i)) ++use_counts_[k];
    }
}

/// Replaces the text of an old node by an expression of a new node. Declares values that the expression needs more
/// than once before its statement.
void Patcher::Writer::write_expression(NodeId old_node, NodeId new_node, bool shares_values) {
    const ComputedText& computed_text = computed_.at(old_node);
    collect_visible_names(computed_text.span.begin);
    const SourceTokens::Statement statement = tokens_.statement_around(computed_text.span.begin);
    const std::string declarations = declare_shared_values(new_node, statement, shares_values);

    // Brackets the expression where the text around it binds more tightly.
    SourcePrecedence precedence = SourcePrecedence::call;
    std::string text = name_of(new_node) != nullptr ? *name_of(new_node) : expression_text(new_node, precedence);
    const SourcePrecedence required_precedence =
        computed_text.is_statement ? SourcePrecedence::choice
                                   : operation_pattern(function_.language, old_tape_[old_node].op, false).precedence;
    if (precedence < required_precedence) text = "(" + text + ")";

    if (!declarations.empty()) changes_.push_back({{statement.begin, statement.begin}, declarations});
    changes_.push_back({computed_text.span, text});
}

/// Returns the declarations of the values that an expression of node n needs more than once, for the beginning of a
/// statement. They get a line each if the statement begins its line.
std::string Patcher::Writer::declare_shared_values(NodeId n, const SourceTokens::Statement& statement,
                                                   bool shares_values) {
    const std::size_t line = *std::prev(std::ranges::upper_bound(line_begins_, statement.begin));
    const bool begins_line = statement.before <= line;
    const std::string indent = text_.substr(line, text_.find_first_not_of(" \t", line) - line);

    std::string declarations;
    for (const NodeId i : nodes_needed_by(n)) {
        const TapeOp op = (*new_tape_)[i].op;
        if (i == n || use_counts_[i] < 2 || op == TapeOp::neg || op == TapeOp::convert || name_of(i) != nullptr)
            continue;

        SourcePrecedence precedence = SourcePrecedence::call;
        const std::string value = expression_text(i, precedence), name = make_name(i);
        const bool is_boolean = is_decision(op);
        declarations += declaration_in(function_.language, name, !is_boolean && is_double(*new_tape_, i), is_boolean) +
                        value + ";" + (begins_line ? "\n" + indent : " ");

        // Further expressions use the name; those of later statements only if values are shared.
        const int value_index = matcher_->value_of_new(i);
        names_by_value_[value_index] = name;
        if (shares_values) visible_names_.push_back({statement.begin, name, value_index});
    }
    return declarations;
}

/// Begins a new patch, with no changes yet.
void Patcher::Writer::begin_patch(Matcher& matcher, const Tape& new_tape) {
    matcher_ = &matcher;
    new_tape_ = &new_tape;
    visible_names_.clear();
    changes_.clear();
    used_names_.clear();
}

/// Lists the parameters and variables of the function with the values that they have after the replacements.
void Patcher::Writer::add_visible_names(const std::map<NodeId, NodeId>& replacements) {
    const std::vector<int> values = matcher_->values_with(replacements);

    // Parameters hold inputs, or the inverse of an input.
    SharedNodes& shared = matcher_->shared();
    const FloatFormat& format = old_tape_.format_of(old_tape_.outputs.t);
    for (const NamedNumber& named_number : function_.names) {
        if (named_number.input < 0) continue;
        const int input_value = shared.input(named_number.input, format);
        visible_names_.push_back(
            {0, named_number.text,
             named_number.is_inverse
                 ? shared.value_of(TapeOp::div, format, {shared.constant(1, format), input_value, -1})
                 : input_value});
    }

    // Variables hold nodes, from where they get their values on.
    for (const StoredNode& s : stored_nodes_) visible_names_.push_back({s.begin, s.text, values[s.node]});
}

/// Returns the changes as a diff; empty if the changed file does not answer like the tape.
std::string Patcher::Writer::make_diff(const Tape& new_tape, bool shares_values) {
    const std::function<bool(NodeId)> can_replace = [this](NodeId old_node) { return computed_.contains(old_node); };
    Matcher matcher(old_tape_, new_tape, can_replace);
    const auto replacements = matcher.find_replacements();
    if (!replacements) throw UnwritableChange("the operations that change are not whole expressions of the function");

    begin_patch(matcher, new_tape);
    add_visible_names(*replacements);

    // Writes the expressions in the order of the text.
    std::vector<std::pair<NodeId, NodeId>> order(replacements->begin(), replacements->end());
    std::ranges::sort(order, {}, [&](const auto& pair) { return computed_.at(pair.first).span; });
    count_uses(*replacements);
    for (const auto& [old_node, new_node] : order) write_expression(old_node, new_node, shares_values);

    const std::optional<std::string> changed_file = apply_changes(text_, changes_);
    if (!changed_file || !answers_like_tape(*changed_file, new_tape)) return "";
    return make_unified_diff(function_.path, text_, *changed_file);
}

/// True if the changed file, compiled and followed, has the same answers as the tape on the rays.
bool Patcher::Writer::answers_like_tape(const std::string& text, const Tape& new_tape) {
    const intersect::device::TemporaryFolder folder("lostbits-patch");
    const std::filesystem::path original_path(function_.path), copy_path = folder.path / original_path.filename();
    std::ofstream(copy_path, std::ios::binary) << text;
    try {
        const auto patched = intersect::function::load_function(
            copy_path.string() + function_.option_suffix,
            {.stop = request_.limit.stop, .headers = std::filesystem::absolute(original_path).parent_path()});
        if (patched->intersector.shape != request_.tested_form.form->shape) return false;
        return has_answers_of_tape({.form = &patched->intersector, .format = request_.tested_form.format}, new_tape,
                                   request_, *measurer_);
    } catch (const InputError&) {
        return false;
    }
}

Patcher::Patcher(const RepairRequest& request, const Tape& old_tape) {
    if (const UserFunction* const f = intersect::function::function_of(*request.tested_form.form->info))
        writer_ = std::make_unique<Writer>(request, old_tape, *f);
}

Patcher::~Patcher() = default;

bool Patcher::can_write() const { return writer_ != nullptr; }

Patch Patcher::make_patch(const Tape& new_tape) { return writer_->make_patch(new_tape); }

}  // namespace lostbits::measure::repair
