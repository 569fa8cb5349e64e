/* lostbits as a library: scenes, maps, judged rays, certified truths, sweeps, explained rays and choices. The results
 * are those of the program `lostbits`, bit for bit. C99; link with liblostbits.so.
 *
 * Terms: a form is one way to compute the intersection of a ray with a primitive; its answer is a decision (hit or
 * miss) and t. The truth of a ray is the exact answer for the stored numbers, with a proof of each decision.
 *
 * Errors: a function returns LOSTBITS_OK or another of the codes below, which are the exit status of the program. If a
 * call fails, `error->text` says what is wrong, why, and what to try. `error` may be NULL.
 *
 * Handles: the caller owns them and passes each to its `_free` function. Several threads may use one handle at once as
 * long as none of them changes or frees it. Calls share no other state, so they may run at the same time.
 *
 * Nothing is written to a file or to a terminal. Texts are UTF-8 and end with a zero byte. A pointer in a result is
 * valid until the result is freed. */
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

/* The version of this interface. It changes when a program compiled with the old header would no longer work. */
#define LOSTBITS_ABI 10

enum {
    LOSTBITS_OK = 0,           /* done */
    LOSTBITS_NO = 1,           /* done, and nothing meets the requirement of lostbits_choose or lostbits_mend */
    LOSTBITS_BAD_INPUT = 2,    /* an argument or a file is wrong */
    LOSTBITS_ENVIRONMENT = 3,  /* the machine or foreign code failed: memory, a file, a form of the caller */
    LOSTBITS_NOTHING = 4,      /* a pattern selects nothing */
    LOSTBITS_INTERNAL = 70,    /* a bug of lostbits */
    LOSTBITS_INTERRUPTED = 130 /* `stop` was set */
};

typedef struct lostbits_error {
    int code;
    char text[4000]; /* a longer message is cut short */
} lostbits_error;

typedef struct lostbits_scene lostbits_scene;
typedef struct lostbits_form lostbits_form;
typedef struct lostbits_result lostbits_result;

/* LOSTBITS_ABI of the loaded library, and its version as text. */
LOSTBITS_API int lostbits_abi(void);
LOSTBITS_API const char* lostbits_version(void);
/* Ends the threads that calls share, and waits until they have ended; the next call starts new ones. Call it before
 * fork(): a child process has none of these threads, so its calls would wait for ever. Returns LOSTBITS_ENVIRONMENT if
 * the threads are in use: by a running call, by a living thread that has made calls, or by another user of TBB. */
LOSTBITS_API int lostbits_end_threads(lostbits_error* error);

/* ---- Scenes ---- */

/* A list of texts; {NULL, 0} is empty. LOSTBITS_BAD_INPUT for a count above 0 without an array, as for all arrays of
 * this interface, and for a NULL among the texts. */
typedef struct lostbits_words {
    const char* const* words;
    size_t count;
} lostbits_words;

typedef struct lostbits_where {
    const char* data;   /* folder with scenes/ and sweeps/. NULL: $LOSTBITS_DATA, else ./data, else the installed one */
    int width, height;  /* size of the picture in pixels; 0: that of the scene */
    lostbits_words set; /* assignments made before the scene is read: "sphere[0].radius=10" */
    const unsigned char* stop; /* set to 1 by another thread to stop the reading within a second; or NULL */
} lostbits_where;

/* Opens a scene file; `name` is its path, or its name in the data folder (`rtg-fig-7-3-4100-oblique`). `where` may be
 * NULL. */
LOSTBITS_API int lostbits_scene_open(const char* name, const lostbits_where* where, lostbits_scene** scene,
                                     lostbits_error* error);
/* Makes a scene from the text of such a file (docs/files.md). */
LOSTBITS_API int lostbits_scene_text(const char* text, const lostbits_where* where, lostbits_scene** scene,
                                     lostbits_error* error);
/* Adds `count` primitives of one shape ("sphere", "box", ...). Each has its numbers in the order of
 * lb_batch.primitives. The first call of this function or of lostbits_scene_mesh removes the primitives that the scene
 * was read with. `object` and `primitive` in results count the primitives from 0 in the order in which they were added;
 * the triangles of a mesh come last. The numbers are ideal: if the scene's inputs are shared, they are rounded once to
 * binary32, as those of a file are. */
