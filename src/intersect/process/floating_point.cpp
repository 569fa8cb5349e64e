#include "intersect/process/floating_point.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "number/error.hpp"

#if defined(__x86_64__) || defined(__i386__)
#include <xmmintrin.h>
#else
#include <cfenv>
#endif

namespace lostbits::intersect::process {
namespace {

/// A difference from the standard state: its name, the mask of its bits, and their value.
struct Deviation {
    std::string_view name;
    std::uint64_t mask, value;
    bool is_x87 = false;
};

#if defined(__x86_64__) || defined(__i386__)

// Intel 64 and IA-32 Architectures Software Developer's Manual, volume 1, 8.1.5 and 10.2.3.
constexpr std::uint64_t standard_control = 0x1F80, raised_exceptions = 0x3F;
constexpr std::uint32_t standard_x87 = 0x033F, x87_bits = 0x0F3F;
constexpr std::array deviations{
    Deviation{"round_down", 0x6000, 0x2000},         Deviation{"round_up", 0x6000, 0x4000},
    Deviation{"round_to_zero", 0x6000, 0x6000},      Deviation{"flush_to_zero", 0x8000, 0x8000},
    Deviation{"denormals_are_zero", 0x0040, 0x0040}, Deviation{"x87_round_down", 0x0C00, 0x0400, true},
    Deviation{"x87_round_up", 0x0C00, 0x0800, true}, Deviation{"x87_round_to_zero", 0x0C00, 0x0C00, true},
    Deviation{"x87_24_bits", 0x0300, 0x0000, true},  Deviation{"x87_53_bits", 0x0300, 0x0200, true}};

std::uint64_t read_control() noexcept { return _mm_getcsr() & ~static_cast<unsigned>(raised_exceptions); }
std::uint32_t read_x87() noexcept {
    std::uint16_t word = 0;
    asm volatile("fnstcw %0" : "=m"(word));
    return word & x87_bits;
}
/// Sets the state and clears the raised exceptions, so that none of them traps later.
void write_control(std::uint64_t bits) noexcept { _mm_setcsr(static_cast<unsigned>(bits)); }
void write_x87(std::uint32_t bits) noexcept {
    const auto word = static_cast<std::uint16_t>(bits | 0x0040U);  // a bit that is always set
    asm volatile("fnclex\n\tfldcw %0" : : "m"(word));
}

#elif defined(__aarch64__)

// Arm Architecture Reference Manual, FPCR: FZ is bit 24, RMode bits 22 and 23.
constexpr std::uint64_t standard_control = 0;
constexpr std::uint32_t standard_x87 = 0;
constexpr std::array deviations{Deviation{"round_up", 0xC00000, 0x400000}, Deviation{"round_down", 0xC00000, 0x800000},
                                Deviation{"round_to_zero", 0xC00000, 0xC00000},
                                Deviation{"flush_to_zero", 0x1000000, 0x1000000}};

std::uint64_t read_control() noexcept {
    std::uint64_t bits = 0;
    asm volatile("mrs %0, fpcr" : "=r"(bits));
    return bits;
}
void write_control(std::uint64_t bits) noexcept { asm volatile("msr fpcr, %0" : : "r"(bits)); }
std::uint32_t read_x87() noexcept { return 0; }
void write_x87(std::uint32_t) noexcept {}

#else

constexpr std::uint64_t standard_control = FE_TONEAREST;
constexpr std::uint32_t standard_x87 = 0;
constexpr std::array deviations{Deviation{"round_down", ~0ULL, FE_DOWNWARD}, Deviation{"round_up", ~0ULL, FE_UPWARD},
                                Deviation{"round_to_zero", ~0ULL, FE_TOWARDZERO}};

std::uint64_t read_control() noexcept { return static_cast<std::uint64_t>(std::fegetround()); }
void write_control(std::uint64_t bits) noexcept { std::fesetround(static_cast<int>(bits)); }
std::uint32_t read_x87() noexcept { return 0; }
void write_x87(std::uint32_t) noexcept {}

#endif

/// Name for all differences that have no name of their own. Most of them are exceptions that trap.
constexpr std::string_view other_difference = "traps";

}  // namespace

FloatingPointState FloatingPointState::current() noexcept {
    FloatingPointState now;
    now.control_ = read_control();
    now.x87_ = read_x87();
    return now;
}

FloatingPointState FloatingPointState::standard() noexcept {
    FloatingPointState state;
    state.control_ = standard_control;
    state.x87_ = standard_x87;
    return state;
}

void FloatingPointState::apply() const noexcept {
    const FloatingPointState now = current();
    if (now.control_ != control_) write_control(control_);
    if (now.x87_ != x87_) write_x87(x87_);
}

std::string FloatingPointState::differences() const {
    std::string names;
    FloatingPointState described_state = standard();
    for (const Deviation& deviation : deviations) {
        const std::uint64_t bits = deviation.is_x87 ? x87_ : control_,
                            standard_bits = deviation.is_x87 ? standard_x87 : standard_control;
        if ((bits & deviation.mask) != deviation.value || (standard_bits & deviation.mask) == deviation.value) continue;
        names += (names.empty() ? "" : ",") + std::string(deviation.name);
        parse_differences(std::string(deviation.name), described_state);
    }
    if (described_state != *this) names += (names.empty() ? "" : ",") + std::string(other_difference);
    return names;
}

bool FloatingPointState::parse_differences(const std::string& names, FloatingPointState& state) {
    std::string_view rest = names;
    while (!rest.empty()) {
        const std::string_view name = rest.substr(0, rest.find(','));
        rest.remove_prefix(std::min(rest.size(), name.size() + 1));
        bool is_known = name == other_difference;
        for (const Deviation& deviation : deviations) {
            if (deviation.name != name) continue;
            is_known = true;
            if (deviation.is_x87)
                state.x87_ = (state.x87_ & ~static_cast<std::uint32_t>(deviation.mask)) |
                             static_cast<std::uint32_t>(deviation.value);
            else state.control_ = (state.control_ & ~deviation.mask) | deviation.value;
        }
        if (!is_known) return false;
    }
    return true;
}

void require_standard(const char* what) {
    const FloatingPointState now = FloatingPointState::current();
    if (now == FloatingPointState::standard()) return;
    throw Error(ExitStatus::internal,
                std::string(what) + ": this thread does not compute as IEEE 754 requires (" + now.differences() +
                    "), so nothing can be proved; some code changed that and did not restore it. To "
                    "find that code, leave out --plugin and LD_PRELOAD");
}

}  // namespace lostbits::intersect::process
