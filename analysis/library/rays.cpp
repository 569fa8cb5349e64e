// Rays given as arrays: judges answers to them, and returns answers of forms, the truth and all crossings.
#include "scene/rays/rays.hpp"
#include "analysis/library/array_dump.hpp"
#include "analysis/library/handles.hpp"
#include "analysis/selection/judge_options.hpp"
#include "intersect/conventions.hpp"
#include "intersect/process/parallel.hpp"
#include "measure/answer/answers.hpp"
#include "measure/attribution/culprits.hpp"
#include "measure/crossing/mesh_crossings.hpp"
#include "measure/judge/judge.hpp"
#include "output/attribution/explain_command.hpp"
#include "output/map/map_tables.hpp"
#include "scene/rays/stored_mesh.hpp"
#include "scene/toml/counted.hpp"
#include "shapes/number_names.hpp"

namespace lostbits::analysis::library {

using measure::evaluate::TestedForm;
using measure::metric::Metric;
using scene::file::Scene;
using scene::rays::RayGroup;

namespace {

constexpr const char* rays_name = "rays";

/// The arrays as a dump, and the primitives that all rays share.
struct GivenRays {
    std::unique_ptr<ArrayDump> dump;
    /// Primitives that all rays share. Without a mesh, an empty list means that each ray has its own primitive.
    std::vector<Primitive<double>> primitives = {};
    /// The triangles of the mesh come after `primitives`; null: no mesh.
    std::shared_ptr<const scene::rays::MeshColumns> mesh = {};
    std::shared_ptr<const StoredScene> stored = {};  ///< the scene with these primitives; null: they are from arrays
    Shape shape{};                                   ///< of the first primitive
    [[nodiscard]] std::vector<Primitive<double>> representatives() const {
        return scene::rays::representatives_of(primitives, mesh.get());
    }
};

/// The primitives of an array that all rays share, in its order.
std::vector<Primitive<double>> shared_primitives_of(const lostbits_rays& rays, Shape shape, const Format& format) {
    std::vector<ArrayColumn> columns;
    append_columns(columns, rays.primitives, column_names(shape));
    std::vector<Primitive<double>> primitives;
    for (std::size_t i = 0; i < rays.primitive_count; ++i) {
        Primitive<double> primitive(shape);
        for (std::size_t k = 0; k < columns.size(); ++k) primitive.numbers[k] = number_at(columns[k], i, format);
        const auto broken = broken_limit(primitive);
        for (const double x : primitive.used())
            if (!std::isfinite(x))
                throw InputError("primitive " + std::to_string(i) + " has a number that is not finite");
        if (broken)
            throw InputError("primitive " + std::to_string(i) + ": " + std::string(broken->key->name) + " " +
                             limit_phrase(shape, *broken->key));
        primitives.push_back(primitive);
    }
    return primitives;
}

GivenRays read_rays(const lostbits_rays& rays, const CallRun& running) {
    if (rays.origin.data == nullptr || rays.direction.data == nullptr)
        throw InputError("rays: origin and direction are arrays of three numbers per ray; give both");
    for (const auto* const array : {&rays.origin, &rays.direction})
        require_addressable(*array, rays.count, 3, rays_name);
    for (const auto* const array : {&rays.tmin, &rays.tmax, &rays.t, &rays.hit, &rays.by})
        require_addressable(*array, rays.count, 1, rays_name);
    require_addressable(rays.matrix, rays.count, scene::dump::matrix_columns.size(), rays_name);
    require_addressable(rays.primitives, rays.primitive_count, most_numbers, "primitives");
    std::vector<ArrayColumn> columns;
    append_columns(columns, rays.origin, std::array<std::string, 3>{"ox", "oy", "oz"});
    append_columns(columns, rays.direction, std::array<std::string, 3>{"dx", "dy", "dz"});
    append_columns(columns, rays.tmin, std::array<std::string, 1>{"tmin"});
    append_columns(columns, rays.tmax, std::array<std::string, 1>{"tmax"});
    append_columns(columns, rays.t, std::array<std::string, 1>{"t"});
    append_columns(columns, rays.hit, std::array<std::string, 1>{"hit"});
    append_columns(columns, rays.by, std::array<std::string, 1>{"`by`"});  // quoted: cylinders have a column named by
    append_columns(columns, rays.matrix,
                   std::vector<std::string>(scene::dump::matrix_columns.begin(), scene::dump::matrix_columns.end()));
    scene::dump::DumpOptions options{.stop = running.stop()};
    if (rays.open_ends != nullptr) options.open = parse_open_ends(rays.open_ends);
    if (rays.format != nullptr) options.format = selection::select_formats({rays.format}, "format").front();
    GivenRays result;
    if (rays.scene != nullptr) {
        if (rays.scene->scene.shapes().empty()) throw InputError("the scene has no primitives");
        result.shape = rays.scene->scene.shapes().front();
    } else {
        const auto shape = shape_named(rays.shape ? rays.shape : "");
        if (!shape || !is_primitive(*shape) || rays.primitives.data == nullptr)
            throw InputError(
                "rays: the primitives are missing; give their shape (\"sphere\", \"box\", ...) and their numbers, or "
                "a scene");
        result.shape = *shape;
        if (rays.paired != 0 && rays.primitive_count != rays.count)
            throw InputError("there are " + scene::toml::count_with_noun(rays.count, "ray") + " and " +
                             scene::toml::count_with_noun(rays.primitive_count, "primitive") +
                             "; pairs need the same number of both");
        if (rays.paired == 0 && rays.primitive_count == 0)
            throw InputError("the list of primitives is empty; give at least one");
        if (rays.paired != 0) append_columns(columns, rays.primitives, column_names(*shape));
    }
    if (rays.paired == 0 || rays.scene != nullptr) options.primitive = result.shape;
    result.dump = std::make_unique<ArrayDump>(rays_name, std::move(columns), rays.count, options);
    const Format& format = result.dump->format();
    if (rays.scene != nullptr) {
        result.stored = rays.scene->stored->get(rays.scene->scene, format.parameters);
        result.primitives = result.stored->beside_mesh;
        result.mesh = result.stored->mesh;
    } else if (rays.paired == 0) {
        result.primitives = shared_primitives_of(rays, result.shape, format);
    }
    selection::put_under_matrices(*result.dump, result.representatives());
    return result;
}

/// The contract that the arguments of the call state, for primitives of a shape.
intersect::Info contract_of_arrays(const lostbits_rays& rays, Shape shape) {
    lb_form form{};
    form.name = "own.arrays";
    form.format = LB_F64;
    form.direction = rays.unit != 0 ? LB_UNIT : LB_ANY;
    form.roots = (static_cast<unsigned>(rays.inside) & LB_INSIDE) == LB_INSIDE_NEAR ? LB_NEAR : LB_FIRST;
    form.touching = rays.touching;
    form.at_origin = rays.at_origin;
    if (rays.facing != 0) form.shape = static_cast<int>(shape);
    form.flags = static_cast<unsigned>(rays.inside) | static_cast<unsigned>(rays.facing);
    form.run = [](const lb_batch*) -> const char* { return nullptr; };
    const auto contract = intersect::external::contract_of(form, rays_name);
    if (rays.scene == nullptr) intersect::require_origin(contract.at_origin, contract.inside, shape, rays_name);
    intersect::Info info{};
    info.direction = contract.direction;
    info.touching = contract.touching;
    info.at_origin = contract.at_origin;
    info.inside = contract.inside;
    info.facing = contract.facing;
    return info;
}

/// Selects the forms whose shapes are exactly those of the rays' primitives.
selection::ShapePredicate shape_filter_of(const GivenRays& given) {
    const Shapes shapes = selection::shapes_of_rays(given.dump->layout(), given.representatives());
    return [shapes](Shapes forms) { return forms == shapes; };
}

std::unique_ptr<lostbits_result> judge_given_rays(const lostbits_rays& rays, Selection& chosen, CallRun& running) {
    GivenRays given = read_rays(rays, running);
    measure::judge::JudgeRequest request{
        .primitives = given.primitives, .mesh = given.mesh, .limit = {.stop = running.stop()}};
    if (rays.by.data != nullptr) request.by = 0;
    intersect::Info contract = contract_of_arrays(rays, given.shape);
    if (given.dump->layout().decides_only()) contract.roots = intersect::Roots::none;
    const measure::judge::FileForm answers("arrays", given.shape, contract);
    if (!chosen.rows.empty()) chosen.keep_rows_for(rays_name, shape_filter_of(given));
    else if (!given.dump->layout().has_answers())
        throw NothingSelected("rays: there are neither answers (t or hit) nor forms; give one of them");
    if (given.dump->layout().has_answers()) {
        request.file_form = &answers.form();
        request.rows.push_back({request.file_form, given.dump->format()});
    }
    request.rows.insert(request.rows.end(), chosen.rows.begin(), chosen.rows.end());
    std::vector<const Metric*> metrics{measure::metric::find_metric("lost_bits")};
    std::ranges::copy(chosen.extra_metrics, std::back_inserter(metrics));
    request.metrics = selection::measured(metrics, request.rows);
    if (!chosen.rows.empty()) {
        RayGroup group;
        group.primitives = given.representatives();
        if (group.primitives.empty()) group.primitives.emplace_back(given.shape);
        if (given.dump->layout().has_matrix()) group.primitives.front().placed = selection::any_matrix();
        request.metrics =
            chosen.metric_set.adapt_to_forms(request.metrics, measure::evaluate::forms_of(chosen.rows),
                                             [&group] { return measure::attribution::OwnedSetting(group); });
    }
    const auto advance = running.advance_callback(rays.count);
    request.progress = [&advance](std::uint64_t done, std::uint64_t) { advance(done); };

    auto result = std::make_unique<lostbits_result>();
    std::vector<Shape> shapes;
    const std::vector<Primitive<double>> representatives = given.representatives();
    for (const ShapeRow& shape_row : shape_rows) {
        const auto has_shape = [&shape_row](const Primitive<double>& primitive) {
            return primitive.shape == shape_row.shape;
        };
        if (representatives.empty() ? shape_row.shape == given.shape : std::ranges::any_of(representatives, has_shape))
            shapes.push_back(shape_row.shape);
    }
    const auto summary =
        output::map::summary_table(request.metrics, shapes, given.mesh != nullptr, request.by ? "by" : "");
    ResultTable& table = result->tables.emplace_back("summary", summary.columns());
    std::deque<RayTable> rows;
    for (const TestedForm& form_row : request.rows) {
        if (chosen.choice.rows == 0) break;
        ResultTable& ray_table = result->tables.emplace_back(
            std::string(form_row.form->info->name) + "." + std::string(form_row.format.name),
            RayTable::columns(request.metrics));
        rows.emplace_back(ray_table, form_row, request.metrics);
    }
    const auto judgement = measure::judge::run_judge(
        *given.dump, request, [&rows](std::size_t r, const auto&, const measure::evaluate::BandResult& band) {
            if (!rows.empty()) rows[r].band(band);
        });
    auto csv = table.writer();
    for (std::size_t r = 0; r < request.rows.size(); ++r) {
        for (const auto& row :
             output::map::summary_rows(r, request.rows[r], judgement.summaries[r], judgement.groups,
                                       [](const measure::evaluate::WorstRay& ray) {
                                           return output::attribution::explain_ray_arguments(ray.given.get());
                                       }))
            summary.add_row(csv, row);
    }
    if (const auto file_row = request.file_row_index())
        result->texts = selection::suspicions_of({request.rows[*file_row]}, [&](const TestedForm&) {
            const auto& summary_of_file = judgement.summaries[*file_row];
            const std::string suspicion_text = measure::contract::suspicion(
                judgement.first, measure::contract::AnswerSource::file, judgement.misses_beside_first(summary_of_file));
            const bool is_whole = judgement.first_are_all(summary_of_file);
            return measure::contract::on_rays_of(rays_name, is_whole ? judgement.rays : judgement.first.size(),
                                                 judgement.rays, "of its rays that hit or should hit", suspicion_text);
        });
    return result;
}

/// Calls `act(first, group, culler)` in parallel for pieces of the rays. The group has the rays from `first` on and
/// their primitives. The culler finds the primitives that a ray can meet; it is null unless there is a mesh or at least
/// `culling_threshold` primitives.
template <class Act>
void for_each_piece(GivenRays& given, CallRun& running, std::size_t count, std::size_t culling_threshold,
                    const Act& act) {
    constexpr std::size_t piece = 8192;
    const auto advance = running.advance_callback(count);
    std::optional<measure::culling::Culler> own_culler;
    const measure::culling::Culler* shared_culler = nullptr;
    if (given.mesh || given.primitives.size() >= culling_threshold)
        shared_culler =
            given.stored ? &given.stored->culler() : &own_culler.emplace(primitive_list(given.primitives, given.mesh));
    intersect::process::in_parallel(std::size_t{0}, (count + piece - 1) / piece, [&](std::size_t p) {
        const std::size_t first = p * piece, n = std::min(piece, count - first);
        scene::dump::Chunk chunk = given.dump->decode({.first = first, .count = n, .bytes = {}});
        RayGroup group;
        group.paired = !chunk.primitives.empty();
        group.primitives = group.paired ? std::move(chunk.primitives) : given.primitives;
        group.mesh = group.paired ? nullptr : given.mesh;
        group.rays = std::move(chunk.rays);
        group.rays.width = static_cast<int>(n);
        group.rays.y1 = 1;
        std::optional<measure::culling::Culler> culler;
        if (shared_culler && !group.paired) culler.emplace(*shared_culler, group.rays);
        act(first, std::move(group), culler ? &*culler : nullptr);
        advance(n);
    });
}

std::unique_ptr<lostbits_result> answers_of_forms(const lostbits_rays& rays, Selection& chosen, CallRun& running) {
    GivenRays given = read_rays(rays, running);
    chosen.keep_rows_for(rays_name, shape_filter_of(given));
    auto result = std::make_unique<lostbits_result>();
    for (const TestedForm& form_row : chosen.rows) {
        ResultTable& table = result->tables.emplace_back(
            std::string(form_row.form->info->name) + "." + std::string(form_row.format.name),
            std::vector<output::file::Column>{{"hit", "boolean", "", "1 if the form answers that the ray hits"},
                                              {"t", "number", "t", "t of the form, in its own unit"}});
        for (ResultColumn& column : table.columns) column.numbers.resize(rays.count);
    }
    for_each_piece(given, running, rays.count, SIZE_MAX, [&](std::size_t first, RayGroup group, auto* culler) {
        const measure::truth::Band band(std::move(group), {.stop = running.stop()}, culler);
        for (std::size_t r = 0; r < chosen.rows.size(); ++r) {
            const TestedForm& form_row = chosen.rows[r];
            const auto inputs = band.inputs_for(form_row.format, *form_row.form->info);
            const auto answers = measure::answer::evaluate(*form_row.form, inputs);
            ResultTable& table = result->tables[r];
            for (std::size_t i = 0; i < answers.t.size(); ++i) {
                table.columns[0].numbers[first + i] = answers.hit[i] != 0 ? 1 : 0;
                table.columns[1].numbers[first + i] = answers.hit[i] != 0 ? answers.t[i] : measure::truth::missing;
            }
        }
    });
    return result;
}

/// A certified number as a sum of two doubles.
std::pair<double, double> as_two_doubles(const measure::truth::Certified& t) {
    const int e = static_cast<int>(std::clamp<std::int64_t>(t.exponent, -3000, 3000));
    return {std::ldexp(t.hi, e), std::ldexp(t.lo, e)};
}

std::unique_ptr<lostbits_result> truth_of_rays(const lostbits_rays& rays, CallRun& running) {
    GivenRays given = read_rays(rays, running);
    const intersect::Info contract = contract_of_arrays(rays, given.shape);
    auto result = std::make_unique<lostbits_result>();
    ResultTable& table = result->tables.emplace_back(
        "truth",
        std::vector<output::file::Column>{{"decision", "integer", "", "0 miss, 1 hit, 2 unresolved"},
                                          {"primitive", "integer", "", "index of the primitive that is hit, from 0"},
                                          {"t_hi", "number", "t", "t*, rounded to the nearest binary64"},
                                          {"t_lo", "number", "t", "t* - t_hi, to 2^-72 of t*"}});
    for (ResultColumn& column : table.columns) column.numbers.assign(rays.count, measure::truth::missing);
    const bool unit = contract.direction == intersect::Direction::unit;
    for_each_piece(given, running, rays.count, measure::culling::least_primitives,
                   [&](std::size_t first, RayGroup group, auto* culler) {
                       const bool paired = group.paired;
                       const measure::truth::Band band(std::move(group), {.stop = running.stop()}, culler);
                       for (std::size_t i = 0; i < band.pixels(); ++i) {
                           const measure::truth::Truth truth = band.truth(i, contract.convention());
                           table.columns[0].numbers[first + i] = static_cast<double>(truth.decision);
                           if (!truth.is_hit()) continue;
                           table.columns[1].numbers[first + i] = static_cast<double>(paired ? first + i : truth.object);
                           std::tie(table.columns[2].numbers[first + i], table.columns[3].numbers[first + i]) =
                               as_two_doubles(unit ? truth.distance : truth.t);
                       }
                   });
    return result;
}

std::unique_ptr<lostbits_result> hits_of_rays(const lostbits_rays& rays, CallRun& running) {
    GivenRays given = read_rays(rays, running);
    const auto is_triangle = [](const auto& primitive) { return primitive.shape == scene::triangle::Mesh::shape; };
    if (rays.paired != 0 || !std::ranges::all_of(given.representatives(), is_triangle))
        throw InputError("rays: crossings need triangles that all rays share; give a mesh, or an array of triangles");
    std::vector<measure::crossing::MeshCrossings> found(rays.count);
    for_each_piece(given, running, rays.count, measure::culling::least_primitives,
                   [&](std::size_t first, RayGroup group, auto* culler) {
                       const auto primitives = scene::rays::primitive_list_of(group);
                       for (std::size_t i = 0; i < group.rays.size(); ++i)
                           found[first + i] = measure::crossing::crossings_of(
                               group.rays[i], {primitives, culler ? culler->for_truth() : nullptr}, group.rays.range(i),
                               {.stop = running.stop()});
                   });
    auto result = std::make_unique<lostbits_result>();
    ResultTable& table = result->tables.emplace_back(
        "crossings",
        std::vector<output::file::Column>{
            {"ray", "integer", "", "the ray, from 0"},
            {"place", "integer", "", "in the order of t, from 0; crossings at the same t have the same place"},
            {"primitive", "integer", "", "the triangle, from 0"},
            {"t_hi", "number", "t", "t*, rounded to the nearest binary64"},
            {"t_lo", "number", "t", "t* - t_hi, to 2^-72 of t*"},
            {"front", "boolean", "", "the ray meets the side on which the corners run counter-clockwise"},
            {"at_rim", "boolean", "", "the ray passes through an edge or a vertex"}});
    ResultTable& resolved = result->tables.emplace_back(
        "rays", std::vector<output::file::Column>{{"resolved", "boolean", "", "every decision is proved"}});
    for (std::size_t i = 0; i < found.size(); ++i) {
        resolved.columns[0].numbers.push_back(found[i].is_resolved ? 1 : 0);
        for (const measure::crossing::MeshCrossing& crossing : found[i].in_order) {
            table.columns[0].numbers.push_back(static_cast<double>(i));
            table.columns[1].numbers.push_back(crossing.rank);
            table.columns[2].numbers.push_back(crossing.triangle);
            const auto [hi, lo] = as_two_doubles(crossing.t);
            table.columns[3].numbers.push_back(hi), table.columns[4].numbers.push_back(lo);
            table.columns[5].numbers.push_back(crossing.hits_front ? 1 : 0);
            table.columns[6].numbers.push_back(crossing.is_at_rim ? 1 : 0);
        }
    }
    return result;
}

void add_edges(const scene::triangle::MeshEdges& edges, lostbits_result& result) {
    auto csv =
        result.tables
            .emplace_back("mesh",
                          std::vector<output::file::Column>{
                              {"edges", "integer", "", "edges of the faces"},
                              {"border", "integer", "", "edges of one face"},
                              {"non_manifold", "integer", "", "edges of more than two faces"},
                              {"unbalanced", "integer", "", "edges along which more faces run one way than the other"},
                              {"odd", "integer", "", "edges of an odd number of faces"},
                              {"duplicates", "integer", "", "faces with the vertices of an earlier face"}})
            .writer();
    csv.add(edges.edges).add(edges.border).add(edges.non_manifold).add(edges.unbalanced).add(edges.odd);
    csv.add(edges.duplicates).end_row();
}

std::unique_ptr<lostbits_result> places_of_points(const lostbits_scene& scene, const lostbits_array& points,
                                                  std::size_t count, CallRun& running) {
    if (points.data == nullptr) throw InputError("points: the array is missing; give three numbers per point");
    require_addressable(points, count, 3, "points");
    const auto stored = scene.stored->get(scene.scene, binary64);
    if (!stored->mesh || !stored->beside_mesh.empty())
        throw InputError("inside: the scene must have meshes and no other primitives; give mesh=(vertices, faces)");
    const Format format = *find_format("f64");
    std::vector<ArrayColumn> columns;
    append_columns(columns, points, std::array<std::string, 3>{"x", "y", "z"});
    std::vector<measure::crossing::PointInMesh> found(count);
    const measure::crossing::Triangles triangles{stored->culler().shared(), stored->culler().for_truth()};
    const auto advance = running.advance_callback(count);
    constexpr std::size_t piece = 1024;
    intersect::process::in_parallel(std::size_t{0}, (count + piece - 1) / piece, [&](std::size_t p) {
        const std::size_t first = p * piece, n = std::min(piece, count - first);
        for (std::size_t i = first; i < first + n; ++i) {
            Vec<double> point;
            for (int k = 0; k < 3; ++k) point[k] = number_at(columns[static_cast<std::size_t>(k)], i, format);
            if (!measure::truth::is_proper(Ray<double>{point, {1, 1, 1}}))
                throw InputError("point " + std::to_string(i) + " has a number that is not finite");
            found[i] = measure::crossing::locate_in_mesh(point, triangles, {.stop = running.stop()});
        }
        advance(n);
    });
    auto result = std::make_unique<lostbits_result>();
    ResultTable& table = result->tables.emplace_back(
        "points", std::vector<output::file::Column>{
                      {"winding", "integer", "", "number of layers of the surface that enclose the point"},
                      {"crossings", "integer", "", "crossings of the ray by which the layers are counted"},
                      {"on_surface", "boolean", "", "the point lies on a triangle"},
                      {"resolved", "boolean", "", "the other columns are proved"}});
    for (const measure::crossing::PointInMesh& point : found) {
        table.columns[0].numbers.push_back(point.winding);
        table.columns[1].numbers.push_back(point.crossings);
        table.columns[2].numbers.push_back(point.is_on_surface ? 1 : 0);
        table.columns[3].numbers.push_back(point.is_resolved ? 1 : 0);
    }
    add_edges(stored->mesh->mesh().edges, *result);
    return result;
}

template <class Find>
int run_call(lostbits_result** result, lostbits_error* error, const lostbits_rays* rays, const Find& find) {
    return guarded(error, [&] {
        require(rays, "rays");
        require(result, "result");
        return hand_over(find(), result);
    });
}

}  // namespace

}  // namespace lostbits::analysis::library

