// Rounded<P>: a correctly rounded number with a significand of P bits and its own exponent range, to find how many bits
// are enough.
#pragma once

#include <bit>

#include "number/concept.hpp"
#include "number/format.hpp"

namespace lostbits {

namespace rounding {

/// Rounds the exact value r + δ to `f`, ties to even, where r = RN53(r + δ) and `residual` is the sign of δ. The result
/// is correct for every p ≤ 52, and for p = 53 if r is normal in f. Since |δ| is at most half of r's last place, δ
/// matters only if r itself lies exactly half way between two neighbours of f.
double to_format(double r, int residual, const FloatFormat& format);

/// The same operations through MPFR, with no assumption about the range. They are a simple reference for the fast
/// functions below, which call them if a residual would underflow.
double add_reference(double a, double b, const FloatFormat& format);
double mul_reference(double a, double b, const FloatFormat& format);
double div_reference(double a, double b, const FloatFormat& format);
double sqrt_reference(double a, const FloatFormat& format);
double fma_reference(double a, double b, double c, const FloatFormat& format);

double add(double a, double b, const FloatFormat& format);
inline double sub(double a, double b, const FloatFormat& format) { return add(a, -b, format); }
double mul(double a, double b, const FloatFormat& format);
double div(double a, double b, const FloatFormat& format);
double sqrt(double a, const FloatFormat& format);
double fma(double a, double b, double c, const FloatFormat& format);
double next_up(double a, const FloatFormat& format);

}  // namespace rounding

/// The format that `RoundedAny` computes in on this thread: that of the innermost scope.
class CurrentFormat {
public:
    /// The format of the innermost scope; Error(ExitStatus::internal) outside of every scope.
    static const FloatFormat& get() {
        if (!current_) [[unlikely]]
            fail_without_format();
        return *current_;
    }

    /// The arithmetic that computes in the current format: the machine's own if it has the format.
    enum class Engine : std::uint8_t { machine_float, machine_double, rounding };
    static Engine engine() { return engine_; }

    /// Sets the thread's format for the lifetime of the scope.
    class Scope {
    public:
        explicit Scope(const FloatFormat& format) : format_(format), previous_(current_), previous_engine_(engine_) {
            current_ = &format_;
            engine_ = format == binary32   ? Engine::machine_float
                      : format == binary64 ? Engine::machine_double
                                           : Engine::rounding;
        }
        ~Scope() {
            current_ = previous_;
            engine_ = previous_engine_;
        }
        Scope(const Scope&) = delete;
        Scope& operator=(const Scope&) = delete;

    private:
        FloatFormat format_;
        const FloatFormat* previous_;
        Engine previous_engine_;
    };

private:
    [[noreturn]] static void fail_without_format();
    // constinit: other files read it without first checking that it is initialised.
    static constinit thread_local const FloatFormat* current_;
    static constinit thread_local Engine engine_;
};

template <int P, int Emin, int Emax>
struct FixedFormat {
    static_assert(2 <= P && P <= 53 && -1022 <= Emin && Emin <= Emax && Emax <= 1023);
    static constexpr FloatFormat get() { return {P, Emin, Emax}; }
};

/// A number of the format `F::get()`, held in a double, which can hold every such number. Each operation is correctly
/// rounded to nearest even, with the subnormals, signed zeros, infinities and NaN of that format.
template <class F>
class BasicRounded {
public:
    BasicRounded() = default;
    explicit BasicRounded(int x) : value_(rounding::to_format(x, 0, F::get())) {}
    explicit BasicRounded(double x) : value_(rounding::to_format(x, 0, F::get())) {}

    /// Wraps a double that is a number of the format already.
    static BasicRounded from_value(double value) { return with_value(value); }

    [[nodiscard]] double value() const { return value_; }
    static FloatFormat format() { return F::get(); }

    friend BasicRounded operator+(BasicRounded a, BasicRounded b) {
        return compute([](auto x, auto y) { return x + y; }, rounding::add, a, b);
    }
    friend BasicRounded operator-(BasicRounded a, BasicRounded b) {
        return compute([](auto x, auto y) { return x - y; }, rounding::sub, a, b);
    }
    friend BasicRounded operator*(BasicRounded a, BasicRounded b) {
        return compute([](auto x, auto y) { return x * y; }, rounding::mul, a, b);
    }
    friend BasicRounded operator/(BasicRounded a, BasicRounded b) {
        return compute([](auto x, auto y) { return x / y; }, rounding::div, a, b);
    }
    friend BasicRounded operator-(BasicRounded a) { return with_value(-a.value_); }
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
        return compute([](auto x) { return std::sqrt(x); }, rounding::sqrt, a);
    }
    friend BasicRounded fma(BasicRounded a, BasicRounded b, BasicRounded c) {
        return compute([](auto x, auto y, auto z) { return std::fma(x, y, z); }, rounding::fma, a, b, c);
    }
    friend BasicRounded abs(BasicRounded a) { return with_value(std::fabs(a.value_)); }
    friend BasicRounded copysign(BasicRounded a, BasicRounded b) {
        return with_value(std::copysign(a.value_, b.value_));
    }
    friend BasicRounded next_up(BasicRounded a) { return with_value(rounding::next_up(a.value_, F::get())); }
    friend BasicRounded next_down(BasicRounded a) { return with_value(-rounding::next_up(-a.value_, F::get())); }

private:
    static BasicRounded with_value(double value) {
        BasicRounded r;
        r.value_ = value;
        return r;
    }
    /// Computes with the machine's arithmetic if the format, known at run time, is one of the machine's, and with
    /// `rounding` otherwise.
    template <class Native, class Rounding, class... X>
    static BasicRounded compute(const Native& native_operation, const Rounding& rounded_operation, X... x) {
        if constexpr (std::same_as<F, CurrentFormat>) {
            const CurrentFormat::Engine engine = CurrentFormat::engine();
            if (engine == CurrentFormat::Engine::machine_float)
                return with_value(native_operation(static_cast<float>(x.value_)...));
            if (engine == CurrentFormat::Engine::machine_double) return with_value(native_operation(x.value_...));
        }
        return with_value(rounded_operation(x.value_..., F::get()));
    }
    double value_ = 0;
};

/// P significand bits, by default with the exponents of binary64.
template <int P, int Emin = -1022, int Emax = 1023>
using Rounded = BasicRounded<FixedFormat<P, Emin, Emax>>;

using Half = Rounded<11, -14, 15>;
using BFloat16 = Rounded<8, -126, 127>;
using TensorFloat32 = Rounded<11, -126, 127>;

/// A number in the thread's `CurrentFormat`, so that one instantiation of a formula serves every format at run time.
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
