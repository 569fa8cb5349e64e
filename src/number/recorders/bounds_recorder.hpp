// A recorder that keeps a bound on the error of every number instead of a tape.
#pragma once

#include <vector>

#include "number/bounded.hpp"
#include "number/recorded.hpp"

namespace lostbits::number::recorders {

/// Computes each operation over `Bounded<float>` or `Bounded<double>`. The format is binary32 or binary64.
class BoundsRecorder final : public Recorder {
public:
    explicit BoundsRecorder(const FloatFormat& format) : Recorder(format), has_double_format_(format == binary64) {}

    NodeId constant(int x, bool is_double) override { return add(x, 0, is_double || has_double_format_); }
    NodeId input(double x, bool is_double) override;
    NodeId apply(TapeOp op, const TapeOperands& operands) override;
    NodeId convert(NodeId x, bool to_double) override;
    NodeId call(const Call& callee, std::span<const NodeId> arguments, double value, bool is_double) override;
    [[nodiscard]] double value(NodeId x) const override { return entry_of(x).value; }
    bool continues_loop(NodeId decision) override { return entry_of(decision).value != 0 || !is_proved(decision); }

    /// Bound on the distance from the result of the same formula without rounding; infinity if nothing is known.
    [[nodiscard]] double error(NodeId x) const { return entry_of(x).error; }
    /// True if the bounds prove a decision.
    [[nodiscard]] bool is_proved(NodeId decision) const { return entry_of(decision).error == 0; }

private:
    /// A decision has the value 1 or 0. Its error is 0 if it is proved, 1 otherwise.
    struct Entry {
        double value, error;
        bool is_double;
    };
    [[nodiscard]] const Entry& entry_of(NodeId x) const { return entries_[x]; }
    NodeId add(double value, double error, bool is_double) {
        entries_.push_back({value, error, is_double});
        return static_cast<NodeId>(entries_.size()) - 1;
    }
    template <class F>
    [[nodiscard]] Bounded<F> bounded_number(NodeId x) const {
        return {static_cast<F>(entry_of(x).value), static_cast<F>(entry_of(x).error)};
    }
    [[nodiscard]] BoundedMask decision_mask(NodeId x) const { return {entry_of(x).value != 0, entry_of(x).error == 0}; }
    template <class F>
    NodeId add(const Bounded<F>& x) {
        return add(x.value(), x.error(), sizeof(F) == sizeof(double));
    }
    NodeId add(const BoundedMask& x) { return add(x.value() ? 1 : 0, x.is_proved() ? 0 : 1, false); }
    template <class F>
    NodeId compute(TapeOp op, const TapeOperands& operands);

    bool has_double_format_;
    std::vector<Entry> entries_;
};

}  // namespace lostbits::number::recorders
