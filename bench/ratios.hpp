// `--ratios`: rates of many kernels and their quotients within one run.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "measure/speed/timing.hpp"
#include "shapes/solid.hpp"

namespace bench {

struct Contestant {
    std::string name;
    std::string rival;  ///< the one written by hand to hold it against; may be empty
    double bytes;       ///< read and written for an item
    lostbits::measure::speed::TimedWork work;
};

/// A table on stdout: items a second, their quotient with the rival's (median and quartiles of quotients within a
/// repetition), and, where the data come from memory, bytes a second as a share of what a loop that only reads as many
/// bytes gets in the same run.
void print_ratios(const std::string& data, std::vector<Contestant> all, std::size_t bytes);

/// Tables on stdout: forms in packs over loops written by hand, where there is one, on many rays against one solid of
/// the shape, and what more processors bring the last of them.
void print_rays(lostbits::Shape shape, const std::vector<std::string>& forms);

/// A line on stdout: the rate of all processors over that of one.
void print_speedup(const std::string& name, const std::string& data,
                   const lostbits::measure::speed::WorkOfThread& work);

/// Tables on stdout: the truth of a ray by each of its stages, in nanoseconds and over Arb and `Ball`; and how many
/// rays each stage settles.
void print_truth();

/// A table on stdout: what the truth of a ray takes in packs, shape by shape.
void print_truth_of_shapes();

/// Tables on stdout: nanoseconds a ray of a map's row, truth and all the rest, and of a float of an exhaustive sweep;
/// and operations of tapes a second.
void print_chains();

/// A table on stdout: what the filtered forms cost, width by width, over the forms that they are held against.
void print_filtered();

/// A table on stdout: what a map of a flake of 5.4 million spheres takes of memory for each, from near and from far.
void print_bytes_a_sphere();

}  // namespace bench
