/* lostbits as a library: scenes, maps, judged rays, certified truths, sweeps, explained rays and choices, as the
 * program `lostbits` measures them, with the same bits. C99; link with liblostbits.so.
 *
 * A function returns LOSTBITS_OK or another of the codes below, which are the exit codes of the program, and then
 * `error->text` says what is wrong, why, and what to try; `error` may be NULL. Nothing is written to a file or to a
 * terminal. Handles belong to the caller, who gives them back to their `_free`; a handle may be used by several threads
 * at once as long as none of them changes or frees it. There is no state beside the handles: calls run side by side.
 * Texts are UTF-8 and end with a zero byte. A pointer in a result lives as long as the result. */
#ifndef LOSTBITS_H
#define LOSTBITS_H

#include <stddef.h>
#include <stdint.h>

#include <lostbits_plugin.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define LOSTBITS_API __attribute__((visibility("default")))
#else
#define LOSTBITS_API
#endif

/* The version of this file. It changes where a program that was compiled with an older one would go wrong. */
#define LOSTBITS_ABI 7

enum {
    LOSTBITS_OK = 0,           /* done */
    LOSTBITS_NO = 1,           /* done, and the answer is no: nothing meets the wish of a choice */
    LOSTBITS_BAD_INPUT = 2,    /* an argument, or a file, that does not say what it should */
    LOSTBITS_ENVIRONMENT = 3,  /* the machine: memory, a file, a form from outside that failed */
    LOSTBITS_NOTHING = 4,      /* a pattern that selects nothing */
    LOSTBITS_INTERNAL = 70,    /* a fault of lostbits */
    LOSTBITS_INTERRUPTED = 130 /* `stop` was set */
};

typedef struct lostbits_error {
    int code;
    char text[4000]; /* cut short where it is longer */
} lostbits_error;

typedef struct lostbits_scene lostbits_scene;
typedef struct lostbits_form lostbits_form;
typedef struct lostbits_result lostbits_result;

/* LOSTBITS_ABI of the library that is loaded, and its version as text. */
LOSTBITS_API int lostbits_abi(void);
LOSTBITS_API const char* lostbits_version(void);
/* Ends the threads that calls share, and waits for them; the next call makes new ones. A process that is forked has
 * none of them, so that calls in the child would wait for ever: call it before fork(). LOSTBITS_ENVIRONMENT where they
 * are in use, by a call that runs, a thread that lives and has made calls, or another user of TBB. */
LOSTBITS_API int lostbits_end_threads(lostbits_error* error);

/* ---- Scenes ---- */

/* A list of texts; {NULL, 0} is empty. Here as in all arrays of the interface, a count without an array, and a NULL
 * among the texts, are LOSTBITS_BAD_INPUT. */
typedef struct lostbits_words {
    const char* const* words;
    size_t count;
} lostbits_words;

typedef struct lostbits_where {
    const char* data;   /* the folder with scenes/ and sweeps/; NULL: $LOSTBITS_DATA, then ./data, then the program's */
    int width, height;  /* of the picture; 0: the scene's own */
    lostbits_words set; /* changes before the scene is read: "sphere[0].radius=10" */
    const unsigned char* stop; /* another thread sets it to 1 to end the reading within a second; NULL: nobody does */
} lostbits_where;

/* A scene file, or the name of one in the data folder (`rtg-fig-7-3-4100-oblique`). `where` may be NULL. */
LOSTBITS_API int lostbits_scene_open(const char* name, const lostbits_where* where, lostbits_scene** scene,
                                     lostbits_error* error);
/* A scene from the text of such a file (docs/files.md). */
LOSTBITS_API int lostbits_scene_text(const char* text, const lostbits_where* where, lostbits_scene** scene,
                                     lostbits_error* error);
/* Takes the solids that a scene has away and gives it these: `count` solids of one shape ("sphere", "box", ...), the
 * numbers of each in the order of lb_batch.solids. A second call adds; `object` and `solid` of results number them from
 * 0 in the order in which they were given, the triangles of a mesh last. Numbers are ideal: where the scene's inputs
 * are shared they are rounded once to binary32, as those of a file are. */
LOSTBITS_API int lostbits_scene_solids(lostbits_scene* scene, const char* shape, const double* numbers, size_t count,
                                       lostbits_error* error);
