// The tables of a choice beside its candidates and its room: safe offsets, and what stands in the way.
#pragma once

#include <vector>

#include "measure/choice/obstacle.hpp"
#include "measure/choice/respawn.hpp"
#include "output/file/csv.hpp"

namespace lostbits::output::choice {

std::vector<file::Column> offset_columns();
void add_offsets(file::CsvWriter& csv, const measure::choice::SafeOffsets& offsets);

std::vector<file::Column> input_columns();
void add_inputs(file::CsvWriter& csv, const measure::choice::Obstacle& obstacle);

/// `binary32`, `binary64`, `p31`: a format of inputs.
std::string name_of_inputs(const FloatFormat& format);

}  // namespace lostbits::output::choice
