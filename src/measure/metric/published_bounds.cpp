#include "measure/metric/published_bounds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "measure/metric/hit_point.hpp"
#include "number/ball.hpp"
#include "number/rounded.hpp"
#include "shapes/box/forms/slab.hpp"

namespace lostbits::measure::metric {

using truth::missing;

namespace {

template <class F>
inline constexpr double roundoff = std::numeric_limits<F>::epsilon() / 2;

double roundoff_of(const Sample& s) { return std::ldexp(1, -s.format->shape.precision); }

/// In object space, where the centre is the origin, as pbrt has it: p = o + t d, then p r/|p|.
template <class F>
double projected(const Sample& s) {
    const auto [centre, radius] = ball_around(*s.solid);
    const auto r = static_cast<F>(radius), t = static_cast<F>(s.t);
    const Vec<F> o = stored<F>(s.ray->origin) - stored<F>(centre), d = stored<F>(s.ray->direction);
    const Vec<F> p = o + Vec<F>(t * d.x, t * d.y, t * d.z);
    const F scale = r / length(p);
    const Ball exact = Ball(double{r}) / length(Vec<Ball>(Ball(double{p.x}), Ball(double{p.y}), Ball(double{p.z})));
    double worst = 0;
    for (int i = 0; i < 3; ++i) {
        if (p[i] == 0) continue;
        const Ball off = Ball(double{p[i] * scale}) / (Ball(double{p[i]}) * exact) - Ball(1);
        if (!off.is_bounded()) return missing;
        worst = std::max(worst, std::fabs(off.hi()));
    }
    return worst / roundoff<F>;
}

/// Of the clipping of slabs alone, which is the box's.
template <class F>
double padding_in(const Ray<F>& ray, const Hull<F>& box) {
    F tmin = 0, tmax = std::numeric_limits<F>::infinity();
    intersect::box::clip_by_signs<F>(ray, box, tmin, tmax);
    if (!(tmin > tmax)) return 0;
    return tmax > 0 ? (double{tmin} - double{tmax}) / double{tmax} / roundoff<F> : HUGE_VAL;
}

}  // namespace

double point_error(const Sample& s) {
    const Vec<double> p = hit_point(s);
    const truth::Certified& t = *s.truth;
    double worst = 0, largest = 0;
    for (int i = 0; i < 3; ++i) {
        const Ball scale(std::ldexp(1, static_cast<int>(std::clamp<std::int64_t>(t.exponent, -800, 800))));
        const Ball exact = Ball(s.ray->origin[i]) + (Ball(t.hi) + Ball(t.lo)) * scale * Ball(s.ray->direction[i]);
        const Ball off = Ball(p[i]) - exact;
        if (!off.is_bounded()) return HUGE_VAL;
        worst = std::max(worst, std::fabs(off.hi()));
        largest = std::max(largest, std::fabs(p[i]));
    }
    return worst / ((1 + largest) * roundoff_of(s));
}

double projected_error(const Sample& s) {
    if (!row_of(s.solid->shape).round) return missing;
    return in_format(s, [&]<class F>() { return projected<F>(s); });
}

double padding(const Sample& s) {
    const auto of = [&s](const Ray<double>& ray, const Hull<double>& box) {
        return in_format(s, [&]<class F>() {
            return padding_in<F>({stored<F>(ray.origin), stored<F>(ray.direction)},
                                 {stored<F>(box.lo), stored<F>(box.hi)});
        });
    };
    if (s.levels) {
        double most = 0;
        for (const auto& asked : s.levels->boxes)
            if (const double here = of(asked.ray, asked.box); !(here <= most)) most = here;
        return most;
    }
    if (!s.truth || !s.solid || !s.solid->is<Box>()) return missing;
    return of(*s.ray, s.solid->box());
}

double padding(const Ray<float>& ray, const Hull<float>& box) { return padding_in(ray, box); }

double bound(const Sample& s) {
    if (!s.bounded) return missing;
    if (!(s.bounded->error < HUGE_VAL)) return HUGE_VAL;
    return std::ldexp(s.bounded->error, -static_cast<int>(ulp_exponent(s.format->shape, s.truth->floor_log2())));
}

double bound_over(const Sample& s, double error) {
    const double size = bound(s);
    return size == 0 && error == 0 ? 1 : size / std::fabs(error);
}

double decision(const Sample& s) { return s.bounded ? (s.bounded->proved ? 0 : 1) : missing; }

double arithmetic(const Sample& s) { return s.way ? static_cast<double>(*s.way) : missing; }

}  // namespace lostbits::measure::metric
