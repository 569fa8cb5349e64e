// Computes the numbers that every map and sweep needs for many rays at once, in registers of `current_isa()`. The
// results have the same bits as those of the scalar functions. Rays that a register cannot handle are listed for the
// scalar functions.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "measure/columns/raw_columns.hpp"
#include "measure/truth/band.hpp"

namespace lostbits::measure::columns {

/// Truth of a band by one convention, with t in the unit of one kind of direction. |t*| is hi + lo. hi is NaN if there
/// is no hit, if t* is 0, or if doubles cannot hold both parts (see `compute_errors`). `inverse_binade` is 1/2^⌊log2
/// t*⌋.
struct TrueLengths {
    std::vector<truth::Truth::Decision> decision;
    std::vector<std::int32_t> primitive;
    std::vector<double> hi, lo, inverse_binade;

    void resize(std::size_t ray_count);
    void set(std::size_t i, const truth::Truth& ray_truth, intersect::Direction direction_kind);
};

/// Truth of a band as columns, for each convention and kind of direction in use.
class BandTruthColumns {
public:
    explicit BandTruthColumns(const truth::Band& band) : band_(&band) {}
    /// Computes the columns once. Unlike `lengths`, it must not be called by several threads at once.
    const TrueLengths& compute_lengths(intersect::Convention convention, intersect::Direction direction_kind);
    [[nodiscard]] const TrueLengths& lengths(intersect::Convention convention,
                                             intersect::Direction direction_kind) const {
        return cached_lengths(convention, direction_kind)->lengths;
    }

private:
    struct CachedLengths {
        intersect::Convention convention;
        intersect::Direction direction_kind;
        TrueLengths lengths;
    };
    [[nodiscard]] const CachedLengths* cached_lengths(intersect::Convention convention,
                                                      intersect::Direction direction_kind) const;

    const truth::Band* band_;
    std::deque<CachedLengths> cached_;
};

/// Outputs for errors, with NaN for rays that are not measured or that are left to the scalar functions. Null for
/// columns that are not requested; `ulp` is required.
struct ErrorColumns {
    double *ulp, *lost, *correct, *relative, *absolute;
};

/// Computes the errors of `answers` (NaN: not measured) in a format. Adds the rays that are left to `unhandled`, and
/// returns the largest |ulp| of the others, at least 0.
double compute_error_columns(std::span<const double> answers, const TrueLengths& true_lengths,
                             const FloatFormat& format, const ErrorColumns& out, std::vector<std::uint32_t>& unhandled);

/// Inputs of hit points: the rays as the form received them, and the primitives. `primitive_indices` names the
/// primitive of each measured answer.
struct HitPoints {
    const scene::rays::RayBlock& rays;
    const scene::rays::PrimitiveList<double>& primitives;
    std::span<const std::int32_t> primitive_indices;
    Format::Engine engine;
};

/// Computes the residuals of `answers` (NaN: not measured). Adds the rays that are left to `unhandled`; these are all
/// rays if the format is neither the machine's float nor its double, or if the primitives have several shapes.
void compute_residual_columns(std::span<const double> answers, const HitPoints& points, double* out,
                              std::vector<std::uint32_t>& unhandled);

/// Adds a column to the sums.
void add_absolute_values(std::span<const double> values, RawAbsoluteSums& sums);

/// Keeps, of the hits so far and the hits with one more primitive, the first one on each ray.
void keep_nearest(const RawHits<float>& hits);
void keep_nearest(const RawHits<double>& hits);

}  // namespace lostbits::measure::columns
