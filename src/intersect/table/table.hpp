// The run-time table: each form in every arithmetic, as plain functions over batches of rays. Code that uses this
// header need not know whether a form is a form template of lostbits or an external form.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "geometry/range.hpp"
#include "intersect/deciding_arithmetic.hpp"
#include "intersect/info.hpp"
#include "intersect/march_watch.hpp"
#include "intersect/target.hpp"
#include "number/ball.hpp"
#include "number/counted.hpp"
#include "number/format.hpp"
#include "number/interval.hpp"
#include "number/tape.hpp"
#include "shapes/primitive.hpp"

namespace lostbits::intersect::table {

/// n rays, structure of arrays; S is the storage type (float, or double for every other format).
template <class S>
struct RayBatch {
    std::span<const S> ox, oy, oz, dx, dy, dz;
    /// The end of each ray, for shapes whose forms take it (boxes); empty if no ray has an end. Forms do not take the
    /// beginning of a range: the caller keeps only the hits that lie in the range (`limit_batch_to_range`).
    std::span<const S> tmax = {};
    std::span<const S> tmin = {};
    OpenEnds open_ends = {};
    [[nodiscard]] std::size_t size() const { return ox.size(); }
    [[nodiscard]] bool have_ranges() const { return !tmin.empty() || !tmax.empty() || open_ends.tmin; }
    [[nodiscard]] Range<S> range(std::size_t i) const {
        Range<S> result{.open_ends = open_ends};
        if (!tmin.empty()) result.tmin = tmin[i];
        if (!tmax.empty()) result.tmax = tmax[i];
        return result;
    }
};

/// The answers for a batch of rays. Each span has one element per ray; `hit` is 0 or 1.
template <class S>
struct HitBatch {
    std::span<S> t, near, far;
    std::span<std::uint8_t> hit;
    /// A record of each march, for forms that march; empty if no records are needed.
    std::span<MarchRecord> march = {};
};

template <class Signature>
class Function;

/// A plain function, or a function with data (`context`), such as a loaded library, a started process or the forms of a
/// set. The data must outlive every copy. A `Function` may be empty.
template <class R, class... A>
class Function<R(A...)> {
public:
    using Plain = R (*)(A...);
    using Bound = R (*)(void* context, A...);

    constexpr Function(std::nullptr_t = nullptr) {}
    constexpr Function(Plain plain) : plain_(plain) {}
    constexpr Function(Bound bound, void* context) : bound_(bound), context_(context) {}

    R operator()(A... a) const { return plain_ ? plain_(a...) : bound_(context_, a...); }
    explicit constexpr operator bool() const { return plain_ != nullptr || bound_ != nullptr; }
    friend constexpr bool operator==(const Function&, const Function&) = default;

private:
    Plain plain_ = nullptr;
    Bound bound_ = nullptr;
    void* context_ = nullptr;
};

/// The function of a form that computes the answers for a batch.
template <class S>
using Kernel = Function<void(const RayBatch<S>&, const Target<S>&, const HitBatch<S>&)>;

/// A march as it runs in a format, sample by sample, and its answer.
struct MarchLog {
    std::vector<MarchStep> steps;
    Hit<double> hit{false, 0, 0, 0};
    StopReason stop = StopReason::max_steps;
};

/// One form in every arithmetic, or a set with one form for each of several shapes (`sets.hpp`). A function is empty if
/// the form does not have it: a form for one format has no kernel in the others, and an external form has only native
/// kernels.
struct Intersector {
    const Info* info;
    Shape shape;  ///< the shape of its primitives; `sdf` if it takes all primitives at once; the first shape of a set
    Kernel<float> native32;
    Kernel<double> native64;
    /// The kernel for other formats. Inputs are first rounded to the format.
    Function<void(const FloatFormat&, const RayBatch<double>&, const Target<double>&, const HitBatch<double>&)>
        rounded = nullptr;
    Function<Hit<Ball>(const Ray<Ball>&, const Target<Ball>&)> ball = nullptr;
    Function<Hit<Interval>(const Ray<Interval>&, const Target<Interval>&)> interval = nullptr;
    /// Logs every sample of one march; null for the forms that do not march. Inputs are numbers of the format.
    Function<MarchLog(const Format&, const Ray<double>&, const Target<double>&)> log = nullptr;
    /// Records every operation of one evaluation on a tape, which it clears first. Inputs are numbers of the format.
    Function<void(const Format&, const Ray<double>&, const Target<double>&, double tmax, Tape&)> record = nullptr;
    /// Records all operations that the form can ever do: every loop runs to its bound, whatever the decisions are.
    Function<void(const Target<double>&, Tape&)> record_all = nullptr;
    /// Counts the operations of one evaluation in binary32, as the form is written (see `Counted`).
    Function<OperationCounts(const Ray<float>&, const Target<float>&, float tmax)> count = nullptr;
    /// The answer with the form's own bound; empty in formats other than binary32 and binary64. Inputs are numbers of
    /// the format.
    Function<std::optional<BoundedAnswer>(const Format&, const Ray<double>&, const Target<double>&, double tmax)>
        bounded = nullptr;
    /// The widest arithmetic that one evaluation needs; null for the forms that do not filter.
    Function<DecidingArithmetic(const Format&, const Ray<double>&, const Target<double>&, double tmax)>
        deciding_arithmetic = nullptr;
    /// The forms of a set, in the order of their shapes.
    std::span<const Intersector* const> parts = {};
    /// True if the form has a transform method, so that it takes transformed primitives
    /// (`transform/transformed_form.hpp`).
    bool has_transform_method = false;

    [[nodiscard]] bool exists_in(const Format& format) const {
        switch (format.engine) {
            case Format::Engine::native32: return static_cast<bool>(native32);
            case Format::Engine::native64: return static_cast<bool>(native64);
            case Format::Engine::rounded: return rounded != nullptr;
        }
        return false;
    }
    /// True if the formula itself is available in any arithmetic: widths between the formats, enclosures, tapes.
    [[nodiscard]] bool is_template() const { return ball != nullptr; }
    [[nodiscard]] bool is_set() const { return !parts.empty(); }
    /// The form for one of the form's shapes: for a set, its form for that shape.
    [[nodiscard]] const Intersector& form_for(Shape primitive_shape) const {
        for (const Intersector* const part : parts)
            if (part->shape == primitive_shape) return *part;
        return *this;
    }
    /// The shapes of the form's primitives; `sdf` for a form that marches.
    [[nodiscard]] Shapes shapes() const {
        Shapes all = Shapes(shape).with_transform(has_transform_method);
        for (const Intersector* const part : parts) all |= part->shapes();
        return all;
    }
};

/// Every form: the catalogue's forms in their order, then the registered forms in the order in which they were added.
std::span<const Intersector> intersectors();
/// The `form_count` forms of the catalogue; `intersectors(shape)` returns those of one shape.
std::span<const Intersector> catalogue();
std::span<const Intersector> intersectors(Shape shape);
/// Adds forms from outside the catalogue. Their `info` must live as long as the program. Throws InputError for a name
/// that is taken. Call it before other code uses the forms, since forms move in memory.
void register_intersectors(const std::vector<Intersector>& forms);

}  // namespace lostbits::intersect::table
