#include "output/plot/label_placement.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace lostbits::output::plot {

using image::Point;

namespace {

constexpr std::array<double, 10> distances{6, 11, 18, 27, 40, 56, 76, 100, 130, 170};  // pixels from the point
// Twelve directions: right, left, above and below before the corners. Cosines and sines are written out, so that they
// are the same on every machine.
constexpr std::array<std::pair<double, double>, 12> directions{{{1, 0},
                                                                {-1, 0},
                                                                {0, -1},
                                                                {0, 1},
                                                                {0.866, -0.5},
                                                                {-0.866, -0.5},
                                                                {0.866, 0.5},
                                                                {-0.866, 0.5},
                                                                {0.5, -0.866},
                                                                {-0.5, -0.866},
                                                                {0.5, 0.866},
                                                                {-0.5, 0.866}}};
// Covering a box costs more than the largest distance, so it happens only if every position covers something.
constexpr double between_labels = 3, price_of_cover = 400;  // pixels
constexpr double leader_step = 3;

/// The line from a point to its label, as small boxes.
std::vector<Box2> leader(Point from, const Box2& label) {
    const Point to = label.nearest(from);
    const double length = std::hypot(to.x - from.x, to.y - from.y);
    const int steps = static_cast<int>(length / leader_step);
    std::vector<Box2> out;
    for (int i = 1; i < steps; ++i) {
        const double s = static_cast<double>(i) / steps;
        out.push_back({std::lerp(from.x, to.x, s) - 1, std::lerp(from.y, to.y, s) - 1, 2, 2});
    }
    return out;
}

Box2 grown(const Box2& b, double by) { return {b.x - by, b.y - by, b.width + 2 * by, b.height + 2 * by}; }

class Placement {
public:
    explicit Placement(const LabelLimits& places) : places_(places) {}

    std::optional<Box2> add(const LabelRequest& request) {
        std::optional<Box2> best;
        double least = 0;
        for (const double distance : distances) {
            for (const auto& [x, y] : directions) {
                const double cx = request.at.x + x * (distance + request.width / 2),
                             cy = request.at.y + y * (distance + request.height / 2);
                const Box2 box{cx - request.width / 2, cy - request.height / 2, request.width, request.height};
                if (!is_free(box, request.at)) continue;
                const double price =
                    distance + price_of_cover * static_cast<double>(std::ranges::count_if(
                                                    places_.avoided, [&](const Box2& a) { return a.overlaps(box); }));
                if (best && price >= least) continue;
                best = box;
                least = price;
            }
        }
        if (best) {
            labels_.push_back(*best);
            std::ranges::copy(leader(request.at, *best), std::back_inserter(leaders_));
        }
        return best;
    }

private:
    bool is_free(const Box2& box, Point at) const {
        const auto on = [](std::span<const Box2> boxes, const Box2& b) {
            return std::ranges::any_of(boxes, [&b](const Box2& o) { return o.overlaps(b); });
        };
        if (!places_.limits.contains(box) || on(places_.taken, box) || on(labels_, grown(box, between_labels)) ||
            on(leaders_, box))
            return false;
        return std::ranges::none_of(leader(at, box), [&](const Box2& piece) { return on(labels_, piece); });
    }

    const LabelLimits& places_;
    std::vector<Box2> labels_, leaders_;
};

}  // namespace

Point Box2::nearest(Point to) const { return {std::clamp(to.x, x, x + width), std::clamp(to.y, y, y + height)}; }

std::vector<std::optional<Box2>> place_labels(std::span<const LabelRequest> requests, const LabelLimits& places) {
    Placement placement(places);
    std::vector<std::optional<Box2>> out;
    for (const LabelRequest& request : requests) out.push_back(placement.add(request));
    return out;
}

}  // namespace lostbits::output::plot
