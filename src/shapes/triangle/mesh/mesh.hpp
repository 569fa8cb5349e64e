// Meshes of triangles that are made by formula or read from files.
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
#include "shapes/primitive.hpp"

namespace lostbits::scene::triangle {

/// Three indices of vertices.
using Face = std::array<std::uint32_t, 3>;

inline Triangle<double> corners_of(const Face& face, const std::vector<Vec<double>>& vertices) {
    return {vertices[face[0]], vertices[face[1]], vertices[face[2]]};
}

/// Counts of edges and faces, most of which show that a mesh is not closed. Faces without area are left out, so their
/// edges count as open.
struct MeshCounts {
    std::size_t edges = 0;
    std::size_t border_edges = 0;        ///< edges of one face
    std::size_t non_manifold_edges = 0;  ///< edges of more than two faces
    std::size_t unbalanced_edges = 0;    ///< edges that more faces traverse in one direction than in the other
    std::size_t odd_edges = 0;           ///< edges with an odd number of faces
    std::size_t duplicate_faces = 0;     ///< faces with the same three vertices as an earlier face
};

/// Triangles that share vertices. Vertices are the ideal numbers of the scene, in binary64. Faces whose corners lie on
/// one line are not triangles, so they are removed and counted.
struct Mesh {
    static constexpr Shape shape = Shape::triangle;

    std::vector<Vec<double>> vertices;
    std::vector<Face> faces;
    std::size_t removed_face_count = 0;  ///< faces without area
    std::string first_removed_face;      ///< describes the first face without area; empty if every face has one
    MeshCounts counts;                   ///< counts over all faces; filled by `merge_and_count`
    /// For each face, bit k is 1 if the edge opposite to its corner k has no other face; filled by `merge_and_count`.
    std::vector<std::uint8_t> borders;

    [[nodiscard]] Triangle<double> triangle(std::size_t face) const { return corners_of(faces[face], vertices); }
    [[nodiscard]] bool share_a_vertex(std::size_t face, std::size_t other) const {
        for (const std::uint32_t a : faces[face])
            for (const std::uint32_t b : faces[other])
                if (a == b) return true;
        return false;
    }
    [[nodiscard]] bool has_border(std::size_t face) const { return borders[face] != 0; }
    /// True if the edge opposite to corner k of the face has no other face.
    [[nodiscard]] bool is_border(std::size_t face, std::size_t k) const { return (borders[face] >> k & 1U) != 0; }
};

/// Merges vertices with the same coordinates (0 and −0 are the same), so that faces which meet share their edge.
/// Removes faces whose corners lie on one line, and fills `counts` and `borders`. `describe_face(face)` describes a
/// face of the mesh as it was given. Throws Interrupted if it is stopped, and then leaves an unusable mesh.
void merge_and_count(Mesh& mesh, const std::function<std::string(std::size_t)>& describe_face,
                     intersect::process::StopToken stop = {});

/// An edge that two faces share.
struct SharedEdge {
    std::array<std::uint32_t, 2> ends;   ///< indices of vertices
    std::array<std::uint32_t, 2> faces;  ///< in ascending order
};
/// Returns every edge of exactly two faces, ordered by its ends.
std::vector<SharedEdge> find_shared_edges(const Mesh& mesh);

/// Joins the meshes into one, in their order.
Mesh join_meshes(std::vector<Mesh> meshes);

/// Counts the faces that lie on one line once the vertices are rounded to a format. No ray meets such a face.
std::size_t count_flat_faces(const Mesh& mesh, const FloatFormat& format);

/// Returns remarks for the author of the mesh about faces without area, as sentences. If `vertex_format` is absent, the
/// vertices are not rounded.
std::vector<std::string> find_mesh_remarks(const Mesh& mesh, const std::optional<FloatFormat>& vertex_format);

/// Settings with which a mesh is read.
struct MeshSettings {
    intersect::process::StopToken stop = {};
    FloatFormat vertex_format = binary64;  ///< the format to which the scene rounds its vertices, before any form runs
};

/// Returns why a scene cannot hold a coordinate of a vertex, as the rest of a sentence after "which"; empty if it can.
std::string_view reason_to_refuse_coordinate(double x, const FloatFormat& vertex_format);

/// Reads a `[[mesh]]`: `make` with the keys of that mesh, or `file`, relative to `folder`. Throws InputError with a
/// position.
Mesh read_mesh_table(toml::TableReader& table, const std::filesystem::path& folder, const MeshSettings& settings = {});

}  // namespace lostbits::scene::triangle
