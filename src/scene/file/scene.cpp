#include "scene/file/scene.hpp"

#include <algorithm>

#include "scene/file/march_table.hpp"
#include "scene/toml/round.hpp"
#include "scene/toml/toml_reader.hpp"

namespace lostbits::scene::file {

using toml::Node;
using toml::Override;
using toml::TableReader;

namespace {

constexpr std::string_view schema = "lostbits-scene/1";
constexpr long long most_pixels_a_side = 65536;
constexpr long long most_pixels = 1LL << 30;

constexpr std::pair<std::string_view, Inputs> inputs_names[] = {{"shared", Inputs::shared}, {"own", Inputs::own}};
constexpr std::pair<std::string_view, Camera::Kind> camera_names[] = {{"orthographic", Camera::Kind::orthographic},
                                                                      {"pinhole", Camera::Kind::pinhole},
                                                                      {"pixel_plane", Camera::Kind::pixel_plane}};

template <class E, std::size_t N>
std::span<const std::pair<std::string_view, E>> choices(const std::pair<std::string_view, E> (&names)[N]) {
    return {names, N};
}

/// Reads numbers and holds them against what the scene does with them: rounding to binary32 where inputs are shared.
class Numbers {
public:
    explicit Numbers(Inputs inputs) : shared_(inputs == Inputs::shared) {}

    [[nodiscard]] Real finite(const TableReader& table, std::string_view key, const Real& x) const {
        if (shared_ && std::isinf(toml::round_to_format(x, binary32)))
            table.fail_at(
                key,
                "overflows binary32, to which inputs = \"shared\" rounds; write at most 3.4e38, or inputs = \"own\"");
        return x;
    }

    [[nodiscard]] Vec<Real> finite(const TableReader& table, std::string_view key, const Vec<Real>& v) const {
        return {finite(table, key, v.x), finite(table, key, v.y), finite(table, key, v.z)};
    }

    /// Zero, or zero once rounded.
    [[nodiscard]] bool vanishes(const Real& x) const {
        return x == 0 || (shared_ && toml::round_to_format(x, binary32) == 0);
    }

