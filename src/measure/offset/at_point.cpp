#include "measure/offset/at_point.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "intersect/bounding_box/behind.hpp"
#include "intersect/transform/transformed_form.hpp"
#include "measure/answer/chunk.hpp"
#include "measure/offset/ball_of.hpp"
#include "measure/offset/half_line.hpp"
#include "measure/offset/smallest.hpp"
#include "measure/truth/unit_direction.hpp"
#include "number/wide/running_error.hpp"
#include "shapes/bounding_box.hpp"
#include "shapes/lift.hpp"

namespace lostbits::measure::offset {

namespace {

template <class T>
struct StoredAs {
    using type = T;
};
template <>
struct StoredAs<RoundedAny> {
    using type = double;
};

bool is_finite(const Vec<double>& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }
double distance(const Vec<double>& a, const Vec<double>& b) { return length(Vec<double>(a - b)); }

/// Finds the t, in doubles, at which a ray comes out of the primitive that it goes into; nothing if the ray never
/// comes out.
std::optional<double> find_exit(const Ray<double>& ray, const Primitive<double>& primitive) {
    const auto ends = with_span(ray, primitive, [](const auto& span) { return ends_of(span); });
    return ends && ends->far > 0 ? std::optional(ends->far) : std::nullopt;
}

/// Returns a lower bound of the distance of a point from the surface of a primitive; 0 if the bounds on all roundings
/// prove nothing.
double min_distance(const Vec<double>& p, const Primitive<double>& primitive) {
    using RunningError = number::wide::RunningError<double>;
    if (primitive.transform && !has_bounding_box(primitive.shape)) return 0;  // the primitive has no bounding ball
    if (primitive.transform && primitive.transform->is_inverse) return 0;     // rounding could put the ball anywhere
    const Vec<RunningError> point = lift_vec<RunningError>(p);
    const Primitive<RunningError> running_primitive = lift_primitive<RunningError>(primitive);
    const auto distance_from_surface = [&point](const auto& shape) {
        return abs(shape.relative_distance(point) * shape.unit());
    };
    const auto distance_from_ball = [&] {
        const auto ball = ball_around(running_primitive);
        return length(Vec<RunningError>(point - ball.centre)) - ball.radius;
    };
    const RunningError separation =
        primitive.transform ? distance_from_ball() : visit(running_primitive, distance_from_surface);
    return std::max(0.0, (separation.first() - separation.radius()) * (1 - 0x1p-50));
}

/// Adds the faults and the size of the offset of a new ray that leaves p.
void add_new_ray(const NewRay& new_ray, const Vec<double>& p, StrategyAtPoint& strategy_result) {
    const auto add_if = [](bool condition, std::uint8_t& count) {
        count = static_cast<std::uint8_t>(count + (condition ? 1 : 0));
    };
    for (std::size_t f = 0; f < fault_names.size(); ++f)
        add_if(new_ray.has(static_cast<Fault>(f)), strategy_result.fault_counts[f]);
    add_if(new_ray.is_bad(), strategy_result.bad_ray_count);
    if (!new_ray.has(Fault::not_finite))
        strategy_result.offset_size =
            std::max(strategy_result.offset_size, distance(new_ray.ray.origin, p) + new_ray.tmin);
}

}  // namespace

/// Far sides of the departed primitive (the one that the hit point lies on) for the rays to one `Side` of its surface.
/// For a ray that goes into the primitive, the far side begins half of the way to its exit (`t_begin`), and its wall is
/// the exit (`t_wall`).
struct FarSides {
    FarSide along_normal;
    std::vector<FarSide> along_rays;
};

/// A hit point, computed in the number type of its format, and the rays that leave it.
template <class T>
class TypedPoint {
public:
    using S = typename StoredAs<T>::type;

    TypedPoint(const PointWork& work, const FormHit& form_hit)
        : work_(work),
          form_hit_(form_hit),
          departed_primitive_(work.primitives_[form_hit.primitive]),
          strategy_input_(compute_hit_point()),
          p_(as_doubles(strategy_input_.point)),
          n_(as_doubles(strategy_input_.normal)) {
        if (!has_point()) return;
        sort_departures();
        find_far_sides();
    }

