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
#include "measure/choice/candidates.hpp"
#include "measure/repair/repair.hpp"
#include "measure/repair/shared_nodes.hpp"
#include "measure/repair/source_words.hpp"
#include "measure/repair/text_change.hpp"
#include "number/error.hpp"

namespace lostbits::measure::repair {

using intersect::function::NamedNumber;
using intersect::function::SourcePlace;
using intersect::function::UserFunction;
using intersect::function::WrittenIn;
using intersect::source_text::SourceTokens;
using intersect::source_text::TextSpan;

namespace {

/// A change that cannot be written. The text ends a sentence.
struct NotWritten : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Finds which nodes of one tape compute another value in a second tape of the same form: replacing them makes the
/// first tape the second. Takes nodes as far from the answer as possible, of those that can be replaced.
class Matcher {
public:
    Matcher(const Tape& own, const Tape& now, const std::function<bool(NodeId)>& can_replace)
        : own_(own),
          now_(now),
          can_replace_(can_replace),
          values_(shared_.values_of(own)),
          new_(shared_.values_of(now)) {}

    /// The node of the second tape for each node to replace; nothing if there is no such set.
    std::optional<std::map<NodeId, NodeId>> replaced() {
        for (int round = 0; round < 12; ++round) {
            replaced_.clear(), failed_.clear(), kept_.clear(), steps_ = 0;
            const auto &a = own_.outputs, &b = now_.outputs;
            if (!match(a.t, b.t) || !match(a.hit, b.hit) || !match(a.near, b.near) || !match(a.far, b.far)) return {};
            const std::vector<int> changed = values_with(replaced_);
            const NodeId wrong = first_wrong(changed);
            if (wrong == no_node) return replaced_;
            forbid_below(wrong);
        }
        return {};
    }
    /// The values of the first tape's nodes after the change.
    [[nodiscard]] std::vector<int> values_with(const std::map<NodeId, NodeId>& replaced) {
        std::map<NodeId, int> values;
        for (const auto& [o, n] : replaced) values[o] = value_of_new(n);
        return shared_.values_of(own_, values);
    }
    [[nodiscard]] int value_of_new(NodeId n) const { return new_[static_cast<std::size_t>(n)]; }
    [[nodiscard]] SharedNodes& shared() { return shared_; }

private:
    bool match(NodeId o, NodeId n) {
        if (++steps_ > 200'000 || failed_.contains({o, n})) return false;
        kept_.emplace_back(o, n);
        if (values_[static_cast<std::size_t>(o)] == value_of_new(n)) return true;
        if (const auto known = replaced_.find(o); known != replaced_.end())
            return value_of_new(known->second) == value_of_new(n);
        const TapeNode &a = own_[o], &b = now_[n];
        const bool same_format =
            is_decision(a.op) ? is_decision(b.op) : !is_decision(b.op) && own_.format_of(o) == now_.format_of(n);
        if (a.op == b.op && !is_given(a.op) && same_format) {
            const auto before = replaced_;
            const std::size_t kept = kept_.size();
            const bool commutes = a.op == TapeOp::add || a.op == TapeOp::mul;
            for (const bool swapped : {false, true}) {
                if (swapped && !commutes) break;
                bool all = true;
                for (std::size_t k = 0; all && k < row_of(a.op).operands; ++k)
                    all = match(a.operands[k], b.operands[swapped ? 1 - k : k]);
                if (all) return true;
                replaced_ = before;
                kept_.resize(kept);
            }
        }
        if (same_format && !forbidden_.contains(o) && can_replace_(o)) {
            replaced_[o] = n;
            return true;
        }
        failed_.emplace(o, n);
        return false;
    }
    /// A node that should have the value of another one, and does not: part of it was replaced for another's sake.
    [[nodiscard]] NodeId first_wrong(const std::vector<int>& changed) const {
        for (const auto& [o, n] : kept_)
            if (changed[static_cast<std::size_t>(o)] != value_of_new(n)) return o;
        return no_node;
    }
    void forbid_below(NodeId wrong) {
        std::vector<NodeId> todo{wrong};
        std::set<NodeId> seen;
        while (!todo.empty()) {
            const NodeId i = todo.back();
            todo.pop_back();
            if (!seen.insert(i).second) continue;
            if (i != wrong && replaced_.contains(i)) forbidden_.insert(i);
            for (const NodeId k : own_.operands_of(i)) todo.push_back(k);
        }
        if (replaced_.contains(wrong)) forbidden_.insert(wrong);
    }

    SharedNodes shared_;
    const Tape &own_, &now_;
    const std::function<bool(NodeId)>& can_replace_;
    std::vector<int> values_, new_;
    std::map<NodeId, NodeId> replaced_;
    std::set<std::pair<NodeId, NodeId>> failed_;
    std::vector<std::pair<NodeId, NodeId>> kept_;
    std::set<NodeId> forbidden_;
    std::size_t steps_ = 0;
};

/// A value that stands under a name from a place of the text on.
struct Visible {
    std::size_t from;
    std::string text;
    int value;
};

/// The part of the text that computes a node, and how tightly its operator binds.
struct Computed {
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
    Writer(const RepairRequest& request, const Tape& own, const UserFunction& function)
        : request_(request), own_(own), function_(function), text_(function.source), tokens_(text_) {
        for (std::size_t at = 0; at != std::string::npos && at < text_.size();) {
            lines_.push_back(at);
            at = text_.find('\n', at);
            if (at != std::string::npos) ++at;
        }
        if (request.scene) thin_ = choice::with_smaller_picture(*request.scene, few_rays);
        if (thin_) judge_.emplace(request, *thin_);
        else judge_.emplace(request);
        locate();
    }

