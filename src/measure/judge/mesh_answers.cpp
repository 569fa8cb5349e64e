#include "measure/judge/mesh_answers.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "intersect/process/parallel.hpp"
#include "measure/culling/culling.hpp"
#include "measure/truth/lost_bits.hpp"
#include "number/error.hpp"
#include "scene/toml/counted.hpp"

namespace lostbits::measure::judge {

using crossing::MeshCrossings;
using scene::dump::AnswerKind, scene::dump::Chunk, scene::dump::Dump, scene::dump::Records;
using scene::rays::PrimitiveList;

namespace {

/// Pieces that are decoded at a time, and their size in records.
constexpr std::size_t pieces_at_once = 16, records_at_once = 4096;

PrimitiveList<double> list_of(const MeshAnswersRequest& request) {
    scene::rays::RayGroup group;
    group.mesh = request.mesh;
    return scene::rays::primitive_list_of(group);
}

class MeshRun {
public:
    MeshRun(Dump& dump, const MeshAnswersRequest& request, const ShowAnswers& show)
        : dump_(dump), request_(request), show_(show), primitives_(list_of(request)), culler_(primitives_) {
        result_.kind = dump.layout().answers();
        if (dump.layout().has(scene::dump::slot::object)) dump.number_primitives(primitives_.size());
    }

    MeshAnswersResult run() {
        while (read()) measure(false);
        measure(true);
        if (result_.rays == 0)
            throw InputError(dump_.name() + ": has no records; write one for each ray or point after the header");
        return std::move(result_);
    }

private:
    [[nodiscard]] bool is_list() const { return result_.kind == AnswerKind::all_hits; }

    /// Reads some pieces and appends their answers. Returns false at the end of the file.
    bool read() {
        std::vector<Records> pieces;
        while (pieces.size() < pieces_at_once) {
            request_.limit.stop.check();
            Records records;
            if (!dump_.next(records_at_once, records)) break;
            pieces.push_back(std::move(records));
        }
        std::vector<Chunk> chunks(pieces.size());
        intersect::process::in_parallel(std::size_t{0}, pieces.size(),
                                        [&](std::size_t k) { chunks[k] = dump_.decode(pieces[k]); });
        for (std::size_t k = 0; k < chunks.size(); ++k) {
            for (std::size_t i = 0; i < chunks[k].size(); ++i) append(chunks[k], i);
            result_.rounded += chunks[k].rounded;
            bytes_ += pieces[k].bytes.size();
        }
        return !pieces.empty();
    }

    void append(const Chunk& chunk, std::size_t i) {
        const std::int32_t count = chunk.counts[i];
        if (is_list() && count > 0) {
            require_next(chunk, i);
        } else {
            waiting_.push_back(
                {.record = chunk.first + i, .ray = chunk.rays[i], .range = chunk.rays.range(i), .count = count});
            if (is_list()) waiting_.back().count = 0;
        }
        if (!is_list() || count < 0) return;
        waiting_.back().hits.push_back({chunk.object[i], chunk.t.empty() ? 0 : chunk.t[i]});
        ++waiting_.back().count;
    }
    /// Requires that a hit after the first follows the one before it. Within a chunk its reader has seen to that.
    void require_next(const Chunk& chunk, std::size_t i) const {
        const auto fail = [&](const std::string& why) {
            throw InputError(chunk.first_place + ": hit_index is " + std::to_string(chunk.counts[i]) + "; " + why);
        };
        if (waiting_.empty() || waiting_.back().count != chunk.counts[i])
            fail("the hits of a ray follow each other in the order of their hit_index, from 0");
        const Ray<double> ray = chunk.rays[i], &before = waiting_.back().ray;
        if (ray.origin != before.origin || ray.direction != before.direction)
            fail("the record before it is of another ray; write the same ray in all records of its hits");
    }

    /// Measures what was read; unless it is the end, the last ray waits, since further hits of it may follow.
    void measure(bool end) {
        const std::size_t n = waiting_.size() - (end || waiting_.empty() || !is_list() ? 0 : 1);
        intersect::process::in_parallel(tbb::blocked_range<std::size_t>(0, n, 64), [&](const auto& range) {
            for (std::size_t i = range.begin(); i < range.end(); ++i) {
                request_.limit.stop.check();
                judge(waiting_[i]);
            }
        });
        for (std::size_t i = 0; i < n; ++i) add(waiting_[i]);
        if (show_) show_(std::span(waiting_).first(n));
        waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(n));
        request_.progress(std::exchange(bytes_, 0));
    }

