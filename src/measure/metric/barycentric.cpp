#include "measure/metric/barycentric.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "measure/metric/hit_point.hpp"
#include "number/tape.hpp"
#include "shapes/lift.hpp"

namespace lostbits::measure::metric {

using truth::missing;

namespace {

/// What the form computed under the name that it has for the weight of a vertex.
std::optional<double> told(const Sample& s, std::size_t vertex) {
    if (!s.blame || s.weights[vertex].empty()) return std::nullopt;
    const auto& nodes = s.blame->tape->nodes;
    const auto found = std::ranges::find(nodes, s.weights[vertex], &TapeNode::label);
    return found == nodes.end() ? std::nullopt : std::optional(found->value);
}

/// How far a number is from the weight of a vertex.
double error_of(double x, const Sample& s, std::size_t vertex) {
    if (!std::isfinite(x)) return HUGE_VAL;
    return visit_shape(*s.solid, [&]<template <class> class Of>() {
        if constexpr (requires(const Of<double>& shape) { shape.weights(Ray<double>()); }) {
            return std::fabs(enclosed([&]<class E>() {
                return in_its_space<Of>(lift_ray<E>(*s.ray), lift_solid<E>(*s.solid),
                                        [&](const Of<E>& shape, const Ray<E>& ray) -> E {
                                            return E(x) - shape.weights(ray)[static_cast<int>(vertex)];
                                        });
            }));
        } else {
            return missing;
        }
    });
}

double in_roundoffs(double x, const Sample& s) { return std::ldexp(x, s.format->shape.precision); }

}  // namespace

double barycentric_error(const Sample& s) {
    double most = missing;
    for (std::size_t vertex = 0; vertex < s.weights.size(); ++vertex)
        if (const auto x = told(s, vertex)) most = std::fmax(most, error_of(*x, s, vertex));
    return in_roundoffs(most, s);
}

double barycentric_sum(const Sample& s) {
    const auto x = told(s, 0), y = told(s, 1), z = told(s, 2);
    if (!x || !y || !z) return missing;
    if (!std::isfinite(*x) || !std::isfinite(*y) || !std::isfinite(*z)) return HUGE_VAL;
    // A Real holds the sum of three doubles near 1, or what is left of it to 2^-200.
    return in_roundoffs(std::fabs(Real(Real(*x) + Real(*y) + Real(*z) - 1).convert_to<double>()), s);
}

}  // namespace lostbits::measure::metric
