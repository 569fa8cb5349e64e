// Compares the answers of a form with the truth by its contract: over all sizes, and for many rays at many primitives.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "measure/contract/random_questions.hpp"

namespace lostbits::measure::contract {
namespace {

using intersect::Direction;

/// Power of two up to which sizes are tested. Usual code multiplies four lengths for round shapes, flat shapes and
/// boxes, and up to ten for others. Beyond this power numbers under- or overflow, which is not the fault of an epsilon.
/// The roots of a primitive that a line enters twice are found with steps and tolerances, which are not epsilons
/// either.
int greatest_power(const intersect::external::Contract& contract) {
    const ShapeRow& shape_row = row_of(contract.shape);
    const auto ends = ends_of(plainest_question(contract.shape), contract.shape);
    if (has_inside(contract.shape) && ends && ends->far < 7) return 12;
    return (contract.bits == 32 ? 112 : 960) / (shape_row.is_ball || shape_row.is_flat || shape_row.has_edges ? 4 : 10);
}

/// Simple rays at a primitive of half-width 2·size: through its centre, off its centre, from inside, and past it.
std::vector<Question> make_questions_of_size(Shape shape, double size) {
    std::vector<Question> questions{
        question_along_z(shape, -5 * size, 1, 0, 2 * size), question_along_z(shape, -8 * size, 1, 0, 2 * size),
        question_along_z(shape, size, 1, 0, 2 * size), question_along_z(shape, -5 * size, 1, 0, 2 * size)};
    questions[1].ray.origin.x = size / 2;
    questions[1].ray.origin.y = size / 4;
    questions[3].ray.origin.x = 16 * size;
    if (!has_inside(shape)) questions.erase(questions.begin() + 2);
    return questions;
}

/// A method of aiming rays, with its text in reports.
struct Aim {
    const char* text;
    Question (*make)(const Primitive<double>& primitive, RandomNumbers& random);
};

Vec<double> point_of(const Primitive<double>& primitive, RandomNumbers& random) {
    const Vec<double> u{random.between(0, 1), random.between(0, 1), random.between(0, 1)};
    return visit(primitive, [&u](const auto& shape) { return shape.point_at(u); });
}
Vec<double> middle_of(const Primitive<double>& primitive) {
    return visit(primitive, [](const auto& shape) { return shape.middle(); });
}

constexpr Aim aims[]{
    {"at it",
     [](const Primitive<double>& primitive, RandomNumbers& random) {
         const Vec<double> d = random.unit();
         return make_question(point_of(primitive, random) - 4 * half_extent_of(primitive) * d, d, primitive);
     }},
    {"at its middle",
     [](const Primitive<double>& primitive, RandomNumbers& random) {
         const Vec<double> d = random.unit(), aside = 0.125 * half_extent_of(primitive) * random.vector();
         return make_question(middle_of(primitive) + aside - 4 * half_extent_of(primitive) * d, d, primitive);
     }},
    {"from around its middle",
     [](const Primitive<double>& primitive, RandomNumbers& random) {
         const Vec<double> middle = middle_of(primitive), point = point_of(primitive, random);
         const double fraction = random.between(0, 1);
         return make_question(middle + fraction * (point - middle), random.unit(), primitive);
     }},
    {"past it",
     [](const Primitive<double>& primitive, RandomNumbers& random) {
         const Vec<double> middle = middle_of(primitive), d = random.unit(), point = point_of(primitive, random);
         const Vec<double> target = middle + random.between(1, 2.5) * (point - middle);
         return make_question(target - 4 * half_extent_of(primitive) * d, d, primitive);
     }},
    {"away from it",
     [](const Primitive<double>& primitive, RandomNumbers& random) {
         const Vec<double> d = random.unit();
         return make_question(point_of(primitive, random) + 4 * half_extent_of(primitive) * d, d, primitive);
     }},
    {"along an axis",
     [](const Primitive<double>& primitive, RandomNumbers& random) {
         const double half_extent = half_extent_of(primitive);
         Vec<double> d{0, 0, 0}, origin = middle_of(primitive) + 1.5 * half_extent * random.vector();
         const int axis = static_cast<int>(random.between(0, 2.999));
         d[axis] = random() < 0 ? -1 : 1;
         origin[axis] -= 4 * half_extent * d[axis];
         return make_question(origin, d, primitive);
     }},
};

/// Rays of one method of aiming, at primitives as in scenes, and at the primitive around the origin with half-width 2.
std::vector<Question> make_aimed_questions(const Trial& trial, const Aim& aim, bool is_upright) {
    RandomNumbers random;
    std::vector<Question> questions;
    for (int i = 0; i < 320 && questions.size() < 96; ++i) {
        const Primitive<double> primitive = i % 4 == 0 ? primitive_around<double>(trial.shape, {0, 0, 0}, 2)
                                                       : draw_primitive(trial.shape, is_upright, random);
        Question q = aim.make(primitive, random);
        if (trial.contract.direction == Direction::any && i % 2 == 1)
            for (int k = 0; k < 3; ++k) q.ray.direction[k] = static_cast<float>(1.5 * q.ray.direction[k]);
        if (is_benign(trial, q, random)) questions.push_back(q);
    }
    return questions;
}

/// Text that names an optional length, such as an inner radius, if all answers are right for primitives without it.
std::string ignored_length_text(const Trial& trial, const std::vector<Question>& questions) {
    std::string text;
    for_each_key(trial.shape, [&](const Key& key, std::size_t k) {
        if (!key.is_optional || !text.empty()) return;
        std::vector<AnsweredQuestion> without_length = add_truths(trial, questions);
        for (AnsweredQuestion& answered : without_length) {
            Question q = answered.question;
            q.primitive[k] = 0;
            answered.right = trial.truth(q);
        }
        if (WrongCount(trial, without_length).wrong_count == 0)
            text = fmt::format("; it seems to ignore the {}", key.name);
    });
    return text;
}

std::string wrong_count_text(const WrongCount& count, const Aim& aim) {
    return std::to_string(count.wrong_count) + " of " + std::to_string(count.tested_count) + " rays " + aim.text +
           " are answered wrongly, none of them near an edge; the first: " + count.first_text;
}

}  // namespace

bool has_axis(Shape shape) {
    return std::ranges::any_of(row_of(shape).keys, [](const Key& key) {
        return key.kind == Key::Kind::direction || key.limit == Key::Limit::differs_from_previous;
    });
}

Primitive<double> draw_primitive(Shape shape, bool is_upright, RandomNumbers& random) {
    for (;;) {
        const double half_width = random.between(0.5, 2), stretch = random.between(0.5, 1.5);
        const Vec<double> centre = 4.0 * random.vector();
        const int first_axis = static_cast<int>(random.between(0, 2.999));
        const auto rotate_axes = [&first_axis](const Vec<double>& v) {
            return Vec<double>(v[first_axis], v[(first_axis + 1) % 3], v[(first_axis + 2) % 3]);
        };

        Primitive<double> primitive = primitive_around<double>(shape, {0, 0, 0}, half_width);
        for_each_key(shape, [&](const Key& key, std::size_t k) {
            const bool is_length = key.is_length(), is_point = key.kind == Key::Kind::point;
            const Vec<double> point = is_length ? Vec<double>(0, 0, 0) : primitive.point(k);

            // Points and directions: along the axes, or at random.
            if (!is_length && is_upright)
                primitive.set_point(k, stretch * rotate_axes(point) + (is_point ? centre : Vec<double>(0, 0, 0)));
            else if (is_point) primitive.set_point(k, point + centre + (0.5 * half_width) * random.vector());
            else if (!is_length) primitive.set_point(k, 2.0 * random.vector());

            // Lengths, and every number as a float.
            for (const std::size_t end = k + key.count(); k < end; ++k) {
                double& x = primitive.numbers[k];
                if (key.is_optional) x = std::max(0.0, random()) * primitive.numbers[k - 1];
                else if (is_length) x *= random.between(0.5, 1.25);
                x = static_cast<float>(x);
            }
        });

        if (!broken_limit(primitive)) return primitive;
    }
}

Question make_question(const Vec<double>& origin, const Vec<double>& direction, const Primitive<double>& primitive) {
    Question q{.ray = {}, .primitive = {}};
    for (int k = 0; k < 3; ++k) {
        q.ray.origin[k] = static_cast<float>(origin[k]);
        q.ray.direction[k] = static_cast<float>(direction[k]);
    }
    std::ranges::copy(primitive.shape_numbers(), q.primitive.begin());
    return q;
}

double half_extent_of(const Primitive<double>& primitive) {
    return std::min(visit(primitive, [](const auto& shape) { return shape.half_extent(); }), 4.0);
}

bool is_benign(const Trial& trial, const Question& question, RandomNumbers& random, int change_count) {
    const HitOrMiss right = trial.truth(question);
    const Vec<double>& d = question.ray.direction;
    const double size = half_extent_of(primitive_of(question, trial.shape)), length = std::hypot(d.x, d.y, d.z);
    if (right.hit && right.t != 0 && right.t * length < size / 16) return false;
    for (int i = 0; i < change_count; ++i) {
        Question changed = question;
        for (int k = 0; k < 3; ++k) changed.ray.origin[k] += 0x1p-5 * size * random();
        for (int k = 0; k < 3; ++k) changed.ray.direction[k] += 0x1p-6 * length * random();
        const HitOrMiss changed_truth = trial.truth(changed);
        if (changed_truth.hit != right.hit || std::fabs(changed_truth.t - right.t) * length > size / 4) return false;
    }
    return true;
}

std::string numbers_text(std::span<const double> numbers) {
    std::string text;
    for (const double x : numbers) {
        const bool is_float = static_cast<double>(static_cast<float>(x)) == x;
        text += (text.empty() ? "" : ",") + (is_float ? fmt::format("{:.9g}", x) : fmt::format("{}", x));
    }
    return text;
}

std::string numbers_text(const Ray<double>& ray) {
    const auto& [o, d] = ray;
    return numbers_text(std::array{o.x, o.y, o.z, d.x, d.y, d.z});
}

std::string answer_text(const Trial& trial, const HitOrMiss& answer) {
    return !answer.hit ? "a miss" : trial.reports_t ? "t = " + text_of(answer.t) : "a hit";
}

Question scale_question(const Question& question, Shape shape, int power) {
    Question result = question;
    for (int k = 0; k < 3; ++k) result.ray.origin[k] = std::ldexp(question.ray.origin[k], power);
    std::ranges::copy(scaled(primitive_of(question, shape), std::ldexp(1.0, power)).shape_numbers(),
                      result.primitive.begin());
    return result;
}

std::vector<AnsweredQuestion> add_truths(const Trial& trial, const std::vector<Question>& questions) {
    std::vector<AnsweredQuestion> rays;
    for (const Question& question : questions) rays.push_back({question, trial.truth(question)});
    return rays;
}

namespace {

/// Text about a wrong answer to a question whose lengths were multiplied by 2^power. The right answer and that of the
/// form are those at 2^0.
std::string wrong_answer_text(const Trial& trial, const Question& question, const HitOrMiss& right,
                              const HitOrMiss& answer, int power) {
    const Question q = mirror_for_facing(question, trial.contract);
    const auto scaled_answer_text = [&](const HitOrMiss& unscaled) {
        return answer_text(trial, {unscaled.hit, std::ldexp(unscaled.t, power)});
    };
    return "ray " + numbers_text(q.ray) + " at " + std::string(row_of(trial.shape).name) + " " +
           numbers_text(std::span(q.primitive).first(row_of(trial.shape).number_count)) + ": " +
           scaled_answer_text(right) + " is right, it answers " + scaled_answer_text(answer);
}

}  // namespace

WrongCount::WrongCount(const Trial& trial, const std::vector<AnsweredQuestion>& rays, int power)
    : tested_count(rays.size()) {
    std::vector<Question> questions;
    for (const AnsweredQuestion& answered : rays)
        questions.push_back(scale_question(answered.question, trial.shape, power));
    const std::vector<Reply> replies = ask(trial.form, questions);

    // Compares at 2^0, where the tolerance is a fraction of the size of the primitive.
    for (std::size_t i = 0; i < tested_count; ++i) {
        const auto& [plain, right] = rays[i];
        HitOrMiss answer = read_reply(trial.contract, replies[i], questions[i]);
        answer.t = std::ldexp(answer.t, -power);
        const double tolerance =
            0x1p-5 * half_extent_of(primitive_of(plain, trial.shape)) / length(plain.ray.direction);
        if (right.hit == answer.hit && (!right.hit || !trial.reports_t || std::fabs(answer.t - right.t) <= tolerance))
            continue;
        if (wrong_count++ == 0) first_text = wrong_answer_text(trial, questions[i], right, answer, power);
    }
}

void try_scale(Trial& trial) {
    // Text about the answer to the ray i at a size, if the answer is wrong; empty otherwise.
    const auto answer_at = [&trial](std::size_t i, double size) -> std::string {
        const Question q = make_questions_of_size(trial.shape, size)[i];
        const HitOrMiss right = trial.truth(q), answer = read_reply(trial.contract, trial.ask(q), q);
        const bool is_right = right.hit == answer.hit &&
                              (!right.hit || !trial.reports_t || std::fabs(answer.t - right.t) <= 0x1p-8 * size);
        if (is_right) return "";
        return " times as large, it answers " + answer_text(trial, answer) + " where " + answer_text(trial, right) +
               " is right: it seems to ";
    };
    const int max_power = greatest_power(trial.contract);
    for (std::size_t i = 0; i < make_questions_of_size(trial.shape, 1).size(); ++i) {
        if (!answer_at(i, 1).empty()) continue;  // wrong at any size

        // Smaller sizes, then larger ones.
        for (int k = 1; k <= max_power; ++k) {
            if (const std::string text = answer_at(i, std::ldexp(1, -k)); !text.empty())
                return trial.report_broken("where all lengths are 2^-" + std::to_string(k) + text +
                                           "compare with a fixed number, an epsilon, that does not scale with its "
                                           "inputs; no property declares that");
        }
        for (int k = 1; k <= max_power; ++k) {
            if (const std::string text = answer_at(i, std::ldexp(1, k)); !text.empty())
                return trial.report_note("where all lengths are 2^" + std::to_string(k) + text +
                                         "have a greatest t or size");
        }
    }
    trial.report_kept("right where all lengths are 2^-" + std::to_string(max_power) + " to 2^" +
                      std::to_string(max_power) + " times as large");
}

void try_rays(Trial& trial) {
    const std::string plural(row_of(trial.shape).plural);
    std::size_t tested = 0;
    for (const bool is_upright : {true, false}) {
        if (is_upright && !has_axis(trial.shape)) continue;
        for (const Aim& aim : aims) {
            const std::vector<Question> questions = make_aimed_questions(trial, aim, is_upright);
            if (questions.size() < 24) continue;  // rays from within a flat shape
            const WrongCount count(trial, add_truths(trial, questions));
            tested += count.tested_count;
            if (count.wrong_count == 0) continue;

            // Few wrong answers, and wrong answers only where axes lie at an angle, break no property.
            const bool is_oblique = !is_upright && has_axis(trial.shape);
            const std::string text = wrong_count_text(count, aim) + ignored_length_text(trial, questions);
            if (count.is_many() && !is_oblique) return trial.report_broken(text);
            trial.report_note(text + (is_oblique ? "; where axes lie along x, y or z it is right" : ""));
            if (is_oblique) return;
        }
    }
    trial.report_kept(std::to_string(tested) + " rays at " + plural + " in random positions get the right answer");
}

}  // namespace lostbits::measure::contract
