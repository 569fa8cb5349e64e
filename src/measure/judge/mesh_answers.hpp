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
#include "scene/dump/dump.hpp"

namespace lostbits::measure::judge {

struct MeshAnswersRequest {
    std::shared_ptr<const scene::rays::MeshColumns> mesh;  ///< in the format of the dump
    MeshContract contract = {};
    truth::TruthLimit limit = {};
    /// Receives the number of bytes of the file done since the last call; may throw to stop.
    std::function<void(std::uint64_t bytes)> progress = [](std::uint64_t) {};
};

/// A ray, or a point, of the file with its answer and what is true.
struct JudgedAnswer {
    std::uint64_t record = 0;  ///< index of its first record in the file, from 0
    Ray<double> ray{};         ///< for a point: its origin
    Range<double> range{};
    std::vector<ListedHit> hits = {};  ///< for `all_hits`
    std::int32_t count = 0;            ///< the answer, for other kinds; the number of hits for `all_hits`
    ListJudgement judgement = {};      ///< for other kinds than `all_hits`, outcome and crossings alone
    std::vector<double> ulps = {};  ///< for each hit: (t − t*)/ulp(t*); NaN where the ray does not meet its triangle
    std::int32_t winding = 0;       ///< for points
};

/// Receives the answers of consecutive records, in the order of the file.
using ShowAnswers = std::function<void(std::span<const JudgedAnswer> answers)>;

struct MeshAnswersResult {
    scene::dump::AnswerKind kind = scene::dump::AnswerKind::none;
    std::uint64_t rays = 0;  ///< rays or points
    std::array<std::uint64_t, mesh_outcome_rows.size()> outcomes{};
    /// The first ray or point of each outcome that is a fault.
    std::array<std::optional<JudgedAnswer>, mesh_outcome_rows.size()> first{};
    /// For lists: true crossings, listed hits, crossings without a hit, hits beyond the first of a crossing, hits that
    /// are no crossing, and hits beside the right triangle. `crossings` is known for numbers of crossings, too.
    std::uint64_t crossings = 0, listed = 0, missing = 0, doubled = 0, wrong = 0, neighbours = 0;
    metric::Distribution ulps, lost_bits;  ///< of the hits whose triangle the ray meets
    std::uint64_t rounded = 0;             ///< numbers of the file that its format cannot represent

    [[nodiscard]] std::uint64_t of(MeshOutcome outcome) const { return outcomes[static_cast<std::size_t>(outcome)]; }
    [[nodiscard]] std::uint64_t faults() const;
};

/// Throws InputError if points cannot be said to be inside of the mesh or not: if an edge has an odd number of faces.
void require_inside(const scene::triangle::Mesh& mesh, const std::string& file);

/// Reads the dump to its end. Memory grows with the number of hits of a ray, not with the file. The results do not
/// depend on the number of threads. Throws InputError, with the position, for anything that the dump refuses, and for a
/// file without records.
MeshAnswersResult judge_mesh_answers(scene::dump::Dump& dump, const MeshAnswersRequest& request,
                                     const ShowAnswers& show = {});

}  // namespace lostbits::measure::judge
