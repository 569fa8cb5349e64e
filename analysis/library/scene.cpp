// Scenes from files, from texts and from arrays.
#include <sys/mman.h>
#include <unistd.h>

#include "analysis/library/handles.hpp"
#include "number/real.hpp"
#include "scene/rays/rays.hpp"
#include "shapes/given_matrix.hpp"
#include "shapes/number_names.hpp"

namespace lostbits::analysis::library {

using scene::file::Scene;

TextFile::TextFile(const std::string& text) : file_(memfd_create("lostbits", MFD_CLOEXEC)) {
    if (file_ < 0 || write(file_, text.data(), text.size()) != static_cast<ssize_t>(text.size()))
        throw EnvironmentError("the text could not be kept in memory");
    path_ = "/proc/self/fd/" + std::to_string(file_);
}

TextFile::~TextFile() { close(file_); }

namespace {

Scene load_scene(const std::string& name, const lostbits_where& where, const std::string& data) {
    selection::SceneOptions choice{.names = {name},
                                   .size = {},
                                   .variant = {},
                                   .set = to_strings(where.set, "set"),
                                   .stop = make_stop_token(where.stop)};
    if (where.width != 0 || where.height != 0)
        choice.size = std::to_string(where.width) + "x" + std::to_string(where.height);
    return selection::load_one_scene(choice, data);
}

std::string find_data_folder(const lostbits_where& where) {
    return selection::data_folder(where.data ? where.data : "").string();
}

/// Removes the primitives that the scene was read with, once. Call it before primitives are added.
void remove_primitives(lostbits_scene& scene) {
    scene.stored->clear();
    if (scene.has_array_primitives) return;
    scene.has_array_primitives = true;
    scene.explain_arguments.clear();
    scene.scene.listed.clear();
    scene.scene.flake.reset();
    scene.scene.mesh.reset();
}

Shape parse_shape(const char* name) {
    require(name, "shape");
    const auto shape = shape_named(name);
    std::string names;
    for (const ShapeRow& shape_row : shape_rows) names += (names.empty() ? "" : ", ") + std::string(shape_row.name);
    if (!shape || !is_primitive(*shape)) throw InputError("shape \"" + std::string(name) + "\" is not one of " + names);
    return *shape;
}

/// A primitive from its numbers. Throws InputError, as for a file, if the ideal or the stored numbers break a limit.
Primitive<Real> make_primitive(Shape shape, const double* numbers, const Scene& scene, const std::string& subject) {
    Primitive<double> primitive(shape);
    std::copy_n(numbers, primitive.shape_numbers().size(), primitive.shape_numbers().begin());
    for (std::size_t k = 0; k < primitive.shape_numbers().size(); ++k) {
        if (!std::isfinite(primitive.numbers[k]))
            throw InputError(subject + ": " + number_names(shape)[k] + " is " + std::to_string(primitive.numbers[k]) +
                             ", which is not a finite number");
    }

    // With shared inputs, the numbers rounded to binary32 must keep the limits too.
    const bool is_shared = scene.inputs == scene::file::InputRounding::shared;
    for (const Primitive<double>& candidate :
         {primitive, is_shared ? scene::rays::round_primitive(primitive, binary32) : primitive}) {
        if (const auto broken = broken_limit(candidate))
            throw InputError(subject + ": " + std::string(broken->key->name) + " " + limit_phrase(shape, *broken));
    }
    return convert_numbers(primitive, [](double x) { return Real(x); });
}

/// A mesh from three numbers per vertex and three indices per face. Throws InputError for a number that the format
/// cannot store, and for an index without a vertex.
scene::triangle::Mesh make_mesh(std::span<const double> vertices, std::span<const uint32_t> faces,
                                const FloatFormat& stored) {
    scene::triangle::Mesh mesh;
    const std::size_t vertex_count = vertices.size() / 3;
    for (std::size_t i = 0; i < vertex_count; ++i) {
        const double* const v = &vertices[3 * i];
        for (int k = 0; k < 3; ++k)
            if (const auto fault = scene::triangle::reason_to_refuse_coordinate(v[k], stored); !fault.empty())
                throw InputError("vertex " + std::to_string(i) + " has a number that " + std::string(fault));
        mesh.vertices.emplace_back(v[0], v[1], v[2]);
    }
    for (std::size_t i = 0; i < faces.size() / 3; ++i) {
        const uint32_t* const f = &faces[3 * i];
        for (int k = 0; k < 3; ++k)
            if (f[k] >= vertex_count)
                throw InputError("face " + std::to_string(i) + " names vertex " + std::to_string(f[k]) +
                                 "; there are " + std::to_string(vertex_count) + ", counted from 0");
        mesh.faces.push_back({f[0], f[1], f[2]});
    }
    return mesh;
}

void add_rays(const Scene& scene, lostbits_result& result) {
    ResultTable& table = result.tables.emplace_back(
        "rays", std::vector<output::file::Column>{{"x", "integer", "pixel", "column, from the left"},
                                                  {"y", "integer", "pixel", "row, from the top"},
                                                  {"ox", "number", "", "coordinate of the ray's origin"},
                                                  {"oy", "number", "", "coordinate of the ray's origin"},
                                                  {"oz", "number", "", "coordinate of the ray's origin"},
                                                  {"dx", "number", "", "coordinate of the ray's direction"},
                                                  {"dy", "number", "", "coordinate of the ray's direction"},
                                                  {"dz", "number", "", "coordinate of the ray's direction"}});
    auto rays = scene.inputs == scene::file::InputRounding::shared
                    ? scene::rays::make_shared_rays(scene, 0, scene.height)
                    : scene::rays::make_input_rays(scene, 0, scene.height, binary64);
    ResultColumn &x = table["x"], &y = table["y"];
    for (std::uint64_t i = 0; i < scene.pixel_count(); ++i) {
        x.numbers.push_back(static_cast<double>(i % static_cast<std::uint64_t>(scene.width)));
        y.numbers.push_back(static_cast<double>(i / static_cast<std::uint64_t>(scene.width)));
    }
    std::size_t k = 2;  // behind x and y
    for (auto* column : {&rays.ox, &rays.oy, &rays.oz, &rays.dx, &rays.dy, &rays.dz})
        table.columns[k++].numbers = std::move(*column);
}

/// Adds the numbers of the matrix and its direction to the columns.
void add_matrix(const std::optional<Transform<double>>& transform, std::span<ResultColumn> columns) {
    constexpr std::size_t number_count = Affine<double>::number_count;
    for (std::size_t k = 0; k < number_count; ++k)
        columns[k].numbers.push_back(transform ? transform->matrix[k] : measure::truth::missing);
    columns[number_count].numbers.push_back(!transform ? measure::truth::missing : transform->is_inverse ? 1 : 0);
}

void add_primitives(const Scene& scene, lostbits_result& result) {
    const std::vector<Primitive<double>> primitives = scene::rays::make_stored_primitives(scene, binary64);
    for (const Shape shape : scene.shapes()) {
        // Only shapes that matrices place have the columns of a matrix.
        std::vector<output::file::Column> columns;
        const bool has_matrices = std::ranges::any_of(primitives, [shape](const Primitive<double>& primitive) {
            return primitive.shape == shape && primitive.transform;
        });
        for (const std::string& name : number_names(shape))
            columns.push_back({name, "number", "", "number of the primitive, as stored"});
        const std::size_t number_count = columns.size();
        for (std::size_t k = 0; has_matrices && k < Affine<double>::number_count; ++k)
            columns.push_back({"M" + std::to_string(k / 4) + std::to_string(k % 4), "number", "",
                               "number of the matrix that places the primitive, as stored"});
        if (has_matrices)
            columns.push_back({"inverse", "boolean", "", "1 if the matrix maps world space to object space"});
        columns.push_back({"number", "integer", "", "index of the primitive in the scene, from 0"});

        ResultTable& table = result.tables.emplace_back(std::string(name_of(shape)), columns);
        for (std::size_t i = 0; i < primitives.size(); ++i) {
            const Primitive<double>& primitive = primitives[i];
            if (primitive.shape != shape) continue;
            table.columns.back().numbers.push_back(static_cast<double>(i));
            for (std::size_t k = 0; k < number_count; ++k) table.columns[k].numbers.push_back(primitive.numbers[k]);
            if (has_matrices) add_matrix(primitive.transform, std::span(table.columns).subspan(number_count));
        }
    }
}

}  // namespace
}  // namespace lostbits::analysis::library

