// Indices that find, among many primitives, the ones that a ray can meet, or that rounding can make a form hit.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "geometry/ray.hpp"
#include "number/format.hpp"
#include "number/real.hpp"
#include "scene/rays/primitive_list.hpp"
#include "scene/rays/rays.hpp"

namespace lostbits::measure::culling {

/// Number of primitives from which on an index is worthwhile.
inline constexpr std::size_t min_primitives = 64;

/// Index that finds candidates among many primitives, for rays within stated bounds. The candidates are a superset:
/// they include every primitive that the line of the ray meets at t ≥ 0.
class PrimitiveIndex {
public:
    virtual ~PrimitiveIndex() = default;
    /// Finds the candidates for a ray, in ascending order.
    virtual void find_candidates(const Ray<double>& ray, std::vector<std::uint32_t>& candidates) const = 0;
    /// Appends the candidates for several rays to `candidates`, ray by ray. `ends[i]` is the size of `candidates` after
    /// ray i. For large trees it is faster than ray by ray.
    virtual void append_candidates(std::span<const Ray<double>> rays, std::vector<std::uint32_t>& candidates,
                                   std::span<std::size_t> ends) const;
};

/// Candidates of every ray of a block, found once for all forms: pairs of a ray and a primitive, ray by ray.
class CandidateLists {
public:
    CandidateLists(const PrimitiveIndex& index, const scene::rays::RayBlock& rays);
    /// Copies the candidates of some rays of another list, in the order of `rays`.
    CandidateLists(const CandidateLists& all_rays, std::span<const std::uint32_t> rays);

    [[nodiscard]] std::size_t ray_count() const { return ends_.size() - 1; }
    [[nodiscard]] std::size_t pair_count() const { return primitives_.size(); }
    /// Index of the first pair of ray i; for i = `ray_count()`, the number of pairs.
    [[nodiscard]] std::size_t first_pair(std::size_t i) const { return ends_[i]; }
    /// Primitive of a pair.
    [[nodiscard]] std::uint32_t primitive(std::size_t pair) const { return primitives_[pair]; }
    [[nodiscard]] std::span<const std::uint32_t> candidates_of(std::size_t i) const {
        return std::span(primitives_).subspan(ends_[i], ends_[i + 1] - ends_[i]);
    }

private:
    std::vector<std::size_t> ends_{0};  ///< index of the first pair of each ray, and the number of pairs
    std::vector<std::uint32_t> primitives_;
};

/// Bounds on the numbers of all rays of a picture.
struct RayBounds {
    double max_origin_distance = 0;                             ///< upper bound of |origin|
    double min_direction_length = 0, max_direction_length = 0;  ///< bounds of |direction|
};

/// Bounds of the rays in a block; `join` returns bounds that hold for both.
RayBounds bounds_of(const scene::rays::RayBlock& rays);
RayBounds join(const RayBounds& a, const RayBounds& b);

/// Returns an upper bound of the sum of squares B (see `SphereIndex`), for rays with |O| ≤ `max_origin_distance` and
/// spheres with |G| + r ≤ `reach`.
double bound_sum_of_squares(double max_origin_distance, double reach);
/// True if no square overflows or vanishes in the format when forms test a sphere with this B and this radius. They
/// square lengths and multiply by |d|² and by 4; Newton's step multiplies once more by about as much.
bool squares_are_safe(double sum, double radius, const RayBounds& rays, const FloatFormat& format);

/// Index that finds candidates among n spheres, for rays within stated bounds. The candidates are a superset of the
/// spheres that matter.
///
/// For the truth, they are the spheres that the line approaches to within 2^-40 of the picture's size. That covers this
/// file's arithmetic and the rounding of ideal rays to binary64.
///
/// For forms in a format with unit roundoff u, they include those that rounding can make a form hit. Every form decides
/// by the sign of something like r² − l², where l is the distance of the centre from the line. Its error is at most
/// K·u·B with B = |O|² + (|G| + r)² + (|O| + |G| + r)², where O is the ray's origin and G the sphere's centre, since it
/// adds only products of those lengths. Counting
/// roundings gives K < 30 for the worst of the forms; 64 is used. A sphere is a candidate if l² ≤ r² + 64·u·B. A test
/// compares with brute force for every form. The bound needs squares that neither overflow nor vanish: see `make`.
///
/// Neighbouring spheres are tested together, 64 in a block and 8192 in a page, each with a ball around all that its
/// spheres can reach. A sphereflake is stored with neighbours together, so no tree is needed. The balls take one byte
/// for each sphere. The result is runs of indices, which the kernels read in place.
class SphereIndex : public PrimitiveIndex {
public:
    static constexpr std::size_t spheres_per_block = 64, spheres_per_page = 8192;

    /// Makes an index. Returns nothing if no index can be trusted (squares of the picture's numbers overflow or vanish
    /// in the format), if there are fewer than 64 primitives, or if one is not round: test every primitive then.
    /// `format` null: for the truth.
    static std::shared_ptr<const SphereIndex> make(const scene::rays::PrimitiveList<double>& primitives,
                                                   const RayBounds& bounds, const FloatFormat* format);

