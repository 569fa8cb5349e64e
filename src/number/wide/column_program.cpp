#include "number/wide/column_program.hpp"

#include <bit>
#include <limits>
#include <stdexcept>

namespace lostbits::number::wide {

namespace {

thread_local ColumnRecorder* recorder = nullptr;

}  // namespace

ColumnRecorder::ColumnRecorder(int words_per_number, std::size_t input_count) : previous_(recorder) {
    program_.words_per_number = words_per_number;
    program_.input_count = program_.column_count = input_count;
    recorder = this;
}
ColumnRecorder::~ColumnRecorder() { recorder = previous_; }

ColumnRecorder& ColumnRecorder::current() {
    if (!recorder)
        throw std::logic_error("a column operation was used on a thread without a ColumnRecorder: construct one first");
    return *recorder;
}

ColumnIndex ColumnRecorder::constant(double x) {
    const auto [entry, is_new] = constants_.try_emplace(std::bit_cast<std::uint64_t>(x), ColumnIndex{0});
    if (is_new) {
        program_.constants.push_back(x);
        entry->second = static_cast<ColumnIndex>(-static_cast<int>(program_.constants.size()));
    }
    return entry->second;
}

std::array<ColumnIndex, ColumnInstruction::max_outputs> ColumnRecorder::record(ColumnInstruction instruction) {
    Key key{static_cast<std::int32_t>(instruction.operation), instruction.exact};
    for (std::size_t k = 0; k < instruction.input_count; ++k) key[2 + k] = instruction.in[k];
    const auto [entry, is_new] = results_.try_emplace(key);
    if (!is_new) return entry->second;
    for (std::size_t k = 0; k < instruction.output_count; ++k) {
        if (program_.column_count > static_cast<std::size_t>(std::numeric_limits<ColumnIndex>::max()))
            throw std::logic_error("a program has more columns than a ColumnIndex can number");
        instruction.out[k] = static_cast<ColumnIndex>(program_.column_count++);
    }
    program_.instructions.push_back(instruction);
    return entry->second = instruction.out;
}

ColumnProgram ColumnRecorder::finish(std::vector<ColumnIndex> outputs) {
    std::vector<bool> is_needed(program_.column_count, false);
    const auto mark_needed = [&is_needed](ColumnIndex index) {
        if (index >= 0) is_needed[index] = true;
    };
    for (const ColumnIndex index : outputs) mark_needed(index);

    // Keeps the instructions that an output needs, from the last to the first.
    std::vector<ColumnInstruction> needed_instructions;
    for (std::size_t i = program_.instructions.size(); i-- > 0;) {
        const ColumnInstruction& instruction = program_.instructions[i];
        bool has_needed_result = instruction.operation == ColumnOperation::gate;
        for (std::size_t k = 0; k < instruction.output_count; ++k) has_needed_result |= is_needed[instruction.out[k]];
        if (!has_needed_result) continue;
        for (std::size_t k = 0; k < instruction.input_count; ++k) mark_needed(instruction.in[k]);
        needed_instructions.push_back(instruction);
    }

    program_.instructions.assign(needed_instructions.rbegin(), needed_instructions.rend());
    program_.outputs = std::move(outputs);
    return std::move(program_);
}

}  // namespace lostbits::number::wide
