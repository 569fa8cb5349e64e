/* The C interface as a C program uses it. Each function returns 0, or the line that went wrong. */
#include <lostbits.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#define HOLDS(condition)                   \
    do {                                   \
        if (!(condition)) return __LINE__; \
    } while (0)

static const char* const scene_text =
    "schema = \"lostbits-scene/1\"\n"
    "title = \"a sphere\"\n"
    "size = [16, 16]\n"
    "[camera]\n"
    "kind = \"orthographic\"\n"
    "eye = [0, 0, 5]\n"
    "look_at = [0, 0, 0]\n"
    "width = 3\n"
    "[[sphere]]\n"
    "centre = [0, 0, 0]\n"
    "radius = 1\n";

/* The near root of a sphere, for rays of any length. */
static const char* near_root(const lb_batch* batch) {
    for (size_t i = 0; i < batch->size; ++i) {
        const float* const r = (const float*)batch->rays + 6 * i;
        const float* const s = (const float*)batch->primitives + batch->primitive_stride * i;
        float* const out = (float*)batch->near_far + 2 * i;
        const float f[3] = {r[0] - s[0], r[1] - s[1], r[2] - s[2]};
        const float a = r[3] * r[3] + r[4] * r[4] + r[5] * r[5], b = f[0] * r[3] + f[1] * r[4] + f[2] * r[5];
        const float c = f[0] * f[0] + f[1] * f[1] + f[2] * f[2] - s[3] * s[3], disc = b * b - a * c;
        batch->hit[i] = disc >= 0;
        out[0] = disc >= 0 ? (-b - sqrtf(disc)) / a : 0;
    }
    return NULL;
}

static const char* refuse(const lb_batch* batch) {
    (void)batch;
    return "it does not feel like it";
}

static int column_named(const lostbits_result* result, size_t table, const char* name, lostbits_column* into) {
    for (size_t k = 0; lostbits_result_column(result, table, k, into) == LOSTBITS_OK; ++k)
        if (strcmp(into->name, name) == 0) return 1;
    return 0;
}

/* Three rays at one sphere: a vector every `step` bytes, its numbers `item_step` apart. */
static lostbits_rays three_rays(const void* origin, const void* direction, ptrdiff_t step, ptrdiff_t item_step,
                                int bits) {
    static const float in_float[] = {0, 0, 0, 1};
    static const double in_double[] = {0, 0, 0, 1};
    lostbits_rays rays;
    memset(&rays, 0, sizeof rays);
    rays.count = 3;
    rays.origin.data = origin, rays.origin.step = step, rays.origin.item_step = item_step, rays.origin.bits = bits;
    rays.direction = rays.primitives = rays.origin;
    rays.direction.data = direction;
    rays.shape = "sphere";
    rays.primitive_count = 1;
    rays.primitives.data = bits == 32 ? (const void*)in_float : (const void*)in_double;
    rays.primitives.item_step = bits / 8;
    return rays;
}

int client_maps_a_text(void) {
    lostbits_error error;
    lostbits_scene* scene = NULL;
    lostbits_result* result = NULL;
    lostbits_table table;
    lostbits_column column;
    const char* const forms[] = {"sphere.unified"};
    const char* const formats[] = {"f32"};
    lostbits_choice choice = {{forms, 1}, NULL, 0, {formats, 1}, {NULL, 0}, 1, 0};
    HOLDS(lostbits_abi() == LOSTBITS_ABI);
    HOLDS(strlen(lostbits_version()) > 0);
    HOLDS(lostbits_scene_text(scene_text, NULL, &scene, &error) == LOSTBITS_OK);
    HOLDS(lostbits_map(scene, &choice, NULL, &result, &error) == LOSTBITS_OK);
    HOLDS(lostbits_result_table(result, 0, &table) == LOSTBITS_OK);
    HOLDS(strcmp(table.name, "summary") == 0 && table.rows == 1);
    HOLDS(column_named(result, 0, "rays", &column) && column.numbers[0] == 256);
    HOLDS(column_named(result, 0, "agree_hit", &column) && column.numbers[0] > 80 && column.numbers[0] < 100);
    HOLDS(lostbits_result_table(result, 1, &table) == LOSTBITS_OK);
    HOLDS(strcmp(table.name, "sphere.unified.f32") == 0 && table.rows == 256);
    HOLDS(column_named(result, 1, "outcome", &column) && column.categories != NULL);
    HOLDS(strcmp(column.names[column.categories[0]], "agree_miss") == 0);
    HOLDS(strcmp(column.names[column.categories[8 * 16 + 8]], "agree_hit") == 0);
    HOLDS(column.colours != NULL && column.colours[3 * column.categories[0]] == 231); /* light grey */
    HOLDS(lostbits_result_table(result, 2, &table) == LOSTBITS_NOTHING);
    lostbits_result_free(result);
    lostbits_scene_free(scene);
    return 0;
}

