// Intersection of an exact half-line with a primitive, in rationals: a second answer that shares no code with the
// first.
#pragma once

#include "intersect/exact.hpp"
#include "measure/offset/half_line.hpp"

namespace lostbits::test {

struct ExactMeeting {
    bool inside, outside, meets;
};

/// From the definition: inner points of a sphere have |o + t w − G|² < r², a parabola in t; those of a box lie strictly
/// between its planes.
inline ExactMeeting exact_meeting(const measure::offset::HalfLine& line, const Primitive<double>& primitive) {
    Rational q[3], w[3];
    for (int i = 0; i < 3; ++i) {
        w[i] = Rational(line.ray.direction[i]);
        q[i] = Rational(line.ray.origin[i]) + Rational(line.tmin) * w[i];
    }
    if (primitive.shape == Shape::sphere) {
        Rational a = 0, half_b = 0, c = -Rational(primitive.numbers[3]) * Rational(primitive.numbers[3]);
        for (int i = 0; i < 3; ++i) {
            const Rational f = q[i] - Rational(primitive.numbers[i]);
            a += w[i] * w[i];
            half_b += f * w[i];
            c += f * f;
        }
        // The least value for t > 0 is at t = −b/2a where that is positive, and is approached at t = 0 elsewhere.
        const bool dips = half_b < 0 && c * a < half_b * half_b;
        return {c<0, c> 0, c < 0 || dips};
    }
    bool inside = true, outside = false, any = true;
    Rational from = 0, to = -1;  // t > from, and t < to unless to < 0
    for (std::size_t i = 0; i < 3; ++i) {
        const Rational lo(primitive.numbers[i]), hi(primitive.numbers[i + 3]);
        inside = inside && q[i] > lo && q[i] < hi;
        outside = outside || q[i] < lo || q[i] > hi;
        if (w[i] == 0) {
            any = any && q[i] > lo && q[i] < hi;
            continue;
        }
        Rational in = (lo - q[i]) / w[i], out = (hi - q[i]) / w[i];
        if (in > out) std::swap(in, out);
        if (out <= 0 || in == out) any = false;
        if (in > from) from = in;
        if (to < 0 || out < to) to = out;
    }
    return {inside, outside, any && from < to};
}

}  // namespace lostbits::test
