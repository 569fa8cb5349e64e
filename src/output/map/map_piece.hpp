// What the files of a map take of a band: what a shard keeps, and what is written where there are none.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "output/map/map_exr.hpp"
#include "output/pixel/columns.hpp"

namespace lostbits::output::map {

/// Of one row of a map, or of one form of the bits needed.
struct MapPiece {
    int y0 = 0;
    std::vector<pixel::Strip> strips = {};  ///< of each picture that is drawn, in their order
    std::vector<ExrRows> exr = {};
    std::string lines = {};  ///< of the table of pixels

    [[nodiscard]] bool is_empty() const { return strips.empty() && exr.empty() && lines.empty(); }
};

template <class Bits>
void fields(Bits& bits, MapPiece& piece) {
    auto& [y0, strips, exr, lines] = piece;
    bits(y0, strips, exr, lines);
}

/// Takes the pieces of each row in place of the files, of which none is opened then.
using KeepPiece = std::function<void(std::size_t row, MapPiece&& piece)>;

}  // namespace lostbits::output::map
