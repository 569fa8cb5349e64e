#include "measure/truth/culling.hpp"

#include <algorithm>
#include <cmath>

#ifdef LOSTBITS_HAS_EMBREE
#include <embree3/rtcore.h>
#endif

namespace lostbits::measure::truth {
namespace {

constexpr std::size_t least_spheres = 64;

double size_of(const Vec<double>& v) { return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z); }

/// B of the class's comment, for spheres that end within `reach` of the world's origin.
double sum_of(double origin, double reach) {
    return origin * origin + reach * reach + (origin + reach) * (origin + reach);
}

/// B at most, and the radius of the smallest sphere.
struct Extent {
    double sum = 0, least_radius = HUGE_VAL;
};

std::optional<Extent> extent_of(std::span<const Solid<double>> solids, const RayBounds& rays) {
    Extent e;
    double reach = 0;
    for (const Solid<double>& solid : solids) {
        if (solid.shape != Shape::sphere) return std::nullopt;
        const Sphere<double> s = solid.sphere();
        const double one = size_of(s.centre) + s.radius;
        if (!(s.radius > 0) || !std::isfinite(one)) return std::nullopt;
        reach = std::max(reach, one);
        e.least_radius = std::min(e.least_radius, s.radius);
    }
    e.sum = sum_of(rays.origin, reach);
    return e;
}

/// Forms square lengths, multiply by |d|² and by 4, and Newton's step once more by about as much.
bool squares_are_safe(const Extent& e, const RayBounds& rays, const FloatFormat& f) {
    const double d2 = rays.direction * rays.direction, least_d2 = rays.least_direction * rays.least_direction;
    const double largest = 64 * std::max({e.sum * d2, e.sum * d2 * d2, e.sum, d2}),
                 smallest = e.least_radius * e.least_radius * std::min({1.0, least_d2, least_d2 * least_d2});
    return std::log2(largest) < f.emax && std::log2(smallest) > f.emin + f.precision;
}

}  // namespace

RayBounds bounds_of(const scene::rays::RayBlock& rays) {
    RayBounds b{0, HUGE_VAL, 0};
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const Ray<double> r = rays[i];
        const double d = size_of(r.direction);
        // NaN and infinity make every bound useless, and are seen as such.
        if (!std::isfinite(d) || !std::isfinite(size_of(r.origin))) return {HUGE_VAL, 0, HUGE_VAL};
        b.origin = std::max(b.origin, size_of(r.origin));
        b.direction = std::max(b.direction, d);
        b.least_direction = std::min(b.least_direction, d);
    }
    return b;
}

RayBounds join(const RayBounds& a, const RayBounds& b) {
    return {std::max(a.origin, b.origin), std::min(a.least_direction, b.least_direction),
            std::max(a.direction, b.direction)};
}

Culler::Culler(const scene::file::Scene& scene)
    : shared_(scene::rays::shared_solids(scene)), many_(shared_.size() >= least_spheres), bounds_{0, 1, 1} {
    constexpr int rows = 16;
    for (int y = 0; many_ && y < scene.height; y += rows) {
        bounds_ =
            join(bounds_, bounds_of(scene::rays::input_rays(scene, y, std::min(scene.height, y + rows), binary64)));
    }
}

const SphereIndex* Culler::for_truth() {
    if (!many_) return nullptr;
    if (!truth_) truth_ = SphereIndex::make(shared_, bounds_, nullptr);
    return truth_->get();
}

std::shared_ptr<const SphereIndex> Culler::for_format(const FloatFormat& format,
                                                      std::span<const Solid<double>> solids) {
    if (!many_) return nullptr;
    const auto [place, fresh] = formats_.try_emplace({format.precision, format.emin, format.emax});
    if (fresh) {
        // The rays as the format rounds them.
        const double u = std::ldexp(1.0, -format.precision);
        place->second = SphereIndex::make(
            solids,
            {bounds_.origin * (1 + 2 * u), bounds_.least_direction * (1 - 2 * u), bounds_.direction * (1 + 2 * u)},
            &format);
    }
    return place->second;
}

SphereIndex::SphereIndex() = default;
SphereIndex::~SphereIndex() = default;

#ifdef LOSTBITS_HAS_EMBREE

struct SphereIndex::Tree {
    ~Tree() {
        if (scene) rtcReleaseScene(scene);
    }
    const SphereIndex* owner = nullptr;
    RTCScene scene = nullptr;
    double rounding = 0;  ///< 64·u
    double origin = 0;    ///< |O| at most
    double margin = 0;    ///< of Embree's arithmetic
    double behind = 0;    ///< how far in front of the origin a candidate may end
    std::size_t most = 0;

    [[nodiscard]] double reach(std::size_t i) const {
        const auto at = [&](std::size_t k) { return owner->columns64_[k][i]; };
        const double r = at(3);
        return std::sqrt(r * r + rounding * sum_of(origin, size_of({at(0), at(1), at(2)}) + r)) * (1 + 0x1p-20) +
               margin;
    }
};

namespace {

/// What the callback sees of a query. Embree hands back the address of its own part, which stands first.
struct Query {
    RTCIntersectContext context;
    std::vector<std::uint32_t>* found;
    std::size_t most;
};

/// One for the program; it lives as long.
RTCDevice device() {
    static const RTCDevice one = rtcNewDevice(nullptr);
    return one;
}

}  // namespace

