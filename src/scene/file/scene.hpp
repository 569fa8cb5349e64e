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
#include "scene/camera/ray_generators.hpp"
#include "scene/file/appearance.hpp"
#include "scene/toml/toml_tree.hpp"
#include "shapes/primitive.hpp"
#include "shapes/sphere/flake/sphereflake.hpp"
#include "shapes/triangle/mesh/mesh.hpp"

namespace lostbits::scene::file {

/// How the numbers of the scene are rounded. `shared`: they are rounded once to binary32 and every format gets the same
/// numbers, so differences come from arithmetic alone. `own`: each format rounds the ideal numbers itself, so input
/// error appears too.
enum class InputRounding { shared, own };

/// The near and far planes from which the rays of a pinhole are unprojected. Clip space needs these planes; directions
/// do not.
struct CameraProjection {
    /// Range of z over w from the near plane to the far plane: -1 to 1, 0 to 1, 1 to 0.
    enum class DepthRange { gl, zero_to_one, reversed };
    DepthRange depth = DepthRange::zero_to_one;
    Real near;                ///< > 0
    std::optional<Real> far;  ///< > near; absent: at infinity
};

/// The camera of a picture: how its rays start and where they go.
struct Camera {
    enum class Kind { orthographic, pinhole, pixel_plane };
    Kind kind = Kind::pinhole;
    Vec<Real> eye;      ///< pinhole, pixel_plane: where all rays start; orthographic: the centre of the picture
    Vec<Real> look_at;  ///< the rays' direction is look_at − eye, of any length
    /// The direction that is upright in the picture. It need not be a unit vector or perpendicular to the view.
    Vec<Real> up{Real(0), Real(1), Real(0)};
    Real width;    ///< orthographic: the picture's width in world units; the height follows, because pixels are square
    Real fov_deg;  ///< pinhole: the vertical field of view in degrees
    /// Moves the window on the picture plane right and up, in picture widths. The view direction stays.
    Real shift_right, shift_up;
    bool normalise = true;  ///< pinhole: true if directions are divided by their length, in the camera's arithmetic
    /// pixel_plane: the part of the plane z = 0 that the picture covers, in world units. A ray goes from the eye
    /// through the middle of its pixel in this plane. Its direction is the difference of the two points and is never
    /// normalised, so t = 1 is in the plane.
    Real left, bottom, right, top;
    std::optional<CameraProjection> projection = {};  ///< pinhole
    /// Ray generator, which makes the rays in each format from the camera's stored numbers. Null: each format rounds
    /// the ideal rays.
    const camera::RayGenerator* ray_generator = nullptr;
};

struct Scene {
    std::string id;  ///< the file's stem, and `.variant` if it has variants
    std::string title;
    std::string source = "-";  ///< what the scene reproduces
    std::string note;          ///< what to look for
    InputRounding inputs = InputRounding::shared;
    int width = 256;  ///< pixels
    int height = 256;
    Camera camera;
    std::vector<Primitive<Real>> listed;         ///< as written, in world units, in the file's order
    std::optional<sphere::Sphereflake> flake;    ///< its spheres come after the primitives of `listed`
    std::shared_ptr<const triangle::Mesh> mesh;  ///< the triangles of all [[mesh]] tables, which come last; null: none
    std::optional<Transform<double>> mesh_transform;  ///< matrix of the meshes, in ideal numbers, like the vertices
    std::optional<intersect::MarchConstants<Real>> march;  ///< absent: no sphere tracing
    Range<double> range = {};                              ///< of every ray, in lengths of its direction
    Appearance appearance;                                 ///< for pictures of the scene
    std::filesystem::path path;

