// What exactness cannot show: a correction that is zero when nothing is rounded (a Newton step, a second solution) must
// still go the right way when something is.
#include <map>

#include "catch.hpp"
#include "intersect/cases.hpp"
#include "intersect/catalogue.hpp"
#include "number/rounded.hpp"

namespace lostbits::test {
namespace {

/// The mean relative error of t over rays that hit in truth and by the form, in units of 2^-p.
template <class T>
std::map<std::string_view, double> mean_errors(Setup setup, int precision) {
    std::map<std::string_view, double> means;
    SphereForms::for_each([&]<class Form>() {
        Random random(0xacc);
        double sum = 0;
        int hits = 0;
        for (int i = 0; i < 400; ++i) {
            const Case x = as_stored<float>(draw_case(random, setup), Direction::unit);
            const Solution s = solve(x);
            const Expected e = expect(Form::info, s);
            if (!s.is_generic() || !e.asked || !e.hit) continue;
            const auto lift = [](const Rational& q) { return T(as_double(q)); };
            const Hit<T> h = Form::intersect(lift_ray<T>(x, lift), lift_sphere<T>(x, lift));
            const Precise& want = e.first_is_far ? s.far : s.near;
            double got = 0;
            if constexpr (std::is_floating_point_v<T>) got = static_cast<double>(h.t);
            else got = h.t.value();
            if (!h.hit || !std::isfinite(got)) continue;
            sum += Precise(abs(Precise(got) - want) / abs(want)).template convert_to<double>() * std::ldexp(1.0, precision);
            ++hits;
        }
        REQUIRE(hits > 100);
        means[Form::info.name] = sum / hits;
    });
    return means;
}

}  // namespace

TEST_CASE("on ordinary rays no form loses more than a few bits", "[intersect][accuracy]") {
    for (const auto& [name, mean] : mean_errors<float>(Setup::near, 24)) {
        INFO(name << " is off by " << mean << " units of 2^-24");
        CHECK(mean > 0);
        CHECK(mean < 64);
    }
}

TEST_CASE("corrections correct", "[intersect][accuracy]") {
    // The second solution and the moved origin exist for distance; the Newton step takes out what the roots lost.
    auto far = mean_errors<float>(Setup::far, 24);
    CAPTURE(far["sphere.half_b"], far["sphere.two_step"], far["sphere.closest_approach"], far["sphere.unified"], far["sphere.newton_refined"]);
    CHECK(far["sphere.two_step"] < 1.2 * far["sphere.half_b"]);
    CHECK(far["sphere.closest_approach"] < far["sphere.half_b"]);
    auto near = mean_errors<float>(Setup::near, 24);
    CAPTURE(near["sphere.unified"], near["sphere.newton_refined"], near["sphere.half_b"]);
    CHECK(near["sphere.newton_refined"] < 1.1 * near["sphere.unified"]);
    auto tangent = mean_errors<float>(Setup::almost_tangent, 24);
    CAPTURE(tangent["sphere.unified"], tangent["sphere.newton_refined"]);
    CHECK(tangent["sphere.newton_refined"] < tangent["sphere.unified"]);
}

}  // namespace lostbits::test