using namespace lostbits::analysis::library;

extern "C" {

int lostbits_judge(const lostbits_rays* rays, const lostbits_choice* choice, const lostbits_run* run,
                   lostbits_result** result, lostbits_error* error) {
    return run_call(result, error, rays, [&] {
        Selection chosen(choice, true);
        CallRun running(run);
        return judge_given_rays(*rays, chosen, running);
    });
}

int lostbits_answers(const lostbits_rays* rays, const lostbits_choice* choice, const lostbits_run* run,
                     lostbits_result** result, lostbits_error* error) {
    return run_call(result, error, rays, [&] {
        Selection chosen(choice);
        CallRun running(run);
        return answers_of_forms(*rays, chosen, running);
    });
}

int lostbits_truth(const lostbits_rays* rays, const lostbits_run* run, lostbits_result** result,
                   lostbits_error* error) {
    return run_call(result, error, rays, [&] {
        CallRun running(run);
        return truth_of_rays(*rays, running);
    });
}

int lostbits_hits(const lostbits_rays* rays, const lostbits_run* run, lostbits_result** result, lostbits_error* error) {
    return run_call(result, error, rays, [&] {
        CallRun running(run);
        return hits_of_rays(*rays, running);
    });
}

int lostbits_inside(const lostbits_scene* scene, const lostbits_array* points, size_t count, const lostbits_run* run,
                    lostbits_result** result, lostbits_error* error) {
    return guarded(error, [&] {
        require(scene, "scene");
        require(points, "points");
        require(result, "result");
        CallRun running(run);
        return hand_over(places_of_points(*scene, *points, count, running), result);
    });
}
}
