// A sweep: a scene or a family of rays, and one or two numbers of it that take many values.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "intersect/info.hpp"
#include "scene/file/scene.hpp"
#include "scene/rays/rays.hpp"
#include "scene/sweep/sweep_head.hpp"

namespace lostbits::scene::sweep {

struct Axis : AxisName {
    enum class Spacing { linear, log2, every_float, whole };
    Spacing spacing = Spacing::log2;
    double from = 1, to = 2;
    std::vector<double> values;  ///< in order; log2 steps are rounded to 12 significant bits
    struct Target {
        std::string path;   ///< in the scene, or in the family's table
        double factor = 1;  ///< the path is set to base + factor · value
        double base = 0;
        toml::Where where = {};
    };
    std::vector<Target> targets;

    /// Half way between two values in the axis's own spacing; equal to one of them when nothing lies between.
    [[nodiscard]] double middle(double a, double b) const;
};

/// What a run changes of a sweep before it begins.
struct SweepChanges {
    std::optional<std::pair<int, int>> size = {};  ///< of the picture of its scene: so many rays a step
    /// Paths as an axis has them: of the scene, or of the family's table; `march.` and `axis[K].` stand beside those.
    std::vector<toml::Override> set = {};
    std::vector<long long> steps = {};  ///< of each axis, or of the only one
};

class SweepFile : public SweepHead {
public:
    /// InputError with a position for anything that is not a sweep, and for a change that means nothing to this one. A
    /// scene is looked up in `data_dir`.
    SweepFile(const std::filesystem::path& path, const std::filesystem::path& data_dir,
              const SweepChanges& changes = {}, intersect::process::StopToken stop = {});

    std::vector<Axis> axes;  ///< one or two
    std::optional<intersect::Touching>
        convention;  ///< all forms are judged as if touching were this; absent: each by its own word

    /// A place on the first axis that a plot points out: a prediction, with the format it is made for (all if empty),
    /// and perhaps the form whose measured onset is to be drawn beside it.
    struct Mark {
        double at;
        std::string label, format;
        std::string form = {}, event = {}, statistic = {};  ///< as in onsets.csv; empty: nothing beside it
        double threshold = 1;
    };
    std::vector<Mark> marks;

    /// Whether the forms for these shapes can handle the sweep.
    [[nodiscard]] bool meets(Shapes forms) const {
        return forms == Shape::sdf ? marches_ : forms == Shapes(shapes_).placed(is_placed_);
    }
    /// The shapes of its solids, each once.
    [[nodiscard]] const std::vector<Shape>& shapes() const { return shapes_; }
    [[nodiscard]] bool has_mesh() const { return has_mesh_; }

    /// Of its scene; empty where it has none.
    [[nodiscard]] std::filesystem::path scene_path() const { return scene_ ? scene_->path() : std::filesystem::path(); }
    /// Whether its rays are drawn at random: those of a family are, those of a scene are not.
    [[nodiscard]] bool is_drawn() const { return !scene_; }
    /// The same sweep with the random numbers of the seed that many after its own.
    [[nodiscard]] SweepFile drawn_again(int further) const;

    /// The rays of one step, one value per axis.
    [[nodiscard]] std::vector<rays::RayGroup> rays(const std::vector<double>& values) const;
    /// The first group of the first step: what solids and constants are like.
    [[nodiscard]] rays::RayGroup first_rays() const;

private:
    void change(const SweepChanges& changes);
    void refuse_what_axes_set(const SweepChanges& changes) const;
    void read_subject(toml::TableReader& file, const std::filesystem::path& data_dir);
    void try_both_ends();

    toml::Node root_;
    std::optional<file::SceneFile> scene_;
    std::optional<std::pair<int, int>> size_;
    std::vector<toml::Override> changes_;  ///< of the scene
    std::optional<std::string> variant_;
    std::vector<Shape> shapes_;
    bool is_placed_ = false;  ///< whether solids stand under matrices
    bool marches_ = false, has_mesh_ = false;
    intersect::process::StopToken stop_;  ///< of the scene, which each step reads anew
    std::uint64_t further_ = 0;           ///< added to the seed of the family
};

/// Whether a file says that it is a sweep, of whatever kind. InputError where it cannot be read.
bool is_sweep_file(const std::filesystem::path& path);

/// A path to a file, or the id of one in `data_dir/sweeps`. InputError with did-you-mean.
std::filesystem::path find_sweep(const std::string& name_or_path, const std::filesystem::path& data_dir);

}  // namespace lostbits::scene::sweep
