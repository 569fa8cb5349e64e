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

constexpr const char* whose = "rays";

/// The arrays as a dump, and the primitives that all rays share.
struct GivenRays {
    std::unique_ptr<ArrayDump> dump;
    /// Empty without a mesh: each ray has its own primitive.
    std::vector<Primitive<double>> primitives = {};
    /// The triangles of the mesh come after `primitives`; null: no mesh.
    std::shared_ptr<const scene::rays::MeshColumns> mesh = {};
    std::shared_ptr<const StoredScene> stored = {};  ///< if they come from a scene
    Shape shape{};                                   ///< of the first primitive
    [[nodiscard]] std::vector<Primitive<double>> examples() const {
        return scene::rays::examples_of(primitives, mesh.get());
    }
};

/// The primitives of an array that all rays share, in its order.
std::vector<Primitive<double>> shared_primitives_of(const lostbits_rays& rays, Shape shape, const Format& format) {
    std::vector<ArrayColumn> columns;
    put_columns(columns, rays.primitives, column_names(shape));
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

GivenRays given(const lostbits_rays& rays, const CallRun& running) {
    if (rays.origin.data == nullptr || rays.direction.data == nullptr)
        throw InputError("rays: origin and direction are arrays of three numbers per ray; give both");
    for (const auto* const array : {&rays.origin, &rays.direction}) require_reach(*array, rays.count, 3, whose);
    for (const auto* const array : {&rays.tmin, &rays.tmax, &rays.t, &rays.hit, &rays.by})
        require_reach(*array, rays.count, 1, whose);
    require_reach(rays.matrix, rays.count, scene::dump::matrix_columns.size(), whose);
    require_reach(rays.primitives, rays.primitive_count, most_numbers, "primitives");
    std::vector<ArrayColumn> columns;
    put_columns(columns, rays.origin, std::array<std::string, 3>{"ox", "oy", "oz"});
    put_columns(columns, rays.direction, std::array<std::string, 3>{"dx", "dy", "dz"});
    put_columns(columns, rays.tmin, std::array<std::string, 1>{"tmin"});
    put_columns(columns, rays.tmax, std::array<std::string, 1>{"tmax"});
    put_columns(columns, rays.t, std::array<std::string, 1>{"t"});
    put_columns(columns, rays.hit, std::array<std::string, 1>{"hit"});
    put_columns(columns, rays.by, std::array<std::string, 1>{"`by`"});  // cylinders have a column by
    put_columns(columns, rays.matrix,
                std::vector<std::string>(scene::dump::matrix_columns.begin(), scene::dump::matrix_columns.end()));
    scene::dump::DumpOptions options{.stop = running.stop()};
    if (rays.open_ends != nullptr) options.open = open_ends_of(rays.open_ends);
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
            throw InputError("there are " + scene::toml::counted(rays.count, "ray") + " and " +
                             scene::toml::counted(rays.primitive_count, "primitive") +
                             "; pairs need the same number of both");
        if (rays.paired == 0 && rays.primitive_count == 0)
            throw InputError("the list of primitives is empty; give at least one");
        if (rays.paired != 0) put_columns(columns, rays.primitives, column_names(*shape));
    }
    if (rays.paired == 0 || rays.scene != nullptr) options.primitive = result.shape;
    result.dump = std::make_unique<ArrayDump>(whose, std::move(columns), rays.count, options);
    const Format& format = result.dump->format();
    if (rays.scene != nullptr) {
        result.stored = rays.scene->stored->in(rays.scene->scene, format.parameters);
        result.primitives = result.stored->beside_mesh;
        result.mesh = result.stored->mesh;
    } else if (rays.paired == 0) {
        result.primitives = shared_primitives_of(rays, result.shape, format);
    }
    selection::put_under_matrices(*result.dump, result.examples());
    return result;
}

/// The contract that the arguments state, for primitives of that shape.
intersect::Info contract_of_arrays(const lostbits_rays& rays, Shape shape) {
    lb_form words{};
    words.name = "own.arrays";
    words.format = LB_F64;
    words.direction = rays.unit != 0 ? LB_UNIT : LB_ANY;
    words.roots = (static_cast<unsigned>(rays.inside) & LB_INSIDE) == LB_INSIDE_NEAR ? LB_NEAR : LB_FIRST;
    words.touching = rays.touching;
    words.at_origin = rays.at_origin;
    if (rays.facing != 0) words.shape = static_cast<int>(shape);
    words.flags = static_cast<unsigned>(rays.inside) | static_cast<unsigned>(rays.facing);
    words.run = [](const lb_batch*) -> const char* { return nullptr; };
    const auto contract = intersect::external::contract_of(words, whose);
    if (rays.scene == nullptr) intersect::require_origin(contract.at_origin, contract.inside, shape, whose);
    intersect::Info info{};
    info.direction = contract.direction;
    info.touching = contract.touching;
    info.at_origin = contract.at_origin;
    info.inside = contract.inside;
    info.facing = contract.facing;
    return info;
}

