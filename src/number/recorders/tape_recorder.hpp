// A recorder that writes every operation onto a tape.
#pragma once

#include "number/recorded.hpp"

namespace lostbits::number::recorders {

/// Computes each operation in the format of its operands and appends it to the tape. The bits are those of the machine
/// (binary32, binary64) or of `Rounded`. Decisions have the tape's first format.
class TapeRecorder final : public Recorder {
public:
    TapeRecorder(Tape& tape, const FloatFormat& format) : Recorder(format), tape_(tape) {}

    NodeId constant(int x, bool is_double) override;
    NodeId input(double x, bool is_double) override;
    NodeId apply(TapeOp op, const TapeOperands& operands) override;
    NodeId convert(NodeId x, bool to_double) override;
    NodeId call(const Call& callee, std::span<const NodeId> arguments, double value, bool is_double) override;
    [[nodiscard]] double value(NodeId x) const override { return tape_[x].value; }
    bool continues_loop(NodeId decision) override { return tape_[decision].value != 0 || tape_.runs_every_loop; }
    void name(NodeId x, std::string_view label) override { tape_.name(x, label); }
    void name_following(std::string_view part) override { tape_.part_name = part; }
    void add_branch(NodeId decision) override { tape_.branch_decisions.push_back(decision); }
    void end_sample() override { tape_.sample_ends.push_back(tape_.nodes.size()); }

private:
    [[nodiscard]] const FloatFormat& format_of(bool is_double) const { return is_double ? binary64 : format(); }

    Tape& tape_;
};

}  // namespace lostbits::number::recorders
