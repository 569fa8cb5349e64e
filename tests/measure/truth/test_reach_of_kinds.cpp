// The bound on how far errors of the inputs move t and the distance, compared with problems that have such errors: for
// every shape, with random rays, rays that run exactly across, along and through a primitive, and lengths and
// directions of every exponent.
#include <cmath>
#include <optional>
#include <vector>

#include "catch.hpp"
#include "counts.hpp"
#include "measure/seeded.hpp"
#include "measure/truth/conditioning.hpp"
#include "measure/truth/reach.hpp"
#include "measure/truth/truth.hpp"
#include "number/real.hpp"

namespace lostbits::test::test_reach_of_kinds {

using measure::truth::CertifiedNumber;
using measure::truth::find_truth;
using measure::truth::Length;
using measure::truth::Perturbation;
using measure::truth::Truth;

namespace {

struct Problem {
    Ray<double> ray;
    Primitive<double> primitive;
};

/// The numbers of a problem: origin, direction, primitive.
template <class S>
std::vector<S> numbers_of(const Ray<S>& ray, const Primitive<S>& primitive) {
    std::vector<S> all{ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x, ray.direction.y, ray.direction.z};
    all.insert(all.end(), primitive.shape_numbers().begin(), primitive.shape_numbers().end());
    return all;
}

/// A primitive of random numbers, rounded to `grid` (not rounded if it is 0), that its shape allows.
std::optional<Primitive<double>> draw_primitive(Seeded& rng, Shape shape, double grid) {
    Primitive<double> primitive(shape);
    const auto on_grid = [grid](double x) { return grid > 0 ? std::round(x / grid) * grid : x; };
    for_each_key(shape, [&](const Key& key, std::size_t k) {
        for (std::size_t i = k; i < k + key.count(); ++i)
            primitive.numbers[i] = on_grid(key.is_length() ? rng.uniform(0.05, 2) : rng.uniform(-2, 2));
    });
    if (primitive.is<Torus>() && primitive.numbers[7] >= primitive.numbers[6])
        std::swap(primitive.numbers[6], primitive.numbers[7]);
    if (primitive.is<Disc>() && rng.index(2) == 0) primitive.numbers[7] = 0;
    if (primitive.is<Disc>() && primitive.numbers[7] >= primitive.numbers[6])
        std::swap(primitive.numbers[6], primitive.numbers[7]);
    if (primitive.is<Box>())
        for (std::size_t i = 0; i < 3; ++i)
            if (primitive.numbers[i] > primitive.numbers[i + 3])
                std::swap(primitive.numbers[i], primitive.numbers[i + 3]);
    return broken_limit(primitive) ? std::nullopt : std::optional(primitive);
}

enum class Kind { random, whole, tiny_parts, spread, far };

/// A ray at a primitive. For `whole` rays all numbers are small whole numbers over 4, so that much is exactly equal,
/// parallel and perpendicular. For `tiny_parts`, components of the direction and the origin that would be zero are
/// tiny. For `spread`, they are so tiny that most are 0 in units of the largest component.
std::optional<Problem> draw(Seeded& rng, Shape shape, Kind kind) {
    const double grid = kind == Kind::random || kind == Kind::far ? 0 : kind == Kind::spread ? 1 : 0.25;
    const auto primitive = draw_primitive(rng, shape, grid);
    if (!primitive) return std::nullopt;
    const auto on_grid = [grid](const Vec<double>& v) {
        const auto one = [grid](double x) { return grid > 0 ? std::round(x / grid) * grid : x; };
        return Vec<double>(one(v.x), one(v.y), one(v.z));
    };
    const Vec<double> share(rng.uniform(0, 1), rng.uniform(0, 1), rng.uniform(0, 1));
    const Vec<double> aim = on_grid(visit(*primitive, [&](const auto& s) { return Vec<double>(s.point_at(share)); }));
    Vec<double> direction = on_grid(rng.vec(-2, 2));
    if (grid > 0)
        for (int i = 0; i < 3; ++i)
            if (rng.index(2) == 0) direction[i] = 0;
    if (direction == Vec<double>(0, 0, 0)) return std::nullopt;
    const double away = kind == Kind::far ? std::exp2(rng.uniform(3, 14)) : std::round(rng.uniform(1, 8));
    Problem p{{aim - away * direction, direction}, *primitive};
    if (kind == Kind::tiny_parts)
        for (Vec<double>* const v : {&p.ray.direction, &p.ray.origin})
            for (int i = 0; i < 3; ++i)
                if ((*v)[i] == 0 && rng.index(2) == 0) (*v)[i] = rng.signed_magnitude(-1000, -60);
    if (kind == Kind::spread)
        for (int i = 0; i < 3; ++i) {
            if (p.ray.direction[i] != 0) p.ray.direction[i] = std::ldexp(p.ray.direction[i], 260);
            else p.ray.direction[i] = rng.signed_magnitude(-822, -812);
            if (p.ray.origin[i] == 0) p.ray.origin[i] = rng.signed_magnitude(-1074, -1068);
        }
    return p;
}

/// Multiplies lengths by 2^lengths and directions by 2^directions; empty if a number leaves the range of doubles.
std::optional<Problem> scaled_by(const Problem& problem, int lengths, int directions) {
    Problem q = problem;
    bool kept = true;
    const auto scale = [&kept](double& x, int e) {
        const double to = std::ldexp(x, e);
        kept &= std::isfinite(to) && std::ldexp(to, -e) == x;
        x = to;
    };
    for (int i = 0; i < 3; ++i) scale(q.ray.origin[i], lengths), scale(q.ray.direction[i], directions);
    for_each_key(problem.primitive.shape, [&](const Key& key, std::size_t k) {
        for (std::size_t i = k; i < k + key.count(); ++i)
            scale(q.primitive.numbers[i], key.kind == Key::Kind::direction ? 0 : lengths);
    });
    return kept ? std::optional(q) : std::nullopt;
}

/// Largest change of t or the distance that was seen for a problem, divided by its bound.
class Trial {
public:
    /// `plain` is the problem before it was scaled, whose slopes have the same signs and are doubles.
    Trial(const Problem& problem, const Problem& plain, const Truth& truth, Length length, const FloatFormat& format,
          Perturbation perturbation)
        : problem_(problem),
          plain_(plain),
          truth_(truth),
          length_(length),
          normwise_(perturbation == Perturbation::normwise),
          x_(numbers_of(problem.ray, problem.primitive)),
          bound_(measure::truth::reach(problem.ray, problem.primitive, answer(truth), length, format, perturbation)) {
        for (const double x : x_) {
            const int e = x == 0 ? format.emin : std::max(std::ilogb(x), format.emin);
            step_.push_back(ldexp(Real(1), e - format.precision));
        }
        // Zeros of the direction stay zero, because they decide which surfaces the ray crosses.
        for (std::size_t i = 3; i < 6; ++i)
            if (x_[i] == 0) step_[i] = 0;
        precision_ = format.precision;
    }