LOSTBITS_API int lostbits_scene_primitives(lostbits_scene* scene, const char* shape, const double* numbers,
                                           size_t count, lostbits_error* error);
/* Sets the mesh of a scene: vertex_count x 3 coordinates, and face_count x 3 indices of vertices, from 0. A face
 * without area is refused: every later triangle would have another number than its row. Another call replaces the
 * mesh. */
LOSTBITS_API int lostbits_scene_mesh(lostbits_scene* scene, const double* vertices, size_t vertex_count,
                                     const uint32_t* faces, size_t face_count, lostbits_error* error);
/* Places all primitives and the mesh that a scene has now by one matrix: twelve numbers, three rows of four. It maps
 * object space to world space or, if `inverse` is not 0, world space to object space (docs/transforms.md). It replaces
 * earlier matrices. The matrix is ideal too. The numbers of the primitives stay as they are; none is multiplied by the
 * matrix. */
LOSTBITS_API int lostbits_scene_transform(lostbits_scene* scene, const double* matrix, int inverse,
                                          lostbits_error* error);
/* The rays and the primitives of a scene as binary64 gets them; every format gets the same values if the scene's inputs
 * are shared. Tables: `rays` with the columns x, y, ox ... dz, row after row of pixels, and one table per shape with
 * the stored numbers of its primitives. If primitives of a shape have transforms, its table also has M00 ...
 * M23, missing for a primitive without a matrix, and `inverse`, which is 1 if the matrix maps world space to object
 * space. The column `number` is the index of the primitive in the scene, from 0. */
LOSTBITS_API int lostbits_scene_rays(const lostbits_scene* scene, lostbits_result** result, lostbits_error* error);
LOSTBITS_API void lostbits_scene_free(lostbits_scene* scene);

/* All shapes, in the order of lb_form.shape, and the keys of each: a table `shapes` with shape, key, and the count of
 * numbers of the key. */
LOSTBITS_API int lostbits_shapes(lostbits_result** result, lostbits_error* error);

/* ---- Forms of the caller ---- */

/* Makes a form of the caller from what `lostbits_plugin.h` describes. `count` is 1, or 2 to give one for each of two
 * formats. Texts are copied; the pointer `own` is kept. Several threads call `run` at once unless `flags` has
 * LB_ONE_THREAD. */
LOSTBITS_API int lostbits_form_make(const lb_form* forms, size_t count, lostbits_form** form, lostbits_error* error);

/* One operation of a formula, as it is applied to the numbers of one ray. `op` is the name of an operation
 * (docs/explain.md): input, constant, add, sub, mul, div, sqrt, fma, neg, abs, copysign, min, max, select, less,
 * less_equal, greater, greater_equal, both, either, opposite, next_up, next_down. */
typedef struct lostbits_operation {
    const char* op;
    int32_t operands[3]; /* indices of earlier operations in the list. For `input`, the first is the index of the input:
                            o.x o.y o.z d.x d.y d.z, then the numbers of the primitive, then the t at which the ray
                            ends */
    double value;        /* for `constant`: its value */
    const char* label;   /* name of the result in the formula's text, or NULL */
} lostbits_operation;

/* Gives the operations of a form in one format; `bits` is 32 or 64. With them, lostbits can treat the form as its own
 * ones: explain it, attribute its error to operations, and run it in formats of any width and without rounding. `hit`
 * and `t` are indices in the list. */
LOSTBITS_API int lostbits_form_write(lostbits_form* form, int bits, const lostbits_operation* operations, size_t count,
                                     int32_t hit, int32_t t, lostbits_error* error);
LOSTBITS_API void lostbits_form_free(lostbits_form* form);

/* ---- What is measured, and how ---- */

typedef struct lostbits_choice {
    lostbits_words forms;      /* names and patterns: "sphere.*"; all forms if both this and `own` are empty */
    lostbits_form* const* own; /* forms of the caller, which come first */
    size_t own_count;
    lostbits_words formats; /* "f32", "bf16", "p5..p12"; empty: f32 and f64 */
    lostbits_words metrics; /* in addition to the default ones: "culprit", "tolerance:0.001", "enough_bits:16" */
    int rows;               /* not 0: also one table per form and format, with one row per ray */
    int written;            /* not 0: run the operations of lostbits_form_write in f32 and f64 too, not `run` */
} lostbits_choice;