    [[nodiscard]] Real positive(const TableReader& table, std::string_view key, const Real& x) const {
        if (x <= 0) table.fail_at(key, "must be greater than 0; write a positive number");
        if (shared_ && toml::round_to_format(x, binary32) == 0)
            table.fail_at(key,
                          "becomes 0 in binary32, to which inputs = \"shared\" rounds; write at least 1.5e-45, or "
                          "inputs = \"own\"");
        return finite(table, key, x);
    }

private:
    bool shared_;
};

bool is_zero(const Vec<Real>& v) { return v.x == 0 && v.y == 0 && v.z == 0; }

/// |view × up|² ≤ 2^-80 |view|² |up|²: an angle below 2^-40 leaves the picture's roll to chance.
bool is_parallel(const Vec<Real>& view, const Vec<Real>& up) {
    const Vec<Real> across = cross(view, up);
    return dot(across, across) <= ldexp(dot(view, view) * dot(up, up), -80);
}

/// The camera whose picture plane lies in the world, at z = 0.
Camera read_pixel_plane(TableReader& table, const Numbers& numbers) {
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

Camera read_camera(TableReader table, const Numbers& numbers) {
    Camera camera;
    camera.kind = table.one_of("kind", choices(camera_names));
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

SphereSpec read_sphere(TableReader& table, const Numbers& numbers) {
    SphereSpec sphere{numbers.finite(table, "centre", table.vec3("centre")),
                      numbers.positive(table, "radius", table.number("radius"))};
    table.reject_unknown_keys();
    return sphere;
}

BoxSpec read_box(TableReader& table, const Numbers& numbers) {
    BoxSpec box{numbers.finite(table, "lo", table.vec3("lo")), numbers.finite(table, "hi", table.vec3("hi"))};
    for (int i = 0; i < 3; ++i)
        if (box.lo[i] > box.hi[i]) table.fail_at("hi", "is below lo in a component; a box needs lo <= hi in each");
    table.reject_unknown_keys();
    return box;
}

bool is_plain_name(std::string_view name) {
    const auto plain = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
    };
    return !name.empty() && std::all_of(name.begin(), name.end(), plain);
}

/// The id of a file: it names the folder of the results, so it must not lead out of it or hide it.
std::string stem_of(const std::filesystem::path& path) {
    std::string stem = path.stem().string();
    if (stem.starts_with('.'))
        throw InputError(path.string() + ":1:1: this file name gives no scene id; rename it to start with a letter");
    return stem;
}

Override size_override(const std::pair<int, int>& size) {
    const toml::Where where{"--size " + std::to_string(size.first) + 'x' + std::to_string(size.second), 0, 0};
    return {"size", Node::of_array({Node::of_integer(size.first, where), Node::of_integer(size.second, where)}, where),
            where};
}

}  // namespace

SceneFile::SceneFile(const std::filesystem::path& path) : path_(path), root_(toml::read_toml(path)) {
    TableReader file(root_);
    toml::require_schema(file, schema);
    for (TableReader& table : file.tables("variant")) {
        Variant variant{table.string("name"), {}};
        if (!is_plain_name(variant.name))
            table.fail_at(
                "name", "is \"" + variant.name + "\", but names are part of file names; use letters, digits, - and _");
        const auto same = [&](const Variant& other) { return other.name == variant.name; };
        if (std::any_of(variants_.begin(), variants_.end(), same))
            table.fail_at("name", "is \"" + variant.name +
                                      "\", which is also the name of another variant; give each its own name");
        table.table("set");
        table.reject_unknown_keys();
        const Node& node = root_.find("variant")->items[variants_.size()];
        variant.changes = toml::overrides_in(*node.find("set"));
        variants_.push_back(std::move(variant));
    }
    std::erase_if(root_.entries, [](const Node::Entry& entry) { return entry.key == "variant"; });
}

std::vector<std::string> SceneFile::variants() const {
    std::vector<std::string> names;
    for (const Variant& variant : variants_) names.push_back(variant.name);
    return names;
}

std::vector<Scene> SceneFile::load(const LoadOptions& options) const {
    if (options.variant) {
        for (const Variant& variant : variants_)
            if (variant.name == *options.variant) return {interpret(&variant, options)};
        const std::string hint =
            variants_.empty() ? "the file has none" : toml::did_you_mean(*options.variant, variants());
        throw InputError(path_.string() + ": no variant \"" + *options.variant + "\"; " + hint);
    }
    if (variants_.empty()) return {interpret(nullptr, options)};
    std::vector<Scene> scenes;
    for (const Variant& variant : variants_) scenes.push_back(interpret(&variant, options));
    return scenes;
}

Scene SceneFile::interpret(const Variant* variant, const LoadOptions& options) const {
    Node root = root_;
    if (variant != nullptr)
        for (const Override& change : variant->changes) toml::apply_override(root, change);
    for (const Override& change : options.overrides) toml::apply_override(root, change);
    if (options.size) toml::apply_override(root, size_override(*options.size));

    Scene scene;
    scene.path = path_;
    scene.id = stem_of(path_) + (variant == nullptr ? "" : '.' + variant->name);
    TableReader file(root);
    toml::require_schema(file, schema);
    scene.title = file.string("title");
    scene.source = file.optional_string("source").value_or("-");
    scene.note = file.optional_string("note").value_or("");
    scene.inputs = file.optional_one_of("inputs", choices(inputs_names)).value_or(Inputs::shared);
    if (const auto size = file.optional_integers("size", 2, 1, most_pixels_a_side)) {
        scene.width = static_cast<int>((*size)[0]);
        scene.height = static_cast<int>((*size)[1]);
        if ((*size)[0] * (*size)[1] > most_pixels)
            file.fail_at("size", "is too large: more than 2^30 pixels; make it smaller");
    }
    const Numbers numbers(scene.inputs);
    scene.camera = read_camera(file.table("camera"), numbers);
    const NumberCheck check = [&numbers](const TableReader& table, std::string_view key, const Real& x) {
        return numbers.finite(table, key, x);
    };
    scene.appearance = read_appearance(file, check);
    for (TableReader& table : file.tables("sphere")) {
        scene.appearance.materials.push_back(read_material(table, scene.appearance, check));
        scene.spheres.push_back(read_sphere(table, numbers));
    }
    for (TableReader& table : file.tables("box")) scene.boxes.push_back(read_box(table, numbers));
    if (auto flake = file.optional_table("sphereflake")) scene.flake = read_sphereflake(*flake);
    if (auto march = file.optional_table("march")) scene.march = read_march(*march, scene.inputs);
    file.reject_unknown_keys();
    if (scene.shapes().empty())
        file.fail_at(
            "sphere",
            "is missing; a scene has at least one [[sphere]] with centre and radius, or [[box]] with lo and hi");
    if (scene.shapes().size() > 1 && !scene.march)
        file.fail_at("box",
                     "and [[sphere]] in one scene need a form that marches; write two scenes, or add a [march] table");
    return scene;
}

std::vector<Solid<Real>> Scene::solids() const {
    std::vector<Solid<Real>> all(spheres.begin(), spheres.end());
    all.insert(all.end(), boxes.begin(), boxes.end());
    if (flake) {
        require_room_for(*flake);
        for_each_sphere(*flake, [&all](const Sphere<double>& s) {
            all.emplace_back(Sphere<Real>{{Real(s.centre.x), Real(s.centre.y), Real(s.centre.z)}, Real(s.radius)});
        });
    }
    return all;
}

std::vector<Shape> Scene::shapes() const {
    std::vector<Shape> found;
    if (!spheres.empty() || flake) found.push_back(Shape::sphere);
    if (!boxes.empty()) found.push_back(Shape::box);
    return found;
}

bool Scene::meets(Shape shape) const {
    return shape == Shape::sdf ? march.has_value() : shapes() == std::vector{shape};
}

std::vector<Scene> load_scene(const std::filesystem::path& path, const LoadOptions& options) {
    return SceneFile(path).load(options);
}

std::vector<std::filesystem::path> scene_files(const std::filesystem::path& data_dir) {
    const std::filesystem::path folder = data_dir / "scenes";
    std::error_code error;
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder, error))
        if (entry.path().extension() == ".toml") files.push_back(entry.path());
    if (error)
        throw InputError(folder.string() + ": is not a folder of scenes: " + error.message() +
                         "; name the folder that contains scenes/ with --data");
    std::sort(files.begin(), files.end());
    return files;
}

