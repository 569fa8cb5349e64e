#include "shapes/triangle/mesh/mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "number/rounded.hpp"
#include "shapes/on_one_line.hpp"

namespace lostbits::scene::triangle {

namespace {

/// An edge with its lower end first, and a face that has this edge.
struct EdgeOfFace {
    std::uint32_t low, high, face;
};

using intersect::process::StopToken;

/// Returns a function that compares elements by a key. It checks the stop token at each call, because sorting millions
/// of elements takes seconds.
template <class Key>
auto comparison_by(const Key& key, StopToken stop) {
    return [key, stop](const auto& a, const auto& b) {
        stop.check();
        return key(a) < key(b);
    };
}

/// Returns the edges of all faces, ordered by their ends. One bucket for each lower end holds the
/// edges, and each bucket is sorted, since a vertex has few edges.
std::vector<EdgeOfFace> sorted_edges(const Mesh& mesh, StopToken stop) {
    // While a bucket is filled, its end is the index of its next edge.
    std::vector<std::size_t> bucket_ends(mesh.vertices.size() + 1);
    const auto for_each_edge_of_face = [&mesh](const auto& visit) {
        for (std::size_t f = 0; f < mesh.faces.size(); ++f)
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t start = mesh.faces[f][k], end = mesh.faces[f][(k + 1) % 3];
                visit(EdgeOfFace{std::min(start, end), std::max(start, end), static_cast<std::uint32_t>(f)});
            }
    };
    for_each_edge_of_face([&](const EdgeOfFace& edge) { ++bucket_ends[edge.low + 1]; });
    std::partial_sum(bucket_ends.begin(), bucket_ends.end(), bucket_ends.begin());

    std::vector<EdgeOfFace> edges(3 * mesh.faces.size());
    for_each_edge_of_face([&](const EdgeOfFace& edge) { edges[bucket_ends[edge.low]++] = edge; });

    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
        std::sort(edges.begin() + static_cast<std::ptrdiff_t>(v == 0 ? 0 : bucket_ends[v - 1]),
                  edges.begin() + static_cast<std::ptrdiff_t>(bucket_ends[v]),
                  comparison_by([](const EdgeOfFace& edge) { return std::pair(edge.high, edge.face); }, stop));
    return edges;
}

/// Calls `visit(edge_faces)` for each edge, with one element for each of its faces.
template <class Visit>
void for_each_edge(const Mesh& mesh, const Visit& visit, StopToken stop = {}) {
    const std::vector<EdgeOfFace> edges = sorted_edges(mesh, stop);
    for (auto first = edges.begin(), last = first; first != edges.end(); first = last) {
        const auto is_same_edge = [&](const EdgeOfFace& edge) {
            return edge.low == first->low && edge.high == first->high;
        };
        last = std::find_if_not(first, edges.end(), is_same_edge);
        visit(std::span(first, last));
    }
}

void merge_vertices(Mesh& mesh, StopToken stop) {
    std::vector<std::uint32_t> order(mesh.vertices.size()), representative(mesh.vertices.size());
    std::iota(order.begin(), order.end(), 0U);
    const auto key = [&](std::uint32_t v) {
        const Vec<double>& p = mesh.vertices[v];
        return std::array{p.x, p.y, p.z};  // −0 and 0 compare equal
    };

    // Finds the first of all vertices at the same point.
    std::ranges::stable_sort(order, comparison_by(key, stop));
    for (std::size_t i = 0; i < order.size(); ++i)
        representative[order[i]] =
            i > 0 && key(order[i]) == key(order[i - 1]) ? representative[order[i - 1]] : order[i];

    // Keeps only these, in their order.
    std::vector<std::uint32_t> new_index(mesh.vertices.size());
    std::uint32_t kept_count = 0;
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
        if (representative[v] != v) continue;
        new_index[v] = kept_count;
        mesh.vertices[kept_count++] = mesh.vertices[v];
    }
    mesh.vertices.resize(kept_count);

    for (Face& face : mesh.faces)
        for (std::uint32_t& v : face) v = new_index[representative[v]];
}

/// Returns the smallest number that a format rounds to infinity: half an ulp above its largest number.
double overflow_threshold(const FloatFormat& format) {
    return std::ldexp(2 - std::ldexp(1.0, -format.precision), format.emax);
}

/// Returns the index, 0, 1 or 2, of the corner of a face that is not an end of the edge.
std::size_t opposite_corner(const Face& face, const EdgeOfFace& edge) {
    const auto is_end_of_edge = [&edge](std::uint32_t v) { return v == edge.low || v == edge.high; };
    return static_cast<std::size_t>(std::ranges::find_if_not(face, is_end_of_edge) - face.begin());
}

/// Returns the number of faces at an edge that have the same third vertex as an earlier face. It considers only faces
/// whose third vertex has the highest index, so that a face counts at only one of its edges.
std::size_t count_duplicates_at(const Mesh& mesh, std::span<const EdgeOfFace> edge_faces,
                                std::vector<std::uint32_t>& third_vertices) {
    third_vertices.clear();
    for (const EdgeOfFace& edge : edge_faces) {
        const Face& face = mesh.faces[edge.face];
        const std::uint32_t third_vertex = face[opposite_corner(face, edge)];
        if (third_vertex > edge.high) third_vertices.push_back(third_vertex);
    }
    std::ranges::sort(third_vertices);
    return third_vertices.size() -
           static_cast<std::size_t>(std::unique(third_vertices.begin(), third_vertices.end()) - third_vertices.begin());
}

