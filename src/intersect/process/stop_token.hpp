// A request to stop some work, made by the code that started the work. Two runs in one process have a token each.
#pragma once

#include <atomic>

#include "number/error.hpp"

namespace lostbits::intersect::process {

/// Copied to every worker of a run. The flag belongs to the owner of the run and outlives all copies; another thread or
/// a signal handler may set it. A token without a flag never requests a stop.
class StopToken {
public:
    StopToken() = default;
    explicit StopToken(const std::atomic<bool>& flag) : flag_(&flag) {}
    [[nodiscard]] bool is_requested() const noexcept {
        return flag_ != nullptr && flag_->load(std::memory_order_relaxed);
    }
    /// Throws Interrupted if a stop is requested. It costs one load. Work that may take longer than a second calls it
    /// repeatedly.
    void check() const {
        if (is_requested()) throw Interrupted();
    }

private:
    static_assert(std::atomic<bool>::is_always_lock_free);  // a signal handler may set it
    const std::atomic<bool>* flag_ = nullptr;
};

}  // namespace lostbits::intersect::process
