// When an intersector from outside is wrong on most rays, arithmetic is seldom the reason: its contract is.
#pragma once

#include <string>
#include <vector>

#include "measure/map/map.hpp"

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
              double t);

/// What would explain answers most of which are wrong: those that are off by more than 2^-8 of t and wrong decisions,
/// where at least half of all that are not rightly missed are so and one explanation fits nine in ten. In words, with
/// what to write; empty where nothing is wrong, or nothing known explains it.
///   a distance for t · the parameter for a distance · the radius's square, root, half or double · the far root · the
///   wrong sign · what lies behind
std::string suspicion(const std::vector<Judged>& rays);

/// The same of a row on a small picture of a scene, or on the rays of a step of a sweep.
std::string suspicion(const scene::file::Scene& scene, const map::MapRow& row);
std::string suspicion(std::vector<scene::rays::RayGroup> groups, const map::MapRow& row);

}  // namespace lostbits::measure::contract
