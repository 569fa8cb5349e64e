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
#include "number/wide/running.hpp"
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

/// The t at which a ray leaves the primitive that it goes into, in doubles; nothing where it does not leave it.
std::optional<double> exit_of(const Ray<double>& ray, const Primitive<double>& primitive) {
    const auto ends = with_span(ray, primitive, [](const auto& span) { return ends_of(span); });
    return ends && ends->far > 0 ? std::optional(ends->far) : std::nullopt;
}

/// Lower bound of the distance of a point from the surface of a primitive; 0 where the bounds on all roundings prove
/// nothing.
double least_distance(const Vec<double>& p, const Primitive<double>& primitive) {
    using Certain = number::wide::Running<double>;
    if (primitive.placed && !has_bounding_box(primitive.shape)) return 0;  // it has no bounding ball
    if (primitive.placed && primitive.placed->is_inverse) return 0;        // rounding could put the ball anywhere
    const Vec<Certain> at = lift_vec<Certain>(p);
    const Primitive<Certain> certain = lift_primitive<Certain>(primitive);
    const auto from_surface = [&at](const auto& shape) { return abs(shape.off_surface(at) * shape.unit()); };
    const auto from_ball = [&] {
        const auto ball = ball_around(certain);
        return length(Vec<Certain>(at - ball.centre)) - ball.radius;
    };
    const Certain away = primitive.placed ? from_ball() : visit(certain, from_surface);
    return std::max(0.0, (away.first() - away.radius()) * (1 - 0x1p-50));
}

}  // namespace

/// Far sides of the primitive that is left, ahead of the rays to one side; for rays that go into it, their way out.
struct FarSides {
    FarSide along_normal;
    std::vector<FarSide> along_rays;
};

/// One point, computed in the number type of its format.
template <class T>
class TypedPoint {
public:
    using S = typename StoredAs<T>::type;

    TypedPoint(const PointWork& work, const FormHit& met)
        : work_(work), met_(met), left_primitive_(work.primitives_[met.primitive]) {
        const Ray<T> ray = lift_ray<T>(met.ray);
        const T t = static_cast<T>(met.t);
        const Vec<T> there = moved<T>(ray.origin, t, ray.direction);
        Leaving<T> found{ray, t, lift_primitive<T>(left_primitive()), {}, there, there, there, T(1), T(1)};
        if (found.primitive.placed) put_object_point(found);
        else put_point(found.ray, found.primitive, found.p, found.n);
        leaving_.emplace(std::move(found));
        const Vec<T>& p = leaving_->p;
        p_ = as_doubles(p);
        n_ = as_doubles(leaving_->n);
        const T infinite = T(1) / T(0);
        std::optional<Vec<T>> light;
        if (work.light_) light = lift_vec<T>(*work.light_);
        if (!is_finite(p_) || !is_finite(n_)) return;
        for (const Departure<T>& departure : departures_from<T>(ray, p, leaving_->n, infinite, light)) {
            if (is_finite(as_doubles(departure.w))) departures_[departure.side > T(0) ? 0 : 1].push_back(departure);
        }
        for (const Side side : both_sides) {
            FarSides& ahead = far_[static_cast<std::size_t>(side)];
            ahead.along_normal = far_ahead(side, side == Side::outside ? n_ : -1.0 * n_);
            for (const Departure<T>& departure : departures(side))
                ahead.along_rays.push_back(far_ahead(side, as_doubles(departure.w)));
        }
    }

    [[nodiscard]] bool is_there() const { return is_finite(p_) && is_finite(n_); }
    [[nodiscard]] const Vec<double>& p() const { return p_; }
    [[nodiscard]] const Vec<double>& n() const { return n_; }
    [[nodiscard]] std::size_t count(Side side) const { return departures(side).size(); }

    [[nodiscard]] std::vector<NewRay> rays(const Strategy& strategy, Side side) const {
        std::vector<NewRay> all;
        for (const Departure<T>& departure : departures(side)) {
            Leaving<T> leaving = *leaving_;
            leaving.w = departure.w;
            leaving.side = departure.side;
            leaving.reach = departure.reach;
            const Respawn<T> r = strategy.respawn<T>(leaving);
            all.push_back({.ray = {as_doubles(r.origin), as_doubles(departure.w)},
                           .tmin = as_double(r.tmin),
                           .tmax = as_double(r.tmax),
                           .tests_left_primitive = r.tests_left_primitive});
        }
        for (std::size_t k = 0; k < all.size(); ++k) find_faults(all[k], side, sides_ahead(side).along_rays[k]);
        find_faults_by_form(all, side);
        return all;
    }