    [[nodiscard]] double bound() const { return bound_; }
    [[nodiscard]] double worst(Seeded& rng, int draws) const {
        double most = 0;
        const auto slopes = measure::truth::gradient(plain_.ray, plain_.primitive);
        for (int k = 0; k < draws; ++k) {
            std::vector<double> way(x_.size());
            for (std::size_t i = 0; i < way.size(); ++i) way[i] = k % 2 ? rng.sign() : rng.uniform(-1, 1);
            if (k < 4 && !slopes.empty()) {  // the largest changes of t, both ways, with changes of d and without
                for (std::size_t i = 0; i < way.size(); ++i) {
                    const double slope = slopes[i] + (length_ == Length::distance && i >= 3 && i < 6 ? turn(i) : 0);
                    way[i] = normwise_ ? slope : slope < 0 ? -1 : 1;
                    if (k % 2) way[i] = -way[i];
                    if (k >= 2 && i >= 3 && i < 6) way[i] = -way[i];
                }
            }
            most = std::max(most, seen(way));
        }
        if (most == 0) return 0;
        return bound_ > 0 ? most / bound_ : HUGE_VAL;
    }

private:
    [[nodiscard]] const CertifiedNumber& answer(const Truth& truth) const {
        return length_ == Length::distance ? truth.distance : truth.t;
    }
    /// The part of |d| in the slope of the distance by a component of d, over |d|: t dᵢ/d².
    [[nodiscard]] double turn(std::size_t i) const {
        const Vec<double>& d = plain_.ray.direction;
        const CertifiedNumber t = find_truth(plain_.ray, plain_.primitive).t;
        return std::ldexp(t.hi, static_cast<int>(t.exponent)) * d[static_cast<int>(i) - 3] / dot(d, d);
    }
    /// Change of the answer, in the unit of the bound; 0 if the changed problem has no answer.
    [[nodiscard]] double seen(const std::vector<double>& way) const {
        std::vector<Real> moved(x_.begin(), x_.end());
        for (std::size_t i = 0; i < moved.size() && !normwise_; ++i) moved[i] += step_[i] * way[i];
        const auto turn_vector = [&](std::size_t first, std::size_t end) {
            Real size = 0, along = 0;
            for (std::size_t i = first; i < end; ++i) size += square(Real(x_[i])), along += square(Real(way[i]));
            if (along == 0) return;
            const Real scale = sqrt(size) / sqrt(along) * ldexp(Real(1), -precision_);
            for (std::size_t i = first; i < end; ++i) moved[i] += way[i] * scale;
        };
        if (normwise_) {
            turn_vector(0, 3), turn_vector(3, 6);
            for_each_key(problem_.primitive.shape,
                         [&](const Key& key, std::size_t k) { turn_vector(6 + k, 6 + k + key.count()); });
        }
        const Ray<Real> ray{{moved[0], moved[1], moved[2]}, {moved[3], moved[4], moved[5]}};
        Primitive<Real> primitive(problem_.primitive.shape);
        for (std::size_t i = 6; i < moved.size(); ++i) primitive.numbers[i - 6] = moved[i];
        if (!measure::truth::is_valid(ray) || !measure::truth::is_valid(primitive)) return 0;
        const Truth found = find_truth(ray, primitive);
        if (!found.is_hit()) return 0;
        return std::fabs(measure::truth::scaled_difference(answer(found), answer(truth_),
                                                           measure::truth::exponent_of_unit(answer(truth_))));
    }

