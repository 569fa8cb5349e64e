// The errors of the weights that a form returns, compared with fractions.
#include <cmath>
#include <map>

#include "catch.hpp"
#include "counts.hpp"
#include "intersect/catalogue.hpp"
#include "intersect/triangle/triangle_rays.hpp"
#include "measure/metric/values.hpp"
#include "number/recorded.hpp"
#include "number/recorders/tape_recorder.hpp"
#include "shapes/given_matrix.hpp"

namespace lostbits::test::test_barycentric {

using intersect::triangle::TriangleForms;
using measure::attribution::RayAttribution;
using measure::metric::find_metric;
using measure::metric::Sample;

namespace {

const auto barycentric_error = find_metric("barycentric_error") -> value,
           barycentric_sum = find_metric("barycentric_sum") -> value;

template <class Form>
Tape tape_of(const TriangleSample& sample) {
    Tape tape;
    const number::recorders::TapeRecorder recorder(tape, binary32);
    const auto lift = [](const Vec<double>& v) {
        using T = Recorded;
        return Vec<T>(T(static_cast<float>(v.x)), T(static_cast<float>(v.y)), T(static_cast<float>(v.z)));
    };
    static_cast<void>(
        Form::intersect(Ray<Recorded>{lift(sample.ray.origin), lift(sample.ray.direction)},
                        Triangle<Recorded>{lift(sample.triangle.a), lift(sample.triangle.b), lift(sample.triangle.c)}));
    return tape;
}

/// A triangle of the plane z = 0 and the weights that a form returns for the ray: w of a, u of b, v of c.
struct AnsweredHit {
    explicit AnsweredHit(double w, double u, double v) {
        for (const auto& [name, x] : {std::pair("w", w), {"u", u}, {"v", v}}) {
            const NodeId one = tape.add(TapeOp::constant, binary32, 1);
            tape.name(tape.add(TapeOp::mul, binary32, x, {one, one}), name);
        }
    }
    Tape tape;
    Format format = *find_format("f32");
    Ray<double> ray{{0.25, 0.5, 3}, {0, 0, -1}};  // weights 1/4, 1/4, 1/2
    Primitive<double> primitive = Primitive<double>(Triangle<double>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    RayAttribution blame{};

    [[nodiscard]] double of(double (*metric)(const Sample&)) {
        blame.tape = &tape;
        return metric(Sample{.format = &format,
                             .ray = &ray,
                             .primitive = &primitive,
                             .attribution = &blame,
                             .weights = {"w", "u", "v"}});
    }
};

}  // namespace

TEST_CASE("the error of barycentric weights agrees with rational arithmetic for every form", "[metric][triangle]") {
    const Format format = *find_format("f32");
    std::map<std::string_view, int> sample_counts, wrong, exact;
    for_each_triangle(static_cast<int>(draws(2000)), [&](const TriangleDistribution& distribution,
                                                         const TriangleSample& sample) {
        const TriangleAnswer right = answer_of(sample);
        if (!right.meets()) return;
        const std::array<Rational, 3> weights{right.u, right.v, right.w};
        const Primitive<double> primitive(sample.triangle);
        TriangleForms::for_each([&]<class Form>() {
            const Tape tape = tape_of<Form>(sample);
            Rational most(0);
            bool finite = true, any = false;
            for (std::size_t k = 0; k < weights.size(); ++k) {
                if (Form::info.weights[k].empty()) continue;
                any = true;
                const auto node = std::ranges::find(tape.nodes, Form::info.weights[k], &TapeNode::label);
                finite = finite && std::isfinite(node->value);
                if (finite) most = std::max(most, Rational(abs(Rational(node->value) - weights[k])));
            }
            const RayAttribution blame{.tape = &tape};
            const double error = barycentric_error(Sample{.format = &format,
                                                          .ray = &sample.ray,
                                                          .primitive = &primitive,
                                                          .attribution = &blame,
                                                          .weights = Form::info.weights});
            ++sample_counts[Form::info.name], exact[Form::info.name] += error == 0;
            const double truly = most.convert_to<double>() * 0x1p24;
            const bool same = !any      ? std::isnan(error)
                              : !finite ? error == HUGE_VAL
                                        : std::fabs(error - truly) <= 0x1p-30 * truly + 0x1p-60;
            if (!same && wrong[Form::info.name]++ == 0)
                UNSCOPED_INFO(Form::info.name << ", " << distribution.name << ": " << error << ", and not " << truly);
        });
    });
    for (const auto& [name, count] : sample_counts) {
        INFO(name << ": exact " << exact[name] << " of " << count);
        CHECK(count > 500);
        CHECK(wrong[name] == 0);
    }
}

TEST_CASE("right weights have no error, and a NaN weight has an infinite error", "[metric][triangle]") {
    CHECK(AnsweredHit(0.25, 0.25, 0.5).of(barycentric_error) == 0);
    CHECK(AnsweredHit(0.25, 0.25, 0.5).of(barycentric_sum) == 0);
    CHECK(AnsweredHit(0.25, 0.25, 0.5 + 0x1p-24).of(barycentric_error) == 1);
    CHECK(AnsweredHit(0.25 - 0x1p-20, 0.25, 0.5).of(barycentric_error) == 16);
    CHECK(AnsweredHit(0.25 + 0x1p-24, 0.25, 0.5 + 0x1p-24).of(barycentric_sum) == 2);
    CHECK(AnsweredHit(0.25 - 0x1p-24, 0.25, 0.5 + 0x1p-24).of(barycentric_sum) == 0);
    CHECK(AnsweredHit(NAN, 0.25, 0.5).of(barycentric_error) == HUGE_VAL);
    CHECK(AnsweredHit(0.25, HUGE_VAL, 0.5).of(barycentric_sum) == HUGE_VAL);
    AnsweredHit transformed(0.25, 0.25, 0.5);  // the same ray and triangle, moved and mirrored together
    transformed.primitive.transform = transform_of(std::array<double, 12>{-2, 0, 0, 4, 0, 2, 0, 8, 0, 0, 2, 16});
    transformed.ray = {{3.5, 9, 22}, {0, 0, -2}};
    CHECK(transformed.of(barycentric_error) == 0);
    AnsweredHit ball(0.25, 0.25, 0.5);
    ball.primitive = Primitive<double>(Sphere<double>{{0, 0, 0}, 1});
    CHECK(std::isnan(ball.of(barycentric_error)));
}

TEST_CASE("the error of a triangle's normal is the rounding of its edges", "[metric][triangle]") {
    const Format format = *find_format("f32");
    const auto error = [&](const Triangle<double>& triangle) {
        const Primitive<double> primitive(triangle);
        const Ray<double> ray{{0.25, 0.25, 5}, {0, 0, -1}};
        const auto truth = measure::truth::make_certified(5, 0, 0);
        return measure::metric::normal_error(
            Sample{.t = 5, .format = &format, .true_t = &truth, .ray = &ray, .primitive = &primitive});
    };
    CHECK(error({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}) == 0);
    // b − a = (2^24 + 1, 0, 0) rounds and keeps its direction; (1, 0, 2^24 + 1) loses its 1.
    CHECK(error({{-1, 0, 0}, {0x1p24, 0, 0}, {-1, 1, 0}}) == 0);
    CHECK(error({{0, 0, -1}, {1, 0, 0x1p24}, {0, 1, -1}}) == Approx(0x1p-48).epsilon(1e-3));
}

}  // namespace lostbits::test::test_barycentric
