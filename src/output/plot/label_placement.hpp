// Places the names of points, so that no name lies on another.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "output/image/image.hpp"

namespace lostbits::output::plot {

/// Rectangle on a page, y downwards.
struct Box2 {
    double x = 0, y = 0, width = 0, height = 0;

    [[nodiscard]] bool overlaps(const Box2& o) const {
        return x < o.x + o.width && o.x < x + width && y < o.y + o.height && o.y < y + height;
    }
    [[nodiscard]] bool contains(const Box2& o) const {
        return x <= o.x && y <= o.y && o.x + o.width <= x + width && o.y + o.height <= y + height;
    }
    /// Point inside that is nearest to `to`.
    [[nodiscard]] image::Point nearest(image::Point to) const;
};

/// A label of a given size in pixels, for a point.
struct LabelRequest {
    image::Point at;
    double width, height;
};

struct LabelLimits {
    Box2 limits;                    ///< labels stay inside this box
    std::span<const Box2> taken;    ///< labels never cover these
    std::span<const Box2> avoided;  ///< labels cover these only if they must
};

/// Places each label near its point; nothing if there is no space for the label. The method is greedy, in the given
/// order. Of the free positions around the point it takes the one that covers the fewest `avoided` boxes and whose
/// straight line to the point crosses the fewest boxes, and among equals the nearest. Neither a label nor its line lies
/// on another label.
std::vector<std::optional<Box2>> place_labels(std::span<const LabelRequest> requests, const LabelLimits& limits);

}  // namespace lostbits::output::plot
