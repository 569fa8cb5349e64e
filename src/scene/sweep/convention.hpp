// The words by which files and options say by whose convention a form is judged.
#pragma once

#include <optional>
#include <string_view>

#include "intersect/info.hpp"
#include "scene/toml/toml_reader.hpp"

namespace lostbits::scene::sweep {

/// `closed`: touching is a hit; `open`: it is a miss (`intersect::convention_name` writes them); nothing for another
/// word.
std::optional<intersect::Touching> convention_named(std::string_view word);

/// The key `convention` of a table: one of the two words. Nothing where it is missing.
std::optional<intersect::Touching> read_convention(toml::TableReader& table);

}  // namespace lostbits::scene::sweep
