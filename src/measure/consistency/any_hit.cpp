// The closest hit against shadow tests that end just after it, at it, and just before it.
#include <cmath>

#include "measure/consistency/check.hpp"
#include "number/rounded.hpp"

namespace lostbits::measure::consistency {

namespace {

/// What a map says of a pixel against a shadow test whose end is made of its t. `expected`: what the test should say.
template <class End>
void compare_with_ends(const RowOnBand& on, const End& end, bool expected, AccordOfPixels& out) {
    scene::rays::RayBlock rays = on.rays();
    rays.tmax.assign(rays.size(), HUGE_VAL);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (on.closest.hit[i] != 0) rays.tmax[i] = end(on.closest.t[i]);
    }
    const auto meets = meets_before_end(on.form, rays, on.solids);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (on.closest.hit[i] == 0 || std::isnan(rays.tmax[i])) continue;
        const Accord how = (meets[i] != 0) == expected ? Accord::agree
                           : expected                  ? Accord::first_alone
                                                       : Accord::second_alone;
        out.set(i, how, [&] {
            return TwoRays{i, on.shown(on.inputs.rays[i], HUGE_VAL), on.shown(on.inputs.rays[i], rays.tmax[i])};
        });
    }
}

}  // namespace

void check_beyond(const RowOnBand& on, AccordOfPixels& out) {
    // No end lies after an infinite t or a NaN: any hit at all must do.
    compare_with_ends(
        on, [&](double t) { return std::isfinite(t) ? rounding::next_up(t, on.format()) : HUGE_VAL; }, true, out);
}

void check_end(const RowOnBand& on, AccordOfPixels& out) {
    compare_with_ends(
        on, [](double t) { return std::isfinite(t) ? t : truth::missing; }, false, out);
}

void check_before(const RowOnBand& on, AccordOfPixels& out) {
    // Before t = 0 there is no ray.
    compare_with_ends(
        on, [&](double t) { return std::isfinite(t) && t > 0 ? -rounding::next_up(-t, on.format()) : truth::missing; },
        false, out);
}

}  // namespace lostbits::measure::consistency
