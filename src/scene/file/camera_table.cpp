#include <array>

#include "number/real.hpp"
#include "scene/file/stretch.hpp"
#include "scene/file/tables.hpp"
#include "text/did_you_mean.hpp"

namespace lostbits::scene::file {

using toml::TableReader;

namespace {

constexpr std::pair<std::string_view, CameraProjection::DepthRange> depth_names[] = {
    {"gl", CameraProjection::DepthRange::gl},
    {"zero_to_one", CameraProjection::DepthRange::zero_to_one},
    {"reversed", CameraProjection::DepthRange::reversed}};

constexpr std::pair<std::string_view, Camera::Kind> camera_names[] = {{"orthographic", Camera::Kind::orthographic},
                                                                      {"pinhole", Camera::Kind::pinhole},
                                                                      {"pixel_plane", Camera::Kind::pixel_plane}};

bool is_zero(const Vec<Real>& v) { return v.x == 0 && v.y == 0 && v.z == 0; }

/// True if |view × up|² ≤ 2^-80 |view|² |up|². At an angle below 2^-40, rounding would decide the roll of the picture.
bool are_parallel(const Vec<Real>& view, const Vec<Real>& up) {
    const Vec<Real> view_cross_up = cross(view, up);
    return dot(view_cross_up, view_cross_up) <= ldexp(dot(view, view) * dot(up, up), -80);
}

/// Reads `[camera.projection]`. 1/tan, near and near·far/(far − near) are entries of its matrix. If one of these
/// entries is 0, the matrix has no inverse.
CameraProjection read_projection(TableReader table, const StoredNumbers& numbers) {
    CameraProjection projection;
    table.read("depth", projection.depth, depth_names);
    projection.near = numbers.require_positive(table, "near", table.number("near"));
    if (table.has("far")) {
        projection.far = numbers.require_positive(table, "far", table.number("far"));
        if (*projection.far <= projection.near)
            table.fail_at("far",
                          "is not beyond near, which leaves nothing between; write a larger number, or leave it "
                          "out for a plane at infinity");
        if (numbers.round_as_stored(*projection.far) == numbers.round_as_stored(projection.near))
            table.fail_at("far",
                          "equals near in binary32, to which inputs = \"shared\" rounds, and the matrix is "
                          "singular; write a larger number, or inputs = \"own\"");
        numbers.require_positive(table, "far", *projection.far * projection.near / (*projection.far - projection.near));
    }
    table.require_known_keys();
    return projection;
}

/// Reads `rays` and `projection` of a pinhole camera.
void read_rays_of_camera(TableReader& table, const StoredNumbers& numbers, Camera& camera) {
    if (auto projection = table.optional_table("projection")) {
        camera.projection = read_projection(*projection, numbers);
        if (camera.shift_right != 0 || camera.shift_up != 0)
            table.fail_at("shift",
                          "moves the picture to one side, but a projection has the view axis in its middle; "
                          "leave one of the two out");
        numbers.require_positive(table, "fov_deg", 1 / half_tangent(camera.fov_deg));
    }

    const auto name = table.optional_string("rays");
    if (!name) return;
    camera.ray_generator = camera::find_ray_generator(*name);
    if (camera.ray_generator == nullptr) {
        std::vector<std::string> names;
        for (const camera::RayGenerator& generator : camera::ray_generators()) names.emplace_back(generator.info->name);
        table.fail_at("rays", "is \"" + *name + "\", which is not a known ray generator; " +
                                  text::did_you_mean(*name, names) + "; `lostbits list generators` shows them");
    }

    // A generator needs the planes of a projection and makes unit directions.
    if (!camera.projection)
        table.fail_at("rays",
                      "needs the planes of a projection; write [camera.projection] with near, and far unless it "
                      "is at infinity");
    if (!camera.normalise)
        table.fail_at("normalise",
                      "is false, but camera.rays makes directions of length one; leave one of the two out");
}

constexpr std::string_view pinhole_only_message =
                               "belongs to kind = \"pinhole\", whose rays meet in the eye; leave it out",
                           pixel_plane_only_message =
                               "belongs to kind = \"pixel_plane\"; write width (orthographic) or fov_deg (pinhole)";

/// Keys that a kind of camera does not have, and the message for a file that has one of them. All other keys are
/// allowed.
struct ForeignKeys {
    Camera::Kind kind;
    std::array<std::string_view, 3> keys;  ///< unused entries are empty
    std::string_view message;
};
constexpr ForeignKeys foreign_keys[] = {
    {Camera::Kind::pixel_plane,
     {"look_at", "up", "shift"},
     "has no meaning for a camera of pixels at z = 0; extent and eye say where it looks"},
    {Camera::Kind::pixel_plane, {"rays", "projection"}, pinhole_only_message},
    {Camera::Kind::pixel_plane,
     {"width", "fov_deg"},
     "has no meaning for a camera of pixels at z = 0; write extent = [left, bottom, right, top], in world units"},
    {Camera::Kind::pixel_plane,
     {"normalise"},
     "has no meaning for a camera of pixels at z = 0, whose directions are differences of points; leave it out"},
    {Camera::Kind::orthographic, {"extent"}, pixel_plane_only_message},
    {Camera::Kind::orthographic, {"rays", "projection"}, pinhole_only_message},
    {Camera::Kind::orthographic, {"fov_deg"}, "has no meaning for an orthographic camera; write width, in world units"},
    {Camera::Kind::orthographic,
     {"normalise"},
     "has no meaning for an orthographic camera, whose rays all have the same direction; leave it out"},
    {Camera::Kind::pinhole, {"extent"}, pixel_plane_only_message},
    {Camera::Kind::pinhole,
     {"width"},
     "has no meaning for a pinhole camera; write fov_deg, the vertical field of view in degrees"},
};

/// Reads a camera whose picture plane is in the world, at z = 0.
void read_pixel_plane(TableReader& table, const StoredNumbers& numbers, Camera& camera) {
    camera.eye = numbers.require_finite(table, "eye", table.vec3("eye"));
    if (numbers.is_stored_as_zero(camera.eye.z))
        table.fail_at("eye",
                      "lies in the plane of the pixels, z = 0, and would see it as a line; move it off the plane");
    std::vector<Real> extent = table.numbers("extent", 4);
    for (Real& x : extent) x = numbers.require_finite(table, "extent", x);
    camera.left = extent[0];
    camera.bottom = extent[1];
    camera.right = extent[2];
    camera.top = extent[3];
    if (!(camera.left < camera.right && camera.bottom < camera.top))
        table.fail_at("extent", "covers nothing; write [left, bottom, right, top] with left < right and bottom < top");
}

/// Reads a camera that looks from its eye along a view, through a window around it.
void read_view(TableReader& table, const StoredNumbers& numbers, Camera& camera) {
    camera.eye = numbers.require_finite(table, "eye", table.vec3("eye"));
    camera.look_at = numbers.require_finite(table, "look_at", table.vec3("look_at"));
    table.read("up", camera.up);
    camera.up = numbers.require_finite(table, "up", camera.up);
    const std::vector<Real> shift = table.optional_numbers("shift", 2).value_or(std::vector<Real>{Real(0), Real(0)});
    camera.shift_right = numbers.require_finite(table, "shift", shift[0]);
    camera.shift_up = numbers.require_finite(table, "shift", shift[1]);

    const Vec<Real> view = camera.look_at - camera.eye;
    if (is_zero(view)) table.fail_at("look_at", "equals camera.eye, which gives no direction; move one of them");
    if (is_zero(camera.up)) table.fail_at("up", "is zero, which is not a direction; write [0, 1, 0]");
    if (are_parallel(view, camera.up))
        table.fail_at(
            "up", "is parallel to the direction of view, look_at - eye; write another, such as [0, 0, 1] or [0, 1, 0]");

    if (camera.kind == Camera::Kind::orthographic) {
        camera.width = numbers.require_positive(table, "width", table.number("width"));
        return;
    }
    camera.fov_deg = table.number("fov_deg");
    if (camera.fov_deg <= 0 || camera.fov_deg >= 180)
        table.fail_at("fov_deg", "must lie between 0 and 180 degrees, both excluded; try 40");
    table.read("normalise", camera.normalise);
    read_rays_of_camera(table, numbers, camera);
}

}  // namespace

Camera read_camera(TableReader table, const StoredNumbers& numbers) {
    Camera camera;
    camera.kind = table.one_of<Camera::Kind>("kind", camera_names);
    for (const auto& [kind, keys, message] : foreign_keys)
        for (const std::string_view key : keys)
            if (kind == camera.kind && !key.empty()) table.reject(key, message);
    if (camera.kind == Camera::Kind::pixel_plane) read_pixel_plane(table, numbers, camera);
    else read_view(table, numbers, camera);
    table.require_known_keys();
    return camera;
}

Scene with_ray_generator(Scene scene, const camera::RayGenerator& generator) {
    const std::string message_start = "scene " + scene.id + ": rays by " + std::string(generator.info->name);
    if (!scene.camera.projection)
        throw InputError(message_start +
                         " need the planes of a projection, which the scene does not have; write [camera.projection] "
                         "with near, and far unless it is at infinity");
    if (!scene.camera.normalise)
        throw InputError(message_start + " have length one, but camera.normalise is false; leave it out");

    scene.camera.ray_generator = &generator;
    if (scene.inputs == InputRounding::own) return scene;
    if (scene.flake || scene.mesh)
        throw InputError(
            message_start +
            ": each format must round the meshes and flakes too, if it computes the rays; write inputs = \"own\"");

    // Stores the shared numbers rounded to binary32, because each format now rounds the stored numbers itself.
    const auto rounded = [](const Real& x) { return Real(toml::round_to_format(x, binary32)); };
    Camera& camera = scene.camera;
    for (Vec<Real>* const v : {&camera.eye, &camera.look_at, &camera.up})
        *v = {rounded(v->x), rounded(v->y), rounded(v->z)};
    camera.fov_deg = rounded(camera.fov_deg);
    camera.projection->near = rounded(camera.projection->near);
    if (auto& far = camera.projection->far) far = rounded(*far);
    for (Primitive<Real>& primitive : scene.listed) primitive = convert_numbers(primitive, rounded);
    if (scene.march) scene.march = convert_numbers(*scene.march, rounded);
    scene.inputs = InputRounding::own;
    return scene;
}

}  // namespace lostbits::scene::file
