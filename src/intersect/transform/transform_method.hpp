// The table of transform methods: each method in every arithmetic, as plain functions.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "intersect/table/table.hpp"
#include "intersect/transform/info.hpp"
#include "number/ball.hpp"
#include "number/interval.hpp"
#include "number/real.hpp"
#include "number/rounded.hpp"

namespace lostbits::intersect::transform {

/// Rays in the space of a primitive, structure of arrays.
template <class S>
struct ObjectColumns {
    std::array<std::vector<S>, 6> ray;
    std::vector<S> length;
    S scale;
};

/// The steps of a method as functions in the arithmetic T.
template <class T>
struct StepFunctions {
    MatrixPair<T> (*maps)(const Transform<T>&);
    Vec<T> (*origin)(const MatrixPair<T>&, const Vec<T>&);
    Vec<T> (*direction)(const MatrixPair<T>&, const Vec<T>&);
    ObjectRay<T> (*finish)(const MatrixPair<T>&, const Vec<T>& origin, const Ray<T>& object);
    T (*back)(const MatrixPair<T>&, const Ray<T>& world, const ObjectRay<T>&, const T& t);

    [[nodiscard]] ObjectRay<T> to_object(const MatrixPair<T>& matrices, const Ray<T>& world) const {
        return finish(matrices, world.origin, {origin(matrices, world.origin), direction(matrices, world.direction)});
    }
};

/// The steps of a method as functions over whole batches with one matrix. The results have the same bits as ray by ray.
template <class T, class S>
struct BatchFunctions {
    MatrixPair<T> (*maps)(const Transform<T>&);
    void (*to_object)(const MatrixPair<T>&, const table::RayBatch<S>&, ObjectColumns<S>&);
    /// Converts the answers of the form to the world, in place.
    void (*back)(const MatrixPair<T>&, const table::RayBatch<S>&, const ObjectColumns<S>&, const table::HitBatch<S>&);
};

/// Indices of nodes on a tape: `WorldNodes` are the inputs of a transform method, `ObjectNodes` the inputs of the form
/// that follows it.
struct WorldNodes {
    std::array<NodeId, 6> ray;
    std::array<NodeId, Affine<double>::number_count> matrix;
    bool is_inverse = false;
};
struct ObjectNodes {
    std::array<NodeId, 6> ray;
    NodeId length, scale;
};
/// Records the form after the steps that are on the tape, and returns the form's outputs.
using RecordForm = std::function<TapeOutputs(const ObjectNodes&)>;

struct TransformMethod {
    const TransformMethodInfo* info;
    StepFunctions<float> f32;
    StepFunctions<double> f64;
    StepFunctions<RoundedAny> rounded;
    StepFunctions<Ball> ball;
    StepFunctions<Interval> interval;
    StepFunctions<Real> real;
    BatchFunctions<float, float> batch32;
    BatchFunctions<double, double> batch64;
    BatchFunctions<RoundedAny, double> batch_rounded;
    /// Appends every operation of the method to the tape, in a format, and calls `RecordForm` for those of the form.
    void (*record)(const Format&, Tape&, const WorldNodes&, const RecordForm&);
};

/// The steps of a method in the arithmetic of a format.
template <class T>
const StepFunctions<T>& step_functions(const TransformMethod& method) {
    if constexpr (std::same_as<T, float>) return method.f32;
    else if constexpr (std::same_as<T, double>) return method.f64;
    else return method.rounded;
}

/// All methods, in the order of the list.
std::span<const TransformMethod> transform_methods();
/// The default method.
const TransformMethod& default_transform_method();

}  // namespace lostbits::intersect::transform
