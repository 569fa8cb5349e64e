#include "measure/culprits.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <map>
#include <mutex>

#include "intersect/recording.hpp"
#include "measure/tape_text.hpp"

namespace lostbits {
namespace {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();
constexpr std::string_view none = "none: nothing rounds";

/// Whatever decides the names of operations: kinds, operands, labels. FNV-1a over 64 bits.
std::uint64_t structure_of(const Tape& tape) {
    std::uint64_t h = 14695981039346656037u;
    const auto mix = [&h](std::uint64_t x) { h = (h ^ x) * 1099511628211u; };
    for (const TapeNode& n : tape.nodes) {
        mix(static_cast<std::uint64_t>(n.op));
        for (const NodeId operand : n.operands) mix(static_cast<std::uint32_t>(operand));
    }
    return h;
}

/// The label that each operation leads to first; its own where it has one.
std::vector<std::string_view> steps_of(const Tape& tape) {
    std::vector<std::string_view> step(tape.nodes.size());
    for (NodeId i = tape.size() - 1; i >= 0; --i) {
        const TapeNode& n = tape[i];
        if (!n.label.empty()) step[static_cast<std::size_t>(i)] = n.label;
        if (n.op <= TapeOp::constant) continue;
        // Users come later on the tape; the earliest of them is seen last and keeps its word.
        for (const NodeId operand : n.operands) {
            if (operand != no_node && tape[operand].label.empty() && !is_decision(n.op)) step[static_cast<std::size_t>(operand)] = step[static_cast<std::size_t>(i)];
        }
    }
    return step;
}

double labelled_contribution(const Sample& s) {
    if (!s.blame || is_decision((*s.blame->tape)[s.blame->attribution->subject].op)) return missing;
    const std::string_view label = s.metric->name.substr(s.metric->name.find(':') + 1);
    return contribution_of(*s.blame->tape, *s.blame->attribution, label) / s.blame->ulp;
}

}  // namespace

const Metric* culprit_among(std::span<const Intersector* const> forms, std::span<const Solid<double>> solids, const MarchConstants<double>* march) {
    static std::mutex lock;
    static std::deque<std::string> texts;
    static std::deque<std::vector<std::string_view>> lists;
    static std::deque<Metric> rows;
    const std::lock_guard guard(lock);
    auto& list = lists.emplace_back(std::vector{none});
    for (const Intersector* form : forms) {
        const auto fits = std::ranges::find_if(solids, [form](const Solid<double>& s) { return s.shape == form->shape; });
        if (form->shape != Shape::sdf && fits == solids.end()) continue;
        const Target<double> target = form->shape == Shape::sdf ? Target<double>(solids, *march) : Target<double>(*fits);
        Tape tape;
        form->record_all(target, tape);
        const TapeText text(tape, input_names(*form, target), TapeText::Style::generic);
        for (NodeId i = 0; i < tape.size(); ++i) {
            if (!is_operation(tape[i].op) && tape[i].op != TapeOp::constant) continue;
            const std::string category = text.category(i);
            if (std::ranges::find(list, category) == list.end()) list.push_back(texts.emplace_back(category));
        }
    }
    Metric row = *find_metric("culprit");
    row.categories = list;
    return &rows.emplace_back(row);
}

const Metric* contribution_metric(std::string_view name) {
    static std::mutex lock;
    static std::deque<std::string> texts;
    static std::map<std::string, Metric, std::less<>> rows;
    if (!name.starts_with("contribution:") || name.size() == std::string_view("contribution:").size()) return nullptr;
    const std::lock_guard guard(lock);
    if (const auto found = rows.find(name); found != rows.end()) return &found->second;
    const std::string_view own = texts.emplace_back(name), layer = texts.emplace_back("contribution." + std::string(name.substr(name.find(':') + 1)));
    const Metric row{own, "ulp", layer, "what the operations of that name add to t by their own rounding, in ulps of t without rounding", needs_attribution, Ramp::magnitude, 0x1p-4, 0x1p+24, false, labelled_contribution};
    return &rows.emplace(own, row).first->second;
}

std::vector<std::string_view> labels_of(const Intersector& form, const Target<double>& target) {
    Tape tape;
    form.record_all(target, tape);
    std::vector<std::string_view> labels;
    for (const TapeNode& n : tape.nodes) {
        if (!n.label.empty() && std::ranges::find(labels, n.label) == labels.end()) labels.push_back(n.label);
    }
    return labels;
}

double contribution_of(const Tape& tape, const Attribution& attribution, std::string_view label) {
    const auto steps = steps_of(tape);
    double sum = 0;
    bool any = false;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        if (steps[i] != label) continue;
        any = true;
        if (attribution.of[i].live) sum += attribution.of[i].contribution;
    }
    return any ? sum : missing;
}

int worst_cancellation(const Attribution& attribution) {
    int worst = 0;
    for (const OperationError& e : attribution.of) {
        if (e.live && e.carried) worst = std::max(worst, e.cancelled);
    }
    return worst;
}

const std::vector<std::int32_t>& Blamer::places(const Target<double>& target) {
    const auto [found, fresh] = known_.try_emplace(structure_of(tape_));
    if (!fresh) return found->second;
    const TapeText text(tape_, input_names(form_, target), TapeText::Style::generic);
    for (NodeId i = 0; i < tape_.size(); ++i) {
        const auto place = std::ranges::find(categories_, text.category(i));
        found->second.push_back(place == categories_.end() ? -1 : static_cast<std::int32_t>(place - categories_.begin()));
    }
    return found->second;
}

Blame Blamer::of(const Ray<double>& ray, const Target<double>& target, double tmax) {
    form_.record(format_, ray, target, tmax, tape_);
    attribution_ = attribute(tape_);
    Blame blame{missing, &tape_, &attribution_, missing};
    const NodeId subject = attribution_.subject;
    if (subject == no_node) return blame;
    const double size = std::fabs(attribution_.of[static_cast<std::size_t>(subject)].exact);
    blame.ulp = std::ldexp(1.0, static_cast<int>(ulp_exponent(format_.shape, size == 0 || !std::isfinite(size) ? -100000 : std::ilogb(size))));
    if (categories_.empty()) return blame;
    if (attribution_.culprit == no_node) {
        blame.culprit = 0;
        return blame;
    }
    const std::int32_t place = places(target)[static_cast<std::size_t>(attribution_.culprit)];
    if (place >= 0) blame.culprit = place;
    return blame;
}

}  // namespace lostbits