    /// A ray with a direction of length one.
    class UnitRay {
    public:
        explicit UnitRay(const Ray<double>& ray);

    private:
        friend SphereIndex;
        Vec<double> origin, unit_direction;
    };

    void find_candidates(const Ray<double>& ray, std::vector<std::uint32_t>& candidates) const override;

    [[nodiscard]] std::size_t page_count() const { return pages_.x.size(); }
    using Run = std::pair<std::size_t, std::size_t>;  ///< indices [first, second)
    enum class Grain { blocks, spheres };
    /// Fills `runs` with indices of page p in ascending order: only the candidates, or whole blocks that contain all of
    /// them.
    void find_runs(const UnitRay& line, std::size_t p, Grain grain, std::vector<Run>& runs) const;

private:
    /// Balls around everything that runs of spheres can reach.
    struct Balls {
        std::vector<double> x, y, z, reach;
        [[nodiscard]] Vec<double> centre(std::size_t i) const { return {x[i], y[i], z[i]}; }
        void add(const Vec<double>& centre, double ball_reach) {
            x.push_back(centre.x);
            y.push_back(centre.y);
            z.push_back(centre.z);
            reach.push_back(ball_reach);
        }
    };
    SphereIndex() = default;
    /// Distance from the centre of a sphere up to which a line may matter to it.
    [[nodiscard]] double reach(const Vec<double>& centre, double radius) const;
    /// Makes the ball of each block, and from these the ball of each page.
    void make_blocks();
    void make_pages();
    [[nodiscard]] bool meets(const UnitRay& line, const Vec<double>& centre, double reach) const;

    scene::rays::PrimitiveList<double> primitives_;
    Balls pages_, blocks_;
    double rounding_factor_ = 0;      ///< 64·u
    double max_origin_distance_ = 0;  ///< upper bound of |O|
    double margin_ = 0;               ///< covers this file's arithmetic
    double max_distance_behind_ = 0;  ///< distance behind the origin at which a candidate may end
};

/// Primitives of a picture and their indices, made once for all of its bands. Not for several threads at once.
class Culler {
public:
    explicit Culler(const scene::file::Scene& scene);
    /// Makes a culler for a single ray, among the primitives of a scene with shared inputs.
    Culler(const scene::file::Scene& scene, const Ray<double>& ray);
    /// Makes a culler for rays that do not belong to a scene.
    Culler(scene::rays::PrimitiveList<double> primitives, const scene::rays::RayBlock& rays);
    /// Makes the parent of the cullers of blocks, for rays that come in blocks.
    explicit Culler(scene::rays::PrimitiveList<double> primitives);
    /// Makes the culler of one block. It shares every index of `parent` that does not depend on bounds of rays. Several
    /// threads may make and use cullers of blocks; `parent` outlives them.
    Culler(const Culler& parent, const scene::rays::RayBlock& rays);
    Culler(Culler&&) = default;
    Culler& operator=(Culler&&) = default;

    /// The primitives as stored, for a scene whose formats share their inputs.
    [[nodiscard]] const scene::rays::PrimitiveList<double>& shared_primitives() const { return stored_; }
    /// The primitives before rounding, for a scene in which each format rounds its own inputs.
    [[nodiscard]] const scene::rays::PrimitiveList<Real>& ideal_primitives() const { return ideal_; }
    /// Index for the truth of the primitives as given. This and the indices of a format may be null: test every
    /// primitive then.
    [[nodiscard]] const PrimitiveIndex* index_for_truth() const { return truth_.get(); }
    /// Indices for forms in a format that receive `primitives`, and for the truth of those primitives. Made on first
    /// use.
    std::shared_ptr<const PrimitiveIndex> index_for_forms(const FloatFormat& format,
                                                          const scene::rays::PrimitiveList<double>& primitives);
    std::shared_ptr<const PrimitiveIndex> index_for_stored_truth(const FloatFormat& format,
                                                                 const scene::rays::PrimitiveList<double>& primitives);

private:
    RayBounds bounds_{0, 1, 1};
    scene::rays::PrimitiveList<Real> ideal_;
    scene::rays::PrimitiveList<double> stored_;
    std::shared_ptr<const PrimitiveIndex> truth_;
    enum class Use : std::uint8_t { forms, stored_truth };
    /// Indices that are made on first use.
    struct LazyIndices {
        std::mutex mutex;
        std::map<std::tuple<Use, int, int, int>, std::shared_ptr<const PrimitiveIndex>> indices;
    };
    std::shared_ptr<const PrimitiveIndex> index_for(Use use, const FloatFormat& format,
                                                    const scene::rays::PrimitiveList<double>& primitives) const;
    const Culler* parent_ = nullptr;
    std::unique_ptr<LazyIndices> lazy_ = std::make_unique<LazyIndices>();
};

/// True if a ray may start in the primitive or on it. False only if bounds on all roundings prove that it does not;
/// results that overflow, underflow or are too close to decide give true. No ray starts in a shape without an inside.
bool may_start_inside(const Ray<double>& ray, const Primitive<double>& primitive);

}  // namespace lostbits::measure::culling
