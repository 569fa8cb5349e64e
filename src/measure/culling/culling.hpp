// Which of many spheres a ray can meet at all, or a form can be misled to say that it meets.
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
#include "scene/rays/rays.hpp"
#include "scene/rays/solid_list.hpp"

namespace lostbits::measure::culling {

/// Candidates among many solids for rays within stated bounds: supersets, never missing one that the line of the ray
/// meets at t ≥ 0.
class SolidIndex {
public:
    virtual ~SolidIndex() = default;
    /// Fills `found` with the candidates for a ray in rising order.
    virtual void candidates(const Ray<double>& ray, std::vector<std::uint32_t>& found) const = 0;
};

/// The candidates of every ray of a block, found once for all forms: pairs of a ray and a solid, ray by ray.
class CandidateLists {
public:
    CandidateLists(const SolidIndex& index, const scene::rays::RayBlock& rays);
    /// Those of some rays of `all`, in their order.
    CandidateLists(const CandidateLists& all, std::span<const std::uint32_t> rays);

    [[nodiscard]] std::size_t rays() const { return ends_.size() - 1; }
    [[nodiscard]] std::size_t pairs() const { return solids_.size(); }
    /// The place of the first pair of ray i among all; of ray `rays()` the end.
    [[nodiscard]] std::size_t first(std::size_t i) const { return ends_[i]; }
    /// The solid of a pair.
    [[nodiscard]] std::uint32_t solid(std::size_t pair) const { return solids_[pair]; }
    [[nodiscard]] std::span<const std::uint32_t> of(std::size_t i) const {
        return std::span(solids_).subspan(ends_[i], ends_[i + 1] - ends_[i]);
    }

private:
    std::vector<std::size_t> ends_{0};  ///< where the pairs of each ray begin, and the end of all
    std::vector<std::uint32_t> solids_;
};

/// How large the numbers of a picture are: bounds over all of its rays.
struct RayBounds {
    double origin = 0;                          ///< |origin| at most
    double least_direction = 0, direction = 0;  ///< lengths of the directions
};

/// Of the rays in a block, or of both.
RayBounds bounds_of(const scene::rays::RayBlock& rays);
RayBounds join(const RayBounds& a, const RayBounds& b);

/// B of the index of spheres, for rays that begin within `origin` of the world's origin and solids that end within
/// `reach` of it.
double sum_of_squares(double origin, double reach);
/// Whether what forms for a sphere with this B and this radius square stays in the format. They square lengths,
/// multiply by |d|² and by 4, and Newton's step once more by about as much.
bool squares_are_safe(double sum, double radius, const RayBounds& rays, const FloatFormat& format);

/// Candidates among n spheres for rays within stated bounds: supersets, never missing one that matters.
///
/// For the truth: the spheres that the line comes within 2^-40 of the picture's size of (that covers this file's
/// arithmetic and the rounding of ideal rays to binary64). For forms in a format with unit roundoff u also those that
/// rounding can make a hit of: every form decides by the sign of something like r² − l², l the distance of the centre
/// from the line, which it knows to an error of at most K·u·B with B = |O|² + (|G| + r)² + (|O| + |G| + r)²: products
/// of those lengths are all that it adds. Counting roundings gives K < 30 for the worst of the forms; 64 is taken. A
/// sphere is a candidate where l² ≤ r² + 64·u·B. A test compares with brute force for every form. The bound needs
/// squares that neither overflow nor vanish: see `make`.
///
/// Spheres that stand together are asked together: 64 to a block, 8192 to a page, each with a ball around all that its
/// spheres can reach. The order of a flake keeps neighbours together, so no tree over them is needed: the balls take
/// one byte a sphere, and what is found are runs of places, which the kernels read where they stand.
class SphereIndex : public SolidIndex {
public:
    static constexpr std::size_t block = 64, page = 8192;

    /// Nothing where no index can be trusted (squares of the picture's numbers overflow or vanish in the format), or
    /// where there are fewer than 64 solids or one that is not round: ask every solid then. `format` null: for the
    /// truth.
    static std::shared_ptr<const SphereIndex> make(const scene::rays::SolidList<double>& solids,
                                                   const RayBounds& bounds, const FloatFormat* format);

    /// A ray, with a direction of length one.
    class UnitRay {
    public:
        explicit UnitRay(const Ray<double>& ray);

