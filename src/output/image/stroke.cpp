#include "output/image/stroke.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace lostbits::output::image {
namespace {

constexpr int area_columns = 4;  // samples across a pixel; down it the coverage is exact

std::uint8_t blend(std::uint8_t paper, std::uint8_t ink, double coverage) {
    const double light = linear_light(paper) * (1 - coverage) + linear_light(ink) * coverage;
    return srgb_byte(static_cast<std::uint16_t>(std::lround(light)));
}

/// The part of a..b within the box from `low` to `high` (Liang and Barsky 1984); false where there is none.
bool clip(Point& a, Point& b, Point low, Point high) {
    const double dx = b.x - a.x, dy = b.y - a.y;
    double enter = 0, leave = 1;
    const std::array<std::array<double, 2>, 4> sides{
        {{-dx, a.x - low.x}, {dx, high.x - a.x}, {-dy, a.y - low.y}, {dy, high.y - a.y}}};
    for (const auto& [speed, room] : sides) {
        if (speed == 0) {
            if (room < 0) return false;
        } else if (speed < 0) {
            enter = std::max(enter, room / speed);
        } else {
            leave = std::min(leave, room / speed);
        }
    }
    if (enter > leave) return false;
    b = {a.x + leave * dx, a.y + leave * dy};
    a = {a.x + enter * dx, a.y + enter * dy};
    return true;
}

}  // namespace

Stroke::Stroke(int x, int y, int width, int height)
    : x_(x),
      y_(y),
      width_(std::max(width, 0)),
      height_(std::max(height, 0)),
      coverage_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)) {}

template <class F>
void Stroke::cover(double x0, double y0, double x1, double y1, F coverage) {
    const int i0 = std::max(static_cast<int>(std::floor(x0)) - 1, x_);
    const int j0 = std::max(static_cast<int>(std::floor(y0)) - 1, y_);
    const int i1 = std::min(static_cast<int>(std::ceil(x1)) + 1, x_ + width_);
    const int j1 = std::min(static_cast<int>(std::ceil(y1)) + 1, y_ + height_);
    for (int j = j0; j < j1; ++j) {
        for (int i = i0; i < i1; ++i) {
            float& c = coverage_[static_cast<std::size_t>((j - y_) * width_ + i - x_)];
            c = std::max(c, static_cast<float>(std::clamp(coverage(Point{i + 0.5, j + 0.5}), 0.0, 1.0)));
        }
    }
}

void Stroke::segment(Point a, Point b, double thickness) {
    const double radius = thickness / 2;
    const double dx = b.x - a.x, dy = b.y - a.y, square = dx * dx + dy * dy;
    cover(std::min(a.x, b.x) - radius, std::min(a.y, b.y) - radius, std::max(a.x, b.x) + radius,
          std::max(a.y, b.y) + radius, [&](Point p) {
              const double along = square > 0 ? ((p.x - a.x) * dx + (p.y - a.y) * dy) / square : 0;
              const double t = std::clamp(along, 0.0, 1.0);
              // A pixel is taken for a disc of radius 1/2.
              return radius + 0.5 - std::hypot(p.x - a.x - t * dx, p.y - a.y - t * dy);
          });
}

void Stroke::polyline(std::span<const Point> points, double thickness, std::span<const double> dashes) {
    std::size_t dash = 0;
    double left = dashes.empty() ? 0 : dashes[0];
    for (std::size_t i = 1; i < points.size(); ++i) {
        Point a = points[i - 1], b = points[i];
        if (!clip(a, b, {x_ - 8.0, y_ - 8.0}, {x_ + width_ + 8.0, y_ + height_ + 8.0})) continue;
        if (dashes.empty()) {
            segment(a, b, thickness);
            continue;
        }
        const double length = std::hypot(b.x - a.x, b.y - a.y);
        for (double at = 0; at < length;) {
            const double step = std::min(left, length - at);
            const auto point = [&](double s) { return Point{a.x + (b.x - a.x) * s, a.y + (b.y - a.y) * s}; };
            if (dash % 2 == 0) segment(point(at / length), point((at + step) / length), thickness);
            at += step;
            left -= step;
            if (left <= 1e-9) {
                dash = (dash + 1) % dashes.size();
                left = dashes[dash];
            }
        }
    }
}

void Stroke::polygon(std::span<const Point> corners) {
    if (corners.size() < 3) return;
    double twice = 0, x0 = corners[0].x, x1 = x0, y0 = corners[0].y, y1 = y0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Point a = corners[i], b = corners[(i + 1) % corners.size()];
        twice += a.x * b.y - b.x * a.y;
        x0 = std::min(x0, a.x);
        x1 = std::max(x1, a.x);
        y0 = std::min(y0, a.y);
        y1 = std::max(y1, a.y);
    }
    cover(x0, y0, x1, y1, [&](Point p) {
        double inside = 1;
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const Point a = corners[i], b = corners[(i + 1) % corners.size()];
            const double cross = (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
            const double distance = cross / std::hypot(b.x - a.x, b.y - a.y);
            inside = std::min(inside, 0.5 + (twice < 0 ? -distance : distance));
        }
        return inside;
    });
}

void Stroke::area(std::span<const Point> above, std::span<const Point> below) {
    for (std::size_t i = 1; i < above.size(); ++i) {
        const double x0 = above[i - 1].x, x1 = above[i].x;
        const double first = std::ceil(std::max(x0, x_ * 1.0) * area_columns - 0.5);
        const double end = std::min(x1, x_ + width_ * 1.0) * area_columns - 0.5;
        for (double k = first; k < end; k += 1) {
            const double x = (k + 0.5) / area_columns, t = (x - x0) / (x1 - x0);
            const double top = std::max(above[i - 1].y + t * (above[i].y - above[i - 1].y), y_ * 1.0);
            const double foot = std::min(below[i - 1].y + t * (below[i].y - below[i - 1].y), y_ + height_ * 1.0);
            const int column = static_cast<int>(std::floor(x)) - x_;
            for (int j = static_cast<int>(std::floor(top)); j < foot; ++j) {
                float& c = coverage_[static_cast<std::size_t>((j - y_) * width_ + column)];
                const double part = std::min(foot, j + 1.0) - std::max(top, j * 1.0);
                c = std::min(1.0F, c + static_cast<float>(part / area_columns));
            }
        }
    }
}

void Stroke::paint(Canvas& canvas, Rgb8 colour, double opacity) {
    for (int j = 0; j < height_; ++j) {
        for (int i = 0; i < width_; ++i) {
            float& coverage = coverage_[static_cast<std::size_t>(j * width_ + i)];
            const int x = x_ + i, y = y_ + j;
            if (coverage > 0 && x >= 0 && y >= 0 && x < canvas.width() && y < canvas.height()) {
                const Rgb8 p = canvas.row(y)[static_cast<std::size_t>(x)];
                const double c = coverage * opacity;
                canvas.set(x, y, {blend(p.r, colour.r, c), blend(p.g, colour.g, c), blend(p.b, colour.b, c)});
            }
            coverage = 0;
        }
    }
}

}  // namespace lostbits::output::image
