// Anti-aliased lines and areas on a canvas.
#pragma once

#include <span>
#include <vector>

#include "output/image/canvas.hpp"

namespace lostbits::output::image {

/// A place on a canvas: pixel (i, j) covers i..i+1 by j..j+1, so its middle is at i + 1/2.
struct Point {
    double x, y;
};

/// One coat of one colour: shapes are gathered as coverage and painted together, so that a line that crosses itself,
/// or the joint of two segments, is not darker than the rest. What lies outside the rectangle is cut off.
class Stroke {
public:
    Stroke(int x, int y, int width, int height);

    /// The segments between the points, `thickness` pixels wide with round ends. `dashes` are the lengths of ink and
    /// gap in turn, running on from segment to segment; empty = solid.
    void polyline(std::span<const Point> points, double thickness, std::span<const double> dashes = {});

    void disc(Point centre, double radius) { segment(centre, centre, 2 * radius); }

    /// A convex polygon, corners in either order.
    void polygon(std::span<const Point> corners);

    /// What lies between two polylines with the same x, the first above the second.
    void area(std::span<const Point> above, std::span<const Point> below);

    /// Blends `colour` into the canvas in linear light and forgets the shapes.
    void paint(Canvas& canvas, Rgb8 colour, double opacity = 1);

private:
    void segment(Point a, Point b, double thickness);
    /// Calls `coverage(centre of the pixel)` for the pixels near a box and keeps the greater coverage.
    template <class F>
    void cover(double x0, double y0, double x1, double y1, F coverage);

    int x_, y_, width_, height_;
    std::vector<float> coverage_;
};

}  // namespace lostbits::output::image
