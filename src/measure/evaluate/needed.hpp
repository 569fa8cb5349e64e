// Computes the bits needed at each pixel: the smallest significand width P such that a form is right to B bits at P and
// at every larger width.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "measure/study/study.hpp"

namespace lostbits::measure::evaluate {

/// Widths that are tested: formats pP with binary64's exponents.
inline constexpr int least_width = 2, most_width = 53;
/// Value of a pixel on which not even `most_width` bits suffice. A pixel whose truth is unresolved has NaN.
inline constexpr double needed_beyond = std::numeric_limits<double>::infinity();

/// True if t keeps B correct bits: |t − t*| ≤ ½ ulp_B(t*), with the ulp of B significand bits and binary64's exponents.
/// t* is the midpoint of its certificate, as in every metric, and is known to 2^-72 of itself. So a t that close to the
/// limit may be on either side of it.
bool keeps_bits(double t, const truth::Certified& truth, int bits);

/// Answer of a form to a ray.
struct Answer {
    bool hit;
    double t;
    std::int32_t object = -1;  ///< the primitive that the form hits; −1 if unknown
};

/// True if a width P suffices on one ray. The form must decide as the truth does (by the form's own convention on
/// touching). On a hit it must also hit the right primitive, keep B bits, and have them: correct_bits = P −
/// lost_bits(P) ≥ B. So P ≥ B on a hit: a narrower number that is near t* by luck does not have B bits.
bool suffices(const truth::Truth& truth, const intersect::Info& form, int width, Answer form_answer, int bits);

/// [w]: number of pixels that need w bits. Statistics of whole numbers are exact.
struct WidthCounts : std::array<std::uint64_t, most_width + 1> {
    [[nodiscard]] std::uint64_t count() const;
    /// NaN if there are no pixels.
    [[nodiscard]] double mean() const;
    /// The nearest-rank quantile, 0 < q ≤ 1; NaN if there are no pixels.
    [[nodiscard]] double quantile(double q) const;
};

/// Summary of one form over a picture.
struct NeededSummary {
    WidthCounts hits{}, misses{};                      ///< by the true decision
    std::uint64_t hits_beyond = 0, misses_beyond = 0;  ///< not even `most_width` bits suffice
    std::uint64_t unresolved = 0;

    void add(const truth::Truth& truth, double needed);
    /// Adds the summary of other pixels.
    void append(const NeededSummary& other);
    /// Hits and misses together.
    [[nodiscard]] WidthCounts all() const;
    [[nodiscard]] std::uint64_t pixels() const;
};

/// Results of a form over some scanlines.
struct NeededBand {
    int y0, rows, width;
    const truth::Band* band;
    const intersect::Info* form;
    std::vector<double> needed;  ///< `least_width` to `most_width`, `needed_beyond`, or NaN where unresolved

    /// Truth by the form's own convention.
    [[nodiscard]] truth::Truth truth(std::size_t i) const { return band->truth(i, form->convention()); }
};

/// The bits needed at each pixel of a scene, as a study (measure/study/study.hpp); a row is a form. A pixel's value is
/// the smallest P such that P and every width above it up to 53 suffice.
///
/// Correctness is not monotone in P: a narrow width may be lucky. So a proof of a value P has to test all of P…53. The
/// scan goes from 53 down, and a pixel leaves it at the first width that fails. That costs 53 − P + 2 evaluations for a
/// pixel, the least that any proof can take.
///
/// As for every format, inputs are rounded to pP too. Shared inputs are binary32 numbers, so widths below 24 (for own
/// inputs, all widths) have input error on top of the form's own rounding. The value is that of the whole pipeline at P
/// bits. Results do not depend on the set of forms.
struct NeededStudy {
    using Band = NeededBand;
    using Summary = NeededSummary;
    static constexpr int pixels_together = study::pixels_of_band;

    const scene::file::Scene& scene;
    std::vector<const intersect::table::Intersector*> rows;  ///< each with `rounded` kernels
    int bits = 12;                                           ///< B, 1 to 52
    truth::ProofLimit limit{};
    shard::Share share = {};
    /// Called with the number of (pixel, form, width) triples done, `units()` in all; may throw to stop.
    std::function<void(std::uint64_t)> progress = [](std::uint64_t) {};

    [[nodiscard]] std::uint64_t units() const;

    static void require() {}
    [[nodiscard]] static NeededSummary begin(std::size_t) { return {}; }
    /// All rows of a band. They are scanned together, since a width's inputs serve every form.
    [[nodiscard]] std::vector<NeededBand> prepare(const truth::Band& band) const;
    static void measure(const std::vector<NeededBand>& bands, std::size_t row_index, NeededSummary& summary,
                        const std::function<void(const NeededBand&)>& show);
};

}  // namespace lostbits::measure::evaluate
