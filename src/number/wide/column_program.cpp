#include "number/wide/column_program.hpp"

#include <bit>
#include <limits>
#include <stdexcept>

namespace lostbits::number::wide {

namespace {

thread_local ColumnRecorder* recorder = nullptr;

}  // namespace

ColumnRecorder::ColumnRecorder(int words, std::size_t input_count) : previous_(recorder) {
    program_.words = words;
    program_.input_count = program_.columns = input_count;
    recorder = this;
}
ColumnRecorder::~ColumnRecorder() { recorder = previous_; }

ColumnRecorder& ColumnRecorder::current() {
    if (!recorder) throw std::logic_error("a column is recorded, and no program is being written");
    return *recorder;
}

ColumnIndex ColumnRecorder::constant(double x) {
    const auto [found, is_new] = constants_.try_emplace(std::bit_cast<std::uint64_t>(x), ColumnIndex{0});
    if (is_new) {
        program_.constants.push_back(x);
        found->second = static_cast<ColumnIndex>(-static_cast<int>(program_.constants.size()));
    }
    return found->second;
}

std::array<ColumnIndex, ColumnInstruction::max_outputs> ColumnRecorder::record(ColumnInstruction instruction) {
    Key key{static_cast<std::int32_t>(instruction.operation), instruction.exact};
    for (std::size_t k = 0; k < instruction.input_count; ++k) key[2 + k] = instruction.in[k];
    const auto [found, is_new] = results_.try_emplace(key);
    if (!is_new) return found->second;
    for (std::size_t k = 0; k < instruction.output_count; ++k) {
        if (program_.columns > static_cast<std::size_t>(std::numeric_limits<ColumnIndex>::max()))
            throw std::logic_error("a program has more columns than places");
        instruction.out[k] = static_cast<ColumnIndex>(program_.columns++);
    }
    program_.instructions.push_back(instruction);
    return found->second = instruction.out;
}

ColumnProgram ColumnRecorder::finish(std::vector<ColumnIndex> outputs) {
    std::vector<bool> is_needed(program_.columns, false);
    const auto mark_needed = [&is_needed](ColumnIndex index) {
        if (index >= 0) is_needed[static_cast<std::size_t>(index)] = true;
    };
    for (const ColumnIndex index : outputs) mark_needed(index);
    std::vector<ColumnInstruction> needed_instructions;
    for (std::size_t i = program_.instructions.size(); i-- > 0;) {
        const ColumnInstruction& instruction = program_.instructions[i];
        bool has_needed_result = instruction.operation == ColumnOperation::gate;
        for (std::size_t k = 0; k < instruction.output_count; ++k)
            has_needed_result |= is_needed[static_cast<std::size_t>(instruction.out[k])];
        if (!has_needed_result) continue;
        for (std::size_t k = 0; k < instruction.input_count; ++k) mark_needed(instruction.in[k]);
        needed_instructions.push_back(instruction);
    }
    program_.instructions.assign(needed_instructions.rbegin(), needed_instructions.rend());
    program_.outputs = std::move(outputs);
    return std::move(program_);
}

}  // namespace lostbits::number::wide
