// Eyes exactly on the surface: the truth for both values of `at_origin`, and every form by its own value.
#include <array>
#include <map>
#include <set>

#include "catch.hpp"
#include "intersect/catalogue.hpp"
#include "measure/evaluate/evaluate.hpp"
#include "measure/rows.hpp"
#include "measure/truth/conditioning.hpp"
#include "number/real.hpp"

namespace test_at_origin {

using namespace lostbits;

using intersect::AtOrigin;
using intersect::Touching;
using measure::answer::Outcome;
using measure::truth::find_truth;
using measure::truth::Truth;

namespace {

struct SphereOrigins {
    Vec<double> origin, direction;
    double radius;
};

/// Whole a² + b² + c² = n²; directions in, out of and along the sphere, some of them of no power of two's length. The
/// centre is the origin, so that h = o·d and a = d·d are whole numbers too.
const SphereOrigins on_sphere[] = {
    {{1, 2, 2}, {-1, -2, -2}, 3},    {{1, 2, 2}, {-2, 0.5, -1}, 3},   {{3, 0, 0}, {-1, 0, 0}, 3},
    {{2, 3, 6}, {-6, 3, -2}, 7},     {{1, 4, 8}, {-0.25, -1, -4}, 9}, {{4, 4, 7}, {1, -9, 3}, 9},
    {{1, 2, 2}, {1, 2, 2}, 3},       {{1, 2, 2}, {2, -0.5, 1}, 3},    {{2, 3, 6}, {6, -3, 2}, 7},
    {{1, 2, 2}, {2, -2, 1}, 3},      {{3, 0, 0}, {0, 3, 4}, 3},       {{-2, -6, 9}, {3, -1, 0}, 11},
    {{1, 4, 8}, {-4, -3, 2}, 9},     {{-6, 6, 7}, {1, 0, -1}, 11},    {{-1, -12, 12}, {5, 7, -7}, 17},
    {{6, 10, 15}, {-1, -3, -1}, 19},
};

Sphere<double> sphere_of(const SphereOrigins& origins) { return {{0, 0, 0}, origins.radius}; }

template <class T>
Vec<T> lifted(const Vec<double>& v) {
    return {T(v.x), T(v.y), T(v.z)};
}

/// True if the contract of a form covers a ray: a form that returns only the near root has no answer if that lies
/// behind.
bool is_requested(const intersect::Info& info, double h) { return info.roots != intersect::Roots::near_only || h <= 0; }

}  // namespace

TEST_CASE("only the sphere on which the eye lies is skipped", "[measure][truth]") {
    const Ray<double> ray{{3, 0, 0}, {1, 0, 0}};
    const Primitive<double> two[] = {Primitive<double>(Sphere<double>{{0, 0, 0}, 3}),
                                     Primitive<double>(Sphere<double>{{10, 0, 0}, 2})};
    const Truth closed = find_truth(ray, two), ahead = find_truth(ray, two, {}, {Touching::hit, AtOrigin::miss});
    CHECK(closed.primitive == 0);
    CHECK(closed.t.is_zero());
    CHECK(ahead.primitive == 1);
    CHECK(round_truth(ahead, ray, two[1], binary64) == 5);
    // t = 0 has no κ. At the far root P = (−1, 2, 2), t = 2: from P·(∂o + ∂t d + t ∂d) = r ∂r with P·d = 1, ∂t/∂o = −P,
    // ∂t/∂r = 3 and ∂t/∂d.x = 2: (1·1 + 2·2 + 2·2 + 3·3 + 1·2)/2.
    const Ray<double> in{{1, 2, 2}, {-1, 0, 0}};
    CHECK(std::isinf(measure::truth::condition(in, two[0])));
    CHECK(measure::truth::condition(in, two[0], AtOrigin::miss) == Approx(10).epsilon(0x1p-19));
}

TEST_CASE("every unrounded sphere form decides eyes on the surface as its contract says", "[measure][truth]") {
    using Exact = BasicReal<2048>;
    // d·d is 1 or 2, so that 1/a is exact as well: a root that is 0 is computed as 0, and no rounding decides.
    std::vector<Vec<double>> directions;
    for (int code = 0; code < 27; ++code) {
        const Vec<double> d(code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1);
        if (dot(d, d) == 1 || dot(d, d) == 2) directions.push_back(d);
    }
    REQUIRE(directions.size() == 18);
    std::map<std::string_view, std::array<int, 3>> seen;  // looking in, along, out
    std::set<std::string_view> undecided;
    intersect::sphere::SphereForms::for_each([&]<class Form>() {
        if constexpr (Form::info.formats == intersect::Formats::all) {
            for (const SphereOrigins& origins : on_sphere) {
                for (const Vec<double>& d : directions) {
                    const double h = dot(origins.origin, d), a = dot(d, d);
                    if (!is_requested(Form::info, h)) continue;
                    if (Form::info.direction == intersect::Direction::unit && a != 1) continue;
                    const Hit<Exact> got =
                        Form::intersect(Ray<Exact>{lifted<Exact>(origins.origin), lifted<Exact>(d)},
                                        Sphere<Exact>{Vec<Exact>(Exact(0), Exact(0), Exact(0)), Exact(origins.radius)});
                    INFO(Form::info.name << " from " << origins.origin.x << " " << origins.origin.y << " "
                                         << origins.origin.z << ", h " << h);
                    if (h == 0 && isnan(got.t)) {
                        undecided.insert(Form::info.name);
                        continue;
                    }
                    const Truth truth = find_truth({origins.origin, d}, Primitive<double>(sphere_of(origins)), {},
                                                   Form::info.convention());
                    CHECK(got.hit == truth.is_hit());
                    // pbrt_interval takes the root of a length that is not a square.
                    const Exact want(truth.is_hit() && !truth.t.is_zero() ? -2 * h / a : 0);
                    if (got.hit) CHECK(abs(got.t - want) <= ldexp(Exact(1), -1900));
                    ++seen[Form::info.name][h < 0 ? 0 : h == 0 ? 1 : 2];
                }
            }
        }
    });
    for (const auto& [name, count] : seen) {
        INFO(name);
        CHECK(count[0] > 15);
        if (undecided.count(name) == 0) CHECK(count[1] > 0);
    }
    // Along the tangent plane, these forms compute t = c/q as 0/0.
    CHECK(undecided == std::set<std::string_view>{"sphere.closest_approach", "sphere.cross_product",
                                                  "sphere.early_exit", "sphere.factored_c", "sphere.kahan_discriminant",
                                                  "sphere.newton_refined", "sphere.unified", "sphere.unified_unit"});
}

TEST_CASE("every unrounded box form hits a box at t = 0 if the eye lies on it", "[measure][truth]") {
    using Exact = BasicReal<2048>;
    const Primitive<double> box(Box<double>{{-1, -2, -3}, {1, 2, 3}});
    const Vec<double> eyes[] = {{1, 0.5, 1}, {-1, 0.5, -2}, {0.25, 2, 1}, {0.5, 1, -3}, {1, 2, 0.5}, {-1, -2, -3}};
    int hits = 0, misses = 0;
    intersect::box::BoxForms::for_each([&]<class Form>() {
        CHECK(Form::info.at_origin == AtOrigin::hit);
        for (const Vec<double>& eye : eyes) {
            for (int signs = 0; signs < 8; ++signs) {
                const Vec<double> d((signs & 1) != 0 ? -1 : 1, (signs & 2) != 0 ? -0.5 : 0.5,
                                    (signs & 4) != 0 ? -2 : 2);
                const Truth truth = find_truth({eye, d}, box, {}, Form::info.convention());
                const Hit<Exact> got =
                    Form::intersect(Ray<Exact>{lifted<Exact>(eye), lifted<Exact>(d)},
                                    Box<Exact>{lifted<Exact>(box.box().lo), lifted<Exact>(box.box().hi)}, Exact(1000));
                INFO(Form::info.name << " from " << eye.x << " " << eye.y << " " << eye.z << ", signs " << signs);
                CHECK(got.hit == truth.is_hit());
                if (got.hit) CHECK(got.t == 0);
                ++(got.hit ? hits : misses);
            }
        }
    });
    CHECK((hits > 100 && misses > 20));
}

TEST_CASE("a form that skips t = 0 is judged by its own contract, not by another form's", "[measure][truth]") {
    const intersect::table::Intersector* const interval = &test::form_named("sphere.pbrt_interval");
    for (const SphereOrigins& origins : on_sphere) {
        scene::rays::RayGroup group;
        group.rays.push({origins.origin, origins.direction});
        group.rays.width = 1;
        group.rays.y1 = 1;
        group.primitives = {Primitive<double>(sphere_of(origins))};
        const double h = dot(origins.origin, origins.direction);
        const auto outcome = [&](std::optional<Touching> judged, const char* format) {
            auto summaries = measure::evaluate::measure_groups(
                {group}, {{interval, *find_format(format), judged}},
                {measure::metric::find_metric("lost_bits"), measure::metric::find_metric("input_error"),
                 measure::metric::find_metric("excess_bits")},
                {});
            for (std::size_t k = 0; k < measure::answer::outcome_names.size(); ++k) {
                if (summaries[0].outcomes[k] == 1) return std::pair{static_cast<Outcome>(k), std::move(summaries[0])};
            }
            throw std::logic_error("no outcome");
        };
        for (const char* format : {"f32", "f64"}) {  // wide enough for its intervals to decide
            INFO(format << ", h " << h);
            const auto [own, summary] = outcome({}, format);
            CHECK(own == (h < 0 ? Outcome::agree_hit : Outcome::agree_miss));
            if (h < 0) {
                CHECK(summary.metrics[0].quantile(1) < 8);
                CHECK(summary.metrics[1].quantile(1) == 0);  // the inputs are numbers of every format
                CHECK(std::isfinite(summary.metrics[2].quantile(1)));
            }
            for (const Touching judged : {Touching::hit, Touching::miss}) {
                const bool true_hit = h != 0 || judged == Touching::hit;
                const Outcome want = h < 0 ? Outcome::agree_hit : true_hit ? Outcome::false_miss : Outcome::agree_miss;
                const auto [other, by_other] = outcome(judged, format);
                CHECK(other == want);
                if (h < 0) CHECK(by_other.metrics[0].quantile(1) == find_format(format)->parameters.precision);
            }
        }
    }
}

TEST_CASE("rounded inputs that touch a primitive follow the convention of the ideal ones", "[measure][truth]") {
    scene::rays::RayGroup group;
    group.rays.push({{-5, 1 - 0x1p-20, 0}, {1, 0, 0}});  // a tangent in bf16
    group.rays.width = 1;
    group.rays.y1 = 1;
    group.primitives = {Primitive<double>(Sphere<double>{{0, 0, 0}, 1})};
    const measure::truth::Band band(group);
    const measure::truth::FormatInputs inputs = band.inputs(*find_format("bf16"), {.stored_truth = true});
    CHECK(band.truth(0, Touching::miss).is_hit());
    CHECK(inputs.find_stored_truth(0, Touching::hit).is_hit());
    CHECK_FALSE(inputs.find_stored_truth(0, Touching::miss).is_hit());
}

}  // namespace test_at_origin
