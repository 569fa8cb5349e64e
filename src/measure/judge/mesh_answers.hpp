// Judges a file of answers about the whole surface of a mesh: all hits of rays, numbers of crossings, or points inside.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "measure/judge/mesh_outcome.hpp"
#include "measure/metric/statistics.hpp"
#include "scene/ray_file/ray_file.hpp"

namespace lostbits::measure::judge {

struct MeshAnswersRequest {
    std::shared_ptr<const scene::rays::StoredMesh> mesh;  ///< in the format of the ray file
    MeshContract contract = {};
    truth::ProofLimit limit = {};
    /// Receives the number of bytes of the file done since the last call; may throw to stop.
    std::function<void(std::uint64_t bytes)> progress = [](std::uint64_t) {};
};

/// A ray or point of the file with its answer and the result of judging it.
struct JudgedAnswer {
    std::uint64_t record = 0;  ///< index in the file, from 0, of its first record
    Ray<double> ray{};         ///< for a point, its origin is the point
    Range<double> range{};
    std::vector<ListedHit> hits = {};     ///< filled for `all_hits` only
    std::int32_t answer_count = 0;        ///< the answer as in the file; for `all_hits`, the number of hits
    ListJudgement judgement = {};         ///< for kinds other than `all_hits`, only `outcome` and `crossings` are set
    std::vector<double> ulp_errors = {};  ///< (t − t*)/ulp(t*) of each hit; NaN if the ray does not meet its triangle
    std::int32_t winding = 0;             ///< filled for points only
};

/// Receives the answers of consecutive records, in the order of the file.
using ShowAnswers = std::function<void(std::span<const JudgedAnswer> answers)>;

struct MeshAnswersResult {
    scene::ray_file::AnswerKind kind = scene::ray_file::AnswerKind::none;
    std::uint64_t answers = 0;  ///< rays or points
    std::array<std::uint64_t, mesh_outcome_rows.size()> outcomes{};
    /// The first ray or point of each outcome that is a fault.
    std::array<std::optional<JudgedAnswer>, mesh_outcome_rows.size()> first_faults{};
    std::uint64_t crossings = 0;  ///< true crossings; not set for points
    /// Number of hits in all lists, and the sums of the counts of `ListJudgement`. Set for lists only.
    std::uint64_t listed_hit_count = 0, missing_crossing_count = 0, double_hit_count = 0, false_hit_count = 0,
                  neighbour_hit_count = 0;
    metric::Distribution ulp_errors, lost_bits;  ///< of the hits whose triangle the ray meets
    std::uint64_t rounded_count = 0;             ///< number of values in the file that its format cannot represent

    [[nodiscard]] std::uint64_t outcome_count(MeshOutcome outcome) const {
        return outcomes[static_cast<std::size_t>(outcome)];
    }
    [[nodiscard]] std::uint64_t faults() const;
};

/// Throws InputError if an edge of the mesh has an odd number of faces: no point is inside or outside then. The message
/// begins with `file`.
void require_inside(const scene::triangle::Mesh& mesh, const std::string& file);

/// Reads the ray file to its end. Memory grows with the number of hits of a ray, not with the file. The results do not
/// depend on the number of threads. Throws InputError, with the position, for anything that the ray file refuses, and
/// for a file without records.
MeshAnswersResult judge_mesh_answers(scene::ray_file::RayFile& ray_file, const MeshAnswersRequest& request,
                                     const ShowAnswers& show = {});

}  // namespace lostbits::measure::judge
