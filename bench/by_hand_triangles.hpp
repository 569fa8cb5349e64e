// Loops for triangles, over `Ops` as in by_hand_loops.hpp. Values that depend only on the triangle are computed before
// the loop.
#pragma once

#include <cstddef>

#include "by_hand.hpp"

namespace by_hand {

template <class Ops>
struct Three {
    typename Ops::V x, y, z;

    static Three all(const typename Ops::F* p) { return {Ops::set1(p[0]), Ops::set1(p[1]), Ops::set1(p[2])}; }
    friend Three operator-(const Three& a, const Three& b) {
        return {Ops::sub(a.x, b.x), Ops::sub(a.y, b.y), Ops::sub(a.z, b.z)};
    }
    friend Three cross(const Three& a, const Three& b) {
        const auto minor = [](auto p, auto q, auto r, auto s) { return Ops::sub(Ops::mul(p, q), Ops::mul(r, s)); };
        return {minor(a.y, b.z, b.y, a.z), minor(a.z, b.x, b.z, a.x), minor(a.x, b.y, b.x, a.y)};
    }
    friend typename Ops::V dot(const Three& a, const Three& b) {
        return Ops::add(Ops::add(Ops::mul(a.x, b.x), Ops::mul(a.y, b.y)), Ops::mul(a.z, b.z));
    }
    friend typename Ops::V dot_from_z(const Three& a, const Three& b) {
        return Ops::add(Ops::mul(a.x, b.x), Ops::add(Ops::mul(a.y, b.y), Ops::mul(a.z, b.z)));
    }
};

/// Calls `ask(origin, direction)` for each pack of rays. It returns t, and a mask of the hits.
template <class Ops, class Ask>
void for_rays(const typename Ops::F* const rays[6], typename Ops::F* const answers[3], unsigned char* hit,
              std::size_t n, const Ask& ask) {
    using F = typename Ops::F;
    const F *const ox = rays[0], *const oy = rays[1], *const oz = rays[2];
    const F *const dx = rays[3], *const dy = rays[4], *const dz = rays[5];
    F *const t = answers[0], *const near = answers[1], *const far = answers[2];
    for (std::size_t i = 0; i < n; i += Ops::lanes) {
        const auto [at, met] = ask(Three<Ops>{Ops::load(ox + i), Ops::load(oy + i), Ops::load(oz + i)},
                                   Three<Ops>{Ops::load(dx + i), Ops::load(dy + i), Ops::load(dz + i)});
        Ops::store(t + i, at);
        Ops::store(near + i, at);
        Ops::store(far + i, at);
        const auto missed = Ops::invert(met);
        Ops::store_neither(hit + i, missed, missed);
    }
}

template <class Ops>
struct At {
    typename Ops::V t;
    typename Ops::M met;
};

template <class Ops, class F = typename Ops::F>
void moller_trumbore(const F* const rays[6], const F* triangle, F* const answers[3], unsigned char* hit,
                     std::size_t n) {
    using V = typename Ops::V;
    const Three<Ops> a = Three<Ops>::all(triangle), e1 = Three<Ops>::all(triangle + 3) - a,
                     e2 = Three<Ops>::all(triangle + 6) - a;
    const V zero = Ops::set1(0), one = Ops::set1(1), epsilon = Ops::set1(F(1) / F(1 << 23));
    for_rays<Ops>(rays, answers, hit, n, [&](const Three<Ops>& o, const Three<Ops>& d) {
        const Three<Ops> p = cross(d, e2), from = o - a, q = cross(from, e1);
        const V det = dot(e1, p), inverse = Ops::div(one, det);
        const V u = Ops::mul(dot(from, p), inverse), v = Ops::mul(dot(d, q), inverse),
                t = Ops::mul(dot(e2, q), inverse);
        const auto within = Ops::both(Ops::less_equal(zero, u), Ops::less_equal(u, one));
        const auto beyond = Ops::either(Ops::less(v, zero), Ops::less(one, Ops::add(u, v)));
        const auto passed = Ops::either(Ops::less(Ops::abs(det), epsilon), Ops::less(t, zero));
        return At<Ops>{t, Ops::both(within, Ops::invert(Ops::either(beyond, passed)))};
    });
}

/// triangle.undivided. The sign bit of the determinant is transferred to the other numbers.
template <class Ops, class F = typename Ops::F>
void undivided(const F* const rays[6], const F* triangle, F* const answers[3], unsigned char* hit, std::size_t n) {
    using V = typename Ops::V;
    const Three<Ops> a = Three<Ops>::all(triangle), e1 = a - Three<Ops>::all(triangle + 3),
                     e2 = Three<Ops>::all(triangle + 6) - a, ng = cross(e2, e1);
    const V zero = Ops::set1(0), one = Ops::set1(1);
    for_rays<Ops>(rays, answers, hit, n, [&](const Three<Ops>& o, const Three<Ops>& d) {
        const Three<Ops> c = a - o, r = cross(c, d);
        const V den = dot_from_z(ng, d), size = Ops::abs(den);
        const V u = Ops::flip(dot_from_z(r, e2), den), v = Ops::flip(dot_from_z(r, e1), den),
                tn = Ops::flip(dot_from_z(ng, c), den);
        const auto inside = Ops::both(Ops::both(Ops::less_equal(zero, u), Ops::less_equal(zero, v)),
                                      Ops::less_equal(Ops::add(u, v), size));
        return At<Ops>{Ops::mul(tn, Ops::div(one, size)),
                       Ops::both(inside, Ops::both(Ops::less(zero, size), Ops::less(zero, tn)))};
    });
}

/// triangle.woop. The axes are permuted after o was subtracted from the vertices: nine numbers instead of twelve.
template <class Ops, class F = typename Ops::F>
void woop(const F* const rays[6], const F* triangle, F* const answers[3], unsigned char* hit, std::size_t n) {
    using V = typename Ops::V;
    const Three<Ops> corner[3] = {Three<Ops>::all(triangle), Three<Ops>::all(triangle + 3),
                                  Three<Ops>::all(triangle + 6)};
    const V zero = Ops::set1(0), one = Ops::set1(1);
    for_rays<Ops>(rays, answers, hit, n, [&](const Three<Ops>& o, const Three<Ops>& direction) {
        const V x = Ops::abs(direction.x), y = Ops::abs(direction.y), z = Ops::abs(direction.z);
        const auto by_x = Ops::both(Ops::less(y, x), Ops::less(z, x)), by_y = Ops::less(z, y);
        const auto pick = [&](V if_x, V if_y, V if_z) {
            return Ops::choose(by_x, if_x, Ops::choose(by_y, if_y, if_z));
        };
        const auto permute = [&](const Three<Ops>& v) {
            return Three<Ops>{pick(v.z, v.x, v.y), pick(v.y, v.z, v.x), pick(v.x, v.y, v.z)};
        };
        const Three<Ops> d = permute(direction);
        const V sz = Ops::div(one, d.z), sx = Ops::mul(d.x, sz), sy = Ops::mul(d.y, sz);
        const auto shear = [&](const Three<Ops>& vertex) {
            const Three<Ops> v = permute(vertex - o);
            return Three<Ops>{Ops::sub(v.x, Ops::mul(v.z, sx)), Ops::sub(v.y, Ops::mul(v.z, sy)), v.z};
        };
        const Three<Ops> a = shear(corner[0]), b = shear(corner[1]), c = shear(corner[2]);
        const auto area = [](V p, V q, V r, V s) { return Ops::sub(Ops::mul(p, q), Ops::mul(r, s)); };
        const V u = area(c.x, b.y, c.y, b.x), v = area(a.x, c.y, a.y, c.x), w = area(b.x, a.y, b.y, a.x);
        const V det = Ops::add(Ops::add(u, v), w);
        const auto part = [&](V k, V depth) { return Ops::mul(k, Ops::mul(sz, depth)); };
        const V tn = Ops::add(Ops::add(part(u, a.z), part(v, b.z)), part(w, c.z)), t = Ops::mul(tn, Ops::div(one, det));
        const auto not_below = [&](V k) { return Ops::less_equal(zero, k); };
        const auto not_above = [&](V k) { return Ops::less_equal(k, zero); };
        const auto inside = Ops::either(Ops::both(Ops::both(not_below(u), not_below(v)), not_below(w)),
                                        Ops::both(Ops::both(not_above(u), not_above(v)), not_above(w)));
        return At<Ops>{t, Ops::both(inside, Ops::both(Ops::less(zero, Ops::abs(det)), Ops::less(zero, t)))};
    });
}

}  // namespace by_hand
