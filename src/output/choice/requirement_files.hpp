// The files of what each pixel requires: requirement.csv and requirement.png.
#pragma once

#include <filesystem>
#include <string>

#include "measure/choice/requirement.hpp"
#include "output/choice/choice_text.hpp"
#include "output/table/table.hpp"

namespace lostbits::output::choice {

struct RequirementRow {
    std::string_view form, format;
    file::Cell time_ns;
    std::uint64_t met, required, pixels;
};
table::Table<RequirementRow> requirement_table();
/// A row per form and format with a pixel to its name or a time, cheapest first; then one per format under `any`, and
/// one for the pixels on which nothing meets the wish.
std::vector<RequirementRow> requirement_rows(const Chosen& chosen, const measure::choice::Requirement& requirement);

/// Left the cheapest that meets the wish, right the narrowest format in which any form does; pixel by pixel.
void draw_requirement(const std::filesystem::path& path, const Chosen& chosen,
                      const measure::choice::Requirement& requirement);

/// What formats the pixels need, and the least that switching between forms could cost; two or three lines.
std::string in_words(const Chosen& chosen, const measure::choice::Requirement& requirement);

}  // namespace lostbits::output::choice
