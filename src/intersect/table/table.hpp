// The run-time table: a form in every arithmetic as plain functions over batches of rays. Nothing above this header
// knows whether a row was compiled from our templates.
#pragma once

#include <cstdint>
#include <span>

#include "geometry/solid.hpp"
#include "intersect/info.hpp"
#include "intersect/march_watch.hpp"
#include "intersect/target.hpp"
#include "number/ball.hpp"
#include "number/format.hpp"
#include "number/interval.hpp"
#include "number/tape.hpp"

namespace lostbits::intersect::table {

/// n rays, structure of arrays; S is the storage type (float, or double for every other format).
template <class S>
struct RayBatch {
    std::span<const S> ox, oy, oz, dx, dy, dz;
    /// Where each ray ends, for the shapes whose forms are told (boxes); empty: nowhere.
    std::span<const S> tmax = {};
    [[nodiscard]] std::size_t size() const { return ox.size(); }
};

/// Where the answers go: as many of each as rays. `hit` is 0 or 1.
template <class S>
struct HitBatch {
    std::span<S> t, near, far;
    std::span<std::uint8_t> hit;
    /// How each march went, for the forms that march; empty: not asked for.
    std::span<MarchRecord> march = {};
};

/// A march as the format runs it, sample by sample, and its answer.
struct MarchLog {
    std::vector<MarchStep> steps;
    Hit<double> hit{false, 0, 0, 0};
    Stop stop = Stop::max_steps;
};

/// One form in every arithmetic. A null pointer means that the form does not exist there (see `Info::formats`).
struct Intersector {
    const Info* info;
    Shape shape;  ///< of the solids that it may be given one of; `sdf`: all of any shape at once
    void (*native32)(const RayBatch<float>&, const Target<float>&, const HitBatch<float>&);
    void (*native64)(const RayBatch<double>&, const Target<double>&, const HitBatch<double>&);
    /// Inputs are rounded to the format on the way in.
    void (*rounded)(const FloatFormat&, const RayBatch<double>&, const Target<double>&,
                    const HitBatch<double>&) = nullptr;
    Hit<Ball> (*ball)(const Ray<Ball>&, const Target<Ball>&) = nullptr;
    Hit<Interval> (*interval)(const Ray<Interval>&, const Target<Interval>&) = nullptr;
    /// Every sample of one march; null for the forms that do not march. Inputs are numbers of the format.
    MarchLog (*log)(const Format&, const Ray<double>&, const Target<double>&) = nullptr;
    /// Every operation of one evaluation, onto a tape that it clears first. Inputs are numbers of the format.
    void (*record)(const Format&, const Ray<double>&, const Target<double>&, double tmax, Tape&) = nullptr;
    /// The same with every loop run to its bound whatever its decisions: all operations that the form can ever do.
    void (*record_all)(const Target<double>&, Tape&) = nullptr;

    [[nodiscard]] bool exists_in(const Format& format) const {
        return info->formats == Formats::all || format.shape == binary32;
    }
};

/// Every form of every shape, in the catalogue's order.
std::span<const Intersector> intersectors();
/// Those of one shape.
std::span<const Intersector> intersectors(Shape shape);
inline std::span<const Intersector> sphere_intersectors() { return intersectors(Shape::sphere); }

}  // namespace lostbits::intersect::table
