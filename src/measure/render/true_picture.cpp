#include "measure/render/true_picture.hpp"

#include <algorithm>
#include <cmath>

#include "intersect/process/parallel.hpp"
#include "measure/render/stored_appearance.hpp"
#include "measure/truth/enclose.hpp"
#include "number/real.hpp"

namespace lostbits::measure::render {

using scene::file::Stage;
using truth::Band;

namespace {

/// Finds the two parts of a number. Returns false if it is not known to within `picture_tightness`.
bool find_parts(const Ball& x, TwoPartNumber& parts) {
    if (!x.is_bounded() || x.radius() > picture_tightness) return false;
    parts = {x.hi(), x.lo()};
    return true;
}

bool find_parts(const Interval& x, TwoPartNumber& parts) {
    if (!x.is_bounded()) return false;
    const long bits = std::max(mpfr_get_prec(x.lower()), mpfr_get_prec(x.upper()));
    mpfr_t work;
    mpfr_init2(work, bits + 64);
    mpfr_sub(work, x.upper(), x.lower(), MPFR_RNDU);
    const bool is_tight = mpfr_cmp_d(work, picture_tightness) <= 0;

    // The middle, rounded to a double, and the rest of it
    mpfr_add(work, x.upper(), x.lower(), MPFR_RNDN);
    mpfr_div_2ui(work, work, 1, MPFR_RNDN);
    parts.hi = mpfr_get_d(work, MPFR_RNDN);
    mpfr_sub_d(work, work, parts.hi, MPFR_RNDN);
    parts.lo = mpfr_get_d(work, MPFR_RNDN);
    mpfr_clear(work);
    return is_tight;
}

/// Finds 255c, rounded half up and clamped to 0…255. Returns false if the byte is not proved. A byte k is proved if k ≤
/// 255c + ½ < k + 1, with no lower bound for k = 0 and no upper bound for k = 255.
template <class E>
bool find_byte(const E& c, double middle, std::uint8_t& byte) {
    const E x = E(255) * c + E(1) / E(2);
    const double guess = std::floor(255 * middle + 0.5);
    for (const double candidate : {guess, guess - 1, guess + 1}) {
        const int k = static_cast<int>(std::clamp(candidate, 0.0, 255.0));
        if ((k > 0 && !(x >= E(k)).is_yes()) || (k < 255 && !(x < E(k + 1)).is_yes())) continue;
        byte = static_cast<std::uint8_t>(k);
        return true;
    }
    return false;
}

template <class E>
bool find_colour(const Vec<E>& colour, TrueColour& colour_out) {
    colour_out.is_certain = true;
    for (int i = 0; i < 3; ++i) {
        const auto k = static_cast<std::size_t>(i);
        if (!find_parts(colour[i], colour_out.channel[k]) ||
            !find_byte(colour[i], colour_out.channel[k].hi, colour_out.byte[k]))
            colour_out.is_certain = false;
    }
    return colour_out.is_certain;
}

/// Ray and primitive in object space. The primitive is the stored one, scaled as the transform method requires. The ray
/// has the same t as in world space.
template <class E>
struct ObjectQuery {
    Ray<E> ray;
    Primitive<E> primitive;

