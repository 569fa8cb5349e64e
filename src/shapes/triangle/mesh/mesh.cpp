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

/// An edge with its lower end first, and one of its faces.
struct Edge {
    std::uint32_t low, high, face;
};

using intersect::process::StopToken;

/// Compares by a key, and checks the stop token at each comparison, because sorting millions takes seconds.
template <class Key>
auto by(const Key& key, StopToken stop) {
    return [key, stop](const auto& a, const auto& b) {
        stop.check();
        return key(a) < key(b);
    };
}

/// The edges of all faces, ordered by their ends: put into buckets by the lower end, as a vertex has few edges, and
/// sorted in these.
std::vector<Edge> sorted_edges(const Mesh& mesh, StopToken stop) {
    std::vector<std::size_t> ends(mesh.vertices.size() + 1);  // of each bucket; while it is filled, its next place
    const auto for_each = [&mesh](const auto& take) {
        for (std::size_t f = 0; f < mesh.faces.size(); ++f)
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t from = mesh.faces[f][k], to = mesh.faces[f][(k + 1) % 3];
                take(Edge{std::min(from, to), std::max(from, to), static_cast<std::uint32_t>(f)});
            }
    };
    for_each([&](const Edge& e) { ++ends[e.low + 1]; });
    std::partial_sum(ends.begin(), ends.end(), ends.begin());
    std::vector<Edge> edges(3 * mesh.faces.size());
    for_each([&](const Edge& e) { edges[ends[e.low]++] = e; });
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
        std::sort(edges.begin() + static_cast<std::ptrdiff_t>(v == 0 ? 0 : ends[v - 1]),
                  edges.begin() + static_cast<std::ptrdiff_t>(ends[v]),
                  by([](const Edge& e) { return std::pair(e.high, e.face); }, stop));
    return edges;
}

/// Calls `take(edges)` for each edge, with all of its faces.
template <class Take>
void for_each_edge(const Mesh& mesh, const Take& take, StopToken stop = {}) {
    const std::vector<Edge> edges = sorted_edges(mesh, stop);
    for (auto first = edges.begin(), last = first; first != edges.end(); first = last) {
        const auto same = [&](const Edge& e) { return e.low == first->low && e.high == first->high; };
        last = std::find_if_not(first, edges.end(), same);
        take(std::span(first, last));
    }
}

void merge_vertices(Mesh& mesh, StopToken stop) {
    std::vector<std::uint32_t> order(mesh.vertices.size()), becomes(mesh.vertices.size());
    std::iota(order.begin(), order.end(), 0U);
    const auto key = [&](std::uint32_t v) {
        const Vec<double>& p = mesh.vertices[v];
        return std::array{p.x, p.y, p.z};  // −0 and 0 compare equal
    };
    std::ranges::stable_sort(order, by(key, stop));
    for (std::size_t i = 0; i < order.size(); ++i)
        becomes[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? becomes[order[i - 1]] : order[i];
    std::vector<std::uint32_t> place(mesh.vertices.size());
    std::uint32_t kept = 0;
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
        if (becomes[v] != v) continue;
        place[v] = kept;
        mesh.vertices[kept++] = mesh.vertices[v];
    }
    mesh.vertices.resize(kept);
    for (Face& face : mesh.faces)
        for (std::uint32_t& v : face) v = place[becomes[v]];
}

bool is_flat(const Vec<double>& a, const Vec<double>& b, const Vec<double>& c) { return on_one_line(a, b, c); }

/// The smallest number that a format rounds to infinity: half an ulp above its largest number.
double overflow_of(const FloatFormat& format) {
    return std::ldexp(2 - std::ldexp(1.0, -format.precision), format.emax);
}

/// The corner of a face that is not an end of one of its edges, 0, 1 or 2.
std::size_t opposite_corner(const Face& face, const Edge& edge) {
    const auto is_end = [&edge](std::uint32_t v) { return v == edge.low || v == edge.high; };
    return static_cast<std::size_t>(std::ranges::find_if_not(face, is_end) - face.begin());
}

/// Number of faces that have the same third vertex as an earlier one at an edge. Only faces whose third vertex is the
/// highest count, so that a face counts at one of its edges.
std::size_t duplicates_at(const Mesh& mesh, std::span<const Edge> of, std::vector<std::uint32_t>& thirds) {
    thirds.clear();
    for (const Edge& edge : of) {
        const Face& face = mesh.faces[edge.face];
        const std::uint32_t third = face[opposite_corner(face, edge)];
        if (third > edge.high) thirds.push_back(third);
    }
    std::ranges::sort(thirds);
    return thirds.size() - static_cast<std::size_t>(std::unique(thirds.begin(), thirds.end()) - thirds.begin());
}