int client_hears_what_is_wrong(void) {
    lostbits_error error;
    lostbits_scene* scene = NULL;
    lostbits_result* result = NULL;
    const char* const unknown[] = {"sphere.unifeid"};
    const char* const nothing[] = {"cube.*"};
    lostbits_choice choice = {{unknown, 1}, NULL, 0, {NULL, 0}, {NULL, 0}, 0, 0};
    HOLDS(lostbits_scene_text("schema = 3\n", NULL, &scene, &error) == LOSTBITS_BAD_INPUT);
    HOLDS(error.code == LOSTBITS_BAD_INPUT && strncmp(error.text, "text:1:", 7) == 0);
    HOLDS(scene == NULL);
    HOLDS(lostbits_scene_open("no such scene", NULL, &scene, NULL) == LOSTBITS_BAD_INPUT);
    HOLDS(lostbits_scene_text(scene_text, NULL, &scene, &error) == LOSTBITS_OK);
    HOLDS(lostbits_map(scene, &choice, NULL, &result, &error) == LOSTBITS_BAD_INPUT);
    HOLDS(strstr(error.text, "sphere.unified") != NULL);
    choice.forms.words = nothing;
    HOLDS(lostbits_map(scene, &choice, NULL, &result, &error) == LOSTBITS_NOTHING);
    HOLDS(lostbits_map(NULL, &choice, NULL, &result, &error) == LOSTBITS_BAD_INPUT);
    HOLDS(result == NULL);
    lostbits_scene_free(scene);
    lostbits_scene_free(NULL);
    lostbits_result_free(NULL);
    return 0;
}

int client_measures_its_own_form(void) {
    lostbits_error error;
    lostbits_scene* scene = NULL;
    lostbits_result* result = NULL;
    lostbits_form* form = NULL;
    lostbits_column column;
    lb_form words = {"own.near", "near root", NULL,   LB_SPHERE, LB_F32, LB_ANY,
                     LB_NEAR,    LB_HIT,      LB_HIT, 0,         NULL,   near_root};
    const char* const formats[] = {"f32"};
    lostbits_choice choice = {{NULL, 0}, NULL, 0, {formats, 1}, {NULL, 0}, 0, 0};
    HOLDS(lostbits_scene_text(scene_text, NULL, &scene, &error) == LOSTBITS_OK);
    HOLDS(lostbits_form_make(&words, 1, &form, &error) == LOSTBITS_OK);
    choice.own = &form;
    choice.own_count = 1;
    HOLDS(lostbits_map(scene, &choice, NULL, &result, &error) == LOSTBITS_OK);
    HOLDS(column_named(result, 0, "form", &column) && strcmp(column.texts[0], "own.near") == 0);
    HOLDS(column_named(result, 0, "false_hit", &column) && column.numbers[0] == 0);
    HOLDS(column_named(result, 0, "lost_bits_max", &column) && column.numbers[0] > 0 && column.numbers[0] < 24);
    lostbits_result_free(result);
    result = NULL;
    HOLDS(lostbits_explain(scene, 8, 8, &choice, &result, &error) == LOSTBITS_BAD_INPUT);
    HOLDS(strstr(error.text, "lostbits_form_write") != NULL);
    lostbits_form_free(form);
    words.run = refuse;
    HOLDS(lostbits_form_make(&words, 1, &form, &error) == LOSTBITS_OK);
    HOLDS(lostbits_map(scene, &choice, NULL, &result, &error) == LOSTBITS_ENVIRONMENT);
    HOLDS(strstr(error.text, "it does not feel like it") != NULL);
    lostbits_form_free(form);
    words.name = "sphere.near"; /* a name of a form that ships */
    HOLDS(lostbits_form_make(&words, 1, &form, &error) == LOSTBITS_BAD_INPUT);
    lostbits_scene_free(scene);
    return 0;
}