    ObjectQuery(const Ray<E>& world_ray, const Primitive<E>& world_primitive)
        : ray(world_ray), primitive(world_primitive) {
        if (!world_primitive.transform) return;
        const ObjectSpaceRay<E> object_ray = to_object_space(world_ray, *world_primitive.transform);
        ray = object_ray.ray;
        primitive = scaled(world_primitive, object_ray.scale);
    }
    [[nodiscard]] truth::EnclosedHit<E> enclosed() const {
        return visit_rendered_shape(primitive, [this](const auto& shape) { return truth::enclose<E>(ray, shape); });
    }
};

/// Returns A⁻ᵀ n, made unit. If no inverse is stored, A⁻ᵀ comes from adj(A), with the sign of the determinant.
template <class E>
Vec<E> normal_in_world(const Vec<E>& n, const Transform<E>& transform) {
    const Affine<E> m = transform.map();
    if (transform.is_inverse) return unit_of<E>(times(m.rows, n));
    const auto columns = m.adjugate();
    return unit_of<E>(E(transform.orientation) * Vec<E>(dot(columns[0], n), dot(columns[1], n), dot(columns[2], n)));
}

/// Decides whether the primitive is between p and the light: whether the segment hits it at 0 < t < 1.
template <class E>
Tri blocks(const Primitive<E>& primitive, const Vec<E>& p, const Vec<E>& light) {
    const ObjectQuery<E> segment({p, light - p}, primitive);
    const truth::EnclosedHit<E> enclosed = segment.enclosed();
    if (!enclosed.hit.is_yes()) return enclosed.hit;
    return enclosed.t > E(0) && enclosed.t < E(1);
}

bool find_shadow(Tri shadowed, TrueShadow& shadow) {
    shadow = shadowed.is_unknown() ? TrueShadow::unresolved
             : shadowed.is_yes()   ? TrueShadow::shadowed
                                   : TrueShadow::lit;
    return !shadowed.is_unknown();
}

/// Finds the true pixels of a band. S is the type of the ideal numbers: double if all formats share them, Real if each
/// format has its own.
template <class S>
class TruePixelFinder {
public:
    TruePixelFinder(const scene::file::Scene& scene, const Band& band, std::span<const Stage> stages,
                    PictureLimit limit)
        : band_(band),
          limit_(limit),
          has_light_(scene.appearance.light.has_value()),
          points_(make_pixel_points<S>(scene, band.y0(), band.y0() + band.scanlines())) {
        if constexpr (std::is_same_v<S, double>) {
            rays_ = scene::rays::make_shared_rays(scene, band.y0(), band.y0() + band.scanlines());
            primitives_ = scene::rays::make_shared_primitives(scene);
            appearance_ = make_shared_appearance(scene.appearance);
        } else {
            rays_ = scene::rays::make_own_rays(scene, band.y0(), band.y0() + band.scanlines());
            primitives_ = scene.primitives();
            appearance_ = make_own_appearance(scene.appearance);
        }
        for (const Stage stage : stages) {
            rules_.emplace_back(static_cast<std::size_t>(stage), make_shade_rule(scene.appearance, stage));
            casts_shadows_ |= rules_.back().second.has_shadows;
        }
    }

    [[nodiscard]] TruePixel find(std::size_t i) const {
        const truth::Truth& ray_truth = band_.truth(i, intersect::Touching::hit);
        TruePixel pixel;
        if (ray_truth.decision == truth::Truth::Decision::unresolved) {
            if (casts_shadows_) pixel.shadow = TrueShadow::unresolved;
            return pixel;
        }

        const auto try_precision = [&]<class E>(int bits) {
            pixel.bits = bits;
            return ray_truth.is_hit() ? find_surface_pixel<E>(i, static_cast<std::size_t>(ray_truth.primitive), pixel)
                                      : find_background_pixel<E>(i, pixel);
        };
        if (try_precision.template operator()<Ball>(106)) return pixel;
        for (int bits = std::is_same_v<S, Real> ? 384 : 192; bits <= limit_.max_bits; bits *= 2) {
            const Interval::Precision precision(bits);
            if (try_precision.template operator()<Interval>(bits)) return pixel;
        }
        return pixel;
    }

private:
    template <class E>
    bool find_surface_pixel(std::size_t i, std::size_t primitive_index, TruePixel& pixel) const {
        const Ray<E> ray = lift_ray<E>(rays_[i]);
        const Primitive<E> primitive = lift_primitive<E>(primitives_[primitive_index]);
        const ObjectQuery<E> query(ray, primitive);
        const truth::EnclosedHit<E> enclosed = query.enclosed();
        if (!enclosed.hit.is_yes()) return false;

        const Vec<E> p = point_at<E>(ray, enclosed.t);
        Vec<E> n = normal_at<E>(primitive.transform ? point_at<E>(query.ray, enclosed.t) : p, query.primitive);
        if (primitive.transform) n = normal_in_world<E>(n, *primitive.transform);
        pixel.has_normal = true;
        for (int k = 0; k < 3; ++k) pixel.has_normal &= find_parts(n[k], pixel.normal[k]);
        bool is_proved = pixel.has_normal;

        // Directions to the light and to the eye, and the shadow
        Vec<E> l(E(0), E(0), E(0)), v = l;
        Tri shadowed = Tri::no;
        if (has_light_) {
            const Vec<E> light = lift_vec<E>(appearance_.light);
            l = unit_of<E>(light - p);
            v = unit_of<E>(ray.origin - p);
            const Tri faces_light = dot(n, l) > E(0);
            pixel.faces_light = faces_light.is_yes();
            if (casts_shadows_) {
                shadowed = in_shadow<E>(p, light, primitive_index);
                is_proved &= find_shadow(faces_light.is_unknown() ? Tri(Tri::unknown) : shadowed, pixel.shadow);
            }
        }

        const Paint<E> paint = lift_numbers(appearance_.paints[primitive_index], lift<E, S>);
        for (const auto& [stage, rule] : rules_)
            is_proved &= find_colour(shade<E>(paint, rule, shadowed, {n, l, v}), pixel.colours[stage]);
        return is_proved;
    }

