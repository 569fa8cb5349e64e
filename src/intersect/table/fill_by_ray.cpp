#include <deque>

#include "intersect/table/arithmetics.hpp"
#include "intersect/table/fill_forms.hpp"
#include "intersect/table/recording.hpp"
#include "intersect/table/written_formula.hpp"
#include "shapes/number_names.hpp"

namespace lostbits::intersect::table {

namespace {

const EvaluateRecorded& evaluator_of(void* context) { return *static_cast<const EvaluateRecorded*>(context); }

void record_with(void* context, const Format& format, const Ray<double>& ray, const Target<double>& target, double tmax,
                 Tape& tape) {
    record_evaluation(evaluator_of(context), format, ray, target, tmax, tape);
}

void record_all_with(void* context, const Target<double>& target, Tape& tape) {
    record_all_operations(evaluator_of(context), target, tape);
}

std::optional<BoundedAnswer> bounded_with(void* context, const Format& format, const Ray<double>& ray,
                                          const Target<double>& target, double tmax) {
    return evaluate_with_bounds([&] { return record_hit(evaluator_of(context), ray, target, tmax); }, format);
}

}  // namespace

void fill_by_ray(std::span<Intersector> forms) {
    static std::deque<WrittenForm> written_forms;  // forms point to its elements
    std::size_t i = 0;
    for_each_form([&]<class Form>() {
        Intersector& form = forms[i++];
        const EvaluateRecorded* const evaluator = &evaluate_recorded<Form>;
        form.record = {record_with, const_cast<EvaluateRecorded*>(evaluator)};
        form.record_all = {record_all_with, const_cast<EvaluateRecorded*>(evaluator)};
        form.bounded = {bounded_with, const_cast<EvaluateRecorded*>(evaluator)};

        // Replaces a form by its recording if that does the same operations; compiles others for each arithmetic.
        if constexpr (is_one_program<Form>) {
            written_forms.emplace_back(form).fill_arithmetics(form);
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
}

std::vector<std::string> input_names(const Intersector& form, const Target<double>& target) {
    std::vector<std::string> names{"o.x", "o.y", "o.z", "d.x", "d.y", "d.z"};
    for (std::size_t s = 0; s < target.primitives.size(); ++s) {
        std::string prefix;
        if (target.primitives.size() > 1) prefix.append("s").append(std::to_string(s)).append(".");
        for (const std::string& number : number_names(target.primitives[s].shape)) {
            std::string name(number);
            if (name.size() > 2 && name[name.size() - 2] == '_') name[name.size() - 2] = '.';
            names.push_back(prefix);
            names.back().append(name);
        }
        for (std::size_t k = 0; target.primitives[s].transform && k < Affine<double>::numbers; ++k)
            names.push_back(prefix + "M" + std::to_string(k / 4) + std::to_string(k % 4));
    }
    if (!is_primitive(form.shape)) names.insert(names.end(), march_number_names.begin(), march_number_names.end());
    names.emplace_back("ray.tmax");
    return names;
}

}  // namespace lostbits::intersect::table
