// Common parts of the probes of a contract. An external form is called directly, before the table enforces its
// contract. Each probe has a name, which verdicts, crashes and the docs use.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "intersect/external/contract.hpp"
#include "intersect/external/foreign_batch.hpp"
#include "intersect/external/guard.hpp"
#include "measure/contract/probe.hpp"
#include "measure/truth/truth.hpp"
#include "number/error.hpp"

namespace lostbits::measure::contract {

/// One ray and one primitive, in numbers of the format of the form.
struct Question {
    Ray<double> ray;
    std::array<double, max_number_count> primitive;  ///< as in `Primitive::numbers`
    double end = std::numeric_limits<double>::infinity();
    double start = 0;
};

/// Answer of a form to one question. `near` and `far` are 0 if the form does not answer them.
struct Reply {
    std::uint8_t hit = 0;
    double near = 0, far = 0;
    friend bool operator==(const Reply&, const Reply&) = default;
};

/// Mirrors the question in z if the form only sees fronts, so that the ray meets the front. A flat primitive around a
/// point shows its back to rays that go up.
inline Question mirror_for_facing(Question q, const intersect::external::Contract& contract) {
    if (contract.facing != intersect::Facing::front) return q;
    q.ray.origin.z = -q.ray.origin.z;
    q.ray.direction.z = -q.ray.direction.z;
    std::size_t first = 0;
    for (const Key& key : row_of(contract.shape).keys) {
        if (key.kind == Key::Kind::point) q.primitive[first + 2] = -q.primitive[first + 2];
        first += key.count();
    }
    return q;
}

/// Primitives of the rays of a batch: each ray has its own, or all have that of the first question.
enum class BatchPrimitives : std::uint8_t { one_for_each_ray, first_for_all };

/// Answers of a form to the questions in one batch, in numbers of type S.
template <class S>
std::vector<Reply> ask_in(const intersect::external::ForeignForm& form, std::span<const Question> questions,
                          BatchPrimitives batch_primitives) {
    const std::size_t count = questions.size(), number_count = row_of(form.contract.shape).number_count;
    const bool has_ranges = (form.contract.flags & LB_RANGE) != 0;

    // Lays out the inputs as the form reads them.
    std::vector<S> rays, starts, ends, primitives;
    for (const Question& question : questions) {
        const Question q = mirror_for_facing(question, form.contract);
        for (const Vec<double>& v : {q.ray.origin, q.ray.direction})
            for (int k = 0; k < 3; ++k) rays.push_back(static_cast<S>(v[k]));
        starts.push_back(static_cast<S>(q.start));
        ends.push_back(static_cast<S>(q.end));
        for (std::size_t k = 0; k < number_count; ++k) primitives.push_back(static_cast<S>(q.primitive[k]));
    }

    // Marks the outputs, so that a number that the form does not write is noticed.
    std::vector<S> near_far(2 * count);
    std::vector<std::uint8_t> hit(count);
    intersect::external::mark_unwritten<S>(near_far, hit);
    form.answer({.size = count,
                 .rays = rays.data(),
                 .ends = ends.data(),
                 .primitives = primitives.data(),
                 .primitive_stride = batch_primitives == BatchPrimitives::first_for_all ? 0 : number_count,
                 .near_far = near_far.data(),
                 .hit = hit.data(),
                 .own = nullptr,
                 .starts = has_ranges ? starts.data() : nullptr});

    // Only the roots that the contract names are read.
    std::vector<Reply> replies;
    for (std::size_t i = 0; i < count; ++i) {
        const bool has_t = hit[i] == 1 && form.contract.roots != intersect::Roots::none;
        const bool has_both_roots = has_t && form.contract.roots == intersect::Roots::both;
        replies.push_back({hit[i], has_t ? static_cast<double>(near_far[2 * i]) : 0,
                           has_both_roots ? static_cast<double>(near_far[2 * i + 1]) : 0});
    }
    return replies;
}

inline std::vector<Reply> ask(const intersect::external::ForeignForm& form, std::span<const Question> questions,
                              BatchPrimitives batch_primitives = BatchPrimitives::one_for_each_ray) {
    return form.contract.bits == 32 ? ask_in<float>(form, questions, batch_primitives)
                                    : ask_in<double>(form, questions, batch_primitives);
}

inline Reply ask(const intersect::external::ForeignForm& form, const Question& question) {
    return ask(form, std::span(&question, 1)).front();
}

/// Primitive of a question.
inline Primitive<double> primitive_of(const Question& question, Shape shape) {
    Primitive<double> primitive(shape);
    std::copy_n(question.primitive.begin(), primitive.shape_numbers().size(), primitive.numbers.begin());
    return primitive;
}

/// A hit with its t, or a miss: the truth, or an answer as the table of forms reads it.
struct HitOrMiss {
    bool hit = false;
    double t = 0;
};

/// Truth of a question by a contract. Directions have unit length if the contract says so.
inline HitOrMiss truth_by(const intersect::external::Contract& contract, const Question& question) {
    const truth::Truth ray_truth = truth::find_truth(question.ray, primitive_of(question, contract.shape), {},
                                                     intersect::external::make_info(contract).convention(),
                                                     {.tmin = question.start, .tmax = question.end});
    if (!ray_truth.is_hit()) return {};
    const truth::CertifiedNumber& t =
        contract.direction == intersect::Direction::unit ? ray_truth.distance : ray_truth.t;
    return {true, std::ldexp(t.hi, static_cast<int>(t.exponent))};
}

/// Reads a reply by a contract, as the table of forms does.
inline HitOrMiss read_reply(const intersect::external::Contract& contract, const Reply& reply,
                            const Question& question) {
    const std::array<double, 2> near_far{reply.near, reply.far};
    const double end = takes_tmax(contract.shape) ? question.end : std::numeric_limits<double>::infinity();
    const Hit<double> hit = intersect::external::apply_contract(contract, reply.hit == 1 ? 1 : 0, near_far.data(), end);
    return {hit.hit, hit.t};
}

/// True if the properties of a contract do not contradict each other.
inline bool is_consistent(const intersect::external::Contract& contract) {
    try {
        intersect::external::require_valid(contract, "");
        return true;
    } catch (const InputError&) {
        return false;
    }
}

/// True if x is `right` to 2^-10 of itself or of 1, whichever is larger.
inline bool is_answer(double x, double right) {
    return x == right || (std::isfinite(right) && std::fabs(x - right) <= 0x1p-10 * std::max(1.0, std::fabs(right)));
}

inline std::string text_of(double x) {
    if (std::isnan(x)) return "NaN";
    std::array<char, 32> text{};
    return {text.data(), static_cast<std::size_t>(std::snprintf(text.data(), text.size(), "%.7g", x))};
}

/// A primitive of half-width `half` around (0, 0, z), and a ray along the z axis. A ray from (0, 0, -5) enters at 3 and
/// leaves at 7 if the half-width is 2 and z is 0.
inline Question question_along_z(Shape shape, double start_z, double direction, double z = 0, double half = 2) {
    Question q{.ray = {{0, 0, start_z}, {0, 0, direction}}, .primitive = {}};
    std::ranges::copy(primitive_around<double>(shape, {0, 0, z}, half).shape_numbers(), q.primitive.begin());
    return q;
}

/// The t at which the line of a ray enters and leaves its primitive; empty if the line misses the primitive.
inline std::optional<Ends<double>> ends_of(const Question& question, Shape shape) {
    const auto ends = with_span(question.ray, primitive_of(question, shape),
                                [](const auto& span) { return lostbits::ends_of(span); });
    return ends && ends->near <= ends->far ? ends : std::nullopt;
}

/// True for shapes that a line enters and leaves. They include the tube, although it has no inside, and exclude flat
/// shapes and shapes without end, such as a half space.
inline bool is_crossed_twice(Shape shape) {
    const auto ends = ends_of(question_along_z(shape, 1, 1), shape);
    return ends && std::isfinite(ends->near) && std::isfinite(ends->far) && ends->near < ends->far;
}

/// Sign of the z direction in which a ray from afar enters a shape around the origin: 1, unless (0, 0, -5) lies in the
/// shape, which happens only if the shape has no end.
inline double entry_sign(Shape shape) {
    const auto ends = ends_of(question_along_z(shape, -5, 1), shape);
    return ends && ends->near < 0 && ends->far >= 0 ? -1 : 1;
}

/// The plainest ray at a shape: it starts outside, `distance` from the origin, and enters along the z axis.
inline Question plainest_question(Shape shape, double distance = 5, double direction = 1, double half = 2) {
    const double sign = entry_sign(shape);
    return question_along_z(shape, -sign * distance, sign * direction, 0, half);
}

/// Probes of one form, with their findings.
class Trial {
public:
    explicit Trial(const intersect::external::ForeignForm& tested_form)
        : form(tested_form),
          contract(form.contract),
          shape(contract.shape),
          reports_t(contract.roots != intersect::Roots::none) {}

