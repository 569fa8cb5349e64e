#include "predicates.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>

namespace bench {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

Kernel::Point_3 point(const Point& p) { return {p[0], p[1], p[2]}; }

}  // namespace

void decide_by_orientations(const std::vector<RayOfPoints>& rays, const std::array<Point, 3>& triangle,
                            std::vector<unsigned char>& hit) {
    const auto a = point(triangle[0]), b = point(triangle[1]), c = point(triangle[2]);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const auto from = point(rays[i].from), through = point(rays[i].through);
        const auto ab = CGAL::orientation(from, through, a, b), bc = CGAL::orientation(from, through, b, c);
        hit[i] = 0;
        if (ab * bc < 0) continue;
        const auto ca = CGAL::orientation(from, through, c, a);
        if (ab * ca < 0 || bc * ca < 0) continue;
        const auto side = ab != 0 ? ab : bc != 0 ? bc : ca;
        hit[i] = side != 0 && side * CGAL::orientation(a, b, c, from) <= 0;
    }
}

void decide_by_do_intersect(const std::vector<RayOfPoints>& rays, const std::array<Point, 3>& triangle,
                            std::vector<unsigned char>& hit) {
    const Kernel::Triangle_3 primitive(point(triangle[0]), point(triangle[1]), point(triangle[2]));
    for (std::size_t i = 0; i < rays.size(); ++i)
        hit[i] = CGAL::do_intersect(Kernel::Ray_3(point(rays[i].from), point(rays[i].through)), primitive);
}

}  // namespace bench
