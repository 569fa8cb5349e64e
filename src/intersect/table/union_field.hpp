// The distance field of several primitives together, which forms that march take.
#pragma once

#include <span>

#include "shapes/primitive.hpp"

namespace lostbits::intersect::table {

template <Number T>
T distance(const Primitive<T>& primitive, const Vec<T>& p) {
    return visit(primitive, [&p](const auto& shape) { return shape.distance(p); });
}

/// The union of primitives: the least of their distances, computed in the order of the primitives.
template <Number T>
class UnionField {
public:
    explicit UnionField(std::span<const Primitive<T>> primitives) : primitives_(primitives) {}
    T operator()(const Vec<T>& p) const {
        T least = distance(primitives_.front(), p);
        for (const Primitive<T>& primitive : primitives_.subspan(1)) least = min(least, distance(primitive, p));
        return least;
    }

private:
    std::span<const Primitive<T>> primitives_;
};

}  // namespace lostbits::intersect::table
