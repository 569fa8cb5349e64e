// What exactness cannot show: a correction that is zero when nothing is rounded (a Newton step, a second solution) must
// still go the right way when something is.
#include <map>

#include "catch.hpp"
#include "intersect/cases.hpp"
#include "intersect/catalogue.hpp"

namespace lostbits::test {
namespace {

/// The mean relative error of t over rays that hit in truth and by the form, in units of 2^-p.
using Means = std::map<std::string_view, double>;

template <class T>
Means mean_errors(Setup setup, int precision) {
    Means means;
    intersect::sphere::SphereForms::for_each([&]<class Form>() {
        Random random(0xacc);
        double sum = 0;
        int hits = 0;
        for (int i = 0; i < 400; ++i) {
            const Case x = as_stored<float>(draw_case(random, setup), intersect::Direction::unit);
            const Solution s = solve(x);
            const Expected e = expect(Form::info, s);
            if (!s.is_generic() || !e.asked || !e.hit) continue;
            const auto lift = [](const Rational& q) { return static_cast<T>(as_double(q)); };
            const Hit<T> h = Form::intersect(lift_ray<T>(x, lift), lift_sphere<T>(x, lift));
            const Precise& want = e.first_is_far ? s.far : s.near;
            const double got = static_cast<double>(h.t);
            if (!h.hit || !std::isfinite(got)) continue;
            sum += Precise(abs(Precise(got) - want) / abs(want)).template convert_to<double>() *
                   std::ldexp(1.0, precision);
            ++hits;
        }
        if (hits > 50) means[Form::info.name] = sum / hits;  // at 10⁶ radii some forms see next to nothing in float
    });
    return means;
}

}  // namespace

TEST_CASE("on ordinary rays no form loses more than a few bits", "[intersect][accuracy]") {
    const auto near = mean_errors<float>(Setup::near, 24);
    CHECK(near.size() == intersect::sphere::SphereForms::size);
    for (const auto& [name, mean] : near) {
        INFO(name << " is off by " << mean << " units of 2^-24");
        CHECK(mean > 0);
        CHECK(mean < 64);
    }
}

TEST_CASE("corrections correct", "[intersect][accuracy]") {
    // The second solution and the moved origin exist for distance; the Newton step takes out what the roots lost.
    const auto far = mean_errors<float>(Setup::far, 24), near = mean_errors<float>(Setup::near, 24);
    CHECK(far.at("sphere.two_step") < far.at("sphere.half_b") / 100);
    CHECK(far.at("sphere.closest_approach") < far.at("sphere.half_b") / 100);
    CHECK(near.at("sphere.newton_refined") < 1.1 * near.at("sphere.unified"));
}

}  // namespace lostbits::test
