#include "output/image/ticks.hpp"

#include <charconv>
#include <cmath>

namespace lostbits::output::image {

double round_step(double least) {
    const double ten = std::pow(10.0, std::floor(std::log10(least)));
    for (const double m : {1.0, 2.0, 5.0}) {
        if (m * ten >= least * (1 - 1e-9)) return m * ten;
    }
    return 10 * ten;
}

std::vector<double> multiples(double step, double lo, double hi) {
    std::vector<double> out;
    const auto inside = [&](double value) { return std::isfinite(value) && value <= hi + step * 1e-9; };
    for (double k = std::ceil(lo / step - 1e-9); inside(k * step); k += 1) out.push_back(k * step);
    return out;
}

std::string tick_label(double value, int digits) {
    char text[40];
    // A negative zero is labelled 0.
    const auto end = std::to_chars(text, text + sizeof text, value + 0.0, std::chars_format::general, digits).ptr;
    return {text, end};
}

}  // namespace lostbits::output::image