    private:
        friend SphereIndex;
        Vec<double> origin, along;
    };

    void candidates(const Ray<double>& ray, std::vector<std::uint32_t>& found) const override;

    [[nodiscard]] std::size_t pages() const { return pages_.x.size(); }
    using Run = std::pair<std::size_t, std::size_t>;  ///< places [first, second)
    enum class Grain { blocks, spheres };
    /// Fills `runs` with places of page p in rising order: the candidates alone, or whole blocks with all of them.
    void find_runs(const UnitRay& line, std::size_t p, Grain grain, std::vector<Run>& runs) const;

private:
    /// Balls around what runs of spheres can reach.
    struct Balls {
        std::vector<double> x, y, z, reach;
        [[nodiscard]] Vec<double> centre(std::size_t i) const { return {x[i], y[i], z[i]}; }
        void add(const Vec<double>& centre, double reach_there) {
            x.push_back(centre.x), y.push_back(centre.y), z.push_back(centre.z), reach.push_back(reach_there);
        }
    };
    SphereIndex() = default;
    [[nodiscard]] double reach(const Vec<double>& centre, double radius) const;
    void make_balls();
    [[nodiscard]] bool meets(const UnitRay& line, const Vec<double>& centre, double reach) const;

    scene::rays::SolidList<double> solids_;
    Balls pages_, blocks_;
    double rounding_ = 0;  ///< 64·u
    double origin_ = 0;    ///< |O| at most
    double margin_ = 0;    ///< of this file's arithmetic
    double behind_ = 0;    ///< how far in front of the origin a candidate may end
};

/// The solids of a picture and their indices, made once for all of its bands. One thread at a time.
class Culler {
public:
    explicit Culler(const scene::file::Scene& scene);
    /// Of one ray alone, among the solids of a scene with shared inputs.
    Culler(const scene::file::Scene& scene, const Ray<double>& ray);
    /// Of rays that are not those of a scene.
    Culler(scene::rays::SolidList<double> solids, const scene::rays::RayBlock& rays);
    /// Of rays that come in blocks; and of one of the blocks, which shares every index that no bounds on rays enter.
    /// Several threads may make and ask those of blocks; `of_all` outlives them.
    explicit Culler(scene::rays::SolidList<double> solids);
    Culler(const Culler& of_all, const scene::rays::RayBlock& rays);
    Culler(Culler&&) = default;
    Culler& operator=(Culler&&) = default;

    /// What the bands of a scene with shared inputs, and of one with own inputs, are made of.
    [[nodiscard]] const scene::rays::SolidList<double>& shared() const { return stored_; }
    [[nodiscard]] const scene::rays::SolidList<Real>& ideal() const { return ideal_; }
    /// For the truth of the solids as given. May be null, as may those of a format: ask every solid then.
    [[nodiscard]] const SolidIndex* for_truth() const { return truth_.get(); }
    /// For forms in a format that are given `solids`, and for the truth of those. Made when it is first asked for.
    std::shared_ptr<const SolidIndex> for_forms(const FloatFormat& format,
                                                const scene::rays::SolidList<double>& solids);
    std::shared_ptr<const SolidIndex> for_own_truth(const FloatFormat& format,
                                                    const scene::rays::SolidList<double>& solids);

private:
    RayBounds bounds_{0, 1, 1};
    scene::rays::SolidList<Real> ideal_;
    scene::rays::SolidList<double> stored_;
    std::shared_ptr<const SolidIndex> truth_;
    enum class For : std::uint8_t { forms, own_truth };
    /// Indices that are made when they are first asked for.
    struct Made {
        std::mutex making;
        std::map<std::tuple<For, int, int, int>, std::shared_ptr<const SolidIndex>> indices;
    };
    std::shared_ptr<const SolidIndex> index_for(For use, const FloatFormat& format,
                                                const scene::rays::SolidList<double>& solids) const;
    const Culler* of_all_ = nullptr;
    std::unique_ptr<Made> made_ = std::make_unique<Made>();
};

/// Decides if a ray may start in the solid or on it: no only where bounds on all roundings prove that it does not, so
/// that what overflows, underflows or is too near to tell is a yes. What has no inside has no ray that starts there.
bool may_start_inside(const Ray<double>& ray, const Solid<double>& solid);

}  // namespace lostbits::measure::culling
