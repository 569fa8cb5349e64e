// Finds the truth of many rays at once, as columns: packs prove the truth of most rays, and the others are proved ray
// by ray.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "measure/culling/culling.hpp"
#include "measure/stages/raw_stages.hpp"
#include "measure/truth/truth.hpp"
#include "number/real.hpp"
#include "scene/rays/rays.hpp"

namespace lostbits::measure::truth {

/// Problems as a structure of arrays: rays, each with a primitive of the same shape. A column has `size` numbers, or
/// one number for all rays. S is float, for which the cheapest stage exists, or double.
template <class S>
struct ProblemColumns {
    std::size_t size = 0;
    std::array<std::span<const S>, 6> ray;  ///< o.x o.y o.z d.x d.y d.z
    Shape shape{};                          ///< the shape of every primitive
    /// Numbers as in `Primitive::numbers`, empty beyond those of the shape; then the numbers of the matrix, if `matrix`
    /// is transformed.
    std::array<std::span<const S>, max_primitive_number_count> primitive;
    std::span<const S> tmin = {}, tmax = {};  ///< the ranges of the rays; empty: from 0, without end
    OpenEnds open_ends = {};
    stages::MatrixKind matrix = {};
    /// Second words: the exact numbers minus those above, to 2^-104 of these. All are empty if the numbers above are
    /// exact.
    std::array<std::span<const S>, 6> ray_low = {};
    std::array<std::span<const S>, max_primitive_number_count> primitive_low = {};
};

/// True if the truth by a convention may differ from the truth for the closed primitive, because the ray touches it or
/// starts on it.
[[nodiscard]] constexpr bool convention_matters(const intersect::Convention& convention, bool touches,
                                                bool on_surface) {
    return (convention.touching == intersect::Touching::miss && touches) ||
           (convention.at_origin == intersect::AtOrigin::miss && on_surface);
}

/// Convention with only the properties that `convention_matters` reads.
[[nodiscard]] constexpr intersect::Convention plain_part(const intersect::Convention& convention) {
    using intersect::AtOrigin;
    return {convention.touching, convention.at_origin == AtOrigin::miss ? AtOrigin::miss : AtOrigin::hit};
}
/// Key of ray i with the properties in `plain_part` of the convention.
[[nodiscard]] inline std::size_t convention_key(std::size_t i, const intersect::Convention& convention) {
    return 4 * i + (convention.touching == intersect::Touching::miss ? 2 : 0) +
           (convention.at_origin == intersect::AtOrigin::miss ? 1 : 0);
}

/// Accuracy of a length that a measurement needs.
enum class Tightness {
    ulps_of_binary32,  ///< to 2^-33 of itself: an error in ulps of at most 24 bits is known to 2^-8
    certified          ///< to `certified_tightness`, as by `find_truth`
};

/// Convention, kind of length, accuracy and limit by which truths are found.
struct TruthOptions {
    intersect::Convention convention = {};
    Length length = Length::parameter;
    Tightness tightness = Tightness::certified;
    ProofLimit limit = {};
};

/// Number of rays that each stage settled; the stage for ties also uses two words.
struct StageCounts {
    std::uint64_t binary64 = 0, double_double = 0, ball = 0, interval = 0;

    StageCounts& operator+=(const StageCounts& b) {
        binary64 += b.binary64;
        double_double += b.double_double;
        ball += b.ball;
        interval += b.interval;
        return *this;
    }
    /// Counts a truth that no pack settled, by the precision that its proof took.
    void count_single(const Truth& truth) { ++(truth.proof_bits <= 106 ? ball : interval); }
    [[nodiscard]] std::uint64_t ray_count() const { return binary64 + double_double + ball + interval; }
};

/// Truths of many rays, as a structure of arrays. |t* − (hi + lo)| ≤ bound, and no power of two lies between the ends,
/// so the binade of t* is proved. hi, lo and bound of a miss and of an unresolved ray are 0.
struct TruthColumns {
    std::vector<Truth::Decision> decision;
    std::vector<double> hi, lo, bound;
    /// Truths of the rays that no pack could settle, in rising order of their rays. If |t*| is neither 0 nor within
    /// [2^-900, 2^900], the columns hold NaN and the value is only here.
    std::vector<std::pair<std::size_t, Truth>> single_truths;
    StageCounts stages;

    [[nodiscard]] std::size_t size() const { return decision.size(); }
};

/// Finds the truth of each ray and writes it to `out`, whose memory is reused. `stages` is counted from 0.
void find_truth_columns(const ProblemColumns<float>& problems, const TruthOptions& options, TruthColumns& out);
void find_truth_columns(const ProblemColumns<double>& problems, const TruthOptions& options, TruthColumns& out);

/// Truth of every ray among the primitives that it can meet, by the closed primitive's convention, as a structure of
/// arrays.
class RayTruths {
public:
    /// As in `TruthColumns`; zeros for a miss.
    struct Lengths {
        std::vector<double> hi, lo, bound;
    };
    std::vector<Truth::Decision> decision;
    std::vector<std::int32_t> primitive;            ///< −1 for a miss
    std::vector<std::uint8_t> touches, on_surface;  ///< 1 or 0, as in `Truth`
    Lengths t, distance;
    /// Rays whose truth does not fit into doubles, in rising order: a length is 0 or out of range, or nothing is
    /// proved. Their `t.hi` is NaN.
    std::vector<std::pair<std::size_t, Truth>> complete_truths;

    void resize(std::size_t ray_count);
    [[nodiscard]] std::size_t size() const { return decision.size(); }
    /// Truth of ray i, rebuilt from the columns. Read the columns if they are enough. Its `proof_bits` are at least
    /// 106.
    [[nodiscard]] Truth operator[](std::size_t i) const;
    /// True if the truth of ray i by `convention`, which is not special, may differ from the stored truth.
    [[nodiscard]] bool may_differ(std::size_t i, const intersect::Convention& convention) const {
        return convention_matters(convention, touches[i] != 0, on_surface[i] != 0);
    }
    /// Stores a truth in the columns. Returns false if they cannot hold all of it.
    bool store(std::size_t i, const Truth& truth);
};

/// Rays, and the primitives that each can meet.
template <class S>
struct RaysAndPrimitives {
    const scene::rays::BasicRayBlock<S>& rays;
    const scene::rays::PrimitiveList<S>& primitives;
    /// Finds the primitives that a ray can meet; null: a ray can meet every primitive.
    const culling::PrimitiveIndex* index = nullptr;
    bool is_paired = false;  ///< ray i can meet only primitive i; all primitives are of one shape
};

/// Finds the truth of every ray among its primitives, in parallel: the same decisions, hi and lo as `find_truth`.
/// Returns how many pairs of a ray and a primitive each stage settled.
StageCounts find_truths(const RaysAndPrimitives<double>& problems, ProofLimit limit, RayTruths& out);
/// Uses two machine words for each number. If they do not enclose the numbers of a ray, the later stages settle the
/// ray.
StageCounts find_truths(const RaysAndPrimitives<Real>& problems, ProofLimit limit, RayTruths& out);

}  // namespace lostbits::measure::truth