    [[nodiscard]] OffsetVerdict judge(Side side, double e, bool by_form) const {
        const T signed_e = side == Side::outside ? static_cast<T>(e) : -static_cast<T>(e);
        const Vec<double> origin = as_doubles(moved<T>(leaving_->p, signed_e, leaving_->n));
        const FarSide& ahead = sides_ahead(side).along_normal;
        if (!is_finite(origin) || e > (enters(side) ? ahead.wall : ahead.from)) return OffsetVerdict::too_much;
        std::vector<NewRay> all;
        for (std::size_t k = 0; k < count(side); ++k) {
            const Departure<T>& departure = departures(side)[k];
            const Ray<double> ray{origin, as_doubles(departure.w)};
            if (!is_right(ray, side, sides_ahead(side).along_rays[k]))
                return e > ahead.from ? OffsetVerdict::too_much : OffsetVerdict::too_little;
            if (by_form) all.push_back({.ray = ray, .tmin = 0, .tmax = as_double(departure.reach)});
        }
        if (!by_form) return OffsetVerdict::enough;
        find_faults_by_form(all, side);
        const unsigned wrong = bit_of(Fault::self_hit_by_form) | bit_of(Fault::lost_exit_by_form);
        const bool any = std::ranges::any_of(all, [&](const NewRay& r) { return (r.faults & wrong) != 0; });
        return any ? OffsetVerdict::too_little : OffsetVerdict::enough;
    }

    [[nodiscard]] double smallest(Side side, bool by_form) const {
        const FloatFormat& format = work_.row_.format.parameters;
        const double start = std::ldexp(largest_of(p_), -format.precision);
        double size = largest_of(p_);
        for (const double x : left_primitive().used()) size = std::max(size, std::fabs(x));
        return smallest_enough(format, start, 64 * size, [&](double e) { return judge(side, e, by_form); });
    }

private:
    /// Projects p onto the surface where the row asks for it, and computes the normal there.
    void put_point(const Ray<T>& ray, const Primitive<T>& primitive, Vec<T>& p, Vec<T>& n) const {
        if (work_.point_ == HitPoint::projected) p = projected<T>(ray, primitive, p);
        n = outward_normal<T>(ray, primitive, p);
    }
    /// Computes the point and its normal in object space, by the transform method of the row, and in world space. In
    /// world space, a computed point is o + t d, a projected one is M times the point in object space, and the normal
    /// is A⁻ᵀ times the one there, made unit. A transform method that takes adj(A) in place of A⁻¹ works with a
    /// primitive |det A| times as large, so its ray is divided by that factor here.
    void put_object_point(Leaving<T>& found) const {
        const auto& steps = intersect::transform::steps_in<T>(
            *intersect::transform::transformed_parts_of(
                 intersect::bounding_box::without_world_boxes(work_.row_.form->of(found.primitive.shape)))
                 .method);
        const Placement<T> placed = *std::exchange(found.primitive.placed, std::nullopt);
        const auto maps = steps.maps(placed);
        const auto in = steps.to_object(maps, found.ray);
        const T t = found.t * in.length;
        const Ray<T> ray{in.ray.origin / in.scale, in.ray.direction / in.scale};
        ObjectPoint<T> there{ray,           t, moved<T>(ray.origin, t, ray.direction), ray.direction, maps.to_world,
                             maps.to_object};
        put_point(ray, found.primitive, there.p, there.n);
        if (work_.point_ == HitPoint::projected) found.p = maps.to_world.point(there.p);
        const auto& rows = maps.to_object.rows;
        const T sign = as_double(in.scale) == 1 || placed.orientation > 0 ? T(1) : T(-1);
        found.n = unit_of<T>(sign * times(rows, there.n));
        found.object = there;
    }
    [[nodiscard]] const std::vector<Departure<T>>& departures(Side side) const {
        return departures_[static_cast<std::size_t>(side)];
    }
    [[nodiscard]] const Primitive<double>& left_primitive() const { return left_primitive_; }
    [[nodiscard]] const FarSides& sides_ahead(Side side) const { return far_[static_cast<std::size_t>(side)]; }
    /// True if rays to a side go into the primitive. If it has no inside, rays to either side leave it.
    [[nodiscard]] bool enters(Side side) const { return side == Side::inside && has_inside(left_primitive().shape); }
    /// The far side ahead of a ray that starts at the point; for a ray that goes in, it begins half of the way out.
    [[nodiscard]] FarSide far_ahead(Side side, const Vec<double>& w) const {
        if (!enters(side)) return far_side({p_, w}, left_primitive());
        const double exit = exit_of({p_, w}, left_primitive()).value_or(std::numeric_limits<double>::infinity());
        return {exit / 2, exit};
    }
    /// True if the next wall lies between the point and the start of a ray.
    [[nodiscard]] bool is_behind_wall(Side side, const HalfLine& line) const {
        const Vec<double> way = line.ray.origin + line.from * line.ray.direction - p_;
        return length(way) > 0 && far_ahead(side, way).wall < 1;
    }

