#include "output/plot/label_placement.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace lostbits::output::plot {

using image::Point;

namespace {

constexpr std::array<double, 10> distances{6, 11, 18, 27, 40, 56, 76, 100, 130, 170};  // pixels from the point
// Directions in steps of 15 degrees: right, left, up and down before the others. Cosines and sines are written out, so
// that they are the same on every machine.
constexpr std::array<std::pair<double, double>, 24> directions{
    {{1, 0},          {-1, 0},          {0, -1},         {0, 1},           {0.866, -0.5},   {-0.866, -0.5},
     {0.866, 0.5},    {-0.866, 0.5},    {0.5, -0.866},   {-0.5, -0.866},   {0.5, 0.866},    {-0.5, 0.866},
     {0.707, -0.707}, {-0.707, -0.707}, {0.707, 0.707},  {-0.707, 0.707},  {0.966, -0.259}, {-0.966, -0.259},
     {0.966, 0.259},  {-0.966, 0.259},  {0.259, -0.966}, {-0.259, -0.966}, {0.259, 0.966},  {-0.259, 0.966}}};
// Prices are in pixels of distance. One covered box or one crossing costs more than the largest distance. A leader over
// a box costs twice its length on the box, so a long leader over boxes can cost more than a covered box.
constexpr double min_label_distance = 3, min_line_distance = 1, price_per_cover = 400, price_of_crossing = 500,
                 price_per_pixel_over_box = 2;

/// The line from a point to its label.
struct Leader {
    Point from, to;
};

double length_of(const Leader& line) { return std::hypot(line.to.x - line.from.x, line.to.y - line.from.y); }

/// Length of the part of a line inside a box, by the method of Liang and Barsky.
double length_inside(const Leader& line, const LabelBox& box) {
    double t_enter = 0, t_exit = 1;
    const auto clip = [&](double from, double to, double low, double high) {
        if (from == to) {
            if (from <= low || from >= high) t_exit = 0;
            return;
        }
        const double t_low = (low - from) / (to - from), t_high = (high - from) / (to - from);
        t_enter = std::max(t_enter, std::min(t_low, t_high));
        t_exit = std::min(t_exit, std::max(t_low, t_high));
    };
    clip(line.from.x, line.to.x, box.x, box.x + box.width);
    clip(line.from.y, line.to.y, box.y, box.y + box.height);
    return std::max(t_exit - t_enter, 0.0) * length_of(line);
}

bool segments_cross(const Leader& a, const Leader& b) {
    const auto side = [](const Leader& line, Point p) {
        return (line.to.x - line.from.x) * (p.y - line.from.y) - (line.to.y - line.from.y) * (p.x - line.from.x);
    };
    return side(a, b.from) * side(a, b.to) < 0 && side(b, a.from) * side(b, a.to) < 0;
}

LabelBox with_margin(const LabelBox& b, double margin) {
    return {b.x - margin, b.y - margin, b.width + 2 * margin, b.height + 2 * margin};
}

class Placer {
public:
    explicit Placer(const LabelLimits& limits) : limits_(limits) {}

    std::optional<LabelBox> add(const LabelRequest& request) {
        std::optional<LabelBox> best;
        double min_price = 0;
        for (const double distance : distances) {
            for (const auto& [x, y] : directions) {
                const double cx = request.point.x + x * (distance + request.width / 2),
                             cy = request.point.y + y * (distance + request.height / 2);
                const LabelBox box{cx - request.width / 2, cy - request.height / 2, request.width, request.height};
                if (!is_free(box, request.point)) continue;
                const double price = distance + price_beyond_distance(box, request.point);
                if (best && price >= min_price) continue;
                best = box;
                min_price = price;
            }
        }

        if (best) {
            labels_.push_back(*best);
            leaders_.push_back({request.point, best->nearest(request.point)});
        }
        return best;
    }

private:
    /// Price of a label, without its distance: of the boxes that it covers, of a crossing of its leader with another,
    /// and of its leader over boxes.
    double price_beyond_distance(const LabelBox& box, Point point) const {
        const Leader line{point, box.nearest(point)};
        double price = std::ranges::any_of(leaders_, [&](const Leader& other) { return segments_cross(line, other); })
                           ? price_of_crossing
                           : 0;
        for (const LabelBox& avoided : limits_.avoided)
            price +=
                (avoided.overlaps(box) ? price_per_cover : 0) + price_per_pixel_over_box * length_inside(line, avoided);
        return price;
    }

    bool is_free(const LabelBox& box, Point point) const {
        const auto overlaps_any = [](std::span<const LabelBox> boxes, const LabelBox& b) {
            return std::ranges::any_of(boxes, [&b](const LabelBox& o) { return o.overlaps(b); });
        };
        const auto are_apart = [](const Leader& line, const LabelBox& label) {
            return length_inside(line, with_margin(label, min_line_distance)) == 0;
        };

        const Leader leader{point, box.nearest(point)};
        return limits_.page.contains(box) && !overlaps_any(limits_.forbidden, box) &&
               !overlaps_any(labels_, with_margin(box, min_label_distance)) &&
               std::ranges::all_of(leaders_, [&](const Leader& line) { return are_apart(line, box); }) &&
               std::ranges::all_of(labels_, [&](const LabelBox& label) { return are_apart(leader, label); });
    }

    const LabelLimits& limits_;
    std::vector<LabelBox> labels_;
    std::vector<Leader> leaders_;
};

}  // namespace

Point LabelBox::nearest(Point to) const { return {std::clamp(to.x, x, x + width), std::clamp(to.y, y, y + height)}; }

std::vector<std::optional<LabelBox>> place_labels(std::span<const LabelRequest> requests, const LabelLimits& limits) {
    Placer placer(limits);
    std::vector<std::optional<LabelBox>> boxes;
    for (const LabelRequest& request : requests) boxes.push_back(placer.add(request));
    return boxes;
}

}  // namespace lostbits::output::plot
