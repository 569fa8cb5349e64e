// The tables of a choice beside its candidates and its room: safe offsets, and what stands in the way.
#pragma once

#include <vector>

#include "measure/choice/obstacle.hpp"
#include "measure/choice/room.hpp"
#include "output/table/table.hpp"

namespace lostbits::output::choice {

/// A strategy that is safe to one side or to both.
struct SafeOffsetRow {
    std::string_view side;
    measure::offset::SafeStrategy safe;
};
table::Table<SafeOffsetRow> offset_table();
std::vector<SafeOffsetRow> offset_rows(const measure::choice::SafeOffsets& offsets);

/// A choice of inputs that come wider.
struct InputRow {
    const measure::choice::Obstacle* obstacle;
    const measure::choice::InputTrial* trial;
};
table::Table<InputRow> input_table();

/// `binary32`, `binary64`, `p31`: a format of inputs.
std::string name_of_inputs(const FloatFormat& format);

}  // namespace lostbits::output::choice