    /// True if a ray leaves what it should leave, or, where it goes in, starts in the primitive and meets a way out.
    [[nodiscard]] bool is_right(const Ray<double>& ray, Side side, const FarSide& ahead) const {
        if (!enters(side)) return !meets_before({ray, 0}, ahead.from, left_primitive());
        const Meeting met = find_meeting({ray, 0}, left_primitive());
        return !met.outside && met.meets;
    }

    /// Finds the true faults of a ray. `ahead` is the far side for the same direction from the point itself.
    void find_faults(NewRay& r, Side side, const FarSide& ahead) const {
        const auto add = [&r](bool is, Fault f) { r.faults |= is ? bit_of(f) : 0; };
        const HalfLine line{r.ray, r.tmin};
        if (!line.is_proper()) return add(true, Fault::not_finite);
        if (enters(side)) {
            const Meeting met = find_meeting(line, left_primitive());
            const Meeting there = r.tmin > 0 ? find_meeting({r.ray, 0}, left_primitive()) : met;
            // Past the far side of a convex primitive nothing is met. Past that of a torus, the ring is met once more.
            const bool lost = !met.meets || (is_hit_again(left_primitive()) && is_behind_wall(side, line));
            add(there.outside, Fault::wrong_side);
            add(r.tests_left_primitive && met.outside && !lost, Fault::self_hit);
            add(!r.tests_left_primitive || lost, Fault::lost_exit);
        } else {
            const HalfLine all{r.ray, 0};
            add(has_inside(left_primitive().shape) ? find_meeting(all, left_primitive()).inside
                                                   : meets_before(all, ahead.from, left_primitive()),
                Fault::wrong_side);
            add(r.tests_left_primitive && meets_before(line, ahead.from, left_primitive()), Fault::self_hit);
            add(ahead.wall < r.tmax && (!r.tests_left_primitive || is_behind_wall(side, line)), Fault::lost_occluder);
        }
        const double jump = distance(r.ray.origin, p_) + r.tmin * length(r.ray.direction);
        if (jump > 0) find_faults_near(1.001 * jump, line, r);
    }

    /// Finds the faults with all other primitives within a distance of p.
    void find_faults_near(double distance, const HalfLine& line, NewRay& r) const {
        const auto look = [&](std::size_t k) {
            if (k == met_.primitive) return;
            const Primitive<double> other = work_.primitives_[k];
            if (!(least_distance(p_, other) > distance)) find_faults_with(other, line, r);
        };
        if (work_.near_ == nullptr) {
            for (std::size_t k = 0; k < work_.primitives_.size(); ++k) look(k);
            return;
        }
        std::vector<std::uint32_t> near;
        work_.near_->within(p_, distance, near);
        for (const std::uint32_t k : near) look(k);
    }

    /// Finds the faults with a neighbour whose surface may lie between p and the start of the ray.
    void find_faults_with(const Primitive<double>& other, const HalfLine& line, NewRay& r) const {
        const Meeting from_p = find_meeting({{p_, r.ray.direction}, 0}, other), now = find_meeting(line, other);
        const bool through = line.from > 0 ? from_p.meets && !now.meets
                                           : !from_p.inside && !now.inside && passes_through(p_, r.ray.origin, other);
        if (from_p.meets && (from_p.inside != now.inside || through)) r.faults |= bit_of(Fault::lost_occluder);
        if (!from_p.inside && now.inside) r.faults |= bit_of(Fault::begins_in_neighbour);
    }

