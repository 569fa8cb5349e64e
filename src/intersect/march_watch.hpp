// What is seen of a march while it runs, in the arithmetics whose comparisons are decided.
#pragma once

#include <vector>

#include "geometry/shapes.hpp"
#include "intersect/march.hpp"
#include "number/with_number.hpp"

namespace lostbits::intersect {

/// Counts the samples and keeps the smallest.
template <class T>
class Tally {
public:
    void operator()(bool active, const T& t, const Vec<T>& /*p*/, const T& d) {
        if (!active) return;
        const T size = abs(d);
        if (count_ == 0 || size < least_ || !(least_ <= least_)) least_ = size;
        if (count_ == 0 || d < deepest_ || !(deepest_ <= deepest_)) deepest_ = d;
        stands_ = count_ > 0 && t <= last_ && last_ <= t;
        last_ = t;
        ++count_;
    }

    /// `drop(T)` gives a number that a double holds.
    template <class Drop>
    [[nodiscard]] MarchRecord record(const Hit<T>& hit, const MarchConstants<T>& c, Drop drop) const {
        const Stop stop = hit.hit              ? Stop::hit
                          : hit.t > c.max_dist ? Stop::max_dist
                          : stands_            ? Stop::stagnated
                                               : Stop::max_steps;
        return {count_, stop, static_cast<double>(drop(least_)), static_cast<double>(drop(deepest_))};
    }

private:
    int count_ = 0;
    bool stands_ = false;  ///< the last two samples were taken at the same t
    T least_ = T(0), deepest_ = T(0), last_ = T(0);
};

/// One sample of a march.
struct MarchStep {
    double t;
    Vec<double> p;
    double size;  ///< |p|, computed in the format
    double d;     ///< the field
};

/// Keeps every sample.
template <class T>
class StepLog {
public:
    void operator()(bool active, const T& t, const Vec<T>& p, const T& d) {
        if (!active) return;
        const Vec<double> at{as_double(p.x), as_double(p.y), as_double(p.z)};
        steps_.push_back({as_double(t), at, as_double(length(p)), as_double(d)});
    }
    [[nodiscard]] std::vector<MarchStep> take() { return std::move(steps_); }

private:
    std::vector<MarchStep> steps_;
};

}  // namespace lostbits::intersect