selection::Meets meets_of(const GivenRays& all) {
    const Shapes shapes = selection::shapes_of_rays(all.dump->layout(), all.examples());
    return [shapes](Shapes forms) { return forms == shapes; };
}

std::unique_ptr<lostbits_result> judge_of(const lostbits_rays& rays, Selection& chosen, CallRun& running) {
    GivenRays all = given(rays, running);
    measure::judge::JudgeRequest request{
        .primitives = all.primitives, .mesh = all.mesh, .limit = {.stop = running.stop()}};
    if (rays.by.data != nullptr) request.by = 0;
    intersect::Info contract = contract_of_arrays(rays, all.shape);
    if (all.dump->layout().decides_only()) contract.roots = intersect::Roots::none;
    const measure::judge::FileForm answers("arrays", all.shape, contract);
    if (!chosen.rows.empty()) chosen.keep_rows_for(whose, meets_of(all));
    else if (!all.dump->layout().has_answers())
        throw NothingSelected("rays: there are neither answers (t or hit) nor forms; give one of them");
    if (all.dump->layout().has_answers()) {
        request.file_form = &answers.form();
        request.rows.push_back({request.file_form, all.dump->format()});
    }
    request.rows.insert(request.rows.end(), chosen.rows.begin(), chosen.rows.end());
    std::vector<const Metric*> asked{measure::metric::find_metric("lost_bits")};
    std::ranges::copy(chosen.asked, std::back_inserter(asked));
    request.metrics = selection::measured(asked, request.rows);
    if (!chosen.rows.empty()) {
        RayGroup group;
        group.primitives = all.examples();
        if (group.primitives.empty()) group.primitives.emplace_back(all.shape);
        if (all.dump->layout().has_matrix()) group.primitives.front().placed = selection::any_matrix();
        request.metrics = chosen.metric_set.for_forms(request.metrics, measure::evaluate::forms_of(chosen.rows),
                                                      [&group] { return measure::attribution::OwnedSetting(group); });
    }
    const auto advance = running.advancing(rays.count);
    request.progress = [&advance](std::uint64_t done, std::uint64_t) { advance(done); };

    auto result = std::make_unique<lostbits_result>();
    std::vector<Shape> shapes;
    const std::vector<Primitive<double>> examples = all.examples();
    for (const ShapeRow& row : shape_rows) {
        const auto of = [&row](const Primitive<double>& primitive) { return primitive.shape == row.shape; };
        if (examples.empty() ? row.shape == all.shape : std::ranges::any_of(examples, of)) shapes.push_back(row.shape);
    }
    const auto summary =
        output::map::summary_table(request.metrics, shapes, all.mesh != nullptr, request.by ? "by" : "");
    ResultTable& table = result->tables.emplace_back("summary", summary.columns());
    std::deque<RayTable> rows;
    for (const TestedForm& row : request.rows) {
        if (chosen.choice.rows == 0) break;
        ResultTable& of_row = result->tables.emplace_back(
            std::string(row.form->info->name) + "." + std::string(row.format.name), RayTable::columns(request.metrics));
        rows.emplace_back(of_row, row, request.metrics);
    }
    const auto found = measure::judge::run_judge(
        *all.dump, request, [&rows](std::size_t r, const auto&, const measure::evaluate::BandResult& band) {
            if (!rows.empty()) rows[r].band(band);
        });
    auto csv = table.writer();
    for (std::size_t r = 0; r < request.rows.size(); ++r) {
        for (const auto& row : output::map::summary_rows(r, request.rows[r], found.summaries[r], found.groups,
                                                         [](const measure::evaluate::WorstRay& ray) {
                                                             return output::attribution::name_of_ray(ray.given.get());
                                                         }))
            summary.add_row(csv, row);
    }
    if (const auto file = request.file_place())
        result->texts = selection::suspicions_of({request.rows[*file]}, [&](const TestedForm&) {
            const auto& summary_of_file = found.summaries[*file];
            const std::string words = measure::contract::suspicion(found.first, measure::contract::AnswerSource::file,
                                                                   found.misses_beside_first(summary_of_file));
            const bool has_all = found.first_are_all(summary_of_file);
            return measure::contract::on_rays_of(whose, has_all ? found.rays : found.first.size(), found.rays,
                                                 "of its rays that hit or should hit", words);
        });
    return result;
}

