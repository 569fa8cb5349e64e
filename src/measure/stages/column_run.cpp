#include "measure/stages/column_run.hpp"

#include <algorithm>
#include <limits>
#include <memory>
#include <new>

namespace lostbits::measure::stages {

using number::wide::ColumnIndex;
using number::wide::ColumnInstruction;
using number::wide::ColumnOperation;
using number::wide::ColumnProgram;

namespace {

/// Number of rays in a block. The columns of most programs then stay in the second-level cache, and many rays share the
/// cost of a kernel call.
constexpr std::size_t block_size = 128;
/// Number of doubles from the start of one column to the next. The distance is not a multiple of 4096 bytes, because
/// the processor would then treat a load as one that depends on a recent store.
constexpr std::size_t column_step = block_size + 8;
constexpr std::size_t max_lanes = 8;

double* scratch_of_thread(std::size_t double_count) {
    struct AlignedDeleter {
        void operator()(double* p) const { ::operator delete[](p, std::align_val_t{64}); }
    };
    thread_local std::unique_ptr<double[], AlignedDeleter> scratch;
    thread_local std::size_t size = 0;
    if (size < double_count) {
        scratch.reset(static_cast<double*>(::operator new[](double_count * sizeof(double), std::align_val_t{64})));
        std::fill_n(scratch.get(), double_count, 0.0);
        size = double_count;
    }
    return scratch.get();
}

}  // namespace

/// Layout of a program's columns in its buffer.
class ColumnRun::Layout {
public:
    Layout(const ColumnProgram& program, std::size_t lanes, std::uint64_t shared_inputs)
        : program_(program),
          lanes_(lanes),
          columns_(program.column_count),
          constant_offsets_(program.constants.size()) {
        for (std::size_t k = 0; k < program.input_count; ++k) columns_[k].is_shared = (shared_inputs >> k & 1) != 0;
        find_last_uses();
        for (std::size_t k = 0; k < program.constants.size(); ++k) constant_offsets_[k] = take_shared_offset();
        for (std::size_t k = 0; k < program.input_count; ++k)
            if (columns_[k].last_use >= 0) assign_offset(columns_[k]);
    }
    /// Places the results of an instruction. The results reuse the columns of operands that this instruction reads for
    /// the last time, if there are any.
    void place_results(const ColumnInstruction& instruction, std::ptrdiff_t index) {
        for (std::size_t k = 0; k < instruction.input_count; ++k) release(instruction.in[k], index);
        for (std::size_t k = 0; k < instruction.output_count; ++k) {
            Column& column = column_at(instruction.out[k]);
            column.is_shared = is_shared(instruction);
            assign_offset(column);
            if (column.last_use < 0) release(instruction.out[k], column.last_use);
        }
    }
    [[nodiscard]] bool is_shared(const ColumnInstruction& instruction) const {
        return std::all_of(
            instruction.in.begin(), instruction.in.begin() + instruction.input_count,
            [this](ColumnIndex column_index) { return column_index < 0 || column_at(column_index).is_shared; });
    }
    [[nodiscard]] ColumnOperand operand(ColumnIndex column_index) const {
        if (column_index < 0) return {constant_offsets_[-1 - column_index], 0};
        const Column& column = column_at(column_index);
        return {column.offset, column.is_shared ? 0 : static_cast<std::uint32_t>(lanes_)};
    }
    [[nodiscard]] bool is_read(std::size_t input) const { return columns_[input].last_use >= 0; }
    [[nodiscard]] bool is_shared(std::size_t input) const { return columns_[input].is_shared; }
    [[nodiscard]] std::size_t size() const { return size_; }

private:
    struct Column {
        bool is_shared = false;
        std::uint32_t offset = 0;
        std::ptrdiff_t last_use = -1;  ///< index of the last instruction that reads the column; −1: none
    };
    static constexpr std::ptrdiff_t never = std::numeric_limits<std::ptrdiff_t>::max();

    void find_last_uses() {
        std::ptrdiff_t index = 0;
        for (const ColumnInstruction& instruction : program_.instructions) {
            for (std::size_t k = 0; k < instruction.input_count; ++k)
                if (instruction.in[k] >= 0) column_at(instruction.in[k]).last_use = index;
            ++index;
        }
        for (const ColumnIndex column_index : program_.outputs)
            if (column_index >= 0) column_at(column_index).last_use = never;
    }
    void assign_offset(Column& column) {
        if (column.is_shared) {
            column.offset = take_shared_offset();
        } else if (!free_offsets_.empty()) {
            column.offset = free_offsets_.back();
            free_offsets_.pop_back();
        } else {
            column.offset = static_cast<std::uint32_t>(size_);
            size_ += column_step;
        }
    }
    void release(ColumnIndex column_index, std::ptrdiff_t index) {
        if (column_index < 0) return;
        const Column& column = column_at(column_index);
        if (column.is_shared || column.last_use != index) return;
        if (std::ranges::find(free_offsets_, column.offset) == free_offsets_.end())
            free_offsets_.push_back(column.offset);
    }
    std::uint32_t take_shared_offset() {
        const auto offset = static_cast<std::uint32_t>(size_);
        size_ += max_lanes;
        return offset;
    }
    Column& column_at(ColumnIndex column_index) { return columns_[column_index]; }
    [[nodiscard]] const Column& column_at(ColumnIndex column_index) const { return columns_[column_index]; }

