#include "scene/file/scene.hpp"

#include <algorithm>
#include <limits>
#include <span>

#include "scene/file/march_table.hpp"
#include "scene/file/tables.hpp"
#include "scene/toml/file_names.hpp"
#include "scene/toml/toml_reader.hpp"
#include "shapes/number_names.hpp"

namespace lostbits::scene::file {

using toml::Node;
using toml::Override;
using toml::TableReader;

namespace {

constexpr std::string_view schema = "lostbits-scene/1";
constexpr long long max_pixels_a_side = 65536;
constexpr long long max_pixels = 1LL << 30;

constexpr std::pair<std::string_view, InputRounding> inputs_names[] = {{"shared", InputRounding::shared},
                                                                       {"own", InputRounding::own}};

/// Fails if the primitive breaks a limit of its shape once its numbers are rounded as they are stored.
void require_limits_when_rounded(const Primitive<Real>& primitive, const TableReader& table,
                                 const StoredNumbers& numbers) {
    const auto rounded =
        broken_limit(convert_numbers(primitive, [&](const Real& x) { return numbers.round_as_stored(x); }));
    if (!rounded) return;
    const bool equals_previous = rounded->key->limit == Key::Limit::differs_from_previous ||
                                 rounded->key->limit == Key::Limit::non_negative_below_previous ||
                                 rounded->key->limit == Key::Limit::positive_below_previous;
    if (equals_previous)
        table.fail_at(rounded->key->name, "equals " + std::string((rounded->key - 1)->name) +
                                              " in binary32, to which inputs = \"shared\" rounds; move one of the two, "
                                              "or write inputs = \"own\"");

    if (rounded->key->limit == Key::Limit::not_collinear_with_previous)
        table.fail_at(rounded->key->name, "lies on one line with " + std::string((rounded->key - 2)->name) + " and " +
                                              std::string((rounded->key - 1)->name) +
                                              " in binary32, to which inputs = \"shared\" rounds, so that no ray meets "
                                              "the triangle; move it off the line, or write inputs = \"own\"");

    if (rounded->key->limit == Key::Limit::not_zero)
        table.fail_at(rounded->key->name,
                      "becomes 0 in binary32, to which inputs = \"shared\" rounds; write a longer one, or inputs = "
                      "\"own\"");
}

Primitive<Real> read_primitive(Shape shape, TableReader& table, const StoredNumbers& numbers) {
    Primitive<Real> primitive(shape);
    for_each_key(shape, [&](const Key& key, std::size_t k) {
        if (key.is_optional && !table.has(key.name)) return;
        if (key.count() == 3) primitive.set_point(k, table.vec3(key.name));
        else primitive.numbers[k] = table.number(key.name);
        for (std::size_t i = k; i < k + key.count(); ++i) {
            if (key.limit == Key::Limit::positive || key.limit == Key::Limit::positive_below_previous)
                numbers.require_positive(table, key.name, primitive.numbers[i]);
            else numbers.require_finite(table, key.name, primitive.numbers[i]);
        }
    });

    if (const auto broken = broken_limit(primitive)) table.fail_at(broken->key->name, limit_phrase(shape, *broken));
    require_limits_when_rounded(primitive, table, numbers);

    primitive.transform = read_transform(table, numbers);
    table.require_known_keys();
    return primitive;
}

/// Reads `[rays]`: tmin (default 0), tmax (default: no end) and open_ends, in lengths of the camera's directions. A
/// range that holds no t is an error, also once rounded to binary32 if inputs are shared.
Range<double> read_rays(TableReader table, InputRounding inputs, const StoredNumbers& numbers) {
    const FloatFormat& stored = inputs == InputRounding::shared ? binary32 : binary64;
    Range<double> range;
    const auto number = [&](std::string_view key, double default_t) {
        const auto x = table.optional_number(key);
        return x ? toml::round_to_format(numbers.require_finite(table, key, *x), stored) : default_t;
    };
    range.tmin = number("tmin", range.tmin);
    range.tmax = number("tmax", range.tmax);
    table.read("open_ends", range.open_ends, open_ends_names);
    table.require_known_keys();
    if (range.tmin < 0) table.fail_at("tmin", "is below 0, but a ray only looks ahead; write 0 or more");
    if (!range.holds_any())
        table.fail_at(table.has("tmax") ? "tmax" : "tmin",
                      "leaves no t between tmin and tmax; write a tmax above tmin, or leave one of them out");
    return range;
}

struct PrimitiveTable {
    Shape shape;
    TableReader table;
    std::pair<int, int> position;  ///< line and column in the file
};

/// Returns the tables of primitives in their order in `original`, the file without changes. If a variant or an option
/// rewrites a list, its tables take the positions of the original tables. A list that the original file does not have
/// comes last.
std::vector<PrimitiveTable> primitives_in_order(TableReader& file, const Node& original) {
    std::vector<PrimitiveTable> tables;
    for (const ShapeRow& shape_row : shape_rows) {
        const Node* const original_list = original.find(shape_row.name);
        const std::size_t count = original_list ? original_list->items.size() : 0;
        std::size_t k = 0;
        for (const TableReader& table : file.tables(shape_row.name)) {
            constexpr int last_line = std::numeric_limits<int>::max();
            const toml::SourcePosition where = count == 0 ? toml::SourcePosition{"", last_line, 0}
                                                          : original_list->items[std::min(k++, count - 1)].where;
            tables.push_back({shape_row.shape, table, {where.line, where.column}});
        }
    }
    std::ranges::stable_sort(tables, {}, &PrimitiveTable::position);
    return tables;
}

/// "[[sphere]] with centre and radius; the others are [[box]], ..."
std::string primitive_tables_text() {
    const ShapeRow& first = shape_rows.front();
    std::string text = "[[" + std::string(first.name) + "]] with " + key_phrase(first.shape) + "; the others are ";
    for (const ShapeRow& shape_row : shape_rows.subspan(1)) text += "[[" + std::string(shape_row.name) + "]], ";
    return text + "[sphereflake] and [[mesh]] (data/README.md)";
}

bool is_plain_name(std::string_view name) {
    const auto is_plain = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
    };
    return !name.empty() && std::all_of(name.begin(), name.end(), is_plain);
}

Override size_override(const std::pair<int, int>& size) {
    const toml::SourcePosition where{"--size " + std::to_string(size.first) + 'x' + std::to_string(size.second), 0, 0};
    return {"size", Node::of_array({Node::of_integer(size.first, where), Node::of_integer(size.second, where)}, where),
            where};
}

}  // namespace

