// Rounded<P>: a significand of P bits with its own exponent range, correctly rounded, to find how many bits are enough.
#pragma once

#include <bit>

#include "number/concept.hpp"
#include "number/format.hpp"

namespace lostbits {

namespace rounding {

/// Rounds the exact value r + δ to `f`, ties to even, where r = RN53(r + δ) and `residual` is the sign of δ.
/// Correct for every p ≤ 52, and for p = 53 where r is normal in f: |δ| is at most half of r's last place, so δ
/// matters only where r itself lies exactly half way between two neighbours of f.
double to_format(double r, int residual, const FloatFormat& f);

/// The same operations through MPFR, with no assumption about range: a simple reference for the fast paths, which fall
/// back on it if a residual would underflow.
double add_reference(double a, double b, const FloatFormat& f);
double mul_reference(double a, double b, const FloatFormat& f);
double div_reference(double a, double b, const FloatFormat& f);
double sqrt_reference(double a, const FloatFormat& f);
double fma_reference(double a, double b, double c, const FloatFormat& f);

double add(double a, double b, const FloatFormat& f);
inline double sub(double a, double b, const FloatFormat& f) { return add(a, -b, f); }
double mul(double a, double b, const FloatFormat& f);
double div(double a, double b, const FloatFormat& f);
double sqrt(double a, const FloatFormat& f);
double fma(double a, double b, double c, const FloatFormat& f);
double next_up(double a, const FloatFormat& f);

}  // namespace rounding

/// The format that `RoundedAny` computes in on this thread: that of the innermost scope.
class CurrentFormat {
public:
    /// The format of the innermost scope; Error(Exit::internal) outside of every scope.
    static const FloatFormat& get() {
        if (!current_) [[unlikely]]
            refuse();
        return *current_;
    }

    /// Arithmetic that computes in the format: the machine's own if it has the format.
    enum class Engine : std::uint8_t { machine_float, machine_double, rounding };
    static Engine engine() { return engine_; }

    /// Sets the thread's format for the lifetime of the scope.
    class Scope {
    public:
        explicit Scope(const FloatFormat& f) : format_(f), before_(current_), engine_before_(engine_) {
            current_ = &format_;
            engine_ = f == binary32 ? Engine::machine_float : f == binary64 ? Engine::machine_double : Engine::rounding;
        }
        ~Scope() { current_ = before_, engine_ = engine_before_; }
        Scope(const Scope&) = delete;
        Scope& operator=(const Scope&) = delete;

    private:
        FloatFormat format_;
        const FloatFormat* before_;
        Engine engine_before_;
    };

private:
    [[noreturn]] static void refuse();
    // constinit: other files read it without first checking that it is initialised.
    static constinit thread_local const FloatFormat* current_;
    static constinit thread_local Engine engine_;
};

template <int P, int Emin, int Emax>
struct FixedFormat {
    static_assert(2 <= P && P <= 53 && -1022 <= Emin && Emin <= Emax && Emax <= 1023);
    static constexpr FloatFormat get() { return {P, Emin, Emax}; }
};

/// A number of the format `F::get()`, held in a double (every such number is one), each operation correctly
/// rounded to nearest even, with subnormals, signed zeros, infinities and NaN of that format.
template <class F>
class BasicRounded {
public:
    BasicRounded() = default;
    explicit BasicRounded(int x) : value_(rounding::to_format(x, 0, F::get())) {}
    explicit BasicRounded(double x) : value_(rounding::to_format(x, 0, F::get())) {}

    /// A double that is a number of the format.
    static BasicRounded holding(double value) { return made(value); }

    [[nodiscard]] double value() const { return value_; }
    static FloatFormat format() { return F::get(); }

    friend BasicRounded operator+(BasicRounded a, BasicRounded b) {
        return computed([](auto x, auto y) { return x + y; }, rounding::add, a, b);
    }
    friend BasicRounded operator-(BasicRounded a, BasicRounded b) {
        return computed([](auto x, auto y) { return x - y; }, rounding::sub, a, b);
    }
    friend BasicRounded operator*(BasicRounded a, BasicRounded b) {
        return computed([](auto x, auto y) { return x * y; }, rounding::mul, a, b);
    }
    friend BasicRounded operator/(BasicRounded a, BasicRounded b) {
        return computed([](auto x, auto y) { return x / y; }, rounding::div, a, b);
    }
    friend BasicRounded operator-(BasicRounded a) { return made(-a.value_); }
    // glm::vec's element-wise operators are written through these.
    BasicRounded& operator+=(BasicRounded b) { return *this = *this + b; }
    BasicRounded& operator-=(BasicRounded b) { return *this = *this - b; }
    BasicRounded& operator*=(BasicRounded b) { return *this = *this * b; }

    friend bool operator<(BasicRounded a, BasicRounded b) { return a.value_ < b.value_; }
    friend bool operator<=(BasicRounded a, BasicRounded b) { return a.value_ <= b.value_; }
    friend bool operator>(BasicRounded a, BasicRounded b) { return a.value_ > b.value_; }
    friend bool operator>=(BasicRounded a, BasicRounded b) { return a.value_ >= b.value_; }
    friend bool operator==(BasicRounded a, BasicRounded b) { return a.value_ == b.value_; }

    friend BasicRounded sqrt(BasicRounded a) {
        return computed([](auto x) { return std::sqrt(x); }, rounding::sqrt, a);
    }
    friend BasicRounded fma(BasicRounded a, BasicRounded b, BasicRounded c) {
        return computed([](auto x, auto y, auto z) { return std::fma(x, y, z); }, rounding::fma, a, b, c);
    }
    friend BasicRounded abs(BasicRounded a) { return made(std::fabs(a.value_)); }
    friend BasicRounded copysign(BasicRounded a, BasicRounded b) { return made(std::copysign(a.value_, b.value_)); }
    friend BasicRounded next_up(BasicRounded a) { return made(rounding::next_up(a.value_, F::get())); }
    friend BasicRounded next_down(BasicRounded a) { return made(-rounding::next_up(-a.value_, F::get())); }

private:
    static BasicRounded made(double value) {
        BasicRounded r;
        r.value_ = value;
        return r;
    }
    /// Computes with the machine's arithmetic if the format, known at run time, is one of the machine's.
    template <class Native, class Rounding, class... X>
    static BasicRounded computed(const Native& native, const Rounding& rounded, X... x) {
        if constexpr (std::same_as<F, CurrentFormat>) {
            const CurrentFormat::Engine engine = CurrentFormat::engine();
            if (engine == CurrentFormat::Engine::machine_float) return made(native(static_cast<float>(x.value_)...));
            if (engine == CurrentFormat::Engine::machine_double) return made(native(x.value_...));
        }
        return made(rounded(x.value_..., F::get()));
    }
    double value_ = 0;
};

/// P significand bits; exponents of binary64 unless given.
template <int P, int Emin = -1022, int Emax = 1023>
using Rounded = BasicRounded<FixedFormat<P, Emin, Emax>>;

using Half = Rounded<11, -14, 15>;
using BFloat16 = Rounded<8, -126, 127>;
using TensorFloat32 = Rounded<11, -126, 127>;

/// The format is the thread's `CurrentFormat`: one instantiation of a formula serves every format at run time.
using RoundedAny = BasicRounded<CurrentFormat>;

/// A double holds every number of these formats.
template <class F>
struct Wider<BasicRounded<F>> {
    using type = double;
    static double widen(BasicRounded<F> x) { return x.value(); }
    static BasicRounded<F> narrow(double x) { return BasicRounded<F>(x); }
};

static_assert(Number<Half> && Number<RoundedAny>);

}  // namespace lostbits
