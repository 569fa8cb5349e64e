// Guesses the mistake when an external intersector is wrong on most rays: the reason is then seldom its arithmetic, and
// usually its contract.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "measure/evaluate/evaluate.hpp"

namespace lostbits::measure::contract {

/// A ray, the primitive that it truly hits (or that it was tested against, if it misses), and the answer of an
/// intersector.
struct AnswerSample {
    Ray<double> ray;
    Primitive<double> primitive;
    bool truly_hits = false;
    bool is_unit = false;  ///< by contract, directions have unit length and t is a distance
    double true_t = 0;     ///< in the unit that the contract declares
    double other_t = 0;    ///< t in the other unit: the parameter for a distance, and vice versa
    bool hit = false;
    double t = 0;
};

/// Makes an AnswerSample with both units of a true hit. `t` counts if the row's form has roots, and is NaN otherwise.
AnswerSample make_answer_sample(const Ray<double>& ray, const Primitive<double>& primitive,
                                const truth::Truth& ray_truth, const evaluate::TestedForm& tested_form, bool hit,
                                double t);

/// Source of the answers. The advice about a file does not mention the contract of a library.
enum class AnswerSource : std::uint8_t { intersector, file };

/// Describes what is wrong with answers if most are wrong; empty if fewer are. An answer is wrong if its decision is,
/// or if its t is off by more than 2^-8 of itself. "Most" means at least half of the answers that are not right misses.
/// The text names the mistake that explains nine in ten of the wrong answers and says what to write. If no known
/// mistake does, the text says how many answers are wrong, and in what way.
///
/// A mistake about t only is tested on the rays that hit and should hit. A guess that would change right answers too
/// has to explain nine in ten of all hits and of all answers, and has to leave less than half as many answers
/// unexplained as the better of the guesses "always a miss" and "always a hit". Every guess must hold on each of two
/// halves of the rays. Known mistakes:
///
/// - t is a distance, or the parameter in place of a distance;
/// - the radius is squared, halved, doubled, or replaced by its root;
/// - from inside, the answer is 0, the exit or the near root, with its sign or without;
/// - the answer is the far root, or has the wrong sign;
/// - the direction is reversed, replaced by the end of the ray, or exchanged with the origin;
/// - an intersection behind the ray is answered as a hit;
/// - y and z are exchanged;
/// - the primitive, or t, is in other units;
/// - hit is inverted.
///
/// `more_miss_count`: number of right misses in addition to those in `rays`.
std::string suspicion_text(const std::vector<AnswerSample>& rays, AnswerSource source = AnswerSource::intersector,
                           std::uint64_t more_miss_count = 0);

/// Does the same for a row on a small picture of a scene, or on the first rays of a step of a sweep that is called
/// `where`. The text begins with the rays that were counted: `on all 64 rays of x: `, `on a sample of x, …: `.
std::string suspicion_text(const scene::file::Scene& scene, const evaluate::TestedForm& tested_form);
std::string suspicion_text(std::vector<scene::rays::RayGroup> groups, const evaluate::TestedForm& tested_form,
                           const std::string& where);
/// Puts the text about the counted rays in front of a suspicion, unless the suspicion is empty. `sampled` of `total`
/// rays were counted; `counted_rays_text` follows their number, such as `of its rays`.
std::string name_counted_rays(const std::string& where, std::uint64_t sampled, std::uint64_t total,
                              const std::string& counted_rays_text, const std::string& suspicion);

}  // namespace lostbits::measure::contract
