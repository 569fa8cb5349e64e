// The options of a command line for files of rays, and the further options of `lostbits judge`.
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
#include "scene/file/scene.hpp"
#include "scene/ray_file/ray_file.hpp"

namespace lostbits::analysis::selection {

/// The options for files of rays: the meaning of columns, the primitives of the rays, and the contract of the answers.
struct RayFileOptions {
    std::string container = "auto", columns, answer_format;
    std::uint64_t skip = 0;
    PrimitiveOptions primitives;
    std::string scene, miss;
    std::string direction = "any", touching = "hit", at_origin = "hit", inside = "usual", facing = "both";
    std::string open_ends = "none";
    intersect::process::StopToken stop = {};
};

/// An option for files of rays whose value is a text. If it is not given, its value is that of `RayFileOptions()`.
struct RayFileOption {
    const char* name;
    std::string RayFileOptions::*value;
    const char* help;
    std::vector<std::string> allowed_values = {};  ///< empty: any
    bool is_about_answers = false;                 ///< it is about the meaning of answers

    [[nodiscard]] bool is_given(const RayFileOptions& options) const {
        return options.*value != RayFileOptions().*value;
    }
};
const std::vector<RayFileOption>& ray_file_options();

/// Adds an option for every member of `RayFileOptions` but `stop`; each option has the name of its member.
void add_ray_options(const shell::Command& command, RayFileOptions& options);

struct JudgeOptions : RayFileOptions {
    std::string file;
    std::vector<std::string> forms, formats, metrics;
    std::string against, by, tolerance, unit;
    double bits = -1;  ///< below 0: not given
    std::string size;
    bool writes_rows = false;
    std::size_t worst_count = 10;
    std::string out, shard, pictures = "sheets";
};

/// The scene whose primitives the rays are tested with; nothing if none is named. Throws InputError for several scenes,
/// and for one with too many primitives.
std::optional<scene::file::Scene> load_scene_of_rays(const RayFileOptions& options,
                                                     const std::filesystem::path& data_folder);

/// The shape of the first primitive that is given for all rays; nothing if no such primitive is given.
std::optional<Shape> shared_shape(const RayFileOptions& options, const std::optional<scene::file::Scene>& scene);

/// The primitives that are given for all rays, with numbers in the format. The primitives of a scene have the numbers
/// that a map of the scene gives them.
std::vector<Primitive<double>> shared_primitives(const RayFileOptions& options,
                                                 const std::optional<scene::file::Scene>& scene, const Format& format);

/// Opens the file as the options say. `keeps_own_columns`: also keep the user's own columns.
std::unique_ptr<scene::ray_file::RayFile> open_file(const RayFileOptions& options, const std::string& file,
                                                    std::optional<Shape> primitive, bool keeps_own_columns = false);

/// The shapes of the primitives of the rays, from columns or given for all rays.
Shapes shapes_of_rays(const scene::ray_file::Layout& layout, const std::vector<Primitive<double>>& shared);

/// If the file has matrices but no primitives: places the primitive that is given for all rays by the matrix of each
/// ray. Throws InputError if there is not exactly one primitive, or if it has a matrix already.
void transform_by_records(scene::ray_file::RayFile& ray_file, const std::vector<Primitive<double>>& shared);

/// A placeholder matrix: a form has the same operations for all matrices.
inline Transform<double> placeholder_matrix() { return {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, false, 1}; }

/// The index, among the file's own columns, of the column to group rays by; nothing if none is asked for.
std::optional<std::size_t> group_column(const JudgeOptions& options, const scene::ray_file::Layout& layout);

/// Adds the metrics that count the rays that fail `--bits` or `--tolerance`.
void add_requirement(const JudgeOptions& options, measure::metric::MetricSet& metric_set,
                     std::vector<const measure::metric::Metric*>& metrics);

/// The contract of the answers. Throws InputError for an option about answers if the file has none.
intersect::Info answer_contract(const RayFileOptions& options, const scene::ray_file::RayFile& ray_file);

}  // namespace lostbits::analysis::selection