/* t = -o.z/d.z, a hit where it is not negative: in 32 bits, in bf16, and refused where the list makes no sense. */
int client_writes_operations(void) {
    lostbits_error error;
    lostbits_form* form = NULL;
    lostbits_result* result = NULL;
    lostbits_column column;
    lb_form words = {"own.plane", NULL, NULL, LB_SPHERE, LB_F32, LB_ANY, LB_FIRST, LB_HIT, LB_HIT, 0, NULL, refuse};
    lostbits_operation list[] = {{"input", {2, -1, -1}, 0, NULL},       {"input", {5, -1, -1}, 0, NULL},
                                 {"neg", {0, -1, -1}, 0, NULL},         {"div", {2, 1, -1}, 0, "t"},
                                 {"constant", {-1, -1, -1}, 0.1, NULL}, {"greater_equal", {3, 4, -1}, 0, NULL}};
    const float origin[] = {0, 0, -3, 0, 0, 3, 0, 0, -0.01f}, direction[] = {0, 0, 7, 0, 0, 7, 0, 0, 1};
    const char* const formats[] = {"f32", "bf16"};
    lostbits_choice choice = {{NULL, 0}, NULL, 0, {formats, 2}, {NULL, 0}, 0, 1};
    const lostbits_rays rays = three_rays(origin, direction, 12, 4, 32);
    HOLDS(lostbits_form_make(&words, 1, &form, &error) == LOSTBITS_OK);
    HOLDS(lostbits_form_write(form, 32, list, 6, 5, 3, &error) == LOSTBITS_OK);
    choice.own = &form;
    choice.own_count = 1;
    HOLDS(lostbits_answers(&rays, &choice, NULL, &result, &error) == LOSTBITS_OK);
    HOLDS(column_named(result, 0, "t", &column) && (float)column.numbers[0] == 3.0f / 7.0f);
    HOLDS(isnan(column.numbers[1]) && isnan(column.numbers[2]));
    HOLDS(column_named(result, 1, "t", &column) && column.numbers[0] == 0.4277343750); /* 8 bits of 3/7 */
    lostbits_result_free(result);
    list[3].operands[1] = 4; /* what comes after it */
    HOLDS(lostbits_form_write(form, 32, list, 6, 5, 3, &error) == LOSTBITS_BAD_INPUT);
    HOLDS(strstr(error.text, "does not come before it") != NULL);
    list[3].operands[1] = 1;
    list[2].op = "sin";
    HOLDS(lostbits_form_write(form, 32, list, 6, 5, 3, &error) == LOSTBITS_BAD_INPUT);
    list[2].op = "neg";
    HOLDS(lostbits_form_write(form, 32, list, 6, 3, 3, &error) == LOSTBITS_BAD_INPUT); /* t is not a decision */
    HOLDS(lostbits_form_write(form, 16, list, 6, 5, 3, &error) == LOSTBITS_BAD_INPUT);
    lostbits_form_free(form);
    return 0;
}

