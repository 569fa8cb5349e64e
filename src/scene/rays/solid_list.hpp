// The solids of a picture as numbers, a flake of millions of spheres among them: held once, shared by all formats.
#pragma once

#include <array>
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
#include "shapes/solid.hpp"

namespace lostbits::scene::rays {

/// The spheres of a flake, structure of arrays: the centres' x, y, z and the radii. 16 bytes a sphere where inputs are
/// shared, which are numbers of binary32, and 32 where each format rounds its own.
class SphereColumns {
public:
    SphereColumns(const sphere::Sphereflake& flake, file::Inputs inputs);

    [[nodiscard]] std::size_t size() const {
        return std::visit([](const auto& columns) { return columns[0].size(); }, columns_);
    }
    [[nodiscard]] Solid<double> operator[](std::size_t i) const {
        Solid<double> solid(sphere::Sphereflake::shape);
        std::visit(
            [&](const auto& columns) {
                for (std::size_t k = 0; k < columns.size(); ++k) solid.numbers[k] = columns[k][i];
            },
            columns_);
        return solid;
    }
    /// The columns as they are stored; nothing where they are stored in the other type.
    template <class T>
    [[nodiscard]] const std::array<std::vector<T>, 4>* stored() const {
        return std::get_if<std::array<std::vector<T>, 4>>(&columns_);
    }

private:
    std::variant<std::array<std::vector<float>, 4>, std::array<std::vector<double>, 4>> columns_;
};

/// The triangles of a scene's meshes: the vertices and the matrix as numbers of binary32 where inputs are shared, else
/// as they are.
class MeshColumns {
public:
    MeshColumns(std::shared_ptr<const triangle::Mesh> mesh, std::optional<Placement<double>> placed,
                file::Inputs inputs);

    [[nodiscard]] std::size_t size() const { return mesh_->faces.size(); }
    [[nodiscard]] Solid<double> operator[](std::size_t i) const {
        Solid<double> triangle = triangle::corners_of(mesh_->faces[i], vertices_);
        triangle.placed = placed_;
        return triangle;
    }
    [[nodiscard]] const triangle::Mesh& mesh() const { return *mesh_; }

private:
    std::shared_ptr<const triangle::Mesh> mesh_;
    std::vector<Vec<double>> vertices_;
    std::optional<Placement<double>> placed_;
};

/// Solids in storage type S: first those that stand in memory one by one, then perhaps the spheres of a flake and the
/// triangles of meshes. Copies share what was made.
template <class S>
class SolidList {
public:
    SolidList() = default;
    SolidList(std::vector<Solid<S>> listed) : listed_(std::move(listed)) {}
    /// What a scene has beside the solids that it lists; null where it has none. `inputs` of both.
    struct Made {
        std::shared_ptr<const SphereColumns> flake;
        std::shared_ptr<const MeshColumns> mesh;
        file::Inputs inputs = file::Inputs::shared;
    };
    /// `format` absent: the numbers of what was made are taken as they are.
    SolidList(std::vector<Solid<S>> listed, Made made, std::optional<FloatFormat> format = std::nullopt)
        : listed_(std::move(listed)), made_(std::move(made)), format_(format) {}

    [[nodiscard]] std::size_t size() const { return first_of_mesh() + (made_.mesh ? made_.mesh->size() : 0); }
    [[nodiscard]] Solid<S> operator[](std::size_t i) const {
        if (i < listed_.size()) return listed_[i];
        const std::size_t triangles = first_of_mesh();
        return transformed(i < triangles ? (*made_.flake)[i - listed_.size()] : (*made_.mesh)[i - triangles],
                           [this](double x) { return S(rounded(x)); });
    }
    [[nodiscard]] const Made& made() const { return made_; }
    /// The triangles of meshes, where there are some.
    [[nodiscard]] const MeshColumns* mesh() const { return made_.mesh.get(); }
    /// The place of the first of them.
    [[nodiscard]] std::size_t first_of_mesh() const { return listed_.size() + (made_.flake ? made_.flake->size() : 0); }
    [[nodiscard]] bool all_listed() const { return size() == listed_.size(); }
    /// Without what was made.
    [[nodiscard]] std::span<const Solid<S>> listed() const { return listed_; }
    [[nodiscard]] const std::shared_ptr<const SphereColumns>& flake() const { return made_.flake; }
    /// One by one in memory, those that were made as well.
    [[nodiscard]] std::vector<Solid<S>> all() const {
        std::vector<Solid<S>> every = listed_;
        every.reserve(size());
        for (std::size_t i = every.size(); i < size(); ++i) every.push_back((*this)[i]);
        return every;
    }

    /// The numbers of spheres begin to begin + count, as columns of T: where they are stored, or in `room`.
    template <class T>
    [[nodiscard]] std::array<std::span<const T>, 4> columns(std::size_t begin, std::size_t count,
                                                            std::array<std::vector<T>, 4>& room) const {
        std::array<std::span<const T>, 4> view;
        if (const auto* stored = made_.flake && !format_ ? made_.flake->template stored<T>() : nullptr;
            stored && begin >= listed_.size()) {
            for (std::size_t k = 0; k < 4; ++k)
                view[k] = std::span((*stored)[k]).subspan(begin - listed_.size(), count);
            return view;
        }
        for (std::size_t k = 0; k < 4; ++k) room[k].resize(count);
        for (std::size_t i = 0; i < count; ++i) {
            const Solid<S> sphere = (*this)[begin + i];
            for (std::size_t k = 0; k < 4; ++k) room[k][i] = static_cast<T>(sphere.numbers[k]);
        }
        for (std::size_t k = 0; k < 4; ++k) view[k] = room[k];
        return view;
    }

private:
    [[nodiscard]] double rounded(double x) const { return format_ ? rounding::to_format(x, 0, *format_) : x; }

    std::vector<Solid<S>> listed_;
    Made made_;
    std::optional<FloatFormat> format_;
};

/// As `shared_solids`, what is made as columns; and its parts, those that the file lists and its meshes.
SolidList<double> shared_solid_list(const file::Scene& scene);
std::vector<Solid<double>> shared_listed(const file::Scene& scene);
std::shared_ptr<const MeshColumns> shared_mesh(const file::Scene& scene);
SolidList<double> solid_list_of(const RayGroup& group);
/// The ideal solids of a scene with own inputs, what is made as columns.
SolidList<Real> ideal_solid_list(const file::Scene& scene);

/// Every number rounded once to F.
SolidList<double> round_solids(const SolidList<double>& solids, const FloatFormat& f);
SolidList<double> round_solids(const SolidList<Real>& solids, const FloatFormat& f);

}  // namespace lostbits::scene::rays