SceneName find_scene(const std::string& name_or_path, const std::filesystem::path& data_dir) {
    const std::filesystem::path as_path(name_or_path);
    if (as_path.has_parent_path()) return {as_path};
    std::error_code ignored;
    if (std::filesystem::is_regular_file(as_path, ignored) && as_path.extension() == ".toml") return {as_path};

    const std::string name = as_path.extension() == ".toml" ? stem_of(as_path) : name_or_path;
    const std::size_t dot = std::min(name.rfind('.'), name.size());
    const std::string stem = name.substr(0, dot);
    const std::vector<std::filesystem::path> files = scene_files(data_dir);
    std::vector<std::string> ids;
    for (const std::filesystem::path& file : files) ids.push_back(stem_of(file));
    for (std::size_t i = 0; i < files.size(); ++i)
        if (ids[i] == name) return {files[i]};
    for (std::size_t i = 0; i < files.size(); ++i)
        if (dot < name.size() && ids[i] == stem) return {files[i], name.substr(dot + 1)};
    const std::string hint = toml::did_you_mean(stem, ids);
    throw InputError("no scene \"" + name_or_path + "\" in " + (data_dir / "scenes").string() +
                     (hint.empty() ? "" : "; " + hint) + " (a path to a .toml file works too)");
}

}  // namespace lostbits::scene::file