int client_judges_arrays(void) {
    lostbits_error error;
    lostbits_result *result = NULL, *truth = NULL;
    lostbits_column column;
    /* Column after column, and backwards: nothing is copied. */
    const double origin[] = {3, 0, 0, /**/ 0, 0, 0, /**/ -5, -5, -5};
    const double direction[] = {0, 0, 1};
    const double t[] = {NAN, 4.0000001, 4}; /* the first ray truly misses; the answers stand in their order */
    lostbits_rays rays = three_rays(origin, direction, 8, 24, 64);
    rays.direction.step = 0, rays.direction.item_step = 8;
    rays.t.data = t, rays.t.step = 8, rays.t.bits = 64;
    lostbits_choice choice = {{NULL, 0}, NULL, 0, {NULL, 0}, {NULL, 0}, 1, 0};
    HOLDS(lostbits_judge(&rays, &choice, NULL, &result, &error) == LOSTBITS_OK);
    HOLDS(column_named(result, 0, "agree_hit", &column) && column.numbers[0] == 2);
    HOLDS(column_named(result, 0, "agree_miss", &column) && column.numbers[0] == 1);
    HOLDS(column_named(result, 1, "lost_bits", &column));
    HOLDS(isnan(column.numbers[0]) && column.numbers[1] > 20 && column.numbers[2] == 0);
    lostbits_result_free(result);
    HOLDS(lostbits_truth(&rays, NULL, &truth, &error) == LOSTBITS_OK);
    HOLDS(column_named(truth, 0, "decision", &column) && column.numbers[0] == 0 && column.numbers[1] == 1);
    HOLDS(column_named(truth, 0, "t_hi", &column) && isnan(column.numbers[0]) && column.numbers[1] == 4);
    lostbits_result_free(truth);
    rays.origin.data = NULL;
    HOLDS(lostbits_truth(&rays, NULL, &truth, &error) == LOSTBITS_BAD_INPUT);
    return 0;
}

/* Three times the same ray at a sphere: from 0 on, from inside of the sphere on, and ending before it. */
int client_gives_ranges_and_groups(void) {
    lostbits_error error;
    lostbits_result *result = NULL, *truth = NULL;
    lostbits_table table;
    lostbits_column column;
    const double origin[] = {0, 0, -5}, direction[] = {0, 0, 1};
    const double tmin[] = {0, 4.5, 0}, tmax[] = {10, 10, 3}, material[] = {7, 2.5, 7}, t[] = {4, 6, -1};
    lostbits_choice choice = {{NULL, 0}, NULL, 0, {NULL, 0}, {NULL, 0}, 0, 0};
    lostbits_rays rays = three_rays(origin, direction, 0, 8, 64);
    rays.tmin.data = tmin, rays.tmin.step = 8, rays.tmin.bits = 64;
    rays.tmax = rays.t = rays.by = rays.tmin;
    rays.tmax.data = tmax;
    rays.t.data = NULL;
    rays.by.data = material;
    HOLDS(lostbits_truth(&rays, NULL, &truth, &error) == LOSTBITS_OK);
    HOLDS(column_named(truth, 0, "t_hi", &column) && column.numbers[0] == 4 && column.numbers[1] == 6);
    HOLDS(isnan(column.numbers[2]));
    lostbits_result_free(truth);
    rays.open_ends = "left";
    HOLDS(lostbits_truth(&rays, NULL, &truth, &error) == LOSTBITS_BAD_INPUT);
    HOLDS(strstr(error.text, "none, tmin, tmax or both") != NULL);
    rays.open_ends = "both";
    rays.t.data = t;
    HOLDS(lostbits_judge(&rays, &choice, NULL, &result, &error) == LOSTBITS_BAD_INPUT); /* -1: a miss, or a hit? */
    HOLDS(strstr(error.text, "give hit too") != NULL && strstr(error.text, "--") == NULL);
    rays.hit = rays.t;
    {
        const unsigned char hit[] = {1, 1, 0};
        rays.hit.data = hit, rays.hit.step = 1, rays.hit.bits = 8;
        HOLDS(lostbits_judge(&rays, &choice, NULL, &result, &error) == LOSTBITS_OK);
    }
    HOLDS(lostbits_result_table(result, 0, &table) == LOSTBITS_OK && table.rows == 3); /* all, 2.5, 7 */
    HOLDS(column_named(result, 0, "by", &column) && column.texts[0] == NULL && strcmp(column.texts[1], "2.5") == 0);
    HOLDS(strcmp(column.texts[2], "7") == 0);
    HOLDS(column_named(result, 0, "agree_hit", &column) && column.numbers[0] == 2 && column.numbers[1] == 1);
    HOLDS(column_named(result, 0, "agree_miss", &column) && column.numbers[1] == 0 && column.numbers[2] == 1);
    lostbits_result_free(result);
    return 0;
}

