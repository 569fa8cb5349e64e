// `[claim.given]`: the kinds of subjects and their keys.
#pragma once

#include "scene/claim/claims_file.hpp"
#include "scene/toml/toml_reader.hpp"

namespace lostbits::scene::claim {

/// What the claim, whose profile is known, is measured on, with its form and format. InputError with a position.
void read_given(toml::TableReader table, Claim& claim);

}  // namespace lostbits::scene::claim
