// Stores the primitives of a picture as numbers, once for all formats. They may include a flake of millions of spheres.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "number/format.hpp"
#include "number/real.hpp"
#include "number/rounded.hpp"
#include "scene/file/scene.hpp"
#include "scene/rays/rays.hpp"
#include "shapes/primitive.hpp"

namespace lostbits::scene::rays {

/// The spheres of a flake, as a structure of arrays: x, y, z of the centres and the radii. A sphere takes 16 bytes if
/// inputs are shared, since these are numbers of binary32, and 32 bytes if each format rounds its own inputs.
class SphereColumns {
public:
    SphereColumns(const sphere::Sphereflake& flake, file::InputRounding inputs);

    [[nodiscard]] std::size_t size() const {
        return std::visit([](const auto& columns) { return columns[0].size(); }, columns_);
    }
    [[nodiscard]] Primitive<double> operator[](std::size_t i) const {
        Primitive<double> primitive(sphere::Sphereflake::shape);
        std::visit(
            [&](const auto& columns) {
                for (std::size_t k = 0; k < columns.size(); ++k) primitive.numbers[k] = columns[k][i];
            },
            columns_);
        return primitive;
    }
    /// The columns as they are stored; null if they are stored in the other type.
    template <class T>
    [[nodiscard]] const std::array<std::vector<T>, 4>* stored_columns() const {
        return std::get_if<std::array<std::vector<T>, 4>>(&columns_);
    }

private:
    std::variant<std::array<std::vector<float>, 4>, std::array<std::vector<double>, 4>> columns_;
};

/// The triangles of a scene's meshes. The vertices and the matrix are numbers of binary32 if inputs are shared, else
/// unrounded.
class StoredMesh {
public:
    StoredMesh(std::shared_ptr<const triangle::Mesh> mesh, std::optional<Transform<double>> transform,
               file::InputRounding inputs);

    [[nodiscard]] std::size_t size() const { return mesh_->faces.size(); }
    [[nodiscard]] Primitive<double> operator[](std::size_t i) const {
        Primitive<double> triangle = triangle::corners_of(mesh_->faces[i], vertices_);
        triangle.transform = transform_;
        return triangle;
    }
    [[nodiscard]] const triangle::Mesh& mesh() const { return *mesh_; }
    /// Loads triangles into the cache. `triangles` lists indices; those from `first` on are loaded.
    void prefetch(std::span<const std::uint32_t> triangles, std::size_t first) const;

private:
    std::shared_ptr<const triangle::Mesh> mesh_;
    std::vector<Vec<double>> vertices_;
    std::optional<Transform<double>> transform_;
};

/// Primitives in storage type S: first those that are stored one by one, then the spheres of a flake and the triangles
/// of meshes, if any. Copies share the flake and the meshes.
template <class S>
class PrimitiveList {
public:
    PrimitiveList() = default;
    PrimitiveList(std::vector<Primitive<S>> listed) : listed_(std::move(listed)) {}
    /// The flake and the meshes of a scene; null if it has none. `inputs` applies to both.
    struct FlakeAndMesh {
        std::shared_ptr<const SphereColumns> flake;
        std::shared_ptr<const StoredMesh> mesh;
        file::InputRounding inputs = file::InputRounding::shared;
    };
    /// If `format` is absent, the numbers of the flake and the meshes are not rounded.
    PrimitiveList(std::vector<Primitive<S>> listed, FlakeAndMesh flake_and_mesh,
                  std::optional<FloatFormat> format = std::nullopt)
        : listed_(std::move(listed)), flake_and_mesh_(std::move(flake_and_mesh)), format_(format) {}

