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
constexpr std::size_t block = 128;
/// Doubles from the start of one column to the next. This is not a multiple of 4096 bytes, because the processor would
/// take a load for one that depends on a recent store.
constexpr std::size_t column_step = block + 8;
constexpr std::size_t most_lanes = 8;

double* scratch_of_thread(std::size_t doubles) {
    struct Free {
        void operator()(double* p) const { ::operator delete[](p, std::align_val_t{64}); }
    };
    thread_local std::unique_ptr<double[], Free> scratch;
    thread_local std::size_t size = 0;
    if (size < doubles) {
        scratch.reset(static_cast<double*>(::operator new[](doubles * sizeof(double), std::align_val_t{64})));
        std::fill_n(scratch.get(), doubles, 0.0);
        size = doubles;
    }
    return scratch.get();
}

}  // namespace

/// Layout of a program's columns in its buffer.
class ColumnRun::Layout {
public:
    Layout(const ColumnProgram& program, std::size_t lanes, std::uint64_t same)
        : program_(program), lanes_(lanes), at_(program.columns), constant_at_(program.constants.size()) {
        for (std::size_t k = 0; k < program.inputs; ++k) at_[k].once = (same >> k & 1) != 0;
        find_last_uses();
        for (std::size_t k = 0; k < program.constants.size(); ++k) constant_at_[k] = next_once();
        for (std::size_t k = 0; k < program.inputs; ++k)
            if (at_[k].last >= 0) place(at_[k]);
    }
    /// Places the results of an instruction. They reuse the columns of operands that it reads for the last time, if
    /// there are any.
    void step(const ColumnInstruction& one, std::ptrdiff_t number) {
        for (std::size_t k = 0; k < one.ins; ++k) release(one.in[k], number);
        for (std::size_t k = 0; k < one.outs; ++k) {
            Column& column = of(one.out[k]);
            column.once = is_once(one);
            place(column);
            if (column.last < 0) release(one.out[k], column.last);
        }
    }
    [[nodiscard]] bool is_once(const ColumnInstruction& one) const {
        return std::all_of(one.in.begin(), one.in.begin() + one.ins,
                           [this](ColumnIndex place) { return place < 0 || of(place).once; });
    }
    [[nodiscard]] ColumnOperand operand(ColumnIndex place) const {
        if (place < 0) return {constant_at_[static_cast<std::size_t>(-1 - place)], 0};
        const Column& column = of(place);
        return {column.offset, column.once ? 0 : static_cast<std::uint32_t>(lanes_)};
    }
    [[nodiscard]] bool is_read(std::size_t input) const { return at_[input].last >= 0; }
    [[nodiscard]] bool is_once(std::size_t input) const { return at_[input].once; }
    [[nodiscard]] std::size_t size() const { return size_; }

private:
    struct Column {
        bool once = false;
        std::uint32_t offset = 0;
        std::ptrdiff_t last = -1;  ///< index of the instruction that reads it last; −1: none
    };
    static constexpr std::ptrdiff_t never = std::numeric_limits<std::ptrdiff_t>::max();

    void find_last_uses() {
        std::ptrdiff_t number = 0;
        for (const ColumnInstruction& one : program_.instructions) {
            for (std::size_t k = 0; k < one.ins; ++k)
                if (one.in[k] >= 0) of(one.in[k]).last = number;
            ++number;
        }
        for (const ColumnIndex place : program_.outputs)
            if (place >= 0) of(place).last = never;
    }
    void place(Column& column) {
        if (column.once) {
            column.offset = next_once();
        } else if (!free_.empty()) {
            column.offset = free_.back(), free_.pop_back();
        } else {
            column.offset = static_cast<std::uint32_t>(size_), size_ += column_step;
        }
    }
    void release(ColumnIndex place, std::ptrdiff_t number) {
        if (place < 0) return;
        const Column& column = of(place);
        if (column.once || column.last != number) return;
        if (std::ranges::find(free_, column.offset) == free_.end()) free_.push_back(column.offset);
    }
    std::uint32_t next_once() {
        const auto offset = static_cast<std::uint32_t>(size_);
        size_ += most_lanes;
        return offset;
    }
    Column& of(ColumnIndex place) { return at_[static_cast<std::size_t>(place)]; }
    [[nodiscard]] const Column& of(ColumnIndex place) const { return at_[static_cast<std::size_t>(place)]; }

    const ColumnProgram& program_;
    std::size_t lanes_;
    std::vector<Column> at_;
    std::vector<std::uint32_t> constant_at_, free_;
    std::size_t size_ = 0;
};

