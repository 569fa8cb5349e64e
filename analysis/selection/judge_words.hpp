// What the words of a command line say of files of rays, and what `lostbits judge` asks beyond that.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analysis/selection/ray_numbers.hpp"
#include "analysis/shell/command_line.hpp"
#include "intersect/info.hpp"
#include "intersect/process/stop_token.hpp"
#include "measure/metric/metric_set.hpp"
#include "scene/dump/dump.hpp"
#include "scene/file/scene.hpp"

namespace lostbits::analysis::selection {

/// Which columns mean what, which solids the rays are aimed at, and what the answers are held to.
struct RayFileWords {
    std::string container = "auto", columns, format;
    std::uint64_t skip = 0;
    SolidWords solids;
    std::string scene, miss;
    std::string direction = "any", touching = "hit", at_origin = "hit", inside = "usual", facing = "both";
    std::string open_ends = "none";
    intersect::process::StopToken stop = {};
};

/// An option of files of rays that is a word; one that was not given has the word of `RayFileWords()`.
struct RayFileOption {
    const char* name;
    std::string RayFileWords::*word;
    const char* help;
    std::vector<std::string> known = {};  ///< which words it may be; empty: any
    bool of_answers = false;              ///< it says what answers mean

    [[nodiscard]] bool is_given(const RayFileWords& words) const { return words.*word != RayFileWords().*word; }
};
const std::vector<RayFileOption>& ray_file_options();

/// The options for all of these, `format` under that name.
void add_ray_options(const shell::Command& command, RayFileWords& words);

struct JudgeWords : RayFileWords {
    std::string file;
    std::vector<std::string> forms, formats, metrics;
    std::string against, by, tolerance, unit;
    double bits = -1;  ///< below 0: not asked
    std::string size;
    bool rows = false;
    std::size_t worst = 10;
    std::string out, shard, pictures = "sheets";
};

/// The one scene whose solids the rays are aimed at; nothing where none is named. InputError for several, and for one
/// of too many solids.
std::optional<scene::file::Scene> scene_of(const RayFileWords& o, const std::filesystem::path& data);

/// Of the first of the solids that are given once for all rays; nothing where none are.
std::optional<Shape> shape_given(const RayFileWords& o, const std::optional<scene::file::Scene>& scene);

/// These solids, numbers of the format; those of a scene as a map of it has them.
std::vector<Solid<double>> solids_given(const RayFileWords& o, const std::optional<scene::file::Scene>& scene,
                                        const Format& format);

/// The file, opened as the words say; `keep`: the user's own columns are wanted.
std::unique_ptr<scene::dump::Dump> open_file(const RayFileWords& o, const std::string& file, std::optional<Shape> solid,
                                             bool keep = false);

/// The shapes of what the rays are aimed at, in columns or given once.
Shapes shapes_of_rays(const scene::dump::Layout& layout, const std::vector<Solid<double>>& given);

/// Puts the solid that is given once for all rays under their matrices, of a file that has matrices and no solids.
/// InputError where it is not one, or has a matrix.
void put_under_matrices(scene::dump::Dump& dump, const std::vector<Solid<double>>& given);

/// Some matrix: the operations of a form under one are the same under all.
inline Placement<double> any_matrix() { return {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, false, 1}; }

/// The place of the column that rays are grouped by among those of the file's own; nothing where none is asked for.
std::optional<std::size_t> group_of(const JudgeWords& o, const scene::dump::Layout& layout);

/// Adds the metrics that count what falls short of `--bits` and `--tolerance`.
void add_wish(const JudgeWords& o, measure::metric::MetricSet& made,
              std::vector<const measure::metric::Metric*>& metrics);

/// The contract of the answers. InputError for a word about answers where there are none.
intersect::Info contract_of(const RayFileWords& o, const scene::dump::Dump& dump);

}  // namespace lostbits::analysis::selection
