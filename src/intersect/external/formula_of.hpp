// Makes a form template of a library available to the program: as a form in every arithmetic, and as functions of the C
// interface. This header is compiled into the library, and nothing in it refers to the program.
#pragma once

#include <exception>
#include <string>

#include <lostbits_plugin.h>
#include "intersect/external/formula.hpp"
#include "intersect/table/arithmetics.hpp"
#include "number/archetype.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::external {

inline const FormulaWatch* formula_watch = nullptr;
template <class Form>
inline const char* name_for_messages = nullptr;

/// Calls `function`, and reports the running form to the program.
template <class Form, auto function, class = std::decay_t<decltype(function)>>
struct ReportingCall;
template <class Form, auto function, class R, class... A>
struct ReportingCall<Form, function, R (*)(A...)> {
    static R run(A... arguments) {
        const struct CallReport {
            CallReport() {
                if (formula_watch != nullptr) formula_watch->enter(name_for_messages<Form>);
            }
            ~CallReport() {
                if (formula_watch != nullptr) formula_watch->leave();
            }
        } report;

        try {
            return function(arguments...);
        } catch (const std::exception& exception) {
            throw EnvironmentError(std::string(name_for_messages<Form>) + ": threw an exception: " + exception.what() +
                                   "; a form must answer every ray, with a miss or a NaN if it has no better answer");
        } catch (...) {
            throw EnvironmentError(std::string(name_for_messages<Form>) +
                                   ": threw something that is not a std::exception; a form must answer every ray, with "
                                   "a miss or a NaN if it has no better answer");
        }
    }
};

/// A distance field that serves only to test which arguments a form takes.
struct AnyField {
    template <class T>
    T operator()(const Vec<T>& p) const {
        return p.x;
    }
};

template <class Form>
concept TakesAPrimitive =
    !marches<Form> || requires(const Ray<float>& ray, const MarchConstants<float>& constants, sdf::NoMarchWatch& w) {
    Form::intersect(ray, AnyField(), constants, w);
};

/// True if this library was compiled so that a·b − c is rounded once. Then its float and double answers contain
/// operations that no tape records. The test computes x·x − y for x = 1 + 2^-12 and y = 1 + 2^-11: x² is 1 + 2^-11 +
/// 2^-24, which rounds to y.
inline bool is_contracted() {
    volatile float a = 1 + 0x1p-12F, c = 1 + 0x1p-11F;
    const float x = a, y = c;
    return x * x - y != 0;
}

/// Compiles the form over the archetype; never called. A formula must not use an operation that the number types do not
/// have in common: a constant that is not whole, a call of std::, a number without a value. Some of these operations
/// compile over every number type, but not over the archetype.
template <class Form>
void compile_with_archetype(const Ray<Archetype>* ray, const Primitive<Archetype>* primitive,
                            const MarchConstants<Archetype>* c) {
    if constexpr (marches<Form>) {
        sdf::NoMarchWatch unwatched;
        static_cast<void>(Form::intersect(*ray, AnyField(), *c, unwatched));
    } else {
        Primitives::of_shape<shape_of<Form>>([&]<template <class> class S>() {
            static_cast<void>(intersect_primitive<Form>(*ray, primitive->as<S>(), ray->origin.x));
        });
    }
}

/// Computes with the program's precision of intervals. The precision is a thread-local variable, and the program and
/// the library each have one. So the library sets its own from the precision of the numbers that the program passes.
template <class Form>
Hit<Interval> enclose_by_intervals(const Ray<Interval>& ray, const Target<Interval>& target) {
    const Interval::Precision precision(mpfr_get_prec(ray.origin.x.lower()));
    return table::enclose_hit<Form, Interval>(ray, target);
}

/// Kernels of the form for each register width, from the object files that are compiled for that width.
template <class Form>
inline std::array<simd::RawFormKernels, 3> compiled_packs{};

template <class Form, std::size_t width, class S>
void run_pack(const simd::RawBatch<S>& batch) {
    if constexpr (std::same_as<S, float>) compiled_packs<Form>[width].f32(batch);
    else compiled_packs<Form>[width].f64(batch);
}

template <class Form, std::size_t width>
simd::RawFormKernels reporting_pack() {
    const simd::RawFormKernels& compiled = compiled_packs<Form>[width];
    return {compiled.f32 ? ReportingCall<Form, run_pack<Form, width, float>>::run : nullptr,
            compiled.f64 ? ReportingCall<Form, run_pack<Form, width, double>>::run : nullptr};
}

/// Compiles the form with the archetype at the end of `calls` nested calls. Compilers report last what is instantiated
/// last, and for an `if` on a comparison the message of the masks (see `NotABool`) should precede the archetype's
/// errors.
template <class Form, int calls = 12>
void check_rules_last() {
    if constexpr (calls > 0) check_rules_last<Form, calls - 1>();
    else compile_with_archetype<Form>(nullptr, nullptr, nullptr);
}

/// Answers a batch in S through the C interface. `stated_roots` selects what the form returns: only t, or near and far.
template <class Form, class S, Roots stated_roots = Form::info.roots>
const char* answer_c_batch(const lb_batch* batch) {
    const auto* const rays = static_cast<const S*>(batch->rays);
    const auto* const ends = static_cast<const S*>(batch->ends);
    auto* const near_far = static_cast<S*>(batch->near_far);
    for (std::size_t i = 0; i < batch->size; ++i) {
        const S* const r = rays + 6 * i;
        const S* const n = static_cast<const S*>(batch->primitives) + batch->primitive_stride * i;
        const Ray<S> ray{{r[0], r[1], r[2]}, {r[3], r[4], r[5]}};
        const S end = ends ? ends[i] : std::numeric_limits<S>::infinity();
        const Hit<S> hit = intersect_numbers<Form>(
            ray, [n](std::size_t k) { return n[k]; }, end);
        batch->hit[i] = hit.hit ? 1 : 0;
        near_far[2 * i] = stated_roots == Roots::both ? hit.near : hit.t;
        near_far[2 * i + 1] = hit.far;
    }
    return nullptr;
}

