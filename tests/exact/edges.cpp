#include "exact/edges.hpp"

#include <algorithm>
#include <bit>
#include <climits>
#include <cmath>
#include <limits>

#include "exact/fixed.hpp"

namespace lostbits::exact {
namespace {

/// m·2^e, m odd or 0.
struct OddDyadic {
    std::int64_t m = 0;
    int e = 0;

    OddDyadic() = default;
    explicit OddDyadic(double x) {
        const auto bits = std::bit_cast<std::uint64_t>(x);
        const int field = static_cast<int>(bits >> 52 & 0x7ff);
        const std::uint64_t fraction = bits << 12 >> 12,
                            size = field == 0 ? fraction : fraction | std::uint64_t{1} << 52;
        if (size == 0) return;
        const int zeros = std::countr_zero(size);
        m = static_cast<std::int64_t>(size >> zeros), e = std::max(field, 1) - 1075 + zeros;
        if (std::signbit(x)) m = -m;
    }
    [[nodiscard]] int top() const {
        return e + static_cast<int>(std::bit_width(static_cast<std::uint64_t>(std::abs(m))));
    }
};

/// Numbers as integers below 2^bits, all times one power of two.
template <std::size_t N>
struct GridNumbers {
    std::array<OddDyadic, N> all;
    int low = INT_MAX, bits = 0;

