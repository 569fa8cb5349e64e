#include "scene/file/camera_table.hpp"

namespace lostbits::scene::file {

using toml::TableReader;

namespace {

constexpr std::pair<std::string_view, Camera::Kind> camera_names[] = {{"orthographic", Camera::Kind::orthographic},
                                                                      {"pinhole", Camera::Kind::pinhole},
                                                                      {"pixel_plane", Camera::Kind::pixel_plane}};

bool is_zero(const Vec<Real>& v) { return v.x == 0 && v.y == 0 && v.z == 0; }

/// |view × up|² ≤ 2^-80 |view|² |up|²: an angle below 2^-40 leaves the picture's roll to chance.
bool is_parallel(const Vec<Real>& view, const Vec<Real>& up) {
    const Vec<Real> across = cross(view, up);
    return dot(across, across) <= ldexp(dot(view, view) * dot(up, up), -80);
}

/// The camera whose picture plane lies in the world, at z = 0.
Camera read_pixel_plane(TableReader& table, const StoredNumbers& numbers) {
    Camera camera;
    camera.kind = Camera::Kind::pixel_plane;
    camera.eye = numbers.finite(table, "eye", table.vec3("eye"));
    if (numbers.vanishes(camera.eye.z))
        table.fail_at("eye",
                      "lies in the plane of the pixels, z = 0, and would see it as a line; move it off the plane");
    for (const char* key : {"look_at", "up", "shift"})
        table.reject(key, "has no meaning for a camera of pixels at z = 0; extent and eye say where it looks");
    for (const char* key : {"width", "fov_deg"})
        table.reject(key,
                     "has no meaning for a camera of pixels at z = 0; write extent = [left, bottom, right, top], in "
                     "world units");
    table.reject(
        "normalise",
        "has no meaning for a camera of pixels at z = 0, whose directions are differences of points; leave it out");
    std::vector<Real> extent = table.numbers("extent", 4);
    for (Real& x : extent) x = numbers.finite(table, "extent", x);
    camera.left = extent[0];
    camera.bottom = extent[1];
    camera.right = extent[2];
    camera.top = extent[3];
    if (!(camera.left < camera.right && camera.bottom < camera.top))
        table.fail_at("extent", "covers nothing; write [left, bottom, right, top] with left < right and bottom < top");
    table.reject_unknown_keys();
    return camera;
}

}  // namespace

Camera read_camera(TableReader table, const StoredNumbers& numbers) {
    Camera camera;
    camera.kind = table.one_of<Camera::Kind>("kind", camera_names);
    if (camera.kind == Camera::Kind::pixel_plane) return read_pixel_plane(table, numbers);
    table.reject("extent", "belongs to kind = \"pixel_plane\"; write width (orthographic) or fov_deg (pinhole)");
    camera.eye = numbers.finite(table, "eye", table.vec3("eye"));
    camera.look_at = numbers.finite(table, "look_at", table.vec3("look_at"));
    camera.up = numbers.finite(table, "up", table.optional_vec3("up").value_or(Vec<Real>(Real(0), Real(1), Real(0))));
    const std::vector<Real> shift = table.optional_numbers("shift", 2).value_or(std::vector<Real>{Real(0), Real(0)});
    camera.shift_right = numbers.finite(table, "shift", shift[0]);
    camera.shift_up = numbers.finite(table, "shift", shift[1]);

    const Vec<Real> view = camera.look_at - camera.eye;
    if (is_zero(view)) table.fail_at("look_at", "equals camera.eye, which gives no direction; move one of them");
    if (is_zero(camera.up)) table.fail_at("up", "is zero, which is not a direction; write [0, 1, 0]");
    if (is_parallel(view, camera.up))
        table.fail_at("up", "is parallel to the view, look_at - eye; write another, such as [0, 0, 1] or [0, 1, 0]");

    if (camera.kind == Camera::Kind::orthographic) {
        table.reject("fov_deg", "has no meaning for an orthographic camera; write width, in world units");
        table.reject("normalise",
                     "has no meaning for an orthographic camera, whose rays all have the same direction; leave it out");
        camera.width = numbers.positive(table, "width", table.number("width"));
    } else {
        table.reject("width",
                     "has no meaning for a pinhole camera; write fov_deg, the vertical field of view in degrees");
        camera.fov_deg = table.number("fov_deg");
        if (camera.fov_deg <= 0 || camera.fov_deg >= 180)
            table.fail_at("fov_deg", "must lie between 0 and 180 degrees, both excluded; try 40");
        camera.normalise = table.optional_boolean("normalise").value_or(true);
    }
    table.reject_unknown_keys();
    return camera;
}

}  // namespace lostbits::scene::file