typedef struct lostbits_run {
    int threads;               /* 0: one per core. While several calls run, the smallest number of them holds for all */
    const unsigned char* stop; /* set to 1 by another thread to end the call within a second; or NULL */
    /* Reports progress, `done` of `of` units of work. Called from any thread, one call at a time; may be NULL. `of` is
     * 0 if it is not known beforehand: lostbits_mend counts candidates. */
    void (*progress)(void* own, uint64_t done, uint64_t of);
    void* own;
} lostbits_run;

/* Makes a form from a function in a file of C, C++, Rust, GLSL, HLSL, SPIR-V or LLVM IR as it stands, as `--function`
 * does: `FILE.c:NAME` (docs/your-function.md). It has its operations, so lostbits_form_write refuses it. Runs a
 * compiler, which `run->stop` ends; `run` may be NULL. `result` has one table `function` with one row: the form's
 * `name`, its `shape`, and `signature`, what its arguments are taken for. */
LOSTBITS_API int lostbits_form_function(const char* named, lostbits_form** form, const lostbits_run* run,
                                        lostbits_result** result, lostbits_error* error);

/* Measures every chosen form and format on the pixels of a scene. Tables: `summary`, as summary.csv of `lostbits map`.
 * With `rows` also a table FORM.FORMAT for each form and format: outcome, object, truth_object, t, truth, and one
 * column per metric. A text for each form of the caller that is wrong on most rays: how many, and what mistake explains
 * it. */
LOSTBITS_API int lostbits_map(const lostbits_scene* scene, const lostbits_choice* choice, const lostbits_run* run,
                              lostbits_result** result, lostbits_error* error);

/* An array of the caller, which is not copied: item (i, k) is at data + i*step + k*item_step bytes. `bits` is 32
 * (float), 64 (double) or 8 (a byte; any value but 0 is true). With `step` 0 all rays have the same items. `data` is
 * NULL if the array is not given. */
typedef struct lostbits_array {
    const void* data;
    ptrdiff_t step, item_step;
    int bits;
} lostbits_array;

typedef struct lostbits_rays {
    size_t count;
    lostbits_array origin, direction; /* count x 3 */
    lostbits_array tmin, tmax;        /* count: the range of t of each ray, both ends included */
    const char* open_ends;            /* ends of the range that are excluded: "tmin", "tmax", "both"; NULL: none */
    const char* shape;                /* of the primitives; NULL if `scene` has them */
    lostbits_array primitives; /* primitive_count x numbers of a primitive, in the order of lb_batch.primitives */
    size_t primitive_count;
    int paired;                      /* not 0: ray i is tested with primitive i alone; primitive_count is then count */
    const lostbits_scene* scene;     /* the scene whose primitives the rays are tested with; or NULL */
    lostbits_array t, hit;           /* count: answers to judge; a t that is NaN or infinite is a miss */
    const char* format;              /* format in which the answers were computed; NULL: from the type of t */
    int unit;                        /* not 0: t is a distance, along the normalised direction */
    int touching, at_origin, inside; /* as in lb_form: LB_HIT, LB_MISS, LB_EXIT; 0 or LB_INSIDE_... */
    int facing;                      /* 0, LB_FACING_FRONT or LB_FACING_BACK */
    lostbits_array by;               /* count: a number; the summary of a judgement also has a group for each value */
    lostbits_array matrix; /* count x 12: the matrix of the primitive for each ray, from object space to world space,
                              row by row: that of primitive i if `paired`, else of the only primitive */
} lostbits_rays;

/* Judges answers to rays of the caller, and measures the chosen forms on these rays, as `lostbits judge` does. The
 * tables and texts are those of lostbits_map; the answers of the caller are those of the form `file.arrays`. With `by`,
 * the summary also has rows for each of its values, and a column `by` in front. */
LOSTBITS_API int lostbits_judge(const lostbits_rays* rays, const lostbits_choice* choice, const lostbits_run* run,
                                lostbits_result** result, lostbits_error* error);