    [[nodiscard]] bool has_point() const { return is_finite(p_) && is_finite(n_); }
    [[nodiscard]] const Vec<double>& p() const { return p_; }
    [[nodiscard]] const Vec<double>& n() const { return n_; }
    [[nodiscard]] std::size_t ray_count(Side side) const { return departures(side).size(); }

    [[nodiscard]] std::vector<NewRay> rays(const Strategy& strategy, Side side) const {
        std::vector<NewRay> new_rays;
        for (const Departure<T>& departure : departures(side)) {
            StrategyInput<T> strategy_input = strategy_input_;
            strategy_input.new_direction = departure.new_direction;
            strategy_input.side_sign = departure.side_sign;
            strategy_input.target_distance = departure.target_distance;
            const StrategyOutput<T> r = strategy.respawn<T>(strategy_input);
            new_rays.push_back({.ray = {as_doubles(r.origin), as_doubles(departure.new_direction)},
                                .tmin = as_double(r.tmin),
                                .tmax = as_double(r.tmax),
                                .tests_departed_primitive = r.tests_departed_primitive});
        }
        for (std::size_t k = 0; k < new_rays.size(); ++k)
            find_faults(new_rays[k], side, far_sides_of(side).along_rays[k]);
        find_faults_by_form(new_rays, side);
        return new_rays;
    }

    /// Judges the offset e by truth: enough means that it is safe.
    [[nodiscard]] OffsetVerdict judge_safety(Side side, double e) const {
        const Vec<double> origin = origin_at_offset(side, e);
        const FarSide& far = far_sides_of(side).along_normal;
        if (!is_finite(origin) || e > (enters(side) ? far.t_wall : far.t_begin)) return OffsetVerdict::too_much;
        for (std::size_t k = 0; k < ray_count(side); ++k) {
            const Ray<double> ray{origin, as_doubles(departures(side)[k].new_direction)};
            if (!is_safe_ray(ray, side, far_sides_of(side).along_rays[k]))
                return e > far.t_begin ? OffsetVerdict::too_much : OffsetVerdict::too_little;
        }
        return OffsetVerdict::enough;
    }

    /// Judges the offset e by truth, and a safe one by the form's arithmetic as well: enough means that it is quiet.
    [[nodiscard]] OffsetVerdict judge_quiet(Side side, double e) const {
        if (const OffsetVerdict by_truth = judge_safety(side, e); by_truth != OffsetVerdict::enough) return by_truth;
        const Vec<double> origin = origin_at_offset(side, e);
        std::vector<NewRay> new_rays;
        for (const Departure<T>& departure : departures(side))
            new_rays.push_back({.ray = {origin, as_doubles(departure.new_direction)},
                                .tmin = 0,
                                .tmax = as_double(departure.target_distance)});
        find_faults_by_form(new_rays, side);
        const unsigned faults_by_form = bit_of(Fault::self_hit_by_form) | bit_of(Fault::lost_exit_by_form);
        const bool has_wrong_ray = std::ranges::any_of(
            new_rays, [&](const NewRay& new_ray) { return (new_ray.faults & faults_by_form) != 0; });
        return has_wrong_ray ? OffsetVerdict::too_little : OffsetVerdict::enough;
    }

