// Whether whoever started some work wants it ended: of two runs in one process each has its own.
#pragma once

#include <atomic>

#include "number/error.hpp"

namespace lostbits::intersect::process {

/// Copied into what is asked for and whatever works on it. The flag is its owner's, outlives all of them, and may be
/// set by another thread or a signal handler. Without a flag nobody ever asks.
class StopToken {
public:
    StopToken() = default;
    explicit StopToken(const std::atomic<bool>& flag) : flag_(&flag) {}
    [[nodiscard]] bool is_asked() const noexcept { return flag_ != nullptr && flag_->load(std::memory_order_relaxed); }
    /// Throws Interrupted where it is asked. A load: what may take longer than a second calls it on the way.
    void check() const {
        if (is_asked()) throw Interrupted();
    }

private:
    static_assert(std::atomic<bool>::is_always_lock_free);  // a signal handler may set it
    const std::atomic<bool>* flag_ = nullptr;
};

}  // namespace lostbits::intersect::process