    Problem problem_, plain_;
    Truth truth_;
    Length length_;
    bool normwise_;
    int precision_ = 0;
    std::vector<double> x_;
    std::vector<Real> step_;
    double bound_;
};

/// Leaves out a problem if nearby problems are hit elsewhere: at a rim or an edge, which no bound covers.
bool is_of_use(const Truth& truth, Shape shape) {
    if (!truth.is_hit() || truth.t.is_zero() || truth.on_surface) return false;
    const bool smooth = shape == Shape::sphere || shape == Shape::ellipsoid || shape == Shape::capsule;
    return smooth || !truth.touches;
}

/// A problem within the errors may begin on the other side, and then has another root.
bool may_begin_on_surface(const Problem& problem) {
    return visit(problem.primitive, [&](const auto& s) { return s.distance(problem.ray.origin); }) < 0x1p-40;
}

struct Tally {
    int trials = 0, beyond = 0, loose = 0;
    double worst = 0;
};

/// Tries problems of a shape; returns the observed changes divided by the bounds.
Tally try_kind(Shape shape, Kind kind, const FloatFormat& format, Perturbation perturbation, int draws, bool scale) {
    Tally tally;
    Seeded rng(0x5ca1ab1e + static_cast<std::uint64_t>(shape) * 16 + static_cast<std::uint64_t>(kind));
    for (int i = 0; i < draws; ++i) {
        const auto drawn = draw(rng, shape, kind);
        if (!drawn) continue;
        const int widest = format == binary64 ? 1000 : 100;
        const int lengths = scale ? static_cast<int>(rng.integer(-widest, widest)) : 0,
                  directions = scale ? static_cast<int>(rng.integer(-widest, widest)) : 0;
        const auto problem = scaled_by(*drawn, lengths, directions);
        if (!problem || !measure::truth::is_valid(problem->ray) || !measure::truth::is_valid(problem->primitive))
            continue;
        const Truth truth = find_truth(problem->ray, problem->primitive);
        if (!is_of_use(truth, shape) || (kind == Kind::spread && may_begin_on_surface(*problem))) continue;
        for (const Length length : {Length::parameter, Length::distance}) {
            const Trial trial(*problem, *drawn, truth, length, format, perturbation);
            const double ratio = trial.worst(rng, 8);
            ++tally.trials;
            tally.beyond += ratio > 1;
            tally.loose += ratio < 0.4;
            tally.worst = std::max(tally.worst, ratio);
        }
    }
    return tally;
}

/// In double and in float.
void check_kind(Shape shape, Kind kind, int draws, bool scale, int percent) {
    for (const FloatFormat& format : {binary64, binary32}) {
        for (const Perturbation perturbation : {Perturbation::componentwise, Perturbation::normwise}) {
            const Tally tally = try_kind(shape, kind, format, perturbation, draws, scale);
            INFO(row_of(shape).name << ", kind " << static_cast<int>(kind) << ", " << format.precision << " bits, "
                                    << (perturbation == Perturbation::normwise ? "normwise" : "componentwise"));
            CHECK(tally.trials >= draws / 3);
            CHECK(tally.beyond == 0);
            CHECK(tally.worst > 0.99);
            CHECK(tally.loose * 100 <= tally.trials * percent);
        }
    }
}

double inherent_bits(const Ray<double>& ray, const Primitive<double>& primitive, Length length = Length::parameter) {
    const Truth truth = find_truth(ray, primitive);
    REQUIRE(truth.is_hit());
    const CertifiedNumber& answer = length == Length::distance ? truth.distance : truth.t;
    return measure::truth::inherent_bits(measure::truth::reach(ray, primitive, answer, length, binary64), answer,
                                         binary64);
}

}  // namespace

// A ray in the plane of a face of a box whose direction leaves that plane by 2^-900 of itself may enter anywhere along
// it.
TEST_CASE("answers at every shape move as far as their reach and no further", "[reach]") {
    for (const ShapeRow& row : shape_rows) {
        for (const Kind kind : {Kind::random, Kind::whole, Kind::far})
            check_kind(row.shape, kind, test::draws(60), false, 6);
        if (row.shape != shape_as<Tube>)  // through a rim exactly
            check_kind(row.shape, Kind::tiny_parts, test::draws(60), false, row.shape == shape_as<Box> ? 35 : 6);
    }
}

// A plane had a reach of at most 2^100 lengths. Whole numbers meet rims of cones, tubes and tori, where a problem
// within the errors may have another root.
TEST_CASE("answers of rays with exponents far apart move no further than their reach", "[reach]") {
    for (const ShapeRow& row : shape_rows) {
        if (row.shape == shape_as<Cylinder> || row.shape == shape_as<Cone> || row.shape == shape_as<Tube> ||
            row.shape == shape_as<Torus>)
            continue;
        for (const Perturbation perturbation : {Perturbation::componentwise, Perturbation::normwise}) {
            const Tally tally = try_kind(row.shape, Kind::spread, binary64, perturbation, test::draws(1500), false);
            INFO(row.name << ", " << (perturbation == Perturbation::normwise ? "normwise" : "componentwise"));
            CHECK(tally.trials >= 40);
            CHECK(tally.beyond == 0);
        }
    }
}

// 3 of 42,000 boxes had a reach of 0, because a component that is 0 in units of the largest one was treated as that of
// a ray along the slab.
TEST_CASE("a box moves no further than its reach if the crossed component is 0 beside the largest", "[reach]") {
    Seeded rng(0xb0c5);
    int trials = 0;
    for (int i = 0; i < test::draws(2000); ++i) {
        const int x = static_cast<int>(rng.integer(0, 2)), z = (x + 1 + static_cast<int>(rng.index(2))) % 3;
        const double size = rng.signed_magnitude(20, 60), past = rng.uniform(1, 1024), speed = rng.uniform(3.2, 4.8);
        Ray<double> ray{{0, 0, 0}, {0, 0, 0}};
        Vec<double> corner = std::fabs(size) * Vec<double>(1, 1, 1);
        ray.origin[x] = -4 * size, ray.direction[x] = std::ldexp(size, 200);
        ray.origin[z] = -std::ldexp(past, -1074), ray.direction[z] = std::ldexp(past / speed, -1074 + 200);
        Box<double> box{-corner, corner};
        box.lo[z] = 0;
        const Problem problem{ray, box};
        const Truth truth = find_truth(ray, problem.primitive);
        if (!is_of_use(truth, Shape::box)) continue;
        for (const Length length : {Length::parameter, Length::distance}) {
            CHECK(Trial(problem, problem, truth, length, binary64, Perturbation::componentwise).worst(rng, 8) <= 1);
            ++trials;
        }
    }
    CHECK(trials > 200);
    const Ray<double> ray{{0x1.b437a9af9d79bp+245, -0x1.9e9487cd8c907p+787, 0x1.19be6a55e415p-477},
                          {-0x1.137af8d27e716p+214, 0x1.4bef78a6b73afp-849, -0x1.8155203ef9416p-901}};
    const Box<double> box{{-0x1.a502477f942e9p+729, -0x1.fe9e241d036fcp+864, 0x1.d5b492bfc5e19p-937},
                          {-0x1.d32d98a38d163p+604, -0x1.6d2571c574625p+725, 0x1.d0828ff73a694p-783}};
    CHECK(inherent_bits(ray, box) > 0.5);
}

TEST_CASE("answers at every exponent move as far as their reach and no further", "[reach]") {
    for (const ShapeRow& row : shape_rows)
        for (const Kind kind : {Kind::random, Kind::whole}) check_kind(row.shape, kind, test::draws(20), true, 8);
}

TEST_CASE("inherent bits are right for rays across an axis, tiny components and extreme exponents", "[reach]") {
    const Capsule<double> capsule{{0, 0, -1}, {0, 0, 1}, 1};
    const double across = inherent_bits({{-4, 0.125, 1.25}, {1, 0, 0}}, capsule);
    CHECK(across == Approx(2.1).margin(0.1));
    CHECK(inherent_bits({{-4, 0.125, 1.25}, {1, 0, 0x1p-60}}, capsule) == Approx(across).margin(0.01));
    const Sphere<double> sphere{{0, 0, 0}, 1};
    const double along = inherent_bits({{-4, 0, 0}, {1, 0, 0}}, sphere);
    CHECK(along == Approx(2).margin(0.1));
    for (const double tiny : {0x1p-600, 0x1p-1000}) CHECK(inherent_bits({{-4, 0, 0}, {1, 0, tiny}}, sphere) == along);
    const Ray<double> ray{{-0x1f7ae8a9aba069p-1074, -0x1261acd148eb7bp-1074, 0x159195bac67929p-1074},
                          {0x89adafdb0ebb5p-1071, 0x16bcd0e3a28603p-1074, -0xe6e3ea7ebff1fp-1072}};
    const Sphere<double> least{{0x11fae421b59d93p-1074, 0x45437827c05a5p-1074, -0x1a937274a4e255p-1074},
                               0x9a4f95e1a59ffp-1074};
    // Compared with exact fractions of the distance's own differences.
    CHECK(inherent_bits(ray, least, Length::distance) == Approx(1.1836035629).epsilon(1e-9));
}

}  // namespace lostbits::test::test_reach_of_kinds