    [[nodiscard]] std::uint64_t pixel_count() const {
        return static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
    }
    /// True if forms for these shapes can be used on the scene: the shapes are those of its primitives or, for `sdf`,
    /// the scene has constants for the march.
    [[nodiscard]] bool accepts(Shapes form_shapes) const;
    /// True if a primitive has a transform.
    [[nodiscard]] bool has_transform() const;
    /// The shapes of its primitives, each once.
    [[nodiscard]] std::vector<Shape> shapes() const;
    /// Remarks about its meshes for the author of the file, as sentences.
    [[nodiscard]] std::vector<std::string> remarks() const;
    /// All primitives: the listed ones, the flake, the mesh. Each takes about 300 bytes; use a `rays::PrimitiveList`
    /// for many.
    [[nodiscard]] std::vector<Primitive<Real>> primitives() const;
    [[nodiscard]] std::size_t primitive_count() const {
        return listed.size() + (flake ? flake->size() : 0) + (mesh ? mesh->faces.size() : 0);
    }
};

/// Returns the scene with rays that each format makes by this ray generator. If inputs are shared, the numbers of the
/// camera and of the primitives are rounded to binary32 here. The ideal rays are then exactly those of the stored
/// camera. Throws InputError for a scene whose camera has no projection, and for shared inputs with meshes or flakes.
Scene with_ray_generator(Scene scene, const camera::RayGenerator& generator);

/// Options for loading a scene file: the parts to load, and the changes to them.
struct LoadOptions {
    std::optional<std::string> variant = std::nullopt;       ///< the only variant to load; absent: all
    std::optional<std::pair<int, int>> size = std::nullopt;  ///< width and height in pixels
    std::vector<toml::Override> overrides = {};              ///< applied after the variant's own, in order
    intersect::process::StopToken stop = {};                 ///< checked while the file, the flake and meshes are read
};

/// A parsed scene file. Parse it once, and interpret it with as many overrides as a sweep needs.
class SceneFile {
public:
    explicit SceneFile(const std::filesystem::path& path, intersect::process::StopToken stop = {});

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    [[nodiscard]] std::vector<std::string> variants() const;

    /// The scenes that the options select: one per variant, in the file's order, or the single one of a file without
    /// variants. Throws InputError with a position for anything that cannot be a picture. `Scene` describes each
    /// number. Radii and widths must be > 0 and fields of view inside (0, 180), also once rounded to binary32 if
    /// inputs are shared.
    [[nodiscard]] std::vector<Scene> load(const LoadOptions& options = {}) const;

private:
    struct SceneVariant {
        std::string name;
        std::vector<toml::Override> changes;
    };
    [[nodiscard]] Scene interpret(const SceneVariant* variant, const LoadOptions& options) const;
    /// Returns the file's tree with the changes of the variant, of the options, and with a table for the range.
    [[nodiscard]] toml::Node root_with_changes(const SceneVariant* variant, const LoadOptions& options) const;

    std::filesystem::path path_;
    toml::Node root_;  ///< without the variants
    std::vector<SceneVariant> variants_;
};

/// Returns `SceneFile(path, options.stop).load(options)`.
std::vector<Scene> load_scene(const std::filesystem::path& path, const LoadOptions& options = {});

/// Returns all `data_dir/scenes/*.toml`, sorted by name. Throws InputError if the folder is missing.
std::vector<std::filesystem::path> list_scene_files(const std::filesystem::path& data_dir);

struct SceneName {
    std::filesystem::path path;
    std::optional<std::string> variant = std::nullopt;
};

/// Resolves a file name `x.toml` that the file `referring_file` contains. Returns the file of that name in the same
/// folder if there is one, else the name unchanged.
std::string resolve_beside(const std::filesystem::path& referring_file, const std::string& name);

/// Finds a scene by a path, or by the id of a file in `data_dir/scenes`: `rtg-fig-7-4`. A variant is named
/// `x.toml.r1e3` or `x.r1e3`. Throws InputError with did-you-mean if there is no such scene. The variant is checked
/// when it is loaded.
SceneName find_scene(const std::string& name_or_path, const std::filesystem::path& data_dir);

}  // namespace lostbits::scene::file
