// Loops over the threads of the pool. Each iteration begins in the state that IEEE 754 asks for: between two iterations
// a thread runs code that is not ours (the pool waits with sched_yield, which a preloaded library may have replaced).
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "intersect/process/floating_point.hpp"

namespace lostbits::intersect::process {

/// Calls `body(i)` for first ≤ i < last, in any order and on several threads.
template <class Body>
void in_parallel(std::size_t first, std::size_t last, const Body& body) {
    tbb::parallel_for(first, last, [&body](std::size_t i) {
        FloatingPointState::standard().apply();
        body(i);
    });
    FloatingPointState::standard().apply();
}

/// Calls `body(range)` for parts of `all`, in any order and on several threads.
template <class Body>
void in_parallel(const tbb::blocked_range<std::size_t>& all, const Body& body) {
    tbb::parallel_for(all, [&body](const tbb::blocked_range<std::size_t>& range) {
        FloatingPointState::standard().apply();
        body(range);
    });
    FloatingPointState::standard().apply();
}

}  // namespace lostbits::intersect::process