/* Answers of the chosen forms to the rays, not judged: a table FORM.FORMAT for each form and format, with hit and t
 * (NaN for a miss). */
LOSTBITS_API int lostbits_answers(const lostbits_rays* rays, const lostbits_choice* choice, const lostbits_run* run,
                                  lostbits_result** result, lostbits_error* error);
/* The certified truth of each ray: a table `truth` with decision (0 miss, 1 hit, 2 unresolved), primitive (index of the
 * primitive, from 0), and t = t_hi + t_lo with a relative error of at most 2^-72. */
LOSTBITS_API int lostbits_truth(const lostbits_rays* rays, const lostbits_run* run, lostbits_result** result,
                                lostbits_error* error);
/* Every crossing of each ray with triangles, in its range. The triangles are those of `rays->scene`, which has no other
 * primitives, or an array that all rays share. They are closed and met from both sides, and t >= 0 counts. Table
 * `crossings`: ray and place (from 0, in the exact order of t; crossings at the same t have the same place), primitive
 * (index of the triangle), t = t_hi + t_lo with a relative error of at most 2^-72, front (the ray meets the side on
 * which the corners run counter-clockwise), at_rim (it passes through an edge or a vertex). Table `rays`: resolved, for
 * each ray; 0 if no precision decided, and crossings may be missing. */
LOSTBITS_API int lostbits_hits(const lostbits_rays* rays, const lostbits_run* run, lostbits_result** result,
                               lostbits_error* error);
/* Answers about the whole surface of the meshes of `rays->scene`, in the terms of files of rays (docs/judge.md). A
 * record is a ray or, for the column "inside", a point; points are the origins, and have no direction. */
typedef struct lostbits_mesh_answers {
    const char* column;     /* what is answered: "hit_index", "crossings", "parity" or "inside" */
    lostbits_array values;  /* count: the numbers of that column; -1 or NaN as a hit_index: the ray has no hit */
    lostbits_array objects; /* count: for "hit_index", the triangle that is hit, from 0; NaN for none */
    int rows;               /* not 0: the result has a table with one row for each ray or point */
} lostbits_mesh_answers;
/* Judges them as `lostbits judge` does. Of `rays` it takes count, origin, direction, tmin, tmax, open_ends, t, scene,
 * format, unit, touching and facing. Tables: `summary`, as summary.csv, and `rows`. */
LOSTBITS_API int lostbits_judge_mesh(const lostbits_rays* rays, const lostbits_mesh_answers* answers,
                                     const lostbits_run* run, lostbits_result** result, lostbits_error* error);
/* Position of points (count x 3) relative to the meshes of a scene, which has no other primitives. Table `points`:
 * winding (number of layers of the surface that enclose the point), crossings (of the ray by which they are
 * counted), on_surface, resolved. Table `mesh`, one row: the numbers of edges, of border edges (one face), non_manifold
 * edges (more than two), unbalanced edges (along which more faces run one way than the other), odd edges (an odd number
 * of faces) and duplicates (faces with the vertices of an earlier face). The winding does not depend on the ray if
 * unbalanced is 0, and the parity of the crossings does not if odd is 0. */
LOSTBITS_API int lostbits_inside(const lostbits_scene* scene, const lostbits_array* points, size_t count,
                                 const lostbits_run* run, lostbits_result** result, lostbits_error* error);
/* Measures a sweep along axes. `sweep` is a file, its name in the data folder or, if `is_text` is not 0, its text.
 * Tables: `samples` and, if the sweep has one axis, `onsets`. */
LOSTBITS_API int lostbits_sweep(const char* sweep, int is_text, const char* data, const lostbits_choice* choice,
                                const lostbits_run* run, lostbits_result** result, lostbits_error* error);
/* Explains one ray, that of pixel (x, y), operation by operation, in the one form and format that `choice` names. Text
 * 0 is the output of `lostbits explain`; text 1 is the same as JSON. */
LOSTBITS_API int lostbits_explain(const lostbits_scene* scene, int x, int y, const lostbits_choice* choice,
                                  lostbits_result** result, lostbits_error* error);