    const ColumnProgram& program_;
    std::size_t lanes_;
    std::vector<Column> columns_;
    std::vector<std::uint32_t> constant_offsets_, free_offsets_;
    std::size_t size_ = 0;
};

ColumnRun::ColumnRun(const ColumnProgram& program, const ColumnKernels& kernels, std::uint64_t shared_inputs)
    : kernels_(&kernels) {
    Layout layout(program, kernels.lanes, shared_inputs);

    // Constants and inputs have columns from the start.
    for (std::size_t k = 0; k < program.constants.size(); ++k)
        constants_.emplace_back(program.constants[k],
                                layout.operand(static_cast<ColumnIndex>(-1 - static_cast<int>(k))).offset);
    for (std::size_t k = 0; k < program.input_count; ++k) {
        if (!layout.is_read(k)) continue;
        (layout.is_shared(k) ? shared_inputs_ : ray_inputs_)
            .push_back({k, layout.operand(static_cast<ColumnIndex>(k)).offset});
    }

    // Places the columns of the results. The steps point into `operands_`, so they are made when it is complete.
    std::vector<std::pair<std::size_t, const ColumnInstruction*>> first_operands;
    std::ptrdiff_t index = 0;
    for (const ColumnInstruction& instruction : program.instructions) {
        first_operands.emplace_back(operands_.size(), &instruction);
        for (std::size_t k = 0; k < instruction.input_count; ++k)
            operands_.push_back(layout.operand(instruction.in[k]));
        layout.place_results(instruction, index++);
        for (std::size_t k = 0; k < instruction.output_count; ++k)
            operands_.push_back(layout.operand(instruction.out[k]));
    }

    for (const auto& [first_operand, instruction] : first_operands) {
        const bool is_gate = instruction->operation == ColumnOperation::gate,
                   is_shared = !is_gate && layout.is_shared(*instruction);
        const auto& word_kernels = kernels.by_words[program.words_per_number - 1];
        const auto& operation_kernels = word_kernels[static_cast<std::size_t>(instruction->operation)];
        (is_shared ? shared_steps_ : ray_steps_)
            .push_back({is_gate ? nullptr : operation_kernels[instruction->exact], &operands_[first_operand],
                        acts_on_masks(instruction->operation)});
    }

    for (const ColumnIndex column_index : program.outputs) outputs_.push_back(layout.operand(column_index));
    scratch_size_ = layout.size();
}

template <class S>
void ColumnRun::run(const RawProblems<S>& problems) const {
    const auto column = [&problems](std::size_t input) -> const RawColumn<S>& {
        if (input == input_of_tmin) return problems.tmin;
        if (input == input_of_tmax) return problems.tmax;
        if (input >= input_of_primitive_low) return problems.primitive_low[input - input_of_primitive_low];
        if (input >= input_of_ray_low) return problems.ray_low[input - input_of_ray_low];
        return input >= input_of_primitive ? problems.primitive[input - input_of_primitive] : problems.ray[input];
    };
    const auto load = [&](const std::vector<Input>& inputs, double* scratch, std::size_t first,
                          std::size_t pack_count) {
        for (const Input& input_column : inputs) {
            if constexpr (std::is_same_v<S, float>)
                kernels_->load_floats(column(input_column.input), first, scratch + input_column.offset, pack_count);
            else kernels_->load_doubles(column(input_column.input), first, scratch + input_column.offset, pack_count);
        }
    };

    // Constants, and the steps that are the same for all rays, are done once.
    double* const scratch = scratch_of_thread(scratch_size_);
    const std::size_t lanes = kernels_->lanes;
    for (const auto& [value, offset] : constants_) kernels_->repeat(value, scratch + offset);
    load(shared_inputs_, scratch, 0, 1);
    for (const Step& step : shared_steps_) step.kernel(scratch, step.operands, 1);

    for (std::size_t first = 0; first < problems.size; first += block_size) {
        const std::size_t pack_count = std::min(block_size, problems.size - first) / lanes;
        load(ray_inputs_, scratch, first, pack_count);
        run_block(scratch, pack_count);

        // Decisions are stored for every ray, lengths only where the ray hits.
        const auto cells = [&](std::size_t output) {
            return ColumnCells{scratch + outputs_[output].offset, outputs_[output].step};
        };
        kernels_->store_mask(cells(output_settled), problems.out.settled + first, pack_count);
        kernels_->store_mask(cells(output_hit), problems.out.hit + first, pack_count);
        const auto store_length = [&](std::size_t output, const RawLength& length) {
            if (!length.hi) return;
            double* const columns[3] = {length.hi + first, length.lo + first, length.bound + first};
            for (std::size_t k = 0; k < 3; ++k)
                kernels_->store_where(cells(output_hit), cells(output + k), columns[k], pack_count);
        };
        store_length(output_t, problems.out.t);
        store_length(output_distance, problems.out.distance);
    }
}

void ColumnRun::run_block(double* scratch, std::size_t pack_count) const {
    bool are_numbers_needed = true;  // decisions are always needed
    for (const Step& step : ray_steps_) {
        if (!step.kernel) {
            const bool is_shared = step.operands[0].step == 0;
            are_numbers_needed =
                are_numbers_needed && kernels_->is_any(scratch + step.operands[0].offset, is_shared ? 1 : pack_count);
        } else if (are_numbers_needed || step.acts_on_masks) {
            step.kernel(scratch, step.operands, pack_count);
        }
    }
}

}  // namespace lostbits::measure::stages
