// `[solid.transform]`: the matrix under which a solid stands, as stored numbers.
#pragma once

#include <optional>

#include "scene/file/stored_numbers.hpp"
#include "shapes/placement.hpp"

namespace lostbits::scene::file {

/// The table `transform` of a solid, where it has one: `matrix` (twelve numbers, row by row), or `scale`, `rotate`,
/// `translate` and `look_at`, done in this order, or `steps`, a list of such tables done one after the other. All is
/// composed in the scene's exact numbers, and rounded once where it is stored: as the matrix from the solid to the
/// world, or, by `stored = "inverse"`, as the one back. InputError with a position, also where the matrix is singular,
/// as written or as stored.
std::optional<Placement<Real>> read_transform(toml::TableReader& solid, const StoredNumbers& numbers);

}  // namespace lostbits::scene::file
