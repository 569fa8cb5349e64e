#include "number/wide/column_program.hpp"

#include <bit>
#include <limits>
#include <stdexcept>

namespace lostbits::number::wide {

namespace {

thread_local ColumnRecorder* recorder = nullptr;

}  // namespace

ColumnRecorder::ColumnRecorder(int words, std::size_t inputs) : before_(recorder) {
    program_.words = words;
    program_.inputs = program_.columns = inputs;
    recorder = this;
}
ColumnRecorder::~ColumnRecorder() { recorder = before_; }

ColumnRecorder& ColumnRecorder::current() {
    if (!recorder) throw std::logic_error("a column is recorded, and no program is being written");
    return *recorder;
}

ColumnIndex ColumnRecorder::constant(double x) {
    const auto [known, is_new] = constants_.try_emplace(std::bit_cast<std::uint64_t>(x), ColumnIndex{0});
    if (is_new) {
        program_.constants.push_back(x);
        known->second = static_cast<ColumnIndex>(-static_cast<int>(program_.constants.size()));
    }
    return known->second;
}

std::array<ColumnIndex, ColumnInstruction::most_out> ColumnRecorder::record(ColumnInstruction step) {
    Key key{static_cast<std::int32_t>(step.operation), step.exact};
    for (std::size_t k = 0; k < step.ins; ++k) key[2 + k] = step.in[k];
    const auto [known, is_new] = known_.try_emplace(key);
    if (!is_new) return known->second;
    for (std::size_t k = 0; k < step.outs; ++k) {
        if (program_.columns > static_cast<std::size_t>(std::numeric_limits<ColumnIndex>::max()))
            throw std::logic_error("a program has more columns than places");
        step.out[k] = static_cast<ColumnIndex>(program_.columns++);
    }
    program_.instructions.push_back(step);
    return known->second = step.out;
}

ColumnProgram ColumnRecorder::finish(std::vector<ColumnIndex> outputs) {
    std::vector<bool> wanted(program_.columns, false);
    const auto want = [&wanted](ColumnIndex place) {
        if (place >= 0) wanted[static_cast<std::size_t>(place)] = true;
    };
    for (const ColumnIndex place : outputs) want(place);
    std::vector<ColumnInstruction> kept;
    for (std::size_t i = program_.instructions.size(); i-- > 0;) {
        const ColumnInstruction& step = program_.instructions[i];
        bool is_wanted = step.operation == ColumnOperation::gate;
        for (std::size_t k = 0; k < step.outs; ++k) is_wanted |= wanted[static_cast<std::size_t>(step.out[k])];
        if (!is_wanted) continue;
        for (std::size_t k = 0; k < step.ins; ++k) want(step.in[k]);
        kept.push_back(step);
    }
    program_.instructions.assign(kept.rbegin(), kept.rend());
    program_.outputs = std::move(outputs);
    return std::move(program_);
}

}  // namespace lostbits::number::wide