/// Fills `edges` and `borders`.
void count_edges(Mesh& mesh, StopToken stop) {
    mesh.edges = {};
    mesh.borders.assign(mesh.faces.size(), 0);
    std::vector<std::uint32_t> thirds;
    const auto count = [&](std::span<const Edge> of) {
        stop.check();
        std::ptrdiff_t balance = 0;
        for (const Edge& edge : of) {
            const Face& face = mesh.faces[edge.face];
            const std::size_t opposite = opposite_corner(face, edge);
            balance += face[(opposite + 1) % 3] == edge.low ? 1 : -1;
            if (of.size() == 1) mesh.borders[edge.face] |= static_cast<std::uint8_t>(1U << opposite);
        }
        MeshEdges& found = mesh.edges;
        ++found.edges;
        found.border += of.size() == 1, found.non_manifold += of.size() > 2;
        found.unbalanced += balance != 0, found.odd += of.size() % 2;
        if (of.size() > 1) found.duplicates += duplicates_at(mesh, of, thirds);
    };
    for_each_edge(mesh, count, stop);
}

}  // namespace

std::string_view fault_of_coordinate(double x, const FloatFormat& stored) {
    if (std::fabs(x) <= std::numeric_limits<float>::max()) return {};  // stored is binary32 or wider
    if (!std::isfinite(x)) return "is not finite; a vertex has finite numbers";
    if (std::fabs(x) < overflow_of(stored)) return {};
    return "overflows binary32, to which inputs = \"shared\" rounds; scale the mesh, or write inputs = \"own\"";
}

void tidy(Mesh& mesh, const std::function<std::string(std::size_t)>& place, StopToken stop) {
    merge_vertices(mesh, stop);
    std::size_t kept = 0;
    for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
        stop.check();
        const auto& [a, b, c] = mesh.faces[f];
        if (is_flat(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c])) {
            if (mesh.left_out++ == 0) mesh.first_left_out = place(f);
            continue;
        }
        mesh.faces[kept++] = mesh.faces[f];
    }
    mesh.faces.resize(kept);
    count_edges(mesh, stop);
}

std::vector<SharedEdge> shared_edges(const Mesh& mesh) {
    std::vector<SharedEdge> found;
    for_each_edge(mesh, [&](std::span<const Edge> of) {
        if (of.size() == 2)
            found.push_back(
                {{of[0].low, of[0].high}, {std::min(of[0].face, of[1].face), std::max(of[0].face, of[1].face)}});
    });
    return found;
}

Mesh joined(std::vector<Mesh> meshes) {
    Mesh all = std::move(meshes.front());
    for (std::size_t i = 1; i < meshes.size(); ++i) {
        const Mesh& next = meshes[i];
        const auto first = static_cast<std::uint32_t>(all.vertices.size());
        all.vertices.insert(all.vertices.end(), next.vertices.begin(), next.vertices.end());
        for (const auto& [a, b, c] : next.faces) all.faces.push_back({first + a, first + b, first + c});
        all.borders.insert(all.borders.end(), next.borders.begin(), next.borders.end());
        for (const auto count : {&MeshEdges::edges, &MeshEdges::border, &MeshEdges::non_manifold,
                                 &MeshEdges::unbalanced, &MeshEdges::odd, &MeshEdges::duplicates})
            all.edges.*count += next.edges.*count;
        if (all.left_out == 0) all.first_left_out = next.first_left_out;
        all.left_out += next.left_out;
    }
    return all;
}

std::size_t flat_faces(const Mesh& mesh, const FloatFormat& format) {
    const auto rounded = [&](std::uint32_t v) {
        Vec<double> p = mesh.vertices[v];
        for (int k = 0; k < 3; ++k) p[k] = rounding::to_format(p[k], 0, format);
        return p;
    };
    return static_cast<std::size_t>(std::ranges::count_if(
        mesh.faces, [&](const Face& f) { return is_flat(rounded(f[0]), rounded(f[1]), rounded(f[2])); }));
}

std::vector<std::string> remarks_on(const Mesh& mesh, const std::optional<FloatFormat>& stored) {
    std::vector<std::string> remarks;
    if (mesh.left_out > 0)
        remarks.push_back(std::to_string(mesh.left_out) + " of " + std::to_string(mesh.left_out + mesh.faces.size()) +
                          " faces of its meshes have no area and are left out; the first is " + mesh.first_left_out);
    const std::size_t flat = stored ? flat_faces(mesh, *stored) : 0;
    if (flat > 0)
        remarks.push_back(std::to_string(flat) + " of " + std::to_string(mesh.faces.size()) +
                          " faces of its meshes have no area once their vertices are rounded to " +
                          std::to_string(stored->precision) +
                          " bits, and no ray meets them; inputs = \"own\" keeps "
                          "them as they are");
    return remarks;
}

}  // namespace lostbits::scene::triangle
