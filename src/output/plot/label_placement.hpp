// Where to write the names of points so that none lies on another.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "output/image/image.hpp"

namespace lostbits::output::plot {

/// On a page, y downwards.
struct Box2 {
    double x = 0, y = 0, width = 0, height = 0;

    [[nodiscard]] bool overlaps(const Box2& o) const {
        return x < o.x + o.width && o.x < x + width && y < o.y + o.height && o.y < y + height;
    }
    [[nodiscard]] bool contains(const Box2& o) const {
        return x <= o.x && y <= o.y && o.x + o.width <= x + width && o.y + o.height <= y + height;
    }
    /// The place inside that is nearest to a point.
    [[nodiscard]] image::Point nearest(image::Point to) const;
};

/// A name of so many pixels for a point.
struct LabelWish {
    image::Point at;
    double width, height;
};

struct LabelPlaces {
    Box2 room;                      ///< labels stay inside
    std::span<const Box2> taken;    ///< what a label never covers
    std::span<const Box2> avoided;  ///< what it covers only where it must
};

/// The place of each label, near its point; nothing where there is no room for it. Greedy, in the order of the wishes:
/// of the free places around the point the one that covers least of what is to be avoided, and of those the nearest.
/// Neither a label nor the straight line from its point to it lies on another label.
std::vector<std::optional<Box2>> place_labels(std::span<const LabelWish> wishes, const LabelPlaces& places);

}  // namespace lostbits::output::plot
