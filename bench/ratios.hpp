// Tables of `--ratios`: rates of many kernels, and their ratios within one run.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "measure/trade/timing.hpp"
#include "shapes/primitive.hpp"

namespace bench {

struct Contestant {
    std::string name;
    std::string rival;  ///< name of the hand-written loop to compare with; may be empty
    double bytes;       ///< bytes read and written per item
    lostbits::measure::trade::TimedWork work;
};

/// Prints a table: items per second, and their ratio to the rival's (median and quartiles of the ratios within a
/// repetition). If the data come from memory, also bytes per second, as a fraction of those of a loop that only reads
/// as many bytes in the same run.
void print_ratios(const std::string& data, std::vector<Contestant> all, std::size_t bytes);

/// Prints tables of many rays against one primitive of the shape: forms in packs, as ratios to the hand-written loops
/// if there are any, and the speed-up of the last form by all processors.
void print_rays(lostbits::Shape shape, const std::vector<std::string>& forms);

/// Prints a line: the ratio of the rate of all processors to that of one.
void print_speedup(const std::string& name, const std::string& data,
                   const lostbits::measure::trade::ThreadWorkFactory& work);

/// Prints tables of the truth of a ray: nanoseconds in packs, their ratios to Arb and `Ball`, and the number of rays
/// that each stage settles.
void print_truth();

/// Prints a table of the time for the truth of a ray in packs, shape by shape.
void print_truth_of_shapes();

/// Prints tables: nanoseconds per ray of a map's row (the truth, and all else), nanoseconds per float of an exhaustive
/// sweep, and operations of tapes per second.
void print_chains();

/// Prints a table of the cost of the filtered forms at each width, as ratios to the forms that they are compared with.
void print_filtered();

/// Prints a table of the memory per sphere that a map of a flake of 5.4 million spheres takes, from near and from far.
void print_bytes_per_sphere();

}  // namespace bench
