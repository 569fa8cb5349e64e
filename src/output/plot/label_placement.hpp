// Places the labels of points so that no label lies on another.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "output/image/image.hpp"

namespace lostbits::output::plot {

/// Rectangle on a page, y downwards.
struct LabelBox {
    double x = 0, y = 0, width = 0, height = 0;

    [[nodiscard]] bool overlaps(const LabelBox& o) const {
        return x < o.x + o.width && o.x < x + width && y < o.y + o.height && o.y < y + height;
    }
    [[nodiscard]] bool contains(const LabelBox& o) const {
        return x <= o.x && y <= o.y && o.x + o.width <= x + width && o.y + o.height <= y + height;
    }
    /// Point of the box that is nearest to `to`.
    [[nodiscard]] image::Point nearest(image::Point to) const;
};

/// Request for the place of a label: the point that it names, and its size in pixels.
struct LabelRequest {
    image::Point point;
    double width, height;
};

struct LabelLimits {
    LabelBox page;                        ///< labels stay inside this box
    std::span<const LabelBox> forbidden;  ///< labels never cover these
    std::span<const LabelBox> avoided;    ///< covering one of these has a price
};

/// Places each label near its point. The result is nothing for a label without space. The method is greedy: in the
/// order of the requests, each label gets the free position with the lowest price, and among equals the nearest. In a
/// free position, neither the label nor its leader (the straight line to its point) lies on another label. The price is
/// the sum of
/// - the distance from the point,
/// - a price for each `avoided` box that the label covers,
/// - a price if its leader crosses another leader,
/// - a price for each pixel of its leader over an `avoided` box.
std::vector<std::optional<LabelBox>> place_labels(std::span<const LabelRequest> requests, const LabelLimits& limits);

}  // namespace lostbits::output::plot
