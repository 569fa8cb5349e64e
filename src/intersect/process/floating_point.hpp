// The processor's floating-point state: its rounding direction, and whether it treats subnormal numbers as zeros. A
// library linked with -Ofast changes the state of the thread that loads it, and a thread inherits the state of the
// thread that starts it.
#pragma once

#include <cstdint>
#include <string>

namespace lostbits::intersect::process {

/// The control bits of SSE and of x87, without the raised exceptions. On AArch64 FPCR; on other processors only the
/// rounding direction.
class FloatingPointState {
public:
    /// Returns the state of this thread.
    static FloatingPointState current() noexcept;
    /// Returns the state that IEEE 754 asks for and on which every number here relies: rounding to nearest, subnormal
    /// numbers kept, no traps, and 64 bits of significand on x87.
    static FloatingPointState standard() noexcept;

    /// Sets this state for this thread.
    void apply() const noexcept;
    /// Returns the differences from the standard state as the property of a contract, such as
    /// `flush_to_zero,denormals_are_zero`; empty if the state is the standard one.
    [[nodiscard]] std::string differences() const;
    /// Applies differences, as `differences` names them, to `state`. Returns false for an unknown name. The difference
    /// `traps` changes nothing.
    static bool parse_differences(const std::string& names, FloatingPointState& state);

    friend bool operator==(const FloatingPointState&, const FloatingPointState&) = default;

private:
    std::uint64_t control_ = 0;
    std::uint32_t x87_ = 0;
};

/// Restores, when it is destroyed, the state that the thread had when the guard was made: for calls of foreign code
/// without a contract, such as image libraries and drivers.
class FloatingPointGuard {
public:
    FloatingPointGuard() noexcept : state_before_(FloatingPointState::current()) {}
    ~FloatingPointGuard() { state_before_.apply(); }
    FloatingPointGuard(const FloatingPointGuard&) = delete;
    FloatingPointGuard& operator=(const FloatingPointGuard&) = delete;

private:
    FloatingPointState state_before_;
};

/// Throws Error with ExitStatus::internal, which names `what`, unless the thread has the standard state: an enclosure
/// is not valid if the processor rounds otherwise or has no subnormal numbers. Takes some ten nanoseconds.
void require_standard(const char* what);

}  // namespace lostbits::intersect::process
