// Observation of a march while it runs, in arithmetics whose comparisons are decided.
#pragma once

#include <vector>

#include "geometry/ray.hpp"
#include "intersect/march.hpp"
#include "number/with_number.hpp"

namespace lostbits::intersect {

template <class T>
bool is_same(const T& a, const T& b) {
    return a <= b && b <= a;
}
template <class T>
bool is_same(const Vec<T>& a, const Vec<T>& b) {
    return is_same(a.x, b.x) && is_same(a.y, b.y) && is_same(a.z, b.z);
}

/// Keeps the last sample and the step after it, which tell why the march ended.
template <class T>
class LastStep {
public:
    void sampled(const T& t, const Vec<T>& p) {
        from_ = t;
        from_point_ = p;
    }
    void stepped(bool active, const T& t) { stepped(active, t, false); }
    void stepped(bool active, const T& t, bool changed) {
        if (!active) return;
        t_ = t;
        stands_ = !changed && is_same(t, from_);
    }
    void stepped(bool active, const T& t, const Vec<T>& p) { stepped(active, t, !is_same(p, from_point_)); }

    [[nodiscard]] bool stands() const { return stands_; }
    [[nodiscard]] Stop stop(const Hit<T>& hit, const MarchConstants<T>& c) const {
        if (hit.hit) return Stop::hit;
        if (t_ > c.max_dist) return Stop::max_dist;
        return stands_ ? Stop::stagnated : Stop::max_steps;
    }

private:
    bool stands_ = false;  ///< the step led nowhere
    T from_ = T(0), t_ = T(0);
    Vec<T> from_point_{T(0), T(0), T(0)};
};

/// Counts the samples and keeps the smallest.
template <class T>
class Tally : public LastStep<T> {
public:
    void operator()(bool active, const T& t, const Vec<T>& p, const T& d) {
        if (!active) return;
        const T size = abs(d);
        if (count_ == 0 || size < least_ || !(least_ <= least_)) least_ = size;
        if (count_ == 0 || d < deepest_ || !(deepest_ <= deepest_)) deepest_ = d;
        this->sampled(t, p);
        ++count_;
    }

    /// `drop(T)` gives a number that a double holds.
    template <class Drop>
    [[nodiscard]] MarchRecord record(const Hit<T>& hit, const MarchConstants<T>& c, Drop drop) const {
        return {count_, this->stop(hit, c), static_cast<double>(drop(least_)), static_cast<double>(drop(deepest_))};
    }

private:
    int count_ = 0;
    T least_ = T(0), deepest_ = T(0);
};

/// One sample of a march.
struct MarchStep {
    double t;
    Vec<double> p;
    double size;          ///< |p|, computed in the format
    double d;             ///< the field
    bool stands = false;  ///< the step after it led nowhere
};

/// Keeps every sample.
template <class T>
class StepLog : public LastStep<T> {
public:
    void operator()(bool active, const T& t, const Vec<T>& p, const T& d) {
        if (!active) return;
        const Vec<double> at{as_double(p.x), as_double(p.y), as_double(p.z)};
        steps_.push_back({as_double(t), at, as_double(length(p)), as_double(d)});
        this->sampled(t, p);
    }
    template <class... Led>
    void stepped(bool active, const T& t, const Led&... led) {
        LastStep<T>::stepped(active, t, led...);
        if (active) steps_.back().stands = this->stands();
    }
    [[nodiscard]] std::vector<MarchStep> take() { return std::move(steps_); }

private:
    std::vector<MarchStep> steps_;
};

}  // namespace lostbits::intersect
