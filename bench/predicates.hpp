// Decides which rays hit a triangle, by the exact predicates of CGAL. A ray is given by its origin and another point on
// it, a triangle by three points.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace bench {

using Point = std::array<double, 3>;

struct RayOfPoints {
    Point from, through;
};

/// Decides by the signs of at most four orientations per ray: the ray's line must pass all edges on the same side, and
/// the ray must start on the right side of the plane. A line in the plane is a miss.
void decide_by_orientations(const std::vector<RayOfPoints>& rays, const std::array<Point, 3>& triangle,
                            std::vector<unsigned char>& hit);

/// Decides by `do_intersect` of a Ray_3 and a Triangle_3, for which a ray in the plane may hit.
void decide_by_do_intersect(const std::vector<RayOfPoints>& rays, const std::array<Point, 3>& triangle,
                            std::vector<unsigned char>& hit);

}  // namespace bench
