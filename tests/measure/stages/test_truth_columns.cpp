// Truths of many rays at once are those of the same rays alone: the same decisions, and the same two words; and packs
// settle nearly all, but nothing of what is not proper.
//
//   LOSTBITS_RAYS=100000 build/test_truth "truth columns*"      so many rays of each of 21 or 19 distributions
#include <algorithm>

#include "catch.hpp"
#include "measure/stages/hard_problems.hpp"
#include "measure/truth/ranges.hpp"
#include "measure/truth/truth_columns.hpp"
#include "measure/widths.hpp"

namespace test_truth_columns {

using namespace lostbits;
using namespace lostbits::test;
using measure::truth::find_truth;
using measure::truth::Length;
using measure::truth::ProblemColumns;
using measure::truth::Tightness;
using measure::truth::Truth;
using measure::truth::TruthColumns;

namespace {

using Problem = HardRay;

template <class S>
class Columns {
public:
    explicit Columns(std::span<const Problem> problems) : size_(problems.size()) {
        for (const Problem& problem : problems) {
            for (int k = 0; k < 3; ++k) {
                numbers_[k].push_back(static_cast<S>(problem.ray.origin[k]));
                numbers_[static_cast<std::size_t>(k) + 3].push_back(static_cast<S>(problem.ray.direction[k]));
            }
            for (std::size_t k = 0; k < 6; ++k) numbers_[6 + k].push_back(static_cast<S>(problem.primitive.numbers[k]));
            numbers_[12].push_back(static_cast<S>(problem.range.tmax));
            numbers_[13].push_back(static_cast<S>(problem.range.tmin));
        }
        open_ends_ = problems.front().range.open_ends;
        shape_ = problems.front().primitive.shape;
    }
    [[nodiscard]] ProblemColumns<S> get() const {
        ProblemColumns<S> p{.size = size_,
                            .ray = {},
                            .shape = shape_,
                            .primitive = {},
                            .tmin = numbers_[13],
                            .tmax = numbers_[12],
                            .open_ends = open_ends_};
        for (std::size_t k = 0; k < 6; ++k) {
            p.ray[k] = numbers_[k];
            p.primitive[k] = numbers_[6 + k];
        }
        return p;
    }

private:
    std::size_t size_;
    Shape shape_;
    std::vector<S> numbers_[14];
    OpenEnds open_ends_;
};

/// One of the numbers of a problem: first those of its ray, then those of its primitive.
double& number_of(Problem& problem, std::size_t k) {
    if (k >= 6) return problem.primitive.numbers[k - 6];
    return k < 3 ? problem.ray.origin[static_cast<int>(k)] : problem.ray.direction[static_cast<int>(k) - 3];
}

const measure::truth::CertifiedNumber& length_of(const Truth& truth, Length length) {
    return length == Length::parameter ? truth.t : truth.distance;
}

/// Number of rays whose results in columns differ from those of the ray alone.
std::size_t count_different(std::span<const Problem> problems, const TruthColumns& found, Length length, bool tight) {
    std::size_t different = 0;
    for (std::size_t i = 0; i < problems.size(); ++i) {
        const Problem& p = problems[i];
        const Truth alone = find_truth(p.ray, p.primitive, {}, {}, p.range);
        if (found.decision[i] != alone.decision) {
            ++different;
            continue;
        }
        if (!alone.is_hit() || std::isnan(found.hi[i])) continue;
        const auto& t = length_of(alone, length);
        const double hi = std::ldexp(t.hi, static_cast<int>(t.exponent)),
                     lo = std::ldexp(t.lo, static_cast<int>(t.exponent));
        // The words are the same if the ray alone needed no wider intervals.
        if (tight && alone.proof_bits == 106) different += found.hi[i] != hi || found.lo[i] != lo;
        else
            different +=
                !(std::fabs((found.hi[i] - hi) + (found.lo[i] - lo)) <= found.bound[i] + std::fabs(hi) * 0x1p-70);
    }
    return different;
}

}  // namespace

TEST_CASE("truth columns: hard rays have the truth of single rays") {
    for (const Shape shape : {Shape::sphere, Shape::box}) {
        for (const FloatFormat& storage : {binary32, binary64}) {
            const std::vector<Problem> problems = problems_of(shape, storage, rays_per_distribution);
            TruthColumns found;
            for (const Length length : {Length::parameter, Length::distance}) {
                find_truth_columns(Columns<double>(problems).get(), {.length = length}, found);
                CHECK(found.size() == problems.size());
                CHECK(count_different(problems, found, length, true) == 0);
                CHECK(found.stages.ray_count() == problems.size());
                CHECK(found.stages.double_double > problems.size() / 4);
                if (storage == binary64) continue;
                find_truth_columns(Columns<float>(problems).get(), {.length = length}, found);
                CHECK(count_different(problems, found, length, true) == 0);
                find_truth_columns(Columns<float>(problems).get(),
                                   {.length = length, .tightness = Tightness::ulps_of_binary32}, found);
                CHECK(count_different(problems, found, length, false) == 0);
                CHECK(found.stages.ray_count() == problems.size());
                CHECK(found.stages.binary64 > problems.size() / 4);
                CHECK(std::ranges::all_of(problems, [&, i = std::size_t{0}](const Problem&) mutable {
                    const double size = std::fabs(found.hi[i]), bound = found.bound[i++];
                    return std::isnan(size) || bound <= 0x1p-33 * size;
                }));
            }
        }
    }
}

TEST_CASE("truth columns: packs decide nearly all random rays") {
    for (const Shape shape : {Shape::sphere, Shape::box}) {
        const double least = shape == Shape::sphere ? 0.999 : 0.99;
        const auto floats = random_problems(shape, binary32), doubles = random_problems(shape, binary64);
        const double enough = least * static_cast<double>(floats.size());
        TruthColumns found;
        for (const Length length : {Length::parameter, Length::distance}) {
            find_truth_columns(Columns<float>(floats).get(),
                               {.length = length, .tightness = Tightness::ulps_of_binary32}, found);
            CHECK(static_cast<double>(found.stages.binary64) >= enough);
            find_truth_columns(Columns<double>(doubles).get(), {.length = length}, found);
            CHECK(static_cast<double>(found.stages.double_double) >= enough);
        }
    }
}

TEST_CASE("truth columns: every register width gives the same bits") {
    for (const Shape shape : {Shape::sphere, Shape::box}) {
        for (const bool ranged : {false, true}) {
            Seeded rng(15);
            std::vector<Problem> problems = problems_of(shape, binary32, 97);
            for (Problem& problem : problems)
                if (ranged)
                    problem.range = range_about_primitive(rng, problem.ray, problem.primitive, binary32),
                    problem.range.open_ends = {};
            for (const Length length : {Length::parameter, Length::distance}) {
                std::optional<TruthColumns> floats, doubles;
                at_every_width([&](intersect::simd::Isa isa) {
                    if (isa == intersect::simd::Isa::scalar) return;  // which computes rays one by one
                    TruthColumns found;
                    const auto same_as = [&found](std::optional<TruthColumns>& first) {
                        if (!first) first = found;
                        const auto same = [](const std::vector<double>& a, const std::vector<double>& b) {
                            return std::ranges::equal(a, b,
                                                      [](double x, double y) { return x == y || (x != x && y != y); });
                        };
                        CHECK(found.decision == first->decision);
                        CHECK((same(found.hi, first->hi) && same(found.lo, first->lo)));
                        CHECK(same(found.bound, first->bound));
                    };
                    find_truth_columns(Columns<float>(problems).get(),
                                       {.length = length, .tightness = Tightness::ulps_of_binary32}, found);
                    same_as(floats);
                    find_truth_columns(Columns<double>(problems).get(), {.length = length}, found);
                    same_as(doubles);
                });
            }
        }
    }
}

TEST_CASE("truth columns: invalid rays and primitives get no answer") {
    constexpr double inf = HUGE_VAL, none = std::numeric_limits<double>::quiet_NaN();
    const auto says = []<class S>(const Problem& problem, S) {
        TruthColumns found;
        bool any = false;
        at_every_width([&](intersect::simd::Isa) {
            for (const Length length : {Length::parameter, Length::distance}) {
                find_truth_columns(Columns<S>(std::span(&problem, 1)).get(),
                                   {.length = length, .tightness = Tightness::ulps_of_binary32}, found);
                any |= found.single_truths.empty() || found.decision[0] != Truth::Decision::miss;
            }
        });
        return any;
    };
    const auto check_none = [&says](const Problem& problem) {
        CHECK_FALSE(says(problem, float{}));
        CHECK_FALSE(says(problem, double{}));
    };
    const Ray<double> ray{{0, 0.125, 4}, {0, 0.0625, -1}};
    const Problem ball{ray, Sphere<double>{{0, 0, 0}, 1}}, box{ray, Box<double>{{-1, -1, -1}, {1, 1, 1}}};
    const auto with = [](Problem p, std::size_t k, double x) {
        number_of(p, k) = x;
        return p;
    };
    for (const Problem& problem : {ball, box}) {
        CHECK((says(problem, float{}) && says(problem, double{})));
        for (std::size_t k = 0; k < 6 + problem.primitive.shape_numbers().size(); ++k)
            for (const double bad : {none, inf, -inf}) check_none(with(problem, k, bad));
        check_none({{ray.origin, {0, 0, 0}}, problem.primitive});
        for (const double bad : {none, -1.0, inf}) check_none({ray, problem.primitive, {.tmin = bad}});
        for (const double end : {none, -1.0, 0.0}) check_none({ray, problem.primitive, {.tmax = end}});
    }
    for (const double radius : {0.0, -1.0}) check_none(with(ball, 9, radius));
    check_none(with(box, 6, 2));  // lo > hi
}

TEST_CASE("truth columns: any number of rays works at every register width, and one number may serve all rays") {
    const std::vector<Problem> problems = problems_of(Shape::sphere, binary32, 60);
    TruthColumns all, some;
    at_every_width([&](intersect::simd::Isa) {
        find_truth_columns(Columns<float>(problems).get(), {.tightness = Tightness::ulps_of_binary32}, all);
        for (const std::size_t size : {1U, 7U, 8U, 9U, 1023U, 1025U}) {
            const std::span part(problems.data(), size);
            find_truth_columns(Columns<float>(part).get(), {.tightness = Tightness::ulps_of_binary32}, some);
            CHECK(std::equal(some.decision.begin(), some.decision.end(), all.decision.begin()));
            CHECK(std::equal(some.hi.begin(), some.hi.end(), all.hi.begin(),
                             [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }));
        }
    });
    // One sphere for all rays, as one number per column and as many.
    std::vector<Problem> same = problems;
    for (Problem& problem : same) problem.primitive = Sphere<double>{{1, 2, 3}, 4};
    const Columns<double> columns(same);
    auto narrow = columns.get();
    for (auto& column : narrow.primitive) column = column.first(std::min<std::size_t>(column.size(), 1));
    narrow.tmax = {};
    find_truth_columns(columns.get(), {}, all);
    find_truth_columns(narrow, {}, some);
    CHECK(some.decision == all.decision);
    CHECK(some.hi == all.hi);
    CHECK(some.lo == all.lo);
    CHECK(some.bound == all.bound);
}

}  // namespace test_truth_columns