    /// Finds the faults by the form's own arithmetic. A t beyond the beginning of the far side belongs to that side.
    void find_faults_by_form(std::vector<NewRay>& all, Side side) const {
        const intersect::Info &info = *work_.row_.form->info, &told = *work_.row_.form->of(left_primitive().shape).info;
        scene::rays::RayBlock rays;
        for (const NewRay& r : all) {
            const bool is_made_unit = info.direction == intersect::Direction::unit && is_finite(r.ray.direction);
            rays.push({r.ray.origin, is_made_unit ? truth::unit_direction(r.ray.direction, work_.row_.format.parameters)
                                                  : r.ray.direction});
        }
        answer::KernelBuffers<S> buffers(rays);
        const auto& [t, near, far, hit] = static_cast<const answer::AnswerBuffers<S>&>(buffers);
        run_kernel(buffers.rays(), lift_primitive<S>(left_primitive()), buffers.hits());
        for (std::size_t k = 0; k < all.size(); ++k) {
            NewRay& r = all[k];
            if (!r.tests_left_primitive || r.has(Fault::not_finite)) continue;
            const double first = hit[k] == 0 ? truth::missing : first_reported(told, r, {t[k], near[k], far[k]});
            const double from =
                enters(side) ? exit_of(r.ray, left_primitive()).value_or(0) / 2 : sides_ahead(side).along_rays[k].from;
            if (enters(side) && std::isnan(first)) r.faults |= bit_of(Fault::lost_exit_by_form);
            else if (first < from) r.faults |= bit_of(Fault::self_hit_by_form);
        }
    }

    void run_kernel(const intersect::table::RayBatch<S>& batch, const Primitive<S>& primitive,
                    const intersect::table::HitBatch<S>& answers) const {
        const intersect::table::Intersector& form = *work_.row_.form;
        if constexpr (std::is_same_v<T, float>) form.native32(batch, primitive, answers);
        else if constexpr (std::is_same_v<T, double>) form.native64(batch, primitive, answers);
        else form.rounded(work_.row_.format.parameters, batch, primitive, answers);
    }

    /// First root that the form reports in (tmin, tmax); NaN where there is none.
    static double first_reported(const intersect::Info& info, const NewRay& r, const std::array<S, 3>& told) {
        const std::size_t begin = info.roots == intersect::Roots::both ? 1 : 0;
        const std::size_t end = info.roots == intersect::Roots::both ? 3 : 1;
        for (std::size_t k = begin; k < end; ++k) {
            const auto root = static_cast<double>(told[k]);
            if (root > r.tmin && root < r.tmax) return root;
        }
        return truth::missing;
    }

    const PointWork& work_;
    const FormHit& met_;
    Primitive<double> left_primitive_;
    std::optional<Leaving<T>> leaving_;
    Vec<double> p_{0, 0, 0}, n_{0, 0, 0};
    std::array<std::vector<Departure<T>>, 2> departures_;
    std::array<FarSides, 2> far_;
};

bool PointWork::measure(const FormHit& met, std::array<SideOfPoint, 2>& sides, std::span<StrategyAtPoint> by_strategy,
                        bool quiet) const {
    return with_number(row_.format, [&]<class T>() {
        const TypedPoint<T> point(*this, met);
        if (!point.is_there()) return false;
        for (const Side side : both_sides) {
            const auto s = static_cast<std::size_t>(side);
            sides[s].rays = static_cast<std::uint8_t>(point.count(side));
            sides[s].safe = point.smallest(side, false);
            if (quiet) sides[s].quiet = point.smallest(side, true);
            for (std::size_t k = 0; k < strategies_.size(); ++k) {
                StrategyAtPoint& at = by_strategy[s * strategies_.size() + k];
                for (const NewRay& r : point.rays(*strategies_[k], side)) {
                    for (std::size_t f = 0; f < fault_names.size(); ++f)
                        at.count[f] = static_cast<std::uint8_t>(at.count[f] + ((r.faults >> f) & 1U));
                    at.bad = static_cast<std::uint8_t>(at.bad + (r.is_bad() ? 1 : 0));
                    if (!r.has(Fault::not_finite))
                        at.size = std::max(at.size, distance(r.ray.origin, point.p()) + r.tmin);
                }
            }
        }
        return true;
    });
}

std::vector<NewRay> PointWork::rays(const FormHit& met, const Strategy& strategy, Side side) const {
    return with_number(row_.format, [&]<class T>() { return TypedPoint<T>(*this, met).rays(strategy, side); });
}

bool PointWork::is_safe(const FormHit& met, Side side, double e, bool by_form) const {
    return with_number(row_.format, [&]<class T>() {
        return TypedPoint<T>(*this, met).judge(side, e, by_form) == OffsetVerdict::enough;
    });
}

std::optional<PointWork::Start> PointWork::start(const FormHit& met) const {
    return with_number(row_.format, [&]<class T>() -> std::optional<Start> {
        const TypedPoint<T> point(*this, met);
        if (!point.is_there()) return std::nullopt;
        return Start{point.p(), point.n()};
    });
}

}  // namespace lostbits::measure::offset
