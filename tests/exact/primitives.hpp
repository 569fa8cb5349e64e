// First hit of a ray with a primitive of each shape, from polynomials derived here from the definition of the shape. No
// number type of lostbits is used.
#pragma once

#include <array>
#include <string_view>

#include "exact/chord.hpp"

namespace lostbits::exact {

inline constexpr std::size_t max_primitive_numbers = 9;

/// A ray, which part of it counts, and a primitive by its numbers in the order of its keys.
struct Problem {
    std::array<double, 6> ray;
    std::array<double, max_primitive_numbers> primitive{};
    double tmin = 0, tmax = INFINITY;
    bool open_tmin = false, open_tmax = false;
    std::array<double, 12> matrix{};  ///< [A τ], row by row, under which the primitive stands, if it does
    bool has_transform = false, is_inverse = false;
};

template <class E>
struct Vector {
    E x, y, z;

    friend Vector operator+(const Vector& a, const Vector& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend Vector operator-(const Vector& a, const Vector& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    friend Vector operator*(const E& k, const Vector& a) { return {k * a.x, k * a.y, k * a.z}; }
    friend E dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
    friend Vector cross(const Vector& a, const Vector& b) {
        return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    }
};

/// A problem in numbers of E, in the space of its primitive.
template <class E>
struct ObjectProblem {
    Vector<E> o, d;
    std::array<E, max_primitive_numbers> n;
    Counted<E> counted;
    bool is_flat = false;  ///< the matrix leaves nothing to hit

    explicit ObjectProblem(const Problem& problem)
        : o{E(problem.ray[0]), E(problem.ray[1]), E(problem.ray[2])},
          d{E(problem.ray[3]), E(problem.ray[4]), E(problem.ray[5])},
          counted{place(E(problem.tmin)), {}, problem.open_tmin, problem.open_tmax} {
        for (std::size_t k = 0; k < max_primitive_numbers; ++k) n[k] = E(problem.primitive[k]);
        if (problem.tmax < INFINITY) counted.to = place(E(problem.tmax));
        if (problem.has_transform) enter(problem);
    }
    [[nodiscard]] Vector<E> point(std::size_t k) const { return {n[k], n[k + 1], n[k + 2]}; }

private:
    /// With A's columns x, y, z, and v for a column by turns, Cramer's rule has A⁻¹v = (v·(y×z), v·(z×x), v·(x×y))/det.
    /// Nothing is divided: the ray and all numbers of the primitive are |det| times as large, at which t stays and the
    /// normal of a plane is one.
    void enter(const Problem& problem) {
        const auto column = [&problem](std::size_t c) {
            return Vector<E>{E(problem.matrix[c]), E(problem.matrix[4 + c]), E(problem.matrix[8 + c])};
        };
        const Vector<E> x = column(0), y = column(1), z = column(2), shift = column(3);
        if (problem.is_inverse) {
            o = o.x * x + o.y * y + o.z * z + shift, d = d.x * x + d.y * y + d.z * z;
            is_flat = sign(dot(x, cross(y, z))) == 0;
            return;
        }
        const Vector<E> yz = cross(y, z), zx = cross(z, x), xy = cross(x, y), v = o - shift;
        E det = dot(x, yz);
        o = {dot(v, yz), dot(v, zx), dot(v, xy)}, d = {dot(d, yz), dot(d, zx), dot(d, xy)};
        const int side = sign(det);
        if (side < 0) o = E(-1) * o, d = E(-1) * d, det = -det;
        is_flat = side == 0;
        for (E& number : n) number = det * number;
    }
};

/// First point at which the ray meets a primitive of a shape; nothing for a miss.
template <class E>
First<E> meet(First<E> (*shape)(const ObjectProblem<E>&), const Problem& problem) {
    const ObjectProblem<E> q(problem);
    return q.is_flat ? First<E>(std::nullopt) : shape(q);
}

template <class E>
Chord<E> all_of_it() {
    return Part<E>{};
}

/// |p − c| ≤ r.
template <class E>
Chord<E> ball(const ObjectProblem<E>& q, const Vector<E>& centre, const E& r) {
    const Vector<E> f = q.o - centre;
    return chord_below<E>(all_of_it<E>(), dot(q.d, q.d), dot(f, q.d), dot(f, f) - r * r);
}

/// With v from base to top, p = o + t d − base and s = v·p: across the axis p² − s²/v² is left, and s/v² of the height
/// the radius is R + k s/v²: v² (v² p² − s²) ≤ (R v² + k s)² and 0 ≤ s ≤ v², or of one radius v² p² − s² ≤ v² R².
template <class E>
struct AlongAxis {
    Vector<E> v, f;
    E v2, fv, dv, a, h, c;  ///< v² p² − s² = a t² + 2 h t + c

    AlongAxis(const ObjectProblem<E>& q, const Vector<E>& base, const Vector<E>& top)
        : v(top - base), f(q.o - base), v2(dot(v, v)), fv(dot(f, v)), dv(dot(q.d, v)) {
        a = v2 * dot(q.d, q.d) - dv * dv, h = v2 * dot(f, q.d) - fv * dv, c = v2 * dot(f, f) - fv * fv;
    }
    [[nodiscard]] Chord<E> planes() const { return chord_between(fv, dv, v2); }
    [[nodiscard]] E round(const E& r) const { return c - v2 * (r * r); }
    /// True if the line lies in the plane of a cap.
    [[nodiscard]] bool is_in_plane() const { return sign(dv) == 0 && (sign(fv) == 0 || sign(v2 - fv) == 0); }
};

/// True if a t² + 2 h t + c is 0 for all t: the line lies in the curved surface.
template <class E>
bool is_nothing(const E& a, const E& h, const E& c) {
    return sign(a) == 0 && sign(h) == 0 && sign(c) == 0;
}

template <class E>
First<E> meet_sphere(const ObjectProblem<E>& q) {
    return first_end(ball(q, q.point(0), q.n[3]), q.counted);
}

template <class E>
First<E> meet_box(const ObjectProblem<E>& q) {
    const E o[3] = {q.o.x, q.o.y, q.o.z}, d[3] = {q.d.x, q.d.y, q.d.z};
    Chord<E> inside = all_of_it<E>();
    for (std::size_t i = 0; i < 3; ++i)
        inside = intersect_chords(inside, chord_between(o[i] - q.n[i], d[i], q.n[i + 3] - q.n[i]));
    return first_of_all(inside, q.counted);
}

/// Cramer's rule for u (b − a) + v (c − a) − t d = o − a.
template <class E>
First<E> meet_triangle(const ObjectProblem<E>& q) {
    const Vector<E> a = q.point(0), e1 = q.point(3) - a, e2 = q.point(6) - a, s = q.o - a;
    const Vector<E> p = cross(q.d, e2), r = cross(s, e1);
    const E det = dot(e1, p), u = dot(s, p), v = dot(q.d, r);
    const int side = sign(det);
    if (side == 0 || side * sign(u) < 0 || side * sign(v) < 0 || side * sign(det - u - v) < 0) return std::nullopt;
    return only(fraction(dot(e2, r), det), q.counted);
}

/// With each axis multiplied by the other two radii it is a ball, whose radius is the product of all three.
template <class E>
First<E> meet_ellipsoid(const ObjectProblem<E>& q) {
    const E &x = q.n[3], &y = q.n[4], &z = q.n[5];
    const Vector<E> w{y * z, z * x, x * y}, g = q.o - q.point(0);
    const Vector<E> f{w.x * g.x, w.y * g.y, w.z * g.z}, d{w.x * q.d.x, w.y * q.d.y, w.z * q.d.z};
    const E r = x * w.x;
    return first_end(chord_below<E>(all_of_it<E>(), dot(d, d), dot(f, d), dot(f, f) - r * r), q.counted);
}

template <class E>
First<E> meet_cylinder(const ObjectProblem<E>& q) {
    const AlongAxis<E> axis(q, q.point(0), q.point(3));
    const E c = axis.round(q.n[6]);
    const Chord<E> inside = chord_below(axis.planes(), axis.a, axis.h, c);
    if (axis.is_in_plane() || is_nothing(axis.a, axis.h, c)) return first_of_all(inside, q.counted);
    return first_end(inside, q.counted);
}

template <class E>
First<E> meet_capsule(const ObjectProblem<E>& q) {
    const E& r = q.n[6];
    const AlongAxis<E> axis(q, q.point(0), q.point(3));
    const E c = axis.round(r);
    const Chord<E> ends = join_chords(ball(q, q.point(0), r), ball(q, q.point(3), r));
    const Chord<E> inside = join_chords(ends, chord_below(axis.planes(), axis.a, axis.h, c));
    return is_nothing(axis.a, axis.h, c) ? first_of_all(inside, q.counted) : first_end(inside, q.counted);
}

/// The wall alone: each root that lies between the planes.
template <class E>
First<E> meet_tube(const ObjectProblem<E>& q) {
    const AlongAxis<E> axis(q, q.point(0), q.point(3));
    const Chord<E> planes = axis.planes();
    if (!planes || sign(axis.a) == 0) return std::nullopt;
    const Quadratic<E> wall(axis.a, axis.h, axis.round(q.n[6]));
    if (sign(wall.q) < 0) return std::nullopt;
    for (const int s : {-1, 1}) {
        const Place<E> t = root_of(wall, s);
        if (planes->first && (order(t, *planes->first) < 0 || order(t, *planes->last) > 0)) continue;
        if (q.counted.has(t)) return t;
    }
    return std::nullopt;
}

template <class E>
First<E> meet_cone(const ObjectProblem<E>& q) {
    const AlongAxis<E> axis(q, q.point(0), q.point(3));
    const E k = q.n[7] - q.n[6], at_o = q.n[6] * axis.v2 + k * axis.fv, change = k * axis.dv;
    const E a = axis.v2 * axis.a - change * change, h = axis.v2 * axis.h - at_o * change;
    const E c = axis.v2 * axis.c - at_o * at_o;
    const Chord<E> inside = chord_below(axis.planes(), a, h, c);
    if (axis.is_in_plane() || is_nothing(a, h, c)) return first_of_all(inside, q.counted);
    return first_end(inside, q.counted);
}

/// m times as far from the centre as the point of the plane, for m = d·n: m f + k d with k = −f·n.
template <class E>
First<E> meet_disc(const ObjectProblem<E>& q) {
    const Vector<E> f = q.o - q.point(0), n = q.point(3);
    const E m = dot(q.d, n), k = -dot(f, n);
    if (sign(m) == 0) return std::nullopt;
    const Vector<E> p = m * f + k * q.d;
    const E p2 = dot(p, p), m2 = m * m;
    if (sign(q.n[6] * q.n[6] * m2 - p2) < 0 || sign(p2 - q.n[7] * q.n[7] * m2) < 0) return std::nullopt;
    return only(fraction(k, m), q.counted);
}

template <class E>
First<E> meet_plane(const ObjectProblem<E>& q) {
    const Vector<E> n = q.point(3);
    const E m = dot(q.d, n);
    if (sign(m) == 0) return std::nullopt;
    return only(fraction(dot(q.point(0) - q.o, n), m), q.counted);
}

/// A number near the place where a line is nearest to the origin of f; computations are relative to it.
inline Enclosed nearest(const Enclosed& fd, const Enclosed& d2) {
    const double t = -fd.high / d2.high;
    return Enclosed(std::isfinite(t) ? t : 0);
}
inline Whole nearest(const Whole&, const Whole&) { return Whole(); }

/// With p from the centre, R and r the radii and n the axis, the part of p across n has the length ρ, n² ρ² = n² p² −
/// (n·p)², and (ρ − R)² + (p² − ρ²) = r²: (p² + R² − r²)² = 4 R² ρ².
template <class E>
Sturm<E> quartic_of(const ObjectProblem<E>& q) {
    const E &major = q.n[6], &minor = q.n[7];
    const Vector<E> f = q.o - q.point(0), n = q.point(3);
    const E a = dot(q.d, q.d), origin = nearest(dot(f, q.d), a), two(2);
    const Vector<E> p = f + origin * q.d;
    const E n2 = dot(n, n), b = dot(p, q.d), c = dot(p, p), np = dot(n, p), nd = dot(n, q.d);
    const E e = c + (major + minor) * (major - minor), b2 = two * b, k = two * major * (two * major);
    return Sturm<E>({{n2 * (e * e) - k * (n2 * c - np * np), two * (n2 * (e * b2) - k * (n2 * b - np * nd)),
                      n2 * (b2 * b2 + two * (e * a)) - k * (n2 * a - nd * nd), two * (n2 * (b2 * a)), n2 * (a * a)},
                     4},
                    origin);
}
template <class E>
First<E> meet_torus(const ObjectProblem<E>& q) {
    const Sturm<E> sturm = quartic_of(q);
    const E& from = number_of(q.counted.from);
    const int before = sturm.up_to(from), index = before + (sturm.is_root(from) && !q.counted.open_from ? 0 : 1);
    if (index > sturm.all()) return std::nullopt;
    RootOf<E> first{sturm, index};
    return q.counted.has(first) ? First<E>(std::move(first)) : std::nullopt;
}

/// A shape in these tests.
struct ShapeTest {
    std::string_view name;
    First<Enclosed> (*quickly)(const ObjectProblem<Enclosed>&);
    First<Whole> (*exactly)(const ObjectProblem<Whole>&);
};
inline constexpr std::array<ShapeTest, 11> shapes{{{"sphere", meet_sphere, meet_sphere},
                                                   {"box", meet_box, meet_box},
                                                   {"triangle", meet_triangle, meet_triangle},
                                                   {"ellipsoid", meet_ellipsoid, meet_ellipsoid},
                                                   {"cylinder", meet_cylinder, meet_cylinder},
                                                   {"capsule", meet_capsule, meet_capsule},
                                                   {"tube", meet_tube, meet_tube},
                                                   {"cone", meet_cone, meet_cone},
                                                   {"disc", meet_disc, meet_disc},
                                                   {"plane", meet_plane, meet_plane},
                                                   {"torus", meet_torus, meet_torus}}};

}  // namespace lostbits::exact
