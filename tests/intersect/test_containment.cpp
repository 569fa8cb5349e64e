// The same form in Ball, in Interval at any precision, and with 2048 bits: whatever an enclosure says of a number or of
// a decision must be true of the form itself.
#include <optional>

#include "catch.hpp"
#include "intersect/cases.hpp"
#include "intersect/catalogue.hpp"
#include "intersect/contains.hpp"
#include "number/ball.hpp"
#include "number/interval.hpp"

namespace lostbits::test {

using intersect::sphere::SphereForms;

namespace {

constexpr long precisions[] = {12, 24, 53, 113, 250, 600};

template <class T>
struct Answer {
    T t, near, far;
    mask_t<T> hit;
    explicit Answer(const Hit<T>& h) : t(h.t), near(h.near), far(h.far), hit(h.hit) {}
};

struct Tally {
    long wrong = 0, contradictory = 0, decided = 0, asked = 0, bounded = 0;
};

template <class T>
void hold(const Hit<T>& got, const Hit<Wide>& want, std::optional<bool>& verdict, Tally& tally) {
    tally.wrong += !contains(got.t, want.t) || !contains(got.near, want.near) || !contains(got.far, want.far);
    tally.wrong += (got.hit.is_yes() && !want.hit) || (got.hit.is_no() && want.hit);
    if (got.hit.is_unknown()) return;
    tally.contradictory += verdict && *verdict != got.hit.is_yes();
    verdict = got.hit.is_yes();
}

template <class Form>
void enclose(const Case& x, Tally& tally) {
    const auto wide = [](const Rational& q) { return real_from<Wide>(q); };
    const auto ball = [](const Rational& q) { return Ball(as_double(q)); };
    const auto interval = [](const Rational& q) {
        const Interval::Precision exact(53);
        return Interval(as_double(q));
    };
    const Hit<Wide> want = Form::intersect(lift_ray<Wide>(x, wide), lift_sphere<Wide>(x, wide));
    const Ray<Interval> ray = lift_ray<Interval>(x, interval);
    const Sphere<Interval> sphere = lift_sphere<Interval>(x, interval);

    std::optional<bool> verdict;
    const long before = tally.wrong;
    hold(Form::intersect(lift_ray<Ball>(x, ball), lift_sphere<Ball>(x, ball)), want, verdict, tally);
    for (const long precision : precisions) {
        const Interval::Precision scope(precision);
        const Hit<Interval> got = Form::intersect(ray, sphere);
        hold(got, want, verdict, tally);
        if (precision == 600) tally.bounded += got.t.is_bounded();
    }
    tally.decided += verdict.has_value();
    ++tally.asked;
    if (before == 0 && tally.wrong != 0) UNSCOPED_INFO(Form::info.name << " t " << want.t << " hit " << want.hit);
}

}  // namespace

TEST_CASE("enclosures of every form contain what the form gives unrounded", "[intersect][containment]") {
    std::array<Tally, SphereForms::size> tallies{};
    long rays = 0;
    for (const Setup setup : every_setup) {
        Random random(0xba11 + static_cast<std::uint64_t>(setup));
        for (int i = 0; i < 60; ++i) {
            const Case x = draw_case(random, setup);
            std::size_t form = 0;
            SphereForms::for_each(
                [&]<class Form>() { enclose<Form>(as_stored<double>(x, Form::info.direction), tallies[form++]); });
            ++rays;
        }
    }
    std::size_t form = 0;
    SphereForms::for_each([&]<class Form>() {
        const Tally& t = tallies[form++];
        INFO(Form::info.name << ": decided " << t.decided << " and bounded " << t.bounded << " of " << t.asked);
        CHECK(t.wrong == 0);
        CHECK(t.contradictory == 0);
        CHECK(t.decided > rays * 9 / 10);
    });
}

}  // namespace lostbits::test
