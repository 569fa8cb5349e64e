#include "intersect/table/recording.hpp"
#include "intersect/table/rows.hpp"
#include "number/recorded.hpp"
#include "number/with_number.hpp"

namespace lostbits::intersect::table {
namespace {

/// Marks where the samples of a march end, and gives its operations the names that the lesson SDF Sphere Marching has
/// for them.
template <class T>
struct SampleMarks : sdf::Unwatched {
    void operator()(const RecordedMask& /*active*/, const T& t, const Vec<T>& p, const T& d) const {
        named("t", t);
        named("p.x", p.x);
        named("p.y", p.y);
        named("p.z", p.z);
        named("d", d);
        if (Tape* const tape = Tape::current()) tape->samples.push_back(tape->nodes.size());
    }
};

template <class Form, class F>
void evaluate_on(Tape& tape, const Ray<double>& ray, const Target<double>& target, double tmax) {
    using T = Recorded<F>;
    const auto input = [](double x) { return T(x); };
    const auto vec = [input](const Vec<double>& v) {
        const T x = input(v.x), y = input(v.y), z = input(v.z);
        return Vec<T>(x, y, z);
    };
    const Tape::Scope scope(tape);
    const Vec<T> origin = vec(ray.origin), direction = vec(ray.direction);
    const LiftedTarget<T> lifted(target, input);
    const T end = input(tmax);
    SampleMarks<T> marks;
    const Hit<T> hit = intersect_target<Form>(Ray<T>{origin, direction}, lifted.get(), end, marks);
    tape.outputs = {hit.hit.node(), hit.t.node(), hit.near.node(), hit.far.node()};
}

template <class Form>
void record_of(const Format& format, const Ray<double>& ray, const Target<double>& target, double tmax, Tape& tape) {
    tape.clear();
    with_number(format, [&]<class F>() { evaluate_on<Form, F>(tape, ray, target, tmax); });
}

/// Two samples of a march, and each refinement once or twice, are all that there is: what follows does the same again.
template <class Form>
void record_all_of(const Target<double>& target, Tape& tape) {
    const Ray<double> any{Vec<double>(1, 2, 3), Vec<double>(4, 5, 6)};
    tape.clear();
    tape.every_loop = true;
    if (target.march) {
        MarchConstants<double> few = *target.march;
        few.max_steps = 3;
        few.secant_steps = std::min(few.secant_steps, 2);
        few.bisect_steps = std::min(few.bisect_steps, 2);
        evaluate_on<Form, float>(tape, any, Target<double>(target.solids, few), HUGE_VAL);
    } else {
        evaluate_on<Form, float>(tape, any, target, HUGE_VAL);
    }
    tape.every_loop = false;
}

}  // namespace

void fill_recorded(std::span<Intersector> rows) {
    std::size_t i = 0;
    for_each_form([&]<class Form>() {
        rows[i].record = record_of<Form>;
        rows[i].record_all = record_all_of<Form>;
        ++i;
    });
}

std::vector<std::string> input_names(const Intersector& form, const Target<double>& target) {
    std::vector<std::string> names{"o.x", "o.y", "o.z", "d.x", "d.y", "d.z"};
    for (std::size_t s = 0; s < target.solids.size(); ++s) {
        std::string prefix;
        if (target.solids.size() > 1) prefix.append("s").append(std::to_string(s)).append(".");
        for (const auto number : number_names(target.solids[s].shape)) {
            std::string name(number);
            if (name.size() > 2 && name[name.size() - 2] == '_') name[name.size() - 2] = '.';
            names.push_back(prefix);
            names.back().append(name);
        }
    }
    if (form.shape == Shape::sdf) names.insert(names.end(), march_number_names.begin(), march_number_names.end());
    names.emplace_back("limit");
    return names;
}

}  // namespace lostbits::intersect::table
