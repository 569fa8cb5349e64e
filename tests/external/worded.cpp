// Forms as in public code, each with the contract that fits it, and some with wrong contracts.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>

#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;

namespace {

struct Roots {
    bool hit;
    double near, far;
};

/// Computes in double, which is right for float.
Roots roots(const Ray<float>& ray, const Sphere<float>& sphere) {
    const auto in = [](float x) { return static_cast<double>(x); };
    double a = 0, h = 0, f[3], c = -in(sphere.radius) * in(sphere.radius);
    for (int k = 0; k < 3; ++k) {
        f[k] = in(ray.origin[k]) - in(sphere.centre[k]);
        a += in(ray.direction[k]) * in(ray.direction[k]);
        h += f[k] * in(ray.direction[k]);
        c += f[k] * f[k];
    }
    const double disc = h * h - a * c, root = std::sqrt(disc);
    return {disc >= 0, (-h - root) / a, (-h + root) / a};
}
Roots roots(const Ray<float>& ray, const Box<float>& box) {
    Roots r{true, -HUGE_VAL, HUGE_VAL};
    for (int k = 0; k < 3; ++k) {
        const double o = static_cast<double>(ray.origin[k]), d = static_cast<double>(ray.direction[k]);
        const double lo = static_cast<double>(box.lo[k]), hi = static_cast<double>(box.hi[k]);
        if (d == 0) {
            if (o < lo || o > hi) r.hit = false;
            continue;
        }
        r.near = std::max(r.near, std::min((lo - o) / d, (hi - o) / d));
        r.far = std::min(r.far, std::max((lo - o) / d, (hi - o) / d));
    }
    r.hit = r.hit && r.near <= r.far;
    return r;
}

template <class Primitive>
using Form32 = Answer<float>(const Ray<float>&, const Primitive&);

/// Returns one root, or a miss if it is not ahead.
Answer<float> ahead(double t) { return t >= 0 ? Answer<float>(static_cast<float>(t)) : miss; }

Answer<float> unsigned_near(const Ray<float>& ray, const Sphere<float>& sphere) {
    const Roots r = roots(ray, sphere);
    return r.hit && r.far >= 0 ? ahead(std::fabs(r.near)) : miss;
}
Answer<float> touch_is_zero(const Ray<float>& ray, const Sphere<float>& sphere) {
    const Roots r = roots(ray, sphere);
    if (!r.hit || r.far < 0) return miss;
    return r.near == r.far ? Answer<float>(0.0F) : ahead(r.near < 0 ? r.far : r.near);
}
Answer<float> with_tmin(const Ray<float>& ray, const Sphere<float>& sphere) {
    const Roots r = roots(ray, sphere);
    if (!r.hit || r.far < 1e-4) return miss;
    return ahead(r.near < 1e-4 ? r.far : r.near);
}
template <class Primitive>
Answer<float> clipped(const Ray<float>& ray, const Primitive& primitive) {
    const Roots r = roots(ray, primitive);
    if (!r.hit || r.far < 0) return miss;
    return {static_cast<float>(std::max(r.near, 0.0)), static_cast<float>(r.far)};
}
/// The same, but ignores a surface that the ray leaves.
Answer<float> clipped_ahead(const Ray<float>& ray, const Sphere<float>& sphere) {
    const Answer<float> interval = clipped(ray, sphere);
    return interval.hit && interval.far > 0 ? interval : miss;
}
template <class Primitive>
Answer<float> answer_zero_inside(const Ray<float>& ray, const Primitive& primitive) {
    const Roots r = roots(ray, primitive);
    return r.hit && r.far >= 0 ? ahead(std::max(r.near, 0.0)) : miss;
}
template <class Primitive>
Answer<float> exit_inside(const Ray<float>& ray, const Primitive& primitive) {
    const Roots r = roots(ray, primitive);
    return r.hit ? ahead(r.near < 0 ? r.far : r.near) : miss;
}
/// Never hits the surface on which the ray starts if the ray goes in, and always if it goes out.
Answer<float> exit_at_origin(const Ray<float>& ray, const Sphere<float>& sphere) {
    const Roots r = roots(ray, sphere);
    return r.hit ? ahead(r.near > 0 ? r.near : r.far) : miss;
}
template <class Primitive>
Answer<float> misses_inside(const Ray<float>& ray, const Primitive& primitive) {
    const Roots r = roots(ray, primitive);
    return r.hit ? ahead(r.near) : miss;
}
Answer<float> signed_near(const Ray<float>& ray, const Sphere<float>& sphere) {
    const Roots r = roots(ray, sphere);
    return r.hit ? Answer<float>(static_cast<float>(r.near)) : miss;
}
/// Decides by the signs of three edges and t; for the open triangle an edge is outside, and so is t = 0.
template <bool open>
Answer<float> triangle(const Ray<float>& r, const Triangle<float>& triangle) {
    double v[3][3];
    for (int k = 0; k < 3; ++k)
        v[0][k] = double(triangle.a[k]) - r.origin[k], v[1][k] = double(triangle.b[k]) - r.origin[k],
        v[2][k] = double(triangle.c[k]) - r.origin[k];
    const auto sign = [&](const double(&a)[3], const double(&b)[3]) {
        return r.direction[0] * (a[1] * b[2] - a[2] * b[1]) + r.direction[1] * (a[2] * b[0] - a[0] * b[2]) +
               r.direction[2] * (a[0] * b[1] - a[1] * b[0]);
    };
    const double w[3] = {sign(v[1], v[2]), sign(v[2], v[0]), sign(v[0], v[1])}, sum = w[0] + w[1] + w[2];
    double t = 0;  // of a unit direction
    for (int k = 0; k < 3; ++k) {
        const double share = w[k] / sum;
        if (!(open ? share > 0 : share >= 0)) return miss;
        for (int i = 0; i < 3; ++i) t += share * v[k][i] * r.direction[i];
    }
    return t < 0 || (open && t == 0) ? miss : Answer<float>(static_cast<float>(t));
}
/// Returns the first root in the range of the ray; from inside a box, the beginning of the range.
Answer<float> in_range(const Ray<float>& ray, const Sphere<float>& sphere) {
    const Roots r = roots(ray, sphere);
    if (!r.hit) return miss;
    const float near = static_cast<float>(r.near), far = static_cast<float>(r.far), t = near < ray.start ? far : near;
    return t >= ray.start && t <= ray.end ? Answer<float>(t) : miss;
}
Answer<float> box_in_range(const Ray<float>& ray, const Box<float>& b) {
    const Roots r = roots(ray, b);
    const float near = std::max(static_cast<float>(r.near), ray.start);
    return r.hit && near <= static_cast<float>(r.far) && near <= ray.end ? Answer<float>(near) : miss;
}
bool sphere_blocks(const Ray<float>& ray, const Sphere<float>& sphere) { return in_range(ray, sphere).hit; }
Answer<float> open_at_start(const Ray<float>& ray, const Sphere<float>& sphere) {
    const Answer<float> a = in_range(ray, sphere);
    return a.hit && a.near == ray.start ? Answer<float>(miss) : a;
}
Answer<float> forgets_the_start(const Ray<float>& ray, const Sphere<float>& sphere) {
    const Answer<float> a = exit_inside(ray, sphere);
    return a.hit && a.near <= ray.end ? a : Answer<float>(miss);
}
/// Does what much public code does in a debug build.
Answer<float> insists(const Ray<float>& ray, const Sphere<float>& sphere) {
    const float* const d = ray.direction;
    if (!(std::fabs(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - 1) < 1e-3F)) std::abort();
    return exit_inside(ray, sphere);
}
Answer<float> insists_on_numbers(const Ray<float>& ray, const Sphere<float>& sphere) {
    if (std::isnan(ray.origin[2])) std::abort();
    return exit_inside(ray, sphere);
}
bool endless(const Ray<float>& ray, const Box<float>& b) {
    const Roots r = roots(ray, b);
    return r.hit && r.far >= 0;
}

// The same problems in the types of public code.
Answer<float> of_segment(const Segment<float>& segment, const Sphere<float>& sphere) {
    Ray<float> ray{{segment.from[0], segment.from[1], segment.from[2]}, {}, 1};
    for (int k = 0; k < 3; ++k) ray.direction[k] = segment.to[k] - segment.from[k];
    return exit_inside(ray, sphere);
}
Points<float> point_of_segment(const Segment<float>& segment, const Sphere<float>& sphere) {
    const Answer<float> share = of_segment(segment, sphere);
    if (!share.hit) return miss;
    float point[3];
    for (int k = 0; k < 3; ++k) point[k] = segment.from[k] + share.near * (segment.to[k] - segment.from[k]);
    return point;
}
Thickness<float> thickness_of_segment(const Segment<float>& segment, const Sphere<float>& sphere) {
    Ray<float> ray{{segment.from[0], segment.from[1], segment.from[2]}, {}, 1};
    for (int k = 0; k < 3; ++k) ray.direction[k] = segment.to[k] - segment.from[k];
    const Roots r = roots(ray, sphere);
    return r.hit ? Thickness<float>(static_cast<float>(r.near), static_cast<float>(r.far - r.near)) : miss;
}
Answer<float> of_centre(const Ray<float>& ray, const CentreBox<float>& b) {
    Box<float> box{};
    for (int k = 0; k < 3; ++k) box.lo[k] = b.centre[k] - b.half[k], box.hi[k] = b.centre[k] + b.half[k];
    return answer_zero_inside(ray, box);
}
Answer<float> of_origin(const Ray<float>& ray, const SphereAtOrigin<float>& s) {
    return exit_inside(ray, Sphere<float>{{0, 0, 0}, s.radius});
}
Thickness<float> thickness(const Ray<float>& ray, const Sphere<float>& sphere) {
    const Roots r = roots(ray, sphere);
    if (!r.hit) return miss;
    return {static_cast<float>(r.near), static_cast<float>(r.far - r.near)};
}
Answer<float> thickness_for_far(const Ray<float>& ray, const Sphere<float>& sphere) {
    const Thickness<float> t = thickness(ray, sphere);
    return t.hit ? Answer<float>(t.near, t.thickness) : miss;
}
Points<float> points(const Ray<float>& ray, const Sphere<float>& sphere) {
    const Roots r = roots(ray, sphere);
    if (!r.hit) return miss;
    float near[3], far[3];
    for (int k = 0; k < 3; ++k) {
        near[k] = ray.origin[k] + static_cast<float>(r.near) * ray.direction[k];
        far[k] = ray.origin[k] + static_cast<float>(r.far) * ray.direction[k];
    }
    return {near, far};
}

// Layout that a library had when compiled with the first version of the header. It must stay readable.
static_assert(sizeof(lb_form) == 72 && offsetof(lb_form, shape) == 24 && offsetof(lb_form, at_origin) == 44);
static_assert(offsetof(lb_form, flags) == 48 && offsetof(lb_form, own) == 56 && offsetof(lb_form, run) == 64);
static_assert(sizeof(lb_batch) == 72 && offsetof(lb_batch, starts) == 64 && offsetof(lb_batch, near_far) == 40 &&
              offsetof(lb_batch, own) == 56);
static_assert(LOSTBITS_PLUGIN_ABI == 1 && LB_LINE == 1 && LB_NO_END == 2 && LB_ONE_THREAD == 4 && LB_MISS == 1);

using S = Sphere<float>;
using B = Box<float>;
constexpr Form open(const char* name) { return form<triangle<true>>(name).first_root().unit_direction(); }

}  // namespace

