#include <deque>

#include "intersect/table/arithmetics.hpp"
#include "intersect/table/recording.hpp"
#include "intersect/table/rows.hpp"
#include "intersect/table/written_formula.hpp"
#include "shapes/number_names.hpp"

namespace lostbits::intersect::table {

namespace {

const EvaluateRecorded& asked(void* own) { return *static_cast<const EvaluateRecorded*>(own); }

void record_asked(void* own, const Format& format, const Ray<double>& ray, const Target<double>& target, double tmax,
                  Tape& tape) {
    record_by(asked(own), format, ray, target, tmax, tape);
}

void record_all_asked(void* own, const Target<double>& target, Tape& tape) { record_all_by(asked(own), target, tape); }

std::optional<BoundedAnswer> bounded_asked(void* own, const Format& format, const Ray<double>& ray,
                                           const Target<double>& target, double tmax) {
    return bounded_by([&] { return recorded_hit(asked(own), ray, target, tmax); }, format);
}

}  // namespace

void fill_by_ray(std::span<Intersector> rows) {
    static std::deque<WrittenForm> recorded;  // rows point into it
    std::size_t i = 0;
    for_each_form([&]<class Form>() {
        Intersector& row = rows[i++];
        const EvaluateRecorded* const ask = &evaluate_recorded<Form>;
        row.record = {record_asked, const_cast<EvaluateRecorded*>(ask)};
        row.record_all = {record_all_asked, const_cast<EvaluateRecorded*>(ask)};
        row.bounded = {bounded_asked, const_cast<EvaluateRecorded*>(ask)};
        if constexpr (is_one_program<Form>) {
            recorded.emplace_back(row).fill_arithmetics(row);
            if (Form::info.formats != Formats::all) row.rounded = nullptr;
        } else {
            if constexpr (Form::info.formats == Formats::all) row.rounded = rounded_batch<Form>;
            row.ball = enclosed<Form, Ball>;
            row.interval = enclosed<Form, Interval>;
        }
        row.count = count_of<Form>;  // as it runs: `a || b` on one ray does not compare b where a is true
        if constexpr (filters<Form>) row.filter_arithmetic = filter_arithmetic_of<Form>;
        if constexpr (marches<Form>) row.log = log_of<Form>;
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
        for (std::size_t k = 0; target.primitives[s].placed && k < Affine<double>::numbers; ++k)
            names.push_back(prefix + "M" + std::to_string(k / 4) + std::to_string(k % 4));
    }
    if (!is_primitive(form.shape)) names.insert(names.end(), march_number_names.begin(), march_number_names.end());
    names.emplace_back("ray.tmax");
    return names;
}

}  // namespace lostbits::intersect::table