    explicit GridNumbers(const std::array<double, N>& numbers) {
        int top = INT_MIN;
        for (std::size_t k = 0; k < N; ++k) {
            all[k] = OddDyadic(numbers[k]);
            if (all[k].m != 0) low = std::min(low, all[k].e), top = std::max(top, all[k].top());
        }
        if (top > low) bits = top - low;
    }
    template <class E>
    [[nodiscard]] Vector<E> point(std::size_t k) const {
        const auto at = [this](const OddDyadic& x) {
            return x.m == 0 ? E(0) : E(Int128{x.m} * (Int128{1} << (x.e - low)));
        };
        return {at(all[k]), at(all[k + 1]), at(all[k + 2])};
    }
};

/// Signs of o + t d = a + u (b − a) + v (c − a). With e, f = b − a, c − a, s = o − a and det = d·(e × f):
///
///     u det = f·(d × s), v det = −e·(d × s), t det = −s·(e × f)
///
/// For points below 2^K and a d below 2^D, t det stays below 2^(3K + 6), and the others and (1 − u − v) det stay below
/// 2^(2K + D + 7).
template <class E>
PassingRay passing(const Vector<E>& o, const Vector<E>& d, const Vector<E> (&corner)[3]) {
    const Vector<E> e = corner[1] - corner[0], f = corner[2] - corner[0], s = o - corner[0];
    const Vector<E> n = cross(e, f), q = cross(d, s);
    const E det = dot(d, n), u = dot(f, q), v = dot(e, q);
    const int across = sign(det);
    return {.across = across,
            .edges = {across * sign(u), -across * sign(v), across * sign(det - u + v)},
            .ahead = -across * sign(dot(s, n))};
}

template <class E, class Points, class Direction>
PassingRay passing_of(const Points& points, const Direction& direction) {
    return passing<E>(points.template point<E>(0), direction.template point<E>(0),
                      {points.template point<E>(3), points.template point<E>(6), points.template point<E>(9)});
}

}  // namespace

PassingRay pass(const Problem& problem) {
    std::array<double, 12> points;
    std::copy_n(problem.ray.begin(), 3, points.begin()), std::copy_n(problem.primitive.begin(), 9, points.begin() + 3);
    const GridNumbers<12> at(points);
    const GridNumbers<3> along({problem.ray[3], problem.ray[4], problem.ray[5]});
    const int bits = std::max(at.bits, along.bits);
    if (bits <= 40) return passing_of<Int128>(at, along);
    PassingRay found;
    if (bits <= 82) {
        found = passing_of<Fixed<4>>(at, along), found.by = PassingRay::four_words;
        return found;
    }
    const ObjectProblem<Whole> q(problem);
    found = passing<Whole>(q.o, q.d, {q.point(0), q.point(3), q.point(6)}), found.by = PassingRay::any_length;
    return found;
}

namespace {

template <class S>
void move(double& x, int ulps, double towards) {
    for (; ulps > 0; --ulps) x = static_cast<double>(std::nextafter(static_cast<S>(x), static_cast<S>(towards)));
}

double power_of_two(Chance& chance, int low, int high) { return std::ldexp(1, low + chance.below(high - low + 1)); }

/// Corner k of three, counted from any of them.
struct Corners {
    std::array<double, max_primitive_numbers>& numbers;
    std::size_t first;
    [[nodiscard]] double& at(std::size_t k, std::size_t i) const { return numbers[(first + k) % 3 * 3 + i]; }
};

/// Points of a grid of up to as many bits as the format has: p on the edge from p + k e to p − l e, or where k = 0 a
/// vertex, met at t = s. All multiples stay below 2^digits.
template <class S>
void draw_exactly(Chance& chance, Problem& problem, const Corners& corner) {
    const int width = 2 + chance.below(std::numeric_limits<S>::digits - 4);
    const auto whole = [&] { return static_cast<double>(static_cast<std::int64_t>(chance.bits()) >> (63 - width)); };
    const double k = chance.below(4), l = 1 + chance.below(3), s = chance.below(6) - 1;
    const bool scaled = chance.below(4) == 0;
    const double unit = scaled ? power_of_two(chance, -60, 60) : 1, step = scaled ? power_of_two(chance, -30, 30) : 1;
    for (std::size_t i = 0; i < 3; ++i) {
        const double at = whole(), d = whole(), e = whole();
        problem.ray[i] = unit * (at - s * d), problem.ray[3 + i] = step * d;
        corner.at(0, i) = unit * (at + k * e), corner.at(1, i) = unit * (at - l * e), corner.at(2, i) = unit * whole();
    }
    if (chance.below(4) == 0) return;
    const std::size_t which = static_cast<std::size_t>(chance.below(15));
    move<S>(which < 6 ? problem.ray[which] : problem.primitive[which - 6], 1 + chance.below(2),
            chance.below(2) == 0 ? HUGE_VAL : -HUGE_VAL);
}

template <class S>
void draw_triangle(Chance& chance, double size, const Corners& corner) {
    const double away = chance.below(2) == 0 ? 0 : size * power_of_two(chance, 0, 6);
    const int thin = chance.below(4);  // a sliver, a needle, or neither
    const double part = (chance.part() + 1) / 2, thickness = size * power_of_two(chance, -20, -1);
    for (std::size_t i = 0; i < 3; ++i) {
        const double middle = away * chance.part(), a = middle + size * chance.part();
        const double b = middle + size * chance.part(), c = thin == 0 ? a + part * (b - a) : a;
        corner.at(0, i) = stored<S>(a), corner.at(1, i) = stored<S>(b);
        corner.at(2, i) = stored<S>(thin < 2 ? c + thickness * chance.part() : middle + size * chance.part());
    }
}

template <class S>
void draw_nearly(Chance& chance, Problem& problem, const Corners& corner) {
    constexpr int sizes[] = {0, 0, 0, 0, -14, -26, 10, 20};
    const double size = std::ldexp(1, sizes[chance.below(8)]), away = size * power_of_two(chance, -10, 20);
    draw_triangle<S>(chance, size, corner);
    const double along = chance.below(4) == 0 ? 0 : (chance.part() + 1) / 2;
    const int flat = chance.below(24);  // of a few the direction is about 0 in a component
    const double step = power_of_two(chance, -3, 3);
    const bool moved = chance.below(4) != 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const double target = corner.at(0, i) + along * (corner.at(1, i) - corner.at(0, i));
        problem.ray[i] = stored<S>(target - (flat == static_cast<int>(i) ? 0 : away * chance.part()));
        problem.ray[3 + i] = stored<S>(step * (target - problem.ray[i]));
        if (moved) move<S>(problem.ray[3 + i], chance.below(3), chance.below(2) == 0 ? HUGE_VAL : -HUGE_VAL);
    }
}

template <class S>
void draw_all(Chance& chance, std::vector<Problem>& problems) {
    for (Problem& problem : problems) {
        do {
            const Corners corner{problem.primitive, static_cast<std::size_t>(chance.below(3))};
            chance.below(16) == 0 ? draw_exactly<S>(chance, problem, corner) : draw_nearly<S>(chance, problem, corner);
        } while (problem.ray[3] == 0 && problem.ray[4] == 0 && problem.ray[5] == 0);
    }
}

}  // namespace

void draw_at_edges(bool floats, Chance& chance, std::vector<Problem>& problems) {
    floats ? draw_all<float>(chance, problems) : draw_all<double>(chance, problems);
}

}  // namespace lostbits::exact
