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
constexpr int max_ulps = 4;
constexpr std::size_t max_sites = 12;  ///< number of operations up to which all subsets are tried

using intersect::table::FormAnswers;
using intersect::table::RandomRays;

/// The program with some rewritings, as a driver might run it.
struct CandidateProgram {
    DerivedTape program;
    bool flushes_subnormals = false;
    NodeId inexact_operation = no_node;
    int ulps = 0;  ///< error of the inexact operation
};

template <class S>
S flush_subnormal(S x) {
    return std::fpclassify(x) == FP_SUBNORMAL ? std::copysign(S(0), x) : x;
}

double compute_rounded(TapeOp op, double a, double b, double c, bool is_float) {
    const auto round_result = [&](double x) { return is_float ? static_cast<double>(static_cast<float>(x)) : x; };
    switch (op) {
        // Operations that round
        case TapeOp::add: return round_result(a + b);
        case TapeOp::sub: return round_result(a - b);
        case TapeOp::mul: return round_result(a * b);
        case TapeOp::div: return round_result(a / b);
        case TapeOp::sqrt: return round_result(std::sqrt(a));
        case TapeOp::fma:
            return is_float ? std::fma(static_cast<float>(a), static_cast<float>(b), static_cast<float>(c))
                            : std::fma(a, b, c);
        case TapeOp::convert: return round_result(a);

        // Operations whose result is an operand, or has its size
        case TapeOp::neg: return -a;
        case TapeOp::abs: return std::fabs(a);
        case TapeOp::copysign: return std::copysign(a, b);
        case TapeOp::min: return a < b ? a : b;
        case TapeOp::max: return a > b ? a : b;
        case TapeOp::select: return a != 0 ? b : c;

        // Decisions
        case TapeOp::less: return a < b;
        case TapeOp::less_equal: return a <= b;
        case TapeOp::greater: return a > b;
        case TapeOp::greater_equal: return a >= b;
        case TapeOp::logical_and: return a != 0 && b != 0;
        case TapeOp::logical_or: return a != 0 || b != 0;
        case TapeOp::logical_not: return a == 0;
        case TapeOp::any: return a;

        default: return NAN;
    }
}

struct Answer {
    bool hit;
    float t;
};

Answer compute_answer(const CandidateProgram& candidate, const RandomRays<float>& rays, std::size_t ray,
                      std::vector<double>& values) {
    const Tape& tape = candidate.program.tape;
    values.resize(tape.nodes.size());
    for (NodeId i = 0; i < tape.size(); ++i) {
        const TapeNode& node = tape[i];
        const auto operand_value = [&](std::size_t k) {
            return node.operands[k] == no_node ? 0 : values[node.operands[k]];
        };

        double value = 0;
        if (node.op == TapeOp::input) value = rays.input(ray, node.operands[0]);
        else if (node.op == TapeOp::constant) value = node.operands[0];
        else
            value = compute_rounded(node.op, operand_value(0), operand_value(1), operand_value(2),
                                    tape.format_of(i) == binary32);

        // The deviations of the suspected driver
        if (candidate.flushes_subnormals && tape.format_of(i) == binary32)
            value = flush_subnormal(static_cast<float>(value));
        if (i == candidate.inexact_operation)
            for (int k = 0; k < std::abs(candidate.ulps); ++k)
                value = std::nextafter(static_cast<float>(value), candidate.ulps > 0 ? INFINITY : -INFINITY);
        values[i] = value;
    }
    return {values[tape.outputs.hit] != 0, static_cast<float>(values[tape.outputs.t])};
}

class Search {
public:
    Search(const Tape& tape, const RandomRays<float>& rays, const FormAnswers<float>& driver)
        : rays_(rays), driver_(driver), names_(driver_rewriting_names()) {
        original_.tape = tape;
        original_.origins.resize(tape.nodes.size());
        std::iota(original_.origins.begin(), original_.origins.end(), 0);
    }

