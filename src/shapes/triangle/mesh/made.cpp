#include "shapes/triangle/mesh/made.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace lostbits::scene::triangle {

namespace {

Vec<double> normalise(const Vec<double>& v) { return v / length(v); }

/// Returns point i of n on the unit circle, counted from x. n is a multiple of four. In each quarter, t = tan(a/2) of
/// the angle a goes from 0 to 1 in equal steps, and the point is ((1 − t²)/(1 + t²), 2t/(1 + t²)), so no sine is
/// needed. The steps of the angle at the start of a quarter are up to twice as long as at its end.
Vec<double> point_on_circle(std::uint32_t i, std::uint32_t n) {
    const std::uint32_t quarter_size = n / 4, quarter_index = i / quarter_size % 4;
    const double t = static_cast<double>(i % quarter_size) / quarter_size, x = (1 - t * t) / (1 + t * t),
                 y = 2 * t / (1 + t * t);
    switch (quarter_index) {
        case 0: return {x, y, 0};
        case 1: return {-y, x, 0};
        case 2: return {-x, -y, 0};
        default: return {y, -x, 0};
    }
}

/// Adds two triangles with the corners (i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1) of a grid.
template <class IndexAt>
void add_square(Mesh& mesh, const IndexAt& index_at, std::uint32_t i, std::uint32_t j) {
    mesh.faces.push_back({index_at(i, j), index_at(i + 1, j), index_at(i + 1, j + 1)});
    mesh.faces.push_back({index_at(i, j), index_at(i + 1, j + 1), index_at(i, j + 1)});
}

/// Makes an icosahedron with its vertices on the unit sphere.
Mesh make_icosahedron() {
    Mesh mesh;
    const double golden_ratio = (1 + std::sqrt(5.0)) / 2;
    mesh.vertices = {{-1, golden_ratio, 0}, {1, golden_ratio, 0}, {-1, -golden_ratio, 0}, {1, -golden_ratio, 0},
                     {0, -1, golden_ratio}, {0, 1, golden_ratio}, {0, -1, -golden_ratio}, {0, 1, -golden_ratio},
                     {golden_ratio, 0, -1}, {golden_ratio, 0, 1}, {-golden_ratio, 0, -1}, {-golden_ratio, 0, 1}};
    for (Vec<double>& v : mesh.vertices) v = normalise(v);
    mesh.faces = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                  {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                  {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    return mesh;
}

/// Divides each triangle into four, with new vertices on the unit sphere above the middles of the edges.
void divide_faces(Mesh& mesh) {
    std::unordered_map<std::uint64_t, std::uint32_t> middle_indices;
    middle_indices.reserve(mesh.faces.size() * 3 / 2);
    const auto middle_index = [&](std::uint32_t a, std::uint32_t b) {
        const std::uint64_t edge = (std::uint64_t{std::min(a, b)} << 32) | std::max(a, b);
        const auto [entry, is_new] = middle_indices.try_emplace(edge, static_cast<std::uint32_t>(mesh.vertices.size()));
        if (is_new) mesh.vertices.push_back(normalise(mesh.vertices[a] + mesh.vertices[b]));
        return entry->second;
    };

    std::vector<Face> finer_faces;
    finer_faces.reserve(4 * mesh.faces.size());
    for (const auto& [a, b, c] : mesh.faces) {
        const std::uint32_t ab = middle_index(a, b), bc = middle_index(b, c), ca = middle_index(c, a);
        finer_faces.insert(finer_faces.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    mesh.faces = std::move(finer_faces);
}

}  // namespace

Mesh make_icosphere(int level_count, const Vec<double>& centre, double radius) {
    Mesh mesh = make_icosahedron();
    for (int level = 0; level < level_count; ++level) divide_faces(mesh);
    for (Vec<double>& v : mesh.vertices) v = centre + radius * v;
    return mesh;
}

Mesh make_grid(std::uint32_t across, std::uint32_t up, const Vec<double>& centre, const Vec<double>& size,
               double bump) {
    Mesh mesh;
    for (std::uint32_t j = 0; j <= up; ++j) {
        for (std::uint32_t i = 0; i <= across; ++i) {
            const double x = static_cast<double>(i) / across - 0.5, y = static_cast<double>(j) / up - 0.5;
            mesh.vertices.push_back(centre +
                                    Vec<double>(size.x * x, size.y * y, bump * (1 - 4 * x * x) * (1 - 4 * y * y)));
        }
    }
    const auto index_at = [across](std::uint32_t i, std::uint32_t j) { return j * (across + 1) + i; };
    for (std::uint32_t j = 0; j < up; ++j)
        for (std::uint32_t i = 0; i < across; ++i) add_square(mesh, index_at, i, j);
    return mesh;
}

Mesh make_tube(std::uint32_t around, std::uint32_t along, const Vec<double>& centre, double ring_radius,
               double radius) {
    Mesh mesh;
    for (std::uint32_t j = 0; j < along; ++j) {
        const Vec<double> outward = point_on_circle(j, along);
        for (std::uint32_t i = 0; i < around; ++i) {
            const Vec<double> p = point_on_circle(i, around);
            mesh.vertices.push_back(centre + (ring_radius + radius * p.x) * outward + Vec<double>(0, 0, radius * p.y));
        }
    }
    const auto index_at = [around, along](std::uint32_t i, std::uint32_t j) { return j % along * around + i % around; };
    for (std::uint32_t j = 0; j < along; ++j)
        for (std::uint32_t i = 0; i < around; ++i) add_square(mesh, index_at, i, j);
    // Make the faces wind outward.
    for (Face& face : mesh.faces) std::swap(face[1], face[2]);
    return mesh;
}

Mesh make_fan(std::uint32_t count, const Vec<double>& centre, double radius) {
    Mesh mesh;
    mesh.vertices.push_back(centre);
    for (std::uint32_t i = 0; i < count; ++i) mesh.vertices.push_back(centre + radius * point_on_circle(i, count));
    for (std::uint32_t i = 0; i < count; ++i) mesh.faces.push_back({0, 1 + i, 1 + (i + 1) % count});
    return mesh;
}

}  // namespace lostbits::scene::triangle
