// The files of what each pixel requires: requirement.csv and requirement.png.
#pragma once

#include <filesystem>
#include <string>

#include "measure/choice/requirement.hpp"
#include "output/choice/choice_text.hpp"
#include "output/file/csv.hpp"

namespace lostbits::output::choice {

extern const std::vector<file::Column> requirement_columns;

/// A row per form and format with a pixel to its name or a time, cheapest first; then one per format under `any`, and
/// one for the pixels on which nothing meets the wish.
void write_requirement(file::CsvWriter& csv, const Chosen& chosen, const measure::choice::Requirement& requirement);

/// Left the cheapest that meets the wish, right the narrowest format in which any form does; pixel by pixel.
void draw_requirement(const std::filesystem::path& path, const Chosen& chosen,
                      const measure::choice::Requirement& requirement);

/// What formats the pixels need, and the least that switching between forms could cost; two or three lines.
std::string in_words(const Chosen& chosen, const measure::choice::Requirement& requirement);

}  // namespace lostbits::output::choice