    [[nodiscard]] std::size_t size() const {
        return first_triangle_index() + (flake_and_mesh_.mesh ? flake_and_mesh_.mesh->size() : 0);
    }
    [[nodiscard]] Primitive<S> operator[](std::size_t i) const {
        if (i < listed_.size()) return listed_[i];
        const std::size_t first_triangle = first_triangle_index();
        return convert_numbers(i < first_triangle ? (*flake_and_mesh_.flake)[i - listed_.size()]
                                                  : (*flake_and_mesh_.mesh)[i - first_triangle],
                               [this](double x) { return S(round_if_needed(x)); });
    }
    /// Loads primitives that will soon be needed into the cache. In a large mesh this is several times as fast as
    /// waiting for each primitive.
    void prefetch(std::span<const std::uint32_t> primitives) const {
        if (flake_and_mesh_.mesh) flake_and_mesh_.mesh->prefetch(primitives, first_triangle_index());
    }
    [[nodiscard]] const FlakeAndMesh& flake_and_mesh() const { return flake_and_mesh_; }
    /// The triangles of meshes; null if the scene has no mesh.
    [[nodiscard]] const StoredMesh* mesh() const { return flake_and_mesh_.mesh.get(); }
    /// Index of the first triangle.
    [[nodiscard]] std::size_t first_triangle_index() const {
        return listed_.size() + (flake_and_mesh_.flake ? flake_and_mesh_.flake->size() : 0);
    }
    [[nodiscard]] bool all_listed() const { return size() == listed_.size(); }
    /// The primitives without flake and meshes.
    [[nodiscard]] std::span<const Primitive<S>> listed_primitives() const { return listed_; }
    [[nodiscard]] const std::shared_ptr<const SphereColumns>& flake() const { return flake_and_mesh_.flake; }
    /// All primitives one by one, including the flake and the meshes.
    [[nodiscard]] std::vector<Primitive<S>> all() const {
        std::vector<Primitive<S>> primitives = listed_;
        primitives.reserve(size());
        for (std::size_t i = primitives.size(); i < size(); ++i) primitives.push_back((*this)[i]);
        return primitives;
    }

    /// The numbers of the spheres from begin to begin + count, as columns of T: a view of the stored columns, or of
    /// `columns_of_spheres`, to which they are copied.
    template <class T>
    [[nodiscard]] std::array<std::span<const T>, 4> columns(std::size_t begin, std::size_t count,
                                                            std::array<std::vector<T>, 4>& columns_of_spheres) const {
        std::array<std::span<const T>, 4> view;
        if (const auto* stored =
                flake_and_mesh_.flake && !format_ ? flake_and_mesh_.flake->template stored_columns<T>() : nullptr;
            stored && begin >= listed_.size()) {
            for (std::size_t k = 0; k < 4; ++k)
                view[k] = std::span((*stored)[k]).subspan(begin - listed_.size(), count);
            return view;
        }
        for (std::size_t k = 0; k < 4; ++k) columns_of_spheres[k].resize(count);
        for (std::size_t i = 0; i < count; ++i) {
            const Primitive<S> sphere = (*this)[begin + i];
            for (std::size_t k = 0; k < 4; ++k) columns_of_spheres[k][i] = static_cast<T>(sphere.numbers[k]);
        }
        for (std::size_t k = 0; k < 4; ++k) view[k] = columns_of_spheres[k];
        return view;
    }

private:
    [[nodiscard]] double round_if_needed(double x) const { return format_ ? rounding::to_format(x, 0, *format_) : x; }

    std::vector<Primitive<S>> listed_;
    FlakeAndMesh flake_and_mesh_;
    std::optional<FloatFormat> format_;
};

/// The primitives of `make_shared_primitives`, with flake and meshes as columns.
PrimitiveList<double> make_shared_primitive_list(const file::Scene& scene);
/// The listed primitives of a scene with shared inputs, rounded to binary32.
std::vector<Primitive<double>> round_listed_primitives(const file::Scene& scene);
/// The meshes of a scene with shared inputs, rounded to binary32; null if the scene has none.
std::shared_ptr<const StoredMesh> make_shared_mesh(const file::Scene& scene);
/// The primitives of a group. Their numbers are those of the group.
PrimitiveList<double> primitive_list_of(const RayGroup& group);
/// The ideal primitives of a scene with own inputs, with flake and meshes as columns.
PrimitiveList<Real> make_ideal_primitive_list(const file::Scene& scene);

/// Rounds every number once to F.
PrimitiveList<double> round_primitives(const PrimitiveList<double>& primitives, const FloatFormat& format);
PrimitiveList<double> round_primitives(const PrimitiveList<Real>& primitives, const FloatFormat& format);

}  // namespace lostbits::scene::rays
