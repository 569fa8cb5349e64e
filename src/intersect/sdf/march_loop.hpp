// The march loop that the forms for distance fields share.
#pragma once

#include "geometry/ray.hpp"
#include "intersect/info.hpp"
#include "intersect/march.hpp"

namespace lostbits::intersect::sdf {

/// A watch that does nothing. A watch receives every sample of a march (t, the point, the field value, and whether the
/// march still runs), and the step after it: the new t and, if the form moves the point itself, the new point.
/// `changed` is true if the form changed more than the position, so that the next step from the same position may
/// differ.
struct NoMarchWatch {
    template <class M, class T>
    void operator()(const M& /*active*/, const T& /*t*/, const Vec<T>& /*p*/, const T& /*d*/) const {}
    template <class M, class T>
    void on_step(const M& /*active*/, const T& /*t*/) const {}
    template <class M, class T>
    void on_step(const M& /*active*/, const T& /*t*/, const M& /*changed*/) const {}
    template <class M, class T>
    void on_step(const M& /*active*/, const T& /*t*/, const Vec<T>& /*p*/) const {}
};

/// The last two samples of a march; d is the field value at a sample.
///
/// - After a hit, t and d belong to the last sample, t_before and d_before to the sample before it (both are 0 if there
///   was only one sample).
/// - After a miss, t_before and d belong to the last sample, d_before to the sample before it. t = t_before + d is
///   already the next position, at which no sample was taken.
template <class T>
struct MarchSamples {
    mask_t<T> hit;
    T t, d;
    T t_before, d_before;
};

template <Number T>
Vec<T> point_on_ray(const Ray<T>& ray, const T& t) {
    return Vec<T>(ray.origin.x + t * ray.direction.x, ray.origin.y + t * ray.direction.y,
                  ray.origin.z + t * ray.direction.z);
}

/// Repeats d = field(o + t·dir). If `is_close(d, t)`, the march ends as a hit. Otherwise t += d, and the march ends as
/// a miss once t > max_dist. Source: SDF Sphere Marching, step 3.
template <Number T, class Field, class Watch, class IsClose>
MarchSamples<T> march(const Ray<T>& ray, const Field& field, const MarchConstants<T>& constants, Watch& watch,
                      const IsClose& is_close) {
    const T zero(0);
    auto active = zero <= zero;
    MarchSamples<T> m{!active, zero, zero, zero, zero};
    for (int i = 0; i < constants.max_steps && any_of(active); ++i) {
        const Vec<T> p = point_on_ray(ray, m.t);
        const T d = field(p);
        watch(active, m.t, p, d);

        m.d_before = select(active, m.d, m.d_before);
        m.d = select(active, d, m.d);
        m.hit = m.hit || (active && is_close(d, m.t));
        active = active && !m.hit;

        m.t_before = select(active, m.t, m.t_before);
        m.t = select(active, m.t + d, m.t);
        watch.on_step(active, m.t);
        active = active && !(m.t > constants.max_dist);
    }
    return m;
}

}  // namespace lostbits::intersect::sdf
