// The loops around the stages, for packs of any width and for single doubles. They see plain pointers only, as
// intersect/simd/packed_batch.hpp does and for the same reason.
#pragma once

#include <cstring>

#include "measure/stages/box_stages.hpp"
#include "measure/stages/raw_stages.hpp"
#include "measure/stages/sphere_binary64.hpp"
#include "measure/stages/sphere_double_double.hpp"
#include "measure/stages/unit_stage.hpp"
#include "number/pack.hpp"

namespace lostbits::measure::stages {

/// How a number of the stages is loaded and stored: one double, or a pack of them.
template <class P>
struct Lanes {
    static constexpr std::size_t count = P::lanes;
    template <class S>
    static P load(const S* from) {
        return P(typename P::Simd(from, stdx::element_aligned));
    }
    static void store(const P& x, double* to) { x.store(to); }
    static void store(const mask_t<P>& x, std::uint8_t* to) {
        bool lanes[count];
        x.store(lanes);
        std::memcpy(to, lanes, count);
    }
};
template <>
struct Lanes<double> {
    static constexpr std::size_t count = 1;
    template <class S>
    static double load(const S* from) {
        return static_cast<double>(*from);
    }
    static void store(double x, double* to) { *to = x; }
    static void store(bool x, std::uint8_t* to) { *to = x; }
};

enum class Subject { sphere, box };

template <Subject subject, class S, Wanted wanted, bool two_words, class P>
[[gnu::flatten]] void settle_all(const RawProblems<S>& raw) {
    const RawProblems<S> p = raw;  // a copy: the stores below could reach it, and everything would be read again
    constexpr std::size_t numbers = subject == Subject::sphere ? 4 : 6;
    const P scale(p.scale);
    for (std::size_t i = 0; i < p.size; i += Lanes<P>::count) {
        const auto at = [i](const RawColumn<S>& c) { return Lanes<P>::load(c.from + i * c.step); };
        ProblemInWords<P> in;
        for (std::size_t k = 0; k < 6; ++k) {
            in.ray[k] = at(p.ray[k]);
            if constexpr (two_words) in.ray_low[k] = at(p.ray_low[k]);
        }
        for (std::size_t k = 0; k < numbers; ++k) {
            in.solid[k] = at(p.solid[k]);
            if constexpr (two_words) in.solid_low[k] = at(p.solid_low[k]);
        }
        const Finding<P> found = [&] {
            if constexpr (subject == Subject::box) {
                in.tmax = at(p.tmax);
                return settle_box<sizeof(S) == sizeof(double), wanted, two_words>(in, scale);
            } else if constexpr (sizeof(S) == sizeof(double)) {
                return settle_sphere_double_double<wanted, two_words>(in, scale);
            } else {
                return settle_sphere_binary64<wanted>(in, scale);
            }
        }();
        Lanes<P>::store(found.settled, p.out.settled + i);
        Lanes<P>::store(found.hit, p.out.hit + i);
        // A miss has zeros; so has a lane that says nothing.
        const auto store = [&](const P& x, double* to) { Lanes<P>::store(select(found.hit, x, P(0)), to + i); };
        const Enclosure<P>& first = wanted == Wanted::distance ? found.distance : found.t;
        store(first.middle.hi, p.out.hi);
        store(first.middle.lo, p.out.lo);
        store(first.bound, p.out.bound);
        if constexpr (wanted == Wanted::both) {
            store(found.distance.middle.hi, p.out.distance_hi);
            store(found.distance.middle.lo, p.out.distance_lo);
            store(found.distance.bound, p.out.distance_bound);
        }
    }
}

template <class P>
[[gnu::flatten]] void settle_unit_directions(const RawDirections& raw) {
    const RawDirections p = raw;
    for (std::size_t i = 0; i < p.size; i += Lanes<P>::count) {
        const P d[3] = {Lanes<P>::load(p.in[0] + i), Lanes<P>::load(p.in[1] + i), Lanes<P>::load(p.in[2] + i)};
        const UnitDirection<P> unit = settle_unit_direction<P>(d, p.binary32, P(p.scale));
        Lanes<P>::store(unit.settled, p.settled + i);
        for (int k = 0; k < 3; ++k) Lanes<P>::store(unit.components[k], p.out[k] + i);
    }
}

template <Subject subject, class P>
RawStages stages_for() {
    using enum Wanted;
    return {{settle_all<subject, float, parameter, false, P>, settle_all<subject, float, distance, false, P>,
             settle_all<subject, float, both, false, P>},
            {settle_all<subject, double, parameter, false, P>, settle_all<subject, double, distance, false, P>,
             settle_all<subject, double, both, false, P>},
            {settle_all<subject, double, parameter, true, P>, settle_all<subject, double, distance, true, P>,
             settle_all<subject, double, both, true, P>},
            settle_unit_directions<P>};
}

template <class P>
void fill_stages(RawStages* of_shape) {
    of_shape[0] = stages_for<Subject::sphere, P>();
    of_shape[1] = stages_for<Subject::box, P>();
}

}  // namespace lostbits::measure::stages