/// Fills `counts` and `borders` of the mesh.
void count_edges_and_borders(Mesh& mesh, StopToken stop) {
    mesh.counts = {};
    mesh.borders.assign(mesh.faces.size(), 0);
    std::vector<std::uint32_t> third_vertices;
    const auto count_edge = [&](std::span<const EdgeOfFace> edge_faces) {
        stop.check();
        std::ptrdiff_t direction_balance = 0;
        for (const EdgeOfFace& edge : edge_faces) {
            const Face& face = mesh.faces[edge.face];
            const std::size_t corner = opposite_corner(face, edge);
            direction_balance += face[(corner + 1) % 3] == edge.low ? 1 : -1;
            if (edge_faces.size() == 1) mesh.borders[edge.face] |= static_cast<std::uint8_t>(1U << corner);
        }

        MeshCounts& counts = mesh.counts;
        ++counts.edges;
        counts.border_edges += edge_faces.size() == 1;
        counts.non_manifold_edges += edge_faces.size() > 2;
        counts.unbalanced_edges += direction_balance != 0;
        counts.odd_edges += edge_faces.size() % 2;
        if (edge_faces.size() > 1) counts.duplicate_faces += count_duplicates_at(mesh, edge_faces, third_vertices);
    };
    for_each_edge(mesh, count_edge, stop);
}

}  // namespace

std::string_view reason_to_refuse_coordinate(double x, const FloatFormat& vertex_format) {
    if (std::fabs(x) <= std::numeric_limits<float>::max()) return {};  // vertex_format is binary32 or wider
    if (!std::isfinite(x)) return "is not finite; a vertex has finite numbers";
    if (std::fabs(x) < overflow_threshold(vertex_format)) return {};
    return "overflows binary32, to which inputs = \"shared\" rounds; scale the mesh, or write inputs = \"own\"";
}

void merge_and_count(Mesh& mesh, const std::function<std::string(std::size_t)>& describe_face, StopToken stop) {
    merge_vertices(mesh, stop);
    std::size_t kept_count = 0;
    for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
        stop.check();
        const auto& [a, b, c] = mesh.faces[f];
        if (are_on_one_line(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c])) {
            if (mesh.removed_face_count++ == 0) mesh.first_removed_face = describe_face(f);
            continue;
        }
        mesh.faces[kept_count++] = mesh.faces[f];
    }
    mesh.faces.resize(kept_count);
    count_edges_and_borders(mesh, stop);
}

std::vector<SharedEdge> find_shared_edges(const Mesh& mesh) {
    std::vector<SharedEdge> edges_of_two_faces;
    for_each_edge(mesh, [&](std::span<const EdgeOfFace> edge_faces) {
        if (edge_faces.size() == 2)
            edges_of_two_faces.push_back(
                {{edge_faces[0].low, edge_faces[0].high},
                 {std::min(edge_faces[0].face, edge_faces[1].face), std::max(edge_faces[0].face, edge_faces[1].face)}});
    });
    return edges_of_two_faces;
}

Mesh join_meshes(std::vector<Mesh> meshes) {
    Mesh result = std::move(meshes.front());
    for (std::size_t i = 1; i < meshes.size(); ++i) {
        const Mesh& next = meshes[i];
        const auto vertex_offset = static_cast<std::uint32_t>(result.vertices.size());
        result.vertices.insert(result.vertices.end(), next.vertices.begin(), next.vertices.end());
        for (const auto& [a, b, c] : next.faces)
            result.faces.push_back({vertex_offset + a, vertex_offset + b, vertex_offset + c});
        result.borders.insert(result.borders.end(), next.borders.begin(), next.borders.end());
        for (const auto member : {&MeshCounts::edges, &MeshCounts::border_edges, &MeshCounts::non_manifold_edges,
                                  &MeshCounts::unbalanced_edges, &MeshCounts::odd_edges, &MeshCounts::duplicate_faces})
            result.counts.*member += next.counts.*member;
        if (result.removed_face_count == 0) result.first_removed_face = next.first_removed_face;
        result.removed_face_count += next.removed_face_count;
    }
    return result;
}

std::size_t count_flat_faces(const Mesh& mesh, const FloatFormat& format) {
    const auto rounded_vertex = [&](std::uint32_t v) {
        Vec<double> p = mesh.vertices[v];
        for (int k = 0; k < 3; ++k) p[k] = rounding::to_format(p[k], 0, format);
        return p;
    };
    return static_cast<std::size_t>(std::ranges::count_if(mesh.faces, [&](const Face& f) {
        return are_on_one_line(rounded_vertex(f[0]), rounded_vertex(f[1]), rounded_vertex(f[2]));
    }));
}

std::vector<std::string> find_mesh_remarks(const Mesh& mesh, const std::optional<FloatFormat>& vertex_format) {
    std::vector<std::string> remarks;
    if (mesh.removed_face_count > 0)
        remarks.push_back(std::to_string(mesh.removed_face_count) + " of " +
                          std::to_string(mesh.removed_face_count + mesh.faces.size()) +
                          " faces of its meshes have no area and are left out; the first is " +
                          mesh.first_removed_face);
    const std::size_t flat = vertex_format ? count_flat_faces(mesh, *vertex_format) : 0;
    if (flat > 0)
        remarks.push_back(std::to_string(flat) + " of " + std::to_string(mesh.faces.size()) +
                          " faces of its meshes have no area once their vertices are rounded to " +
                          std::to_string(vertex_format->precision) +
                          " bits, and no ray meets them; inputs = \"own\" keeps "
                          "them as they are");
    return remarks;
}

}  // namespace lostbits::scene::triangle
