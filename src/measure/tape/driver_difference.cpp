#include "measure/tape/driver_difference.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>

#include "intersect/table/random_rays.hpp"
#include "measure/tape/tape_form.hpp"

namespace lostbits::measure::tape {
namespace {

using intersect::table::Intersector;

constexpr std::size_t ray_count = 4096;
constexpr int most_ulps = 4;
constexpr std::size_t most_sites = 12;  ///< operations whose subsets are all tried

using intersect::table::RandomRays;
using intersect::table::RowAnswers;

/// A program with rewritings, as a driver might run it.
struct Suspect {
    DerivedTape made;
    bool flushes = false;
    NodeId inexact = no_node;
    int ulps = 0;
};

template <class S>
S flushed(S x) {
    return std::fpclassify(x) == FP_SUBNORMAL ? std::copysign(S(0), x) : x;
}

double rounded(TapeOp op, double a, double b, double c, bool is_float) {
    const auto f = [&](double x) { return is_float ? static_cast<double>(static_cast<float>(x)) : x; };
    switch (op) {
        case TapeOp::add: return f(a + b);
        case TapeOp::sub: return f(a - b);
        case TapeOp::mul: return f(a * b);
        case TapeOp::div: return f(a / b);
        case TapeOp::sqrt: return f(std::sqrt(a));
        case TapeOp::fma:
            return is_float ? std::fma(static_cast<float>(a), static_cast<float>(b), static_cast<float>(c))
                            : std::fma(a, b, c);
        case TapeOp::neg: return -a;
        case TapeOp::abs: return std::fabs(a);
        case TapeOp::copysign: return std::copysign(a, b);
        case TapeOp::min: return a < b ? a : b;
        case TapeOp::max: return a > b ? a : b;
        case TapeOp::select: return a != 0 ? b : c;
        case TapeOp::convert: return f(a);
        case TapeOp::less: return a < b;
        case TapeOp::less_equal: return a <= b;
        case TapeOp::greater: return a > b;
        case TapeOp::greater_equal: return a >= b;
        case TapeOp::both: return a != 0 && b != 0;
        case TapeOp::either: return a != 0 || b != 0;
        case TapeOp::opposite: return a == 0;
        case TapeOp::any: return a;
        default: return NAN;
    }
}

struct Answer {
    bool hit;
    float t;
};

Answer answer_of(const Suspect& s, const RandomRays<float>& rays, std::size_t ray, std::vector<double>& values) {
    const Tape& tape = s.made.tape;
    values.resize(tape.nodes.size());
    for (NodeId i = 0; i < tape.size(); ++i) {
        const TapeNode& n = tape[i];
        const auto x = [&](std::size_t k) {
            return n.operands[k] == no_node ? 0 : values[static_cast<std::size_t>(n.operands[k])];
        };
        double value = 0;
        if (n.op == TapeOp::input) value = rays.input(ray, static_cast<std::size_t>(n.operands[0]));
        else if (n.op == TapeOp::constant) value = n.operands[0];
        else value = rounded(n.op, x(0), x(1), x(2), tape.format_of(i) == binary32);
        if (s.flushes && tape.format_of(i) == binary32) value = flushed(static_cast<float>(value));
        if (i == s.inexact)
            for (int k = 0; k < std::abs(s.ulps); ++k)
                value = std::nextafter(static_cast<float>(value), s.ulps > 0 ? INFINITY : -INFINITY);
        values[static_cast<std::size_t>(i)] = value;
    }
    return {values[static_cast<std::size_t>(tape.outputs.hit)] != 0,
            static_cast<float>(values[static_cast<std::size_t>(tape.outputs.t)])};
}

class Search {
public:
    Search(const Tape& tape, const RandomRays<float>& rays, const RowAnswers<float>& driver)
        : rays_(rays), driver_(driver), names_(driver_rewritings()) {
        own_.tape = tape;
        own_.origins.resize(tape.nodes.size());
        std::iota(own_.origins.begin(), own_.origins.end(), 0);
    }

    void find(DriverDifference& found) {
        std::vector<unsigned> sets(std::size_t{1} << (names_.size() + 1));
        std::iota(sets.begin(), sets.end(), 0U);
        std::ranges::stable_sort(sets, {}, [](unsigned set) { return std::popcount(set); });
        for (const unsigned set : sets) {
            Chosen all;
            if (const auto made = with(set, nullptr, &all); made && explains(*made)) return told(set, all, found);
        }
        for (const unsigned set : sets)
            if (std::popcount(set) <= 2 && is_partly_rewritten(set, found)) return;
        for (const unsigned set : sets)
            if (std::popcount(set) <= 2 && is_inexact(set, found)) return;
    }

private:
    using Chosen = std::vector<std::vector<NodeId>>;  ///< sites of each rewriting