/// Calls `act(first, group, culler)` in parallel for pieces of the rays. The group has the rays from `first` on and
/// their primitives. The culler finds the primitives that a ray can meet; it is null unless there is a mesh or at least
/// `many` primitives.
template <class Act>
void by_piece(GivenRays& all, CallRun& running, std::size_t count, std::size_t many, const Act& act) {
    constexpr std::size_t piece = 8192;
    const auto advance = running.advancing(count);
    std::optional<measure::culling::Culler> own_culler;
    const measure::culling::Culler* of_all = nullptr;
    if (all.mesh || all.primitives.size() >= many)
        of_all = all.stored ? &all.stored->culler() : &own_culler.emplace(primitive_list(all.primitives, all.mesh));
    intersect::process::in_parallel(std::size_t{0}, (count + piece - 1) / piece, [&](std::size_t p) {
        const std::size_t first = p * piece, n = std::min(piece, count - first);
        scene::dump::Chunk chunk = all.dump->decode({.first = first, .count = n, .bytes = {}});
        RayGroup group;
        group.paired = !chunk.primitives.empty();
        group.primitives = group.paired ? std::move(chunk.primitives) : all.primitives;
        group.mesh = group.paired ? nullptr : all.mesh;
        group.rays = std::move(chunk.rays);
        group.rays.width = static_cast<int>(n);
        group.rays.y1 = 1;
        std::optional<measure::culling::Culler> culler;
        if (of_all && !group.paired) culler.emplace(*of_all, group.rays);
        act(first, std::move(group), culler ? &*culler : nullptr);
        advance(n);
    });
}