int client_judges_answers_about_a_mesh(void) {
    lostbits_error error;
    lostbits_scene* scene = NULL;
    lostbits_result* result = NULL;
    lostbits_column column;
    const double corners[] = {0, 0, 0, 4, 0, 0, 0, 4, 0}, origin[] = {1, 1, 5, 9, 9, 5, 1, 1, 5},
                 direction[] = {0, 0, -1};
    const double counts[] = {1, 0, 2}, hits[] = {0, -1, 0}, objects[] = {0, -1, 0}, t[] = {5, 0, 5};
    const uint32_t face[] = {0, 1, 2};
    lostbits_rays rays = three_rays(origin, direction, 24, 8, 64);
    lostbits_mesh_answers answers = {"crossings", {counts, 8, 0, 64}, {NULL, 0, 0, 0}, 1};
    HOLDS(lostbits_scene_text(scene_text, NULL, &scene, &error) == LOSTBITS_OK);
    HOLDS(lostbits_scene_mesh(scene, corners, 3, face, 1, &error) == LOSTBITS_OK);
    rays.scene = scene, rays.direction.step = 0;
    HOLDS(lostbits_judge_mesh(&rays, &answers, NULL, &result, &error) == LOSTBITS_OK);
    HOLDS(column_named(result, 0, "agree", &column) && column.numbers[0] == 2);
    HOLDS(column_named(result, 1, "true_crossings", &column) && column.numbers[0] == 1 && column.numbers[1] == 0);
    lostbits_result_free(result);
    answers.column = "hit_index", answers.values.data = hits, answers.objects = answers.values;
    answers.objects.data = objects;
    rays.t = answers.values, rays.t.data = t;
    HOLDS(lostbits_judge_mesh(&rays, &answers, NULL, &result, &error) == LOSTBITS_OK);
    HOLDS(column_named(result, 0, "agree", &column) && column.numbers[0] == 3);
    HOLDS(column_named(result, 0, "ulp_error_max", &column) && column.numbers[0] == 0);
    lostbits_result_free(result);
    answers.column = "hits";
    HOLDS(lostbits_judge_mesh(&rays, &answers, NULL, &result, &error) == LOSTBITS_BAD_INPUT);
    HOLDS(strstr(error.text, "write hit_index, crossings, parity or inside") != NULL);
    lostbits_scene_free(scene);
    return 0;
}

int client_asks_for_studies_and_a_choice(void) {
    lostbits_error error;
    lostbits_scene* scene = NULL;
    lostbits_result* result = NULL;
    lostbits_table table;
    lostbits_column column;
    const char* const forms[] = {"sphere.unified"};
    lostbits_choice choice = {{forms, 1}, NULL, 0, {NULL, 0}, {NULL, 0}, 0, 0};
    const char* option = "points=computed";
    const lostbits_words points = {&option, 1};
    lostbits_requirement requirement = {0, 1e-4, 0, "max"};
    HOLDS(lostbits_shapes(&result, &error) == LOSTBITS_OK);
    HOLDS(column_named(result, 0, "shape", &column) && strcmp(column.texts[0], "sphere") == 0);
    HOLDS(column_named(result, 0, "numbers", &column) && column.numbers[0] == 3 && column.numbers[1] == 1);
    lostbits_result_free(result);
    HOLDS(lostbits_scene_text(scene_text, NULL, &scene, &error) == LOSTBITS_OK);
    HOLDS(lostbits_study("offsets", scene, &points, NULL, NULL, &result, &error) == LOSTBITS_OK);
    HOLDS(lostbits_result_table(result, 0, &table) == LOSTBITS_OK && table.rows > 10);
    HOLDS(column_named(result, 0, "form", &column) && strcmp(column.texts[0], "sphere.half_b") == 0);
    HOLDS(column_named(result, 0, "point", &column) && strcmp(column.texts[table.rows - 1], "computed") == 0);
    lostbits_result_free(result);
    option = "points=all";
    HOLDS(lostbits_study("offsets", scene, &points, NULL, NULL, &result, &error) == LOSTBITS_BAD_INPUT);
    HOLDS(strstr(error.text, "points is \"all\"; write one of computed, projected, both") != NULL);
    HOLDS(lostbits_study("offset", scene, NULL, NULL, NULL, &result, &error) == LOSTBITS_BAD_INPUT);
    HOLDS(strstr(error.text, "did you mean \"offsets\"") != NULL);
    HOLDS(lostbits_study("consistency", scene, NULL, NULL, NULL, &result, &error) == LOSTBITS_OK);
    HOLDS(column_named(result, 0, "check", &column) && strcmp(column.texts[0], "beyond") == 0);
    lostbits_result_free(result);
    HOLDS(lostbits_trade(scene, NULL, 1, &choice, NULL, &result, &error) == LOSTBITS_OK);
    HOLDS(column_named(result, 1, "kept_bits_p99", &column) && column.numbers[0] > 8 && column.numbers[0] <= 24);
    HOLDS(column_named(result, 0, "time_ns", &column) && column.numbers[0] > 0);
    lostbits_result_free(result);
    HOLDS(lostbits_trade(scene, "sphere", 1, &choice, NULL, &result, &error) == LOSTBITS_BAD_INPUT);
    HOLDS(strstr(error.text, "pass NULL for one of the two") != NULL);
    HOLDS(lostbits_choose(scene, &requirement, &choice, NULL, &result, &error) == LOSTBITS_OK);
    HOLDS(column_named(result, 0, "distance_error", &column) && column.numbers[0] > 0 && column.numbers[0] <= 1e-4);
    lostbits_result_free(result);
    HOLDS(lostbits_mend(scene, &requirement, 0, &choice, NULL, &result, &error) == LOSTBITS_BAD_INPUT);
    requirement.tolerance = 0;
    HOLDS(lostbits_choose(scene, &requirement, &choice, NULL, &result, &error) == LOSTBITS_NO);
    HOLDS(strstr(lostbits_result_text(result, 0), "Nothing meets the requirement") != NULL);
    lostbits_result_free(result);
    lostbits_scene_free(scene);
    return 0;
}

