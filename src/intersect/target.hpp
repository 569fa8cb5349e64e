// What a kernel is aimed at: one solid, or, for the forms that march, all of them together with the constants of the
// march.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "intersect/march.hpp"
#include "shapes/solid.hpp"

namespace lostbits::intersect {

/// A view: the solids and constants outlive it.
template <class S>
struct Target {
    /// For the forms of a sphere or a box one, which every ray of a batch is aimed at, or as many as rays, of one
    /// shape: to each its own. Packs take one.
    std::span<const Solid<S>> solids;
    const MarchConstants<S>* march = nullptr;  ///< never null for the forms of `Shape::sdf`

    Target(const Solid<S>& one) : solids(&one, 1) {}
    explicit Target(std::span<const Solid<S>> one_a_ray) : solids(one_a_ray) {}
    Target(std::span<const Solid<S>> all, const MarchConstants<S>& constants) : solids(all), march(&constants) {}
};

/// A target in another arithmetic, which `lift` takes each number to.
template <class T>
class LiftedTarget {
public:
    template <class S, class Lift>
    LiftedTarget(const Target<S>& from, Lift lift) {
        solids_.reserve(from.solids.size());
        for (const Solid<S>& solid : from.solids) solids_.push_back(transformed(solid, lift));
        if (from.march) march_.emplace(transformed(*from.march, lift));
    }
    /// Valid as long as this is.
    [[nodiscard]] Target<T> get() const {
        return march_ ? Target<T>(solids_, *march_) : Target<T>(std::span<const Solid<T>>(solids_));
    }

private:
    std::vector<Solid<T>> solids_;
    std::optional<MarchConstants<T>> march_;
};

}  // namespace lostbits::intersect
