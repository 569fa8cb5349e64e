// Maps a format named at run time to the number type that computes in it.
#pragma once

#include "number/format.hpp"
#include "number/rounded.hpp"

namespace lostbits {

/// Calls `use.operator()<T>()`, where T is the number type that evaluates a format: float, double, or `RoundedAny`. For
/// `RoundedAny`, the format is set for this thread during the call.
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

/// Returns the double that holds a number of a format exactly.
inline double as_double(float x) { return x; }
inline double as_double(double x) { return x; }
template <class F>
double as_double(BasicRounded<F> x) {
    return x.value();
}

}  // namespace lostbits
