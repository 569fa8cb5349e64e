#include "measure/answer/answers.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <optional>

#include "intersect/external/contract.hpp"
#include "intersect/process/parallel.hpp"
#include "intersect/sdf/march_loop.hpp"
#include "intersect/simd/packed.hpp"
#include "intersect/simd/packed_many.hpp"
#include "intersect/table/in_range.hpp"
#include "intersect/table/union_field.hpp"
#include "measure/answer/chunk.hpp"
#include "shapes/lift.hpp"

namespace lostbits::measure::answer {

using culling::SphereIndex;
using intersect::Target;
using intersect::simd::PrimitiveArrays;
using intersect::table::HitBatch;
using intersect::table::Intersector;
using intersect::table::RayBatch;
using scene::rays::RayBlock;
using truth::FormatInputs;

namespace {

/// Tests each ray against the primitive that it is paired with. Neighbouring rays with the same primitive share one
/// call.
template <class S, class Kernel>
void test_pairs(const Kernel& kernel, RayChunk<S>& chunk, const FormatInputs& in, Answers& answers) {
    in.stop.check();
    const auto are_same_primitive = [primitives = in.primitives.listed_primitives()](std::size_t a, std::size_t b) {
        return std::ranges::equal(primitives[a].shape_numbers(), primitives[b].shape_numbers()) &&
               primitives[a].transform == primitives[b].transform;
    };
    for (std::size_t i = 0, end = 0; i < chunk.count(); i = end) {
        const std::size_t first = chunk.begin() + i;
        for (end = i + 1; end < chunk.count() && are_same_primitive(first, chunk.begin() + end);) ++end;
        const Primitive<S> primitive = lift_primitive<S>(in.primitives[first]);
        kernel(chunk.batch(i, end), Target<S>(primitive), chunk.hits(i, end));
        for (std::size_t k = i; k < end; ++k) {
            const std::size_t ray_index = chunk.begin() + k;
            const HitBatch<S> hits = chunk.hits();
            if (hits.hit[k] != 0) keep_nearest(hits.t[k], ray_index, static_cast<std::int32_t>(ray_index), answers);
        }
    }
}

/// Tests each ray against the primitive that it is paired with, all in one call. For external kernels, where each call
/// may cost a message to another process.
template <class S, class Kernel>
void test_pairs_in_one_call(const Kernel& kernel, RayChunk<S>& chunk, const FormatInputs& in, Answers& answers) {
    in.stop.check();
    std::vector<Primitive<S>> paired_primitives;
    for (std::size_t k = 0; k < chunk.count(); ++k)
        paired_primitives.push_back(lift_primitive<S>(in.primitives[chunk.begin() + k]));
    const HitBatch<S> hits = chunk.hits();
    kernel(chunk.batch(), Target<S>(std::span<const Primitive<S>>(paired_primitives)), hits);
    for (std::size_t k = 0; k < chunk.count(); ++k) {
        const std::size_t ray_index = chunk.begin() + k;
        if (hits.hit[k] != 0) keep_nearest(hits.t[k], ray_index, static_cast<std::int32_t>(ray_index), answers);
    }
}

/// Tests one chunk of rays against all primitives and keeps the nearest hit.
template <class S, class Kernel>
void find_nearest_hits(const Kernel& kernel, RayChunk<S>& chunk, const FormatInputs& in, Answers& answers) {
    for (std::size_t s = 0; s < in.primitives.size(); ++s) {
        in.stop.check();
        const Primitive<S> primitive = lift_primitive<S>(in.primitives[s]);
        kernel(chunk.batch(), Target<S>(primitive), chunk.hits());
        chunk.keep_nearest(s);
    }
    chunk.write_to(answers);
}

/// Kernel of one ray, in its range, against many spheres in the format's own arithmetic. It fills `t` and `hit`, one
/// for each sphere.
template <class S>
using OneToMany = std::function<void(const Ray<S>&, const Range<S>&, const PrimitiveArrays<S>&, std::span<S>,
                                     std::span<std::uint8_t>)>;

/// Calls `on_hit(c)` for every c with hit[c] != 0, in order. Hits are rare, so eight bytes are tested together.
template <class OnHit>
void for_each_hit(std::span<const std::uint8_t> hit, const OnHit& on_hit) {
    std::size_t c = 0;
    for (; c + 8 <= hit.size(); c += 8) {
        std::uint64_t eight;
        std::memcpy(&eight, hit.data() + c, 8);
        if (eight == 0) continue;
        for (std::size_t k = c; k < c + 8; ++k) {
            if (hit[k] != 0) on_hit(k);
        }
    }
    for (; c < hit.size(); ++c) {
        if (hit[c] != 0) on_hit(c);
    }
}

/// True if one of the hits comes before the hit at `best`, which is not NaN. For most spheres there is no such hit.
template <class S>
bool has_nearer_hit(std::span<const S> t, std::span<const std::uint8_t> hit, S best) {
    unsigned is_nearer = 0;
    for (std::size_t c = 0; c < t.size(); ++c) is_nearer |= static_cast<unsigned>(t[c] < best) & hit[c];
    return is_nearer != 0;
}

/// Tests rays against the spheres of one page, in the order of the spheres. Skips the spheres that a ray cannot meet,
/// and finds the same hits as `find_nearest_hits`.
template <class S>
class PageTester {
public:
    PageTester(const OneToMany<S>& kernel, const RayBlock& rays, const FormatInputs& in, Answers& answers)
        : kernel_(kernel), rays_(rays), in_(in), answers_(answers) {}

