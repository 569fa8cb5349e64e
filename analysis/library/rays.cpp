// Rays given as arrays: judges answers to them, and returns answers of forms, the truth and all crossings.
#include "scene/rays/rays.hpp"
#include "analysis/library/given_rays.hpp"
#include "analysis/selection/ray_file_options.hpp"
#include "intersect/conventions.hpp"
#include "intersect/process/parallel.hpp"
#include "measure/answer/answers.hpp"
#include "measure/attribution/culprits.hpp"
#include "measure/crossing/mesh_crossings.hpp"
#include "measure/judge/judge.hpp"
#include "output/attribution/explain_command.hpp"
#include "output/map/map_tables.hpp"

namespace lostbits::analysis::library {

using measure::evaluate::TestedForm;
using measure::metric::Metric;
using scene::rays::RayGroup;

namespace {

/// The contract that the arguments of the call state, for primitives of a shape.
intersect::Info read_contract(const lostbits_rays& rays, Shape shape) {
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
    const auto contract = intersect::external::read_form_contract(form, rays_name);
    if (rays.scene == nullptr)
        intersect::refuse_unused_at_origin(contract.at_origin, contract.inside, shape, rays_name);
    intersect::Info info{};
    info.direction = contract.direction;
    info.touching = contract.touching;
    info.at_origin = contract.at_origin;
    info.inside = contract.inside;
    info.facing = contract.facing;
    return info;
}

/// Selects the forms whose shapes are exactly those of the rays' primitives.
selection::ShapePredicate shape_filter(const GivenRays& given_rays) {
    const Shapes shapes = selection::shapes_of_rays(given_rays.ray_file->layout(), given_rays.representatives());
    return [shapes](Shapes forms) { return forms == shapes; };
}

/// The default metrics and those of the call, made for its forms.
std::vector<const Metric*> make_metrics(const measure::judge::JudgeRequest& request, const GivenRays& given_rays,
                                        CallSelection& chosen) {
    std::vector<const Metric*> metrics{measure::metric::find_metric("lost_bits")};
    std::ranges::copy(chosen.extra_metrics, std::back_inserter(metrics));
    metrics = selection::with_default_metrics(metrics, request.tested_forms);
    if (chosen.tested_forms.empty()) return metrics;

    // The operations of a form depend on the shapes of the primitives, and on whether matrices place them.
    RayGroup group;
    group.primitives = given_rays.representatives();
    if (group.primitives.empty()) group.primitives.emplace_back(given_rays.shape);
    if (given_rays.ray_file->layout().has_matrix())
        group.primitives.front().transform = selection::placeholder_matrix();
    return chosen.metric_set.adapt_to_forms(metrics, measure::evaluate::forms_of(chosen.tested_forms),
                                            [&group] { return measure::attribution::OwnedSetting(group); });
}

/// The shapes of the rays' primitives, in the order of `shape_rows`.
std::vector<Shape> list_shapes(const GivenRays& given_rays) {
    std::vector<Shape> shapes;
    const std::vector<Primitive<double>> representatives = given_rays.representatives();
    for (const ShapeRow& shape_row : shape_rows) {
        const auto has_shape = [&shape_row](const Primitive<double>& primitive) {
            return primitive.shape == shape_row.shape;
        };
        if (representatives.empty() ? shape_row.shape == given_rays.shape
                                    : std::ranges::any_of(representatives, has_shape))
            shapes.push_back(shape_row.shape);
    }
    return shapes;
}

/// Probable fault of the caller's answers.
std::vector<std::string> find_suspicions(const measure::judge::JudgeRequest& request,
                                         const measure::judge::JudgeResult& judgement) {
    const auto file_form = request.file_form_index();
    if (!file_form) return {};
    return selection::list_suspicions({request.tested_forms[*file_form]}, [&](const TestedForm&) {
        const auto& summary_of_file = judgement.summaries[*file_form];
        const std::string suspicion_text =
            measure::contract::suspicion_text(judgement.first_samples, measure::contract::AnswerSource::file,
                                              judgement.scaled_right_misses(summary_of_file));
        const bool is_whole = judgement.has_all_samples(summary_of_file);
        return measure::contract::name_counted_rays(
            rays_name, is_whole ? judgement.ray_count : judgement.first_samples.size(), judgement.ray_count,
            "of its rays that hit or should hit", suspicion_text);
    });
}

std::unique_ptr<lostbits_result> make_judgement_result(const lostbits_rays& rays, CallSelection& chosen,
                                                       CallSettings& settings) {
    GivenRays given_rays = read_rays(rays, settings);
    measure::judge::JudgeRequest request{
        .primitives = given_rays.primitives, .mesh = given_rays.mesh, .limit = {.stop = settings.stop()}};
    if (rays.by.data != nullptr) request.group_column = 0;

    // The rows: the answers of the arrays, and the forms of the call.
    intersect::Info contract = read_contract(rays, given_rays.shape);
    if (given_rays.ray_file->layout().has_only_decisions()) contract.roots = intersect::Roots::none;
    const measure::judge::FileForm answers("arrays", given_rays.shape, contract);
    if (!chosen.tested_forms.empty()) chosen.keep_forms_for(rays_name, shape_filter(given_rays));
    else if (!given_rays.ray_file->layout().has_first_hits())
        throw NothingSelected("rays: there are neither answers (t or hit) nor forms; give one of them");
    if (given_rays.ray_file->layout().has_first_hits()) {
        request.file_answers_form = &answers.form();
        request.tested_forms.push_back({request.file_answers_form, given_rays.ray_file->format()});
    }
    request.tested_forms.insert(request.tested_forms.end(), chosen.tested_forms.begin(), chosen.tested_forms.end());

    request.metrics = make_metrics(request, given_rays, chosen);
    const auto advance = settings.advance_callback(rays.count);
    request.progress = [&advance](std::uint64_t done, std::uint64_t) { advance(done); };

    // The summary is the first table of the result.
    auto result = std::make_unique<lostbits_result>();
    const auto summary = output::map::make_summary_table(request.metrics, list_shapes(given_rays),
                                                         given_rays.mesh != nullptr, request.group_column ? "by" : "");
    ResultTable& table = result->tables.emplace_back("summary", summary.columns());
    std::deque<RayTable> ray_tables = add_ray_tables(*result, chosen, request.tested_forms, request.metrics);
    const auto judgement =
        measure::judge::run_judge(*given_rays.ray_file, request,
                                  [&ray_tables](std::size_t r, const auto&, const measure::evaluate::BandResult& band) {
                                      if (!ray_tables.empty()) ray_tables[r].add_band(band);
                                  });

    auto csv = table.writer();
    const auto name_worst_ray = [](const measure::evaluate::WorstRay& ray) {
        return output::attribution::explain_ray_arguments(ray.given.get());
    };
    for (std::size_t r = 0; r < request.tested_forms.size(); ++r) {
        for (const auto& row : output::map::make_summary_rows(r, request.tested_forms[r], judgement.summaries[r],
                                                              judgement.groups, name_worst_ray))
            summary.add_row(csv, row);
    }
    result->texts = find_suspicions(request, judgement);
    return result;
}

/// Calls `act(first, group, culler)` in parallel for pieces of the rays. The group has the rays from `first` on and
/// their primitives. The culler finds the primitives that a ray can meet; it is null unless there is a mesh or at least
/// `culling_threshold` primitives.
template <class Act>
void for_each_piece(GivenRays& given_rays, CallSettings& settings, std::size_t count, std::size_t culling_threshold,
                    const Act& act) {
    constexpr std::size_t rays_per_piece = 8192;
    const auto advance = settings.advance_callback(count);
    std::optional<measure::culling::Culler> own_culler;
    const measure::culling::Culler* shared_culler = nullptr;
    if (given_rays.mesh || given_rays.primitives.size() >= culling_threshold)
        shared_culler = given_rays.stored ? &given_rays.stored->culler()
                                          : &own_culler.emplace(primitive_list(given_rays.primitives, given_rays.mesh));

    intersect::process::in_parallel(
        std::size_t{0}, (count + rays_per_piece - 1) / rays_per_piece, [&](std::size_t piece_index) {
            const std::size_t first = piece_index * rays_per_piece, ray_count = std::min(rays_per_piece, count - first);
            scene::ray_file::Chunk chunk =
                given_rays.ray_file->decode({.first = first, .count = ray_count, .bytes = {}});
            RayGroup group;
            group.is_paired = !chunk.primitives.empty();
            group.primitives = group.is_paired ? std::move(chunk.primitives) : given_rays.primitives;
            group.mesh = group.is_paired ? nullptr : given_rays.mesh;
            group.rays = std::move(chunk.rays);
            group.rays.width = static_cast<int>(ray_count);
            group.rays.y1 = 1;

            std::optional<measure::culling::Culler> culler;
            if (shared_culler && !group.is_paired) culler.emplace(*shared_culler, group.rays);
            act(first, std::move(group), culler ? &*culler : nullptr);
            advance(ray_count);
        });
}

std::unique_ptr<lostbits_result> make_answers_result(const lostbits_rays& rays, CallSelection& chosen,
                                                     CallSettings& settings) {
    GivenRays given_rays = read_rays(rays, settings);
    chosen.keep_forms_for(rays_name, shape_filter(given_rays));
    auto result = std::make_unique<lostbits_result>();
    for (const TestedForm& tested_form : chosen.tested_forms) {
        ResultTable& table = result->tables.emplace_back(
            std::string(tested_form.form->info->name) + "." + std::string(tested_form.format.name),
            std::vector<output::file::Column>{{"hit", "boolean", "", "1 if the form answers that the ray hits"},
                                              {"t", "number", "t", "t of the form, in its own unit"}});
        for (ResultColumn& column : table.columns) column.numbers.resize(rays.count);
    }

    // Answers need no truth, so only a mesh is culled.
    for_each_piece(given_rays, settings, rays.count, SIZE_MAX, [&](std::size_t first, RayGroup group, auto* culler) {
        const measure::truth::Band band(std::move(group), {.stop = settings.stop()}, culler);
        for (std::size_t r = 0; r < chosen.tested_forms.size(); ++r) {
            const TestedForm& tested_form = chosen.tested_forms[r];
            const auto inputs = band.inputs_for(tested_form.format, *tested_form.form->info);
            const auto answers = measure::answer::evaluate(*tested_form.form, inputs);
            ResultColumn &hit = result->tables[r]["hit"], &t = result->tables[r]["t"];
            for (std::size_t i = 0; i < answers.t.size(); ++i) {
                hit.numbers[first + i] = answers.hit[i] != 0 ? 1 : 0;
                t.numbers[first + i] = answers.hit[i] != 0 ? answers.t[i] : measure::truth::missing;
            }
        }
    });
    return result;
}

/// A certified number as a sum of two doubles.
std::pair<double, double> to_two_doubles(const measure::truth::CertifiedNumber& t) {
    const int exponent = static_cast<int>(std::clamp<std::int64_t>(t.exponent, -3000, 3000));
    return {std::ldexp(t.hi, exponent), std::ldexp(t.lo, exponent)};
}

std::unique_ptr<lostbits_result> make_truth_result(const lostbits_rays& rays, CallSettings& settings) {
    GivenRays given_rays = read_rays(rays, settings);
    const intersect::Info contract = read_contract(rays, given_rays.shape);
    auto result = std::make_unique<lostbits_result>();
    ResultTable& table = result->tables.emplace_back(
        "truth",
        std::vector<output::file::Column>{{"decision", "integer", "", "0 miss, 1 hit, 2 unresolved"},
                                          {"primitive", "integer", "", "index of the primitive that is hit, from 0"},
                                          {"t_hi", "number", "t", "t*, rounded to the nearest binary64"},
                                          {"t_lo", "number", "t", "t* - t_hi, to 2^-72 of t*"}});
    for (ResultColumn& column : table.columns) column.numbers.assign(rays.count, measure::truth::missing);

    ResultColumn &decisions = table["decision"], &primitives = table["primitive"];
    ResultColumn &t_hi = table["t_hi"], &t_lo = table["t_lo"];
    const bool is_unit = contract.direction == intersect::Direction::unit;
    for_each_piece(given_rays, settings, rays.count, measure::culling::min_primitives,
                   [&](std::size_t first, RayGroup group, auto* culler) {
                       const bool is_paired = group.is_paired;
                       const measure::truth::Band band(std::move(group), {.stop = settings.stop()}, culler);
                       for (std::size_t i = 0; i < band.pixel_count(); ++i) {
                           const measure::truth::Truth ray_truth = band.truth(i, contract.convention());
                           decisions.numbers[first + i] = static_cast<double>(ray_truth.decision);
                           if (!ray_truth.is_hit()) continue;

                           // Only a hit has a primitive and a t.
                           primitives.numbers[first + i] =
                               static_cast<double>(is_paired ? first + i : ray_truth.primitive);
                           std::tie(t_hi.numbers[first + i], t_lo.numbers[first + i]) =
                               to_two_doubles(is_unit ? ray_truth.distance : ray_truth.t);
                       }
                   });
    return result;
}

/// All crossings of each ray, found in parallel.
std::vector<measure::crossing::MeshCrossings> find_crossings(GivenRays& given_rays, std::size_t count,
                                                             CallSettings& settings) {
    std::vector<measure::crossing::MeshCrossings> crossings_by_ray(count);
    for_each_piece(given_rays, settings, count, measure::culling::min_primitives,
                   [&](std::size_t first, RayGroup group, auto* culler) {
                       const auto primitives = scene::rays::primitive_list_of(group);
                       for (std::size_t i = 0; i < group.rays.size(); ++i)
                           crossings_by_ray[first + i] = measure::crossing::find_crossings(
                               group.rays[i], {primitives, culler ? culler->index_for_truth() : nullptr},
                               group.rays.range(i), {.stop = settings.stop()});
                   });
    return crossings_by_ray;
}

std::unique_ptr<lostbits_result> make_crossings_result(const lostbits_rays& rays, CallSettings& settings) {
    GivenRays given_rays = read_rays(rays, settings);
    const auto is_triangle = [](const auto& primitive) { return primitive.shape == scene::triangle::Mesh::shape; };
    if (rays.paired != 0 || !std::ranges::all_of(given_rays.representatives(), is_triangle))
        throw InputError("rays: crossings need triangles that all rays share; give a mesh, or an array of triangles");
    const auto crossings_by_ray = find_crossings(given_rays, rays.count, settings);

    // One table has a row per crossing, the other a row per ray.
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

    ResultColumn &rays_of_crossings = table["ray"], &places = table["place"], &triangles = table["primitive"];
    ResultColumn &t_hi = table["t_hi"], &t_lo = table["t_lo"];
    ResultColumn &hits_front = table["front"], &at_rim = table["at_rim"], &is_resolved = resolved["resolved"];
    for (std::size_t i = 0; i < crossings_by_ray.size(); ++i) {
        is_resolved.numbers.push_back(crossings_by_ray[i].is_resolved ? 1 : 0);
        for (const measure::crossing::MeshCrossing& crossing : crossings_by_ray[i].in_order) {
            rays_of_crossings.numbers.push_back(static_cast<double>(i));
            places.numbers.push_back(crossing.rank);
            triangles.numbers.push_back(crossing.triangle);
            const auto [hi, lo] = to_two_doubles(crossing.t);
            t_hi.numbers.push_back(hi);
            t_lo.numbers.push_back(lo);
            hits_front.numbers.push_back(crossing.hits_front ? 1 : 0);
            at_rim.numbers.push_back(crossing.is_at_rim ? 1 : 0);
        }
    }
    return result;
}

void add_mesh_counts(const scene::triangle::MeshCounts& counts, lostbits_result& result) {
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
    csv.add(counts.edges)
        .add(counts.border_edges)
        .add(counts.non_manifold_edges)
        .add(counts.unbalanced_edges)
        .add(counts.odd_edges);
    csv.add(counts.duplicate_faces).end_row();
}

/// Counts, for each point, the layers of the surface around it, in parallel.
std::vector<measure::crossing::PointInMesh> locate_points(const SceneInFormat& stored, const lostbits_array& points,
                                                          std::size_t count, CallSettings& settings) {
    const Format format = *find_format("f64");
    std::vector<ArrayColumn> columns;
    append_columns(columns, points, std::array<std::string, 3>{"x", "y", "z"});
    std::vector<measure::crossing::PointInMesh> points_in_mesh(count);
    const measure::crossing::Triangles triangles{stored.culler().shared_primitives(),
                                                 stored.culler().index_for_truth()};
    const auto advance = settings.advance_callback(count);

    constexpr std::size_t points_per_piece = 1024;
    intersect::process::in_parallel(
        std::size_t{0}, (count + points_per_piece - 1) / points_per_piece, [&](std::size_t piece_index) {
            const std::size_t first = piece_index * points_per_piece,
                              point_count = std::min(points_per_piece, count - first);
            for (std::size_t i = first; i < first + point_count; ++i) {
                Vec<double> point;
                for (int k = 0; k < 3; ++k) point[k] = number_at(columns[k], i, format);
                if (!measure::truth::is_valid(Ray<double>{point, {1, 1, 1}}))
                    throw InputError("point " + std::to_string(i) + " has a number that is not finite");
                points_in_mesh[i] = measure::crossing::locate_in_mesh(point, triangles, {.stop = settings.stop()});
            }
            advance(point_count);
        });
    return points_in_mesh;
}

std::unique_ptr<lostbits_result> make_points_result(const lostbits_scene& scene, const lostbits_array& points,
                                                    std::size_t count, CallSettings& settings) {
    if (points.data == nullptr) throw InputError("points: the array is missing; give three numbers per point");
    require_addressable(points, count, 3, "points");
    const auto stored = scene.stored->get(scene.scene, binary64);
    if (!stored->mesh || !stored->primitives_beside_mesh.empty())
        throw InputError("inside: the scene must have meshes and no other primitives; give mesh=(vertices, faces)");
    const auto points_in_mesh = locate_points(*stored, points, count, settings);

    auto result = std::make_unique<lostbits_result>();
    ResultTable& table = result->tables.emplace_back(
        "points", std::vector<output::file::Column>{
                      {"winding", "integer", "", "number of layers of the surface that enclose the point"},
                      {"crossings", "integer", "", "crossings of the ray by which the layers are counted"},
                      {"on_surface", "boolean", "", "the point lies on a triangle"},
                      {"resolved", "boolean", "", "the other columns are proved"}});
    ResultColumn &windings = table["winding"], &crossings = table["crossings"];
    ResultColumn &on_surface = table["on_surface"], &resolved = table["resolved"];
    for (const measure::crossing::PointInMesh& point : points_in_mesh) {
        windings.numbers.push_back(point.winding);
        crossings.numbers.push_back(point.crossings);
        on_surface.numbers.push_back(point.is_on_surface ? 1 : 0);
        resolved.numbers.push_back(point.is_resolved ? 1 : 0);
    }
    add_mesh_counts(stored->mesh->mesh().counts, *result);
    return result;
}

template <class Find>
int run_call(lostbits_result** result, lostbits_error* error, const lostbits_rays* rays, const Find& find) {
    return run_guarded(error, [&] {
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
        CallSelection chosen(choice, CallSelection::WithoutForms::no_form);
        CallSettings settings(run);
        return make_judgement_result(*rays, chosen, settings);
    });
}

int lostbits_answers(const lostbits_rays* rays, const lostbits_choice* choice, const lostbits_run* run,
                     lostbits_result** result, lostbits_error* error) {
    return run_call(result, error, rays, [&] {
        CallSelection chosen(choice);
        CallSettings settings(run);
        return make_answers_result(*rays, chosen, settings);
    });
}

int lostbits_truth(const lostbits_rays* rays, const lostbits_run* run, lostbits_result** result,
                   lostbits_error* error) {
    return run_call(result, error, rays, [&] {
        CallSettings settings(run);
        return make_truth_result(*rays, settings);
    });
}

int lostbits_hits(const lostbits_rays* rays, const lostbits_run* run, lostbits_result** result, lostbits_error* error) {
    return run_call(result, error, rays, [&] {
        CallSettings settings(run);
        return make_crossings_result(*rays, settings);
    });
}

int lostbits_inside(const lostbits_scene* scene, const lostbits_array* points, size_t count, const lostbits_run* run,
                    lostbits_result** result, lostbits_error* error) {
    return run_guarded(error, [&] {
        require(scene, "scene");
        require(points, "points");
        require(result, "result");
        CallSettings settings(run);
        return hand_over(make_points_result(*scene, *points, count, settings), result);
    });
}
}
