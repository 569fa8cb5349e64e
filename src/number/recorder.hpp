// Recorder: what becomes of each operation of a formula that runs over `Recorded`. One recorder writes a tape
// (tape_recorder.hpp), another bounds every error (bounds_recorder.hpp).
#pragma once

#include <span>
#include <string_view>

#include "number/rounded.hpp"
#include "number/tape.hpp"

namespace lostbits {

/// Keeps the numbers and decisions of one evaluation, each under the index of the operation that made it. Operations
/// are computed in the format of their operands: the recorder's own, or binary64 for what a formula computes in double
/// inside.
///
/// The recorder is this thread's from its construction to its destruction, and its format is the thread's
/// `CurrentFormat`.
class Recorder {
public:
    explicit Recorder(const FloatFormat& format) : format_(format), before_(current_) { current_ = this; }
    virtual ~Recorder() { current_ = before_; }
    Recorder(const Recorder&) = delete;
    Recorder& operator=(const Recorder&) = delete;

    /// Error(Exit::internal) where this thread has none.
    static Recorder& current() {
        if (current_ == nullptr) [[unlikely]]
            refuse();
        return *current_;
    }

    /// An integer of the formula's text or an input, rounded to the recorder's format, or to binary64.
    virtual NodeId constant(int x, bool in_double) = 0;
    virtual NodeId input(double x, bool in_double) = 0;
    /// The result of an operation, comparisons and logic included; operands in the order of `TapeNode::operands`.
    virtual NodeId apply(TapeOp op, const TapeOperands& of) = 0;
    /// The same number in binary64, or in the recorder's format.
    virtual NodeId convert(NodeId x, bool to_double) = 0;
    /// The value of a step that was computed as a whole (`Call`).
    virtual NodeId call(const Call& of, std::span<const NodeId> arguments, double value, bool in_double) = 0;
    /// The number, or 1 and 0 of a decision.
    [[nodiscard]] virtual double value(NodeId x) const = 0;
    /// Whether a loop of the formula that asks for this decision goes on.
    virtual bool goes_on(NodeId decision) = 0;
    /// Names an operation as the source of the form does.
    virtual void name(NodeId /*x*/, std::string_view /*label*/) {}
    /// Names all operations that follow, until the name is empty.
    virtual void name_all(std::string_view /*part*/) {}
    /// Ends one sample of a march.
    virtual void end_sample() {}

    [[nodiscard]] const FloatFormat& format() const { return CurrentFormat::get(); }

private:
    [[noreturn]] static void refuse();
    static constinit thread_local Recorder* current_;

    CurrentFormat::Scope format_;
    Recorder* before_;
};

}  // namespace lostbits
