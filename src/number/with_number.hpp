// From a format named at run time to the number that computes in it.
#pragma once

#include "number/format.hpp"
#include "number/rounded.hpp"

namespace lostbits {

/// `use.operator()<T>()`, T the number that evaluates a format: float, double, or `RoundedAny` with the format as the
/// thread's own for as long as the call takes.
template <class Use>
decltype(auto) with_number(const Format& format, const Use& use) {
    switch (format.engine) {
        case Format::Engine::native32: return use.template operator()<float>();
        case Format::Engine::native64: return use.template operator()<double>();
        case Format::Engine::rounded: break;
    }
    const CurrentFormat::Scope scope(format.parameters);
    return use.template operator()<RoundedAny>();
}

/// The number of a format as the double that holds it.
inline double as_double(float x) { return x; }
inline double as_double(double x) { return x; }
template <class F>
double as_double(BasicRounded<F> x) {
    return x.value();
}

}  // namespace lostbits
