// Prints one line for each form and type: a checksum of its answers on seeded rays. IEEE 754 rounds every operation of
// a formula correctly, so the output is the same text whatever compiled this file, as long as nothing fused or
// reordered. No MPFR and no Boost: this compiles alone with any compiler.
#include <bit>
#include <cstdint>
#include <cstdio>
#include <utility>

#include "counts.hpp"
#include "intersect/catalogue.hpp"
#include "intersect/form_shape.hpp"
#include "number/random.hpp"

namespace lostbits::test {
namespace {

/// FNV-1a over 64-bit words. NaN has no defined sign or payload: all are one.
struct Checksum {
    std::uint64_t state = 0xcbf29ce484222325;
    void add(std::uint64_t word) { state = (state ^ word) * 0x100000001b3 ^ state >> 29; }
    void add(float x) { add(x != x ? ~std::uint64_t{0} : std::uint64_t{std::bit_cast<std::uint32_t>(x)}); }
    void add(double x) { add(x != x ? ~std::uint64_t{0} : std::bit_cast<std::uint64_t>(x)); }
};

template <class T>
struct Sample {
    Ray<T> ray;
    Sphere<T> sphere;
};

template <class T>
T scale(T x, int exponent) {
    return std::ldexp(x, exponent);
}

/// A seeded ray of one of eight kinds, cheap to compute and with all roundings.
template <class T>
Sample<T> draw(Random& random, int kind, bool unit) {
    const auto in = [&] { return T(2 * random.unit() - 1); };
    const int span = sizeof(T) == 4 ? 60 : 500;  // squares of 2^span stay finite; those of 2^(2·span) do not
    T radius = T(0.25 + random.unit());
    // Braces, because the order in which a parenthesised call draws its arguments is the compiler's choice.
    Vec<T> towards{in(), in(), in()}, side{in(), in(), in()}, centre{in(), in(), in()};
    T away = T(3 + 4 * random.unit()), off = T(1.3 * random.unit());
    if (kind == 1) away = T(1e5);
    if (kind == 2) off = 1 + scale(in(), sizeof(T) == 4 ? -18 : -46);               // grazing
    if (kind == 3) radius = scale(radius, 20), away = T(1 + random.unit() / 4096);  // huge, the eye just above
    if (kind == 4) away = T(random.unit() / 2);                                     // inside
    const auto normalised = [](const Vec<T>& v) {
        const T length = lostbits::sqrt(dot(v, v));
        return Vec<T>(v.x / length, v.y / length, v.z / length);
    };
    const Vec<T> axis = normalised(towards), beside = normalised(cross(axis, side));
    // Aimed so that the line passes the centre at `off` radii, which is possible from outside.
    const T reach = radius * away, aim = radius * off;
    const T lever = away > off ? aim / lostbits::sqrt(1 - (off / away) * (off / away)) : aim;
    const Vec<T> origin(centre.x - reach * axis.x, centre.y - reach * axis.y, centre.z - reach * axis.z);
    Vec<T> direction(axis.x * reach + beside.x * lever, axis.y * reach + beside.y * lever,
                     axis.z * reach + beside.z * lever);
    if (random.one_in(8)) direction = Vec<T>(-direction.x, -direction.y, -direction.z);
    int shift = 0, turn = 0;
    if (kind == 5)
        shift = -span + static_cast<int>(random.between(-span / 2, 0)), turn = -shift / 2;       // towards underflow
    if (kind == 6) shift = span + static_cast<int>(random.between(0, span)), turn = -shift / 2;  // towards overflow
    if (kind == 7) turn = static_cast<int>(random.between(-span, span));
    if (unit) {
        direction = normalised(direction);
        turn = 0;
    }
    const auto move = [](const Vec<T>& v, int e) { return Vec<T>(scale(v.x, e), scale(v.y, e), scale(v.z, e)); };
    return {{move(origin, shift), move(direction, turn)}, {move(centre, shift), scale(radius, shift)}};
}

template <class T>
struct BoxSample {
    Ray<T> ray;
    Box<T> box;
    T tmax;
};

/// A seeded ray and box of one of eight kinds; planes, directions and origins coincide or vanish, with either sign of
/// zero.
template <class T>
BoxSample<T> draw_box(Random& random, int kind) {
    const auto in = [&] { return T(2 * random.unit() - 1); };
    const auto zero = [&] { return random.one_in(2) ? T(0) : -T(0); };
    const int span = sizeof(T) == 4 ? 90 : 900;
    Vec<T> lo{in(), in(), in()}, hi{in(), in(), in()}, target{in(), in(), in()}, origin{in(), in(), in()};
    T tmax = random.one_in(3) ? T(2 * random.unit()) : HUGE_VALF;
    for (int i = 0; i < 3; ++i) {
        if (lo[i] > hi[i]) std::swap(lo[i], hi[i]);
        if (kind == 1) origin[i] *= T(1e5);
        if (kind != 2) origin[i] *= T(4);
    }
    Vec<T> direction(target.x - origin.x, target.y - origin.y, target.z - origin.z);
    const auto axis = static_cast<int>(random.between(0, 2));
    if (kind == 3 || kind == 4) direction[axis] = zero();
    if (kind == 4) origin[axis] = random.one_in(2) ? lo[axis] : hi[axis];
    if (kind == 5) hi[axis] = lo[axis];
    if (kind == 6) direction[axis] = scale(direction[axis], -static_cast<int>(random.between(0, span + 50)));
    if (kind == 7) {
        const int shift = static_cast<int>(random.between(-span, span));
        for (Vec<T>* v : {&lo, &hi, &origin})
            for (int i = 0; i < 3; ++i) (*v)[i] = scale((*v)[i], shift);
    }
    return {{origin, direction}, {lo, hi}, tmax};
}

template <class Form, class T>
Hit<T> shoot(Random& random, int kind) {
    if constexpr (intersect::shape_of<Form> == Shape::sphere) {
        const Sample<T> x = draw<T>(random, kind, Form::info.direction == intersect::Direction::unit);
        return Form::intersect(x.ray, x.sphere);
    } else {
        const BoxSample<T> x = draw_box<T>(random, kind);
        return Form::intersect(x.ray, x.box, x.tmax);
    }
}

template <class Form, class T>
void print(const char* type) {
    const int rays = draws(120000);
    Checksum sum;
    Random random(2024);
    long hits = 0, undefined = 0;
    for (int i = 0; i < rays; ++i) {
        const Hit<T> h = shoot<Form, T>(random, i % 8);
        sum.add(std::uint64_t{h.hit});
        sum.add(h.t);
        sum.add(h.near);
        sum.add(h.far);
        hits += h.hit;
        undefined += h.t != h.t;
    }
    std::printf("%s %s %016llx hits %ld nan %ld of %d\n", Form::info.name.data(), type,
                static_cast<unsigned long long>(sum.state), hits, undefined, rays);
}

}  // namespace

void print_every_form() {
    const auto print_form = []<class Form>() {
        print<Form, float>("f32");
        if constexpr (Form::info.formats == intersect::Formats::all) print<Form, double>("f64");
    };
    intersect::sphere::SphereForms::for_each(print_form);
    intersect::box::BoxForms::for_each(print_form);
}

}  // namespace lostbits::test

int main() { lostbits::test::print_every_form(); }
