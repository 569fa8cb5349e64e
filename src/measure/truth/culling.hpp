// Which of many spheres a ray can meet at all, or a form can be misled to say that it meets. The tree is Embree's.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "geometry/solid.hpp"
#include "number/format.hpp"
#include "scene/rays/rays.hpp"

namespace lostbits::measure::truth {

/// How large the numbers of a picture are: bounds over all of its rays.
struct RayBounds {
    double origin = 0;                          ///< |origin| at most
    double least_direction = 0, direction = 0;  ///< lengths of the directions
};

/// Of the rays in a block, or of both.
RayBounds bounds_of(const scene::rays::RayBlock& rays);
RayBounds join(const RayBounds& a, const RayBounds& b);

/// Candidates among n spheres for rays within stated bounds: supersets, never missing one that matters.
///
/// For the truth: the spheres that the line comes within 2^-18 of the picture's size of (that covers Embree's float
/// arithmetic and the rounding of ideal rays to it). For forms in a format with unit roundoff u also those that
/// rounding can make a hit of: every form decides by the sign of something like r² − l², l the distance of the centre
/// from the line, which it knows to an error of at most K·u·B with B = |O|² + (|G| + r)² + (|O| + |G| + r)²: products
/// of those lengths are all that it adds. Counting roundings gives K < 30 for the worst of the forms; 64 is taken. A
/// sphere is a candidate where l² ≤ r² + 64·u·B. A test compares with brute force for every form. The bound needs
/// squares that neither overflow nor vanish: see `make`.
class SphereIndex {
public:
    /// Nothing where no index can be trusted (squares of the picture's numbers overflow or vanish in the format), where
    /// there are fewer than 64 solids or one that is not a sphere, or where this build has no Embree: ask every solid
    /// then. `format` null: for the truth.
    static std::shared_ptr<const SphereIndex> make(std::span<const Solid<double>> solids, const RayBounds& bounds,
                                                   const FloatFormat* format);
    ~SphereIndex();
    SphereIndex(const SphereIndex&) = delete;
    SphereIndex& operator=(const SphereIndex&) = delete;

    /// Fills `found` with the candidates for a ray in rising order; false where they are more than a thirty-second of
    /// all: asking all is cheaper then. Any thread may ask.
    bool candidates(const Ray<double>& ray, std::vector<std::uint32_t>& found) const;

    /// All spheres as columns, numbers of the format.
    template <class S>
    [[nodiscard]] std::span<const S> column(int k) const {
        if constexpr (std::is_same_v<S, float>) return columns32_[static_cast<std::size_t>(k)];
        else return columns64_[static_cast<std::size_t>(k)];
    }

private:
    struct Tree;
    SphereIndex();
    std::unique_ptr<Tree> tree_;
    std::vector<float> columns32_[4];
    std::vector<double> columns64_[4];
};

/// The solids of a picture and their indices, made once for all of its bands. One thread at a time.
class Culler {
public:
    explicit Culler(const scene::file::Scene& scene);

    /// As `scene::shared_solids`.
    [[nodiscard]] const std::vector<Solid<double>>& shared_solids() const { return shared_; }
    /// For the truth, and for forms in a format that are given `solids`; each made when it is first asked for. May be
    /// null.
    const SphereIndex* for_truth();
    std::shared_ptr<const SphereIndex> for_format(const FloatFormat& format, std::span<const Solid<double>> solids);

private:
    std::vector<Solid<double>> shared_;
    bool many_;
    RayBounds bounds_;
    std::optional<std::shared_ptr<const SphereIndex>> truth_;
    std::map<std::array<int, 3>, std::shared_ptr<const SphereIndex>> formats_;
};

}  // namespace lostbits::measure::truth
