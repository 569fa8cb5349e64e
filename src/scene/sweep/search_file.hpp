// Reads two kinds of searches. One kind searches in ranges of every number of a ray and a primitive, for the worst ray
// of a form. The other searches along the edges of a mesh, for the smallest distance from which a form lets a ray
// through an edge or counts the edge twice.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/sweep/sweep_head.hpp"
#include "scene/toml/toml_reader.hpp"
#include "shapes/primitive.hpp"

namespace lostbits::scene::sweep {

struct SearchedRange {
    double low = 0, high = 0;
    [[nodiscard]] bool contains(double x) const { return low <= x && x <= high; }
};

/// Reads `key = [low, high]`. Throws InputError with a position if low is above high.
SearchedRange read_range(toml::TableReader& table, std::string_view key);

/// Distance from the origin of a ray to the centre of a round primitive, in radii.
double distance_in_radii(const Ray<double>& ray, const Primitive<double>& primitive);

/// A sweep file with a `[search]` table in place of axes.
class SearchFile : public SweepHead {
public:
    /// Throws InputError with a position for anything that is not a search. `changes` are first applied to
    /// keys of the table: `starts`, `radius`.
    explicit SearchFile(const std::filesystem::path& path, const std::vector<toml::Override>& changes = {});

    Shape shape{};
    /// True if the primitives of the search are round, so that a ray has a distance and an impact in radii.
    [[nodiscard]] bool is_round() const { return row_of(shape).is_ball; }
    /// The ranges of origin x, y, z, direction x, y, z, and the primitive's numbers, in this order.
    std::vector<SearchedRange> ranges;
    /// Spheres only: distances from the eye to the centre and from the line to the centre, in radii. Losses of far rays
    /// and of rays near the silhouette are expected; these ranges keep the search to rays that should be easy.
    SearchedRange distance_radii{0, 0x1p1000}, impact_radii{0, 0x1p1000};
    std::string metric = "lost_bits";  ///< the metric to maximise; a wrong decision counts more than any value
    /// True if the metric is minimised instead, as for `bound_ratio`; then only hits count.
    bool is_minimised = false;
    /// True if wrong decisions are ignored; the search looks for the worst hit.
    bool hits_only = false;
    std::uint64_t seed = 1;
    int start_count = 16;       ///< random rays from which the search begins
    int generation_count = 64;  ///< number of generations, of 32 neighbours each, from every start
    /// Numbers are drawn as ±m·2^e with whole e from this range. Each significand m is equally likely, or m is a few
    /// last places from a power of two, where roundings are largest. Moves also flip single bits and change exponents.
    /// If absent, numbers are drawn uniformly from their ranges.
    std::optional<SearchedRange> exponents;
    /// Boxes only: if true, rays are aimed at an edge. One plane by which the ray enters and one by which it leaves are
    /// drawn where the ray passes them at the same t, and the other planes at the ends of their ranges.
    bool at_edge = false;
    /// Part of the primitive at which rays are aimed, by the `aims` of the shape's ray distribution: a rim, an apex, a
    /// line in the side. If absent, rays are aimed at any point of the primitive.
    std::optional<int> aim;
    /// From the eye to the part that `aim` names, in halves of the primitive's size.
    SearchedRange distance{0x1p-10, 0x1p20};
    /// Spheres only: if true, the worst ray is the wrong decision nearest to the sphere, in radii. The search does not
    /// end with the first wrong decision.
    bool nearest = false;

    /// True if a ray and a primitive are in the ranges (the derived ranges to double precision) and are proper.
    [[nodiscard]] bool contains(const Ray<double>& ray, const Primitive<double>& primitive) const;

private:
    void read_ranges(toml::TableReader& table);
    void read_drawing(toml::TableReader& table);
    void read_aim(toml::TableReader& table);
    void read_goal(toml::TableReader& table);
};

/// A sweep file with an `[edge_search]` table.
class EdgeSearchFile : public SweepHead {
public:
    /// Throws InputError with a position for anything that is not such a search. A scene is looked up in `data_dir`.
    /// `changes` are first applied to keys of the table: `rays`, `census`, `seed`.
    EdgeSearchFile(const std::filesystem::path& path, const std::filesystem::path& data_dir,
                   const std::vector<toml::Override>& changes = {}, intersect::process::StopToken stop = {});

    /// The scene of the triangles: only meshes, shared by all formats. Its camera is not used.
    file::Scene scene;
    SearchedRange distance{1, 0x1p20};  ///< from the eye to the point of an edge, in lengths of the edge
    int ulps = 2;                       ///< each component of a direction is moved by at most this many ulps
    std::uint64_t seed = 1;
    std::int64_t ray_count = 1 << 20;  ///< number of rays tried for each form and each outcome
    std::int64_t census_ray_count =
        20000;  ///< number of rays from the whole range whose outcomes are counted for each form

    [[nodiscard]] bool accepts(Shapes form_shapes) const { return form_shapes == Shapes(triangle::Mesh::shape); }
};

}  // namespace lostbits::scene::sweep