/* The same of a mesh: vertices count x 3, faces count x 3 places among them. */
LOSTBITS_API int lostbits_scene_mesh(lostbits_scene* scene, const double* vertices, size_t vertex_count,
                                     const uint32_t* faces, size_t face_count, lostbits_error* error);
/* Puts all solids and the mesh of a scene under one matrix: twelve numbers, three rows of four, from their own space to
 * the world, or with `inverse` not 0 back (docs/spaces.md). The matrix is ideal too, and replaces those that there are;
 * none of their numbers is multiplied by it. */
LOSTBITS_API int lostbits_scene_transform(lostbits_scene* scene, const double* matrix, int inverse,
                                          lostbits_error* error);
/* The rays of the scene's camera as every format gets them: a table `rays` with x, y, ox ... dz, row after row of
 * pixels; and a table a shape with the stored numbers of its solids. Where solids of the shape stand under matrices it
 * has also M00 ... M23, missing for those that do not, and `inverse`, whether these lead to the solid. `number`: which
 * of all solids of the scene it is, from 0. */
LOSTBITS_API int lostbits_scene_rays(const lostbits_scene* scene, lostbits_result** result, lostbits_error* error);
LOSTBITS_API void lostbits_scene_free(lostbits_scene* scene);

/* The shapes there are, in the order of lb_form.shape, and the keys of each: a table `shapes` with shape, key, and how
 * many numbers the key has. */
LOSTBITS_API int lostbits_shapes(lostbits_result** result, lostbits_error* error);

/* ---- Forms of one's own ---- */

/* A form as `lostbits_plugin.h` describes it, one or one for each of two formats; texts are copied, `own` is kept. Its
 * `run` is called from several threads at once, unless its flags say LB_ONE_THREAD. */
LOSTBITS_API int lostbits_form_make(const lb_form* forms, size_t count, lostbits_form** form, lostbits_error* error);

/* One operation of a formula: what was done to one ray's numbers. `op` is a name of the tape (docs/explain.md): input,
 * constant, add, sub, mul, div, sqrt, fma, neg, abs, copysign, min, max, select, less, less_equal, greater,
 * greater_equal, both, either, opposite, next_up, next_down. */
typedef struct lostbits_operation {
    const char* op;
    int32_t operands[3]; /* places in the list, each before its own. Of an input: which number it is, o.x o.y o.z d.x
                            d.y d.z, then the numbers of the solid, then where the ray ends */
    double value;        /* of a constant */
    const char* label;   /* what the formula's text calls it, or NULL */
} lostbits_operation;

/* Says which operations the form does in a format (32 or 64), so that it can be explained, blamed, and run in formats
 * of any width and without rounding, as the forms of lostbits are. `hit` and `t` are places in the list. */
LOSTBITS_API int lostbits_form_write(lostbits_form* form, int bits, const lostbits_operation* operations, size_t count,
                                     int32_t hit, int32_t t, lostbits_error* error);
LOSTBITS_API void lostbits_form_free(lostbits_form* form);

/* ---- What is measured, and how ---- */

typedef struct lostbits_choice {
    lostbits_words forms;      /* names and globs: "sphere.*"; all where neither these nor `own` are there */
    lostbits_form* const* own; /* forms of one's own, which come first */
    size_t own_count;
    lostbits_words formats; /* "f32", "bf16", "p5..p12"; empty: f32 and f64 */
    lostbits_words metrics; /* beside the default ones: "culprit", "tolerance:0.001", "enough_bits:16" */
    int rows;               /* not 0: also a table a form and format with a row a ray */
    int written;            /* not 0: forms of one's own answer by their written operations in f32 and f64 too */
} lostbits_choice;

typedef struct lostbits_run {
    int threads;               /* 0: one per core. While several calls run, the smallest number holds for all */
    const unsigned char* stop; /* another thread sets it to 1 to end the call within a second; NULL: nobody does */
    /* From any thread, one at a time; or NULL. `of` is 0 where it is not known beforehand: of lostbits_mend, which
     * counts candidates. */
    void (*progress)(void* own, uint64_t done, uint64_t of);
    void* own;
} lostbits_run;

