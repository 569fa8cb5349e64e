// Moves the rays of a request together with their primitives, so that the answers stay the same in real arithmetic:
// exchanges axes, mirrors, rotates. A repair that was fitted to one axis of a scene fails on some of these rays.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "geometry/affine.hpp"
#include "measure/choose/ideal_rays.hpp"
#include "measure/repair/quality.hpp"

namespace lostbits::measure::repair {

/// Linear map that keeps every length: its matrix is `entries` over `divisor`.
///
/// Only the maps that permute the axes, with signs, have entries that are exact in binary. Suppose 2^k is the smallest
/// common denominator of a row, k ≥ 1. The squares of the row's three integers sum to 4^k, which 4 divides. A square is
/// 0 or 1 modulo 4, so all three are even, and 2^k was not the smallest.
struct Isometry {
    std::string_view name;         ///< as in probes.csv
    std::string_view description;  ///< as in the text
    std::array<int, 9> entries;
    int divisor;

    /// True if the map permutes the axes, with signs; stored numbers are then mapped to stored numbers.
    [[nodiscard]] constexpr bool is_exact() const { return divisor == 1; }
    /// True if the map mirrors: its determinant is −1.
    [[nodiscard]] constexpr bool mirrors() const {
        const auto& [a, b, c, d, e, f, g, h, i] = entries;
        return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g) < 0;
    }
};

// clang-format off
inline constexpr std::array isometries{
    Isometry{"yzx", "axes in the order y z x", {0, 1, 0,  0, 0, 1,  1, 0, 0}, 1},
    Isometry{"zxy", "axes in the order z x y", {0, 0, 1,  1, 0, 0,  0, 1, 0}, 1},
    Isometry{"yxz", "x and y exchanged", {0, 1, 0,  1, 0, 0,  0, 0, 1}, 1},
    Isometry{"mirrored", "mirrored in x, y and z", {-1, 0, 0,  0, -1, 0,  0, 0, -1}, 1},
    Isometry{"quarter_turn", "a quarter turn about z", {0, -1, 0,  1, 0, 0,  0, 0, 1}, 1},
    // The rotation of the quaternion (5, 1, 2, 3): by 147 degrees about (1, 2, 3).
    Isometry{"rotated", "rotated by 147 degrees about (1, 2, 3)", {13, -26, 26,  34, 19, 2,  -14, 22, 29}, 39}};
// clang-format on

/// Maps a primitive by an isometry about the origin. Empty if the result is not a primitive of the same shape: a
/// box or an ellipsoid without a matrix stays along the axes, so it cannot be rotated.
std::optional<Primitive<Real>> map_primitive(const Primitive<Real>& primitive, const Isometry& isometry);

/// Quality of tapes on the rays and primitives of a request, mapped by one of the isometries.
class Probe {
public:
    Probe(const Isometry& isometry, const RepairRequest& request, const MovedRays& rays)
        : isometry_(&isometry), measurer_(request, rays) {}
    [[nodiscard]] const Isometry& isometry() const { return *isometry_; }
    [[nodiscard]] QualityMeasurer& measurer() { return measurer_; }

private:
    const Isometry* isometry_;
    QualityMeasurer measurer_;
};

/// Makes the probes that apply to a request, on at most `ray_count` of its rays, fewer if there are many primitives.
/// Returns none for a flake or more than 1024 primitives. Forms that count one side of a primitive are not tested in a
/// mirror, where rays meet the other side.
std::vector<std::unique_ptr<Probe>> make_probes(const RepairRequest& request, int ray_count = few_rays_count);

/// Groups of operations that are the same expression up to an exchange of x, y and z; every operation is in one group.
/// `example`: a primitive of the form, with its way of storing a matrix. A partial sum that no exchange maps to an
/// operation is in the group of the whole sum. The order of operands does not matter, nor the brackets of a sum.
std::vector<std::vector<NodeId>> find_exchanged_groups(const Tape& tape, const std::vector<NodeId>& operations,
                                                       const Primitive<double>& example);

}  // namespace lostbits::measure::repair