    template <class E>
    bool find_background_pixel(std::size_t i, TruePixel& pixel) const {
        bool is_proved = true;
        Tri shadowed = Tri::no;
        if (casts_shadows_ && !points_.empty()) {
            shadowed = in_shadow<E>(lift_vec<E>(points_[i]), lift_vec<E>(appearance_.light), primitives_.size());
            is_proved &= find_shadow(shadowed, pixel.shadow);
        }

        const Vec<E> unshadowed = lift_vec<E>(appearance_.background);
        const E factor = lift<E>(appearance_.shadow_on_background);
        for (const auto& [stage, rule] : rules_) {
            Vec<E> colour = unshadowed;
            for (int k = 0; rule.has_shadows && k < 3; ++k)
                colour[k] = select(shadowed, factor * unshadowed[k], unshadowed[k]);
            is_proved &= find_colour(colour, pixel.colours[stage]);
        }
        return is_proved;
    }

    template <class E>
    Tri in_shadow(const Vec<E>& p, const Vec<E>& light, std::size_t departed_sphere) const {
        Tri shadowed = Tri::no;
        for (std::size_t k = 0; k < primitives_.size() && !shadowed.is_yes(); ++k) {
            if (k != departed_sphere) shadowed = shadowed || blocks<E>(lift_primitive<E>(primitives_[k]), p, light);
        }
        return shadowed;
    }

    const Band& band_;
    PictureLimit limit_;
    bool has_light_, casts_shadows_ = false;
    scene::rays::BasicRayBlock<S> rays_;
    std::vector<Primitive<S>> primitives_;
    std::vector<Vec<S>> points_;
    StoredAppearance<S> appearance_;
    std::vector<std::pair<std::size_t, ShadeRule>> rules_;
};

template <class S>
std::vector<TruePixel> find_all_pixels(const TruePixelFinder<S>& finder, std::size_t count,
                                       intersect::process::StopToken stop) {
    std::vector<TruePixel> pixels(count);
    intersect::process::in_parallel(tbb::blocked_range<std::size_t>(0, count, 256), [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
            stop.check();
            pixels[i] = finder.find(i);
        }
    });
    return pixels;
}

}  // namespace

std::vector<TruePixel> find_true_picture(const scene::file::Scene& scene, const Band& band,
                                         std::span<const Stage> stages, PictureLimit limit) {
    if (scene.inputs == scene::file::InputRounding::own)
        return find_all_pixels(TruePixelFinder<Real>(scene, band, stages, limit), band.pixel_count(), limit.stop);
    return find_all_pixels(TruePixelFinder<double>(scene, band, stages, limit), band.pixel_count(), limit.stop);
}

}  // namespace lostbits::measure::render
