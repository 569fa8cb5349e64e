#include "measure/truth/truth_columns.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

#include "measure/stages/stages.hpp"
#include "measure/truth/missing.hpp"

namespace lostbits::measure::truth {

using stages::RawProblems;

static_assert(static_cast<int>(Truth::Decision::miss) == 0 && static_cast<int>(Truth::Decision::hit) == 1);

namespace {

/// Problems that are settled together: their columns stay in the first two caches.
constexpr std::size_t most = 1024;
/// Doubles of the widest register.
constexpr std::size_t widest = 8;
constexpr std::size_t column_count = 13;

template <class S>
std::span<const S> column_of(const ProblemColumns<S>& p, std::size_t k) {
    return k < 6 ? p.ray[k] : k < 12 ? p.solid[k - 6] : p.tmax;
}

template <class S>
S number_of(std::span<const S> column, std::size_t i) {
    return column[column.size() == 1 ? 0 : i];
}

template <class S>
stages::RawColumn<S>& raw_column(RawProblems<S>& raw, std::size_t k) {
    return k < 6 ? raw.ray[k] : k < 12 ? raw.solid[k - 6] : raw.tmax;
}

/// Problems in a row, whichever they were: at the end filled up to whole registers by the last of them.
template <class S>
struct Gathered {
    alignas(64) S numbers[column_count][most];
    std::uint8_t settled[most], hit[most];
    double hi[most], lo[most], bound[most];

    template <class From>
    RawProblems<S> gather(const ProblemColumns<From>& p, std::span<const std::size_t> which, std::size_t lanes) {
        const std::size_t size = (which.size() + lanes - 1) / lanes * lanes;
        RawProblems<S> raw = stages::raw_problems<S>(size, {settled, hit, hi, lo, bound});
        for (std::size_t k = 0; k < column_count; ++k) {
            S* const to = numbers[k];
            const auto from = column_of(p, k);
            if (from.size() <= 1) {
                const S one = from.empty() ? static_cast<S>(HUGE_VAL) : static_cast<S>(from[0]);
                std::fill_n(to, lanes, one);
                raw_column(raw, k) = {to, 0};
                continue;
            }
            for (std::size_t i = 0; i < which.size(); ++i) to[i] = static_cast<S>(from[which[i]]);
            std::fill(to + which.size(), to + size, to[which.size() - 1]);
            raw_column(raw, k) = {to, 1};
        }
        return raw;
    }
    void scatter(std::span<const std::size_t> which, TruthColumns& out) const {
        for (std::size_t i = 0; i < which.size(); ++i) {
            out.decision[which[i]] = static_cast<Truth::Decision>(hit[i]);
            out.hi[which[i]] = hi[i];
            out.lo[which[i]] = lo[i];
            out.bound[which[i]] = bound[i];
        }
    }
};

/// The `size` problems from `begin` on where they lie.
template <class S>
class InPlace {
public:
    InPlace(const ProblemColumns<S>& p, TruthColumns& out) : problems_(p), out_(out) {
        for (std::size_t k = 0; k < column_count; ++k) {
            const auto from = column_of(p, k);
            if (from.size() <= 1) std::fill_n(same_[k], widest, from.empty() ? static_cast<S>(HUGE_VAL) : from[0]);
        }
    }
    RawProblems<S> at(std::size_t begin, std::size_t size, std::uint8_t* settled) {
        auto* const hit = reinterpret_cast<std::uint8_t*>(out_.decision.data());
        RawProblems<S> raw = stages::raw_problems<S>(
            size, {settled, hit + begin, out_.hi.data() + begin, out_.lo.data() + begin, out_.bound.data() + begin});
        for (std::size_t k = 0; k < column_count; ++k) {
            const auto from = column_of(problems_, k);
            if (from.size() > 1) raw_column(raw, k) = {from.data() + begin, 1};
            else raw_column(raw, k) = {same_[k], 0};
        }
        return raw;
    }

private:
    const ProblemColumns<S>& problems_;
    TruthColumns& out_;
    alignas(64) S same_[column_count][widest];
};

/// Ray i by itself, into its place in the columns.
template <class S>
void find_alone(const ProblemColumns<S>& p, const ColumnTerms& terms, std::size_t i, TruthColumns& out) {
    const auto at = [&](std::size_t k) { return static_cast<double>(number_of(column_of(p, k), i)); };
    Solid<double> solid;
    solid.shape = p.shape;
    for (std::size_t k = 0; k < solid.used().size(); ++k) solid.numbers[k] = at(6 + k);
    const Truth truth = find_truth({{at(0), at(1), at(2)}, {at(3), at(4), at(5)}}, solid, terms.limit, terms.convention,
                                   p.tmax.empty() ? HUGE_VAL : at(12));
    out.decision[i] = truth.decision;
    out.hi[i] = out.lo[i] = out.bound[i] = 0;
    if (truth.is_hit()) {
        const Certified& t = terms.length == Length::parameter ? truth.t : truth.distance;
        const bool in_range = t.is_zero() || (t.exponent >= -900 && t.exponent < 900);
        const auto scaled = [&](double x) { return in_range ? std::ldexp(x, static_cast<int>(t.exponent)) : missing; };
        out.hi[i] = scaled(t.hi);
        out.lo[i] = scaled(t.lo);
        out.bound[i] = scaled(t.bound);
    }
    ++(truth.bits <= 106 ? out.stages.ball : out.stages.interval);
    out.alone.emplace_back(i, truth);
}

/// Keeps of `which` those that are not settled.
void keep_open(const std::uint8_t* settled, std::size_t begin, std::size_t count, std::vector<std::size_t>& open) {
    for (std::size_t i = 0; i < count; ++i) {
        std::uint64_t eight = 0x0101010101010101;
        if (i % 8 == 0 && i + 8 <= count) std::memcpy(&eight, settled + i, 8);
        if (i % 8 == 0 && i + 8 <= count && eight == 0x0101010101010101) {
            i += 7;
            continue;
        }
        if (settled[i] == 0) open.push_back(begin + i);
    }
}

template <class S>
class ColumnSearch {
public:
    ColumnSearch(const ProblemColumns<S>& problems, const ColumnTerms& terms, TruthColumns& out)
        : problems_(problems),
          terms_(terms),
          out_(out),
          stages_(stages::stages_of(problems.shape, intersect::simd::current_isa())),
          in_place_(problems, out) {}

