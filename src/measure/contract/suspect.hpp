// When an intersector from outside is wrong on most rays, arithmetic is seldom the reason: its contract is.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "measure/evaluate/evaluate.hpp"

namespace lostbits::measure::contract {

/// A ray, the solid that it truly hits (that it was given, where it misses), and what an intersector made of it.
struct Judged {
    Ray<double> ray;
    Solid<double> solid;
    bool truly_hits = false;
    bool unit = false;         ///< by contract directions have unit length and t is a distance
    double true_t = 0;         ///< in the measure that the contract names
    double other_measure = 0;  ///< the parameter where t is a distance, the distance where it is the parameter
    bool hit = false;
    double t = 0;
};

/// Both measures of a true hit; `unit`: by contract directions have unit length.
Judged judged(const Ray<double>& ray, const Solid<double>& solid, const truth::Truth& truth, bool unit, bool hit,
              double t, const FloatFormat& format);

/// Whose answers they are: what to write about a file is no word of a library's contract.
enum class Whose : std::uint8_t { intersector, file };

/// What is wrong with answers most of which are: those that are off by more than 2^-8 of t and wrong decisions, where
/// at least half of all that are not rightly missed are so. What explains nine in ten of them, in words with what to
/// write; where nothing known does, how many are wrong, and how. Empty where fewer are.
/// What is about t alone is asked of the rays that hit and should. A guess that would change right answers too explains
/// nine in ten of all hits and of all answers, and leaves less than half of what "always a miss" and "always a hit"
/// leave. Every guess holds on each of two halves of the rays: what is made from one half is tested on the other.
///   a distance for t · the parameter for a distance · the radius's square, root, half or double · 0, the exit or the
///   near root, with its sign or without, from inside · the far root · the wrong sign · the direction reversed, or the
///   end of the ray in its place, or exchanged with the origin · what lies behind · y and z exchanged · the solid, or
///   t, in other units · hit inverted
/// `more_misses`: rays that are rightly missed, beside those in `rays`.
std::string suspicion(const std::vector<Judged>& rays, Whose whose = Whose::intersector, std::uint64_t more_misses = 0);

/// The same of a row on a small picture of a scene, or on the first rays of a step of a sweep, of which `where` is the
/// name. The text begins with the rays that were counted: `on all 64 rays of x: `, `on a sample of x, …: `.
std::string suspicion(const scene::file::Scene& scene, const evaluate::TestedForm& row);
std::string suspicion(std::vector<scene::rays::RayGroup> groups, const evaluate::TestedForm& row,
                      const std::string& where);
/// Puts that in front of what is suspected, if anything is: of `all` rays so many were `counted`, which are the first
/// `which`.
std::string on_rays_of(const std::string& where, std::uint64_t counted, std::uint64_t all, const std::string& which,
                       const std::string& suspicion);

}  // namespace lostbits::measure::contract
