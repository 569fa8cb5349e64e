// Bits needed: per pixel the smallest significand width from which a form is right to B bits, at it and above it.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "measure/shard/share.hpp"
#include "measure/truth/band.hpp"

namespace lostbits::measure::evaluate {

/// The widths that are tried: formats pP with binary64's exponents.
inline constexpr int least_width = 2, most_width = 53;
/// The value of a pixel on which not even `most_width` bits suffice; one whose truth is unresolved has NaN.
inline constexpr double needed_beyond = std::numeric_limits<double>::infinity();

/// Whether t keeps B correct bits: |t − t*| ≤ ½ ulp_B(t*), the ulp of B significand bits with binary64's exponents. t*
/// is the midpoint of its certificate, as in every metric: known to 2^-72 of itself, so a t that close to the boundary
/// may fall on either side of it.
bool keeps_bits(double t, const truth::Certified& truth, int bits);

/// What a form says of a ray.
struct Answer {
    bool hit;
    double t;
    std::int32_t object = -1;  ///< the solid that it hits; −1 where nobody knows
};

/// What a width P must do on one ray: decide as the truth does (by the form's own convention on touching) and, on a
/// hit, meet the right solid, keep B bits and have them, that is correct_bits = P − lost_bits(P) ≥ B. So P ≥ B on a
/// hit: a narrower number that lies near t* by luck carries no B bits.
bool suffices(const truth::Truth& truth, const intersect::Info& form, int width, Answer given, int bits);

/// [w]: pixels that need w bits. Statistics of whole numbers are exact.
struct WidthCounts : std::array<std::uint64_t, most_width + 1> {
    [[nodiscard]] std::uint64_t count() const;
    /// NaN where there is none.
    [[nodiscard]] double mean() const;
    /// The nearest-rank quantile, 0 < q ≤ 1; NaN where there is none.
    [[nodiscard]] double quantile(double q) const;
};

/// Of one form over a picture.
struct NeededSummary {
    WidthCounts hits{}, misses{};                      ///< by what the ray truly does
    std::uint64_t hits_beyond = 0, misses_beyond = 0;  ///< not even `most_width` bits suffice
    std::uint64_t unresolved = 0;

    void add(const truth::Truth& truth, double needed);
    /// What is known of other pixels.
    void append(const NeededSummary& after);
    /// Hits and misses together.
    [[nodiscard]] WidthCounts all() const;
    [[nodiscard]] std::uint64_t pixels() const;
};

/// A form's results over some scanlines.
struct NeededBand {
    int y0, rows, width;
    const truth::Band* band;
    const intersect::Info* form;
    std::vector<double> needed;  ///< `least_width` to `most_width`, `needed_beyond`, or NaN where unresolved

    /// By the form's own convention.
    [[nodiscard]] truth::Truth truth(std::size_t i) const { return band->truth(i, form->convention()); }
};

struct NeededRequest {
    const scene::file::Scene& scene;
    std::vector<const intersect::table::Intersector*> forms;  ///< each with `rounded` kernels
    int bits = 12;                                            ///< B, 1 to 52
    truth::TruthLimit limit{};
    shard::Share share = {};  ///< of the bands, as in `EvaluationRequest`
    /// Called with the number of (pixel, form, width) triples done, `needed_units` in all; may throw to stop.
    std::function<void(std::uint64_t)> progress = [](std::uint64_t) {};
};

std::uint64_t needed_units(const NeededRequest& request);

/// The forms over one band, `needed` in the order of `request.forms`. A pixel's value is the smallest P such that P and
/// every width above it up to 53 suffice. Correctness is not monotone in P (a narrow width may be lucky), so nothing
/// short of looking at all of P…53 proves a value P: widths are scanned from 53 down, and a pixel leaves the scan at
/// the first width that fails. That costs 53 − P + 2 evaluations per pixel, the least that any proof can take.
///
/// As for every format, inputs are rounded to pP too: shared inputs are binary32 numbers, so widths below 24 (own
/// inputs: all widths) see input error on top of the form's own rounding, and the value is that of the whole pipeline
/// at P bits.
std::vector<NeededBand> measure_needed(const NeededRequest& request, const truth::Band& band);

/// The whole picture; `show` gets the bands of each form from top to bottom, different forms at the same time. Neither
/// the number of threads nor the set of forms changes a result.
std::vector<NeededSummary> run_needed(const NeededRequest& request,
                                      const std::function<void(std::size_t form, const NeededBand& band)>& show = {});

}  // namespace lostbits::measure::evaluate