    void test_page(std::size_t page, std::size_t first, std::size_t last) {
        const std::size_t begin = page * SphereIndex::spheres_per_page;
        std::optional<std::array<std::span<const S>, 4>> columns;  // made for the first ray that needs them
        for (std::size_t ray_index = first; ray_index < last; ++ray_index) {
            const Ray<double> ray = rays_[ray_index];
            in_.index->find_runs(SphereIndex::UnitRay(ray), page, grain_, runs_);
            if (runs_.empty()) continue;
            in_.stop.check();  // a ray may test all spheres of the page, in software
            if (!columns)
                columns = in_.primitives.columns<S>(
                    begin, std::min(SphereIndex::spheres_per_page, in_.primitives.size() - begin), buffers_);
            for (const auto& [run_begin, run_end] : runs_) {
                const auto column_part = [&, run_begin = run_begin, run_end = run_end](std::size_t k) {
                    return (*columns)[k].subspan(run_begin - begin,
                                                 run_end - run_begin);  // clang before 16 captures no bindings
                };
                test_run(ray, ray_index, run_begin, {column_part(0), column_part(1), column_part(2), column_part(3)});
            }
        }
    }

private:
    void test_run(const Ray<double>& ray, std::size_t ray_index, std::size_t first_sphere,
                  const PrimitiveArrays<S>& spheres) {
        t_.resize(spheres.size());
        hit_.resize(spheres.size());
        const Range<double> range = rays_.range(ray_index);
        kernel_(lift_ray<S>(ray), {static_cast<S>(range.tmin), static_cast<S>(range.tmax), range.open_ends}, spheres,
                t_, hit_);
        const bool has_best = answers_.hit[ray_index] != 0 && !std::isnan(answers_.t[ray_index]);
        if (has_best && !has_nearer_hit<S>(t_, hit_, static_cast<S>(answers_.t[ray_index]))) return;
        for_each_hit(hit_, [&](std::size_t c) {
            keep_nearest(t_[c], ray_index, static_cast<std::int32_t>(first_sphere + c), answers_);
        });
    }

