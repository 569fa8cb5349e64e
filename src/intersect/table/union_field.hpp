// The field of several primitives together, which forms that march take.
#pragma once

#include <span>

#include "shapes/solid.hpp"

namespace lostbits::intersect::table {

template <Number T>
T distance(const Solid<T>& solid, const Vec<T>& p) {
    return visit(solid, [&p](const auto& shape) { return shape.distance(p); });
}

/// The union of primitives: the least of their distances, computed in their order.
template <Number T>
class Union {
public:
    explicit Union(std::span<const Solid<T>> solids) : solids_(solids) {}
    T operator()(const Vec<T>& p) const {
        T least = distance(solids_.front(), p);
        for (const Solid<T>& solid : solids_.subspan(1)) least = min(least, distance(solid, p));
        return least;
    }

private:
    std::span<const Solid<T>> solids_;
};

}  // namespace lostbits::intersect::table
