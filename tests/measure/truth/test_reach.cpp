// The bound on how far errors of the inputs move t, compared with problems that have such errors, in 2048 bits: with a
// primitive for each ray, and with one transformed primitive whose numbers are far apart.
#include <array>
#include <cmath>
#include <optional>

#include "catch.hpp"
#include "counts.hpp"
#include "measure/truth/hard_rays.hpp"
#include "measure/truth/reach_of_t.hpp"
#include "measure/truth/textbook.hpp"
#include "measure/truth/truth.hpp"

namespace test_reach {

using namespace lostbits;
using measure::truth::Perturbation;
using test::reach_of_t;
using test::Seeded;
using namespace test::textbook;

namespace {

double half_ulp_of(double x, const FloatFormat& format) {
    const int e = x == 0 ? format.emin : std::max(std::ilogb(x), format.emin);
    return std::ldexp(1.0, e - format.precision);
}

/// A ray at a primitive, its answer, and other problems within the errors.
class Trial {
public:
    Trial(const Ray<double>& ray, const Primitive<double>& primitive, const FloatFormat& format)
        : ray_(ray),
          primitive_(primitive),
          format_(format),
          count_(6 + row_of(primitive.shape).number_count),
          x_(numbers_of(ray, primitive)) {
        for (std::size_t k = 0; k < 3; ++k) book_.crossed[k] = x_[3 + k] != 0;
        const auto found = measure::truth::find_truth(ray, primitive);
        if (!found.is_hit()) return;
        certified_ = found.t;
        find_root(found.t);
    }
    /// True if the answer is a root or a face of the textbook, and not where the ray begins inside.
    [[nodiscard]] bool is_of_use() const { return t_.has_value(); }
    /// True if the ray still hits after the largest changes of t, in both directions.
    [[nodiscard]] bool is_decided() const { return is_decided_; }

    /// The largest observed change of t, divided by its reach; 0 if both are 0.
    double worst_of_componentwise(Seeded& rng, int draws) {
        std::array<double, most_of_problem> step{};
        for (std::size_t i = 0; i < count_; ++i) step[i] = half_ulp_of(static_cast<double>(x_[i]), format_);
        // Zeros of the direction stay zero, because they decide which surfaces the ray crosses.
        for (std::size_t i = 3; i < 6; ++i)
            if (x_[i] == 0) step[i] = 0;
        Wide most = 0;
        for (const int side : {-1, 1}) {
            Numbers moved = x_;
            for (std::size_t i = 0; i < count_; ++i) moved[i] += step[i] * (slope(i) < 0 ? -side : side);
            is_decided_ &= take(moved, most);
        }
        for (int k = 0; k < draws; ++k) {
            Numbers moved = x_;
            for (std::size_t i = 0; i < count_; ++i) moved[i] += step[i] * (k % 2 ? rng.sign() : rng.uniform(-1, 1));
            take(moved, most);
        }
        return over(most, reach_of_t(ray_, primitive_, certified_, format_));
    }
    double worst_of_normwise(Seeded& rng, int draws) {
        Wide most = 0;
        for (int k = -2; k < draws; ++k) {
            Numbers moved = x_;
            for_each_vector([&](std::size_t first, std::size_t end) {
                Wide size = 0, along = 0;
                std::array<Wide, most_of_problem> way;
                for (std::size_t i = first; i < end; ++i) {
                    way[i] = k < 0 ? Wide(slope(i) * (k == -1 ? 1 : -1)) : Wide(rng.uniform(-1, 1));
                    size += x_[i] * x_[i], along += way[i] * way[i];
                }
                if (along == 0) return;
                const Wide scale = Wide(sqrt(size)) / Wide(sqrt(along)) * std::ldexp(1.0, -format_.precision);
                for (std::size_t i = first; i < end; ++i) moved[i] += way[i] * scale;
            });
            take(moved, most);
        }
        return over(most, reach_of_t(ray_, primitive_, certified_, format_, Perturbation::normwise));
    }

private:
    template <class Act>
    void for_each_vector(const Act& act) const {
        act(0, 3), act(3, 6);
        for_each_key(primitive_.shape, [&](const Key& key, std::size_t k) { act(6 + k, 6 + k + key.count()); });
    }
    void find_root(const measure::truth::CertifiedNumber& truth) {
        const auto is_it = [&](const Wide& t) {
            const Wide apart = abs(Wide(t - Wide(truth.hi) * ldexp(Wide(1), static_cast<int>(truth.exponent)) -
                                        Wide(truth.lo) * ldexp(Wide(1), static_cast<int>(truth.exponent))));
            return truth.is_zero() ? t == 0 : apart <= ldexp(abs(t), -70);
        };
        for (const int which : {-1, 1}) {
            book_.which = which;
            const auto t = book_.t(primitive_.shape, x_);
            if (!t || !is_it(*t)) continue;
            t_ = t;
            break;
        }
        if (!t_ || primitive_.shape != Shape::box) return;
        Wide nearest = -1;
        for (std::size_t k = 0; k < 3; ++k) {
            const Wide off = abs(residual(Shape::box, x_, *t_, k));
            if (x_[3 + k] != 0 && (nearest < 0 || off < nearest)) nearest = off, axis_ = k;
        }
    }
    [[nodiscard]] Wide slope(std::size_t i) const {
        const Wide step = ldexp(Wide(1), -900);
        Numbers up = x_, down = x_;
        up[i] += step, down[i] -= step;
        return (residual(primitive_.shape, up, *t_, axis_) - residual(primitive_.shape, down, *t_, axis_)) / (2 * step);
    }
    /// True if the changed problem has an answer.
    bool take(const Numbers& moved, Wide& most) const {
        const auto t = book_.t(primitive_.shape, moved);
        if (t) most = std::max(most, Wide(abs(Wide(*t - *t_))));
        return t.has_value();
    }
    static double over(const Wide& most, double bound) {
        if (most == 0) return 0;
        return bound > 0 ? static_cast<double>(Wide(most / Wide(bound))) : HUGE_VAL;
    }