    /// Runs one probe. The findings and errors of the probe carry its name.
    template <class Probe>
    void probe(const char* name, const Probe& run) {
        name_ = name;
        const intersect::external::ProbeScope scope(name);
        try {
            run(*this);
        } catch (const EnvironmentError& error) {
            throw EnvironmentError(std::string(error.what()) + " (in the probe \"" + name + "\")");
        }
    }

    void report_kept(std::string text) { add(Observation::Verdict::kept, std::move(text)); }
    void report_broken(std::string text) { add(Observation::Verdict::broken, std::move(text)); }
    void report_warning(std::string text) { add(Observation::Verdict::warned, std::move(text)); }
    void report_note(std::string text) { add(Observation::Verdict::noted, std::move(text)); }
    void check(bool is_kept, const std::string& kept_text, const std::string& broken_text) {
        add(is_kept ? Observation::Verdict::kept : Observation::Verdict::broken, is_kept ? kept_text : broken_text);
    }
    [[nodiscard]] Reply ask(const Question& question) const { return contract::ask(form, question); }
    [[nodiscard]] bool has_flag(unsigned flag) const { return (contract.flags & flag) != 0; }
    [[nodiscard]] bool has_broken_property() const {
        return std::ranges::any_of(findings, [](const Observation& observation) {
            return observation.verdict == Observation::Verdict::broken;
        });
    }
    /// True if a probe of this name found a broken property.
    [[nodiscard]] bool has_broken(std::string_view name) const {
        return std::ranges::any_of(findings, [name](const Observation& observation) {
            return observation.subject == name && observation.verdict == Observation::Verdict::broken;
        });
    }
    /// Truth by the trial's contract, or by another contract for the same question.
    [[nodiscard]] HitOrMiss truth(const Question& question) const { return truth(question, contract); }
    [[nodiscard]] HitOrMiss truth(const Question& question, const intersect::external::Contract& other_contract) const {
        return truth_by(other_contract, mirror_for_facing(question, contract));
    }
    /// True if a reply is the true answer by a contract.
    [[nodiscard]] bool is_right(const Question& question, const Reply& reply,
                                const intersect::external::Contract& other_contract) const {
        const HitOrMiss right = truth(question, other_contract), answer = read_reply(other_contract, reply, question);
        return right.hit == answer.hit && (!right.hit || !reports_t || is_answer(answer.t, right.t));
    }

    const intersect::external::ForeignForm& form;
    const intersect::external::Contract& contract;
    Shape shape;
    bool reports_t;
    std::vector<Observation> findings;

private:
    void add(Observation::Verdict verdict, std::string text) { findings.push_back({name_, verdict, std::move(text)}); }
    const char* name_ = "";
};

/// Probes how the form is called (probe_calls.cpp).
void probe_calls(Trial& trial);
/// Probes of one property each (probe_surface.cpp).
void try_inside(Trial& trial);
void try_facing(Trial& trial);
/// For a form that misses the plainest ray: true if the form hits the primitive from the other side. Then reports which
/// side the form hits.
bool try_other_side(Trial& trial);
void try_touching(Trial& trial);
/// Probes with rays in the plane of a flat primitive, which they do not cross.
void try_in_plane(Trial& trial);
void try_at_origin(Trial& trial);
/// Probes with a surface just ahead of the origin.
void try_just_ahead(Trial& trial);

/// Probes that compare with the truth on many rays (probe_truth.cpp).
void try_scale(Trial& trial);
void try_rays(Trial& trial);
/// Probes with rays at places where parts of a surface meet (probe_edges.cpp).
void try_edges(Trial& trial);

}  // namespace lostbits::measure::contract
