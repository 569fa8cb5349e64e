// The picture that exact arithmetic paints, with a proof: the reference of every rendered picture.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "intersect/process/stop_token.hpp"
#include "measure/truth/band.hpp"
#include "scene/file/appearance.hpp"

namespace lostbits::measure::picture {

/// Limit of the precision. Enclosures start at double-double and go to MPFI at 192 bits, doubling up to this limit. A
/// colour of a point is almost always irrational. So a decision that is exactly on its edge (a shadow ray that touches,
/// N·L = 0, a channel on the edge between two bytes) is not settled by more bits unless the enclosure has no width. It
/// is left `unresolved` and counted.
struct PictureLimit {
    int bits = 3072;
    intersect::process::StopToken stop = {};  ///< as in `TruthLimit`
};

/// Absolute error bound of channels and of components of normals: 2^-72, which is 2^-64 of an 8-bit step.
inline constexpr double picture_tightness = 0x1p-72;
struct Tight {
    double hi = 0, lo = 0;
};

struct TrueColour {
    std::array<Tight, 3> channel;        ///< as computed, not clamped
    std::array<std::uint8_t, 3> byte{};  ///< 255 times the channel, rounded half up, clamped
    bool certain = false;                ///< the channels are tight and their bytes proved
};

/// Tells if the light reaches a pixel's point past all spheres but its own.
enum class TrueShadow : std::uint8_t { untested, lit, shadowed, unresolved };

struct TruePixel {
    std::array<Tight, 3> normal;
    bool has_normal = false;  ///< a sphere is seen and its normal is tight
    TrueShadow shadow = TrueShadow::untested;
    bool faces_light = false;                                         ///< N·L > 0, certainly
    std::array<TrueColour, scene::file::stage_names.size()> colours;  ///< one a requested stage
    int bits = 0;                                                     ///< precision of the last attempt
};

/// Finds the true pixels of a band for some stages, in parallel. Primitives are closed: touching is a hit, for the eye
/// and for shadows. It depends on no form, so all forms have the same reference. The spheres' shadows on the background
/// are those on the plane of pixels z = 0 (`Camera::Kind::pixel_plane`); under other cameras the background has no
/// place, and no shadow.
std::vector<TruePixel> find_true_picture(const scene::file::Scene& scene, const truth::Band& band,
                                         std::span<const scene::file::Stage> stages, PictureLimit limit = {});

}  // namespace lostbits::measure::picture
