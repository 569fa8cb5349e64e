#include <tbb/global_control.h>
#include <tbb/task_scheduler_observer.h>

#include <algorithm>
#include <thread>

#include "analysis/choice/select.hpp"
#include "intersect/process/floating_point.hpp"

namespace lostbits::analysis::choice {

namespace {

/// A thread of the pool computes as the one that started it, which may have been anybody's.
class StandardThreads : public tbb::task_scheduler_observer {
public:
    StandardThreads() { observe(true); }
    ~StandardThreads() override { observe(false); }
    void on_scheduler_entry(bool) override { intersect::process::FloatingPoint::standard().set(); }
};

}  // namespace

struct ThreadLimit::Control {
    tbb::global_control limit;
    StandardThreads threads = {};
};

ThreadLimit::ThreadLimit(int threads) {
    const auto count = static_cast<std::size_t>(
        threads > 0 ? threads : static_cast<int>(std::max(1U, std::thread::hardware_concurrency())));
    control_.reset(new Control{.limit = {tbb::global_control::max_allowed_parallelism, count}});
}

ThreadLimit::~ThreadLimit() = default;

}  // namespace lostbits::analysis::choice
