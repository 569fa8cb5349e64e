// `[camera]` of a scene file.
#pragma once

#include "scene/file/stored_numbers.hpp"

namespace lostbits::scene::file {

/// Reads the table. InputError with a position for anything that makes no picture.
Camera read_camera(toml::TableReader table, const StoredNumbers& numbers);

}  // namespace lostbits::scene::file
