// Right arguments of every function of lostbits.h, for tests that make them wrong one by one.
#pragma once

#include <lostbits.h>

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "catch.hpp"

namespace lostbits::test {
inline constexpr const char* scene_text =
    "schema = \"lostbits-scene/1\"\ntitle = \"a sphere\"\nsize = [4, 4]\n"
    "[camera]\nkind = \"orthographic\"\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\nwidth = 3\n"
    "[[sphere]]\ncentre = [0, 0, 0]\nradius = 1\n";

inline const char* answers_nothing(const lb_batch* batch) {
    for (std::size_t i = 0; i < batch->size; ++i) batch->hit[i] = 0;
    return nullptr;
}

inline void free_result(lostbits_result* result) { lostbits_result_free(result); }

/// Right arguments of all functions, for tests that make each of them wrong.
struct Arguments {
    Arguments() {
        lostbits_scene* made = nullptr;
        REQUIRE(lostbits_scene_text(scene_text, nullptr, &made, nullptr) == LOSTBITS_OK);
        scenes.reset(made, lostbits_scene_free);
        lostbits_form* formed = nullptr;
        REQUIRE(lostbits_form_make(forms.data(), 1, &formed, nullptr) == LOSTBITS_OK);
        own_forms.reset(formed, lostbits_form_free);
        lostbits_result* shapes = nullptr;
        REQUIRE(lostbits_shapes(&shapes, nullptr) == LOSTBITS_OK);
        results.reset(shapes, free_result);
        scene = made, form = own = formed, result = shapes;
        lostbits_scene* of_mesh = nullptr;
        REQUIRE(lostbits_scene_text(scene_text, nullptr, &of_mesh, nullptr) == LOSTBITS_OK);
        REQUIRE(lostbits_scene_mesh(of_mesh, vertices, vertex_count, faces, face_count, nullptr) == LOSTBITS_OK);
        mesh.reset(of_mesh, lostbits_scene_free);
        rays.count = 3;
        rays.origin = {origins.data(), 24, 8, 64};
        rays.direction = {directions.data(), 24, 8, 64};
        rays.shape = "sphere";
        rays.primitives = {sphere.data(), 32, 8, 64};
        rays.primitive_count = 1;
    }
    Arguments(const Arguments&) = delete;
    Arguments& operator=(const Arguments&) = delete;

    std::shared_ptr<lostbits_scene> scenes = {}, mesh = {};
    std::shared_ptr<lostbits_form> own_forms = {};
    std::shared_ptr<lostbits_result> results = {};