SceneFile::SceneFile(const std::filesystem::path& path, intersect::process::StopToken stop)
    : path_(path), root_(toml::read_toml(path, stop)) {
    TableReader file(root_);
    toml::require_schema(file, schema);
    for (TableReader& table : file.tables("variant")) {
        SceneVariant variant{table.string("name"), {}};
        if (!is_plain_name(variant.name))
            table.fail_at(
                "name", "is \"" + variant.name + "\", but names are part of file names; use letters, digits, - and _");
        const auto has_same_name = [&](const SceneVariant& other) { return other.name == variant.name; };
        if (std::any_of(variants_.begin(), variants_.end(), has_same_name))
            table.fail_at("name", "is \"" + variant.name +
                                      "\", which is also the name of another variant; give each its own name");
        table.table("set");
        table.require_known_keys();
        const Node& node = root_.find("variant")->items[variants_.size()];
        variant.changes = toml::read_overrides(*node.find("set"));
        variants_.push_back(std::move(variant));
    }
    std::erase_if(root_.entries, [](const Node::Entry& entry) { return entry.key == "variant"; });
}

std::vector<std::string> SceneFile::variants() const {
    std::vector<std::string> names;
    for (const SceneVariant& variant : variants_) names.push_back(variant.name);
    return names;
}

std::vector<Scene> SceneFile::load(const LoadOptions& options) const {
    if (options.variant) {
        for (const SceneVariant& variant : variants_)
            if (variant.name == *options.variant) return {interpret(&variant, options)};
        const std::string hint =
            variants_.empty() ? "the file has none" : text::did_you_mean(*options.variant, variants());
        throw InputError(path_.string() + ": no variant \"" + *options.variant + "\"; " + hint);
    }
    if (variants_.empty()) return {interpret(nullptr, options)};
    std::vector<Scene> scenes;
    for (const SceneVariant& variant : variants_) scenes.push_back(interpret(&variant, options));
    return scenes;
}

Node SceneFile::root_with_changes(const SceneVariant* variant, const LoadOptions& options) const {
    Node root = root_;
    if (root.find("rays") == nullptr) {  // any scene can get a range from a variant, from --set or from a sweep
        root.entries.push_back({"rays", root.where, {}});
        root.entries.back().value.kind = Node::Kind::table;
    }
    if (variant != nullptr)
        for (const Override& change : variant->changes) toml::apply_override(root, change);
    for (const Override& change : options.overrides) toml::apply_override(root, change);
    if (options.size) toml::apply_override(root, size_override(*options.size));
    return root;
}

