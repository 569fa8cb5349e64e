#include "intersect/table/arithmetics.hpp"

#include <deque>

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

void set_recorders(Intersector& form, const EvaluateRecorded* evaluator) {
    auto* const context = const_cast<EvaluateRecorded*>(evaluator);
    form.record = {record_with, context};
    form.record_all = {record_all_with, context};
    form.bounded = {bounded_with, context};
}

void set_recorded_arithmetics(Intersector& form) {
    static std::deque<WrittenForm> written_forms;  // forms point to its elements
    written_forms.emplace_back(form).fill_arithmetics(form);
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
        for (std::size_t k = 0; target.primitives[s].transform && k < Affine<double>::number_count; ++k)
            names.push_back(prefix + "M" + std::to_string(k / 4) + std::to_string(k % 4));
    }
    if (!is_primitive(form.shape)) names.insert(names.end(), march_number_names.begin(), march_number_names.end());
    names.emplace_back("ray.tmax");
    return names;
}

}  // namespace lostbits::intersect::table
