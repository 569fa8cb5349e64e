// Every crossing of a ray with triangles, in exact order, and the winding number of a point in a mesh.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "measure/culling/culling.hpp"
#include "measure/truth/truth.hpp"
#include "shapes/triangle/mesh/mesh.hpp"

namespace lostbits::measure::crossing {

/// Triangles, and the index that finds those that a ray can meet. Without an index (null), every triangle is tested.
struct Triangles {
    const scene::rays::PrimitiveList<double>& primitives;  ///< triangles only
    const culling::PrimitiveIndex* index = nullptr;
};

/// A point at which a ray meets a triangle, its rim included.
struct MeshCrossing {
    std::uint32_t triangle = 0;
    int rank = 0;                     ///< position in the order of t, from 0; the same for crossings at the same t
    truth::CertifiedNumber t;         ///< in units of the direction's length
    truth::CertifiedNumber distance;  ///< t |d|
    bool hits_front = false;          ///< the ray comes from the side from which the corners run counter-clockwise
    bool is_at_rim = false;           ///< the ray passes through an edge or a vertex
};

/// Crossings of one ray.
struct MeshCrossings {
    std::vector<MeshCrossing> in_order;  ///< by t, then by the index of the triangle
    bool is_resolved = true;             ///< false: no precision decided, and crossings may be missing
};

/// Finds every crossing with t in `range`. Decisions and the order of t are signs of dyadic polynomials, so that a tie
/// is a tie of the exact numbers. A ray in the plane of a triangle does not cross it.
MeshCrossings find_crossings(const Ray<double>& ray, const Triangles& triangles, const Range<double>& range = {},
                             truth::ProofLimit limit = {});

/// Side from which a line crosses the plane of a triangle: 1 for the front, −1 for the back, 0 if the line does not
/// cross the plane. Exact, by rising precision. Nothing if no precision decides.
std::optional<int> find_facing(const Ray<double>& ray, const Primitive<double>& triangle);

/// Edges of a triangle to which a line passes nearest, measured in the plane of the triangle, for a line that meets the
/// triangle. Bit k stands for the edge opposite to corner k. Several edges may be exactly as near. All edges if the
/// line does not cross the plane, or if no precision decides.
unsigned find_nearest_edges(const Ray<double>& ray, const Primitive<double>& triangle);

/// True if one of the edges of a face to which the line passes nearest belongs to this face alone. The line must meet
/// the face.
bool is_beside_border(const Ray<double>& ray, const Primitive<double>& triangle, const scene::triangle::Mesh& mesh,
                      std::size_t face);

/// Position of a point relative to a mesh.
struct PointInMesh {
    int winding = 0;             ///< number of layers of the surface around the point, see `locate_in_mesh`
    int crossings = 0;           ///< number of crossings of the ray that counts the layers
    bool is_on_surface = false;  ///< the point lies on a triangle; `winding` and `crossings` are then 0
    bool is_resolved = true;  ///< false: the point is not finite, or every ray tried meets an edge or lies in a plane
};

/// Counts crossings of a ray that begins at the point: winding = (number of triangles that the ray leaves through the
/// back) − (number of triangles that it meets from the front). Tries directions, the same ones for every point, until
/// the ray meets no rim and lies in no plane of a triangle that it may meet.
///
/// The number does not depend on the direction if at every edge of the mesh as many faces run one way as the other
/// (`MeshCounts::unbalanced_edges` = 0): the faces are then a closed 2-chain, the boundary of a 3-chain whose
/// multiplicity at the point is the sum of the signs of the crossings with any ray that misses the edges. It is 1
/// inside a closed mesh whose corners run counter-clockwise seen from outside, and −1 if they run clockwise. If every
/// edge has an even number of faces (`MeshCounts::odd_edges` = 0), the same holds modulo 2 for the number of crossings,
/// however the faces are turned.
PointInMesh locate_in_mesh(const Vec<double>& point, const Triangles& triangles, truth::ProofLimit limit = {});

}  // namespace lostbits::measure::crossing
