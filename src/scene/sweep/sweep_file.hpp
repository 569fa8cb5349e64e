// Reads a sweep: a scene or a ray distribution, and one or two axes on which its numbers take many values.
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

/// An axis of a sweep: its values, and the numbers that they set.
struct Axis : AxisName {
    enum class Spacing { linear, log2, every_float, whole };
    Spacing spacing = Spacing::log2;
    double from = 1, to = 2;
    std::vector<double> values;  ///< in order; values with log2 spacing are rounded to 12 significant bits
    struct AxisTarget {
        std::string path;   ///< in the scene, or in the table of the ray distribution
        double factor = 1;  ///< the path is set to base + factor · value
        double base = 0;
        toml::SourcePosition where = {};
    };
    std::vector<AxisTarget> targets;

    /// Midpoint of a and b by the spacing of the axis. It is a or b if no number of the axis lies between.
    [[nodiscard]] double middle(double a, double b) const;
};

/// Changes to a sweep before a run begins.
struct SweepChanges {
    std::optional<std::pair<int, int>> size = {};  ///< size of the scene's picture, and so the number of rays per step
    /// Assignments to paths of the scene or of the table of the ray distribution, as in an axis; also to paths that
    /// begin with `march.` or `axis[K].`.
    std::vector<toml::Override> set = {};
    std::vector<long long> steps = {};  ///< number of steps of each axis, or one number for all axes
};

/// A sweep file with one or two `[[axis]]` tables.
class SweepFile : public SweepHead {
public:
    /// Throws InputError with a position for anything that is not a sweep, and for a change that has no meaning for
    /// this one. A scene is looked up in `data_dir`.
    SweepFile(const std::filesystem::path& path, const std::filesystem::path& data_dir,
              const SweepChanges& changes = {}, intersect::process::StopToken stop = {});

    std::vector<Axis> axes;  ///< one or two
    /// Convention on touching by which all forms are judged; absent: each form's own.
    std::optional<intersect::Touching> convention;

    /// A predicted position on the first axis, which a plot marks. It is for one format, or for all if `format` is
    /// empty. If `form` is not empty, the measured onset of that form is drawn beside the mark.
    struct Mark {
        double at;
        std::string label, format;
        std::string form = {}, event = {}, statistic = {};  ///< as in onsets.csv; empty: no onset
        double threshold = 1;
    };
    std::vector<Mark> marks;

    /// True if a form for these shapes can run the sweep.
    [[nodiscard]] bool accepts(Shapes form_shapes) const {
        return form_shapes == Shape::sdf ? marches_ : form_shapes == Shapes(shapes_).with_transform(has_transform_);
    }
    /// The shapes of the sweep's primitives, each once.
    [[nodiscard]] const std::vector<Shape>& shapes() const { return shapes_; }
    [[nodiscard]] bool has_mesh() const { return has_mesh_; }

    /// The path of the sweep's scene; empty if the sweep draws its rays at random.
    [[nodiscard]] std::filesystem::path scene_path() const { return scene_ ? scene_->path() : std::filesystem::path(); }
    /// True if the rays are random: rays of a ray distribution are, rays of a scene are not.
    [[nodiscard]] bool has_random_rays() const { return !scene_; }
    /// Returns this sweep with other random rays: its seed is `offset` larger.
    [[nodiscard]] SweepFile with_seed_offset(int offset) const;

    /// The rays of one step. `values` has one value per axis.
    [[nodiscard]] std::vector<rays::RayGroup> rays(const std::vector<double>& values) const;
    /// The first group of rays of the first step. It shows which primitives and march constants the sweep has.
    [[nodiscard]] rays::RayGroup first_rays() const;

private:
    void apply_changes(const SweepChanges& changes);
    void apply_steps(const SweepChanges& changes);
    void require_no_changes_of_axes(const SweepChanges& changes) const;
    void read_subject(toml::TableReader& file, const std::filesystem::path& data_dir);
    void read_both_ends();
    [[nodiscard]] std::vector<rays::RayGroup> rays_of_distribution(const std::vector<toml::Override>& changes) const;
    [[nodiscard]] std::vector<rays::RayGroup> rays_of_scene(const std::vector<toml::Override>& changes) const;

    toml::Node root_;
    std::optional<file::SceneFile> scene_;
    std::optional<std::pair<int, int>> size_;
    std::vector<toml::Override> changes_;  ///< changes to the scene
    std::optional<std::string> variant_;
    std::vector<Shape> shapes_;
    bool has_transform_ = false;  ///< true if primitives have transforms
    bool marches_ = false, has_mesh_ = false;
    intersect::process::StopToken stop_;  ///< for the scene, which each step reads again
    std::uint64_t seed_offset_ = 0;       ///< added to the seed of the ray distribution
};

/// True if a file declares that it is a sweep of any kind. Throws InputError if it cannot be read.
bool is_sweep_file(const std::filesystem::path& path);

/// Finds a sweep by a path, or by its id in `data_dir/sweeps`. Throws InputError with did-you-mean.
std::filesystem::path find_sweep(const std::string& name_or_path, const std::filesystem::path& data_dir);

}  // namespace lostbits::scene::sweep
