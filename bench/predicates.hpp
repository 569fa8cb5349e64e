// Which rays meet a triangle, by the exact predicates of CGAL. A ray is a point and another on it, a triangle three.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace bench {

using Point = std::array<double, 3>;

struct RayOfPoints {
    Point from, through;
};

/// By signs of orientations alone, at most four of a ray: on which side of the line the edges pass, all on one, and on
/// which side of the plane the ray begins. A line in the plane is a miss.
void by_orientations(const std::vector<RayOfPoints>& rays, const std::array<Point, 3>& triangle,
                     std::vector<unsigned char>& hit);

/// By `do_intersect` of a Ray_3 and a Triangle_3, to which a ray in the plane may hit.
void by_do_intersect(const std::vector<RayOfPoints>& rays, const std::array<Point, 3>& triangle,
                     std::vector<unsigned char>& hit);

}  // namespace bench