    /// Returns the smallest safe offset; infinite if no offset is safe.
    [[nodiscard]] double safe_offset(Side side) const {
        return smallest_offset([&](double e) { return judge_safety(side, e); });
    }
    /// Returns the smallest quiet offset; infinite if no offset is quiet.
    [[nodiscard]] double quiet_offset(Side side) const {
        return smallest_offset([&](double e) { return judge_quiet(side, e); });
    }

private:
    /// Computes the hit point and its normal: the input of every strategy, but for the new ray.
    [[nodiscard]] StrategyInput<T> compute_hit_point() const {
        const Ray<T> ray = lift_ray<T>(form_hit_.ray);
        const T t = static_cast<T>(form_hit_.t);
        const Vec<T> point = add_scaled<T>(ray.origin, t, ray.direction);
        StrategyInput<T> strategy_input{ray,  t,   lift_primitive<T>(departed_primitive()), {}, point, point, point,
                                        T(1), T(1)};
        if (strategy_input.primitive.transform) compute_object_point(strategy_input);
        else compute_point(strategy_input.ray, strategy_input.primitive, strategy_input.point, strategy_input.normal);
        return strategy_input;
    }
    /// Sorts the rays that leave the point by their side. Rays whose direction is not finite are left out.
    void sort_departures() {
        const T infinite_distance = T(1) / T(0);
        std::optional<Vec<T>> light;
        if (work_.light_) light = lift_vec<T>(*work_.light_);
        for (const Departure<T>& departure : make_departures<T>(strategy_input_.ray, strategy_input_.point,
                                                                strategy_input_.normal, infinite_distance, light)) {
            const Side side = departure.side_sign > T(0) ? Side::outside : Side::inside;
            if (is_finite(as_doubles(departure.new_direction)))
                departures_[static_cast<std::size_t>(side)].push_back(departure);
        }
    }
    /// Finds the far side ahead of each ray, and along the normal.
    void find_far_sides() {
        for (const Side side : both_sides) {
            FarSides& sides = far_sides_[static_cast<std::size_t>(side)];
            sides.along_normal = far_side_ahead(side, side == Side::outside ? n_ : -1.0 * n_);
            for (const Departure<T>& departure : departures(side))
                sides.along_rays.push_back(far_side_ahead(side, as_doubles(departure.new_direction)));
        }
    }
    /// Returns p ± e·n, to the side of the rays, as the format computes it.
    [[nodiscard]] Vec<double> origin_at_offset(Side side, double e) const {
        const T signed_e = side == Side::outside ? static_cast<T>(e) : -static_cast<T>(e);
        return as_doubles(add_scaled<T>(strategy_input_.point, signed_e, strategy_input_.normal));
    }
    /// Finds the smallest offset that `verdict_on` calls enough, up to 64 times the largest number of the point and the
    /// primitive; infinite if none of these is enough.
    template <class VerdictOn>
    [[nodiscard]] double smallest_offset(const VerdictOn& verdict_on) const {
        const FloatFormat& format = work_.tested_form_.format.parameters;
        const double start = std::ldexp(largest_of(p_), -format.precision);
        double size = largest_of(p_);
        for (const double x : departed_primitive().shape_numbers()) size = std::max(size, std::fabs(x));
        return find_smallest_enough(format, start, 64 * size, verdict_on);
    }

