// Many rays at once: the numbers that every map and sweep asks for, in registers of `current_isa()`. What comes out has
// the bits of the scalar functions; the rays that a register cannot answer for are named, and left to them.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "measure/columns/raw_columns.hpp"
#include "measure/truth/band.hpp"

namespace lostbits::measure::columns {

/// The truth of a band by one convention and in one unit. |t*| is hi + lo; hi is NaN where there is no hit, where t* is
/// 0, and where doubles do not hold both parts (see `errors_of`). `inverse` is 1/2^⌊log2 t*⌋.
struct TrueLengths {
    std::vector<truth::Truth::Decision> decision;
    std::vector<std::int32_t> object;
    std::vector<double> hi, lo, inverse;

    void resize(std::size_t rays);
    void put(std::size_t i, const truth::Truth& truth, intersect::Direction unit_of);
};

/// The truth of a band as columns, by each convention and in each unit that is asked for.
class BandColumns {
public:
    explicit BandColumns(const truth::Band& band) : band_(&band) {}
    /// Finds them once; not for several threads at once, unlike `of`.
    const TrueLengths& find(intersect::Convention convention, intersect::Direction unit_of);
    [[nodiscard]] const TrueLengths& of(intersect::Convention convention, intersect::Direction unit_of) const {
        return find_if(convention, unit_of)->lengths;
    }

private:
    struct Found {
        intersect::Convention convention;
        intersect::Direction unit_of;
        TrueLengths lengths;
    };
    [[nodiscard]] const Found* find_if(intersect::Convention convention, intersect::Direction unit_of) const;

    const truth::Band* band_;
    std::deque<Found> found_;
};

/// Where columns of errors go, NaN for what is not measured or left; null where not wanted. `ulp` is always wanted.
struct ErrorColumns {
    double *ulp, *lost, *correct, *relative, *absolute;
};

/// The errors of `answers` (NaN: not measured) in a format. Adds the rays that are left to `left`, and returns the
/// largest |ulp| of the others, at least 0.
double find_errors(std::span<const double> answers, const TrueLengths& truth, const FloatFormat& format,
                   const ErrorColumns& out, std::vector<std::uint32_t>& left);

/// What hit points are computed from: the rays as the form got them, and the solids, of which `objects` names one for
/// each measured answer.
struct HitPoints {
    const scene::rays::RayBlock& rays;
    const scene::rays::SolidList<double>& solids;
    std::span<const std::int32_t> objects;
    Format::Engine engine;
};

/// The residuals of `answers` (NaN: not measured). Adds the rays that are left to `left`: all where the format is
/// neither the machine's float nor its double, or the solids are of several shapes.
void find_residuals(std::span<const double> answers, const HitPoints& points, double* out,
                    std::vector<std::uint32_t>& left);

/// Adds a column to the sums.
void add_sizes(std::span<const double> values, RawSizes& sizes);

/// Takes the hits of one more solid where they come first.
void keep_nearest(const RawHits<float>& hits);
void keep_nearest(const RawHits<double>& hits);

}  // namespace lostbits::measure::columns
