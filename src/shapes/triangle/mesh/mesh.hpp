// Meshes of triangles: made by formula, or read from files.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "intersect/process/stop_token.hpp"
#include "number/format.hpp"
#include "scene/toml/toml_reader.hpp"
#include "shapes/solid.hpp"

namespace lostbits::scene::triangle {

/// Three places among the vertices.
using Face = std::array<std::uint32_t, 3>;

inline Triangle<double> corners_of(const Face& face, const std::vector<Vec<double>>& vertices) {
    return {vertices[face[0]], vertices[face[1]], vertices[face[2]]};
}

/// Triangles that share vertices. Vertices are the ideal numbers of the scene, in binary64. Faces whose corners lie on
/// one line are no triangles: they are left out and counted.
struct Mesh {
    static constexpr Shape shape = Shape::triangle;

    std::vector<Vec<double>> vertices;
    std::vector<Face> faces;
    std::size_t left_out = 0;    ///< faces without area
    std::string first_left_out;  ///< which of them was the first, in words; empty where there is none
    /// Of each face, whether one of its edges has no other face across; `tidy` fills it.
    std::vector<bool> borders;

    [[nodiscard]] Triangle<double> triangle(std::size_t face) const { return corners_of(faces[face], vertices); }
    [[nodiscard]] bool share_a_vertex(std::size_t face, std::size_t other) const {
        for (const std::uint32_t a : faces[face])
            for (const std::uint32_t b : faces[other])
                if (a == b) return true;
        return false;
    }
    [[nodiscard]] bool has_border(std::size_t face) const { return borders[face]; }
};

/// Vertices with the same coordinates become one (0 and −0 are the same), so that faces which meet share their edge;
/// faces whose corners lie on one line are left out, and `borders` is filled. `place(face)` names a face of the mesh as
/// it is given. Throws Interrupted, and leaves a mesh of no use, where it is asked to stop.
void tidy(Mesh& mesh, const std::function<std::string(std::size_t)>& place, intersect::process::StopToken stop = {});

/// An edge of two faces.
struct SharedEdge {
    std::array<std::uint32_t, 2> ends;   ///< places among the vertices
    std::array<std::uint32_t, 2> faces;  ///< in rising order
};
/// Every edge of exactly two faces, by its ends. O(n log n) for n faces.
std::vector<SharedEdge> shared_edges(const Mesh& mesh);

/// All of them as one, in their order.
Mesh joined(std::vector<Mesh> meshes);

/// The faces that lie on one line once the vertices are rounded to a format: no ray meets them truly.
std::size_t flat_faces(const Mesh& mesh, const FloatFormat& format);

/// What whoever gave the mesh should know of faces without area, as sentences; `stored` absent: its vertices stay as
/// they are.
std::vector<std::string> remarks_on(const Mesh& mesh, const std::optional<FloatFormat>& stored);

/// How a mesh is read.
struct MeshTerms {
    intersect::process::StopToken stop = {};
    FloatFormat stored = binary64;  ///< to which the scene rounds its vertices before any form sees them
};

/// Why a scene cannot hold such a number of a vertex, as a sentence goes on behind "which"; empty where it can.
std::string_view fault_of_coordinate(double x, const FloatFormat& stored);

/// Reads a `[[mesh]]`: `make` with the keys of what is made, or `file`, which is looked for from `folder`. InputError
/// with a position.
Mesh read_mesh_table(toml::TableReader& table, const std::filesystem::path& folder, const MeshTerms& terms = {});

}  // namespace lostbits::scene::triangle