    /// Projects p onto the surface if the kind of the points is `HitPointKind::projected`, and computes the normal
    /// there.
    void compute_point(const Ray<T>& ray, const Primitive<T>& primitive, Vec<T>& p, Vec<T>& n) const {
        if (work_.point_kind_ == HitPointKind::projected) p = project_onto_surface<T>(ray, primitive, p);
        n = outward_normal<T>(ray, primitive, p);
    }
    /// Computes the point and its normal in object space, by the transform method of the form, and in world space. With
    /// M = [A τ] the matrix of the primitive, a computed point in world space is o + t d, and a projected one is M
    /// times the point in object space. The normal in world space is A⁻ᵀ times that in object space, made unit. A
    /// transform method that uses adj(A) in place of A⁻¹ works with a primitive |det A| times as large, so its ray is
    /// divided by that factor here.
    void compute_object_point(StrategyInput<T>& strategy_input) const {
        const auto& steps = intersect::transform::step_functions<T>(
            *intersect::transform::find_transformed_parts(
                 intersect::bounding_box::without_world_boxes(
                     work_.tested_form_.form->form_for(strategy_input.primitive.shape)))
                 .method);

        // The ray, the point and the normal in object space.
        const Transform<T> transform = *std::exchange(strategy_input.primitive.transform, std::nullopt);
        const auto maps = steps.maps(transform);
        const auto object_ray = steps.to_object(maps, strategy_input.ray);
        const T t = strategy_input.t * object_ray.length;
        const Ray<T> ray{object_ray.ray.origin / object_ray.scale, object_ray.ray.direction / object_ray.scale};
        ObjectPoint<T> object_point{
            ray, t, add_scaled<T>(ray.origin, t, ray.direction), ray.direction, maps.to_world, maps.to_object};
        compute_point(ray, strategy_input.primitive, object_point.point, object_point.normal);

        // The point and the normal in world space.
        if (work_.point_kind_ == HitPointKind::projected)
            strategy_input.point = maps.to_world.point(object_point.point);
        const auto& rows = maps.to_object.rows;
        const T sign = as_double(object_ray.scale) == 1 || transform.orientation > 0 ? T(1) : T(-1);
        strategy_input.normal = unit_of<T>(sign * times(rows, object_point.normal));
        strategy_input.object_point = object_point;
    }
    [[nodiscard]] const std::vector<Departure<T>>& departures(Side side) const {
        return departures_[static_cast<std::size_t>(side)];
    }
    [[nodiscard]] const Primitive<double>& departed_primitive() const { return departed_primitive_; }
    [[nodiscard]] const FarSides& far_sides_of(Side side) const { return far_sides_[static_cast<std::size_t>(side)]; }
    /// True if rays to a side go into the primitive. If the primitive has no inside, rays to both sides go away from
    /// it.
    [[nodiscard]] bool enters(Side side) const {
        return side == Side::inside && has_inside(departed_primitive().shape);
    }
    /// Returns the far side ahead of a ray that starts at the point (`FarSides`).
    [[nodiscard]] FarSide far_side_ahead(Side side, const Vec<double>& w) const {
        if (!enters(side)) return find_far_side({p_, w}, departed_primitive());
        const double exit = find_exit({p_, w}, departed_primitive()).value_or(std::numeric_limits<double>::infinity());
        return {exit / 2, exit};
    }
    /// True if the wall of the far side lies between the point and the start of a ray.
    [[nodiscard]] bool is_behind_wall(Side side, const HalfLine& line) const {
        const Vec<double> to_start = line.ray.origin + line.tmin * line.ray.direction - p_;
        return length(to_start) > 0 && far_side_ahead(side, to_start).t_wall < 1;
    }

    /// True if a ray has no true self-hit and no lost exit: a ray to the outside must not meet the primitive before the
    /// far side, and a ray that goes into the primitive must start in or on the primitive and meet its inner points.
    [[nodiscard]] bool is_safe_ray(const Ray<double>& ray, Side side, const FarSide& far) const {
        if (!enters(side)) return !meets_before({ray, 0}, far.t_begin, departed_primitive());
        const Meeting meeting = find_meeting({ray, 0}, departed_primitive());
        return !meeting.outside && meeting.meets;
    }

    /// Finds the true faults of a ray. `far` is the far side ahead of a ray in the same direction that starts at the
    /// hit point.
    void find_faults(NewRay& new_ray, Side side, const FarSide& far) const {
        const HalfLine line{new_ray.ray, new_ray.tmin};
        if (!line.is_proper()) return new_ray.add_fault_if(true, Fault::not_finite);
        if (enters(side)) find_faults_inside(line, side, new_ray);
        else find_faults_outside(line, side, far, new_ray);
        const double jump = distance(new_ray.ray.origin, p_) + new_ray.tmin * length(new_ray.ray.direction);
        if (jump > 0) find_faults_near(1.001 * jump, line, new_ray);
    }

    /// Finds the faults of a ray that goes into the departed primitive.
    void find_faults_inside(const HalfLine& line, Side side, NewRay& new_ray) const {
        const Meeting meeting = find_meeting(line, departed_primitive());
        const Meeting from_origin = new_ray.tmin > 0 ? find_meeting({new_ray.ray, 0}, departed_primitive()) : meeting;
        // Beyond the far side of a convex primitive, the ray meets nothing. Beyond that of a torus, it meets the
        // ring once more.
        const bool lost = !meeting.meets || (is_hit_again(departed_primitive()) && is_behind_wall(side, line));
        new_ray.add_fault_if(from_origin.outside, Fault::wrong_side);
        new_ray.add_fault_if(new_ray.tests_departed_primitive && meeting.outside && !lost, Fault::self_hit);
        new_ray.add_fault_if(!new_ray.tests_departed_primitive || lost, Fault::lost_exit);
    }

