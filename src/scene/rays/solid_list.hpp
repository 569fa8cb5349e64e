// The solids of a picture as numbers, a flake of millions of spheres among them: held once, shared by all formats.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "number/format.hpp"
#include "number/real.hpp"
#include "number/rounded.hpp"
#include "scene/file/scene.hpp"
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

/// Solids in storage type S: first those that stand in memory one by one, then perhaps the spheres of a flake. Copies
/// share the flake.
template <class S>
class SolidList {
public:
    SolidList() = default;
    SolidList(std::vector<Solid<S>> listed) : listed_(std::move(listed)) {}
    /// `format` absent: the numbers of the flake are taken as they are.
    SolidList(std::vector<Solid<S>> listed, std::shared_ptr<const SphereColumns> flake,
              std::optional<FloatFormat> format = std::nullopt)
        : listed_(std::move(listed)), flake_(std::move(flake)), format_(format) {}

    [[nodiscard]] std::size_t size() const { return listed_.size() + (flake_ ? flake_->size() : 0); }
    [[nodiscard]] Solid<S> operator[](std::size_t i) const {
        if (i < listed_.size()) return listed_[i];
        return transformed((*flake_)[i - listed_.size()], [this](double x) { return S(rounded(x)); });
    }
    /// Without the flake.
    [[nodiscard]] std::span<const Solid<S>> listed() const { return listed_; }
    [[nodiscard]] const std::shared_ptr<const SphereColumns>& flake() const { return flake_; }
    /// One by one in memory, the flake's as well.
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
        if (const auto* stored = flake_ && !format_ ? flake_->template stored<T>() : nullptr;
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
    std::shared_ptr<const SphereColumns> flake_;
    std::optional<FloatFormat> format_;
};

/// As `shared_solids`, the flake as columns.
SolidList<double> shared_solid_list(const file::Scene& scene);
/// The ideal solids of a scene with own inputs, the flake as columns.
SolidList<Real> ideal_solid_list(const file::Scene& scene);

/// Every number rounded once to F.
SolidList<double> round_solids(const SolidList<double>& solids, const FloatFormat& f);
SolidList<double> round_solids(const SolidList<Real>& solids, const FloatFormat& f);

}  // namespace lostbits::scene::rays
