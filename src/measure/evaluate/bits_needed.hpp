// Computes the bits needed at each pixel: the smallest precision P, in significand bits, such that a form is right to B
// bits at P and at every larger precision.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "measure/study/study.hpp"

namespace lostbits::measure::evaluate {

/// Smallest and largest precision P that are tested, in significand bits: formats pP with binary64's exponents.
inline constexpr int min_precision = 2, max_precision = 53;
/// Value of a pixel on which not even `max_precision` bits suffice. A pixel whose truth is unresolved has NaN.
inline constexpr double beyond_max_precision = std::numeric_limits<double>::infinity();

/// True if t has B correct bits: |t − t*| ≤ ½ ulp_B(t*), with the ulp of B significand bits and binary64's exponents.
/// t* is the midpoint of its certificate, as in every metric, and is known to 2^-72 of itself. So a t that close to the
/// limit may be on either side of it.
bool has_correct_bits(double t, const truth::CertifiedNumber& true_t, int correct_bits);

/// Answer of a form to a ray.
struct Answer {
    bool hit;
    double t;
    std::int32_t primitive_index = -1;  ///< the primitive that the form hits; −1 if unknown
};

/// True if precision P suffices on one ray. The form must decide as the truth does (by the form's own convention on
/// touching). On a hit it must also hit the right primitive, t must have B correct bits, and P − lost_bits(P) ≥ B.
/// So P ≥ B on a hit: a narrower number that is near t* by luck does not have B bits.
bool is_precision_enough(const truth::Truth& ray_truth, const intersect::Info& info, int precision, Answer form_answer,
                         int correct_bits);

/// Element P is the number of pixels that need P bits. Statistics of whole numbers are exact.
struct PrecisionCounts : std::array<std::uint64_t, max_precision + 1> {
    [[nodiscard]] std::uint64_t count() const;
    /// NaN if there are no pixels.
    [[nodiscard]] double mean() const;
    /// The nearest-rank quantile, 0 < q ≤ 1; NaN if there are no pixels.
    [[nodiscard]] double quantile(double q) const;
};

/// Summary of one form over a picture.
struct BitsNeededSummary {
    PrecisionCounts hits{}, misses{};                  ///< by the true decision
    std::uint64_t hits_beyond = 0, misses_beyond = 0;  ///< not even `max_precision` bits suffice
    std::uint64_t unresolved = 0;

    void add(const truth::Truth& ray_truth, double bits_needed);
    /// Adds the summary of other pixels.
    void append(const BitsNeededSummary& other);
    /// Hits and misses together.
    [[nodiscard]] PrecisionCounts all() const;
    [[nodiscard]] std::uint64_t pixel_count() const;
};

/// Results of a form over some scanlines.
struct BitsNeededBand {
    int y0, scanlines, width;
    const truth::Band* band;
    const intersect::Info* form;
    /// `min_precision` to `max_precision`, `beyond_max_precision`, or NaN if unresolved.
    std::vector<double> bits_needed;

    /// Truth by the form's own convention.
    [[nodiscard]] truth::Truth truth(std::size_t i) const { return band->truth(i, form->convention()); }
};

/// The bits needed at each pixel of a scene, as a study (measure/study/study.hpp); a row is a form. A pixel's value is
/// the smallest P such that P and every precision above it up to 53 suffice.
///
/// Correctness is not monotone in P: a form may be right at a low precision by luck. So a proof of a value P has to
/// test all of P…53. The scan goes from 53 down, and a pixel leaves it at the first precision that fails. That costs 53
/// − P + 2 evaluations for a pixel, the least that any proof can take.
///
/// As for every format, inputs are rounded to pP too. Shared inputs are binary32 numbers, so precisions below 24 (for
/// own inputs, all precisions) have input error on top of the form's own rounding. The value is that of the whole
/// pipeline at P bits. Results do not depend on the set of forms.
struct BitsNeededStudy {
    using Band = BitsNeededBand;
    using Summary = BitsNeededSummary;
    static constexpr int pixels_per_band = study::default_pixels_per_band;

    const scene::file::Scene& scene;
    std::vector<const intersect::table::Intersector*> tested_forms;  ///< each with `rounded` kernels
    int correct_bits = 12;                                           ///< B, 1 to 52
    truth::ProofLimit limit{};
    shard::Share share = {};
    /// Called with the number of (pixel, form, precision) triples done, `units()` in all; may throw to stop.
    std::function<void(std::uint64_t)> progress = [](std::uint64_t) {};

    [[nodiscard]] std::uint64_t units() const;

    static void require() {}
    [[nodiscard]] static BitsNeededSummary begin(std::size_t) { return {}; }
    /// All forms on a band. They are scanned together, since the inputs of a precision serve every form.
    [[nodiscard]] std::vector<BitsNeededBand> prepare(const truth::Band& band) const;
    static void measure(const std::vector<BitsNeededBand>& bands, std::size_t form_index, BitsNeededSummary& summary,
                        const std::function<void(const BitsNeededBand&)>& show);
};

}  // namespace lostbits::measure::evaluate
