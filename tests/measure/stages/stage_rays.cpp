#include "measure/stages/stage_rays.hpp"

#include <algorithm>
#include <sstream>

#include "measure/stages/stage_loops.hpp"

namespace lostbits::testing {
using measure::stages::RawProblems;

namespace {

const StageNumber& number_of(const StageProblem& p, std::size_t k) { return k < 6 ? p.ray[k] : p.solid[k - 6]; }

Interval exactly(const StageNumber& x) {
    const Interval first(x.first);
    return x.second == 0 ? first : first + Interval(x.second) + Interval(x.rest);
}

/// Columns of every number, and room for the findings: whole registers.
template <class S>
struct StageColumns {
    std::vector<S> first[12], second[12], tmin, tmax;
    OpenEnds open;
    std::vector<std::uint8_t> settled, hit;
    std::vector<double> hi, lo, bound;

    StageColumns(const std::vector<StageProblem>& problems, std::size_t lanes) {
        const std::size_t size = (problems.size() + lanes - 1) / lanes * lanes;
        for (std::size_t k = 0; k < 12; ++k) {
            for (std::size_t i = 0; i < size; ++i) {
                const StageNumber& x = number_of(problems[std::min(i, problems.size() - 1)], k);
                first[k].push_back(static_cast<S>(x.first));
                second[k].push_back(static_cast<S>(x.second));
            }
        }
        for (std::size_t i = 0; i < size; ++i) {
            const Range<double>& range = problems[std::min(i, problems.size() - 1)].range;
            tmin.push_back(static_cast<S>(range.tmin));
            tmax.push_back(static_cast<S>(range.tmax));
        }
        open = problems.front().range.open;
        settled.resize(size);
        hit.resize(size);
        for (auto* column : {&hi, &lo, &bound}) column->resize(size);
    }
    RawProblems<S> raw(bool distance) {
        auto p = measure::stages::raw_problems<S>(hi.size(), {settled.data(), hit.data(), {}, {}});
        (distance ? p.out.distance : p.out.t) = measure::stages::RawLength{hi.data(), lo.data(), bound.data()};
        for (std::size_t k = 0; k < 6; ++k) {
            p.ray[k] = {first[k].data(), 1};
            p.ray_low[k] = {second[k].data(), 1};
            p.solid[k] = {first[6 + k].data(), 1};
            p.solid_low[k] = {second[6 + k].data(), 1};
        }
        p.tmin = {tmin.data(), 1};
        p.tmax = {tmax.data(), 1};
        p.open = open;
        return p;
    }
    [[nodiscard]] std::vector<StageFinding> findings(std::size_t count) const {
        std::vector<StageFinding> found;
        for (std::size_t i = 0; i < count; ++i) found.push_back({settled[i] != 0, hit[i] != 0, hi[i], lo[i], bound[i]});
        return found;
    }
};

template <class S>
std::vector<StageFinding> run(void (*kernel)(const RawProblems<S>&), const std::vector<StageProblem>& problems,
                              std::size_t lanes, bool distance, bool two_words = false) {
    StageColumns<S> columns(problems, lanes);
    auto raw = columns.raw(distance);
    raw.two_words = two_words;
    raw.ranged = !std::ranges::all_of(problems, [](const StageProblem& p) { return p.range.is_whole(); });
    kernel(raw);
    return columns.findings(problems.size());
}

/// Of single numbers the stages of spheres and boxes are compiled here.
measure::stages::Stages stages_of(Shape shape, intersect::simd::Isa isa) {
    using measure::stages::settle_all;
    using Two = number::wide::TwoWords<double>;
    if (isa != intersect::simd::Isa::scalar) return measure::stages::stages_of(shape, isa);
    if (shape == Shape::box) return {{settle_all<Box, float, double>, settle_all<Box, double, Two>, nullptr}, 1};
    return {{settle_all<Sphere, float, double>, settle_all<Sphere, double, Two>, nullptr}, 1};
}

}  // namespace

std::vector<StageFinding> run_stage(StageName stage, bool distance, const std::vector<StageProblem>& problems,
                                    intersect::simd::Isa isa) {
    const auto [kernels, lanes] = stages_of(problems.front().shape, isa);
    switch (stage) {
        case StageName::binary64: return run<float>(kernels.binary64, problems, lanes, distance);
        case StageName::double_double: return run<double>(kernels.double_double, problems, lanes, distance);
        case StageName::of_two_words: break;
    }
    return run<double>(kernels.double_double, problems, lanes, distance, true);
}

std::string contradiction(const StageProblem& problem, const StageFinding& found, bool distance) {
    if (!found.settled) return "";
    for (long bits = 320; bits < 20000; bits *= 2) {
        const Interval::Precision precision(bits);
        const auto at = [&](std::size_t k) { return exactly(number_of(problem, k)); };
        const Ray<Interval> ray{{at(0), at(1), at(2)}, {at(3), at(4), at(5)}};
        Solid<Interval> solid;
        solid.shape = problem.shape;
        for (std::size_t k = 0; k < solid.used().size(); ++k) solid.numbers[k] = at(6 + k);
        if (!problem.range.holds_any()) return found.hit ? "a hit in a range that holds nothing" : "";
        const auto range = measure::truth::range_over<Interval>(problem.range);
        const auto e = measure::truth::enclose<Interval>(ray, solid, range ? &*range : nullptr);
        if (e.hit.is_unknown()) continue;
        if (e.touching || e.on_surface) return "settled what touches, or starts on the surface";
        if (e.hit.is_yes() != found.hit) return found.hit ? "a hit that MPFI misses" : "a miss that MPFI hits";
        if (!found.hit) return "";
        const Interval& t = distance ? e.distance : e.t;
        const Interval middle = Interval(found.hi) + Interval(found.lo), bound(found.bound);
        const Tri within = middle - bound <= t && t <= middle + bound;
        if (within.is_yes()) return "";
        if (within.is_no()) return "the length is not within its bound";
    }
    return "MPFI did not decide";
}

std::string paste(const StageProblem& problem) {
    std::ostringstream out;
    out << std::hexfloat << "{";
    for (std::size_t k = 0; k < 12; ++k) out << number_of(problem, k).first << (k % 3 == 2 ? ",  " : ", ");
    out << "range " << problem.range.tmin << " to " << problem.range.tmax << ", open " << name_of(problem.range.open)
        << "}";
    return out.str();
}

}  // namespace lostbits::testing
