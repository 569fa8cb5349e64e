// Every number that a form tells, ray by ray, and whether anything is met before a ray ends.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "intersect/process/stop_token.hpp"
#include "intersect/simd/packed.hpp"
#include "scene/rays/rays.hpp"

namespace lostbits::measure::consistency {

/// The answers of a form to some rays, widened to double. Where `hit` is 0 the numbers mean nothing.
struct AllAnswers {
    std::vector<double> t, near, far;
    std::vector<std::uint8_t> hit;

    [[nodiscard]] std::size_t size() const { return hit.size(); }
};

/// How a kernel is called: once with all rays, or once for each.
enum class Calls : std::uint8_t { together, one_by_one };

/// A form in a format, by the kernels that `native` has of it.
struct AskedForm {
    const intersect::table::Intersector& form;
    Format format;
    intersect::process::StopToken stop;
    intersect::simd::PackedRow native;

    /// By the kernels of one ray, or at a register width that this machine has.
    AskedForm(const intersect::table::Intersector& asked, const Format& in, intersect::process::StopToken until = {},
              intersect::simd::Isa isa = intersect::simd::Isa::scalar)
        : form(asked), format(in), stop(until), native(intersect::simd::packed_kernels(asked, isa)) {}
};

/// Rays, whose numbers and ends are of the format, with one solid; or with as many as rays, to each its own, by the
/// kernels of one ray.
AllAnswers ask(const AskedForm& asked, const scene::rays::RayBlock& rays, std::span<const Solid<double>> solids,
               Calls calls = Calls::together);

/// Whether a form can say where a ray is met: an end is compared with that.
bool tells_t(const intersect::Info& info);

/// Of each ray, whether the form meets any of the solids before the ray's `tmax`, as a shadow test asks. The forms that
/// are told the end (boxes) decide by themselves. Of the others a solid counts where the form says that it is hit and
/// its t, or the far side where it tells that, lies in 0 < t < tmax. A near side that is not t is one that the form
/// itself has turned down.
std::vector<std::uint8_t> meets_before_end(const AskedForm& asked, const scene::rays::RayBlock& rays,
                                           std::span<const Solid<double>> solids);

}  // namespace lostbits::measure::consistency
