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
    std::string_view word;
    std::uint64_t mask, value;
    bool x87 = false;
};

#if defined(__x86_64__) || defined(__i386__)

// Intel 64 and IA-32 Architectures Software Developer's Manual, volume 1, 8.1.5 and 10.2.3.
constexpr std::uint64_t standard_main = 0x1F80, raised = 0x3F;
constexpr std::uint32_t standard_x87 = 0x033F, x87_bits = 0x0F3F;
constexpr std::array deviations{
    Deviation{"round_down", 0x6000, 0x2000},         Deviation{"round_up", 0x6000, 0x4000},
    Deviation{"round_to_zero", 0x6000, 0x6000},      Deviation{"flush_to_zero", 0x8000, 0x8000},
    Deviation{"denormals_are_zero", 0x0040, 0x0040}, Deviation{"x87_round_down", 0x0C00, 0x0400, true},
    Deviation{"x87_round_up", 0x0C00, 0x0800, true}, Deviation{"x87_round_to_zero", 0x0C00, 0x0C00, true},
    Deviation{"x87_24_bits", 0x0300, 0x0000, true},  Deviation{"x87_53_bits", 0x0300, 0x0200, true}};

std::uint64_t main_now() noexcept { return _mm_getcsr() & ~static_cast<unsigned>(raised); }
std::uint32_t x87_now() noexcept {
    std::uint16_t word = 0;
    asm volatile("fnstcw %0" : "=m"(word));
    return word & x87_bits;
}
/// Clears the raised exceptions, so that none of them traps later.
void set_main(std::uint64_t bits) noexcept { _mm_setcsr(static_cast<unsigned>(bits)); }
void set_x87(std::uint32_t bits) noexcept {
    const auto word = static_cast<std::uint16_t>(bits | 0x0040U);  // a bit that is always set
    asm volatile("fnclex\n\tfldcw %0" : : "m"(word));
}

#elif defined(__aarch64__)

// Arm Architecture Reference Manual, FPCR: FZ is bit 24, RMode bits 22 and 23.
constexpr std::uint64_t standard_main = 0;
constexpr std::uint32_t standard_x87 = 0;
constexpr std::array deviations{Deviation{"round_up", 0xC00000, 0x400000}, Deviation{"round_down", 0xC00000, 0x800000},
                                Deviation{"round_to_zero", 0xC00000, 0xC00000},
                                Deviation{"flush_to_zero", 0x1000000, 0x1000000}};

std::uint64_t main_now() noexcept {
    std::uint64_t bits = 0;
    asm volatile("mrs %0, fpcr" : "=r"(bits));
    return bits;
}
void set_main(std::uint64_t bits) noexcept { asm volatile("msr fpcr, %0" : : "r"(bits)); }
std::uint32_t x87_now() noexcept { return 0; }
void set_x87(std::uint32_t) noexcept {}

#else

constexpr std::uint64_t standard_main = FE_TONEAREST;
constexpr std::uint32_t standard_x87 = 0;
constexpr std::array deviations{Deviation{"round_down", ~0ULL, FE_DOWNWARD}, Deviation{"round_up", ~0ULL, FE_UPWARD},
                                Deviation{"round_to_zero", ~0ULL, FE_TOWARDZERO}};

std::uint64_t main_now() noexcept { return static_cast<std::uint64_t>(std::fegetround()); }
void set_main(std::uint64_t bits) noexcept { std::fesetround(static_cast<int>(bits)); }
std::uint32_t x87_now() noexcept { return 0; }
void set_x87(std::uint32_t) noexcept {}

#endif

/// The name of any other difference: exceptions that trap.
constexpr std::string_view otherwise = "traps";

}  // namespace

FloatingPoint FloatingPoint::current() noexcept {
    FloatingPoint now;
    now.main_ = main_now();
    now.x87_ = x87_now();
    return now;
}

FloatingPoint FloatingPoint::standard() noexcept {
    FloatingPoint usual;
    usual.main_ = standard_main;
    usual.x87_ = standard_x87;
    return usual;
}

void FloatingPoint::set() const noexcept {
    const FloatingPoint now = current();
    if (now.main_ != main_) set_main(main_);
    if (now.x87_ != x87_) set_x87(x87_);
}

std::string FloatingPoint::differences() const {
    std::string all;
    FloatingPoint told = standard();
    for (const Deviation& way : deviations) {
        const std::uint64_t here = way.x87 ? x87_ : main_, usual = way.x87 ? standard_x87 : standard_main;
        if ((here & way.mask) != way.value || (usual & way.mask) == way.value) continue;
        all += (all.empty() ? "" : ",") + std::string(way.word);
        read(std::string(way.word), told);
    }
    if (told != *this) all += (all.empty() ? "" : ",") + std::string(otherwise);
    return all;
}

bool FloatingPoint::read(const std::string& words, FloatingPoint& into) {
    std::string_view rest = words;
    while (!rest.empty()) {
        const std::string_view word = rest.substr(0, rest.find(','));
        rest.remove_prefix(std::min(rest.size(), word.size() + 1));
        bool known = word == otherwise;
        for (const Deviation& way : deviations) {
            if (way.word != word) continue;
            known = true;
            if (way.x87)
                into.x87_ = (into.x87_ & ~static_cast<std::uint32_t>(way.mask)) | static_cast<std::uint32_t>(way.value);
            else into.main_ = (into.main_ & ~way.mask) | way.value;
        }
        if (!known) return false;
    }
    return true;
}

void require_standard(const char* what) {
    const FloatingPoint now = FloatingPoint::current();
    if (now == FloatingPoint::standard()) return;
    throw Error(Exit::internal, std::string(what) + ": this thread does not compute as IEEE 754 asks (" +
                                    now.differences() +
                                    "), so nothing can be proved; some code changed that and did not restore it. To "
                                    "find that code, leave out --plugin and LD_PRELOAD");
}

}  // namespace lostbits::intersect::process
