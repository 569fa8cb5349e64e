// Judges answers about the whole surface of a mesh that are given as arrays.
#include "measure/judge/mesh_answers.hpp"
#include "analysis/library/handles.hpp"
#include "analysis/library/ray_arrays.hpp"
#include "analysis/selection/ray_file_options.hpp"
#include "measure/judge/judge.hpp"
#include "output/judge/mesh_answer_files.hpp"

namespace lostbits::analysis::library {

using scene::ray_file::AnswerKind;

namespace {

constexpr const char* answers_name = "answers";

/// The kind of answers that a column of this name has.
AnswerKind parse_answer_kind(const char* column) {
    const std::string name = column ? column : "";
    for (const auto& [known_name, kind] :
         {std::pair("hit_index", AnswerKind::all_hits), std::pair("crossings", AnswerKind::crossings),
          std::pair("parity", AnswerKind::parity), std::pair("inside", AnswerKind::inside)})
        if (name == known_name) return kind;
    throw InputError("column is \"" + name + "\"; write hit_index, crossings, parity or inside");
}

intersect::Facing parse_facing(int value) {
    if (value == 0) return intersect::Facing::both;
    if (value == LB_FACING_FRONT) return intersect::Facing::front;
    if (value == LB_FACING_BACK) return intersect::Facing::back;
    throw InputError("facing is " + std::to_string(value) + "; give 0, LB_FACING_FRONT or LB_FACING_BACK");
}

bool parse_touching(int value) {
    if (value != LB_HIT && value != LB_MISS)
        throw InputError("touching is " + std::to_string(value) + "; give LB_HIT or LB_MISS");
    return value == LB_MISS;
}

std::unique_ptr<RayArrays> make_ray_file(const lostbits_rays& rays, const lostbits_mesh_answers& answers,
                                         const CallSettings& settings) {
    const AnswerKind kind = parse_answer_kind(answers.column);
    const bool are_points = kind == AnswerKind::inside;
    if (rays.origin.data == nullptr || answers.values.data == nullptr || (rays.direction.data == nullptr) != are_points)
        throw InputError(are_points ? "answers: points need origin and values, and have no direction"
                                    : "answers: rays need origin, direction and values; give all three");

    std::vector<ArrayColumn> columns;
    const auto append = [&](const lostbits_array& array, std::initializer_list<std::string> names) {
        if (array.data == nullptr) return;
        require_addressable(array, rays.count, names.size(), answers_name);
        append_columns(columns, array, std::vector<std::string>(names));
    };
    if (are_points) {
        append(rays.origin, {"px", "py", "pz"});
    } else {
        append(rays.origin, {"ox", "oy", "oz"});
        append(rays.direction, {"dx", "dy", "dz"});
    }
    append(rays.tmin, {"tmin"});
    append(rays.tmax, {"tmax"});
    append(rays.t, {"t"});
    append(answers.objects, {"object"});
    append(answers.values, {answers.column});

    scene::ray_file::ReadOptions options{.stop = settings.stop()};
    options.primitive = scene::triangle::Mesh::shape;
    if (rays.open_ends != nullptr) options.open_ends = parse_open_ends(rays.open_ends);
    if (rays.format != nullptr) options.format = selection::select_formats({rays.format}, "format").front();
    return std::make_unique<RayArrays>(answers_name, std::move(columns), rays.count, options);
}

std::unique_ptr<lostbits_result> judge_answers(const lostbits_rays& rays, const lostbits_mesh_answers& answers,
                                               CallSettings& settings) {
    require(rays.scene, "scene");
    const auto ray_file = make_ray_file(rays, answers, settings);
    const AnswerKind kind = ray_file->layout().answer_kind();
    const auto stored = rays.scene->stored->get(rays.scene->scene, ray_file->format().parameters);
    if (!stored->mesh || !stored->primitives_beside_mesh.empty())
        throw InputError("answers: the scene must have meshes and no other primitives; give mesh=(vertices, faces)");
    measure::judge::MeshAnswersRequest request{.mesh = stored->mesh,
                                               .contract = {.has_t = rays.t.data != nullptr,
                                                            .unit_direction = rays.unit != 0,
                                                            .touching_may_miss = parse_touching(rays.touching),
                                                            .facing = parse_facing(rays.facing)},
                                               .limit = {.stop = settings.stop()}};
    if (kind == AnswerKind::inside) measure::judge::require_inside(stored->mesh->mesh(), answers_name);

    std::vector<measure::judge::JudgedAnswer> rows;
    const auto advance = settings.advance_callback(0);
    const auto judgement = measure::judge::judge_mesh_answers(*ray_file, request, [&](const auto& judged_rows) {
        if (answers.rows != 0) rows.insert(rows.end(), judged_rows.begin(), judged_rows.end());
        advance(judged_rows.size());
    });

    auto result = std::make_unique<lostbits_result>();
    result->add_table<output::judge::MeshSummaryRow>(
        "summary", output::judge::make_mesh_summary_table(kind),
        {{measure::judge::name_of_answers("arrays"), std::string(ray_file->format().name), &judgement}});
    if (answers.rows != 0) result->add_table("rows", output::judge::make_mesh_answer_table(kind), rows);
    return result;
}

}  // namespace

}  // namespace lostbits::analysis::library

using namespace lostbits::analysis::library;

extern "C" {

int lostbits_judge_mesh(const lostbits_rays* rays, const lostbits_mesh_answers* answers, const lostbits_run* run,
                        lostbits_result** result, lostbits_error* error) {
    return run_guarded(error, [&] {
        require(rays, "rays");
        require(answers, "answers");
        require(result, "result");
        CallSettings settings(run);
        return hand_over(judge_answers(*rays, *answers, settings), result);
    });
}
}
