#include "measure/columns/columns.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <initializer_list>

#include "intersect/process/parallel.hpp"
#include "intersect/simd/of_width.hpp"
#include "measure/truth/missing.hpp"

namespace lostbits::measure::columns {

using intersect::Convention;
using intersect::Direction;
using intersect::simd::Isa;
using truth::missing;

namespace {

/// Returns the kernels of a width with registers. Each function that makes kernels is itself compiled with the
/// instructions of its width and would fault on a processor without them, so kernels are made on the first use of their
/// width.
const RawKernels& kernels_of_width(Isa isa) {
    static constexpr intersect::simd::FunctionOfWidth<RawKernels()> make = LOSTBITS_OF_EACH_WIDTH(raw_kernels);
    return intersect::simd::with_width(isa, []<Isa width>() -> const RawKernels& {
        static const RawKernels kernels = make.at(width)();
        return kernels;
    });
}

/// Returns the kernels of the current width; null for `scalar`, where the scalar functions handle every ray.
const RawKernels* current_kernels() {
    const Isa isa = intersect::simd::current_isa();
    return isa == Isa::scalar ? nullptr : &kernels_of_width(isa);
}

/// Kernels for results that are the same in every width and have no scalar function.
const RawKernels& register_kernels() {
    return kernels_of_width(intersect::simd::register_isa(intersect::simd::current_isa()));
}

void leave_all_to_scalar(std::span<const double> answers, std::initializer_list<double*> columns,
                         std::vector<std::uint32_t>& unhandled) {
    for (double* const column : columns) {
        if (column) std::fill_n(column, answers.size(), missing);
    }
    for (std::size_t i = 0; i < answers.size(); ++i) {
        if (!std::isnan(answers[i])) unhandled.push_back(static_cast<std::uint32_t>(i));
    }
}

/// Does the same as `TrueLengths::set`, for lengths that doubles hold: hi is 0 for a miss, and normal for a hit.
void copy_lengths(const truth::RayTruths::Lengths& from, std::size_t begin, std::size_t end, TrueLengths& to) {
    constexpr std::uint64_t exponent = std::uint64_t{0x7ff} << 52;
    for (std::size_t i = begin; i < end; ++i) {
        const double hi = from.hi[i], lo = from.lo[i];
        const double binade = std::bit_cast<double>(std::bit_cast<std::uint64_t>(hi) & exponent);
        const bool is_held =
            binade >= 0x1p-400 && binade <= 0x1p+400 && (lo == 0 || std::fabs(lo) >= binade * 0x1p-200);
        to.hi[i] = is_held ? hi : missing;
        to.lo[i] = lo;
        // If hi is a power of two and lo points towards zero, t* lies in the binade below.
        to.inverse_binade[i] = (hi == binade && lo < 0 ? 2.0 : 1.0) / binade;
    }
}

/// Buffer for the indices of the rays that a kernel leaves in one block; `append` adds them to `unhandled`.
constexpr std::size_t rays_per_block = 512;  // columns of primitives stay in the first-level cache
struct BlockIndices {
    std::array<std::uint32_t, rays_per_block> indices;

