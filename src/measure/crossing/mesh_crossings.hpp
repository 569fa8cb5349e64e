// Every crossing of a ray with triangles, in exact order, and the winding number of a point in a mesh.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "measure/culling/culling.hpp"
#include "measure/truth/truth.hpp"
#include "shapes/triangle/mesh/mesh.hpp"

namespace lostbits::measure::crossing {

/// Triangles and the index that finds those that a ray can meet. Index null: every triangle is tested.
struct Triangles {
    const scene::rays::PrimitiveList<double>& primitives;  ///< of no other shape
    const culling::PrimitiveIndex* index = nullptr;
};

/// A point at which a ray meets a triangle, its rim included.
struct MeshCrossing {
    std::uint32_t triangle = 0;
    int place = 0;              ///< in the order of t, from 0; crossings at the same t have the same place
    truth::Certified t;         ///< in lengths of the direction
    truth::Certified distance;  ///< t |d|
    bool front = false;         ///< the ray comes from the side on which the corners run counter-clockwise
    bool at_rim = false;        ///< it passes through an edge or a vertex
};

/// Crossings of one ray.
struct MeshCrossings {
    std::vector<MeshCrossing> in_order;  ///< by t, then by the number of the triangle
    bool is_resolved = true;             ///< false: no precision decided, and crossings may be missing
};

/// Finds every crossing with t in `range`. Decisions and the order of t are signs of dyadic polynomials, so that a tie
/// is a tie of the exact numbers. A ray in the plane of a triangle does not cross it.
MeshCrossings crossings_of(const Ray<double>& ray, const Triangles& among, const Range<double>& range = {},
                           truth::TruthLimit limit = {});

/// Side from which a line crosses the plane of a triangle: 1 for the front, −1 for the back, 0 if it does not cross it.
/// Exact, by rising precision. Nothing if no precision decides.
std::optional<int> facing_of(const Ray<double>& ray, const Primitive<double>& triangle);

/// Edges of a triangle that a line passes nearest to, measured in the plane of the triangle, for a line that meets it.
/// Bit k stands for the edge opposite to corner k. Several edges may be exactly as near. All edges if the line does not
/// cross the plane, or if no precision decides.
unsigned nearest_edges(const Ray<double>& ray, const Primitive<double>& triangle);

/// True if an edge that the line passes nearest to, among those of a face that it meets, belongs to this face alone.
bool is_beside_border(const Ray<double>& ray, const Primitive<double>& triangle, const scene::triangle::Mesh& mesh,
                      std::size_t face);

/// Position of a point relative to a mesh.
struct PointInMesh {
    int winding = 0;          ///< number of layers of the surface that enclose it, see `place_in_mesh`
    int crossings = 0;        ///< crossings of the ray by which the layers are counted
    bool on_surface = false;  ///< it lies on a triangle; the two numbers are 0 then
    bool is_resolved = true;  ///< false: the point is not finite, or no ray was found that passes all edges
};

/// Counts crossings of a ray that begins at the point: winding = (triangles that it leaves through the back) − (those
/// that it meets from the front). Directions are tried, the same ones for every point, until the ray meets no rim and
/// lies in no plane of a triangle that it may meet.
///
/// The number does not depend on the direction if at every edge of the mesh as many faces run one way as the other
/// (`MeshEdges::unbalanced` = 0): the faces are then a closed 2-chain, the boundary of a 3-chain whose multiplicity at
/// the point is the sum of the signs of the crossings with any ray that misses the edges. It is 1 inside a closed mesh
/// whose corners run counter-clockwise seen from outside, and −1 if they run clockwise. If every edge has an even
/// number of faces (`MeshEdges::odd` = 0), the same holds modulo 2 for the number of crossings, however the faces are
/// turned.
PointInMesh place_in_mesh(const Vec<double>& point, const Triangles& mesh, truth::TruthLimit limit = {});

}  // namespace lostbits::measure::crossing