    /// Finds the faults with the departed primitive of a ray that goes away from it.
    void find_faults_outside(const HalfLine& line, Side side, const FarSide& far, NewRay& new_ray) const {
        const HalfLine whole_line{new_ray.ray, 0};
        const bool is_wrong_side = has_inside(departed_primitive().shape)
                                       ? find_meeting(whole_line, departed_primitive()).inside
                                       : meets_before(whole_line, far.t_begin, departed_primitive());
        new_ray.add_fault_if(is_wrong_side, Fault::wrong_side);
        new_ray.add_fault_if(new_ray.tests_departed_primitive && meets_before(line, far.t_begin, departed_primitive()),
                             Fault::self_hit);
        new_ray.add_fault_if(
            far.t_wall < new_ray.tmax && (!new_ray.tests_departed_primitive || is_behind_wall(side, line)),
            Fault::lost_occluder);
    }

    /// Finds the faults with all other primitives whose surface may lie within a radius around p.
    void find_faults_near(double radius, const HalfLine& line, NewRay& new_ray) const {
        const auto test_primitive = [&](std::size_t k) {
            if (k == form_hit_.primitive) return;
            const Primitive<double> other = work_.primitives_[k];
            if (!(min_distance(p_, other) > radius)) find_faults_with(other, line, new_ray);
        };
        if (work_.tree_ == nullptr) {
            for (std::size_t k = 0; k < work_.primitives_.size(); ++k) test_primitive(k);
            return;
        }
        std::vector<std::uint32_t> nearby;
        work_.tree_->find_within(p_, radius, nearby);
        for (const std::uint32_t k : nearby) test_primitive(k);
    }

    /// Finds the faults with a neighbour whose surface may lie between p and the start of the ray.
    void find_faults_with(const Primitive<double>& other, const HalfLine& line, NewRay& new_ray) const {
        const Meeting from_p = find_meeting({{p_, new_ray.ray.direction}, 0}, other);
        const Meeting from_start = find_meeting(line, other);
        const bool passes_surface =
            line.tmin > 0 ? from_p.meets && !from_start.meets
                          : !from_p.inside && !from_start.inside && passes_through(p_, new_ray.ray.origin, other);
        new_ray.add_fault_if(from_p.meets && (from_p.inside != from_start.inside || passes_surface),
                             Fault::lost_occluder);
        new_ray.add_fault_if(!from_p.inside && from_start.inside, Fault::begins_in_neighbour);
    }

    /// Runs the form on the new rays and adds the faults that it causes. A hit beyond the start of the far side counts
    /// as a new hit, not as a self-hit.
    void find_faults_by_form(std::vector<NewRay>& new_rays, Side side) const {
        const intersect::Info &info = *work_.tested_form_.form->info,
                              &part_info = *work_.tested_form_.form->form_for(departed_primitive().shape).info;

        // The rays in the format, of unit length for a form that needs it.
        scene::rays::RayBlock rays;
        for (const NewRay& new_ray : new_rays) {
            const bool is_made_unit = info.direction == intersect::Direction::unit && is_finite(new_ray.ray.direction);
            rays.push({new_ray.ray.origin,
                       is_made_unit ? truth::unit_direction(new_ray.ray.direction, work_.tested_form_.format.parameters)
                                    : new_ray.ray.direction});
        }
        answer::KernelBuffers<S> buffers(rays);
        const auto& [t, near, far, hit] = static_cast<const answer::AnswerBuffers<S>&>(buffers);
        run_kernel(buffers.rays(), lift_primitive<S>(departed_primitive()), buffers.hits());

        for (std::size_t k = 0; k < new_rays.size(); ++k) {
            NewRay& r = new_rays[k];
            if (!r.tests_departed_primitive || r.has(Fault::not_finite)) continue;
            const double reported_t =
                hit[k] == 0 ? truth::missing : first_reported(part_info, r, {t[k], near[k], far[k]});
            const double far_begin = enters(side) ? find_exit(r.ray, departed_primitive()).value_or(0) / 2
                                                  : far_sides_of(side).along_rays[k].t_begin;
            r.add_fault_if(enters(side) && std::isnan(reported_t), Fault::lost_exit_by_form);
            r.add_fault_if(reported_t < far_begin, Fault::self_hit_by_form);  // false for NaN
        }
    }