    const OneToMany<S>& kernel_;
    const RayBlock& rays_;
    const FormatInputs& in_;
    Answers& answers_;
    /// Arithmetic in software is slower than the test whether a sphere is a candidate.
    SphereIndex::Grain grain_ = in_.format.is_emulated() ? SphereIndex::Grain::spheres : SphereIndex::Grain::blocks;
    std::array<std::vector<S>, 4> buffers_;
    std::vector<SphereIndex::Run> runs_;
    std::vector<S> t_;
    std::vector<std::uint8_t> hit_;
};

/// Tests the spheres page by page: the numbers of a page stay in the second-level cache while many rays use them.
template <class S>
void test_pages(const OneToMany<S>& kernel, const RayBlock& rays, const FormatInputs& in, Answers& answers) {
    constexpr std::size_t rays_per_part = 4096;
    const std::size_t parts = (rays.size() + rays_per_part - 1) / rays_per_part;
    intersect::process::in_parallel(std::size_t{0}, parts, [&](std::size_t part) {
        PageTester<S> tester(kernel, rays, in, answers);
        for (std::size_t page = 0; page < in.index->page_count(); ++page)
            tester.test_page(page, part * rays_per_part, std::min((part + 1) * rays_per_part, rays.size()));
    });
}

/// Makes a kernel of one ray and many spheres from a kernel of many rays and one primitive.
template <class S, class Kernel>
OneToMany<S> kernel_per_sphere(const Intersector& form, const Kernel& kernel) {
    return [&form, kernel](const Ray<S>& ray, const Range<S>& range, const PrimitiveArrays<S>& spheres, std::span<S> t,
                           std::span<std::uint8_t> hit) {
        const auto span_of_one = [](const S& x) { return std::span(&x, 1); };
        const Vec<S>&o = ray.origin, &d = ray.direction;
        S near{}, far{};
        Primitive<S> primitive(form.shape);

        RayBatch<S> rays{.ox = span_of_one(o.x),
                         .oy = span_of_one(o.y),
                         .oz = span_of_one(o.z),
                         .dx = span_of_one(d.x),
                         .dy = span_of_one(d.y),
                         .dz = span_of_one(d.z)};
        if (!range.is_whole()) {
            rays.tmax = span_of_one(range.tmax);
            rays.tmin = span_of_one(range.tmin);
            rays.open_ends = range.open_ends;
        }

        for (std::size_t i = 0; i < spheres.size(); ++i) {
            for (std::size_t k = 0; k < primitive.shape_numbers().size(); ++k)
                primitive.numbers[k] = spheres.numbers[k][i];
            const HitBatch<S> hits{t.subspan(i, 1), std::span(&near, 1), std::span(&far, 1), hit.subspan(i, 1)};
            kernel(rays, Target<S>(primitive), hits);
            intersect::table::limit_batch_to_range(*form.info, form.shape, rays, hits);
        }
    };
}

/// Wraps the kernel for many spheres, which answers only the first root of each; null where rays have ranges, because
/// these may need the second root.
template <class S, class Kernel>
OneToMany<S> kernel_for_many(const Kernel& kernel, const RayBlock& rays) {
    if (!kernel || rays.have_ranges()) return nullptr;
    return [kernel](const Ray<S>& ray, const Range<S>&, const auto&... rest) { kernel(ray, rest...); };
}

/// Finds the nearest hit over all spheres that a ray can meet. A row that is not in the table has no kernel for many
/// spheres.
void test_spheres(const intersect::table::Intersector& form, const RayBlock& rays, const FormatInputs& in,
                  Answers& answers) {
    const intersect::simd::ManyFormKernels many = intersect::simd::many_kernels(form);
    switch (in.format.engine) {
        case Format::Engine::native32: {
            const auto many_kernel = kernel_for_many<float>(many.f32, rays);
            return test_pages<float>(many_kernel ? many_kernel : kernel_per_sphere<float>(form, form.native32), rays,
                                     in, answers);
        }
        case Format::Engine::native64: {
            const auto many_kernel = kernel_for_many<double>(many.f64, rays);
            return test_pages<double>(many_kernel ? many_kernel : kernel_per_sphere<double>(form, form.native64), rays,
                                      in, answers);
        }
        case Format::Engine::rounded: break;
    }
    const auto rounded = [&](const auto&... a) { form.rounded(in.format.parameters, a...); };
    test_pages<double>(kernel_per_sphere<double>(form, rounded), rays, in, answers);
}

/// Tests every ray against its candidates.
template <class S, class Kernel>
void test_candidates(const Kernel& kernel, const RayBlock& rays, const FormatInputs& in, bool in_one_call,
                     Answers& answers) {
    answers.claimed.resize(in.candidates->pair_count());
    // Pairs of one part stay in a cache. Far from a large mesh a ray has all of its triangles as candidates.
    constexpr std::size_t max_rays = 512, min_rays = 4, max_pairs = 1 << 18;
    const std::size_t pairs_per_ray = in.candidates->pair_count() / std::max(rays.size(), std::size_t{1}) + 1;
    const std::size_t rays_per_part =
        in_one_call ? std::max(rays.size(), std::size_t{1}) : std::clamp(max_pairs / pairs_per_ray, min_rays, max_rays);
    const std::size_t parts = (rays.size() + rays_per_part - 1) / rays_per_part;
    intersect::process::in_parallel(std::size_t{0}, parts, [&](std::size_t part) {
        PairColumns<S> pairs(rays, in, part * rays_per_part, std::min((part + 1) * rays_per_part, rays.size()));
        if (in_one_call) pairs.evaluate_at_once(kernel);
        else pairs.evaluate_one_by_one(kernel);
        pairs.write_to(answers);
    });
}

/// Returns the index of the primitive whose surface is nearest to the point at t, in double precision. A distance field
/// does not say which primitive was hit.
std::int32_t nearest_primitive(const Ray<double>& ray, double t, std::span<const Primitive<double>> primitives) {
    const Vec<double> p = intersect::sdf::point_on_ray(ray, t);
    const auto distance = [&p](const Primitive<double>& primitive) {
        return std::fabs(intersect::table::distance(primitive, p));
    };
    return static_cast<std::int32_t>(std::ranges::min_element(primitives, {}, distance) - primitives.begin());
}

/// Marches one chunk of rays through the field of all primitives.
template <class S, class Kernel>
void march_chunk(const Kernel& kernel, RayChunk<S>& chunk, const RayBlock& rays, const FormatInputs& in,
                 Answers& answers) {
    in.stop.check();
    HitBatch<S> hits = chunk.hits();
    hits.march = std::span(answers.march).subspan(chunk.begin(), chunk.count());
    const intersect::LiftedTarget<S> target(Target<double>(in.primitives.listed_primitives(), in.march.value()));
    kernel(chunk.batch(), target.get(), hits);
    for (std::size_t i = 0; i < chunk.count(); ++i) {
        if (hits.hit[i] == 0) continue;
        const std::size_t ray_index = chunk.begin() + i;
        keep_nearest(
            hits.t[i], ray_index,
            nearest_primitive(rays[ray_index], static_cast<double>(hits.t[i]), in.primitives.listed_primitives()),
            answers);
    }
}

}  // namespace

Answers evaluate(const intersect::table::Intersector& form, const FormatInputs& inputs) {
    const RayBlock& rays = inputs.rays_for(*form.info);
    const std::size_t n = rays.size();
    const bool marches = !is_primitive(form.shape),
               takes_batches = !intersect::external::find_foreign_forms(form).empty();
    Answers answers{std::vector<double>(n), std::vector<std::uint8_t>(n), std::vector<std::int32_t>(n, -1)};

    // Kernels of packs keep no records of the marches in their lanes.
    const intersect::simd::PackedFormKernels native =
        marches ? intersect::simd::PackedFormKernels{form.info, form.native32, form.native64}
                : intersect::simd::packed_kernels(form);
    if (marches) answers.march.resize(n);

    // The spheres of an index are tested page by page.
    if (inputs.index && form.shapes() == scene::sphere::Sphereflake::shape) {
        test_spheres(form, rays, inputs, answers);
        return answers;
    }

    // Runs a kernel over all rays: with the candidates of each, in pairs with primitives, or against all primitives.
    const auto run = [&]<class S>(const auto& whole_ray) {
        const auto kernel = [&](const RayBatch<S>& batch, const Target<S>& target, const HitBatch<S>& hits) {
            whole_ray(batch, target, hits);
            const Intersector& shape_form = marches ? form : form.form_for(target.primitives.front().shape);
            intersect::table::limit_batch_to_range(*shape_form.info, shape_form.shape, batch, hits);
        };
        if (inputs.candidates && !marches) return test_candidates<S>(kernel, rays, inputs, takes_batches, answers);
        RayChunk<S> chunk(rays);
        for (std::size_t begin = 0; begin < n; begin += RayChunk<S>::capacity) {
            chunk.move_to(begin);
            if (marches) march_chunk<S>(kernel, chunk, rays, inputs, answers);
            else if (inputs.is_paired && takes_batches) test_pairs_in_one_call<S>(kernel, chunk, inputs, answers);
            else if (inputs.is_paired) test_pairs<S>(kernel, chunk, inputs, answers);
            else find_nearest_hits<S>(kernel, chunk, inputs, answers);
        }
    };

    switch (inputs.format.engine) {
        case Format::Engine::native32: run.template operator()<float>(native.f32); break;
        case Format::Engine::native64: run.template operator()<double>(native.f64); break;
        case Format::Engine::rounded:
            run.template operator()<double>([&](const auto&... a) { form.rounded(inputs.format.parameters, a...); });
            break;
    }
    return answers;
}

}  // namespace lostbits::measure::answer
