// Some thousand floats of an axis, tried by every form on one ray.
#pragma once

#include <vector>

#include "measure/sweep/exhaustive.hpp"

namespace lostbits::measure::sweep {

/// Consecutive floats of an axis, on one of its rays.
struct FloatsOnRay {
    const ExhaustiveRequest& request;
    std::size_t ray = 0;
    scene::sweep::FloatRange floats;
};

/// In one block, by one form.
inline constexpr std::size_t most_refined = 4096;

/// What the rows of the request do at these floats: a tally a row.
///
/// The worst error is that of the whole truth (`find_truth`) at its float. Floats that may be worse are looked at
/// closely, so that none is worse by more than 2^-20 of it or of an ulp; but where thousands in a row are as bad to
/// within 2^-8 ulp, as where t* hardly depends on the axis, no more than `most_refined`. What the others' errors are at
/// most is in `at_most`. Crossings of a number of lost bits are decided by the whole truth wherever the columns leave
/// them open.
std::vector<FloatTally> try_floats(const FloatsOnRay& of, truth::StageCounts& stages);

/// By how many u tmax must grow so that no hit is missed for slabs that come apart; 0 where none is, missing for a form
/// that asks no box.
double padding_max(const evaluate::TestedForm& row, const FloatTally& tally);

}  // namespace lostbits::measure::sweep
