// CGAL 5.5.1: do_intersect of a Ray_3 with a Sphere_3 and with an Iso_cuboid_3. A ray that has an end is a Segment_3.
// One kernel rounds (Simple_cartesian), the other does not (Exact_predicates_exact_constructions). A Ray_3 holds two
// points, so the first kernel rounds the second point, origin + direction. Sphere_3 takes the radius squared.
// Intersections_3/internal/Ray_3_Sphere_3_do_intersect.h:25, Bbox_3_Segment_3_do_intersect.h:135.
#include <cmath>

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/intersections.h>
#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;
using Inexact = CGAL::Simple_cartesian<double>;
using Exact = CGAL::Exact_predicates_exact_constructions_kernel;

template <class K>
typename K::Point_3 point(const double (&p)[3]) {
    return {p[0], p[1], p[2]};
}
template <class K, class Primitive>
bool meets(const Ray<double>& ray, const Primitive& primitive) {
    for (const double* const v : {ray.origin, ray.direction})  // the exact kernel throws on others
        if (!(std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]))) return false;
    const auto from = point<K>(ray.origin);
    const typename K::Vector_3 along(ray.direction[0], ray.direction[1], ray.direction[2]);
    if (ray.end <= 1e300) return CGAL::do_intersect(typename K::Segment_3(from, from + along * ray.end), primitive);
    return CGAL::do_intersect(typename K::Ray_3(from, along), primitive);
}
template <class K>
bool sphere(const Ray<double>& ray, const Sphere<double>& s) {
    return meets<K>(ray, typename K::Sphere_3(point<K>(s.centre), CGAL::square(typename K::FT(s.radius))));
}
template <class K>
bool box(const Ray<double>& ray, const Box<double>& b) {
    return meets<K>(ray, typename K::Iso_cuboid_3(point<K>(b.lo), point<K>(b.hi)));
}

LOSTBITS_FORMS(form<sphere<Inexact>>("cgal.sphere").titled("do_intersect of CGAL 5.5.1, Simple_cartesian<double>"),
               form<sphere<Exact>>("cgal.sphere_exact").titled("do_intersect of CGAL 5.5.1, exact kernel"),
               form<box<Inexact>>("cgal.box").titled("do_intersect of CGAL 5.5.1, Simple_cartesian<double>"),
               form<box<Exact>>("cgal.box_exact").titled("do_intersect of CGAL 5.5.1, exact kernel"))