    void judge(JudgedAnswer& answer) const {
        const crossing::Triangles triangles{primitives_, culler_.for_truth()};
        if (result_.kind == AnswerKind::inside) return judge_point(answer, triangles);
        const MeshCrossings crossings = crossings_of(answer.ray, triangles, answer.range, request_.limit);
        if (is_list()) {
            answer.judgement = judge_list(answer.ray, answer.hits, crossings, *request_.mesh, request_.contract);
            find_errors(answer);
            return;
        }
        answer.judgement.outcome = judge_count(answer.ray, answer.count, result_.kind == AnswerKind::parity, crossings,
                                               *request_.mesh, request_.contract);
        answer.judgement.crossings = SurfaceCrossings(crossings, request_.contract.facing).all().size();
    }
    void judge_point(JudgedAnswer& answer, const crossing::Triangles& triangles) const {
        const crossing::PointInMesh at = place_in_mesh(answer.ray.origin, triangles, request_.limit);
        const bool balanced = request_.mesh->mesh().edges.unbalanced == 0;
        const bool inside = balanced ? at.winding != 0 : at.crossings % 2 != 0;
        answer.winding = at.winding;
        answer.judgement.outcome = !at.is_resolved                 ? MeshOutcome::unresolved
                                   : at.on_surface                 ? MeshOutcome::on_surface
                                   : inside == (answer.count != 0) ? MeshOutcome::agree
                                   : inside                        ? MeshOutcome::false_outside
                                                                   : MeshOutcome::false_inside;
    }
    void find_errors(JudgedAnswer& answer) const {
        const FloatFormat& format = dump_.format().parameters;
        answer.ulps.assign(answer.hits.size(), truth::missing);
        for (std::size_t k = 0; k < answer.hits.size(); ++k) {
            const crossing::MeshCrossing* const met = answer.judgement.met[k];
            const double t = answer.hits[k].t;
            if (met != nullptr && request_.contract.has_t && !std::isnan(t))
                answer.ulps[k] = truth::ulp_error(t, request_.contract.unit ? met->distance : met->t, format);
        }
        answer.judgement.met.clear();  // the crossings end here
    }

    void add(const JudgedAnswer& answer) {
        ++result_.rays;
        const auto outcome = static_cast<std::size_t>(answer.judgement.outcome);
        ++result_.outcomes[outcome];
        if (is_fault(answer.judgement.outcome) && !result_.first[outcome]) result_.first[outcome] = answer;
        result_.crossings += answer.judgement.crossings;
        result_.listed += answer.hits.size();
        result_.missing += answer.judgement.missing;
        result_.doubled += answer.judgement.doubled;
        result_.wrong += answer.judgement.wrong;
        result_.neighbours += answer.judgement.neighbours;
        for (const double ulps : answer.ulps) {
            if (std::isnan(ulps)) continue;
            result_.ulps.add(ulps);
            result_.lost_bits.add(truth::lost_bits(ulps, dump_.format().parameters.precision));
        }
    }

    Dump& dump_;
    const MeshAnswersRequest& request_;
    const ShowAnswers& show_;
    PrimitiveList<double> primitives_;
    culling::Culler culler_;
    std::vector<JudgedAnswer> waiting_ = {};  ///< answers that were read and not judged
    std::uint64_t bytes_ = 0;                 ///< their bytes in the file
    MeshAnswersResult result_;
};

}  // namespace

std::uint64_t MeshAnswersResult::faults() const {
    std::uint64_t all = 0;
    for (std::size_t o = 0; o < outcomes.size(); ++o) all += is_fault(static_cast<MeshOutcome>(o)) ? outcomes[o] : 0;
    return all;
}

void require_inside(const scene::triangle::Mesh& mesh, const std::string& file) {
    if (mesh.edges.odd == 0) return;
    throw InputError(file + ": has a column inside, but the mesh is not closed: " +
                     scene::toml::counted(mesh.edges.odd, "edge has", "edges have") +
                     " an odd number of faces, so no point is inside or outside; close the mesh, or judge crossings of "
                     "rays");
}

MeshAnswersResult judge_mesh_answers(Dump& dump, const MeshAnswersRequest& request, const ShowAnswers& show) {
    return MeshRun(dump, request, show).run();
}

}  // namespace lostbits::measure::judge