    Ray<double> ray_;
    Primitive<double> primitive_;
    FloatFormat format_;
    std::size_t count_, axis_ = 0;
    bool is_decided_ = true;
    Numbers x_;
    Textbook book_;
    measure::truth::CertifiedNumber certified_;
    std::optional<Wide> t_;
};

struct Tally {
    int trials = 0, loose = 0;
    double worst = 0;

    void take(double ratio, bool decided) {
        ++trials, loose += decided && ratio > 0 && ratio < 0.5, worst = std::max(worst, ratio);
    }
};

const int rays_per_distribution = test::draws(1000);

/// Checks hard rays, with errors of a given format or of the format in which they are stored.
void check_distributions(const std::vector<test::HardDistribution>& distributions, Tally& all,
                         const std::optional<FloatFormat>& format = {}) {
    for (const test::HardDistribution& distribution : distributions) {
        const FloatFormat& of_errors = format ? *format : distribution.storage;
        INFO(distribution.name << ", " << of_errors.precision << " bits");
        Tally needles;  // half an ulp turns one into a different plane
        Tally& tally = distribution.name == "a needle" ? needles : all;
        Seeded rng(0x7eac);
        for (int i = 0; i < rays_per_distribution; ++i) {
            const auto [ray, primitive, range] = distribution.draw(rng);
            if (!measure::truth::is_valid(ray) || !measure::truth::is_valid(primitive)) continue;
            Trial trial(ray, primitive, of_errors);
            if (!trial.is_of_use()) continue;
            const double ratio = trial.worst_of_componentwise(rng, 6);
            CHECK(ratio <= 1);
            CHECK(trial.worst_of_normwise(rng, 6) <= 1);
            tally.take(ratio, trial.is_decided());
        }
    }
}

/// Checks that the bound is within a factor of two of the largest change seen, for all but `percent` of the problems.
void check_tightness(const Tally& tally, int percent) {
    CHECK(tally.trials >= 200);
    CHECK(tally.worst > 0.999);
    CHECK(tally.loose * 100 <= tally.trials * percent);
}

}  // namespace

TEST_CASE("t moves no further than its reach - spheres", "[reach]") {
    using test::Wide;
    Tally tally;
    check_distributions(test::hard_distributions(Shape::sphere, {binary32}, Wide::yes), tally);
    check_distributions(test::hard_distributions(Shape::sphere, {binary64}),
                        tally);  // 2048 bits do not hold wide squares
    check_distributions(test::hard_distributions(Shape::sphere, {binary32}), tally, binary16);
    check_tightness(tally, 1);
}

TEST_CASE("t moves no further than its reach - boxes", "[reach]") {
    Tally tally;
    check_distributions(test::hard_distributions(Shape::box, {binary32, binary64}), tally);
    check_tightness(tally, 4);
}

TEST_CASE("t moves no further than its reach - triangles", "[reach]") {
    Tally tally;
    check_distributions(test::hard_distributions(Shape::triangle, {binary32}), tally);
    check_tightness(tally, 5);
}

namespace {

/// The near root of a transformed sphere: the ray by Cramer's rule, x the numbers of the ray, the sphere, and the
/// matrix row by row.
std::optional<Wide> near_root_under(const std::array<Wide, 22>& x) {
    const auto row = [&x](std::size_t k) { return Vec<Wide>(x[10 + k], x[11 + k], x[12 + k]); };
    const Vec<Wide> a = row(0), b = row(4), c = row(8), shift(x[13], x[17], x[21]);
    const std::array<Vec<Wide>, 3> columns{cross(b, c), cross(c, a), cross(a, b)};
    const Wide det = dot(a, cross(b, c));
    const auto back = [&](const Vec<Wide>& v) {
        const Vec<Wide> scaled = v.x * columns[0] + v.y * columns[1] + v.z * columns[2];
        return Vec<Wide>(scaled.x / det, scaled.y / det, scaled.z / det);
    };
    const Vec<Wide> o(x[0], x[1], x[2]), d = back({x[3], x[4], x[5]});
    const Vec<Wide> f = back(Vec<Wide>(o - shift)) - Vec<Wide>(x[6], x[7], x[8]);
    const Wide aa = dot(d, d), h = dot(f, d), q = h * h - aa * (dot(f, f) - x[9] * x[9]);
    if (q < 0) return std::nullopt;
    return Wide((-h - sqrt(q)) / aa);
}

}  // namespace

TEST_CASE("t moves no further than its reach - with transforms of widely spread numbers", "[reach]") {
    int trials = 0, known = 0, near = 0;
    for (const FloatFormat& format : {binary32, binary64}) {
        Seeded rng(0x5ca1e);
        for (int i = 0; i < test::draws(20000); ++i) {
            Primitive<double> primitive(Sphere<double>{rng.vec(-2, 2), rng.uniform(0.5, 2)});
            // Turns by half a turn leave numbers like these where others are 1; scales are as small.
            std::array<double, 12> m{};
            const int size = static_cast<int>(rng.integer(-50, 50));
            for (double& x : m) x = rng.signed_magnitude(size - (i % 2 ? 70 : 50), size - (i % 2 ? 50 : 20));
            for (const std::size_t k : {0, 5, 10}) m[k] = rng.signed_magnitude(size - 1, size + 1);
            const auto stored = [&format](double x) { return test::stored(x, format); };
            primitive.transform = convert_numbers(Transform<double>{m, false, 1}, stored);
            primitive = convert_numbers(primitive, stored);
            const Vec<double> from = std::ldexp(1.0, size) * rng.vec(-8, 8),
                              at = primitive.transform->map().point(primitive.point(0));
            const Ray<double> ray{test::stored(at + from, format),
                                  test::stored(-from + std::ldexp(0.5, size) * rng.vec(-1, 1), format)};
            const auto truth = measure::truth::find_truth(ray, primitive);
            if (!truth.is_hit() || truth.t.is_zero()) continue;
            std::array<Wide, 22> x;
            std::array<double, 22> step{};
            for (int k = 0; k < 3; ++k) x[k] = ray.origin[k], x[3 + k] = ray.direction[k];
            for (std::size_t k = 0; k < 4; ++k) x[6 + k] = primitive.numbers[k];
            for (std::size_t k = 0; k < 12; ++k) x[10 + k] = primitive.transform->matrix[k];
            for (std::size_t k = 0; k < 22; ++k) step[k] = half_ulp_of(static_cast<double>(x[k]), format);
            const auto t = near_root_under(x);
            if (!t || *t <= 0) continue;
            ++trials;
            const double bound = reach_of_t(ray, primitive, truth.t, format);
            if (!std::isfinite(bound)) continue;
            ++known;
            Wide most = 0;
            for (int k = 0; k < 6; ++k) {
                auto moved = x;
                for (std::size_t j = 0; j < 22; ++j) moved[j] += step[j] * (k % 2 ? rng.sign() : rng.uniform(-1, 1));
                if (const auto other = near_root_under(moved)) most = std::max(most, Wide(abs(Wide(*other - *t))));
            }
            CHECK(most <= Wide(bound));
            near += most > Wide(bound) / 64;
        }
    }
    CHECK(trials > 500);
    CHECK(known > trials * 9 / 10);
    CHECK(near > trials / 2);
}

}  // namespace test_reach