    void run_kernel(const intersect::table::RayBatch<S>& batch, const Primitive<S>& primitive,
                    const intersect::table::HitBatch<S>& answers) const {
        const intersect::table::Intersector& form = *work_.tested_form_.form;
        if constexpr (std::is_same_v<T, float>) form.native32(batch, primitive, answers);
        else if constexpr (std::is_same_v<T, double>) form.native64(batch, primitive, answers);
        else form.rounded(work_.tested_form_.format.parameters, batch, primitive, answers);
    }

    /// Returns the first root that the form reports in (tmin, tmax); NaN if it reports no root there.
    static double first_reported(const intersect::Info& info, const NewRay& new_ray, const std::array<S, 3>& roots) {
        const std::size_t begin = info.roots == intersect::Roots::both ? 1 : 0;
        const std::size_t end = info.roots == intersect::Roots::both ? 3 : 1;
        for (std::size_t k = begin; k < end; ++k) {
            const auto root = static_cast<double>(roots[k]);
            if (root > new_ray.tmin && root < new_ray.tmax) return root;
        }
        return truth::missing;
    }

    const PointWork& work_;
    const FormHit& form_hit_;
    Primitive<double> departed_primitive_;
    StrategyInput<T> strategy_input_;
    Vec<double> p_, n_;
    std::array<std::vector<Departure<T>>, 2> departures_;
    std::array<FarSides, 2> far_sides_;
};

bool PointWork::measure(const FormHit& form_hit, std::array<SideOfPoint, 2>& sides,
                        std::span<StrategyAtPoint> by_strategy, bool search_quiet_offset) const {
    return with_number(tested_form_.format, [&]<class T>() {
        const TypedPoint<T> point(*this, form_hit);
        if (!point.has_point()) return false;
        for (const Side side : both_sides) {
            const auto s = static_cast<std::size_t>(side);
            sides[s].ray_count = static_cast<std::uint8_t>(point.ray_count(side));
            sides[s].safe_offset = point.safe_offset(side);
            if (search_quiet_offset) sides[s].quiet_offset = point.quiet_offset(side);
            for (std::size_t k = 0; k < strategies_.size(); ++k) {
                StrategyAtPoint& strategy_result = by_strategy[index_at_point(side, k, strategies_.size())];
                for (const NewRay& new_ray : point.rays(*strategies_[k], side))
                    add_new_ray(new_ray, point.p(), strategy_result);
            }
        }
        return true;
    });
}

std::vector<NewRay> PointWork::rays(const FormHit& form_hit, const Strategy& strategy, Side side) const {
    return with_number(tested_form_.format,
                       [&]<class T>() { return TypedPoint<T>(*this, form_hit).rays(strategy, side); });
}

bool PointWork::is_safe(const FormHit& form_hit, Side side, double e, bool by_form) const {
    return with_number(tested_form_.format, [&]<class T>() {
        const TypedPoint<T> point(*this, form_hit);
        return (by_form ? point.judge_quiet(side, e) : point.judge_safety(side, e)) == OffsetVerdict::enough;
    });
}

std::optional<PointWork::HitPoint> PointWork::hit_point(const FormHit& form_hit) const {
    return with_number(tested_form_.format, [&]<class T>() -> std::optional<HitPoint> {
        const TypedPoint<T> point(*this, form_hit);
        if (!point.has_point()) return std::nullopt;
        return HitPoint{point.p(), point.n()};
    });
}

}  // namespace lostbits::measure::offset
