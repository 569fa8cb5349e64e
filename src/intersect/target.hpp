// The target of a kernel: one primitive or, for forms that march, all primitives together and the constants of the
// march.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "intersect/march.hpp"
#include "shapes/primitive.hpp"

namespace lostbits::intersect {

/// A view of primitives and constants, which must outlive it.
template <class S>
struct Target {
    /// For a form of one shape: one primitive for every ray of a batch, or one for each ray, all of that shape. Packs
    /// accept only a single primitive. For a form that marches: all primitives.
    std::span<const Primitive<S>> primitives;
    const MarchConstants<S>* march = nullptr;  ///< never null for the forms of `Shape::sdf`

    Target(const Primitive<S>& primitive) : primitives(&primitive, 1) {}
    explicit Target(std::span<const Primitive<S>> primitive_per_ray) : primitives(primitive_per_ray) {}
    Target(std::span<const Primitive<S>> all_primitives, const MarchConstants<S>& constants)
        : primitives(all_primitives), march(&constants) {}
};

/// A target in another arithmetic: each number x becomes T(x).
template <class T>
class LiftedTarget {
public:
    template <class S>
    explicit LiftedTarget(const Target<S>& source) {
        const auto lift = [](S x) { return T(x); };
        primitives_.reserve(source.primitives.size());
        for (const Primitive<S>& primitive : source.primitives) primitives_.push_back(convert_numbers(primitive, lift));
        if (source.march) march_.emplace(convert_numbers(*source.march, lift));
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