static void stop_after_some(void* stop, uint64_t done, uint64_t of) {
    if (of == 0 && done > 100) *(unsigned char*)stop = 1;
}

static unsigned char stopped = 1, stops_later = 0;

int client_stops(void) {
    lostbits_error error;
    lostbits_scene* scene = NULL;
    lostbits_result* result = NULL;
    lostbits_run run = {0, &stopped, NULL, NULL}, later = {0, &stops_later, stop_after_some, &stops_later};
    const char *const forms[] = {"sphere.half_b"}, *const formats[] = {"f32"};
    lostbits_choice choice = {{forms, 1}, NULL, 0, {formats, 1}, {NULL, 0}, 0, 0};
    lostbits_requirement requirement = {24, -1, 0, "max"};
    HOLDS(lostbits_scene_text(scene_text, NULL, &scene, &error) == LOSTBITS_OK);
    HOLDS(lostbits_map(scene, NULL, &run, &result, &error) == LOSTBITS_INTERRUPTED);
    HOLDS(lostbits_mend(scene, &requirement, 0, &choice, &later, &result, &error) == LOSTBITS_INTERRUPTED);
    HOLDS(stops_later == 1 && result == NULL);
    HOLDS(lostbits_map(scene, NULL, NULL, &result, &error) == LOSTBITS_OK); /* and goes on */
    lostbits_result_free(result);
    lostbits_scene_free(scene);
    return 0;
}

static void* map_once(void* line) {
    *(int*)line = client_maps_a_text();
    return NULL;
}

int client_runs_in_threads(void) {
    pthread_t threads[4];
    int lines[4] = {-1, -1, -1, -1};
    for (int i = 0; i < 4; ++i) HOLDS(pthread_create(&threads[i], NULL, map_once, &lines[i]) == 0);
    for (int i = 0; i < 4; ++i) pthread_join(threads[i], NULL);
    for (int i = 0; i < 4; ++i)
        if (lines[i] != 0) return lines[i];
    return 0;
}

/* Twenty processes, each forked right behind a call, whose threads would be on their way to rest. */
int client_forks(void) {
    lostbits_error error;
    for (int i = 0; i < 20; ++i) {
        int status = 0, line = 0;
        pid_t child;
        HOLDS(client_maps_a_text() == 0);
        HOLDS(lostbits_end_threads(&error) == LOSTBITS_OK);
        child = fork();
        HOLDS(child >= 0);
        if (child == 0) {
            line = client_maps_a_text();
            _exit(line == 0 ? 0 : 1);
        }
        HOLDS(waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0);
    }
    return 0;
}
