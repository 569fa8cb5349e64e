#include "measure/truth/band.hpp"

#include <algorithm>
#include <cmath>

#include "intersect/process/parallel.hpp"
#include "measure/truth/enclose.hpp"
#include "measure/truth/truth_columns.hpp"
#include "measure/truth/unit_direction.hpp"
#include "scene/file/march_table.hpp"
#include "scene/rays/stored_mesh.hpp"

namespace lostbits::measure::truth {

using intersect::AtOrigin;
using intersect::Convention;
using intersect::Facing;
using intersect::Inside;
using intersect::Touching;
using scene::rays::PrimitiveList;
using scene::rays::RayBlock;

namespace {

/// Primitives of ` culler`; without one, those of the group.
PrimitiveList<double> make_shared_primitive_list(const scene::rays::RayGroup& group, const culling::Culler* culler) {
    return culler ? culler->shared_primitives() : scene::rays::primitive_list_of(group);
}

/// True if binary32 holds every number of the group; `primitives` lists its primitives. Every format holds a NaN.
bool fits_binary32(const scene::rays::RayGroup& group, const PrimitiveList<double>& primitives) {
    bool all_fit = !group.mesh || primitives.flake_and_mesh().inputs == scene::file::InputRounding::shared;
    const auto check_number = [&all_fit](double x) {
        all_fit &= static_cast<double>(static_cast<float>(x)) == x || x != x;
        return x;
    };
    for (const auto* numbers : group.rays.numbers()) std::ranges::for_each(*numbers, check_number);
    for (const auto* numbers : {&group.rays.tmin, &group.rays.tmax}) std::ranges::for_each(*numbers, check_number);
    for (const Primitive<double>& primitive : group.primitives)
        static_cast<void>(convert_numbers(primitive, check_number));
    if (group.march) convert_numbers(*group.march, check_number);
    return all_fit;
}

/// True if the format holds every double.
bool holds_binary64(const FloatFormat& format) {
    return format.precision >= binary64.precision && format.emin <= binary64.emin && format.emax >= binary64.emax;
}

/// Rays with directions of length one in the format; the ends of their ranges become distances.
RayBlock normalise_rays(const RayBlock& rays, const FloatFormat& format, intersect::process::StopToken stop) {
    RayBlock unit_rays = rays;
    intersect::process::in_parallel(tbb::blocked_range<std::size_t>(0, rays.size(), 1024), [&](const auto& range) {
        stop.check();
        const auto part_of_column = [&](std::vector<double>& column) {
            return std::span(column).subspan(range.begin(), range.size());
        };
        make_unit({part_of_column(unit_rays.dx), part_of_column(unit_rays.dy), part_of_column(unit_rays.dz)}, format);
    });
    for (auto* const ends : {&unit_rays.tmin, &unit_rays.tmax})
        for (std::size_t i = 0; i < ends->size(); ++i) (*ends)[i] = as_distance((*ends)[i], rays[i].direction, format);
    return unit_rays;
}

}  // namespace

Band::Band(const scene::file::Scene& scene, int y0, int y1, ProofLimit limit, culling::Culler* culler)
    : culler_(culler), scene_(&scene), y0_(y0), scanlines_(y1 - y0), limit_(limit) {
    if (scene.inputs == scene::file::InputRounding::shared) {
        shared_ = scene::rays::make_shared_rays(scene, y0, y1);
        shared_primitives_ =
            culler ? culler->shared_primitives() : PrimitiveList(scene::rays::make_shared_primitives(scene));
    } else {
        ideal_ = scene::rays::make_own_rays(scene, y0, y1);
        ideal_primitives_ = culler ? culler->ideal_primitives() : PrimitiveList(scene.primitives());
    }
    if (scene.march) shared_march_ = scene::file::round_march(*scene.march, binary32);
    find_all_truths();
}

Band::Band(const scene::file::Scene& scene, scene::rays::IdealRayBlock rays, ProofLimit limit)
    : Band(std::move(rays), scene.primitives(), false, limit) {
    scene_ = &scene;
}

Band::Band(scene::rays::IdealRayBlock rays, std::vector<Primitive<Real>> primitives, bool is_paired, ProofLimit limit)
    : y0_(rays.y0),
      scanlines_(rays.y1 - rays.y0),
      limit_(limit),
      is_paired_(is_paired),
      ideal_(std::move(rays)),
      ideal_primitives_(std::move(primitives)) {
    find_all_truths();
}

Band::Band(scene::rays::RayGroup group, ProofLimit limit, culling::Culler* culler)
    : culler_(culler),
      y0_(group.rays.y0),
      scanlines_(group.rays.y1 - group.rays.y0),
      limit_(limit),
      is_paired_(group.is_paired),
      shared_primitives_(make_shared_primitive_list(group, culler)),
      shared_march_(group.march) {
    binary32_holds_all_ = fits_binary32(group, shared_primitives_);
    shared_ = std::move(group.rays);
    find_all_truths();
}

Band::Band(const scene::file::Scene& scene, RayBlock single_ray, culling::Culler& culler, ProofLimit limit)
    : culler_(&culler),
      scanlines_(1),
      limit_(limit),
      binary32_holds_all_(fits_binary32({single_ray, {}}, {})),
      shared_(std::move(single_ray)),
      shared_primitives_(culler.shared_primitives()) {
    if (scene.march) shared_march_ = scene::file::round_march(*scene.march, binary32);
    find_all_truths();
}

namespace {

template <class S>
Ray<double> to_double_ray(const Ray<S>& ray) {
    const auto vector_in_double = [](const Vec<S>& v) {
        return Vec<double>(nearest_double(v.x), nearest_double(v.y), nearest_double(v.z));
    };
    return {vector_in_double(ray.origin), vector_in_double(ray.direction)};
}

/// Selects the primitives that a ray is tested against: the candidates of `index`; if it is null, all primitives; if
/// `is_paired`, only the primitive with the index of the ray.
struct Candidates {
    const culling::PrimitiveIndex* index = nullptr;
    bool is_paired = false;
};

/// Truth of ray i among its candidates.
template <class S>
Truth find_candidate_truth(Candidates candidates, std::size_t i, const Ray<S>& ray, const PrimitiveList<S>& primitives,
                           ProofLimit limit, Convention convention, const Range<double>& range) {
    const culling::PrimitiveIndex* const index = candidates.index;
    if (candidates.is_paired) {
        Truth truth = find_truth(ray, primitives[i], limit, convention, range);
        if (truth.primitive >= 0) truth.primitive = static_cast<int>(i);
        return truth;
    }
    if (index == nullptr) {
        if (primitives.all_listed()) return find_truth(ray, primitives.listed_primitives(), limit, convention, range);
        return find_truth(ray, std::span<const Primitive<S>>(primitives.all()), limit, convention, range);
    }

    thread_local std::vector<std::uint32_t> indices;
    thread_local std::vector<Primitive<S>> candidate_primitives;
    index->find_candidates(to_double_ray(ray), indices);
    candidate_primitives.clear();
    for (const std::uint32_t primitive : indices) candidate_primitives.push_back(primitives[primitive]);
    Truth truth = find_truth(ray, std::span<const Primitive<S>>(candidate_primitives), limit, convention, range);
    if (truth.primitive >= 0) truth.primitive = static_cast<int>(indices[truth.primitive]);
    return truth;
}

}  // namespace

Truth Band::find_ray_truth(std::size_t i, Convention convention) const {
    const Candidates candidates{culler_ ? culler_->index_for_truth() : nullptr, is_paired_};
    return with_ray(i, [&](const auto& ray, const auto& primitives) {
        return find_candidate_truth(candidates, i, ray, primitives, limit_, convention, range(i));
    });
}

Truth Band::truth_of_primitive(std::size_t i, std::size_t primitive, Convention convention) const {
    return with_ray(i, [&](const auto& ray, const auto& primitives) {
        return find_truth(ray, primitives[primitive], limit_, convention, range(i));
    });
}

void Band::find_all_truths() {
    const culling::PrimitiveIndex* const index = culler_ ? culler_->index_for_truth() : nullptr;
    stages_ =
        ideal_
            ? find_truths(RaysAndPrimitives<Real>{*ideal_, ideal_primitives_, index, is_paired_}, limit_, truths_)
            : find_truths(RaysAndPrimitives<double>{shared_, shared_primitives_, index, is_paired_}, limit_, truths_);
}

const Truth& Band::special_truth(std::size_t i, Convention convention) const {
    const std::size_t key = convention_key(i, convention);
    const auto entry = special_truths_.find(key);
    if (entry != special_truths_.end()) return entry->second;
    return special_truths_.emplace(key, find_ray_truth(i, plain_part(convention))).first->second;
}

bool Band::first_hit_faces(std::size_t i, Facing facing) const {
    if (truths_.primitive[i] < 0) return false;
    return with_ray(i, [&](const auto& ray, const auto& primitives) {
        const auto primitive = lift_primitive<Ball>(primitives[truths_.primitive[i]]);
        return with_span(lift_ray<Ball>(ray), primitive, [facing](const auto& span) {
            if constexpr (requires { faces(span, facing); }) return faces(span, facing).is_yes();
            else return true;
        });
    });
}

bool Band::may_differ(std::size_t i, Convention convention) const {
    return truths_.may_differ(i, convention) || (convention.is_special() && needs_special_truth(i, convention));
}

bool Band::needs_special_truth(std::size_t i, Convention convention) const {
    if (convention.by_shape)
        return std::ranges::any_of(all_shapes, [&](Shape shape) { return may_differ(i, convention.for_shape(shape)); });

    const bool has_ranges = ideal_ ? ideal_->have_ranges() : shared_.have_ranges();
    if (convention.endless && has_ranges) return true;
    if (convention.at_origin == AtOrigin::exit && truths_.on_surface[i] != 0) return true;

    // A ray that misses from both sides misses from one side. If the first hit is on a side that counts, it stays the
    // first hit, unless another property of the convention excludes it.
    if (convention.facing != Facing::both && truths_.decision[i] != Truth::Decision::miss &&
        (truths_.may_differ(i, convention) || !first_hit_faces(i, convention.facing)))
        return true;

    // Only a ray that starts inside a primitive has another answer.
    if (convention.inside == Inside::usual) return false;
    if (has_ranges) return true;  // the ray may begin elsewhere than at its origin
    if (ideal_ || !shared_primitives_.all_listed() || (culler_ && culler_->index_for_truth())) return true;
    const auto primitives = shared_primitives_.listed_primitives();
    return std::ranges::any_of(
        is_paired_ ? primitives.subspan(i, 1) : primitives,
        [ray = shared_[i]](const Primitive<double>& primitive) { return culling::may_start_inside(ray, primitive); });
}

Truth Band::truth(std::size_t i, Convention convention) const {
    if (convention.is_special() && needs_special_truth(i, convention)) return find_ray_truth(i, convention);
    return truths_.may_differ(i, convention) ? special_truth(i, convention) : truths_[i];
}

FormatInputs Band::inputs(const Format& format, BandNeeds needs) const {
    FormatInputs in{.format = format, .is_paired = is_paired_, .stop = limit_.stop};
    const FloatFormat& parameters = format.parameters;

    // Rounds the rays and primitives, and finds out whether the format rounds any number at all.
    if (ideal_) {
        in.rays = scene::rays::round_rays(*ideal_, parameters);
        in.primitives = round_primitives(ideal_primitives_, parameters);
    } else {
        const bool holds_binary32 = parameters.precision >= binary32.precision && parameters.emin <= binary32.emin &&
                                    parameters.emax >= binary32.emax;
        in.is_ideal = holds_binary32 && binary32_holds_all_;
        in.rays = in.is_ideal ? shared_ : scene::rays::round_block(shared_, parameters);
        in.primitives = round_primitives(shared_primitives_, parameters);
        if (holds_binary32 && !in.is_ideal) in.is_ideal = holds_binary64(parameters) || are_all_unrounded(in);
    }
    if (ideal_ && scene_ && scene_->march) in.march = scene::file::round_march(*scene_->march, parameters);
    else if (shared_march_) in.march = scene::file::round_march(*shared_march_, parameters);

    // Ray generators end with directions of length one, up to their rounding.
    const bool rays_are_unit = ideal_ && ideal_->generated_rays;
    if (needs.unit_rays) in.unit_rays = rays_are_unit ? in.rays : normalise_rays(in.rays, parameters, limit_.stop);

    // Candidates that the forms are tested against: an index, or lists of candidates made with it
    if (const auto index =
            culler_ && !needs.without_forms ? culler_->index_for_forms(parameters, in.primitives) : nullptr) {
        in.index = std::dynamic_pointer_cast<const culling::SphereIndex>(index);
        if (!in.index) in.candidates = std::make_shared<culling::CandidateLists>(*index, in.rays);
    }

    find_reach(in, needs);
    if (needs.stored_truth && !in.is_ideal) {
        if (culler_) in.truth_index = culler_->index_for_stored_truth(parameters, in.primitives);
        find_truths(RaysAndPrimitives<double>{in.rays, in.primitives, in.truth_index.get(), is_paired_}, limit_,
                    in.stored_truth);
    }
    return in;
}

Truth FormatInputs::find_stored_truth(std::size_t i, Convention convention) const {
    const Truth closed_truth = stored_truth[i];
    if (!convention.is_special() && !convention_matters(convention, closed_truth.touches, closed_truth.on_surface))
        return closed_truth;
    return find_candidate_truth({truth_index.get(), is_paired}, i, rays[i], primitives, {.stop = stop}, convention,
                                rays.range(i));
}

namespace {

/// True if both numbers are equal or both are NaN.
constexpr auto is_same = [](double stored, const auto& original) {
    return stored == original || (std::isnan(stored) && original != original);
};

template <class Predicate>
bool holds_for_all(std::size_t count, const Predicate& predicate) {
    for (std::size_t i = 0; i < count; ++i)
        if (!predicate(i)) return false;
    return true;
}

}  // namespace

bool Band::is_ray_unrounded(const FormatInputs& inputs, std::size_t i) const {
    const auto is_same_number = is_same;
    const auto same_vector = [&](const Vec<double>& stored, const auto& original) {
        return is_same_number(stored.x, original.x) && is_same_number(stored.y, original.y) &&
               is_same_number(stored.z, original.z);
    };
    return with_ray(i, [&](const auto& ray, const auto&) {
        const Ray<double> stored = inputs.rays[i];
        if (!same_vector(stored.origin, ray.origin) || !same_vector(stored.direction, ray.direction)) return false;
        const Range<double> stored_range = inputs.rays.range(i), original_range = range(i);
        return is_same_number(stored_range.tmin, original_range.tmin) &&
               is_same_number(stored_range.tmax, original_range.tmax);
    });
}

bool Band::is_primitive_unrounded(const FormatInputs& inputs, std::size_t k) const {
    return with_ray(0, [&](const auto&, const auto& primitives) {
        const auto stored_primitive = inputs.primitives[k];
        const auto original = primitives[k];
        if (!std::ranges::equal(stored_primitive.shape_numbers(), original.shape_numbers(), is_same)) return false;
        return !original.transform ||
               std::ranges::equal(stored_primitive.transform->matrix, original.transform->matrix, is_same);
    });
}

bool Band::is_unrounded(const FormatInputs& inputs, std::size_t i) const {
    if (!is_ray_unrounded(inputs, i)) return false;
    if (is_paired_) return is_primitive_unrounded(inputs, i);
    return holds_for_all(inputs.primitives.size(), [&](std::size_t k) { return is_primitive_unrounded(inputs, k); });
}

bool Band::are_all_unrounded(const FormatInputs& inputs) const {
    return holds_for_all(pixel_count(), [&](std::size_t i) { return is_ray_unrounded(inputs, i); }) &&
           holds_for_all(pixel_count() == 0 ? 0 : inputs.primitives.size(),
                         [&](std::size_t k) { return is_primitive_unrounded(inputs, k); });
}

Ray<Real> Band::true_ray(std::size_t i) const {
    return with_ray(i, [](const auto& ray, const auto&) { return lift_ray<Real>(ray); });
}

const scene::rays::CameraFrame<Real>* Band::camera_frame() const {
    return ideal_ && ideal_->generated_rays ? &ideal_->generated_rays->frame() : nullptr;
}

std::optional<scene::rays::RecordedRay> Band::recorded_ray(std::size_t i, const Format& format) const {
    if (camera_frame() == nullptr) return std::nullopt;
    const auto index = static_cast<int>(i);
    return ideal_->generated_rays->record_ray(format, {index % ideal_->width, y0_ + index / ideal_->width});
}

std::shared_ptr<const scene::rays::RayGroup> Band::make_original_group(std::size_t i, std::set<int> primitives) const {
    if (is_paired_) primitives = {static_cast<int>(i)};
    const std::size_t count = primitives.empty() ? shared_primitives_.size() : primitives.size();
    if (scene_ != nullptr || ideal_ || count > max_original_primitives) return nullptr;
    auto group = std::make_shared<scene::rays::RayGroup>(scene::rays::make_group(shared_[i]));
    group->rays.push_range(shared_, i);
    for (const int primitive : primitives) group->primitives.push_back(shared_primitives_[primitive]);
    if (!primitives.empty()) return group;
    group->primitives = shared_primitives_.all();
    group->march = shared_march_;
    return group;
}

double Band::rounded_truth(std::size_t i, const FloatFormat& format, intersect::Direction direction,
                           Convention convention) const {
    const Truth truth = this->truth(i, convention);
    const Length length = length_of(direction);
    return with_ray(i, [&](const auto& ray, const auto& primitives) {
        const auto primitive = primitives[truth.primitive];
        return round_truth(truth, ray, primitive, format, length, convention.for_shape(primitive.shape), range(i));
    });
}

}  // namespace lostbits::measure::truth