std::unique_ptr<lostbits_result> answers_of_forms(const lostbits_rays& rays, Selection& chosen, CallRun& running) {
    GivenRays all = given(rays, running);
    chosen.keep_rows_for(whose, meets_of(all));
    auto result = std::make_unique<lostbits_result>();
    for (const TestedForm& row : chosen.rows) {
        ResultTable& table = result->tables.emplace_back(
            std::string(row.form->info->name) + "." + std::string(row.format.name),
            std::vector<output::file::Column>{{"hit", "boolean", "", "1 if the form answers that the ray hits"},
                                              {"t", "number", "t", "t of the form, in its own unit"}});
        for (ResultColumn& column : table.columns) column.numbers.resize(rays.count);
    }
    by_piece(all, running, rays.count, SIZE_MAX, [&](std::size_t first, RayGroup group, auto* culler) {
        const measure::truth::Band band(std::move(group), {.stop = running.stop()}, culler);
        for (std::size_t r = 0; r < chosen.rows.size(); ++r) {
            const TestedForm& row = chosen.rows[r];
            const auto inputs = band.inputs_for(row.format, *row.form->info);
            const auto answers = measure::answer::evaluate(*row.form, inputs);
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
std::pair<double, double> in_two_words(const measure::truth::Certified& t) {
    const int e = static_cast<int>(std::clamp<std::int64_t>(t.exponent, -3000, 3000));
    return {std::ldexp(t.hi, e), std::ldexp(t.lo, e)};
}

std::unique_ptr<lostbits_result> truth_of_rays(const lostbits_rays& rays, CallRun& running) {
    GivenRays all = given(rays, running);
    const intersect::Info contract = contract_of_arrays(rays, all.shape);
    auto result = std::make_unique<lostbits_result>();
    ResultTable& table = result->tables.emplace_back(
        "truth",
        std::vector<output::file::Column>{{"decision", "integer", "", "0 miss, 1 hit, 2 unresolved"},
                                          {"primitive", "integer", "", "index of the primitive that is hit, from 0"},
                                          {"t_hi", "number", "t", "t*, rounded to the nearest binary64"},
                                          {"t_lo", "number", "t", "t* - t_hi, to 2^-72 of t*"}});
    for (ResultColumn& column : table.columns) column.numbers.assign(rays.count, measure::truth::missing);
    const bool unit = contract.direction == intersect::Direction::unit;
    by_piece(all, running, rays.count, measure::culling::least_primitives,
             [&](std::size_t first, RayGroup group, auto* culler) {
                 const bool paired = group.paired;
                 const measure::truth::Band band(std::move(group), {.stop = running.stop()}, culler);
                 for (std::size_t i = 0; i < band.pixels(); ++i) {
                     const measure::truth::Truth truth = band.truth(i, contract.convention());
                     table.columns[0].numbers[first + i] = static_cast<double>(truth.decision);
                     if (!truth.is_hit()) continue;
                     table.columns[1].numbers[first + i] = static_cast<double>(paired ? first + i : truth.object);
                     std::tie(table.columns[2].numbers[first + i], table.columns[3].numbers[first + i]) =
                         in_two_words(unit ? truth.distance : truth.t);
                 }
             });
    return result;
}

std::unique_ptr<lostbits_result> hits_of_rays(const lostbits_rays& rays, CallRun& running) {
    GivenRays all = given(rays, running);
    const auto is_triangle = [](const auto& one) { return one.shape == scene::triangle::Mesh::shape; };
    if (rays.paired != 0 || !std::ranges::all_of(all.examples(), is_triangle))
        throw InputError("rays: crossings need triangles that all rays share; give a mesh, or an array of triangles");
    std::vector<measure::crossing::MeshCrossings> found(rays.count);
    by_piece(all, running, rays.count, measure::culling::least_primitives,
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
        for (const measure::crossing::MeshCrossing& one : found[i].in_order) {
            table.columns[0].numbers.push_back(static_cast<double>(i));
            table.columns[1].numbers.push_back(one.place);
            table.columns[2].numbers.push_back(one.triangle);
            const auto [hi, lo] = in_two_words(one.t);
            table.columns[3].numbers.push_back(hi), table.columns[4].numbers.push_back(lo);
            table.columns[5].numbers.push_back(one.front ? 1 : 0);
            table.columns[6].numbers.push_back(one.at_rim ? 1 : 0);
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
    require_reach(points, count, 3, "points");
    const auto stored = scene.stored->in(scene.scene, binary64);
    if (!stored->mesh || !stored->beside_mesh.empty())
        throw InputError("inside: the scene must have meshes and no other primitives; give mesh=(vertices, faces)");
    const Format format = *find_format("f64");
    std::vector<ArrayColumn> columns;
    put_columns(columns, points, std::array<std::string, 3>{"x", "y", "z"});
    std::vector<measure::crossing::PointInMesh> found(count);
    const measure::crossing::Triangles triangles{stored->culler().shared(), stored->culler().for_truth()};
    const auto advance = running.advancing(count);
    constexpr std::size_t piece = 1024;
    intersect::process::in_parallel(std::size_t{0}, (count + piece - 1) / piece, [&](std::size_t p) {
        const std::size_t first = p * piece, n = std::min(piece, count - first);
        for (std::size_t i = first; i < first + n; ++i) {
            Vec<double> point;
            for (int k = 0; k < 3; ++k) point[k] = number_at(columns[static_cast<std::size_t>(k)], i, format);
            if (!measure::truth::is_proper(Ray<double>{point, {1, 1, 1}}))
                throw InputError("point " + std::to_string(i) + " has a number that is not finite");
            found[i] = measure::crossing::place_in_mesh(point, triangles, {.stop = running.stop()});
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
    for (const measure::crossing::PointInMesh& one : found) {
        table.columns[0].numbers.push_back(one.winding);
        table.columns[1].numbers.push_back(one.crossings);
        table.columns[2].numbers.push_back(one.on_surface ? 1 : 0);
        table.columns[3].numbers.push_back(one.is_resolved ? 1 : 0);
    }
    add_edges(stored->mesh->mesh().edges, *result);
    return result;
}

template <class Find>
int call(lostbits_result** result, lostbits_error* error, const lostbits_rays* rays, const Find& find) {
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
    return call(result, error, rays, [&] {
        Selection chosen(choice, true);
        CallRun running(run);
        return judge_of(*rays, chosen, running);
    });
}

int lostbits_answers(const lostbits_rays* rays, const lostbits_choice* choice, const lostbits_run* run,
                     lostbits_result** result, lostbits_error* error) {
    return call(result, error, rays, [&] {
        Selection chosen(choice);
        CallRun running(run);
        return answers_of_forms(*rays, chosen, running);
    });
}

int lostbits_truth(const lostbits_rays* rays, const lostbits_run* run, lostbits_result** result,
                   lostbits_error* error) {
    return call(result, error, rays, [&] {
        CallRun running(run);
        return truth_of_rays(*rays, running);
    });
}

int lostbits_hits(const lostbits_rays* rays, const lostbits_run* run, lostbits_result** result, lostbits_error* error) {
    return call(result, error, rays, [&] {
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
