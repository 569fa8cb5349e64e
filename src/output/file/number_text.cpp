#include "output/file/number_text.hpp"

#include <charconv>
#include <cmath>

namespace lostbits::output::file {
namespace {

template <class F>
std::string shortest(F value) {
    if (std::isnan(value)) return "nan";
    if (std::isinf(value)) return std::signbit(value) ? "-inf" : "inf";
    char text[64];
    const auto end = std::to_chars(text, text + sizeof text, value).ptr;
    return {text, end};
}

}  // namespace

std::string decimal(double value) { return shortest(value); }
std::string decimal(float value) { return shortest(value); }

std::string hex(double value) {
    if (!std::isfinite(value)) return shortest(value);
    char text[64];
    const auto end = std::to_chars(text, text + sizeof text, std::fabs(value), std::chars_format::hex).ptr;
    return (std::signbit(value) ? "-0x" : "0x") + std::string(text, end);
}

}  // namespace lostbits::output::file
