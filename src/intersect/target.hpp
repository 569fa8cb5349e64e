// The target of a kernel: one primitive or, for forms that march, all primitives together and the constants of the
// march.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "intersect/march.hpp"
#include "shapes/solid.hpp"

namespace lostbits::intersect {

/// A view: the primitives and constants outlive it.
template <class S>
struct Target {
    /// For a form of one shape: one primitive for every ray of a batch, or one for each ray, all of that shape. Packs
    /// take only one. For a form that marches: all primitives.
    std::span<const Solid<S>> solids;
    const MarchConstants<S>* march = nullptr;  ///< never null for the forms of `Shape::sdf`

    Target(const Solid<S>& one) : solids(&one, 1) {}
    explicit Target(std::span<const Solid<S>> one_a_ray) : solids(one_a_ray) {}
    Target(std::span<const Solid<S>> all, const MarchConstants<S>& constants) : solids(all), march(&constants) {}
};

/// A target in another arithmetic: `lift` converts each number.
template <class T>
class LiftedTarget {
public:
    template <class S, class Lift>
    LiftedTarget(const Target<S>& from, Lift lift) {
        solids_.reserve(from.solids.size());
        for (const Solid<S>& solid : from.solids) solids_.push_back(transformed(solid, lift));
        if (from.march) march_.emplace(transformed(*from.march, lift));
    }
    /// Valid while this object lives.
    [[nodiscard]] Target<T> get() const {
        return march_ ? Target<T>(solids_, *march_) : Target<T>(std::span<const Solid<T>>(solids_));
    }

private:
    std::vector<Solid<T>> solids_;
    std::optional<MarchConstants<T>> march_;
};

}  // namespace lostbits::intersect
