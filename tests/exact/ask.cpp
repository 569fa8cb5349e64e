#include "exact/ask.hpp"

#include <lostbits.h>

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "measure/truth/truth_columns.hpp"
#include "shapes/given_matrix.hpp"

namespace lostbits::exact {
namespace {

namespace truth = measure::truth;

/// A problem in the types of lostbits.
struct GivenProblem {
    Ray<double> ray;
    Primitive<double> primitive;
    Range<double> range;

    GivenProblem(Shape shape, const Problem& problem)
        : ray{{problem.ray[0], problem.ray[1], problem.ray[2]}, {problem.ray[3], problem.ray[4], problem.ray[5]}},
          primitive(shape),
          range{problem.tmin, problem.tmax, {problem.open_tmin, problem.open_tmax}} {
        for (std::size_t k = 0; k < primitive.shape_numbers().size(); ++k) primitive.numbers[k] = problem.primitive[k];
        if (problem.has_transform) primitive.transform = transform_of(problem.matrix, problem.is_inverse);
    }
};

double rounded(const truth::Truth& found, const GivenProblem& given, const FloatFormat& format) {
    return truth::round_truth(found, given.ray, given.primitive, format, truth::Length::parameter, {}, given.range);
}

/// Answer from a truth. A t that is known only to 2^-33 is not yet a double; rounding it would find it again for each
/// ray.
Answer answer_of(const truth::Truth& found, const GivenProblem& given,
                 truth::Tightness tightness = truth::Tightness::certified) {
    if (found.decision == truth::Truth::Decision::unresolved) throw std::runtime_error("a ray is unresolved");
    if (!found.is_hit()) return {};
    const truth::CertifiedNumber& t = found.t;
    const bool is_double = tightness == truth::Tightness::certified;
    return {true,
            t.hi,
            t.lo,
            t.bound,
            t.exponent,
            rounded(found, given, binary32),
            is_double ? rounded(found, given, binary64) : NAN};
}

/// One column for each number, as the shape of S has them.
template <class S>
struct Columns {
    std::array<std::vector<S>, 6> ray;
    std::array<std::vector<S>, max_primitive_number_count> primitive;
    std::vector<S> tmin, tmax;
    truth::ProblemColumns<S> columns;

