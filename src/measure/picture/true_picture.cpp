#include "measure/picture/true_picture.hpp"

#include <algorithm>
#include <cmath>

#include "intersect/process/parallel.hpp"
#include "measure/picture/stored_appearance.hpp"
#include "measure/truth/enclose.hpp"
#include "number/real.hpp"

namespace lostbits::measure::picture {

using scene::file::Stage;
using truth::Band;

namespace {

bool tighten(const Ball& x, Tight& out) {
    if (!x.is_bounded() || x.radius() > picture_tightness) return false;
    out = {x.hi(), x.lo()};
    return true;
}

bool tighten(const Interval& x, Tight& out) {
    if (!x.is_bounded()) return false;
    const long bits = std::max(mpfr_get_prec(x.lower()), mpfr_get_prec(x.upper()));
    mpfr_t work;
    mpfr_init2(work, bits + 64);
    mpfr_sub(work, x.upper(), x.lower(), MPFR_RNDU);
    const bool tight = mpfr_cmp_d(work, picture_tightness) <= 0;
    mpfr_add(work, x.upper(), x.lower(), MPFR_RNDN);
    mpfr_div_2ui(work, work, 1, MPFR_RNDN);
    out.hi = mpfr_get_d(work, MPFR_RNDN);
    mpfr_sub_d(work, work, out.hi, MPFR_RNDN);
    out.lo = mpfr_get_d(work, MPFR_RNDN);
    mpfr_clear(work);
    return tight;
}

/// 255c rounded half up and clamped; false where that is not certain. k is certain where k ≤ 255c + ½ < k + 1, with no
/// lower end for k = 0 and no upper end for k = 255.
template <class E>
bool settle_byte(const E& c, double middle, std::uint8_t& byte) {
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
bool settle(const Vec<E>& colour, TrueColour& out) {
    out.certain = true;
    for (int i = 0; i < 3; ++i) {
        const auto k = static_cast<std::size_t>(i);
        if (!tighten(colour[i], out.channel[k]) || !settle_byte(colour[i], out.channel[k].hi, out.byte[k]))
            out.certain = false;
    }
    return out.certain;
}

/// Ray and primitive in object space. The primitive is as it is stored, up to a scale of the transform; the ray has the
/// same t as in world space.
template <class E>
struct ObjectProblem {
    Ray<E> ray;
    Primitive<E> primitive;

    ObjectProblem(const Ray<E>& world, const Primitive<E>& placed) : ray(world), primitive(placed) {
        if (!placed.placed) return;
        const InObject<E> in = in_object(world, *placed.placed);
        ray = in.ray;
        primitive = scaled(placed, in.scale);
    }
    [[nodiscard]] truth::Enclosed<E> enclosed() const {
        return on_rendered(primitive, [this](const auto& shape) { return truth::enclose<E>(ray, shape); });
    }
};

/// A⁻ᵀ n, made unit. Where no inverse is stored it is taken from adj(A), with the sign of the determinant.
template <class E>
Vec<E> normal_in_world(const Vec<E>& n, const Placement<E>& placed) {
    const Affine<E> m = placed.map();
    if (placed.is_inverse) return unit_of<E>(times(m.rows, n));
    const auto columns = m.adjugate();
    return unit_of<E>(E(placed.orientation) * Vec<E>(dot(columns[0], n), dot(columns[1], n), dot(columns[2], n)));
}

/// Tells if the primitive stands between p and the light: the segment hits it at 0 < t < 1.
template <class E>
Tri blocks(const Primitive<E>& primitive, const Vec<E>& p, const Vec<E>& light) {
    const ObjectProblem<E> asked({p, light - p}, primitive);
    const truth::Enclosed<E> e = asked.enclosed();
    if (!e.hit.is_yes()) return e.hit;
    return e.t > E(0) && e.t < E(1);
}

bool settle(Tri shadowed, TrueShadow& out) {
    out = shadowed.is_unknown() ? TrueShadow::unresolved : shadowed.is_yes() ? TrueShadow::shadowed : TrueShadow::lit;
    return !shadowed.is_unknown();
}

/// Finds true pixels. S stores the ideal numbers: double where all formats share them, Real where each format has its
/// own.
template <class S>
class Reference {
public:
    Reference(const scene::file::Scene& scene, const Band& band, std::span<const Stage> stages, PictureLimit limit)
        : band_(band),
          limit_(limit),
          has_light_(scene.appearance.light.has_value()),
          points_(pixel_points<S>(scene, band.y0(), band.y0() + band.rows())) {
        if constexpr (std::is_same_v<S, double>) {
            rays_ = scene::rays::make_shared_rays(scene, band.y0(), band.y0() + band.rows());
            primitives_ = scene::rays::shared_primitives(scene);
            look_ = shared_appearance(scene.appearance);
        } else {
            rays_ = scene::rays::make_own_rays(scene, band.y0(), band.y0() + band.rows());
            primitives_ = scene.primitives();
            look_ = own_appearance(scene.appearance);
        }
        for (const Stage stage : stages) {
            rules_.emplace_back(static_cast<std::size_t>(stage), shade_rule(scene.appearance, stage));
            casts_ |= rules_.back().second.shadows;
        }
    }

    [[nodiscard]] TruePixel find(std::size_t i) const {
        const truth::Truth& truth = band_.truth(i, intersect::Touching::hit);
        TruePixel pixel;
        if (truth.decision == truth::Truth::Decision::unresolved) {
            if (casts_) pixel.shadow = TrueShadow::unresolved;
            return pixel;
        }
        const auto attempt = [&]<class E>(int bits) {
            pixel.bits = bits;
            return truth.is_hit() ? surface<E>(i, static_cast<std::size_t>(truth.object), pixel)
                                  : background<E>(i, pixel);
        };
        if (attempt.template operator()<Ball>(106)) return pixel;
        for (int bits = std::is_same_v<S, Real> ? 384 : 192; bits <= limit_.bits; bits *= 2) {
            const Interval::Precision precision(bits);
            if (attempt.template operator()<Interval>(bits)) return pixel;
        }
        return pixel;
    }

private:
    template <class E>
    bool surface(std::size_t i, std::size_t object, TruePixel& out) const {
        const Ray<E> ray = lift_ray<E>(rays_[i]);
        const Primitive<E> primitive = lift_primitive<E>(primitives_[object]);
        const ObjectProblem<E> asked(ray, primitive);
        const truth::Enclosed<E> e = asked.enclosed();
        if (!e.hit.is_yes()) return false;
        const Vec<E> p = point_at<E>(ray, e.t);
        Vec<E> n = normal_at<E>(primitive.placed ? point_at<E>(asked.ray, e.t) : p, asked.primitive);
        if (primitive.placed) n = normal_in_world<E>(n, *primitive.placed);
        out.has_normal = true;
        for (int k = 0; k < 3; ++k) out.has_normal &= tighten(n[k], out.normal[static_cast<std::size_t>(k)]);
        bool settled = out.has_normal;

        Vec<E> l(E(0), E(0), E(0)), v = l;
        Tri shadowed = Tri::no;
        if (has_light_) {
            const Vec<E> light = lift_vec<E>(look_.light);
            l = unit_of<E>(light - p);
            v = unit_of<E>(ray.origin - p);
            const Tri faces = dot(n, l) > E(0);
            out.faces_light = faces.is_yes();
            if (casts_) {
                shadowed = in_shadow<E>(p, light, object);
                settled &= settle(faces.is_unknown() ? Tri(Tri::unknown) : shadowed, out.shadow);
            }
        }
        const Paint<E> paint = lifted(look_.paints[object], lift<E, S>);
        for (const auto& [stage, rule] : rules_)
            settled &= settle(shade<E>(paint, rule, shadowed, {n, l, v}), out.colours[stage]);
        return settled;
    }

    template <class E>
    bool background(std::size_t i, TruePixel& out) const {
        bool settled = true;
        Tri shadowed = Tri::no;
        if (casts_ && !points_.empty()) {
            shadowed = in_shadow<E>(lift_vec<E>(points_[i]), lift_vec<E>(look_.light), primitives_.size());
            settled &= settle(shadowed, out.shadow);
        }
        const Vec<E> full = lift_vec<E>(look_.background);
        const E factor = lift<E>(look_.shadow_on_background);
        for (const auto& [stage, rule] : rules_) {
            Vec<E> colour = full;
            for (int k = 0; rule.shadows && k < 3; ++k) colour[k] = select(shadowed, factor * full[k], full[k]);
            settled &= settle(colour, out.colours[stage]);
        }
        return settled;
    }

    template <class E>
    Tri in_shadow(const Vec<E>& p, const Vec<E>& light, std::size_t own) const {
        Tri shadowed = Tri::no;
        for (std::size_t s = 0; s < primitives_.size() && !shadowed.is_yes(); ++s) {
            if (s != own) shadowed = shadowed || blocks<E>(lift_primitive<E>(primitives_[s]), p, light);
        }
        return shadowed;
    }

    const Band& band_;
    PictureLimit limit_;
    bool has_light_, casts_ = false;
    scene::rays::BasicRayBlock<S> rays_;
    std::vector<Primitive<S>> primitives_;
    std::vector<Vec<S>> points_;
    StoredAppearance<S> look_;
    std::vector<std::pair<std::size_t, ShadeRule>> rules_;
};

template <class S>
std::vector<TruePixel> find_all(const Reference<S>& reference, std::size_t count, intersect::process::StopToken stop) {
    std::vector<TruePixel> pixels(count);
    intersect::process::in_parallel(tbb::blocked_range<std::size_t>(0, count, 256), [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
            stop.check();
            pixels[i] = reference.find(i);
        }
    });
    return pixels;
}

}  // namespace

std::vector<TruePixel> find_true_picture(const scene::file::Scene& scene, const Band& band,
                                         std::span<const Stage> stages, PictureLimit limit) {
    if (scene.inputs == scene::file::Inputs::own)
        return find_all(Reference<Real>(scene, band, stages, limit), band.pixels(), limit.stop);
    return find_all(Reference<double>(scene, band, stages, limit), band.pixels(), limit.stop);
}

}  // namespace lostbits::measure::picture
