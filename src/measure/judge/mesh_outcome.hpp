// Outcomes of answers about the whole surface of a mesh: all hits of a ray, the number of its crossings, or whether a
// point is inside.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "intersect/info.hpp"
#include "measure/crossing/mesh_crossings.hpp"
#include "scene/ray_file/layout.hpp"
#include "scene/rays/primitive_list.hpp"

namespace lostbits::measure::judge {

/// The outcome of one ray or point. If a ray has several faults, it has the outcome that comes last here.
enum class MeshOutcome : std::uint8_t {
    agree,
    wrong_neighbour,
    out_of_order,
    double_hit,
    missing_hit,
    false_hit,
    crack,
    false_outside,
    false_inside,
    on_surface,
    not_a_number,
    unresolved
};

/// Name of an outcome, and its meaning for all kinds of answers.
struct MeshOutcomeRow {
    std::string_view name, meaning;
};
inline constexpr std::array<MeshOutcomeRow, 12> mesh_outcome_rows{{
    {"agree", "the answer is right"},
    {"wrong_neighbour",
     "a hit names a triangle that the ray does not meet, beside the triangle that the ray meets "
     "there"},
    {"out_of_order", "a hit is listed after a hit that is farther away"},
    {"double_hit", "two hits are the same crossing of the surface"},
    {"missing_hit", "the ray crosses the surface where no hit is listed, or more often than the answer says"},
    {"false_hit", "a hit is listed where the ray does not cross the surface, or the answer counts more crossings"},
    {"crack", "by the answer, light ends on the wrong side of a surface that the ray does cross"},
    {"false_outside", "the point is inside"},
    {"false_inside", "the point is outside"},
    {"on_surface", "the point lies on a triangle, and either answer is right"},
    {"not_a_number", "the t of a hit is NaN"},
    {"unresolved", "the truth is not proved"},
}};
inline constexpr std::string_view name_of(MeshOutcome outcome) {
    return mesh_outcome_rows[static_cast<std::size_t>(outcome)].name;
}
inline constexpr bool is_fault(MeshOutcome outcome) {
    return outcome != MeshOutcome::agree && outcome != MeshOutcome::on_surface;
}
/// True if answers of this kind can have the outcome.
bool can_have_outcome(MeshOutcome outcome, scene::ray_file::AnswerKind kind);

/// One hit in a list.
struct ListedHit {
    std::int32_t triangle;
    double t;  ///< NaN if it is not a number; 0 if the file has no t
};

/// Meaning of the answers where geometry leaves it open.
struct MeshContract {
    bool has_t = true;
    bool unit_direction = false;  ///< directions have length 1, so t is a distance
    /// A ray that only touches the surface, at a fold or a border, may also be listed without this hit.
    bool touching_may_miss = false;
    intersect::Facing facing = intersect::Facing::both;  ///< side from which triangles are hit
};

/// All crossings of a ray, grouped as crossings of the surface: triangles that the ray meets at one t from one side are
/// one crossing.
class SurfaceCrossings {
public:
    /// `crossings` must outlive this object.
    SurfaceCrossings(const crossing::MeshCrossings& crossings, intersect::Facing facing);

    struct Surface {
        /// Rank in the order of t; crossings at the same t have the same rank.
        int rank;
        bool is_front;  ///< the ray meets the front of the triangles
        std::vector<const crossing::MeshCrossing*> owners;
        bool touches = false;  ///< the ray meets a surface of the other side at the same t
    };
    [[nodiscard]] const std::vector<Surface>& all() const { return surfaces_; }
    /// Number of crossings, except those where the ray only touches the surface.
    [[nodiscard]] std::size_t certain_count() const;

private:
    std::vector<Surface> surfaces_;
};

/// Result of comparing the hits that are listed for a ray with the true ones.
struct ListJudgement {
    MeshOutcome outcome = MeshOutcome::agree;
    std::size_t crossings = 0;               ///< true crossings of the surface
    std::size_t missing_crossing_count = 0;  ///< crossings without a hit
    std::size_t double_hit_count = 0;        ///< hits beyond the first of a crossing
    std::size_t false_hit_count = 0;         ///< hits that are not a crossing
    std::size_t neighbour_hit_count = 0;  ///< hits of a triangle beside the right one, if no other hit is this crossing
    /// For each listed hit, the crossing of its triangle; null if the ray does not meet the triangle.
    std::vector<const crossing::MeshCrossing*> crossings_of_hits = {};
};

/// Compares a list of hits, in its order, with all crossings of a ray. The triangles that the ray meets at a crossing
/// are the *owners* of the crossing. Each hit is assigned to one crossing, or to none, by its triangle:
///
/// - The triangle owns a crossing: the hit is this crossing.
/// - The ray does not meet the triangle, but the triangle shares a vertex with an owner of a crossing and does not face
///   the other way: the hit counts as this crossing. It is a `wrong_neighbour` if no other hit is this crossing, and a
///   `double_hit` otherwise.
/// - Neither: the hit is a `false_hit`.
///
/// A crossing without a hit is missing. To find cracks, lists are counted with each crossing once, and with each false
/// hit as a crossing. The ray is a `crack` if this count differs from the true number of crossings by an odd number,
/// and if some missing crossing does not lie at a border of the mesh.
ListJudgement judge_list(const Ray<double>& ray, std::span<const ListedHit> hits,
                         const crossing::MeshCrossings& crossings, const scene::rays::StoredMesh& mesh,
                         const MeshContract& contract);

/// Compares a number of crossings, or its parity, with all crossings of a ray. If the ray only touches the surface, the
/// two crossings may be counted or not. The outcome is `crack` if the ray crosses the surface and the number differs
/// from the true one by an odd number, unless the ray passes all its crossings at borders of the mesh.
MeshOutcome judge_count(const Ray<double>& ray, std::int32_t count, bool parity,
                        const crossing::MeshCrossings& crossings, const scene::rays::StoredMesh& mesh,
                        const MeshContract& contract);

}  // namespace lostbits::measure::judge