    Columns(Shape shape, std::span<const Problem> problems) {
        columns.size = problems.size();
        columns.shape = shape;
        columns.open_ends = {problems.front().open_tmin, problems.front().open_tmax};
        const auto put = [&](std::vector<S>& to, const auto& number) {
            to.reserve(problems.size());
            for (const Problem& problem : problems) to.push_back(static_cast<S>(number(problem)));
            return std::span<const S>(to);
        };
        for (std::size_t k = 0; k < 6; ++k)
            columns.ray[k] = put(ray[k], [k](const Problem& problem) { return problem.ray[k]; });
        for (std::size_t k = 0; k < row_of(shape).number_count; ++k)
            columns.primitive[k] = put(primitive[k], [k](const Problem& problem) { return problem.primitive[k]; });
        columns.tmin = put(tmin, [](const Problem& problem) { return problem.tmin; });
        columns.tmax = put(tmax, [](const Problem& problem) { return problem.tmax; });
        const Problem& first = problems.front();
        if (!first.has_transform) return;
        columns.matrix = {true, first.is_inverse, transform_of(first.matrix).orientation};
        for (std::size_t k = 0; k < first.matrix.size(); ++k)
            columns.primitive[max_number_count + k] =
                put(primitive[max_number_count + k], [k](const Problem& problem) { return problem.matrix[k]; });
    }
};

template <class S>
void decide_columns(Shape shape, const truth::TruthOptions& options, std::span<const Problem> problems,
                    std::vector<std::uint8_t>& hits) {
    const Columns<S> given(shape, problems);
    thread_local truth::TruthColumns found;
    truth::find_truth_columns(given.columns, options, found);
    hits.clear();
    for (const truth::Truth::Decision decision : found.decision) {
        if (decision == truth::Truth::Decision::unresolved) throw std::runtime_error("a ray is unresolved");
        hits.push_back(decision == truth::Truth::Decision::hit);
    }
}

template <class S>
void ask_columns(Shape shape, truth::Tightness tightness, std::span<const Problem> problems,
                 std::vector<Answer>& answers) {
    const Columns<S> given(shape, problems);
    truth::TruthColumns found;
    truth::find_truth_columns(given.columns, {.convention = {}, .tightness = tightness, .limit = {}}, found);
    auto alone = found.single_truths.begin();
    for (std::size_t i = 0; i < problems.size(); ++i) {
        const GivenProblem one(shape, problems[i]);
        if (alone != found.single_truths.end() && alone->first == i) {
            answers[i] = answer_of((alone++)->second, one, tightness);
            continue;
        }
        truth::Truth t;
        t.decision = found.decision[i];
        if (t.is_hit()) t.t = truth::make_certified(found.hi[i], found.lo[i], found.bound[i]);
        answers[i] = answer_of(t, one, tightness);
    }
}

/// The interface does not return rounded numbers.
void ask_interface(std::string_view shape, std::span<const Problem> problems, std::vector<Answer>& answers) {
    const auto column = [&problems](const double* first, std::size_t items) {
        return lostbits_array{.data = first,
                              .step = sizeof(Problem),
                              .item_step = items == 1 ? 0 : std::ptrdiff_t{sizeof(double)},
                              .bits = 64};
    };
    const std::string name(shape);
    const Problem& p = problems.front();
    lostbits_rays rays{};
    rays.count = rays.primitive_count = problems.size();
    rays.origin = column(p.ray.data(), 3);
    rays.direction = column(p.ray.data() + 3, 3);
    rays.tmin = column(&p.tmin, 1);
    rays.tmax = column(&p.tmax, 1);
    rays.open_ends = p.open_tmin ? (p.open_tmax ? "both" : "tmin") : p.open_tmax ? "tmax" : "none";
    rays.shape = name.c_str();
    rays.primitives = column(p.primitive.data(), max_primitive_numbers);
    rays.paired = 1;
    if (p.has_transform) rays.matrix = column(p.matrix.data(), p.matrix.size());
    rays.format = "f64";
    lostbits_run run{};
    run.threads = 1;
    lostbits_error error{};
    lostbits_result* result = nullptr;
    if (lostbits_truth(&rays, &run, &result, &error) != LOSTBITS_OK) throw std::runtime_error(error.text);
    std::array<lostbits_column, 4> columns{};
    for (std::size_t k = 0; k < columns.size(); ++k) lostbits_result_column(result, 0, k, &columns[k]);
    for (std::size_t i = 0; i < problems.size(); ++i) {
        answers[i] = {.hit = columns[0].numbers[i] == 1, .as_float = NAN, .as_double = NAN};
        if (!answers[i].hit) continue;
        answers[i].high = columns[2].numbers[i], answers[i].low = columns[3].numbers[i];
        answers[i].bound = 0x1p-72 * std::fabs(answers[i].high);
    }
    lostbits_result_free(result);
}

}  // namespace

double tightness_of(TruthRoute route) { return route == TruthRoute::floats_for_ulps ? 0x1p-33 : 0x1p-72; }

void ask(std::string_view shape, TruthRoute route, std::span<const Problem> problems, std::vector<Answer>& answers) {
    const Shape named = shape_named(shape).value();
    answers.assign(problems.size(), {});
    switch (route) {
        case TruthRoute::floats_for_ulps:
            return ask_columns<float>(named, truth::Tightness::ulps_of_binary32, problems, answers);
        case TruthRoute::floats: return ask_columns<float>(named, truth::Tightness::certified, problems, answers);
        case TruthRoute::doubles: return ask_columns<double>(named, truth::Tightness::certified, problems, answers);
        case TruthRoute::one_by_one:
            for (std::size_t i = 0; i < problems.size(); ++i) {
                const GivenProblem one(named, problems[i]);
                answers[i] = answer_of(truth::find_truth(one.ray, one.primitive, {}, {}, one.range), one);
            }
            return;
        case TruthRoute::interface: return ask_interface(shape, problems, answers);
    }
}

void decide(std::string_view shape, TruthRoute route, bool with_rim, std::span<const Problem> problems,
            std::vector<std::uint8_t>& hits) {
    const Shape named = shape_named(shape).value();
    const truth::TruthOptions options{.convention = with_rim ? intersect::Touching::hit : intersect::Touching::miss,
                                      .tightness = route == TruthRoute::floats_for_ulps
                                                       ? truth::Tightness::ulps_of_binary32
                                                       : truth::Tightness::certified,
                                      .limit = {}};
    route == TruthRoute::doubles ? decide_columns<double>(named, options, problems, hits)
                                 : decide_columns<float>(named, options, problems, hits);
}

std::vector<std::pair<std::string_view, std::size_t>> all_shapes() {
    std::vector<std::pair<std::string_view, std::size_t>> all;
    for (const ShapeRow& row : shape_rows) all.emplace_back(row.name, row.number_count);
    return all;
}

}  // namespace lostbits::exact
