// Runs column programs on blocks of rays: each instruction runs for a whole block before the next instruction.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "measure/stages/raw_stages.hpp"
#include "measure/stages/stage_program.hpp"
#include "number/wide/column_program.hpp"

namespace lostbits::measure::stages {

/// A program with a buffer for its columns. Columns that are the same for every ray (constants, inputs of one number,
/// and results of these alone) are computed once for each batch. The other columns are reused as soon as they are no
/// longer needed.
class ColumnRun {
public:
    /// Bit k of `shared_inputs` is set if input k is one number for all rays.
    ColumnRun(const number::wide::ColumnProgram& program, const ColumnKernels& kernels, std::uint64_t shared_inputs);
    ColumnRun(const ColumnRun&) = delete;
    ColumnRun& operator=(const ColumnRun&) = delete;

    void operator()(const RawProblems<float>& problems) const { run(problems); }
    void operator()(const RawProblems<double>& problems) const { run(problems); }

private:
    struct Step {
        ColumnKernels::Kernel kernel;  ///< null for a gate, whose operand is its mask
        const ColumnOperand* operands;
        bool acts_on_masks;
    };
    struct Input {
        std::size_t input;
        std::uint32_t offset;
    };
    class Layout;

    template <class S>
    void run(const RawProblems<S>& problems) const;
    void run_block(double* scratch, std::size_t pack_count) const;

    const ColumnKernels* kernels_;
    std::size_t scratch_size_ = 0;  ///< in doubles
    std::vector<ColumnOperand> operands_;
    std::vector<Step> shared_steps_, ray_steps_;
    std::vector<Input> shared_inputs_, ray_inputs_;
    std::vector<std::pair<double, std::uint32_t>> constants_;
    std::vector<ColumnOperand> outputs_;
};

}  // namespace lostbits::measure::stages