/* Every chosen form and format over the pixels of a scene. Tables: `summary`, as summary.csv of `lostbits map`; with
 * `rows`, one that is named FORM.FORMAT for each: outcome, object, truth_object, t, truth, and a column a metric. */
LOSTBITS_API int lostbits_map(const lostbits_scene* scene, const lostbits_choice* choice, const lostbits_run* run,
                              lostbits_result** result, lostbits_error* error);

/* An array of one's own, read where it lies: item (i, k) is at data + i*step + k*item_step bytes. `bits` is 32 (float),
 * 64 (double) or 8 (a byte that is 0 or not). `step` 0: the same for every ray. `data` NULL: there is none. */
typedef struct lostbits_array {
    const void* data;
    ptrdiff_t step, item_step;
    int bits;
} lostbits_array;

typedef struct lostbits_rays {
    size_t count;
    lostbits_array origin, direction; /* count x 3 */
    lostbits_array tmin, tmax;        /* count: where each ray begins and ends, both ends being part of it */
    const char* open_ends;            /* but for "tmin", "tmax" or "both"; NULL: none */
    const char* shape;                /* of the solids; or NULL where `scene` has them */
    lostbits_array solids;            /* solid_count x numbers */
    size_t solid_count;
    int paired;                      /* not 0: ray i is aimed at solid i alone; solid_count is count then */
    const lostbits_scene* scene;     /* whose solids the rays are aimed at; or NULL */
    lostbits_array t, hit;           /* count: answers; a t that is NaN or infinite is a miss */
    const char* format;              /* that the answers were computed in; NULL: by the type of t */
    int unit;                        /* not 0: t is a distance, of the direction normalised */
    int touching, at_origin, inside; /* as in lb_form: LB_HIT, LB_MISS, LB_EXIT; 0 or LB_INSIDE_... */
    int facing;                      /* 0, LB_FACING_FRONT or LB_FACING_BACK */
    lostbits_array by;               /* count: a number by which the summary of a judgement is grouped as well */
    lostbits_array matrix; /* count x 12: under which each ray's solid stands, from its space to the world, row by row;
                              its own solid of pairs, else the only one there is */
} lostbits_rays;

/* Rays of one's own, and answers if there are any: as `lostbits judge`. Tables as of a map, the answers being those of
 * the form `file.arrays`; with `by` the summary has rows for each of its values too, and a column `by` in front. */
LOSTBITS_API int lostbits_judge(const lostbits_rays* rays, const lostbits_choice* choice, const lostbits_run* run,
                                lostbits_result** result, lostbits_error* error);
/* What the chosen forms answer to the rays, unjudged: a table FORM.FORMAT each, with hit and t (NaN of a miss). */
LOSTBITS_API int lostbits_answers(const lostbits_rays* rays, const lostbits_choice* choice, const lostbits_run* run,
                                  lostbits_result** result, lostbits_error* error);
/* The certified truth of each ray: a table `truth` with decision (0 miss, 1 hit, 2 unresolved), solid (from 0), and
 * t = t_hi + t_lo to 2^-72 of its value. */
LOSTBITS_API int lostbits_truth(const lostbits_rays* rays, const lostbits_run* run, lostbits_result** result,
                                lostbits_error* error);
/* Every crossing of each ray with triangles, in its range: those of a scene without other solids, or an array of them
 * that all rays share. Triangles are closed and met from both sides, and t >= 0 counts. Table `crossings`: ray and
 * place (from 0, in the exact order of t; crossings at one t share a place), solid, t = t_hi + t_lo to 2^-72 of its
 * value, front (it is met from the side on which its corners run counter-clockwise), at_rim (through an edge or a
 * vertex). Table `rays`: resolved, for each ray; 0 where no precision decided. */
LOSTBITS_API int lostbits_hits(const lostbits_rays* rays, const lostbits_run* run, lostbits_result** result,
                               lostbits_error* error);
/* Whether points (count x 3) lie in the meshes of a scene, which has no other solids. Table `points`: winding (by how
 * many layers of the surface the point is enclosed), crossings (of the ray that was counted), on_surface, resolved.
 * Table `mesh`, one row: edges, border (of one face), non_manifold (of more than two), unbalanced (along which more
 * faces run one way than the other), odd (of an odd number of faces), duplicates (faces). The winding does not depend
 * on the ray where unbalanced is 0, the parity of the crossings where odd is 0. */
