// Truths of many rays at once are those of the same rays alone: the same decisions, and the same two words.
#include <algorithm>

#include "catch.hpp"
#include "intersect/simd/packed.hpp"
#include "measure/truth/hard_rays.hpp"
#include "measure/truth/ranges.hpp"
#include "measure/truth/truth_columns.hpp"

namespace test_truth_columns {

using namespace lostbits;
using namespace lostbits::testing;
using measure::truth::find_truth;
using measure::truth::Length;
using measure::truth::ProblemColumns;
using measure::truth::StageCounts;
using measure::truth::Tightness;
using measure::truth::Truth;
using measure::truth::TruthColumns;

namespace {

using Problem = HardRay;

std::vector<Problem> problems_of(Shape shape, const FloatFormat& storage, std::size_t each) {
    Seeded rng(14);
    std::vector<Problem> problems;
    for (const HardFamily& f : hard_families(shape, {storage}, Wide::yes))
        for (std::size_t i = 0; i < each; ++i) problems.push_back(f.draw(rng));
    return problems;
}

template <class S>
class Columns {
public:
    explicit Columns(std::span<const Problem> problems) : size_(problems.size()) {
        for (const Problem& p : problems) {
            for (int k = 0; k < 3; ++k) {
                numbers_[static_cast<std::size_t>(k)].push_back(static_cast<S>(p.ray.origin[k]));
                numbers_[static_cast<std::size_t>(k) + 3].push_back(static_cast<S>(p.ray.direction[k]));
            }
            for (std::size_t k = 0; k < 6; ++k) numbers_[6 + k].push_back(static_cast<S>(p.solid.numbers[k]));
            numbers_[12].push_back(static_cast<S>(p.range.tmax));
            numbers_[13].push_back(static_cast<S>(p.range.tmin));
        }
        open_ = problems.front().range.open;
        shape_ = problems.front().solid.shape;
    }
    [[nodiscard]] ProblemColumns<S> get() const {
        ProblemColumns<S> p{.size = size_,
                            .ray = {},
                            .shape = shape_,
                            .solid = {},
                            .tmin = numbers_[13],
                            .tmax = numbers_[12],
                            .open = open_};
        for (std::size_t k = 0; k < 6; ++k) {
            p.ray[k] = numbers_[k];
            p.solid[k] = numbers_[6 + k];
        }
        return p;
    }

private:
    std::size_t size_;
    Shape shape_;
    std::vector<S> numbers_[14];
    OpenEnds open_;
};

const measure::truth::Certified& length_of(const Truth& truth, Length length) {
    return length == Length::parameter ? truth.t : truth.distance;
}

/// How many rays do not have, in the columns, what they have alone.
std::size_t count_different(std::span<const Problem> problems, const TruthColumns& found, Length length, bool tight) {
    std::size_t different = 0;
    for (std::size_t i = 0; i < problems.size(); ++i) {
        const Problem& p = problems[i];
        const Truth alone = find_truth(p.ray, p.solid, {}, {}, p.range);
        if (found.decision[i] != alone.decision) {
            ++different;
            continue;
        }
        if (!alone.is_hit() || std::isnan(found.hi[i])) continue;
        const auto& t = length_of(alone, length);
        const double hi = std::ldexp(t.hi, static_cast<int>(t.exponent)),
                     lo = std::ldexp(t.lo, static_cast<int>(t.exponent));
        // Where one ray alone needed wider intervals its words are theirs.
        if (tight && alone.bits == 106) different += found.hi[i] != hi || found.lo[i] != lo;
        else
            different +=
                !(std::fabs((found.hi[i] - hi) + (found.lo[i] - lo)) <= found.bound[i] + std::fabs(hi) * 0x1p-70);
    }
    return different;
}

}  // namespace

TEST_CASE("truth columns: the same as ray by ray, however tight") {
    for (const Shape shape : {Shape::sphere, Shape::box}) {
        for (const FloatFormat& storage : {binary32, binary64}) {
            const std::vector<Problem> problems = problems_of(shape, storage, 500);
            TruthColumns found;
            for (const Length length : {Length::parameter, Length::distance}) {
                find_truth_columns(Columns<double>(problems).get(), {.length = length}, found);
                CHECK(found.size() == problems.size());
                CHECK(count_different(problems, found, length, true) == 0);
                CHECK(found.stages.rays() == problems.size());
                CHECK(found.stages.double_double > problems.size() / 4);
                if (storage == binary64) continue;
                find_truth_columns(Columns<float>(problems).get(), {.length = length}, found);
                CHECK(count_different(problems, found, length, true) == 0);
                find_truth_columns(Columns<float>(problems).get(),
                                   {.length = length, .tightness = Tightness::ulps_of_binary32}, found);
                CHECK(count_different(problems, found, length, false) == 0);
                CHECK(found.stages.rays() == problems.size());
                CHECK(found.stages.binary64 > problems.size() / 4);
                CHECK(std::ranges::all_of(problems, [&, i = std::size_t{0}](const Problem&) mutable {
                    const double size = std::fabs(found.hi[i]), bound = found.bound[i++];
                    return std::isnan(size) || bound <= 0x1p-33 * size;
                }));
            }
        }
    }
}

TEST_CASE("truth columns: rays with ranges, the same as ray by ray") {
    for (const Shape shape : {Shape::sphere, Shape::box}) {
        for (const auto& [name, open] : open_ends_names) {
            for (const FloatFormat& storage : {binary32, binary64}) {
                Seeded rng(15);
                std::vector<Problem> problems = problems_of(shape, storage, 60);
                for (Problem& p : problems)
                    p.range = range_about_solid(rng, p.ray, p.solid, storage), p.range.open = open;
                TruthColumns found;
                find_truth_columns(Columns<double>(problems).get(), {}, found);
                CHECK(count_different(problems, found, Length::parameter, true) == 0);
                CHECK(found.stages.double_double > problems.size() / 4);
                if (storage == binary64) continue;
                find_truth_columns(Columns<float>(problems).get(), {.tightness = Tightness::ulps_of_binary32}, found);
                CHECK(count_different(problems, found, Length::parameter, false) == 0);
                CHECK(found.stages.binary64 > problems.size() / 4);
            }
        }
    }
}

TEST_CASE("truth columns: any number of rays at every width, and one number for all") {
    const std::vector<Problem> problems = problems_of(Shape::sphere, binary32, 60);
    TruthColumns all, some;
    const auto before = intersect::simd::current_isa();
    for (const auto isa : intersect::simd::available_isas()) {
        intersect::simd::set_isa(isa);
        find_truth_columns(Columns<float>(problems).get(), {.tightness = Tightness::ulps_of_binary32}, all);
        for (const std::size_t size :
             {std::size_t{1}, std::size_t{7}, std::size_t{8}, std::size_t{9}, std::size_t{1023}, std::size_t{1025}}) {
            const std::span part(problems.data(), size);
            find_truth_columns(Columns<float>(part).get(), {.tightness = Tightness::ulps_of_binary32}, some);
            CHECK(std::equal(some.decision.begin(), some.decision.end(), all.decision.begin()));
            CHECK(std::equal(some.hi.begin(), some.hi.end(), all.hi.begin(),
                             [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }));
        }
    }
    intersect::simd::set_isa(before);
    // One sphere for all rays, as one number a column and as many.
    std::vector<Problem> same = problems;
    for (Problem& p : same) p.solid = Sphere<double>{{1, 2, 3}, 4};
    const Columns<double> columns(same);
    auto narrow = columns.get();
    for (auto& column : narrow.solid) column = column.first(std::min<std::size_t>(column.size(), 1));
    narrow.tmax = {};
    find_truth_columns(columns.get(), {}, all);
    find_truth_columns(narrow, {}, some);
    CHECK(some.decision == all.decision);
    CHECK(some.hi == all.hi);
    CHECK(some.lo == all.lo);
    CHECK(some.bound == all.bound);
}

TEST_CASE("truths of rays among spheres and boxes are those of each ray alone") {
    std::vector<Problem> problems = problems_of(Shape::sphere, binary32, 40);
    for (const Problem& p : problems_of(Shape::box, binary32, 40)) problems.push_back(p);
    std::vector<Solid<double>> solids;
    for (std::size_t i = 0; i < problems.size(); i += 97) solids.push_back(problems[i].solid);
    // Several that no ray can tell apart, and one that does not exist.
    solids.push_back(solids[2]);
    solids.insert(solids.begin() + 1, Solid<double>(Sphere<double>{{0, 0, 0}, -1}));
    scene::rays::RayBlock rays;
    for (const Problem& p : problems) {
        rays.push(p.ray);
        rays.tmin.push_back(p.range.tmin);
        rays.tmax.push_back(p.range.tmax);
    }
    measure::truth::RayTruths found;
    const scene::rays::SolidList<double> list(solids);
    const StageCounts counts = find_truths(measure::truth::RaysAndSolids<double>{rays, list}, {}, found);
    CHECK(counts.rays() == problems.size() * solids.size());
    std::size_t different = 0, hits = 0;
    for (std::size_t i = 0; i < problems.size(); ++i) {
        const Truth alone =
            find_truth(problems[i].ray, std::span<const Solid<double>>(solids), {}, {}, problems[i].range);
        hits += alone.is_hit();
        const Truth there = found[i];
        different += there.decision != alone.decision || there.object != alone.object ||
                     there.touches != alone.touches || there.on_surface != alone.on_surface ||
                     compare(there.t, alone.t) != 0 || compare(there.distance, alone.distance) != 0;
        if (alone.bits > 106) continue;
        different += there.t.hi != alone.t.hi || there.t.lo != alone.t.lo || there.t.exponent != alone.t.exponent ||
                     there.distance.hi != alone.distance.hi || there.distance.lo != alone.distance.lo;
    }
    CHECK(different == 0);
    CHECK(hits > problems.size() / 8);
}

}  // namespace test_truth_columns