/* Measures a scene by a study: "consistency", "offsets" or "render" (docs/consistency.md, offsets.md, render.md). The
 * study is a command of the program, and the table `summary` is its summary.csv. `options` are options of that command,
 * each as NAME=WORD: "strategy=offset.ulp*", "points=computed", "stage=shadows"; one that takes several words is
 * repeated. NULL or empty: their default values. If `choice` names no form or no format, the default ones of the
 * command are measured. */
LOSTBITS_API int lostbits_study(const char* study, const lostbits_scene* scene, const lostbits_words* options,
                                const lostbits_choice* choice, const lostbits_run* run, lostbits_result** result,
                                lostbits_error* error);

/* Measures speed against accuracy, as `lostbits trade` does: on the rays of a scene or, if it is NULL, on rays of known
 * kinds at a shape (NULL: "sphere"). If `quick` is not 0, the measurements are few and short. Tables: `trade` and
 * `pareto`, as trade.csv and pareto.csv; text 0 is the answer in words. Times differ from call to call. */
LOSTBITS_API int lostbits_trade(const lostbits_scene* scene, const char* shape, int quick,
                                const lostbits_choice* choice, const lostbits_run* run, lostbits_result** result,
                                lostbits_error* error);

typedef struct lostbits_requirement {
    double bits;      /* least number of correct bits of t, 0 to 53 */
    double tolerance; /* largest error of the hit point along the ray, in the scene's unit of length; below 0: any */
    double wrong;     /* largest share of the rays with a wrong decision, 0 to 1 */
    const char* at;   /* share of the hits that must keep `bits` and `tolerance`: "p99", "max" (all); NULL: p99 */
} lostbits_requirement;

/* Finds the fastest form and format that meets the requirement. Tables: `choose`, and `room`, the margin in which the
 * chosen one still meets it; text 0 is the answer in words. Returns LOSTBITS_NO, with a result, if nothing meets it. */
LOSTBITS_API int lostbits_choose(const lostbits_scene* scene, const lostbits_requirement* requirement,
                                 const lostbits_choice* choice, const lostbits_run* run, lostbits_result** result,
                                 lostbits_error* error);

/* Finds what to change in the one form and format that `choice` names so that it meets the requirement on every pixel
 * (docs/mend.md): operations to do in double or, with `two_words`, in two numbers of the format, and other ways to
 * write the formula. The operations of the form must be known. Tables: `mend`, `minimal` and `probes`, as the files of
 * `lostbits mend`. Text 0 is the answer in words; text 1 is the form to take, as C++, if one meets it. Returns
 * LOSTBITS_NO, with a result, if nothing does. Set `tolerance` below 0; `at` NULL is "max". */
LOSTBITS_API int lostbits_mend(const lostbits_scene* scene, const lostbits_requirement* requirement, int two_words,
                               const lostbits_choice* choice, const lostbits_run* run, lostbits_result** result,
                               lostbits_error* error);

/* ---- Results: tables of columns, and texts ---- */

typedef struct lostbits_table {
    const char* name;
    size_t columns, rows;
} lostbits_table;

typedef struct lostbits_column {
    const char *name, *type, *unit, *meaning; /* type: number, integer, boolean or string, as in datapackage.json */
    const double* numbers;                    /* one per row, NaN if missing; NULL for texts and categories */
    const char* const* texts;                 /* one per row, NULL if missing; NULL for other columns */
    const uint8_t* categories;                /* one index in `names` per row, 255 if missing; NULL for other columns */
    const char* const* names;                 /* of the categories */
    size_t name_count;
    const uint8_t* colours; /* red, green and blue of each name, as in pictures; NULL if the names have no colours */
} lostbits_column;

/* Fills `into` with a table, or with a column of a table; both are counted from 0. Returns LOSTBITS_NOTHING beyond the
 * last one, LOSTBITS_BAD_INPUT if `into` is NULL. */
LOSTBITS_API int lostbits_result_table(const lostbits_result* result, size_t table, lostbits_table* into);
LOSTBITS_API int lostbits_result_column(const lostbits_result* result, size_t table, size_t column,
                                        lostbits_column* into);
/* A text, counted from 0; NULL beyond the last. */
LOSTBITS_API const char* lostbits_result_text(const lostbits_result* result, size_t text);
LOSTBITS_API void lostbits_result_free(lostbits_result* result);

#ifdef __cplusplus
}
#endif

#endif