namespace {

/// Reads everything in front of the tables.
void read_scene_head(TableReader& file, Scene& scene) {
    scene.title = file.title("title");
    file.read("source", scene.source);
    file.read("note", scene.note);
    file.read("inputs", scene.inputs, inputs_names);
    static_cast<void>(file.has("variant"));  // the variants were removed, but `varient` must still be recognised
    if (const auto size = file.optional_integers("size", 2, 1, max_pixels_a_side)) {
        scene.width = static_cast<int>((*size)[0]);
        scene.height = static_cast<int>((*size)[1]);
        if ((*size)[0] * (*size)[1] > max_pixels)
            file.fail_at("size", "is too large: more than 2^30 pixels; make it smaller");
    }
}

/// Reads the `[[mesh]]` tables and joins them into one mesh. A transform applies to all triangles.
void read_meshes(TableReader& file, const StoredNumbers& numbers, const intersect::process::StopToken& stop,
                 Scene& scene) {
    const triangle::MeshSettings settings{stop, scene.inputs == InputRounding::shared ? binary32 : binary64};
    std::vector<triangle::Mesh> meshes;
    for (TableReader& table : file.tables("mesh")) {
        if (const auto transform = read_transform(table, numbers))
            scene.mesh_transform = convert_numbers(*transform, [](const Real& x) { return x.convert_to<double>(); });
        meshes.push_back(triangle::read_mesh_table(table, scene.path.parent_path(), settings));
        if (scene.mesh_transform && meshes.size() > 1)
            table.fail_at(
                "transform",
                "applies to all triangles of the scene, but there are several meshes; write them into one, or leave it "
                "out");
    }
    if (!meshes.empty()) scene.mesh = std::make_shared<const triangle::Mesh>(triangle::join_meshes(std::move(meshes)));
}

}  // namespace

Scene SceneFile::interpret(const SceneVariant* variant, const LoadOptions& options) const {
    const Node root = root_with_changes(variant, options);
    Scene scene;
    scene.path = path_;
    scene.id = toml::result_name(path_) + (variant == nullptr ? "" : '.' + variant->name);
    TableReader file(root);
    toml::require_schema(file, schema);
    read_scene_head(file, scene);

    const StoredNumbers numbers(scene.inputs);
    TableReader camera = file.table("camera");
    scene.camera = read_camera(camera, numbers);
    scene.appearance = read_appearance(file, numbers);

    // Primitives: listed one by one, a flake, and meshes.
    for (auto& [shape, table, position] : primitives_in_order(file, root_)) {
        if (shape == rendered_shape)
            scene.appearance.materials.push_back(read_material(table, scene.appearance, numbers));
        scene.listed.push_back(read_primitive(shape, table, numbers));
    }
    if (auto flake = file.optional_table("sphereflake")) scene.flake = sphere::read_sphereflake(*flake);
    if (scene.flake) scene.flake->stop = options.stop;
    read_meshes(file, numbers, options.stop, scene);

    if (auto march = file.optional_table("march")) scene.march = read_march(*march, scene.inputs);
    if (auto rays = file.optional_table("rays")) scene.range = read_rays(*rays, scene.inputs, numbers);
    file.require_known_keys();

    if (scene.shapes().empty())
        toml::fail(file.where(), "the scene has no primitives; write at least one, such as " + primitive_tables_text());
    if (scene.camera.ray_generator && scene.inputs == InputRounding::shared && (scene.flake || scene.mesh))
        camera.fail_at("rays",
                       "makes rays in each format, which must also round meshes and flakes; write inputs = "
                       "\"own\"");
    return scene.camera.ray_generator ? with_ray_generator(scene, *scene.camera.ray_generator) : scene;
}

std::vector<Primitive<Real>> Scene::primitives() const {
    std::vector<Primitive<Real>> all = listed;
    if (flake) {
        sphere::require_memory_for(*flake);
        sphere::for_each_primitive(*flake, [&all](const Primitive<double>& primitive) {
            all.push_back(convert_numbers(primitive, [](double x) { return Real(x); }));
        });
    }
    for (std::size_t i = 0; mesh && i < mesh->faces.size(); ++i) {
        Primitive<double> triangle(mesh->triangle(i));
        triangle.transform = mesh_transform;
        all.push_back(convert_numbers(triangle, [](double x) { return Real(x); }));
    }
    return all;
}

std::vector<std::string> Scene::remarks() const {
    if (!mesh) return {};
    return triangle::find_mesh_remarks(*mesh, inputs == InputRounding::shared ? std::optional(binary32) : std::nullopt);
}

std::vector<Shape> Scene::shapes() const {
    std::vector<Shape> scene_shapes;
    for (const ShapeRow& shape_row : shape_rows) {
        const bool is_listed = std::ranges::find(listed, shape_row.shape, &Primitive<Real>::shape) != listed.end();
        if (is_listed || (flake && shape_row.shape == sphere::Sphereflake::shape) ||
            (mesh && shape_row.shape == triangle::Mesh::shape))
            scene_shapes.push_back(shape_row.shape);
    }
    return scene_shapes;
}