    void find(DriverDifference& difference) {
        std::vector<unsigned> rewriting_sets(std::size_t{1} << (names_.size() + 1));
        std::iota(rewriting_sets.begin(), rewriting_sets.end(), 0U);
        std::ranges::stable_sort(rewriting_sets, {},
                                 [](unsigned rewriting_set) { return std::popcount(rewriting_set); });

        // From the simplest explanation to the others: rewritings everywhere, rewritings of some operations, and an
        // operation that is not rounded correctly.
        for (const unsigned rewriting_set : rewriting_sets) {
            SitesByRewriting sites;
            if (const auto candidate = rewrite(rewriting_set, nullptr, &sites);
                candidate && explains_all_rays(*candidate))
                return report_minimal(rewriting_set, sites, difference);
        }
        for (const unsigned rewriting_set : rewriting_sets)
            if (std::popcount(rewriting_set) <= 2 && find_partial_rewriting(rewriting_set, difference)) return;
        for (const unsigned rewriting_set : rewriting_sets)
            if (std::popcount(rewriting_set) <= 2 && find_inexact_operation(rewriting_set, difference)) return;
    }

private:
    using SitesByRewriting = std::vector<std::vector<NodeId>>;  ///< sites of each rewriting

    /// The program with the rewritings of a set. Returns nothing if one of the rewritings changes nothing.
    std::optional<CandidateProgram> rewrite(unsigned rewriting_set, const SitesByRewriting* sites,
                                            SitesByRewriting* changed) const {
        CandidateProgram candidate{.program = original_, .flushes_subnormals = (rewriting_set >> names_.size()) != 0};
        for (std::size_t k = 0; k < names_.size(); ++k) {
            std::vector<NodeId> changed_sites;
            if ((rewriting_set >> k & 1U) != 0) {
                candidate.program =
                    rewrite_as_driver(candidate.program, k, sites ? &(*sites)[k] : nullptr, changed_sites);
                if (changed_sites.empty()) return {};
            }
            if (changed) changed->push_back(changed_sites);
        }
        return candidate;
    }
    bool has_drivers_bits(const CandidateProgram& candidate, std::size_t ray) {
        const Answer answer = compute_answer(candidate, rays_, ray, values_);
        return FormAnswers<float>::are_same(answer.hit, answer.t, driver_.hit[ray] != 0, driver_.t[ray]);
    }
    bool explains_all_rays(const CandidateProgram& candidate) {
        for (std::size_t i = 0; i < ray_count; ++i)
            if (!has_drivers_bits(candidate, i)) return false;
        return true;
    }
    /// Tries the rewritings of a set at some of the operations only, beginning with few operations. Returns true if a
    /// subset explains all rays.
    bool find_partial_rewriting(unsigned rewriting_set, DriverDifference& difference) {
        SitesByRewriting all_sites;
        if (!rewrite(rewriting_set, nullptr, &all_sites)) return false;
        std::vector<std::pair<std::size_t, NodeId>> sites;
        for (std::size_t k = 0; k < all_sites.size(); ++k)
            for (const NodeId i : all_sites[k]) sites.emplace_back(k, i);
        if (sites.size() > max_sites) return false;

        // Tries the subsets, the small ones first.
        std::vector<unsigned> masks(std::size_t{1} << sites.size());
        std::iota(masks.begin(), masks.end(), 0U);
        std::ranges::stable_sort(masks, {}, [](unsigned mask) { return std::popcount(mask); });
        for (const unsigned mask : masks) {
            SitesByRewriting subset(all_sites.size());
            for (std::size_t j = 0; j < sites.size(); ++j)
                if ((mask >> j & 1U) != 0) subset[sites[j].first].push_back(sites[j].second);
            const auto candidate = rewrite(rewriting_set, &subset, nullptr);
            if (!candidate || !explains_all_rays(*candidate)) continue;
            report_minimal(rewriting_set, subset, difference);
            return true;
        }
        return false;
    }
    /// Reports the rewritings, without every operation that does not have to be rewritten.
    void report_minimal(unsigned rewriting_set, SitesByRewriting sites, DriverDifference& difference) {
        for (std::size_t k = 0; k < names_.size(); ++k)
            for (std::size_t j = sites[k].size(); j-- > 0 && sites[k].size() > 1;) {
                SitesByRewriting fewer_sites = sites;
                fewer_sites[k].erase(fewer_sites[k].begin() + static_cast<std::ptrdiff_t>(j));
                if (const auto candidate = rewrite(rewriting_set, &fewer_sites, nullptr);
                    candidate && explains_all_rays(*candidate))
                    sites = fewer_sites;
            }
        for (std::size_t k = 0; k < names_.size(); ++k)
            if (!sites[k].empty()) difference.rewritings.push_back({names_[k], sites[k]});
        if (rewriting_set >> names_.size() != 0) difference.rewritings.push_back({"makes subnormal numbers 0", {}});
    }
    /// Tries each quotient or root as an operation whose result has an error of some units in the last place. Returns
    /// true if one of them explains all rays.
    bool find_inexact_operation(unsigned rewriting_set, DriverDifference& difference) {
        SitesByRewriting sites;
        auto candidate = rewrite(rewriting_set, nullptr, &sites);
        if (!candidate) return false;
        const Tape& tape = candidate->program.tape;
        for (NodeId i = 0; i < tape.size(); ++i) {
            if (tape[i].op != TapeOp::div && tape[i].op != TapeOp::sqrt) continue;
            candidate->inexact_operation = i;
            const auto largest_ulps = find_largest_ulps(*candidate);
            if (!largest_ulps) continue;
            for (std::size_t k = 0; k < names_.size(); ++k)
                if (!sites[k].empty()) difference.rewritings.push_back({names_[k], sites[k]});
            difference.inexact_operation = candidate->program.origins[i];
            difference.ulps = *largest_ulps;
            return true;
        }
        return false;
    }
    /// Finds the largest error that the inexact operation needs on any ray; empty if no error explains some ray.
    std::optional<int> find_largest_ulps(CandidateProgram& candidate) {
        int largest_ulps = 0;
        for (std::size_t ray = 0; ray < ray_count; ++ray) {
            const int ulps = find_least_ulps(candidate, ray);
            if (ulps > max_ulps) return std::nullopt;
            largest_ulps = std::max(largest_ulps, ulps);
        }
        return largest_ulps;
    }
    /// Finds the least error of the inexact operation that gives the driver's bits; more than `max_ulps` if no error
    /// does.
    int find_least_ulps(CandidateProgram& candidate, std::size_t ray) {
        for (int magnitude = 0; magnitude <= max_ulps; ++magnitude)
            for (const int sign : {1, -1}) {
                candidate.ulps = sign * magnitude;
                if (has_drivers_bits(candidate, ray)) return magnitude;
            }
        return max_ulps + 1;
    }

    const RandomRays<float>& rays_;
    const FormAnswers<float>& driver_;
    std::vector<std::string> names_;
    DerivedTape original_;
    std::vector<double> values_;
};

}  // namespace

NodeId DriverDifference::first_changed() const {
    NodeId least = inexact_operation;
    for (const DriverRewriting& r : rewritings)
        for (const NodeId i : r.sites)
            if (least == no_node || i < least) least = i;
    return least;
}

DriverDifference find_driver_difference(const Intersector& driver, const Intersector& program_form) {
    const RandomRays<float> rays(program_form.shape, ray_count, driver.info->direction == intersect::Direction::unit);
    const FormAnswers<float> driver_answers = rays.answers(driver.native32),
                             program_answers = rays.answers(program_form.native32);
    DriverDifference difference{.ray_count = ray_count, .differing_ray_count = 0, .rewritings = {}};
    for (std::size_t i = 0; i < ray_count; ++i)
        difference.differing_ray_count += driver_answers.are_same(program_answers, i) ? 0 : 1;
    if (difference.differing_ray_count > 0)
        Search(record_tape(program_form, *find_format("f32")), rays, driver_answers).find(difference);
    return difference;
}

}  // namespace lostbits::measure::tape
