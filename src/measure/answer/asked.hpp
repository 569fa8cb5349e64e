// One ray put to one row of the table, or to the steps of a way into the space of a solid, in a format.
#pragma once

#include <optional>

#include "intersect/space/space.hpp"
#include "number/with_number.hpp"

namespace lostbits::measure::answer {

/// The steps over the number that evaluates a format.
template <class T>
const intersect::space::StepsIn<T>& steps_in(const intersect::space::Space& space) {
    if constexpr (std::same_as<T, float>) return space.f32;
    else if constexpr (std::same_as<T, double>) return space.f64;
    else return space.rounded;
}

/// The t that a row answers; nothing where it misses. Inputs are numbers of the format.
std::optional<double> ask_one(const intersect::table::Intersector& row, const Format& format, const Ray<double>& ray,
                              const Solid<double>& solid, double tmax);

}  // namespace lostbits::measure::answer