    [[nodiscard]] RawUnhandledRays raw() { return {indices.data(), 0}; }
    void append(const RawUnhandledRays& raw, std::size_t begin, std::vector<std::uint32_t>& unhandled) const {
        for (std::size_t k = 0; k < raw.count; ++k) unhandled.push_back(static_cast<std::uint32_t>(begin + indices[k]));
    }
};

}  // namespace

void TrueLengths::resize(std::size_t ray_count) {
    decision.resize(ray_count);
    primitive.resize(ray_count);
    for (auto* column : {&hi, &lo, &inverse_binade}) column->resize(ray_count);
}

void TrueLengths::set(std::size_t i, const truth::Truth& ray_truth, Direction direction_kind) {
    const truth::CertifiedNumber& x = direction_kind == Direction::unit ? ray_truth.distance : ray_truth.t;
    decision[i] = ray_truth.decision;
    primitive[i] = ray_truth.primitive;
    hi[i] = missing;
    if (!ray_truth.is_hit() || x.is_zero() || std::abs(x.exponent) > 400) return;
    if (x.lo != 0 && std::fabs(x.lo) < 0x1p-200) return;
    const int e = static_cast<int>(x.exponent);
    hi[i] = std::ldexp(x.hi, e);
    lo[i] = std::ldexp(x.lo, e);
    inverse_binade[i] = std::ldexp(1.0, -static_cast<int>(x.floor_log2()));
}

const BandTruthColumns::CachedLengths* BandTruthColumns::cached_lengths(Convention convention,
                                                                        Direction direction_kind) const {
    const auto found = std::ranges::find_if(cached_, [&](const CachedLengths& f) {
        return f.convention == convention && f.direction_kind == direction_kind;
    });
    return found == cached_.end() ? nullptr : &*found;
}

const TrueLengths& BandTruthColumns::compute_lengths(Convention convention, Direction direction_kind) {
    if (const CachedLengths* const found = cached_lengths(convention, direction_kind)) return found->lengths;
    const truth::RayTruths& truths = band_->truths();
    TrueLengths& columns = cached_.emplace_back(CachedLengths{convention, direction_kind, {}}).lengths;
    columns.decision = truths.decision;
    columns.primitive = truths.primitive;
    for (auto* column : {&columns.hi, &columns.lo, &columns.inverse_binade}) column->resize(truths.size());
    intersect::process::in_parallel(tbb::blocked_range<std::size_t>(0, truths.size(), 4096), [&](const auto& range) {
        copy_lengths(direction_kind == Direction::unit ? truths.distance : truths.t, range.begin(), range.end(),
                     columns);
    });
    for (const auto& [i, ray_truth] : truths.complete_truths) columns.set(i, ray_truth, direction_kind);
    if (convention == Convention{}) return columns;
    intersect::process::in_parallel(tbb::blocked_range<std::size_t>(0, truths.size(), 256), [&](const auto& range) {
        band_->stop().check();
        for (std::size_t i = range.begin(); i < range.end(); ++i)
            if (band_->may_differ(i, convention)) columns.set(i, band_->truth(i, convention), direction_kind);
    });
    return columns;
}

double compute_error_columns(std::span<const double> answers, const TrueLengths& true_lengths,
                             const FloatFormat& format, const ErrorColumns& out,
                             std::vector<std::uint32_t>& unhandled) {
    const RawKernels* const raw_kernels = current_kernels();
    if (!raw_kernels) {
        leave_all_to_scalar(answers, {out.ulp, out.lost, out.correct, out.relative, out.absolute}, unhandled);
        return 0;
    }

    const auto column_from = [](double* column, std::size_t begin) { return column ? column + begin : nullptr; };
    double largest = 0;
    for (std::size_t begin = 0; begin < answers.size(); begin += rays_per_block) {
        BlockIndices block_indices;
        RawErrors batch{
            .size = std::min(rays_per_block, answers.size() - begin),
            .in = {answers.data() + begin, true_lengths.hi.data() + begin, true_lengths.lo.data() + begin,
                   true_lengths.inverse_binade.data() + begin},
            .out = {column_from(out.ulp, begin), column_from(out.lost, begin), column_from(out.correct, begin),
                    column_from(out.relative, begin), column_from(out.absolute, begin)},
            .precision = static_cast<double>(format.precision),
            .ulps_of_binade = std::ldexp(1.0, format.precision - 1),
            .max_inverse_binade = std::ldexp(1.0, -format.emin),
            .largest = largest,
            .unhandled = block_indices.raw()};

        raw_kernels->errors(batch);
        largest = batch.largest;
        block_indices.append(batch.unhandled, begin, unhandled);
    }
    return largest;
}

void compute_residual_columns(std::span<const double> answers, const HitPoints& points, double* out,
                              std::vector<std::uint32_t>& unhandled) {
    const RawKernels* const raw_kernels = current_kernels();
    const Primitive<double> first = points.primitives[0];
    const Shape shape = first.shape;
    const auto has_shape = [shape](const Primitive<double>& primitive) {
        return primitive.shape == shape && !primitive.transform;
    };

    // A kernel takes primitives of one shape without matrices.
    const bool has_one_shape =
        std::ranges::all_of(points.primitives.listed_primitives(), has_shape) &&
        (!points.primitives.flake() || shape == scene::sphere::Sphereflake::shape) &&
        (!points.primitives.mesh() || (shape == scene::triangle::Mesh::shape && !first.transform));

    void (*const residuals)(RawResiduals&) =
        raw_kernels ? raw_kernels->residuals[static_cast<std::size_t>(shape)] : nullptr;
    if (!residuals || points.engine == Format::Engine::rounded || !has_one_shape) {
        leave_all_to_scalar(answers, {out}, unhandled);
        return;
    }

    // The numbers of the primitives, one column each. A single primitive is loaded once.
    const std::size_t number_count = first.shape_numbers().size();
    std::array<std::array<double, rays_per_block>, max_number_count> numbers;
    const auto load_primitive = [&](std::size_t i, std::size_t primitive) {
        const Primitive<double> current = points.primitives[primitive];
        for (std::size_t k = 0; k < number_count; ++k) numbers[k][i] = current.numbers[k];
    };
    if (points.primitives.size() == 1) {
        for (std::size_t i = 0; i < rays_per_block; ++i) load_primitive(i, 0);
    }

    const std::span<const Primitive<double>> listed = points.primitives.listed_primitives();
    const scene::rays::RayBlock& rays = points.rays;
    for (std::size_t begin = 0; begin < answers.size(); begin += rays_per_block) {
        const std::size_t size = std::min(rays_per_block, answers.size() - begin);

        // Loads the primitive of each ray of the block.
        for (std::size_t i = 0; points.primitives.size() > 1 && i < size; ++i) {
            const auto primitive = static_cast<std::size_t>(std::max(0, points.primitive_indices[begin + i]));
            if (primitive < listed.size()) {
                for (std::size_t k = 0; k < max_number_count; ++k) numbers[k][i] = listed[primitive].numbers[k];
            } else {
                load_primitive(i, primitive);
            }
        }

        BlockIndices block_indices;
        RawResiduals batch{
            .size = size,
            .in = {answers.data() + begin, rays.ox.data() + begin, rays.oy.data() + begin, rays.oz.data() + begin,
                   rays.dx.data() + begin, rays.dy.data() + begin, rays.dz.data() + begin},
            .out = out + begin,
            .binary32 = points.engine == Format::Engine::native32,
            .unhandled = block_indices.raw()};
        for (std::size_t k = 0; k < max_number_count; ++k) batch.in[RawResiduals::primitive + k] = numbers[k].data();

        residuals(batch);
        block_indices.append(batch.unhandled, begin, unhandled);
    }
}

void add_absolute_values(std::span<const double> values, RawAbsoluteSums& sums) {
    sums.size = values.size();
    sums.values = values.data();
    register_kernels().absolute_sums(sums);
}

void keep_nearest(const RawHits<float>& hits) { register_kernels().hits32(hits); }
void keep_nearest(const RawHits<double>& hits) { register_kernels().hits64(hits); }

}  // namespace lostbits::measure::columns
