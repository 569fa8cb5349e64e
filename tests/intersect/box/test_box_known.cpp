// Rays in and near the boundary of a box, worked out by hand from min(x, y) = x < y ? x : y, max(x, y) = x > y ? x : y
// and 0·∞ = NaN. Planes are at 1 and at powers of two and directions have components 0, ±1, so no t is rounded; columns
// of `hits` are the forms in the order of the catalogue.
#include <string>

#include "catch.hpp"
#include "intersect/ask_row.hpp"
#include "number/rounded.hpp"
#include "shapes/box/forms/forms.hpp"

namespace lostbits::test::test_box_known {

using intersect::table::Intersector;

namespace {

constexpr double inf = HUGE_VAL;
constexpr double u = 0x1p-24;  // of float

struct KnownCase {
    const char* what;
    std::array<double, 3> origin, direction;
    double tmax;
    const char* hits;  ///< H hit, . miss
    double t;          ///< of those that hit
    bool float_only = false;
    std::array<double, 3> lo{1, 1, 1}, hi{4, 4, 4};
};

/// One column of `hits` for each form.
constexpr std::array<std::string_view, 14> forms{
    "box.baseline",      "box.exclusive",   "box.inclusive", "box.signs",      "box.divide",
    "box.ieee_minmax",   "box.pbrt_padded", "box.max_mult",  "box.embree_fma", "box.embree_robust",
    "box.embree_padded", "box.bvh_robust",  "box.tinybvh",   "box.filtered"};

// b baseline, x exclusive, i inclusive, s signs, / divide, m ieee_minmax, p pbrt_padded, M max_mult, f embree_fma, r
// embree_robust, e embree_padded, v bvh_robust, t tinybvh, F filtered
const KnownCase known_cases[] = {
    //                                                                                   bxis/mpMfrevtF
    {"through the middle", {2, 2, -1}, {0, 0, 1}, inf, "HHHHHHHHHHHHHH", 2},
    {"through the middle, zeros negative", {2, 2, -1}, {-0.0, -0.0, 1}, inf, "HHHHHHHHHHHHHH", 2},
    {"through the middle, backwards", {2, 2, 6}, {0, -0.0, -1}, inf, "HHHHHHHHHHHHHH", 2},
    {"oblique", {0, -1, -2}, {1, 1, 1}, inf, "HHHHHHHHHHHHHH", 3},
    {"behind", {2, 2, 5}, {0, 0, 1}, inf, "..............", 0},
    {"beside, below", {0, 2, -1}, {0, 0, 1}, inf, "..............", 0},
    {"beside, below, zero negative", {0, 2, -1}, {-0.0, 0, 1}, inf, "..............", 0},
    {"beside, above", {5, 2, -1}, {0, 0, 1}, inf, "..............", 0},
    {"beside, above, zero negative", {5, 2, -1}, {-0.0, 0, 1}, inf, "..............", 0},

    // t1 = NaN, t2 = ±∞. minNum returns the ∞ for both planes. embree_fma's and embree_padded's +1e-18 and tinybvh's
    // 1e30 enter the box from lo and leave it from hi.
    {"in a lo face", {1, 2, -1}, {0, 0, 1}, inf, "..HHH.HHHHHHHH", 2},
    {"in a lo face, zero negative", {1, 2, -1}, {-0.0, 0, 1}, inf, "..HHH.HHHHHHHH", 2},
    {"in a lo face, a ray with an end", {1, 2, -1}, {0, 0, 1}, 8, "..HHH.HHHHHHHH", 2},
    {"in a lo face, last axis", {-1, 2, 1}, {1, 0, 0}, inf, "..HHH.HHHHHHHH", 2},
    // t2 = NaN, and baseline's max(tmin, NaN) = NaN; the next axis's max(NaN, t) = t starts afresh.
    {"in a hi face", {4, 2, -1}, {0, 0, 1}, inf, "H.HHH.HH.H.H.H", 2},
    {"in a hi face, zero negative", {4, 2, -1}, {-0.0, 0, 1}, inf, "H.HHH.HH.H.H.H", 2},
    {"in a hi face, middle axis", {2, 4, -1}, {0, 0, 1}, inf, "H.HHH.HH.H.H.H", 2},
    {"in a hi face, last axis: NaN < NaN", {-1, 2, 4}, {1, 0, 0}, inf, "..HHH.HH.H.H.H", 2},
    {"in a hi face, last axis, zero negative", {-1, 2, 4}, {1, 0, -0.0}, inf, "..HHH.HH.H.H.H", 2},
    {"in a hi face, the box behind: baseline forgets t ≥ 0", {4, 2, 6}, {0, 0, 1}, inf, "H.............", -5},
    {"in a hi face, the box beyond the end: baseline forgets tmax", {4, 2, -1}, {0, 0, 1}, 1, "H.............", 2},
    {"in a hi face, but beside the box", {4, 0, -1}, {0, 0, 1}, inf, "..............", 0},
    {"in a hi face, beside on an axis before: baseline forgets", {0, 4, -1}, {0, 0, 1}, inf, "H.............", 2},
    {"along a lo edge", {1, 1, -1}, {0, 0, 1}, inf, "..HHH.HHHHHHHH", 2},
    {"along a hi edge", {4, 4, -1}, {0, -0.0, 1}, inf, "H.HHH.HH.H.H.H", 2},
    {"along a lo-hi edge", {1, 4, -1}, {0, 0, 1}, inf, "H.HHH.HH.H.H.H", 2},
    {"along a hi-lo edge", {4, 1, -1}, {0, 0, 1}, inf, "..HHH.HH.H.H.H", 2},

    // Edges and corners met at an angle: tmin = tmax, and no NaN.
    {"across an edge", {2, 6, 0}, {1, -1, 1}, inf, "..HHHHHHHHHHHH", 2},
    {"across a corner", {2, 6, 6}, {1, -1, -1}, inf, "..HHHHHHHHHHHH", 2},
    {"across an edge behind", {6, 2, 4}, {1, -1, 1}, inf, "..............", 0},

    // tmin = 2 + 2^-21·k and tmax = 2: paddings in the order of their size.
    {"one last place off an edge", {2, 6 + 8 * u, 0}, {1, -1, 1}, inf, "......HH.HHH..", 2 + 8 * u, true},
    {"two", {2, 6 + 16 * u, 0}, {1, -1, 1}, inf, ".........HH...", 2 + 16 * u, true},
    {"three", {2, 6 + 24 * u, 0}, {1, -1, 1}, inf, ".........HH...", 2 + 24 * u, true},
    {"four", {2, 6 + 32 * u, 0}, {1, -1, 1}, inf, "..............", 0, true},

    {"the ray ends where it enters", {2, 2, -1}, {0, 0, 1}, 2, "..HHHHHHHHHH.H", 2},
    {"the ray ends just after", {2, 2, -1}, {0, 0, 1}, 2 + 4 * u, "HHHHHHHHHHHHHH", 2},
    // max_mult and embree_robust pad tmax, be it a plane or the ray's end; pbrt_padded and bvh_robust pad far planes;
    // embree_padded is early by its padding. tinybvh's end is open.
    {"the ray ends just before", {2, 2, -1}, {0, 0, 1}, 2 - 2 * u, ".......H.HH...", 2, true},
    {"the ray ends well before", {2, 2, -1}, {0, 0, 1}, 1.5, "..............", 0},
    {"inside, the ray without length", {2, 2, 2}, {0, 0, 1}, 0, "..HHHHHHHHHHHH", 0},

    {"inside", {2, 2, 2}, {0, 0, 1}, inf, "HHHHHHHHHHHHHH", 0},
    {"on a face, looking in", {2, 2, 1}, {0, 0, 1}, inf, "HHHHHHHHHHHHHH", 0},
    {"on a face, looking out", {2, 2, 1}, {0, 0, -1}, inf, "..HHHHHHHHHHHH", 0},
    {"on a corner, looking in", {1, 1, 1}, {1, 1, 1}, inf, "HHHHHHHHHHHHHH", 0},
    {"on a corner, looking out", {4, 4, 4}, {1, 1, 1}, inf, "..HHHHHHHHHHHH", 0},
    {"on an edge, looking along a face", {1, 2, 4}, {0, 0, -1}, inf, "..HHH.HHHHHHHH", 0},

    {"flat across the ray", {2, 2, 0}, {0, 0, 1}, inf, "..HHHHHHHHHHHH", 2, false, {1, 1, 2}, {4, 4, 2}},
    {"flat across the ray, backwards", {2, 2, 4}, {0, 0, -1}, inf, "..HHHHHHHHHHHH", 2, false, {1, 1, 2}, {4, 4, 2}},
    // Both planes give NaN: maxNum(tmin, NaN) = tmin.
    {"flat, and the ray in it", {2, 2, -1}, {0, 0, 1}, inf, "H.HHHHHH.H.H.H", 2, false, {2, 1, 1}, {2, 4, 4}},
    {"flat, and the ray in it, zero negative",
     {2, 2, -1},
     {-0.0, 0, 1},
     inf,
     "H.HHHHHH.H.H.H",
     2,
     false,
     {2, 1, 1},
     {2, 4, 4}},
    {"flat in the last axis, and the ray in it: NaN < NaN",
     {-1, 2, 2},
     {1, 0, 0},
     inf,
     "..HHHHHH.H.H.H",
     2,
     false,
     {1, 1, 2},
     {4, 4, 2}},
    {"flat, the ray in it, the box behind",
     {2, 2, 6},
     {0, 0, 1},
     inf,
     "H.............",
     -5,
     false,
     {2, 1, 1},
     {2, 4, 4}},
    {"a point, straight on", {2, 2, 0}, {0, 0, 1}, inf, "..HHHHHH.H.H.H", 2, false, {2, 2, 2}, {2, 2, 2}},
    {"a point, at an angle", {0, 4, 0}, {1, -1, 1}, inf, "..HHHHHHHHHHHH", 2, false, {2, 2, 2}, {2, 2, 2}},
};

template <class T>
void ask_every_form(const KnownCase& known) {
    const auto vec = [](const std::array<double, 3>& v) { return Vec<T>(T(v[0]), T(v[1]), T(v[2])); };
    const auto rows = intersect::table::intersectors(Shape::box);
    REQUIRE(rows.size() == forms.size());
    REQUIRE(std::string_view(known.hits).size() == forms.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const std::string_view name = rows[i].info->name;
        REQUIRE(name == forms[i]);
        const auto [hit, t, near, far] = ask_row<T>(rows[i], {vec(known.origin), vec(known.direction)},
                                                    Box<T>{vec(known.lo), vec(known.hi)}, T(known.tmax));
        INFO(name << ", " << known.what << ": t " << t << " near " << near << " far " << far);
        CHECK(hit == (known.hits[i] == 'H'));
        if (known.hits[i] != 'H') continue;
        CHECK(near == t);
        if (name == "box.embree_padded") {  // (1 - 3 eps)/d, rounded to less than 8u of t
            CHECK(t <= known.t);
            CHECK(t >= known.t * (1 - 8 * u));
        } else {
            CHECK(t == known.t);
        }
    }
}

template <class T>
void check_nan_order() {
    const T one(1), bad = T(0) / T(0);
    const auto value = [](const T& x) {
        if constexpr (std::is_floating_point_v<T>) return static_cast<double>(x);
        else return x.value();
    };
    const auto is_nan = [](const T& x) { return !(x < T(0)) && !(x >= T(0)); };
    CHECK(is_nan(min(one, bad)));
    CHECK(is_nan(max(one, bad)));
    CHECK(value(min(bad, one)) == 1);
    CHECK(value(max(bad, one)) == 1);
    for (const auto num : {intersect::box::min_num<T>, intersect::box::max_num<T>}) {
        CHECK(value(num(one, bad)) == 1);
        CHECK(value(num(bad, one)) == 1);
        CHECK(is_nan(num(bad, bad)));
    }
    CHECK(value(intersect::box::min_num<T>(T(2), T(3))) == 2);
    CHECK(value(intersect::box::min_num<T>(T(3), T(-2))) == -2);
    CHECK(value(intersect::box::max_num<T>(T(2), T(3))) == 3);
    CHECK(value(intersect::box::max_num<T>(T(-3), T(-2))) == -2);
}

}  // namespace

TEST_CASE("forms of boxes give the answers worked out by hand", "[intersect][box][known]") {
    for (const KnownCase& k : known_cases) {
        ask_every_form<float>(k);
        if (!k.float_only) ask_every_form<double>(k);
    }
}

TEST_CASE("the order of operands of min and max decides whether a NaN is kept or dropped", "[intersect][box][known]") {
    check_nan_order<float>();
    check_nan_order<double>();
    check_nan_order<Half>();
}

TEST_CASE("far is the exit or the end of the ray, with the padding of the form", "[intersect][box][known]") {
    for (const Intersector& form : intersect::table::intersectors(Shape::box)) {
        const Primitive<float> box(Box<float>{Vec<float>(1), Vec<float>(4)});
        const Ray<float> ray{Vec<float>(2, 2, -1), Vec<float>(0, 0, 1)};
        const float far = ask_row<float>(form, ray, box).far, ended = ask_row<float>(form, ray, box, 4).far;
        INFO(form.info->name);
        const auto is = [&form](std::string_view name) { return form.info->name == name; };
        const bool padded = is("box.pbrt_padded") || is("box.embree_padded"), multiplied = is("box.max_mult");
        CHECK(far == (padded ? 5 * (1 + 3 * 0x1p-23f) : multiplied || is("box.bvh_robust") ? 5 * (1 + 0x1p-22f) : 5));
        CHECK(ended == (multiplied ? 4 * (1 + 0x1p-22f) : 4));
    }
}

TEST_CASE("a reciprocal overflows to infinity where division does not", "[intersect][box][known]") {
    // 1/d = ∞ for d = 2^-129: the plane ahead lies at ∞, where (2^-129)/(2^-129) = 1 for a box of that size.
    const Box<float> box{Vec<float>(0x1p-129f, -1, -1), Vec<float>(0x1p-128f, 1, 1)};
    const Ray<float> ray{Vec<float>(0, 0, 0), Vec<float>(0x1p-129f, 0, 0)};
    CHECK(intersect::box::Divide::intersect(ray, box, 8.0f).hit);
    CHECK(intersect::box::Divide::intersect(ray, box, 8.0f).t == 1);
    CHECK_FALSE(intersect::box::Inclusive::intersect(ray, box, 8.0f).hit);
    CHECK_FALSE(intersect::box::Signs::intersect(ray, box, 8.0f).hit);
    CHECK(intersect::box::Inclusive::intersect(ray, box, HUGE_VALF).t == HUGE_VALF);  // a hit, at infinity
}

TEST_CASE("embree_fma's smallest direction is 1e-18", "[intersect][box][known]") {
    const auto far = []<class T>(T dx) {
        const Ray<T> ray{Vec<T>(0, 0, 0), Vec<T>(dx, 1, 1)};
        return intersect::box::EmbreeFma::intersect(
                   ray, Box<T>{Vec<T>(-2, T(-1e30), T(-1e30)), Vec<T>(1, T(1e30), T(1e30))}, T(HUGE_VAL))
            .far;
    };
    const float tiny = 1e-18f;
    CHECK(far(tiny) == 1 / tiny);
    CHECK(far(2 * tiny) == 0.5f / tiny);
    CHECK(far(-tiny) == 2 / tiny);  // keeps its sign, and leaves by the other plane
    for (const float smaller : {std::nextafter(tiny, 0.0f), -std::nextafter(tiny, 0.0f), 0.0f, -0.0f})
        CHECK(far(smaller) == 1 / tiny);
    CHECK(far(0.0) == 1 / 1e-18);
    CHECK(far(std::nextafter(1e-18, 0.0)) == 1 / 1e-18);
    CHECK(far(std::nextafter(1e-18, 1.0)) == 1 / std::nextafter(1e-18, 1.0));
}

TEST_CASE("the reciprocals of tinybvh match its source", "[intersect][box][known]") {
    // Between planes at ±1 in x, only 1/d decides where the ray leaves.
    const auto leaves = [](float dx) {
        const Ray<float> ray{Vec<float>(0, 0, 0), Vec<float>(dx, 1, 1)};
        return intersect::box::TinyBvh::intersect(
                   ray, Box<float>{Vec<float>(-1, -1e38f, -1e38f), Vec<float>(1, 1e38f, 1e38f)}, HUGE_VALF)
            .far;
    };
    CHECK(leaves(2e-12f) == 1 / 2e-12f);
    for (const float none : {1e-12f, -1e-12f, 0.0f, -0.0f}) CHECK(leaves(none) == 1e30f);
}

TEST_CASE("embree_fma loses bits because it rounds a product that then cancels", "[intersect][box][known]") {
    // o·inv = (1 + 2^-12)·(1 + 2^-12), rounded by 2^-24 before lo·inv = (1 + 2^-11)(1 + 2^-12) is added: the others
    // subtract lo − o exactly.
    const float o = -(1 + 0x1p-12f), lo = -(1 + 0x1p-13f), d = 1;
    const Box<float> box{Vec<float>(lo, -1, -1), Vec<float>(4, 1, 1)};
    const Ray<float> ray{Vec<float>(o, 0, 0), Vec<float>(3 * d, 0, 0)};
    const float exact = (0x1p-13f) / 3;
    const float by_signs = intersect::box::Signs::intersect(ray, box, 8.0f).t,
                by_fma = intersect::box::EmbreeFma::intersect(ray, box, 8.0f).t;
    CHECK(std::fabs(by_signs - exact) <= exact * 0x1p-22f);
    CHECK(std::fabs(by_fma - exact) > exact * 0x1p-14f);
}

}  // namespace lostbits::test::test_box_known
