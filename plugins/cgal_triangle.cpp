// CGAL 5.5.1: intersection of a Ray_3 and a Triangle_3 (Intersections_3/internal/Ray_3_Triangle_3_intersection.h), in
// three kinds of kernel: one that rounds (Simple_cartesian), one with exact predicates, and an exact one. A Ray_3 holds
// two points, so all but the exact kernel round origin + direction. If the intersection is a segment (the ray lies in
// the plane of the triangle), it counts as a miss, as in lostbits itself.
#include <cmath>

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/intersections.h>
#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;

template <class K, class T>
Answer<T> triangle(const Ray<T>& r, const Triangle<T>& s) {
    using Point = typename K::Point_3;
    for (int k = 0; k < 3; ++k)  // the exact kernel throws on others
        if (!std::isfinite(r.origin[k]) || !std::isfinite(r.direction[k])) return miss;
    const auto point = [](const T(&p)[3]) { return Point(p[0], p[1], p[2]); };
    const typename K::Triangle_3 primitive(point(s.a), point(s.b), point(s.c));
    const typename K::Ray_3 ray(point(r.origin), typename K::Vector_3(r.direction[0], r.direction[1], r.direction[2]));
    if (ray.is_degenerate() || primitive.is_degenerate()) return miss;  // its preconditions
    const auto met = CGAL::intersection(ray, primitive);
    const Point* const p = met ? boost::get<Point>(&*met) : nullptr;
    if (p == nullptr) return miss;
    int k = std::fabs(r.direction[1]) > std::fabs(r.direction[0]) ? 1 : 0;
    if (std::fabs(r.direction[2]) > std::fabs(r.direction[k])) k = 2;
    return T(CGAL::to_double((p->cartesian(k) - r.origin[k]) / typename K::FT(r.direction[k])));
}

constexpr Form contract(Form form, const char* kernel) { return form.first_root().ignores_end().titled(kernel); }
template <class T>
using Cartesian = CGAL::Simple_cartesian<T>;
using Predicates = CGAL::Exact_predicates_inexact_constructions_kernel;
using Exact = CGAL::Exact_predicates_exact_constructions_kernel;

LOSTBITS_FORMS(contract(form<triangle<Cartesian<float>, float>>("cgal.triangle"), "intersection, Simple_cartesian"),
               contract(form<triangle<Cartesian<double>, double>>("cgal.triangle"), "intersection, Simple_cartesian"),
               contract(form<triangle<Predicates, double>>("cgal.triangle_predicates"),
                        "intersection, exact predicates"),
               contract(form<triangle<Exact, double>>("cgal.triangle_exact"), "intersection, exact kernel"))
