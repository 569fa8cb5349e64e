// Every form against the exact solution, in arithmetic of 2048 bits: a slip in a formula cannot hide behind rounding.

#include "catch.hpp"
#include "intersect/cases.hpp"
#include "intersect/catalogue.hpp"

namespace lostbits::test {

using intersect::sphere::SphereForms;

namespace {

// 2048 bits, of which no form loses 400 on these rays (tangent to 2^-60, eye 2^-50 above, far 2^20, directions 2^±60).
const Wide tolerance = ldexp(Wide(1), -1600);

struct Tally {
    long asked = 0, hits = 0, from_far = 0, wrong = 0;
};

bool close(const Wide& got, const Precise& want) {
    const Precise error = abs(Precise(got) - want);
    return error <= abs(want) * Precise(tolerance);
}

template <class Form>
void ask(const Case& x, const Solution& s, Tally& tally) {
    const Expected e = expect(Form::info, s);
    if (!e.asked) return;
    const auto lift = [](const Rational& q) { return real_from<Wide>(q); };
    Ray<Wide> ray = lift_ray<Wide>(x, lift);
    const Sphere<Wide> sphere = lift_sphere<Wide>(x, lift);
    Precise scale = 1;
    if (Form::info.direction == intersect::Direction::unit) {
        scale = s.length;
        const Wide length(s.length);
        ray.direction = Vec<Wide>(ray.direction.x / length, ray.direction.y / length, ray.direction.z / length);
    }
    const Hit<Wide> hit = Form::intersect(ray, sphere);
    const Precise near = s.near * scale, far = s.far * scale;
    const Precise& first = e.first_is_far ? far : near;
    bool good = hit.hit == e.hit;
    if (good && e.hit) {
        good = close(hit.t, first);
        if (Form::info.roots == intersect::Roots::both) good = good && close(hit.near, near) && close(hit.far, far);
        else good = good && hit.near == hit.t && hit.far == hit.t;
    }
    ++tally.asked;
    tally.hits += e.hit;
    tally.from_far += e.hit && e.first_is_far;
    if (!good && tally.wrong++ == 0)
        UNSCOPED_INFO(
            Form::info.name << ": hit " << hit.hit << " for " << e.hit << ", t " << hit.t.template convert_to<double>()
                            << " for " << first.template convert_to<double>() << ", near "
                            << hit.near.template convert_to<double>() << " for " << near.template convert_to<double>()
                            << ", far " << hit.far.template convert_to<double>() << " for "
                            << far.template convert_to<double>());
}

}  // namespace

TEST_CASE("every form solves the problem when nothing is rounded", "[intersect][formula]") {
    std::array<Tally, SphereForms::size> tallies{};
    long rays = 0;
    for (const Setup setup : every_setup) {
        Random random(0x5eed + static_cast<std::uint64_t>(setup));
        for (int i = 0; i < 300; ++i) {
            const Case x = draw_case(random, setup);
            const Solution s = solve(x);
            REQUIRE(s.is_generic());
            std::size_t form = 0;
            SphereForms::for_each([&]<class Form>() { ask<Form>(x, s, tallies[form++]); });
            ++rays;
        }
    }
    std::size_t form = 0;
    SphereForms::for_each([&]<class Form>() {
        const Tally& t = tallies[form++];
        INFO(Form::info.name << ": asked " << t.asked << ", hits " << t.hits << ", of them the far root "
                             << t.from_far);
        CHECK(t.wrong == 0);
        CHECK(t.hits > t.asked / 3);
        CHECK(t.hits < t.asked);
        if (Form::info.roots == intersect::Roots::near_only) CHECK(t.asked > rays / 2);
        else CHECK((t.asked == rays && t.from_far > 300));
    });
}

TEST_CASE("almost tangent rays lie on both sides of touching", "[intersect][formula]") {
    Random random(60);
    int crossing = 0, missing = 0;
    for (int i = 0; i < 200; ++i) {
        const Solution s = solve(draw_case(random, Setup::almost_tangent));
        crossing += s.discriminant > 0;
        missing += s.discriminant < 0;
    }
    CHECK(crossing > 60);
    CHECK(missing > 60);
}

}  // namespace lostbits::test
