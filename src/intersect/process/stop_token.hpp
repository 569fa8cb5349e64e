// A request to stop some work by whoever started it: two runs in one process have one each.
#pragma once

#include <atomic>

#include "number/error.hpp"

namespace lostbits::intersect::process {

/// Copied to every worker of a run. The flag belongs to its owner and outlives all copies; another thread or a signal
/// handler may set it. Without a flag there is never a request.
class StopToken {
public:
    StopToken() = default;
    explicit StopToken(const std::atomic<bool>& flag) : flag_(&flag) {}
    [[nodiscard]] bool is_asked() const noexcept { return flag_ != nullptr && flag_->load(std::memory_order_relaxed); }
    /// Throws Interrupted if a stop is requested. It costs one load; work that may take longer than a second calls it
    /// on the way.
    void check() const {
        if (is_asked()) throw Interrupted();
    }

private:
    static_assert(std::atomic<bool>::is_always_lock_free);  // a signal handler may set it
    const std::atomic<bool>* flag_ = nullptr;
};

}  // namespace lostbits::intersect::process
