#include "measure/judge/mesh_answers.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "intersect/process/parallel.hpp"
#include "measure/culling/culling.hpp"
#include "measure/truth/lost_bits.hpp"
#include "number/error.hpp"
#include "text/count_with_noun.hpp"

namespace lostbits::measure::judge {

using crossing::MeshCrossings;
using scene::ray_file::AnswerKind, scene::ray_file::Chunk, scene::ray_file::RayFile, scene::ray_file::Records;
using scene::rays::PrimitiveList;

namespace {

/// Number of pieces that are decoded together, and the number of records in each.
constexpr std::size_t max_pieces = 16, records_per_piece = 4096;

PrimitiveList<double> triangles_of(const MeshAnswersRequest& request) {
    scene::rays::RayGroup group;
    group.mesh = request.mesh;
    return scene::rays::primitive_list_of(group);
}

/// Judges one file of answers about a mesh: reads some pieces, measures their answers, and so on.
class MeshFileJudge {
public:
    MeshFileJudge(RayFile& ray_file, const MeshAnswersRequest& request, const ShowAnswers& show)
        : ray_file_(ray_file),
          request_(request),
          show_(show),
          primitives_(triangles_of(request)),
          culler_(primitives_) {
        result_.kind = ray_file.layout().answer_kind();
        if (ray_file.layout().has(scene::ray_file::slot::object)) ray_file.number_primitives(primitives_.size());
    }

    MeshAnswersResult run() {
        while (read_pieces()) measure(complete_answers());
        measure(pending_.size());
        if (result_.answers == 0)
            throw InputError(ray_file_.name() + ": has no records; write one for each ray or point after the header");
        return std::move(result_);
    }

private:
    [[nodiscard]] bool is_list() const { return result_.kind == AnswerKind::all_hits; }

    /// Reads some pieces and appends their answers. Returns false at the end of the file.
    bool read_pieces() {
        std::vector<Records> pieces;
        while (pieces.size() < max_pieces) {
            request_.limit.stop.check();
            Records records;
            if (!ray_file_.next(records_per_piece, records)) break;
            pieces.push_back(std::move(records));
        }

        // Decodes them at the same time, and appends them in order.
        std::vector<Chunk> chunks(pieces.size());
        intersect::process::in_parallel(std::size_t{0}, pieces.size(),
                                        [&](std::size_t k) { chunks[k] = ray_file_.decode(pieces[k]); });
        for (std::size_t k = 0; k < chunks.size(); ++k) {
            for (std::size_t i = 0; i < chunks[k].size(); ++i) append(chunks[k], i);
            result_.rounded_count += chunks[k].rounded_count;
            bytes_ += pieces[k].bytes.size();
        }
        return !pieces.empty();
    }

    void append(const Chunk& chunk, std::size_t i) {
        const std::int32_t count = chunk.counts[i];
        if (is_list() && count > 0) {
            require_next(chunk, i);
        } else {
            pending_.push_back(
                {.record = chunk.first + i, .ray = chunk.rays[i], .range = chunk.rays.range(i), .answer_count = count});
            if (is_list()) pending_.back().answer_count = 0;
        }
        if (!is_list() || count < 0) return;
        pending_.back().hits.push_back({chunk.object[i], chunk.t.empty() ? 0 : chunk.t[i]});
        ++pending_.back().answer_count;
    }
    /// Throws unless this hit, which is not the first of its ray, continues the last ray. Within a chunk, the reader
    /// has already checked that.
    void require_next(const Chunk& chunk, std::size_t i) const {
        const auto throw_error = [&](const std::string& why) {
            throw InputError(chunk.first_place + ": hit_index is " + std::to_string(chunk.counts[i]) + "; " + why);
        };
        if (pending_.empty() || pending_.back().answer_count != chunk.counts[i])
            throw_error("the hits of a ray follow each other in the order of their hit_index, from 0");
        const Ray<double> ray = chunk.rays[i], &last_ray = pending_.back().ray;
        if (ray.origin != last_ray.origin || ray.direction != last_ray.direction)
            throw_error("the record before it is of another ray; write the same ray in all records of its hits");
    }

    /// Number of answers that are complete before the end of the file: in a list, further hits of the last ray may
    /// follow.
    [[nodiscard]] std::size_t complete_answers() const {
        return pending_.size() - (pending_.empty() || !is_list() ? 0 : 1);
    }

    /// Measures the first n answers that were read.
    void measure(std::size_t n) {
        intersect::process::in_parallel(tbb::blocked_range<std::size_t>(0, n, 64), [&](const auto& range) {
            for (std::size_t i = range.begin(); i < range.end(); ++i) {
                request_.limit.stop.check();
                judge(pending_[i]);
            }
        });

        for (std::size_t i = 0; i < n; ++i) add(pending_[i]);
        if (show_) show_(std::span(pending_).first(n));
        pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(n));
        request_.progress(std::exchange(bytes_, 0));
    }

