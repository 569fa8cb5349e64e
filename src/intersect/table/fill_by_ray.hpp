// Defines `fill_by_ray`, which compiles the forms over the arithmetics that take one ray at a time.
#pragma once

#include "intersect/table/arithmetics.hpp"
#include "intersect/table/fill_forms.hpp"

namespace lostbits::intersect::table {

template <class Forms>
std::span<Intersector> fill_by_ray(std::span<Intersector> forms) {
    std::size_t i = 0;
    Forms::for_each([&]<class Form>() {
        Intersector& form = forms[i++];
        set_recorders(form, &evaluate_recorded<Form>);

        // Replaces a form by its recording if that does the same operations; compiles others for each arithmetic.
        if constexpr (is_one_program<Form>) {
            set_recorded_arithmetics(form);
            if (Form::info.formats != Formats::all) form.rounded = nullptr;
        } else {
            if constexpr (Form::info.formats == Formats::all) form.rounded = intersect_rounded_batch<Form>;
            form.ball = enclose_hit<Form, Ball>;
            form.interval = enclose_hit<Form, Interval>;
        }

        // Counts in the form itself: `a || b` on one ray does not evaluate b if a is true.
        form.count = count_form_operations<Form>;
        if constexpr (filters<Form>) form.deciding_arithmetic = deciding_arithmetic_of<Form>;
        if constexpr (marches<Form>) form.log = log_form_march<Form>;
    });
    return forms.subspan(i);
}

}  // namespace lostbits::intersect::table