std::shared_ptr<const SphereIndex> SphereIndex::make(std::span<const Solid<double>> solids, const RayBounds& rays,
                                                     const FloatFormat* format) {
    if (solids.size() < least_spheres || !std::isfinite(rays.origin) || !(rays.least_direction > 0)) return nullptr;
    const auto extent = extent_of(solids, rays);
    // Embree computes in float: its squares must be safe, too.
    if (!extent || !squares_are_safe(*extent, rays, binary32) || (format && !squares_are_safe(*extent, rays, *format)))
        return nullptr;
    std::shared_ptr<SphereIndex> index(new SphereIndex);
    for (std::size_t k = 0; k < 4; ++k) {
        for (const Solid<double>& s : solids) {
            index->columns64_[k].push_back(s.numbers[k]);
            if (format && format->precision <= binary32.precision)
                index->columns32_[k].push_back(static_cast<float>(s.numbers[k]));
        }
    }
    index->tree_ = std::make_unique<Tree>();
    Tree& tree = *index->tree_;
    tree.owner = index.get();
    tree.rounding = format ? 64 * std::ldexp(1.0, -format->precision) : 0;
    tree.origin = rays.origin;
    tree.margin = 0x1p-18 * std::sqrt(extent->sum);
    tree.behind = std::sqrt(tree.rounding * extent->sum) + tree.margin;
    tree.most = std::max<std::size_t>(16, solids.size() / 32);

    tree.scene = rtcNewScene(device());
    rtcSetSceneFlags(tree.scene, RTC_SCENE_FLAG_ROBUST);
    const RTCGeometry geometry = rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(solids.size()));
    rtcSetGeometryUserData(geometry, &tree);
    rtcSetGeometryBoundsFunction(
        geometry,
        [](const RTCBoundsFunctionArguments* a) {
            const Tree& t = *static_cast<const Tree*>(a->geometryUserPtr);
            const double r = t.reach(a->primID);
            const auto side = [&](std::size_t axis, double offset) {
                return static_cast<float>(t.owner->columns64_[axis][a->primID] + offset);
            };
            // The margin is 2^6 float roundings of the picture's size: rounding these bounds to nearest leaves them
            // outside.
            a->bounds_o->lower_x = side(0, -r), a->bounds_o->lower_y = side(1, -r), a->bounds_o->lower_z = side(2, -r);
            a->bounds_o->upper_x = side(0, r), a->bounds_o->upper_y = side(1, r), a->bounds_o->upper_z = side(2, r);
        },
        nullptr);
    rtcSetGeometryIntersectFunction(geometry, [](const RTCIntersectFunctionNArguments* a) {
        if (a->valid[0] == 0) return;
        Query& query = *reinterpret_cast<Query*>(a->context);
        query.found->push_back(a->primID);
        // Too many already: no box lies before minus infinity, so the walk ends.
        if (query.found->size() > query.most) RTCRayN_tfar(RTCRayHitN_RayN(a->rayhit, a->N), a->N, 0) = -HUGE_VALF;
    });
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(tree.scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(tree.scene);
    return index;
}

bool SphereIndex::candidates(const Ray<double>& ray, std::vector<std::uint32_t>& found) const {
    found.clear();
    Query query{};
    rtcInitIntersectContext(&query.context);
    query.found = &found;
    query.most = 2 * tree_->most;  // boxes let through more than spheres do
    const double length = size_of(ray.direction);
    alignas(16) RTCRayHit hit{};
    hit.ray.org_x = static_cast<float>(ray.origin.x), hit.ray.org_y = static_cast<float>(ray.origin.y),
    hit.ray.org_z = static_cast<float>(ray.origin.z);
    hit.ray.dir_x = static_cast<float>(ray.direction.x), hit.ray.dir_y = static_cast<float>(ray.direction.y),
    hit.ray.dir_z = static_cast<float>(ray.direction.z);
    // Embree takes rays from 0 on: start a little earlier.
    const float back = static_cast<float>(2 * tree_->behind / length);
    hit.ray.org_x -= back * hit.ray.dir_x, hit.ray.org_y -= back * hit.ray.dir_y, hit.ray.org_z -= back * hit.ray.dir_z;
    hit.ray.tnear = 0;
    hit.ray.tfar = HUGE_VALF;
    hit.ray.mask = ~0U;
    hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(tree_->scene, &query.context, &hit);
    if (found.size() > query.most) return false;

    // l² |d|² = |(G − O) × d|²; what the boxes let through at their corners goes.
    const auto off = [&](std::uint32_t i) {
        const Vec<double> f(columns64_[0][i] - ray.origin.x, columns64_[1][i] - ray.origin.y,
                            columns64_[2][i] - ray.origin.z);
        const Vec<double> m(f.y * ray.direction.z - f.z * ray.direction.y,
                            f.z * ray.direction.x - f.x * ray.direction.z,
                            f.x * ray.direction.y - f.y * ray.direction.x);
        return size_of(m) > tree_->reach(i) * length;
    };
    std::erase_if(found, off);
    if (found.size() > tree_->most) return false;
    std::ranges::sort(found);
    found.erase(std::ranges::unique(found).begin(), found.end());
    return true;
}

#else

struct SphereIndex::Tree {};

std::shared_ptr<const SphereIndex> SphereIndex::make(std::span<const Solid<double>>, const RayBounds&,
                                                     const FloatFormat*) {
    return nullptr;
}
bool SphereIndex::candidates(const Ray<double>&, std::vector<std::uint32_t>&) const { return false; }

#endif

}  // namespace lostbits::measure::truth
