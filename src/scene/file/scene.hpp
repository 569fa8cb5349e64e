// A scene: the ideal numbers of a picture, before any format has rounded them.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "geometry/range.hpp"
#include "intersect/march.hpp"
#include "intersect/process/stop_token.hpp"
#include "number/real.hpp"
#include "scene/camera/makers.hpp"
#include "scene/file/appearance.hpp"
#include "scene/toml/toml_tree.hpp"
#include "shapes/solid.hpp"
#include "shapes/sphere/flake/sphereflake.hpp"
#include "shapes/triangle/mesh/mesh.hpp"

namespace lostbits::scene::file {

/// Who rounds the scene. `shared`: it is rounded once to binary32 and every format gets the same numbers, so that a
/// difference is arithmetic alone. `own`: each format rounds the ideal scene itself, so that input error appears.
enum class Inputs { shared, own };

/// What a pinhole's rays are unprojected from. Directions need none of it, clip space does.
struct CameraProjection {
    /// z over w from the near plane to the far one: -1 to 1, 0 to 1, 1 to 0.
    enum class Depth { gl, zero_to_one, reversed };
    Depth depth = Depth::zero_to_one;
    Real near;                ///< > 0
    std::optional<Real> far;  ///< > near; absent: at infinity
};

struct Camera {
    enum class Kind { orthographic, pinhole, pixel_plane };
    Kind kind = Kind::pinhole;
    Vec<Real> eye;      ///< pinhole, pixel_plane: where all rays start; orthographic: the centre of the picture
    Vec<Real> look_at;  ///< the rays' direction is look_at − eye, of any length
    /// Appears upright in the picture; need be neither unit nor perpendicular.
    Vec<Real> up{Real(0), Real(1), Real(0)};
    Real width;    ///< orthographic: the picture's width in world units; the height follows, pixels being square
    Real fov_deg;  ///< pinhole: the vertical field of view in degrees
    /// Moves the window on the picture plane, right and up, in picture widths; the view direction stays.
    Real shift_right, shift_up;
    bool normalise = true;  ///< pinhole: directions are divided by their length, in the camera's arithmetic
    /// pixel_plane: the part of the plane z = 0 that the picture covers, in world units. A ray goes from the eye
    /// through the middle of its pixel there; its direction is the difference of the two points, never normalised, so
    /// that t = 1 is the plane.
    Real left, bottom, right, top;
    std::optional<CameraProjection> projection = {};  ///< pinhole
    /// Who makes the rays, in each format from the camera's numbers as it stores them; null: the ideal rays are
    /// rounded.
    const camera::Maker* rays = nullptr;
};

struct Scene {
    std::string id;  ///< the file's stem, and `.variant` where it has variants
    std::string title;
    std::string source = "-";  ///< what the scene reproduces
    std::string note;          ///< what to look for
    Inputs inputs = Inputs::shared;
    int width = 256;  ///< pixels
    int height = 256;
    Camera camera;
    std::vector<Solid<Real>> listed;                       ///< as written, in world units, in the file's order
    std::optional<sphere::Sphereflake> flake;              ///< its spheres come after the others
    std::shared_ptr<const triangle::Mesh> mesh;            ///< of all [[mesh]]: its triangles come last; null: none
    std::optional<Placement<double>> mesh_placed;          ///< under which they stand: ideal numbers, as the vertices
    std::optional<intersect::MarchConstants<Real>> march;  ///< absent: the scene asks for no sphere tracing
    Range<double> range = {};                              ///< of every ray, in lengths of its direction
    Appearance appearance;                                 ///< for pictures of it
    std::filesystem::path path;

    [[nodiscard]] std::uint64_t pixels() const {
        return static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
    }
    /// Whether the forms for these shapes can be asked about the scene: they are those of its solids, or, for `sdf`,
    /// the scene has constants for the march.
    [[nodiscard]] bool meets(Shapes forms) const;
    /// Whether a solid stands under a matrix.
    [[nodiscard]] bool is_placed() const;
    /// The shapes of its solids, each once.
    [[nodiscard]] std::vector<Shape> shapes() const;
    /// What whoever wrote the file should know of its meshes, as sentences.
    [[nodiscard]] std::vector<std::string> remarks() const;
    /// All of them: the listed, the flake, the mesh. Some 300 bytes each: many are a `rays::SolidList`.
    [[nodiscard]] std::vector<Solid<Real>> solids() const;
    [[nodiscard]] std::size_t solid_count() const {
        return listed.size() + (flake ? flake->size() : 0) + (mesh ? mesh->faces.size() : 0);
    }
};

/// The scene where each format makes the rays this way. What is rounded to binary32 for all formats is rounded then:
/// the camera's numbers and the solids', and the ideal rays are exactly those of the stored camera. InputError for a
/// scene whose camera has no projection, and for shared inputs with meshes or flakes.
Scene with_rays(Scene scene, const camera::Maker& by);

struct LoadOptions {
    std::optional<std::string> variant = std::nullopt;       ///< this one alone; all where absent
    std::optional<std::pair<int, int>> size = std::nullopt;  ///< width and height in pixels
    std::vector<toml::Override> overrides = {};              ///< applied after the variant's own, in order
    intersect::process::StopToken stop = {};                 ///< of the file, the flake and meshes
};

/// A parsed scene file. Parse once, interpret under as many overrides as a sweep needs.
class SceneFile {
public:
    explicit SceneFile(const std::filesystem::path& path, intersect::process::StopToken stop = {});

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    [[nodiscard]] std::vector<std::string> variants() const;

    /// The scenes that the options select: one per variant, in the file's order, or the single one of a file without
    /// variants. InputError, with a position, for anything that makes no picture: see `Scene` for what each number is;
    /// radii, widths > 0 and fields of view inside (0, 180), also once rounded to binary32 where inputs are shared.
    [[nodiscard]] std::vector<Scene> load(const LoadOptions& options = {}) const;

private:
    struct Variant {
        std::string name;
        std::vector<toml::Override> changes;
    };
    [[nodiscard]] Scene interpret(const Variant* variant, const LoadOptions& options) const;

    std::filesystem::path path_;
    toml::Node root_;  ///< without the variants
    std::vector<Variant> variants_;
};

/// `SceneFile(path, options.stop).load(options)`.
std::vector<Scene> load_scene(const std::filesystem::path& path, const LoadOptions& options = {});

/// All `data_dir/scenes/*.toml`, sorted by name. InputError when the folder is missing.
std::vector<std::filesystem::path> scene_files(const std::filesystem::path& data_dir);

struct SceneName {
    std::filesystem::path path;
    std::optional<std::string> variant = std::nullopt;
};

/// `x.toml` as the file `by` means it: the one that lies beside `by`, if there is one; otherwise the name as it is.
std::string beside(const std::filesystem::path& by, const std::string& name);

/// A path to a file, or the id of one in `data_dir/scenes`: `rtg-fig-7-4`; of one variant `x.toml.r1e3`, `x.r1e3`.
/// InputError with did-you-mean for a name that is neither. The variant itself is checked when it is loaded.
SceneName find_scene(const std::string& name_or_path, const std::filesystem::path& data_dir);

}  // namespace lostbits::scene::file
