// CGAL 5.5.1, Cartesian/Ray_3.h: Ray_3(p, v), "a ray starting at p with direction v", keeps p and p + v. In a kernel
// that rounds, a v that is short against p is rounded with it: the direction turns, or is gone. A limit of what a ray
// holds.
//   g++ -frounding-math cgal_ray.cpp -lgmp -lmpfr && ./a.out
#include <cstdio>
#include <initializer_list>

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/intersections.h>

template <class K>
void show(const char* kernel, double length) {  // from (3, 4, 12) at (0, 0.9, 0), within the unit sphere
    const typename K::Point_3 p(3, 4, 12);
    const typename K::Vector_3 v(-3 * length, -3.1 * length, -12 * length);
    const typename K::Ray_3 ray(p, v);
    const auto kept = ray.to_vector();
    const bool hit = CGAL::do_intersect(ray, typename K::Sphere_3(typename K::Point_3(0, 0, 0), 1));
    std::printf("%s, direction %g (-3, -3.1, -12): expected hit, got %s; the ray holds %g (%g, %g, %g)\n", kernel,
                length, hit ? "hit" : "miss", length, CGAL::to_double(kept.x()) / length,
                CGAL::to_double(kept.y()) / length, CGAL::to_double(kept.z()) / length);
}

int main() {
    for (const double length : {1.0, 0x1p-48, 0x1p-51, 0x1p-54, 0x1p-60}) {
        show<CGAL::Simple_cartesian<double>>("rounding", length);
        show<CGAL::Exact_predicates_exact_constructions_kernel>("exact   ", length);
    }
}
