// A search along the edges of a mesh: from how near a form lets a ray through one, or counts it twice.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "scene/file/scene.hpp"
#include "scene/sweep/search_file.hpp"

namespace lostbits::scene::sweep {

/// A sweep file with an `[edge_search]` table.
class EdgeSearchFile : public SweepHead {
public:
    /// InputError with a position for anything that is not such a search. A scene is looked up in `data_dir`. `set`
    /// changes keys of the table first: `rays`, `seed`.
    EdgeSearchFile(const std::filesystem::path& path, const std::filesystem::path& data_dir,
                   const std::vector<toml::Override>& set = {});

    /// Whose triangles they are: meshes alone, shared by all formats. Its camera plays no part.
    file::Scene scene;
    SearchedRange distance{1, 0x1p20};  ///< from the eye to the point of an edge, in lengths of the edge
    int ulps = 2;                       ///< each component of a direction is moved by so many at most
    std::uint64_t seed = 1;
    std::int64_t rays = 1 << 20;  ///< tried of each form for each outcome

    [[nodiscard]] bool meets(Shapes forms) const { return forms == Shapes(triangle::Mesh::shape); }
};

}  // namespace lostbits::scene::sweep
