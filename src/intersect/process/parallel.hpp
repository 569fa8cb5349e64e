// Loops over the threads of the pool. Each iteration begins in the state that IEEE 754 asks for: between two iterations
// a thread runs code that is not ours (the pool waits with sched_yield, which a preloaded library may have replaced).
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <functional>
#include <utility>

#include "intersect/process/floating_point.hpp"

namespace lostbits::intersect::process {

/// Returns `body` as a function that first sets the standard state of the thread that calls it.
template <class Body>
auto in_standard_state(const Body& body) {
    return [body]<class... Arguments>(Arguments&&... arguments) -> decltype(auto) {
        FloatingPointState::standard().apply();
        return body(std::forward<Arguments>(arguments)...);
    };
}

/// Calls `body(i)` for first ≤ i < last, in any order and on several threads.
template <class Body>
void in_parallel(std::size_t first, std::size_t last, const Body& body) {
    tbb::parallel_for(first, last, in_standard_state(std::cref(body)));
    FloatingPointState::standard().apply();
}

/// Calls `body(range)` for parts of `all`, in any order and on several threads.
template <class Body>
void in_parallel(const tbb::blocked_range<std::size_t>& all, const Body& body) {
    tbb::parallel_for(all, in_standard_state(std::cref(body)));
    FloatingPointState::standard().apply();
}

}  // namespace lostbits::intersect::process
