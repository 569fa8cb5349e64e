// Finds the picture that exact arithmetic gives, with a proof. It is the reference of every rendered picture.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "intersect/process/stop_token.hpp"
#include "measure/truth/band.hpp"
#include "scene/file/appearance.hpp"

namespace lostbits::measure::render {

/// Limit of the precision. Enclosures start in double-double, continue in MPFI with 192 bits, and double the bits up to
/// this limit. The colour of a point is almost always irrational. So more bits do not prove a decision that is exactly
/// on its edge (a shadow ray that touches, N·L = 0, a channel on the edge between two bytes), unless the enclosure has
/// no width. Such a decision stays `unresolved` and is counted.
struct PictureLimit {
    int max_bits = 3072;
    intersect::process::StopToken stop = {};  ///< as in `ProofLimit`
};

/// Absolute error bound of channels and of components of normals: 2^-72, which is 2^-64 of an 8-bit step.
inline constexpr double picture_tightness = 0x1p-72;
/// A number within `picture_tightness` of hi + lo.
struct TwoPartNumber {
    double hi = 0, lo = 0;
};

struct TrueColour {
    std::array<TwoPartNumber, 3> channel;  ///< as computed, not clamped
    std::array<std::uint8_t, 3> byte{};    ///< 255 times the channel, rounded half up and clamped
    bool is_certain = false;               ///< the channels are tight and their bytes proved
};

/// True shadow of the point at a pixel: whether a sphere other than its own blocks the light.
enum class TrueShadow : std::uint8_t { untested, lit, shadowed, unresolved };

struct TruePixel {
    std::array<TwoPartNumber, 3> normal;
    bool has_normal = false;  ///< a sphere is seen and its normal is tight
    TrueShadow shadow = TrueShadow::untested;
    bool faces_light = false;  ///< N·L > 0 is proved
    /// Indexed by stage; set for the requested stages.
    std::array<TrueColour, scene::file::stage_names.size()> colours;
    int bits = 0;  ///< precision of the last attempt
};

/// Finds the true pixels of a band for some stages, in parallel. Primitives are closed, so a ray that touches one hits
/// it, for the eye and for shadows. The result depends on no form, so all forms have the same reference. Spheres cast
/// shadows on the background only if it is the plane of the pixels, z = 0 (`Camera::Kind::pixel_plane`). With other
/// cameras the background has no points and no shadows.
std::vector<TruePixel> find_true_picture(const scene::file::Scene& scene, const truth::Band& band,
                                         std::span<const scene::file::Stage> stages, PictureLimit limit = {});

}  // namespace lostbits::measure::render
