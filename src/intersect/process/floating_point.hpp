// The processor's floating-point state: its rounding direction, and whether it treats subnormal numbers as zeros. A
// library linked with -Ofast changes that in the thread that loads it, and threads inherit it from the one that starts
// them.
#pragma once

#include <cstdint>
#include <string>

namespace lostbits::intersect::process {

/// The control bits of SSE and of x87, without the raised exceptions. On other processors the rounding direction alone,
/// and on AArch64 FPCR.
class FloatingPoint {
public:
    /// The state of this thread.
    static FloatingPoint current() noexcept;
    /// The state that IEEE 754 asks for and that every number here relies on: rounding to nearest, subnormal numbers
    /// kept, no traps, and 64 bits of significand on x87.
    static FloatingPoint standard() noexcept;

    /// Sets this state for this thread.
    void set() const noexcept;
    /// `flush_to_zero,denormals_are_zero`: the differences from the standard, as the property of a contract; empty if
    /// there are none.
    [[nodiscard]] std::string differences() const;
    /// The inverse of `differences`. False for an unknown word.
    static bool read(const std::string& words, FloatingPoint& into);

    friend bool operator==(const FloatingPoint&, const FloatingPoint&) = default;

private:
    std::uint64_t main_ = 0;
    std::uint32_t x87_ = 0;
};

/// Restores the thread's initial state when it is destroyed: for calls of foreign code without a contract, such as
/// image libraries and drivers.
class FloatingPointGuard {
public:
    FloatingPointGuard() noexcept : before_(FloatingPoint::current()) {}
    ~FloatingPointGuard() { before_.set(); }
    FloatingPointGuard(const FloatingPointGuard&) = delete;
    FloatingPointGuard& operator=(const FloatingPointGuard&) = delete;

private:
    FloatingPoint before_;
};

/// Requires the standard state: an enclosure is not valid if the processor rounds otherwise or has no subnormal
/// numbers. Error with Exit::internal, which names `what`; takes some ten nanoseconds.
void require_standard(const char* what);

}  // namespace lostbits::intersect::process
