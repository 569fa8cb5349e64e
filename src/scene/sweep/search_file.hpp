// Searches: of ranges of every number of a ray and a solid, for the worst ray of a form; and along the edges of a mesh,
// from how near a form lets a ray through one, or counts it twice.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/sweep/sweep_head.hpp"
#include "scene/toml/toml_reader.hpp"
#include "shapes/solid.hpp"

namespace lostbits::scene::sweep {

struct SearchedRange {
    double low = 0, high = 0;
    [[nodiscard]] bool holds(double x) const { return low <= x && x <= high; }
};

/// `key = [low, high]`. InputError with a position where low is above high.
SearchedRange read_range(toml::TableReader& table, std::string_view key);

/// From the origin of a ray to the centre of a round solid.
double distance_in_radii(const Ray<double>& ray, const Solid<double>& solid);

/// A sweep file with a `[search]` table in place of axes.
class SearchFile : public SweepHead {
public:
    /// InputError with a position for anything that is not a search.
    /// `set` changes keys of the table first: `starts`, `radius`.
    explicit SearchFile(const std::filesystem::path& path, const std::vector<toml::Override>& set = {});

    Shape shape{};
    /// Whether its solids are round, and so have a distance and an impact in radii.
    [[nodiscard]] bool is_round() const { return row_of(shape).round; }
    /// Of origin x, y, z, direction x, y, z, and the solid's numbers, in this order: one after another.
    std::vector<SearchedRange> ranges;
    /// Spheres only: eye to centre and line to centre, in radii. What a ray near the silhouette or a far one loses is
    /// no surprise; these keep the search to rays that should be easy.
    SearchedRange distance_radii{0, 0x1p1000}, impact_radii{0, 0x1p1000};
    std::string metric = "lost_bits";  ///< made as large as possible; a wrong decision beats any value
    /// The metric is made as small as possible instead, as of `bound_ratio`; of hits alone.
    bool smallest = false;
    /// Wrong decisions are passed over: the worst of the hits is looked for.
    bool hits_only = false;
    std::uint64_t seed = 1;
    int starts = 16;       ///< random rays that the search begins from
    int generations = 64;  ///< of 32 neighbours each, from every start
    /// Numbers are drawn as ±m·2^e, e from these whole numbers, each significand m as likely as another or a few last
    /// places from a power of two, where roundings are largest; and moves also turn single bits and exponents. Without
    /// it numbers are drawn evenly from their ranges.
    std::optional<SearchedRange> exponents;
    /// Boxes only: one plane that the ray enters by and one that it leaves by are drawn where the ray passes at once,
    /// and the others at the ends of their ranges: an edge.
    bool at_edge = false;
    /// Spheres only: of wrong decisions the one nearest to the sphere, in radii, is the worst; the search does not end
    /// with the first.
    bool nearest = false;

    /// Whether a ray and a solid lie in the ranges (the derived ones to double precision), and are a ray and a solid.
    [[nodiscard]] bool holds(const Ray<double>& ray, const Solid<double>& solid) const;
};

/// A sweep file with an `[edge_search]` table.
class EdgeSearchFile : public SweepHead {
public:
    /// InputError with a position for anything that is not such a search. A scene is looked up in `data_dir`. `set`
    /// changes keys of the table first: `rays`, `seed`.
    EdgeSearchFile(const std::filesystem::path& path, const std::filesystem::path& data_dir,
                   const std::vector<toml::Override>& set = {}, intersect::process::StopToken stop = {});

    /// Whose triangles they are: meshes alone, shared by all formats. Its camera plays no part.
    file::Scene scene;
    SearchedRange distance{1, 0x1p20};  ///< from the eye to the point of an edge, in lengths of the edge
    int ulps = 2;                       ///< each component of a direction is moved by so many at most
    std::uint64_t seed = 1;
    std::int64_t rays = 1 << 20;  ///< tried of each form for each outcome

    [[nodiscard]] bool meets(Shapes forms) const { return forms == Shapes(triangle::Mesh::shape); }
};

}  // namespace lostbits::scene::sweep
