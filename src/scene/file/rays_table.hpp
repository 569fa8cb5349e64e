// The range of the rays in scene files.
#pragma once

#include "scene/file/scene.hpp"
#include "scene/file/stored_numbers.hpp"
#include "scene/toml/toml_reader.hpp"

namespace lostbits::scene::file {

/// Reads `[rays]`: tmin (0 where it is missing), tmax (nowhere) and open_ends, in lengths of the camera's directions.
/// InputError with a position for a tmin below 0 and a range that holds no t, also once rounded to binary32 where
/// inputs are shared.
Range<double> read_rays(toml::TableReader table, Inputs inputs, const StoredNumbers& numbers);

}  // namespace lostbits::scene::file
