// Random questions for the probes that compare a form with the truth: primitives as in scenes, and rays that every
// usual formula decides correctly.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "measure/contract/trial.hpp"

namespace lostbits::measure::contract {

/// Pseudorandom numbers, the same on every machine.
class RandomNumbers {
public:
    explicit RandomNumbers(std::uint32_t seed = 1) : state_(seed) {}
    /// The next number, a multiple of 2^-23 in [-1, 1).
    double operator()() {
        state_ = state_ * 1664525U + 1013904223U;
        return static_cast<double>(state_ >> 8) / 0x1p23 - 1;
    }
    /// A number in [low, high).
    double between(double low, double high) { return low + (high - low) * ((*this)() + 1) / 2; }
    Vec<double> vector() { return {(*this)(), (*this)(), (*this)()}; }
    /// A vector of length one.
    Vec<double> unit() {
        for (;;) {
            const Vec<double> v = vector();
            if (const double l = length(v); l > 0.125 && l < 1) return (1 / l) * v;
        }
    }

private:
    std::uint32_t state_;
};

/// True for shapes with an axis, which may lie along x, y or z, or at an angle.
bool has_axis(Shape shape);

/// Draws a primitive of random position and shape, in numbers that floats can represent. If `is_upright`, its axis lies
/// along x, y or z.
Primitive<double> draw_primitive(Shape shape, bool is_upright, RandomNumbers& random);

/// Question about a ray and a primitive, in numbers that floats can represent.
Question make_question(const Vec<double>& origin, const Vec<double>& direction, const Primitive<double>& primitive);

/// Half of the primitive's extent, at most 4, since a plane is infinite.
double half_extent_of(const Primitive<double>& primitive);

/// Multiplies the lengths of a question by 2^power, exactly. Directions keep their length, so t is multiplied, too.
Question scale_question(const Question& question, Shape shape, int power);

/// True if none of `change_count` small random changes of the ray changes the answer much. Every usual formula answers
/// such a question correctly.
bool is_benign(const Trial& trial, const Question& question, RandomNumbers& random, int change_count = 6);

std::string numbers_text(std::span<const double> numbers);
/// Text with the six numbers of a ray: those of its origin, then those of its direction.
std::string numbers_text(const Ray<double>& ray);
std::string answer_text(const Trial& trial, const HitOrMiss& answer);

/// Question with its right answer.
struct AnsweredQuestion {
    Question question;
    HitOrMiss right;
};
std::vector<AnsweredQuestion> add_truths(const Trial& trial, const std::vector<Question>& questions);

/// Number of wrong answers among some rays, and a description of the first.
struct WrongCount {
    std::size_t tested_count = 0, wrong_count = 0;
    std::string first_text = {};

    WrongCount() = default;
    /// Tests the form on these rays, with all lengths multiplied by 2^power.
    WrongCount(const Trial& trial, const std::vector<AnsweredQuestion>& rays, int power = 0);
    /// True if more than one answer in twenty is wrong. Fewer wrong answers may be due to rounding in the format, and
    /// do not count as a mistake of the form.
    [[nodiscard]] bool is_many() const { return 20 * wrong_count > tested_count; }
    void add(const WrongCount& other) {
        tested_count += other.tested_count;
        wrong_count += other.wrong_count;
        if (first_text.empty()) first_text = other.first_text;
    }
};

}  // namespace lostbits::measure::contract