    void find() {
        for (std::size_t begin = 0; begin < problems_.size; begin += most) {
            const std::size_t count = std::min(most, problems_.size - begin);
            const std::size_t distance = terms_.length == Length::distance ? 1 : 0;
            open_.clear();
            if constexpr (std::is_same_v<S, float>) {
                if (terms_.tightness == Tightness::ulps_of_binary32) {
                    settle_in_place(stages_.kernels.binary64[distance], begin, count);
                    out_.stages.binary64 += count - open_.size();
                } else {
                    open_.resize(count);
                    std::iota(open_.begin(), open_.end(), begin);
                }
                if (!open_.empty()) settle_gathered(stages_.kernels.double_double[distance]);
            } else {
                settle_in_place(stages_.kernels.double_double[distance], begin, count);
                out_.stages.double_double += count - open_.size();
            }
            for (const std::size_t i : open_) find_alone(problems_, terms_, i, out_);
        }
    }

private:
    /// Those from `begin` on; what stays open goes into `open_`.
    void settle_in_place(void (*stage)(const RawProblems<S>&), std::size_t begin, std::size_t count) {
        const std::size_t whole = count - count % stages_.lanes;
        std::uint8_t settled[most];
        if (whole) stage(in_place_.at(begin, whole, settled));
        if (whole < count) {
            std::vector<std::size_t> tail(count - whole);
            std::iota(tail.begin(), tail.end(), begin + whole);
            Gathered<S> rest;
            stage(rest.gather(problems_, tail, stages_.lanes));
            rest.scatter(tail, out_);
            std::copy_n(rest.settled, tail.size(), settled + whole);
        }
        keep_open(settled, begin, count, open_);
    }
    /// Those in `open_`, which keeps what stays open.
    void settle_gathered(void (*stage)(const RawProblems<double>&)) {
        const auto gathered = std::make_unique<Gathered<double>>();
        const std::vector<std::size_t> which = std::exchange(open_, {});
        stage(gathered->gather(problems_, which, stages_.lanes));
        gathered->scatter(which, out_);
        for (std::size_t i = 0; i < which.size(); ++i) {
            if (gathered->settled[i] == 0) open_.push_back(which[i]);
        }
        out_.stages.double_double += which.size() - open_.size();
    }

    const ProblemColumns<S>& problems_;
    const ColumnTerms& terms_;
    TruthColumns& out_;
    const stages::Stages& stages_;
    InPlace<S> in_place_;
    std::vector<std::size_t> open_;
};

template <class S>
void find_columns(const ProblemColumns<S>& problems, const ColumnTerms& terms, TruthColumns& out) {
    out.decision.resize(problems.size);
    for (auto* column : {&out.hi, &out.lo, &out.bound}) column->resize(problems.size);
    out.alone.clear();
    out.stages = {};
    ColumnSearch<S>(problems, terms, out).find();
}

}  // namespace

void find_truth_columns(const ProblemColumns<float>& problems, const ColumnTerms& terms, TruthColumns& out) {
    find_columns(problems, terms, out);
}
void find_truth_columns(const ProblemColumns<double>& problems, const ColumnTerms& terms, TruthColumns& out) {
    find_columns(problems, terms, out);
}

}  // namespace lostbits::measure::truth