template <class Form, class S, Roots stated_roots = Form::info.roots>
constexpr lb_form plain_form() {
    return {.name = Form::info.name.data(),
            .title = Form::info.title.data(),
            .source = Form::info.source.data(),
            .shape = static_cast<int>(shape_of<Form>),
            .format = 8 * sizeof(S),
            .direction = static_cast<int>(Form::info.direction),
            .roots = static_cast<int>(stated_roots),
            .touching = static_cast<int>(Form::info.touching),
            .at_origin = static_cast<int>(Form::info.at_origin),
            .flags = (!takes_tmax(shape_of<Form>) && Form::info.roots != Roots::none ? unsigned{LB_NO_END} : 0U) |
                     (Form::info.endless ? unsigned{LB_NO_END} : 0U) |
                     static_cast<unsigned>(Form::info.inside) * LB_INSIDE_EXIT |
                     static_cast<unsigned>(Form::info.facing) * LB_FACING_FRONT,
            .own = nullptr,
            .run = answer_c_batch<Form, S, stated_roots>};
}

/// A form of the C interface that yields the t of the form's hits as its first root.
template <class Form, class S>
inline constexpr lb_form first_form = plain_form<Form, S, Roots::first_only>();

template <class Form>
Formula formula_of() {
    static_assert(TakesAPrimitive<Form>,
                  "intersect must be static and take (const Ray<T>&, const Sphere<T>&), or (const Ray<T>&, const "
                  "Box<T>&, const T& tmax), or (const Ray<T>&, const Field&, const intersect::MarchConstants<T>&, "
                  "Watch&)");
    table::Intersector form{.info = &Form::info, .shape = shape_of<Form>, .native32 = {}, .native64 = {}};

    // Every call reports the form, so that a crash names it.
    form.native32 = ReportingCall<Form, table::intersect_native_batch<Form, float>>::run;
    form.ball = ReportingCall<Form, table::enclose_hit<Form, Ball>>::run;
    form.interval = ReportingCall<Form, enclose_by_intervals<Form>>::run;
    form.record = ReportingCall<Form, table::record_form_evaluation<Form>>::run;
    form.record_all = ReportingCall<Form, table::record_whole_form<Form>>::run;
    form.count = ReportingCall<Form, table::count_form_operations<Form>>::run;
    form.bounded = ReportingCall<Form, table::evaluate_form_with_bounds<Form>>::run;
    if constexpr (marches<Form>) form.log = ReportingCall<Form, table::log_form_march<Form>>::run;

    if constexpr (Form::info.formats == Formats::all) {
        form.native64 = ReportingCall<Form, table::intersect_native_batch<Form, double>>::run;
        form.rounded = ReportingCall<Form, table::intersect_rounded_batch<Form>>::run;
    }

    if (false) check_rules_last<Form>();

    // Forms that yield near and far also come with t as their root, for which the C interface has no field.
    FirstRootForms first_root_forms;
    if constexpr (!marches<Form> && Form::info.roots == Roots::both) {
        first_root_forms.f32 = &first_form<Form, float>;
        if constexpr (Form::info.formats == Formats::all) first_root_forms.f64 = &first_form<Form, double>;
    }
    return {form,
            {reporting_pack<Form, 0>(), reporting_pack<Form, 1>(), reporting_pack<Form, 2>()},
            &name_for_messages<Form>,
            first_root_forms};
}

/// Exports a list of forms from a library.
template <class... Form>
struct Formulas {
    static const FormulaList* list(const FormulaWatch* watch, const char* build,
                                   const std::array<void (*)(simd::RawFormKernels*), 3>& fill_packs) {
        formula_watch = watch;
        for (std::size_t width = 0; width < fill_packs.size(); ++width) {
            if (fill_packs[width] == nullptr) continue;
            std::array<simd::RawFormKernels, sizeof...(Form)> rows;
            fill_packs[width](rows.data());
            std::size_t i = 0;
            ((compiled_packs<Form>[width] = rows[i++]), ...);
        }
        static const std::array<Formula, sizeof...(Form)> formulas{formula_of<Form>()...};
        static const FormulaList formula_list{build, formulas.data(), formulas.size(), is_contracted()};
        return &formula_list;
    }

    /// The forms in float and in double for the C interface. Forms that march are left out, since they take no
    /// primitive that the C interface could name.
    static const lb_form* plain(int abi, std::size_t* count) {
        if (abi != LOSTBITS_PLUGIN_ABI) return nullptr;
        static const std::vector<lb_form> forms_of_all = [] {
            std::vector<lb_form> forms;
            const auto add = [&forms]<class F>() {
                if constexpr (!marches<F>) {
                    forms.push_back(plain_form<F, float>());
                    if constexpr (F::info.formats == Formats::all) forms.push_back(plain_form<F, double>());
                }
            };
            (add.template operator()<Form>(), ...);
            return forms;
        }();
        *count = forms_of_all.size();
        return forms_of_all.data();
    }
};

}  // namespace lostbits::intersect::external
