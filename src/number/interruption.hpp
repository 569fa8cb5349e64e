// A run that was asked to stop ends at the next place that asks.
#pragma once

#include <atomic>

#include "number/error.hpp"

namespace lostbits {

/// Set by a signal; see analysis/main.cpp.
inline std::atomic<bool> asked_to_stop{false};
static_assert(std::atomic<bool>::is_always_lock_free);

/// Throws Interrupted once the run was asked to stop. A load: what may take longer than a second calls it on the way.
inline void stop_if_interrupted() {
    if (asked_to_stop.load(std::memory_order_relaxed)) throw Interrupted();
}

}  // namespace lostbits