bool Scene::has_transform() const {
    return mesh_transform || std::ranges::any_of(listed, [](const Primitive<Real>& primitive) {
               return primitive.transform.has_value();
           });
}

bool Scene::accepts(Shapes form_shapes) const {
    if (form_shapes == Shape::sdf) return march.has_value() && !has_transform();
    return form_shapes == Shapes(shapes()).with_transform(has_transform());
}

std::vector<Scene> load_scene(const std::filesystem::path& path, const LoadOptions& options) {
    return SceneFile(path, options.stop).load(options);
}

std::vector<std::filesystem::path> list_scene_files(const std::filesystem::path& data_dir) {
    const std::filesystem::path folder = toml::find_data_folder(data_dir, "scenes");
    std::error_code error;
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder, error))
        if (entry.path().extension() == ".toml") files.push_back(entry.path());
    if (error) throw InputError(folder.string() + ": cannot be listed: " + error.message());
    std::sort(files.begin(), files.end());
    return files;
}

namespace {

/// Returns `mine.toml` for the file `mine.toml` and for its variant `mine.toml.close`; empty for any other name.
std::filesystem::path scene_path_without_variant(const std::filesystem::path& name) {
    if (name.extension() == ".toml") return name;
    const std::filesystem::path without_variant = name.parent_path() / name.stem();
    return without_variant.extension() == ".toml" ? without_variant : std::filesystem::path();
}

}  // namespace

std::string resolve_beside(const std::filesystem::path& referring_file, const std::string& name) {
    const std::filesystem::path relative(name), neighbour = referring_file.parent_path() / relative;
    std::error_code ignored;
    const bool has_toml_extension = relative.is_relative() && !scene_path_without_variant(relative).empty();
    return has_toml_extension && std::filesystem::is_regular_file(scene_path_without_variant(neighbour), ignored)
               ? neighbour.string()
               : name;
}

SceneName find_scene(const std::string& name_or_path, const std::filesystem::path& data_dir) {
    const std::filesystem::path as_path(name_or_path);
    std::error_code ignored;
    const std::string no_file = name_or_path + ": no such file";
    const auto fail_if_misspelt = [&] {
        if (std::filesystem::exists(as_path, ignored)) return;
        if (const std::string hint_text = toml::suggest_file(as_path); !hint_text.empty())
            throw InputError(no_file + "; " + hint_text);
    };

    // A path to a file, perhaps with a variant behind it.
    if (const auto file = scene_path_without_variant(as_path); !std::filesystem::exists(as_path, ignored) &&
                                                               file != as_path &&
                                                               std::filesystem::is_regular_file(file, ignored))
        return {file, as_path.extension().string().substr(1)};
    if (as_path.has_parent_path()) {
        fail_if_misspelt();
        return {as_path};
    }
    // The path may also be a folder or a pipe; the reader reports that.
    if (std::filesystem::exists(as_path, ignored) && as_path.extension() == ".toml") return {as_path};

    // Otherwise it is the name of a scene of the data, perhaps with a variant.
    const std::string name = as_path.extension() == ".toml" ? toml::result_name(as_path) : name_or_path;
    const std::size_t dot = std::min(name.rfind('.'), name.size());
    const std::string stem = name.substr(0, dot);
    const bool has_toml_extension = as_path.extension() == ".toml";
    if (has_toml_extension && !std::filesystem::is_directory(data_dir / "scenes", ignored))
        throw InputError(no_file + "; check the path");

    const std::vector<std::filesystem::path> files = list_scene_files(data_dir);
    std::vector<std::string> ids;
    for (const std::filesystem::path& file : files) ids.push_back(toml::result_name(file));
    for (std::size_t i = 0; i < files.size(); ++i)
        if (ids[i] == name) return {files[i]};
    for (std::size_t i = 0; i < files.size(); ++i)
        if (dot < name.size() && ids[i] == stem) return {files[i], name.substr(dot + 1)};

    // Nothing has that name: says what may be meant.
    fail_if_misspelt();
    if (!has_toml_extension && std::filesystem::is_regular_file(as_path, ignored))
        throw InputError(name_or_path + ": is not a scene: a scene is a .toml file");
    const std::string hint = text::did_you_mean(stem, ids);
    if (has_toml_extension)
        throw InputError(no_file + ", and no scene \"" + name + "\" in " + (data_dir / "scenes").string() +
                         (hint.empty() ? "" : "; " + hint));
    throw InputError("no scene \"" + name_or_path + "\" in " + (data_dir / "scenes").string() +
                     (hint.empty() ? "" : "; " + hint) +
                     " (a path to a .toml file works too; `lostbits list scenes` lists all names)");
}

}  // namespace lostbits::scene::file