    /// The program with the rewritings of a set; nothing if one of them changes nothing.
    std::optional<Suspect> with(unsigned set, const Chosen* sites, Chosen* changed) const {
        Suspect made{.made = own_, .flushes = (set >> names_.size()) != 0};
        for (std::size_t k = 0; k < names_.size(); ++k) {
            std::vector<NodeId> at;
            if ((set >> k & 1U) != 0) {
                made.made = rewritten_by_driver(made.made, k, sites ? &(*sites)[k] : nullptr, at);
                if (at.empty()) return {};
            }
            if (changed) changed->push_back(at);
        }
        return made;
    }
    bool is_drivers(const Suspect& s, std::size_t ray) {
        const Answer own = answer_of(s, rays_, ray, values_);
        return RowAnswers<float>::are_same(own.hit, own.t, driver_.hit[ray] != 0, driver_.numbers[0][ray]);
    }
    bool explains(const Suspect& s) {
        for (std::size_t i = 0; i < ray_count; ++i)
            if (!is_drivers(s, i)) return false;
        return true;
    }
    /// Tries the rewritings of a set at some of the operations only, at few of them first.
    bool is_partly_rewritten(unsigned set, DriverDifference& found) {
        Chosen all;
        if (!with(set, nullptr, &all)) return false;
        std::vector<std::pair<std::size_t, NodeId>> sites;
        for (std::size_t k = 0; k < all.size(); ++k)
            for (const NodeId i : all[k]) sites.emplace_back(k, i);
        if (sites.size() > most_sites) return false;
        std::vector<unsigned> masks(std::size_t{1} << sites.size());
        std::iota(masks.begin(), masks.end(), 0U);
        std::ranges::stable_sort(masks, {}, [](unsigned mask) { return std::popcount(mask); });
        for (const unsigned mask : masks) {
            Chosen some(all.size());
            for (std::size_t j = 0; j < sites.size(); ++j)
                if ((mask >> j & 1U) != 0) some[sites[j].first].push_back(sites[j].second);
            if (const auto made = with(set, &some, nullptr); made && explains(*made))
                return told(set, some, found), true;
        }
        return false;
    }
    /// Leaves out every operation that does not have to be rewritten.
    void told(unsigned set, Chosen sites, DriverDifference& found) {
        for (std::size_t k = 0; k < names_.size(); ++k)
            for (std::size_t j = sites[k].size(); j-- > 0 && sites[k].size() > 1;) {
                Chosen fewer = sites;
                fewer[k].erase(fewer[k].begin() + static_cast<std::ptrdiff_t>(j));
                if (const auto made = with(set, &fewer, nullptr); made && explains(*made)) sites = fewer;
            }
        for (std::size_t k = 0; k < names_.size(); ++k)
            if (!sites[k].empty()) found.rewritings.push_back({names_[k], sites[k]});
        if (set >> names_.size() != 0) found.rewritings.push_back({"makes subnormal numbers 0", {}});
    }
    /// Tries one quotient or root after the other as an operation that is some units in the last place off.
    bool is_inexact(unsigned set, DriverDifference& found) {
        Chosen sites;
        auto made = with(set, nullptr, &sites);
        if (!made) return false;
        const Tape& tape = made->made.tape;
        for (NodeId i = 0; i < tape.size(); ++i) {
            if (tape[i].op != TapeOp::div && tape[i].op != TapeOp::sqrt) continue;
            made->inexact = i;
            int most = 0;
            const bool all = [&] {
                for (std::size_t ray = 0; ray < ray_count; ++ray) {
                    const int ulps = ulps_at(*made, ray);
                    if (ulps > most_ulps) return false;
                    most = std::max(most, ulps);
                }
                return true;
            }();
            if (!all) continue;
            for (std::size_t k = 0; k < names_.size(); ++k)
                if (!sites[k].empty()) found.rewritings.push_back({names_[k], sites[k]});
            found.inexact = made->made.origins[static_cast<std::size_t>(i)], found.ulps = most;
            return true;
        }
        return false;
    }
    /// The least error of the inexact operation that gives the driver's bits; more than `most_ulps`: none.
    int ulps_at(Suspect& s, std::size_t ray) {
        for (int size = 0; size <= most_ulps; ++size)
            for (const int sign : {1, -1}) {
                s.ulps = sign * size;
                if (is_drivers(s, ray)) return size;
            }
        return most_ulps + 1;
    }

    const RandomRays<float>& rays_;
    const RowAnswers<float>& driver_;
    std::vector<std::string> names_;
    DerivedTape own_;
    std::vector<double> values_;
};

}  // namespace

NodeId DriverDifference::first() const {
    NodeId least = inexact;
    for (const DriverRewriting& r : rewritings)
        for (const NodeId i : r.sites)
            if (least == no_node || i < least) least = i;
    return least;
}

DriverDifference driver_difference(const Intersector& driver, const Intersector& program) {
    const RandomRays<float> rays(program.shape, ray_count, driver.info->direction == intersect::Direction::unit);
    const RowAnswers<float> theirs = rays.answers(driver.native32), ours = rays.answers(program.native32);
    DriverDifference found{.rays = ray_count, .differ = 0, .rewritings = {}};
    for (std::size_t i = 0; i < ray_count; ++i) found.differ += theirs.are_same(ours, i) ? 0 : 1;
    if (found.differ > 0) Search(tape_of(program, *find_format("f32")), rays, theirs).find(found);
    return found;
}

}  // namespace lostbits::measure::tape