using namespace lostbits;
using namespace lostbits::analysis;
using namespace lostbits::analysis::library;

extern "C" {

int lostbits_abi(void) { return LOSTBITS_ABI; }
const char* lostbits_version(void) { return LOSTBITS_VERSION; }

int lostbits_scene_open(const char* name, const lostbits_where* where, lostbits_scene** scene, lostbits_error* error) {
    return run_guarded(error, [&] {
        require(name, "name");
        require(scene, "scene");
        const lostbits_where given = where ? *where : lostbits_where{};
        const std::string data = find_data_folder(given);
        auto created = std::make_unique<lostbits_scene>(
            lostbits_scene{.scene = load_scene(name, given, data), .explain_arguments = {}});
        created->explain_arguments = selection::scene_arguments(created->scene, data);
        for (const std::string& assignment : to_strings(given.set, "set"))
            created->explain_arguments += " --set '" + assignment + "'";
        if (given.width != 0)
            created->explain_arguments += " --size " + std::to_string(given.width) + "x" + std::to_string(given.height);
        *scene = created.release();
        return ExitStatus::done;
    });
}

int lostbits_scene_text(const char* text, const lostbits_where* where, lostbits_scene** scene, lostbits_error* error) {
    return run_guarded(error, [&] {
        require(text, "text");
        require(scene, "scene");
        const TextFile file(text);
        auto created = std::make_unique<lostbits_scene>(
            lostbits_scene{.scene = file.run_with_text_positions(
                               [&] { return load_scene(file.path(), where ? *where : lostbits_where{}, ""); }),
                           .explain_arguments = {}});
        created->scene.id = "text";
        created->scene.path.clear();
        *scene = created.release();
        return ExitStatus::done;
    });
}

int lostbits_scene_primitives(lostbits_scene* scene, const char* shape, const double* numbers, size_t count,
                              lostbits_error* error) {
    return run_guarded(error, [&] {
        require(scene, "scene");
        const Shape parsed_shape = parse_shape(shape);
        if (count == 0) throw InputError("the list of primitives is empty; give at least one");
        require(numbers, "numbers");
        const std::span<const double> all_numbers =
            to_span(numbers, count, "numbers", row_of(parsed_shape).number_count);
        std::vector<Primitive<Real>> primitives;
        for (std::size_t i = 0; i < count; ++i)
            primitives.push_back(make_primitive(parsed_shape, &all_numbers[i * row_of(parsed_shape).number_count],
                                                scene->scene,
                                                std::string(row_of(parsed_shape).name) + " " + std::to_string(i)));
        remove_primitives(*scene);
        auto& listed = scene->scene.listed;
        listed.insert(listed.end(), primitives.begin(), primitives.end());
        return ExitStatus::done;
    });
}

int lostbits_scene_mesh(lostbits_scene* scene, const double* vertices, size_t vertex_count, const uint32_t* faces,
                        size_t face_count, lostbits_error* error) {
    return run_guarded(error, [&] {
        require(scene, "scene");
        require(vertices, "vertices");
        require(faces, "faces");
        const std::span<const double> all_vertices = to_span(vertices, vertex_count, "vertices", 3);
        const std::span<const uint32_t> all_faces = to_span(faces, face_count, "faces", 3);
        const FloatFormat& stored = scene->scene.inputs == scene::file::InputRounding::shared ? binary32 : binary64;
        scene::triangle::Mesh mesh = make_mesh(all_vertices, all_faces, stored);
        scene::triangle::merge_and_count(mesh, [](std::size_t face) { return "face " + std::to_string(face); });
        // Without the removed faces every later triangle would have another index than its row.
        if (mesh.removed_face_count > 0)
            throw InputError("faces: " + std::to_string(mesh.removed_face_count) + " of " + std::to_string(face_count) +
                             " have no area (the first is " + mesh.first_removed_face +
                             "); remove these rows, since a triangle is numbered by its row");
        if (mesh.faces.empty()) throw InputError("the mesh has no face; give at least one");

        remove_primitives(*scene);
        scene->scene.mesh = std::make_shared<const scene::triangle::Mesh>(std::move(mesh));
        return ExitStatus::done;
    });
}

int lostbits_scene_transform(lostbits_scene* scene, const double* matrix, int inverse, lostbits_error* error) {
    return run_guarded(error, [&] {
        require(scene, "scene");
        require(matrix, "matrix");
        Scene& target = scene->scene;
        scene->stored->clear();
        if (target.flake) throw InputError("transform: a sphereflake is made in world space and takes no matrix");

        // The matrix has the numbers that a file of the scene would store.
        const bool is_shared = target.inputs == scene::file::InputRounding::shared;
        std::array<double, Affine<double>::number_count> numbers;
        for (std::size_t k = 0; k < numbers.size(); ++k) {
            const double x = is_shared ? rounding::to_format(matrix[k], 0, binary32) : matrix[k];
            if (!std::isfinite(x))
                throw InputError("transform: number " + std::to_string(k) + " is not a finite number" +
                                 (is_shared ? " of float32" : ""));
            numbers[k] = x;
        }
        const Transform<double> transform = transform_of(numbers, inverse != 0);
        if (!transform.is_proper()) throw InputError("transform: the matrix " + std::string(singular_reason));

        for (Primitive<Real>& primitive : target.listed)
            primitive.transform = convert_numbers(transform, [](double x) { return Real(x); });
        if (target.mesh) target.mesh_transform = transform;
        scene->explain_arguments.clear();
        return ExitStatus::done;
    });
}

int lostbits_scene_rays(const lostbits_scene* scene, lostbits_result** result, lostbits_error* error) {
    return run_guarded(error, [&] {
        require(scene, "scene");
        require(result, "result");
        auto created = std::make_unique<lostbits_result>();
        add_rays(scene->scene, *created);
        add_primitives(scene->scene, *created);
        return hand_over(std::move(created), result);
    });
}

int lostbits_shapes(lostbits_result** result, lostbits_error* error) {
    return run_guarded(error, [&] {
        require(result, "result");
        auto created = std::make_unique<lostbits_result>();
        auto csv = created->tables
                       .emplace_back("shapes",
                                     std::vector<output::file::Column>{
                                         {"shape", "string", "", "name of the shape"},
                                         {"key", "string", "", "key of its numbers, in their order"},
                                         {"numbers", "integer", "", "count of numbers of the key"}})
                       .writer();
        for (const ShapeRow& shape_row : shape_rows)
            for (const Key& key : shape_row.keys) csv.add(shape_row.name).add(key.name).add(key.count()).end_row();
        return hand_over(std::move(created), result);
    });
}

void lostbits_scene_free(lostbits_scene* scene) { delete scene; }
}