    Patch patch_of(const Tape& now) {
        Patch made{.diff = {}, .why_not = {}, .file = function_.path};
        try {
            if (function_.language == WrittenIn::other)
                throw NotWritten("it is not a file of C, C++, Rust, GLSL or HLSL");
            const bool is_double = request_.row.format.engine == Format::Engine::native64;
            if (is_double != (function_.bits == 64))
                throw NotWritten(fmt::format("the function computes in {}, and this is a change in {}",
                                             is_double ? "float" : "double", request_.row.format.name));
            for (const bool shares : {true, false}) {
                made.diff = diff_of(now, shares);
                if (!made.diff.empty()) return made;
            }
            throw NotWritten("the changed file does not compute these operations where the old one did");
        } catch (const NotWritten& reason) {
            made.why_not = reason.what();
        }
        return made;
    }

private:
    [[nodiscard]] bool is_in_file(int place) const {
        if (place < 0) return false;
        const SourcePlace& p = function_.places[static_cast<std::size_t>(place)];
        return p.file == function_.path && p.line > 0 && static_cast<std::size_t>(p.line) <= lines_.size();
    }
    /// The place in the function itself from which this one was called.
    [[nodiscard]] int outermost(int place) const {
        while (place >= 0 && is_in_file(function_.places[static_cast<std::size_t>(place)].caller))
            place = function_.places[static_cast<std::size_t>(place)].caller;
        return is_in_file(place) ? place : -1;
    }
    [[nodiscard]] std::size_t line_begin(int line) const {
        return line < 1 || static_cast<std::size_t>(line) > lines_.size() ? text_.size()
                                                                          : lines_[static_cast<std::size_t>(line - 1)];
    }

    /// Finds where each node of the tape is computed, and from where on each variable has which node.
    void locate() {
        const std::vector<NodeId> nodes = function_.written->nodes_on_tape(request_.row.format);
        std::map<std::pair<int, int>, std::vector<NodeId>> by_place;
        for (std::size_t k = 0; k < nodes.size(); ++k) {
            const int place = function_.place_of_operation[k];
            if (!is_in_file(place) || outermost(place) != place || nodes[k] >= own_.size() ||
                is_given(own_[nodes[k]].op))
                continue;
            const SourcePlace& p = function_.places[static_cast<std::size_t>(place)];
            if (p.column > 0) by_place[{p.line, p.column}].push_back(nodes[k]);
        }
        // rustc names the begin of an expression, and so several of them by one place: the last one is the whole.
        const bool is_begin = function_.language == WrittenIn::rust;
        for (const auto& [at, all] : by_place) {
            if (all.size() > 1 && !is_begin) continue;
            const std::size_t offset = line_begin(at.first) + static_cast<std::size_t>(at.second - 1);
            computed_[*std::ranges::max_element(all)] = {
                is_begin ? tokens_.expression_from(offset) : tokens_.expression_at(offset), false};
        }
        for (const NamedNumber& named : function_.names) {
            if (named.operation == no_node) continue;
            const NodeId node = nodes[static_cast<std::size_t>(named.operation)];
            const int place = outermost(named.place);
            if (place < 0 || node >= own_.size()) continue;
            const int line = function_.places[static_cast<std::size_t>(place)].line;
            std::optional<TextSpan> value;
            for (const int at : {line, named.declared})
                if (!value && at > 0 && is_identifier(named.text))
                    value = tokens_.value_of(named.text, line_begin(at), line_begin(at + 1));
            if (value && !is_given(own_[node].op)) computed_[node] = {*value, true};
            stored_.push_back({value ? value->end : line_begin(line + 1), named.text, node});
        }
    }

