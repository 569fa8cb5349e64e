// Lists the fields of the results that shards store. `LOSTBITS_FIELDS(Type, members…)` defines the function `fields`
// that `BitWriter` and `BitReader` call.
#pragma once

#include "measure/check/claim.hpp"
#include "measure/contract/suspect.hpp"
#include "measure/edges/edge_search.hpp"
#include "measure/evaluate/bits_needed.hpp"
#include "measure/evaluate/evaluate.hpp"
#include "measure/judge/judge.hpp"
#include "measure/judge/worst_rays.hpp"
#include "measure/study/sums.hpp"
#include "measure/sweep/exhaustive.hpp"
#include "measure/sweep/sweep.hpp"
#include "measure/sweep/worst.hpp"
#include "output/shard/bits.hpp"

namespace lostbits::output::shard {

/// For a type with a member function that lists its fields.
template <class Archive, class T>
requires requires(Archive& archive, T& value) { value.fields(archive); }
void fields(Archive& archive, T& value) { value.fields(archive); }

LOSTBITS_FIELDS(Vec<double>, x, y, z)
LOSTBITS_FIELDS(Ray<double>, origin, direction)
LOSTBITS_FIELDS(Transform<double>, matrix, is_inverse, orientation)
LOSTBITS_FIELDS(Primitive<double>, shape, numbers, transform)
LOSTBITS_FIELDS(OpenEnds, tmin, tmax)
LOSTBITS_FIELDS(scene::rays::RayBlock, width, y0, y1, ox, oy, oz, dx, dy, dz, tmin, tmax, open_ends)
LOSTBITS_FIELDS(intersect::MarchConstants<double>, hit_eps, max_dist, relative_eps, cone, over_relaxation, max_steps,
                secant_steps, bisect_steps)

template <class Archive>
void fields(Archive& archive, scene::rays::RayGroup& group) {
    // A group that names one ray holds its primitives itself. It has no mesh and no scene.
    auto& [rays, primitives, march, is_paired, mesh, scene] = group;
    archive(rays, primitives, march, is_paired);
}

LOSTBITS_FIELDS(measure::truth::StageCounts, binary64, double_double, ball, interval)
LOSTBITS_FIELDS(measure::evaluate::WorstRay, x, y, group, primitive_index, size, ray, primitive, t, outcome, ulps,
                truth, touching, given)
LOSTBITS_FIELDS(measure::evaluate::FormSummary, ray_count, view_count, outcomes, true_hit_count, metrics, categories,
                worst, faults)

template <class Archive>
void fields(Archive& archive, measure::evaluate::BitsNeededSummary& summary) {
    auto& [hits, misses, hits_beyond, misses_beyond, unresolved] = summary;
    archive(static_cast<std::array<std::uint64_t, measure::evaluate::max_precision + 1>&>(hits),
            static_cast<std::array<std::uint64_t, measure::evaluate::max_precision + 1>&>(misses), hits_beyond,
            misses_beyond, unresolved);
}

LOSTBITS_FIELDS(measure::sweep::SweepStep, values, summaries)
LOSTBITS_FIELDS(measure::sweep::Onset, form_index, event, statistic, threshold, reads_backwards, found,
                happens_at_start, last_good, first_bad, value_at_first_bad, recovers, is_good_at_end, last_good_after,
                bad_again, ray_count, view_count, further_first_bad)
LOSTBITS_FIELDS(measure::sweep::SweepFindings, steps, onsets)
LOSTBITS_FIELDS(measure::sweep::FloatTally::WorstError, float_index, ulps)
LOSTBITS_FIELDS(measure::sweep::FloatTally::WrongDecision, float_index, outcome)
LOSTBITS_FIELDS(measure::sweep::FloatTally::Padding, float_index, u)
LOSTBITS_FIELDS(measure::sweep::FloatTally, outcomes, worst, error_bound, first_wrong, last_wrong, first_floats,
                padding)
LOSTBITS_FIELDS(measure::sweep::ExhaustiveState, tried_float_count, tallies, stages)
LOSTBITS_FIELDS(measure::sweep::WorstResult, outcome, value, ray, primitive, t, truth, distance, evaluation_count)
LOSTBITS_FIELDS(measure::edges::NearestRay, distance, numbers, faces, t, true_t)
LOSTBITS_FIELDS(measure::edges::EdgeCounts, ray_count, outcome_counts)
LOSTBITS_FIELDS(measure::edges::EdgeResults, census, nearest, searched_ray_counts)
LOSTBITS_FIELDS(measure::contract::AnswerSample, ray, primitive, truly_hits, is_unit, true_t, other_t, hit, t)
LOSTBITS_FIELDS(measure::judge::ReportedRay, ray_index, outcome, ulps, ray_group)
LOSTBITS_FIELDS(measure::evaluate::Group, value, summaries)
LOSTBITS_FIELDS(measure::judge::JudgeResult, summaries, ray_count, rounded_count, nonzero_answer_count,
                float_answer_count, max_digits, inexact_decimal_count, first_samples, groups)
LOSTBITS_FIELDS(measure::metric::Bounds, low, high)
LOSTBITS_FIELDS(measure::check::ClaimResult, state, measured, reason, witness, sample_count, float_count,
                evaluation_count, further_measured, bounds, seconds)

/// Returns the bits of values, as `BitWriter` writes them.
template <class... T>
std::string bits_of(const T&... values) {
    BitWriter out;
    out(values...);
    return out.release();
}

}  // namespace lostbits::output::shard