LOSTBITS_API int lostbits_inside(const lostbits_scene* scene, const lostbits_array* points, size_t count,
                                 const lostbits_run* run, lostbits_result** result, lostbits_error* error);
/* A sweep file or the name of one, or (`is_text`) the text of one. Tables `samples` and, of one axis, `onsets`. */
LOSTBITS_API int lostbits_sweep(const char* sweep, int is_text, const char* data, const lostbits_choice* choice,
                                const lostbits_run* run, lostbits_result** result, lostbits_error* error);
/* One ray, operation by operation, for the one form and format that `choice` names: pixel (x, y) of the scene. Texts:
 * 0 what `lostbits explain` says, 1 the same as JSON. */
LOSTBITS_API int lostbits_explain(const lostbits_scene* scene, int x, int y, const lostbits_choice* choice,
                                  lostbits_result** result, lostbits_error* error);
/* By how much the origin of the next ray must move, and what strategies do (docs/offsets.md): a table `offsets`, as
 * summary.csv of `lostbits offsets`. `strategies`: names and globs; all where there are none. `points`: "computed",
 * "projected", or both where NULL. Where `choice` names no form or no format the usual ones are asked. */
LOSTBITS_API int lostbits_offsets(const lostbits_scene* scene, const lostbits_words* strategies, const char* points,
                                  const lostbits_choice* choice, const lostbits_run* run, lostbits_result** result,
                                  lostbits_error* error);

typedef struct lostbits_wish {
    double bits;      /* correct bits of t, 0 to 53 */
    double tolerance; /* how far the hit point may be off along the ray, in the scene's unit of length; below 0: any */
    double wrong;     /* share of the rays that may be decided wrongly */
    const char* at;   /* of how many hits that is asked: "p99", "max"; NULL: p99 */
} lostbits_wish;

/* The cheapest form and format that meets the wish. Tables `choose` and `room`; text 0 in words. LOSTBITS_NO with a
 * result where nothing meets it. */
LOSTBITS_API int lostbits_choose(const lostbits_scene* scene, const lostbits_wish* wish, const lostbits_choice* choice,
                                 const lostbits_run* run, lostbits_result** result, lostbits_error* error);

/* What to change in the one form and format that `choice` names, whose operations are known, so that it meets the wish
 * on every pixel (docs/mend.md): operations in double, or with `two_words` in two numbers of the format, and other ways
 * of writing it. Tables `mend` and `minimal`, as the files of `lostbits mend`; text 0 in words, text 1 the form to take
 * as C++ where one meets the wish. LOSTBITS_NO with a result where nothing does. The wish names no tolerance; `at` NULL
 * is "max". */
LOSTBITS_API int lostbits_mend(const lostbits_scene* scene, const lostbits_wish* wish, int two_words,
                               const lostbits_choice* choice, const lostbits_run* run, lostbits_result** result,
                               lostbits_error* error);

/* ---- Results: tables of columns, and texts ---- */

typedef struct lostbits_table {
    const char* name;
    size_t columns, rows;
} lostbits_table;

typedef struct lostbits_column {
    const char *name, *type, *unit, *meaning; /* type: number, integer, boolean or string, as in datapackage.json */
    const double* numbers;                    /* a row each, NaN where missing; NULL for texts and categories */
    const char* const* texts;                 /* a row each, NULL where missing; else NULL */
    const uint8_t* categories;                /* a row each, a place among the names, 255 where missing; else NULL */
    const char* const* names;                 /* of the categories */
    size_t name_count;
} lostbits_column;

/* Tables are counted from 0; LOSTBITS_NOTHING beyond the last, LOSTBITS_BAD_INPUT where `into` is NULL. */
LOSTBITS_API int lostbits_result_table(const lostbits_result* result, size_t table, lostbits_table* into);
LOSTBITS_API int lostbits_result_column(const lostbits_result* result, size_t table, size_t column,
                                        lostbits_column* into);
/* NULL beyond the last. */
LOSTBITS_API const char* lostbits_result_text(const lostbits_result* result, size_t text);
LOSTBITS_API void lostbits_result_free(lostbits_result* result);

#ifdef __cplusplus
}
#endif

#endif
