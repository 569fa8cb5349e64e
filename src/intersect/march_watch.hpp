// Classes that observe a march while it runs, in arithmetics whose comparisons are decided.
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

/// Keeps the last sample and the step after it, which determine why the march ended.
template <class T>
class LastStep {
public:
    void on_sample(const T& t, const Vec<T>& p) {
        sample_t_ = t;
        sample_point_ = p;
    }
    void on_step(bool active, const T& t) { on_step(active, t, false); }
    void on_step(bool active, const T& t, bool has_moved) {
        if (!active) return;
        next_t_ = t;
        is_stagnant_ = !has_moved && is_same(t, sample_t_);
    }
    void on_step(bool active, const T& t, const Vec<T>& p) { on_step(active, t, !is_same(p, sample_point_)); }

    [[nodiscard]] bool is_stagnant() const { return is_stagnant_; }
    [[nodiscard]] StopReason stop(const Hit<T>& hit, const MarchConstants<T>& constants) const {
        if (hit.hit) return StopReason::hit;
        if (next_t_ > constants.max_dist) return StopReason::max_dist;
        return is_stagnant_ ? StopReason::stagnated : StopReason::max_steps;
    }

private:
    bool is_stagnant_ = false;  ///< true if the last step changed neither t nor the point
    T sample_t_ = T(0), next_t_ = T(0);
    Vec<T> sample_point_{T(0), T(0), T(0)};
};

/// Counts the samples, and keeps the smallest |field| and the smallest field value.
template <class T>
class MarchRecorder : public LastStep<T> {
public:
    void operator()(bool active, const T& t, const Vec<T>& p, const T& d) {
        if (!active) return;
        const T magnitude = abs(d);
        if (count_ == 0 || magnitude < least_ || !(least_ <= least_)) least_ = magnitude;
        if (count_ == 0 || d < deepest_ || !(deepest_ <= deepest_)) deepest_ = d;
        this->on_sample(t, p);
        ++count_;
    }

    /// `to_double(T)` converts to a number that a double holds.
    template <class ToDouble>
    [[nodiscard]] MarchRecord record(const Hit<T>& hit, const MarchConstants<T>& constants, ToDouble to_double) const {
        return {count_, this->stop(hit, constants), static_cast<double>(to_double(least_)),
                static_cast<double>(to_double(deepest_))};
    }

private:
    int count_ = 0;
    T least_ = T(0), deepest_ = T(0);
};

/// One sample of a march.
struct MarchStep {
    double t;
    Vec<double> p;
    double size;               ///< |p|, computed in the format
    double d;                  ///< field value at p
    bool is_stagnant = false;  ///< true if the step after this sample changed nothing
};

/// Keeps every sample.
template <class T>
class StepLog : public LastStep<T> {
public:
    void operator()(bool active, const T& t, const Vec<T>& p, const T& d) {
        if (!active) return;
        const Vec<double> point{as_double(p.x), as_double(p.y), as_double(p.z)};
        steps_.push_back({as_double(t), point, as_double(length(p)), as_double(d)});
        this->on_sample(t, p);
    }
    template <class... Position>
    void on_step(bool active, const T& t, const Position&... position) {
        LastStep<T>::on_step(active, t, position...);
        if (active) steps_.back().is_stagnant = this->is_stagnant();
    }
    [[nodiscard]] std::vector<MarchStep> take() { return std::move(steps_); }

private:
    std::vector<MarchStep> steps_;
};

}  // namespace lostbits::intersect
