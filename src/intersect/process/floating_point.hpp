// How the processor computes: which way it rounds, and whether subnormal numbers are zeros to it. A library that was
// linked with -Ofast changes that in the thread that loads it, and threads inherit it from the one that starts them.
#pragma once

#include <cstdint>
#include <string>

namespace lostbits::intersect::process {

/// The control bits of SSE and of x87, without the exceptions that were raised. Elsewhere than on x86 the rounding
/// direction alone, and on AArch64 FPCR.
class FloatingPoint {
public:
    /// Of this thread.
    static FloatingPoint current() noexcept;
    /// What IEEE 754 asks for and every number here rests on: to nearest, subnormal numbers kept, no traps; of x87 64
    /// bits of significand.
    static FloatingPoint standard() noexcept;

    /// From now on this thread computes so.
    void set() const noexcept;
    /// `flush_to_zero,denormals_are_zero`: what differs from the standard, in the words of a contract; empty where
    /// nothing does.
    [[nodiscard]] std::string words() const;
    /// The inverse. False where a word is none.
    static bool read(const std::string& words, FloatingPoint& into);

    friend bool operator==(const FloatingPoint&, const FloatingPoint&) = default;

private:
    std::uint64_t main_ = 0;
    std::uint32_t x87_ = 0;
};

/// At its end this thread computes as it did at its beginning: around calls of code that is not ours and has no
/// contract, such as that of images and of drivers.
class KeepsFloatingPoint {
public:
    KeepsFloatingPoint() noexcept : before_(FloatingPoint::current()) {}
    ~KeepsFloatingPoint() { before_.set(); }
    KeepsFloatingPoint(const KeepsFloatingPoint&) = delete;
    KeepsFloatingPoint& operator=(const KeepsFloatingPoint&) = delete;

private:
    FloatingPoint before_;
};

/// An enclosure is none where the processor rounds otherwise or has no subnormal numbers. Error with Exit::internal,
/// which names `what`; some ten nanoseconds.
void require_standard(const char* what);

}  // namespace lostbits::intersect::process