ColumnRun::ColumnRun(const ColumnProgram& program, const ColumnKernels& kernels, std::uint64_t same)
    : kernels_(&kernels) {
    Layout layout(program, kernels.lanes, same);
    std::vector<std::pair<std::size_t, const ColumnInstruction*>> first_operand;
    for (std::size_t k = 0; k < program.constants.size(); ++k)
        constants_.emplace_back(program.constants[k],
                                layout.operand(static_cast<ColumnIndex>(-1 - static_cast<int>(k))).offset);
    for (std::size_t k = 0; k < program.inputs; ++k) {
        if (!layout.is_read(k)) continue;
        (layout.is_once(k) ? once_in_ : each_in_).push_back({k, layout.operand(static_cast<ColumnIndex>(k)).offset});
    }
    std::ptrdiff_t number = 0;
    for (const ColumnInstruction& one : program.instructions) {
        first_operand.emplace_back(operands_.size(), &one);
        for (std::size_t k = 0; k < one.ins; ++k) operands_.push_back(layout.operand(one.in[k]));
        layout.step(one, number++);
        for (std::size_t k = 0; k < one.outs; ++k) operands_.push_back(layout.operand(one.out[k]));
    }
    for (const auto& [first, one] : first_operand) {
        const bool is_gate = one->operation == ColumnOperation::gate, once = !is_gate && layout.is_once(*one);
        const auto& of_words = kernels.of[static_cast<std::size_t>(program.words - 1)];
        const auto& of = of_words[static_cast<std::size_t>(one->operation)];
        (once ? once_ : each_)
            .push_back({is_gate ? nullptr : of[one->exact], &operands_[first], is_of_masks(one->operation)});
    }
    for (const ColumnIndex place : program.outputs) outputs_.push_back(layout.operand(place));
    scratch_size_ = layout.size();
}

template <class S>
void ColumnRun::run(const RawProblems<S>& p) const {
    const auto column = [&p](std::size_t input) -> const RawColumn<S>& {
        if (input == input_of_tmin) return p.tmin;
        if (input == input_of_tmax) return p.tmax;
        if (input >= input_of_primitive_low) return p.primitive_low[input - input_of_primitive_low];
        if (input >= input_of_ray_low) return p.ray_low[input - input_of_ray_low];
        return input >= input_of_primitive ? p.primitive[input - input_of_primitive] : p.ray[input];
    };
    const auto load = [&](const std::vector<Input>& inputs, double* scratch, std::size_t first, std::size_t packs) {
        for (const Input& one : inputs) {
            if constexpr (std::is_same_v<S, float>)
                kernels_->load_floats(column(one.input), first, scratch + one.offset, packs);
            else kernels_->load_doubles(column(one.input), first, scratch + one.offset, packs);
        }
    };
    double* const scratch = scratch_of_thread(scratch_size_);
    const std::size_t lanes = kernels_->lanes;
    for (const auto& [x, offset] : constants_) kernels_->repeat(x, scratch + offset);
    load(once_in_, scratch, 0, 1);
    for (const Step& step : once_) step.kernel(scratch, step.operands, 1);
    for (std::size_t first = 0; first < p.size; first += block) {
        const std::size_t packs = std::min(block, p.size - first) / lanes;
        load(each_in_, scratch, first, packs);
        run_block(scratch, packs);
        const auto cells = [&](std::size_t output) {
            return CellsOfColumn{scratch + outputs_[output].offset, outputs_[output].step};
        };
        kernels_->store_mask(cells(output_settled), p.out.settled + first, packs);
        kernels_->store_mask(cells(output_hit), p.out.hit + first, packs);
        const auto store = [&](std::size_t output, const RawLength& to) {
            if (!to.hi) return;
            double* const columns[3] = {to.hi + first, to.lo + first, to.bound + first};
            for (std::size_t k = 0; k < 3; ++k)
                kernels_->store_where(cells(output_hit), cells(output + k), columns[k], packs);
        };
        store(output_t, p.out.t);
        store(output_distance, p.out.distance);
    }
}

void ColumnRun::run_block(double* scratch, std::size_t packs) const {
    bool are_wanted = true;  // applies to numbers; decisions always are
    for (const Step& step : each_) {
        if (!step.kernel) {
            const bool is_once = step.operands[0].step == 0;
            are_wanted = are_wanted && kernels_->is_any(scratch + step.operands[0].offset, is_once ? 1 : packs);
        } else if (are_wanted || step.is_of_masks) {
            step.kernel(scratch, step.operands, packs);
        }
    }
}

}  // namespace lostbits::measure::stages
