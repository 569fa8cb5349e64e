#include "analysis/library/given_rays.hpp"

#include "analysis/selection/ray_file_options.hpp"
#include "shapes/number_names.hpp"
#include "text/count_with_noun.hpp"

namespace lostbits::analysis::library {

namespace {

/// The primitives of an array that all rays share, in its order.
std::vector<Primitive<double>> read_shared_primitives(const lostbits_rays& rays, Shape shape, const Format& format) {
    std::vector<ArrayColumn> columns;
    append_columns(columns, rays.primitives, column_names(shape));
    std::vector<Primitive<double>> primitives;
    for (std::size_t i = 0; i < rays.primitive_count; ++i) {
        Primitive<double> primitive(shape);
        for (std::size_t k = 0; k < columns.size(); ++k) primitive.numbers[k] = number_at(columns[k], i, format);
        const auto broken = broken_limit(primitive);
        for (const double x : primitive.shape_numbers())
            if (!std::isfinite(x))
                throw InputError("primitive " + std::to_string(i) + " has a number that is not finite");
        if (broken)
            throw InputError("primitive " + std::to_string(i) + ": " + std::string(broken->key->name) + " " +
                             limit_phrase(shape, *broken));
        primitives.push_back(primitive);
    }
    return primitives;
}

/// Throws InputError if an array that a call needs is missing, or if one reaches beyond the memory.
void require_arrays(const lostbits_rays& rays) {
    if (rays.origin.data == nullptr || rays.direction.data == nullptr)
        throw InputError("rays: origin and direction are arrays of three numbers per ray; give both");
    for (const auto* const array : {&rays.origin, &rays.direction})
        require_addressable(*array, rays.count, 3, rays_name);
    for (const auto* const array : {&rays.tmin, &rays.tmax, &rays.t, &rays.hit, &rays.by})
        require_addressable(*array, rays.count, 1, rays_name);
    require_addressable(rays.matrix, rays.count, scene::ray_file::matrix_columns.size(), rays_name);
    require_addressable(rays.primitives, rays.primitive_count, max_number_count, "primitives");
}

/// The columns of the rays, without those of their primitives.
std::vector<ArrayColumn> list_columns(const lostbits_rays& rays) {
    std::vector<ArrayColumn> columns;
    append_columns(columns, rays.origin, std::array<std::string, 3>{"ox", "oy", "oz"});
    append_columns(columns, rays.direction, std::array<std::string, 3>{"dx", "dy", "dz"});
    append_columns(columns, rays.tmin, std::array<std::string, 1>{"tmin"});
    append_columns(columns, rays.tmax, std::array<std::string, 1>{"tmax"});
    append_columns(columns, rays.t, std::array<std::string, 1>{"t"});
    append_columns(columns, rays.hit, std::array<std::string, 1>{"hit"});
    append_columns(columns, rays.by, std::array<std::string, 1>{"`by`"});  // quoted: cylinders have a column named by
    append_columns(
        columns, rays.matrix,
        std::vector<std::string>(scene::ray_file::matrix_columns.begin(), scene::ray_file::matrix_columns.end()));
    return columns;
}

/// The shape of the first primitive of the rays. Throws InputError if there are no primitives, or if pairs of rays and
/// primitives do not fit.
Shape read_first_shape(const lostbits_rays& rays) {
    if (rays.scene != nullptr) {
        if (rays.scene->scene.shapes().empty()) throw InputError("the scene has no primitives");
        return rays.scene->scene.shapes().front();
    }
    const auto shape = shape_named(rays.shape ? rays.shape : "");
    if (!shape || !is_primitive(*shape) || rays.primitives.data == nullptr)
        throw InputError(
            "rays: the primitives are missing; give their shape (\"sphere\", \"box\", ...) and their numbers, or "
            "a scene");
    if (rays.paired != 0 && rays.primitive_count != rays.count)
        throw InputError("there are " + text::count_with_noun(rays.count, "ray") + " and " +
                         text::count_with_noun(rays.primitive_count, "primitive") +
                         "; pairs need the same number of both");
    if (rays.paired == 0 && rays.primitive_count == 0)
        throw InputError("the list of primitives is empty; give at least one");
    return *shape;
}

}  // namespace

GivenRays read_rays(const lostbits_rays& rays, const CallSettings& settings) {
    require_arrays(rays);
    std::vector<ArrayColumn> columns = list_columns(rays);
    scene::ray_file::ReadOptions options{.stop = settings.stop()};
    if (rays.open_ends != nullptr) options.open_ends = parse_open_ends(rays.open_ends);
    if (rays.format != nullptr) options.format = selection::select_formats({rays.format}, "format").front();

    // Pairs have the numbers of their primitives in further columns.
    GivenRays result;
    result.shape = read_first_shape(rays);
    const bool are_pairs = rays.paired != 0 && rays.scene == nullptr;
    if (are_pairs) append_columns(columns, rays.primitives, column_names(result.shape));
    else options.primitive = result.shape;
    result.ray_file = std::make_unique<RayArrays>(rays_name, std::move(columns), rays.count, options);

    // Other rays share their primitives.
    const Format& format = result.ray_file->format();
    if (rays.scene != nullptr) {
        result.stored = rays.scene->stored->get(rays.scene->scene, format.parameters);
        result.primitives = result.stored->primitives_beside_mesh;
        result.mesh = result.stored->mesh;
    } else if (!are_pairs) {
        result.primitives = read_shared_primitives(rays, result.shape, format);
    }
    selection::transform_by_records(*result.ray_file, result.representatives());
    return result;
}

}  // namespace lostbits::analysis::library