    const char* name = "near-benign";
    const char* function = LOSTBITS_DATA_DIR "/../examples/functions/sphere.c:hit_sphere";
    const char* text = scene_text;
    lostbits_where where{LOSTBITS_DATA_DIR, 4, 4, {nullptr, 0}, nullptr};
    lostbits_scene* scene = nullptr;
    const char* shape = "sphere";
    std::vector<double> sphere{0, 0, 0, 1};
    const double* numbers = sphere.data();
    std::size_t primitive_count = 1;
    std::vector<double> corners{0, 0, 0, 1, 0, 0, 0, 1, 0}, matrix_numbers{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    const double *vertices = corners.data(), *matrix = matrix_numbers.data();
    std::vector<std::uint32_t> places{0, 1, 2};
    const std::uint32_t* faces = places.data();
    std::size_t vertex_count = 3, face_count = 1;

    std::vector<lb_form> forms{{"own.none", nullptr, nullptr, LB_SPHERE, LB_F32, LB_ANY, LB_FIRST, LB_HIT, LB_HIT, 0,
                                nullptr, answers_nothing}};
    const lb_form* given_forms = forms.data();
    std::size_t form_count = 1;
    lostbits_form *form = nullptr, *own = nullptr;
    std::vector<lostbits_operation> listed{{"input", {2, -1, -1}, 0, nullptr},
                                           {"input", {5, -1, -1}, 0, nullptr},
                                           {"div", {0, 1, -1}, 0, "t"},
                                           {"less", {0, 2, -1}, 0, nullptr}};
    const lostbits_operation* operations = listed.data();
    std::size_t operation_count = 4;
    int bits = 32, hit = 3, t = 2;

    const char *chosen_form = "sphere.unified", *chosen_format = "f32";
    const char* spoilt = nullptr;  ///< what a list has that a test spoils
    lostbits_where* at = &where;
    lostbits_choice choice{{&chosen_form, 1}, nullptr, 0, {&chosen_format, 1}, {nullptr, 0}, 0, 0};
    lostbits_run run{1, nullptr, nullptr, nullptr};
    std::vector<double> origins{0, 0, 5, 0, 0, 6, 0, 0, 7}, directions{0, 0, -1, 0, 0, -1, 0, 0, -1};
    lostbits_rays rays{};
    const lostbits_rays* given_rays = &rays;
    std::vector<double> counts{0, 1, 2};
    lostbits_mesh_answers answers{"crossings", {counts.data(), 8, 0, 64}, {nullptr, 0, 0, 0}, 1};
    const lostbits_mesh_answers* given_answers = &answers;
    const char* sweep =
        "schema = \"lostbits-sweep/1\"\ntitle = \"a\"\nsource = \"-\"\nscene = \"near-benign\"\n"
        "[[axis]]\nname = \"radius\"\nunit = \"world\"\nspacing = \"linear\"\nfrom = 1\nto = 2\nsteps = 2\n"
        "set = [\"sphere[0].radius\"]\n";
    const char* data = LOSTBITS_DATA_DIR;
    const char *study = "consistency", *option = "check=reverse";
    lostbits_words options{&option, 1};
    const lostbits_words* given_options = &options;
    lostbits_requirement requirement{8, -1, 0, "max"};
    const lostbits_requirement* given_requirement = &requirement;
    int x = 2, y = 2;

    const lostbits_result* result = nullptr;
    lostbits_table table{};
    lostbits_column column{};
    lostbits_table* into_table = &table;
    lostbits_column* into_column = &column;

    lostbits_scene* new_scene = nullptr;
    lostbits_form* new_form = nullptr;
    lostbits_result* new_result = nullptr;
    lostbits_scene** scene_out = &new_scene;
    lostbits_form** form_out = &new_form;
    lostbits_result** out = &new_result;
};

using Call = int (*)(Arguments&, lostbits_error*);
struct Function {
    const char* name;
    Call call;
};
inline const Function functions[] = {
    {"scene_open", [](Arguments& a, lostbits_error* e) { return lostbits_scene_open(a.name, a.at, a.scene_out, e); }},
    {"scene_text", [](Arguments& a, lostbits_error* e) { return lostbits_scene_text(a.text, a.at, a.scene_out, e); }},
    {"scene_primitives",
     [](Arguments& a, lostbits_error* e) {
         return lostbits_scene_primitives(a.scene, a.shape, a.numbers, a.primitive_count, e);
     }},
    {"scene_mesh",
     [](Arguments& a, lostbits_error* e) {
         return lostbits_scene_mesh(a.scene, a.vertices, a.vertex_count, a.faces, a.face_count, e);
     }},
    {"scene_transform",
     [](Arguments& a, lostbits_error* e) { return lostbits_scene_transform(a.scene, a.matrix, 0, e); }},
    {"scene_rays", [](Arguments& a, lostbits_error* e) { return lostbits_scene_rays(a.scene, a.out, e); }},
    {"shapes", [](Arguments& a, lostbits_error* e) { return lostbits_shapes(a.out, e); }},
    {"form_make",
     [](Arguments& a, lostbits_error* e) { return lostbits_form_make(a.given_forms, a.form_count, a.form_out, e); }},
    {"form_function",
     [](Arguments& a, lostbits_error* e) { return lostbits_form_function(a.function, a.form_out, &a.run, a.out, e); }},
    {"form_write",
     [](Arguments& a, lostbits_error* e) {
         return lostbits_form_write(a.form, a.bits, a.operations, a.operation_count, a.hit, a.t, e);
     }},
    {"map", [](Arguments& a, lostbits_error* e) { return lostbits_map(a.scene, &a.choice, &a.run, a.out, e); }},
    {"judge",
     [](Arguments& a, lostbits_error* e) { return lostbits_judge(a.given_rays, &a.choice, &a.run, a.out, e); }},
    {"answers",
     [](Arguments& a, lostbits_error* e) { return lostbits_answers(a.given_rays, &a.choice, &a.run, a.out, e); }},
    {"truth", [](Arguments& a, lostbits_error* e) { return lostbits_truth(a.given_rays, &a.run, a.out, e); }},
    {"hits",
     [](Arguments& a, lostbits_error* e) {
         const bool is_right = a.rays.shape != nullptr && std::string_view(a.rays.shape) == "sphere";
         if (is_right && a.rays.primitives.data != nullptr)
             a.rays.shape = "triangle", a.rays.primitives.data = (a.sphere[1] == 0 ? a.corners : a.sphere).data();
         return lostbits_hits(a.given_rays, &a.run, a.out, e);
     }},
    {"inside",
     [](Arguments& a, lostbits_error* e) {
         const lostbits_array* const array = a.given_rays == nullptr ? nullptr : &a.rays.origin;
         return lostbits_inside(a.scene == nullptr ? nullptr : a.mesh.get(), array, a.rays.count, &a.run, a.out, e);
     }},
    {"judge_mesh",
     [](Arguments& a, lostbits_error* e) {
         a.rays.scene = a.scene == nullptr ? nullptr : a.mesh.get();
         return lostbits_judge_mesh(a.given_rays, a.given_answers, &a.run, a.out, e);
     }},
    {"sweep",
     [](Arguments& a, lostbits_error* e) { return lostbits_sweep(a.sweep, 1, a.data, &a.choice, &a.run, a.out, e); }},
    {"explain",
     [](Arguments& a, lostbits_error* e) { return lostbits_explain(a.scene, a.x, a.y, &a.choice, a.out, e); }},
    {"study",
     [](Arguments& a, lostbits_error* e) {
         return lostbits_study(a.study, a.scene, a.given_options, &a.choice, &a.run, a.out, e);
     }},
    {"trade",
     [](Arguments& a, lostbits_error* e) { return lostbits_trade(nullptr, a.shape, 1, &a.choice, &a.run, a.out, e); }},
    {"choose",
     [](Arguments& a, lostbits_error* e) {
         return lostbits_choose(a.scene, a.given_requirement, &a.choice, &a.run, a.out, e);
     }},
    {"mend",
     [](Arguments& a, lostbits_error* e) {
         return lostbits_mend(a.scene, a.given_requirement, 0, &a.choice, &a.run, a.out, e);
     }},
    {"result_table", [](Arguments& a, lostbits_error*) { return lostbits_result_table(a.result, 0, a.into_table); }},
    {"result_column",
     [](Arguments& a, lostbits_error*) { return lostbits_result_column(a.result, 0, 0, a.into_column); }},
};

inline const Function& function_named(std::string_view name) {
    for (const Function& function : functions)
        if (function.name == name) return function;
    throw std::logic_error(std::string(name));
}

}  // namespace lostbits::test