    void judge(JudgedAnswer& answer) const {
        const crossing::Triangles triangles{primitives_, culler_.index_for_truth()};
        if (result_.kind == AnswerKind::inside) return judge_point(answer, triangles);
        const MeshCrossings crossings = find_crossings(answer.ray, triangles, answer.range, request_.limit);
        if (is_list()) {
            answer.judgement = judge_list(answer.ray, answer.hits, crossings, *request_.mesh, request_.contract);
            find_errors(answer);
            return;
        }
        answer.judgement.outcome = judge_count(answer.ray, answer.answer_count, result_.kind == AnswerKind::parity,
                                               crossings, *request_.mesh, request_.contract);
        answer.judgement.crossings = SurfaceCrossings(crossings, request_.contract.facing).all().size();
    }
    void judge_point(JudgedAnswer& answer, const crossing::Triangles& triangles) const {
        const crossing::PointInMesh position = locate_in_mesh(answer.ray.origin, triangles, request_.limit);
        const bool is_balanced = request_.mesh->mesh().counts.unbalanced_edges == 0;
        const bool is_inside = is_balanced ? position.winding != 0 : position.crossings % 2 != 0;
        answer.winding = position.winding;
        answer.judgement.outcome = !position.is_resolved                     ? MeshOutcome::unresolved
                                   : position.is_on_surface                  ? MeshOutcome::on_surface
                                   : is_inside == (answer.answer_count != 0) ? MeshOutcome::agree
                                   : is_inside                               ? MeshOutcome::false_outside
                                                                             : MeshOutcome::false_inside;
    }
    void find_errors(JudgedAnswer& answer) const {
        const FloatFormat& format = ray_file_.format().parameters;
        answer.ulp_errors.assign(answer.hits.size(), truth::missing);
        for (std::size_t k = 0; k < answer.hits.size(); ++k) {
            const crossing::MeshCrossing* const owner = answer.judgement.crossings_of_hits[k];
            const double t = answer.hits[k].t;
            if (owner != nullptr && request_.contract.has_t && !std::isnan(t))
                answer.ulp_errors[k] =
                    truth::ulp_error(t, request_.contract.unit_direction ? owner->distance : owner->t, format);
        }
        answer.judgement.crossings_of_hits.clear();  // the crossings do not outlive `judge`
    }

    void add(const JudgedAnswer& answer) {
        ++result_.answers;
        const auto outcome = static_cast<std::size_t>(answer.judgement.outcome);
        ++result_.outcomes[outcome];
        if (is_fault(answer.judgement.outcome) && !result_.first_faults[outcome])
            result_.first_faults[outcome] = answer;

        result_.crossings += answer.judgement.crossings;
        result_.listed_hit_count += answer.hits.size();
        result_.missing_crossing_count += answer.judgement.missing_crossing_count;
        result_.double_hit_count += answer.judgement.double_hit_count;
        result_.false_hit_count += answer.judgement.false_hit_count;
        result_.neighbour_hit_count += answer.judgement.neighbour_hit_count;

        for (const double ulps : answer.ulp_errors) {
            if (std::isnan(ulps)) continue;
            result_.ulp_errors.add(ulps);
            result_.lost_bits.add(truth::lost_bits(ulps, ray_file_.format().parameters.precision));
        }
    }

    RayFile& ray_file_;
    const MeshAnswersRequest& request_;
    const ShowAnswers& show_;
    PrimitiveList<double> primitives_;
    culling::Culler culler_;
    std::vector<JudgedAnswer> pending_ = {};  ///< answers that were read but not judged yet
    std::uint64_t bytes_ = 0;                 ///< number of bytes of the file that they take
    MeshAnswersResult result_;
};

}  // namespace

std::uint64_t MeshAnswersResult::faults() const {
    std::uint64_t sum = 0;
    for (std::size_t o = 0; o < outcomes.size(); ++o) sum += is_fault(static_cast<MeshOutcome>(o)) ? outcomes[o] : 0;
    return sum;
}

void require_inside(const scene::triangle::Mesh& mesh, const std::string& file) {
    if (mesh.counts.odd_edges == 0) return;
    throw InputError(file + ": has a column inside, but the mesh is not closed: " +
                     text::count_with_noun(mesh.counts.odd_edges, "edge has", "edges have") +
                     " an odd number of faces, so no point is inside or outside; close the mesh, or judge crossings of "
                     "rays");
}

MeshAnswersResult judge_mesh_answers(RayFile& ray_file, const MeshAnswersRequest& request, const ShowAnswers& show) {
    return MeshFileJudge(ray_file, request, show).run();
}

}  // namespace lostbits::measure::judge
