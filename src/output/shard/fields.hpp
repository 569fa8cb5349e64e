// The fields of what shards find. A structured binding names all fields of a struct: one that is added and forgotten
// here does not compile.
#pragma once

#include "measure/claim/claim.hpp"
#include "measure/contract/suspect.hpp"
#include "measure/edges/nearest.hpp"
#include "measure/evaluate/evaluate.hpp"
#include "measure/evaluate/needed.hpp"
#include "measure/judge/judge.hpp"
#include "measure/judge/worst_rays.hpp"
#include "measure/sweep/exhaustive.hpp"
#include "measure/sweep/sweep.hpp"
#include "measure/sweep/worst.hpp"
#include "output/shard/bits.hpp"

namespace lostbits::output::shard {

template <class Bits, class T>
void fields(Bits& bits, Vec<T>& v) {
    bits(v.x, v.y, v.z);
}

template <class Bits, class T>
void fields(Bits& bits, Ray<T>& ray) {
    auto& [origin, direction] = ray;
    bits(origin, direction);
}

template <class Bits, class T>
void fields(Bits& bits, Placement<T>& placed) {
    auto& [matrix, is_inverse, orientation] = placed;
    bits(matrix, is_inverse, orientation);
}

template <class Bits, class T>
void fields(Bits& bits, Solid<T>& solid) {
    auto& [shape, numbers, placed] = solid;
    bits(shape, numbers, placed);
}

template <class Bits>
void fields(Bits& bits, OpenEnds& open) {
    bits(open.tmin, open.tmax);
}

template <class Bits>
void fields(Bits& bits, scene::rays::RayBlock& block) {
    auto& [width, y0, y1, ox, oy, oz, dx, dy, dz, tmin, tmax, open] = block;
    bits(width, y0, y1, ox, oy, oz, dx, dy, dz, tmin, tmax, open);
}

template <class Bits, class T>
void fields(Bits& bits, intersect::MarchConstants<T>& march) {
    auto& [hit_eps, max_dist, relative_eps, cone, over_relaxation, max_steps, secant_steps, bisect_steps] = march;
    bits(hit_eps, max_dist, relative_eps, cone, over_relaxation, max_steps, secant_steps, bisect_steps);
}

template <class Bits>
void fields(Bits& bits, scene::rays::RayGroup& group) {
    // What names one ray has its solids: no mesh, and no scene.
    auto& [rays, solids, march, paired, mesh, scene] = group;
    bits(rays, solids, march, paired);
}

template <class Bits>
void fields(Bits& bits, measure::truth::StageCounts& stages) {
    auto& [binary64, double_double, ball, interval] = stages;
    bits(binary64, double_double, ball, interval);
}

template <class Bits>
void fields(Bits& bits, measure::metric::Distribution& distribution) {
    distribution.fields(bits);
}

template <class Bits>
void fields(Bits& bits, measure::evaluate::WorstRay& w) {
    auto& [x, y, group, object, size, ray, solid, t, outcome, ulps, truth, judged, given] = w;
    bits(x, y, group, object, size, ray, solid, t, outcome, ulps, truth, judged, given);
}

template <class Bits>
void fields(Bits& bits, measure::evaluate::FormSummary& summary) {
    auto& [rays, views, outcomes, true_hits, metrics, categories, worst, faults] = summary;
    bits(rays, views, outcomes, true_hits, metrics, categories, worst, faults);
}

template <class Bits>
void fields(Bits& bits, measure::evaluate::NeededSummary& summary) {
    auto& [hits, misses, hits_beyond, misses_beyond, unresolved] = summary;
    bits(static_cast<std::array<std::uint64_t, measure::evaluate::most_width + 1>&>(hits),
         static_cast<std::array<std::uint64_t, measure::evaluate::most_width + 1>&>(misses), hits_beyond, misses_beyond,
         unresolved);
}

template <class Bits>
void fields(Bits& bits, measure::sweep::SweepStep& step) {
    auto& [values, rows] = step;
    bits(values, rows);
}

template <class Bits>
void fields(Bits& bits, measure::sweep::Onset& o) {
    auto& [row, event, statistic, threshold, from_last, found, from_start, last_good, first_bad, value_at_first_bad,
           recovers, good_at_end, last_good_after, bad_again, rays, views, further] = o;
    bits(row, event, statistic, threshold, from_last, found, from_start, last_good, first_bad, value_at_first_bad,
         recovers, good_at_end, last_good_after, bad_again, rays, views, further);
}

template <class Bits>
void fields(Bits& bits, measure::sweep::SweepFindings& found) {
    auto& [steps, onsets] = found;
    bits(steps, onsets);
}

template <class Bits>
void fields(Bits& bits, measure::sweep::WorstFound& w) {
    auto& [outcome, value, ray, solid, t, truth, distance, evaluations] = w;
    bits(outcome, value, ray, solid, t, truth, distance, evaluations);
}

template <class Bits>
void fields(Bits& bits, measure::edges::NearestRay& ray) {
    auto& [distance, numbers, faces, t, truth] = ray;
    bits(distance, numbers, faces, t, truth);
}

template <class Bits>
void fields(Bits& bits, measure::edges::EdgeFinding& finding) {
    auto& [nearest, rays] = finding;
    bits(nearest, rays);
}

template <class Bits>
void fields(Bits& bits, measure::contract::Judged& j) {
    auto& [ray, solid, truly_hits, unit, true_t, other_measure, hit, t] = j;
    bits(ray, solid, truly_hits, unit, true_t, other_measure, hit, t);
}

template <class Bits>
void fields(Bits& bits, measure::judge::NotedRay& ray) {
    auto& [place, outcome, ulps, given] = ray;
    bits(place, outcome, ulps, given);
}

template <class Bits>
void fields(Bits& bits, measure::judge::WorstRays& worst) {
    worst.fields(bits);
}

template <class Bits>
void fields(Bits& bits, measure::evaluate::Group& group) {
    auto& [value, summaries] = group;
    bits(value, summaries);
}

template <class Bits>
void fields(Bits& bits, measure::evaluate::Groups& groups) {
    groups.fields(bits);
}

template <class Bits>
void fields(Bits& bits, measure::judge::JudgeResult& result) {
    auto& [summaries, rays, rounded, answers, floats, digits, decimals, first, groups] = result;
    bits(summaries, rays, rounded, answers, floats, digits, decimals, first, groups);
}

template <class Bits>
void fields(Bits& bits, measure::metric::Bounds& bounds) {
    auto& [low, high] = bounds;
    bits(low, high);
}

template <class Bits>
void fields(Bits& bits, measure::claim::ClaimResult& result) {
    auto& [state, measured, trouble, witness, samples, floats, evaluations, further, bounds, seconds] = result;
    bits(state, measured, trouble, witness, samples, floats, evaluations, further, bounds, seconds);
}

/// Anything that has fields, as bits.
template <class... T>
std::string bits_of(const T&... values) {
    BitWriter out;
    out(values...);
    return out.take();
}

}  // namespace lostbits::output::shard
