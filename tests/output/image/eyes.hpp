// Eyes and how far apart two colours are to them: for tests of palettes.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "output/image/colour.hpp"

namespace lostbits::output::test {

using Vector = std::array<double, 3>;

inline Vector linear(image::Rgb8 c) {
    return {image::linear_light(c.r) / 65535.0, image::linear_light(c.g) / 65535.0, image::linear_light(c.b) / 65535.0};
}

using Matrix = std::array<Vector, 3>;

inline Vector seen_through(const Matrix& m, const Vector& c) {
    Vector out;
    for (std::size_t i = 0; i < 3; ++i) out[i] = std::clamp(m[i][0] * c[0] + m[i][1] * c[1] + m[i][2] * c[2], 0.0, 1.0);
    return out;
}

/// Colours as a deuteranope and a protanope see them: Machado, Oliveira and Fernandes 2009, severity 1, on linear
/// light.
inline Vector deuteranope(const Vector& c) {
    return seen_through(
        {{{0.367322, 0.860646, -0.227968}, {0.280085, 0.672501, 0.047413}, {-0.01182, 0.04294, 0.968881}}}, c);
}
inline Vector protanope(const Vector& c) {
    return seen_through(
        {{{0.152286, 1.052583, -0.204868}, {0.114503, 0.786281, 0.099216}, {-0.003882, -0.048116, 1.051998}}}, c);
}
inline Vector any_eye(const Vector& c) { return c; }

/// CIE L*a*b* of linear sRGB, under D65.
inline Vector cielab(const Vector& c) {
    const auto f = [](double t) { return t > 216.0 / 24389 ? std::cbrt(t) : (24389.0 / 27 * t + 16) / 116; };
    const double x = f((0.4124564 * c[0] + 0.3575761 * c[1] + 0.1804375 * c[2]) / 0.95047);
    const double y = f(0.2126729 * c[0] + 0.7151522 * c[1] + 0.0721750 * c[2]);
    const double z = f((0.0193339 * c[0] + 0.1191920 * c[1] + 0.9503041 * c[2]) / 1.08883);
    return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

/// CIEDE2000 of two colours in L*a*b*, as Sharma, Wu and Dalal 2005 write it out.
inline double ciede2000(const Vector& one, const Vector& other) {
    const auto degrees = [](double radians) { return radians * 180 / std::numbers::pi; };
    const auto cosine = [](double angle) { return std::cos(angle * std::numbers::pi / 180); };
    const auto seventh = [](double c) { return std::sqrt(std::pow(c, 7) / (std::pow(c, 7) + std::pow(25.0, 7))); };
    const double g = 0.5 * (1 - seventh((std::hypot(one[1], one[2]) + std::hypot(other[1], other[2])) / 2));
    const auto chroma = [&](const Vector& v) { return std::hypot((1 + g) * v[1], v[2]); };
    const auto hue = [&](const Vector& v) {
        const double h = v[1] == 0 && v[2] == 0 ? 0 : degrees(std::atan2(v[2], (1 + g) * v[1]));
        return h < 0 ? h + 360 : h;
    };
    const double c1 = chroma(one), c2 = chroma(other), h1 = hue(one), h2 = hue(other);
    double dh = 0, h = h1 + h2;
    if (c1 * c2 != 0) {
        const bool far = std::fabs(h1 - h2) > 180;
        dh = h2 - h1 + (far ? h2 > h1 ? -360 : 360 : 0);
        h = (h1 + h2 + (far ? h1 + h2 < 360 ? 360 : -360 : 0)) / 2;
    }
    const double dl = other[0] - one[0], dc = c2 - c1;
    const double large_dh = 2 * std::sqrt(c1 * c2) * std::sin(dh / 2 * std::numbers::pi / 180);
    const double l = (one[0] + other[0]) / 2, c = (c1 + c2) / 2;
    const double t =
        1 - 0.17 * cosine(h - 30) + 0.24 * cosine(2 * h) + 0.32 * cosine(3 * h + 6) - 0.2 * cosine(4 * h - 63);
    const double of_l = dl / (1 + 0.015 * (l - 50) * (l - 50) / std::sqrt(20 + (l - 50) * (l - 50)));
    const double of_c = dc / (1 + 0.045 * c), of_h = large_dh / (1 + 0.015 * c * t);
    const double turn =
        -std::sin(60 * std::exp(-std::pow((h - 275) / 25, 2)) * std::numbers::pi / 180) * 2 * seventh(c);
    return std::sqrt(of_l * of_l + of_c * of_c + of_h * of_h + turn * of_c * of_h);
}

}  // namespace lostbits::output::test
