// The target of a kernel: one primitive or, for forms that march, all primitives together and the constants of the
// march.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "intersect/march.hpp"
#include "shapes/primitive.hpp"

namespace lostbits::intersect {

/// A view: the primitives and constants outlive it.
template <class S>
struct Target {
    /// For a form of one shape: one primitive for every ray of a batch, or one for each ray, all of that shape. Packs
    /// take only one. For a form that marches: all primitives.
    std::span<const Primitive<S>> primitives;
    const MarchConstants<S>* march = nullptr;  ///< never null for the forms of `Shape::sdf`

    Target(const Primitive<S>& one) : primitives(&one, 1) {}
    explicit Target(std::span<const Primitive<S>> one_a_ray) : primitives(one_a_ray) {}
    Target(std::span<const Primitive<S>> all, const MarchConstants<S>& constants)
        : primitives(all), march(&constants) {}
};

/// A target in another arithmetic: `lift` converts each number.
template <class T>
class LiftedTarget {
public:
    template <class S, class Lift>
    LiftedTarget(const Target<S>& from, Lift lift) {
        primitives_.reserve(from.primitives.size());
        for (const Primitive<S>& primitive : from.primitives) primitives_.push_back(transformed(primitive, lift));
        if (from.march) march_.emplace(transformed(*from.march, lift));
    }
    /// Valid while this object lives.
    [[nodiscard]] Target<T> get() const {
        return march_ ? Target<T>(primitives_, *march_) : Target<T>(std::span<const Primitive<T>>(primitives_));
    }

private:
    std::vector<Primitive<T>> primitives_;
    std::optional<MarchConstants<T>> march_;
};

}  // namespace lostbits::intersect