LOSTBITS_FORMS(form<clipped_ahead>("word.clipped_ahead").clipped().origin_misses(),
               form<clipped_ahead>("bad.clipped_ahead").clipped(),
               form<clipped<S>>("word.clipped").clipped(),                                      //
               form<answer_zero_inside<S>>("word.zero").first_root().inside_zero(),             //
               form<misses_inside<S>>("word.misses").first_root().inside_misses(),              //
               form<exit_at_origin>("word.exit_at_origin").first_root().origin_exits(),         //
               form<misses_inside<S>>("word.near").near_root(),                                 //
               form<signed_near>("word.signed_near").near_root().inside_near(),                 //
               form<signed_near>("word.near_line").near_root().whole_line(),                    //
               form<insists>("word.insists").first_root().unit_direction(),                     //
               form<exit_inside<B>>("word.box_exit").first_root().ignores_end().inside_exit(),  //
               form<clipped<B>>("word.box_clipped").ignores_end().clipped(),                    //
               form<misses_inside<B>>("word.box_near").near_root().ignores_end(),               //
               form<endless>("word.endless").ignores_end(),                                     //
               form<of_segment>("word.segment").first_root(),                                   //
               form<point_of_segment>("word.segment_point").first_root(),                       //
               form<thickness_of_segment>("word.segment_thickness").whole_line(),               //
               form<of_centre>("word.centre").first_root().ignores_end(),                       //
               form<of_origin>("word.at_origin").first_root(),                                  //
               form<thickness>("word.thickness").whole_line(),                                  //
               form<points>("word.points").whole_line(),                                        //
               form<in_range>("word.in_range").first_root().in_range(),                         //
               form<box_in_range>("word.box_in_range").first_root().in_range(),                 //
               form<sphere_blocks>("word.blocks").in_range(),                                   //
               form<triangle<false>>("word.triangle").first_root().unit_direction(),            //
               open("word.open_triangle").touching_misses().origin_misses(),                    //
               open("bad.open_triangle").origin_misses(),                                       //
               open("bad.at_triangle").touching_misses(),                                       //
               form<open_at_start>("bad.open_at_start").first_root().in_range(),                //
               form<forgets_the_start>("bad.forgets_the_start").first_root().in_range(),        //
               form<unsigned_near>("bad.unsigned_near").near_root(),                            //
               form<touch_is_zero>("bad.touch").first_root(),                                   //
               form<with_tmin>("bad.tmin").first_root().origin_misses(),                        //
               form<clipped<S>>("bad.clipped"),                                                 //
               form<answer_zero_inside<S>>("bad.zero").first_root(),                            //
               form<misses_inside<S>>("bad.misses").first_root(),                               //
               form<exit_at_origin>("bad.exit_at_origin").first_root(),                         //
               form<exit_inside<B>>("bad.box_exit").first_root().ignores_end(),                 //
               form<exit_inside<S>>("bad.near").near_root(),                                    //
               form<signed_near>("bad.behind").first_root(),                                    //
               form<endless>("bad.endless"),                                                    //
               form<thickness_for_far>("bad.thickness").whole_line(),                           //
               form<insists_on_numbers>("bad.insists").first_root())