    std::string diff_of(const Tape& now, bool shares);
    void write_one(NodeId o, NodeId n, bool shares);
    void count_uses(const std::map<NodeId, NodeId>& replaced);
    std::vector<NodeId> needed_by(NodeId n) const;
    std::string operand(NodeId n, int binds) const;
    std::string expression(NodeId n, int& binds) const;
    [[nodiscard]] const std::string* name_of(NodeId n) const;
    void see(std::size_t from);
    std::string new_name(NodeId n);
    bool computes(const std::string& text, const Tape& now);
    [[nodiscard]] bool is_double(const Tape& tape, NodeId i) const { return tape.format_of(i) == binary64; }

    const RepairRequest& request_;
    const Tape& own_;
    const UserFunction& function_;
    const std::string& text_;
    SourceTokens tokens_;
    std::vector<std::size_t> lines_;
    std::optional<scene::file::Scene> thin_;
    std::optional<Judge> judge_;
    std::map<NodeId, Computed> computed_;
    struct StoredNode {
        std::size_t from;
        std::string text;
        NodeId node;
    };
    std::vector<StoredNode> stored_;

    // State of one patch
    Matcher* matcher_ = nullptr;
    const Tape* now_ = nullptr;
    std::vector<Visible> visible_;
    std::map<int, std::string> seen_;  ///< names by their values where the text is written
    std::map<NodeId, int> uses_;
    std::set<std::string> taken_;
    std::vector<TextChange> changes_;
};

/// Collects the names that can be read at an offset: of each name the last value before it.
void Patcher::Writer::see(std::size_t from) {
    std::map<std::string, int> last;
    for (const Visible& v : visible_)
        if (v.from <= from) last[v.text] = v.value;
    seen_.clear();
    for (const auto& [text, value] : last) {
        std::string& known = seen_[value];
        if (known.empty() || text.size() < known.size()) known = text;
    }
}

const std::string* Patcher::Writer::name_of(NodeId n) const {
    const auto found = seen_.find(matcher_->value_of_new(n));
    return found == seen_.end() ? nullptr : &found->second;
}

/// The nodes that an expression for this one has to compute, in order.
std::vector<NodeId> Patcher::Writer::needed_by(NodeId n) const {
    std::vector<NodeId> todo{n};
    std::set<NodeId> found;
    while (!todo.empty()) {
        const NodeId i = todo.back();
        todo.pop_back();
        const bool is_known = is_given((*now_)[i].op) || (i != n && name_of(i) != nullptr) ||
                              matcher_->shared().number_of(matcher_->value_of_new(i)) != nullptr;
        if (is_known || !found.insert(i).second) continue;
        for (const NodeId k : now_->operands_of(i)) todo.push_back(k);
    }
    return {found.begin(), found.end()};
}

std::string Patcher::Writer::operand(NodeId n, int binds) const {
    if (const std::string* const name = name_of(n)) return *name;
    int own = 4;
    const std::string text = expression(n, own);
    return own < binds ? "(" + text + ")" : text;
}

/// An expression for a node, and how tightly it binds.
std::string Patcher::Writer::expression(NodeId n, int& binds) const {
    const TapeNode& node = (*now_)[n];
    const bool wide = is_double(*now_, n);
    if (const double* const x = matcher_->shared().number_of(matcher_->value_of_new(n))) {
        const std::string digits = digits_in(function_.language, *x, wide);
        if (digits.empty()) throw NotWritten("it has a number that is not finite");
        binds = digits.starts_with('-') ? 3 : 4;
        return digits;
    }
    if (node.op == TapeOp::input) throw NotWritten("it needs a number that has no name in the function");
    const bool of_double = is_double(*now_, is_comparison(node.op) ? node.operands[0] : n);
    const SourcePattern written = node.op == TapeOp::convert ? conversion_in(function_.language, wide)
                                                             : pattern_in(function_.language, node.op, of_double);
    if (written.pattern.empty())
        throw NotWritten(fmt::format("it needs {}, which the language has not", lostbits::name_of(node.op)));
    binds = written.binds;
    return attribution::filled(written.pattern,
                               [&](std::size_t k, int level) { return operand(node.operands[k], level); });
}

std::string Patcher::Writer::new_name(NodeId n) {
    std::string name;
    for (const char c : (*now_)[n].label) {
        if (std::isalnum(static_cast<unsigned char>(c)) != 0) name += c;
        else if (!name.ends_with('_')) name += '_';
    }
    while (name.ends_with('_')) name.pop_back();
    const bool is_named = !name.empty() && std::isdigit(static_cast<unsigned char>(name[0])) == 0;
    for (int k = 1;; ++k) {
        const std::string tried = is_named ? (k == 1 ? name : fmt::format("{}_{}", name, k)) : fmt::format("part{}", k);
        if (!tokens_.has_word(tried) && taken_.insert(tried).second) return tried;
    }
}

/// Counts how often the new expressions use each node.
void Patcher::Writer::count_uses(const std::map<NodeId, NodeId>& replaced) {
    uses_.clear();
    for (const auto& [o, n] : replaced) {
        see(computed_.at(o).span.begin);
        ++uses_[n];
        for (const NodeId i : needed_by(n))
            for (const NodeId k : now_->operands_of(i)) ++uses_[k];
    }
}

/// Writes the expression of node `o` anew, and before its statement the values that it needs more than once.
void Patcher::Writer::write_one(NodeId o, NodeId n, bool shares) {
    const Computed& place = computed_.at(o);
    see(place.span.begin);
    const SourceTokens::Statement statement = tokens_.statement_around(place.span.begin);
    const std::size_t line = *std::prev(std::ranges::upper_bound(lines_, statement.begin));
    const bool begins_line = statement.before <= line;
    const std::string indent = text_.substr(line, text_.find_first_not_of(" \t", line) - line);
    std::string declared;
    for (const NodeId i : needed_by(n)) {
        const TapeOp op = (*now_)[i].op;
        if (i == n || uses_[i] < 2 || op == TapeOp::neg || op == TapeOp::convert || name_of(i) != nullptr) continue;
        int binds = 4;
        const std::string value = expression(i, binds), name = new_name(i);
        const bool decides = is_decision(op);
        declared += declared_in(function_.language, name, !decides && is_double(*now_, i), decides) + value + ";" +
                    (begins_line ? "\n" + indent : " ");
        const int own = matcher_->value_of_new(i);
        seen_[own] = name;
        if (shares) visible_.push_back({statement.begin, name, own});
    }
    int binds = 4;
    std::string text = name_of(n) != nullptr ? *name_of(n) : expression(n, binds);
    const int least = place.is_statement ? -2 : pattern_in(function_.language, own_[o].op, false).binds;
    if (binds < least) text = "(" + text + ")";
    if (!declared.empty()) changes_.push_back({{statement.begin, statement.begin}, declared});
    changes_.push_back({place.span, text});
}

std::string Patcher::Writer::diff_of(const Tape& now, bool shares) {
    const std::function<bool(NodeId)> can_replace = [this](NodeId o) { return computed_.contains(o); };
    Matcher matcher(own_, now, can_replace);
    const auto replaced = matcher.replaced();
    if (!replaced) throw NotWritten("the operations that change are not whole expressions of the function");
    matcher_ = &matcher, now_ = &now;
    visible_.clear(), changes_.clear(), taken_.clear();
    const std::vector<int> values = matcher.values_with(*replaced);
    SharedNodes& shared = matcher.shared();
    const FloatFormat& format = own_.format_of(own_.outputs.t);
    for (const NamedNumber& named : function_.names) {
        if (named.input < 0) continue;
        const int in = shared.input(named.input, format);
        visible_.push_back(
            {0, named.text,
             named.is_inverse ? shared.value_of(TapeOp::div, format, {shared.constant(1, format), in, -1}) : in});
    }
    for (const StoredNode& s : stored_) visible_.push_back({s.from, s.text, values[static_cast<std::size_t>(s.node)]});
    std::vector<std::pair<NodeId, NodeId>> order(replaced->begin(), replaced->end());
    std::ranges::sort(order, {}, [&](const auto& pair) { return computed_.at(pair.first).span; });
    count_uses(*replaced);
    for (const auto& [o, n] : order) write_one(o, n, shares);
    const std::optional<std::string> changed = changed_text(text_, changes_);
    if (!changed || !computes(*changed, now)) return "";
    return unified_diff(function_.path, text_, *changed);
}

/// Compiles and follows the changed file, and compares it with the tape on the rays.
bool Patcher::Writer::computes(const std::string& text, const Tape& now) {
    const intersect::device::TemporaryFolder folder("lostbits-patch");
    const std::filesystem::path own(function_.path), copy = folder.path / own.filename();
    std::ofstream(copy, std::ios::binary) << text;
    try {
        const auto patched = intersect::function::load_function(
            copy.string() + function_.name,
            {.stop = request_.limit.stop, .headers = std::filesystem::absolute(own).parent_path()});
        if (patched->row.shape != request_.row.form->shape) return false;
        return answers_as({.form = &patched->row, .format = request_.row.format}, now, request_, *judge_);
    } catch (const InputError&) {
        return false;
    }
}

Patcher::Patcher(const RepairRequest& request, const Tape& own) {
    if (const UserFunction* const f = intersect::function::function_of(*request.row.form->info))
        writer_ = std::make_unique<Writer>(request, own, *f);
}

Patcher::~Patcher() = default;

bool Patcher::has_file() const { return writer_ != nullptr; }

Patch Patcher::patch_of(const Tape& now) { return writer_->patch_of(now); }

}  // namespace lostbits::measure::repair
