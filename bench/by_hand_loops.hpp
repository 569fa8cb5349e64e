// The loops, as templates over `Ops`: a struct with a short name for each intrinsic of a format and a width. A
// translation unit defines its Ops in an anonymous namespace, so that the instances stay inside it.
#pragma once

#include <cstddef>

#include "by_hand_triangles.hpp"

namespace by_hand {

template <class Ops>
struct OneRay {
    using F = typename Ops::F;
    typename Ops::V o[3], inv[3];
    explicit OneRay(const F* ray) {
        for (int k = 0; k < 3; ++k) o[k] = Ops::set1(ray[k]), inv[k] = Ops::set1(1 / ray[3 + k]);
    }
};

template <class Ops, class F = typename Ops::F>
void signs(const F* ray, const F* const columns[6], F* t, std::size_t n) {
    using V = typename Ops::V;
    const OneRay<Ops> r(ray);
    const F *first[3], *second[3];
    for (int k = 0; k < 3; ++k) {
        const bool sign = __builtin_signbit(1 / ray[3 + k]);
        first[k] = columns[sign ? k + 3 : k];
        second[k] = columns[sign ? k : k + 3];
    }
    for (std::size_t i = 0; i < n; i += Ops::lanes) {
        const V old = Ops::load(t + i);
        V tmin = Ops::set1(0), tmax = old;
#pragma GCC unroll 3
        for (int k = 0; k < 3; ++k) {
            tmin = Ops::max(Ops::mul(Ops::sub(Ops::load(first[k] + i), r.o[k]), r.inv[k]), tmin);
            tmax = Ops::min(Ops::mul(Ops::sub(Ops::load(second[k] + i), r.o[k]), r.inv[k]), tmax);
        }
        Ops::store(t + i, Ops::choose(Ops::less_equal(tmin, tmax), tmin, old));
    }
}

template <class Ops, class F = typename Ops::F>
void inclusive(const F* ray, const F* const columns[6], F* t, std::size_t n) {
    using V = typename Ops::V;
    const OneRay<Ops> r(ray);
    const F* const c[6] = {columns[0], columns[1], columns[2], columns[3], columns[4], columns[5]};
    for (std::size_t i = 0; i < n; i += Ops::lanes) {
        const V old = Ops::load(t + i);
        V tmin = Ops::set1(0), tmax = old;
#pragma GCC unroll 3
        for (int k = 0; k < 3; ++k) {
            const V t1 = Ops::mul(Ops::sub(Ops::load(c[k] + i), r.o[k]), r.inv[k]),
                    t2 = Ops::mul(Ops::sub(Ops::load(c[k + 3] + i), r.o[k]), r.inv[k]);
            tmin = Ops::min(Ops::max(t1, tmin), Ops::max(t2, tmin));
            tmax = Ops::max(Ops::min(t1, tmax), Ops::min(t2, tmax));
        }
        Ops::store(t + i, Ops::choose(Ops::less_equal(tmin, tmax), tmin, old));
    }
}

/// Columns of rays and answers in separate variables, so that the compiler knows that no store changes them.
template <class Ops>
struct Rays {
    using F = typename Ops::F;
    using V = typename Ops::V;
    const F *ox, *oy, *oz, *dx, *dy, *dz;
    V cx, cy, cz, r2;
    F *t, *near, *far;
    unsigned char* hit;
    Rays(const F* const rays[6], const F* sphere, F* const answers[3], unsigned char* h)
        : ox(rays[0]),
          oy(rays[1]),
          oz(rays[2]),
          dx(rays[3]),
          dy(rays[4]),
          dz(rays[5]),
          cx(Ops::set1(sphere[0])),
          cy(Ops::set1(sphere[1])),
          cz(Ops::set1(sphere[2])),
          r2(Ops::set1(sphere[3] * sphere[3])),
          t(answers[0]),
          near(answers[1]),
          far(answers[2]),
          hit(h) {}
    void put(std::size_t i, typename Ops::M missed, V near_root, V far_root) const {
        const V zero = Ops::set1(0), first = Ops::choose(Ops::less(near_root, zero), far_root, near_root);
        Ops::store(t + i, first);
        Ops::store(near + i, near_root);
        Ops::store(far + i, far_root);
        Ops::store_neither(hit + i, missed, Ops::less(first, zero));
    }
};

template <class Ops>
typename Ops::V dot(typename Ops::V ax, typename Ops::V ay, typename Ops::V az, typename Ops::V bx, typename Ops::V by,
                    typename Ops::V bz) {
    return Ops::add(Ops::add(Ops::mul(ax, bx), Ops::mul(ay, by)), Ops::mul(az, bz));
}

template <class Ops, class F = typename Ops::F>
void schoolbook(const F* const rays[6], const F* sphere, F* const answers[3], unsigned char* hit, std::size_t n) {
    using V = typename Ops::V;
    const Rays<Ops> r(rays, sphere, answers, hit);
    const V zero = Ops::set1(0), two = Ops::set1(2), four = Ops::set1(4);
    for (std::size_t i = 0; i < n; i += Ops::lanes) {
        const V fx = Ops::sub(Ops::load(r.ox + i), r.cx), fy = Ops::sub(Ops::load(r.oy + i), r.cy),
                fz = Ops::sub(Ops::load(r.oz + i), r.cz);
        const V dx = Ops::load(r.dx + i), dy = Ops::load(r.dy + i), dz = Ops::load(r.dz + i);
        const V a = dot<Ops>(dx, dy, dz, dx, dy, dz), b = Ops::mul(two, dot<Ops>(fx, fy, fz, dx, dy, dz));
        const V c = Ops::sub(dot<Ops>(fx, fy, fz, fx, fy, fz), r.r2);
        const V disc = Ops::sub(Ops::mul(b, b), Ops::mul(Ops::mul(four, a), c));
        const V root = Ops::sqrt(disc), minus_b = Ops::negate(b), two_a = Ops::mul(two, a);
        r.put(i, Ops::less(disc, zero), Ops::div(Ops::sub(minus_b, root), two_a),
              Ops::div(Ops::add(minus_b, root), two_a));
    }
}

template <class Ops, class F = typename Ops::F>
void unified(const F* const rays[6], const F* sphere, F* const answers[3], unsigned char* hit, std::size_t n) {
    using V = typename Ops::V;
    const Rays<Ops> r(rays, sphere, answers, hit);
    const V zero = Ops::set1(0);
    for (std::size_t i = 0; i < n; i += Ops::lanes) {
        const V fx = Ops::sub(Ops::load(r.ox + i), r.cx), fy = Ops::sub(Ops::load(r.oy + i), r.cy),
                fz = Ops::sub(Ops::load(r.oz + i), r.cz);
        const V dx = Ops::load(r.dx + i), dy = Ops::load(r.dy + i), dz = Ops::load(r.dz + i);
        const V a = dot<Ops>(dx, dy, dz, dx, dy, dz), b = Ops::negate(dot<Ops>(fx, fy, fz, dx, dy, dz));
        const V s = Ops::div(b, a);
        const V lx = Ops::add(fx, Ops::mul(s, dx)), ly = Ops::add(fy, Ops::mul(s, dy)),
                lz = Ops::add(fz, Ops::mul(s, dz));
        const V delta = Ops::sub(r.r2, dot<Ops>(lx, ly, lz, lx, ly, lz)),
                c = Ops::sub(dot<Ops>(fx, fy, fz, fx, fy, fz), r.r2);
        const V root = Ops::sqrt(Ops::mul(a, delta));
        const auto behind = Ops::less(b, zero);
        const V q = Ops::add(b, Ops::choose(behind, Ops::negate(root), root)), over_a = Ops::div(q, a),
                under_c = Ops::div(c, q);
        r.put(i, Ops::less(delta, zero), Ops::choose(behind, over_a, under_c), Ops::choose(behind, under_c, over_a));
    }
}

template <class Ops>
Loops<typename Ops::F> loops() {
    return {signs<Ops>, inclusive<Ops>, schoolbook<Ops>, unified<Ops>, moller_trumbore<Ops>, undivided<Ops>, woop<Ops>};
}

}  // namespace by_hand
