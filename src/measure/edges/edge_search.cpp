#include "measure/edges/edge_search.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "intersect/process/parallel.hpp"
#include "measure/culling/culling.hpp"
#include "measure/truth/missing.hpp"
#include "number/rounded.hpp"
#include "scene/rays/primitive_list.hpp"
#include "scene/rays/random.hpp"

namespace lostbits::measure::edges {

using answer::Outcome;
using scene::triangle::SharedEdge;

namespace {

constexpr std::size_t eyes_per_batch = 16, rays_per_eye = 32;

/// One ray of a batch.
struct AimedRay {
    Ray<double> ray;
    double distance;  ///< from the eye, in lengths of the edge
    std::size_t edge, eye;
    std::optional<std::uint32_t> vertex;  ///< the target; absent if it is a point between the ends of the edge
};

scene::rays::RayBlock block_of(const std::vector<AimedRay>& batch) {
    scene::rays::RayBlock rays;
    for (const AimedRay& aimed_ray : batch) rays.push(aimed_ray.ray);
    rays.mark_as_list();
    return rays;
}

/// True if the form also claims another triangle that the ray truly meets at the same t as the answered one.
bool is_tie(const evaluate::BandResult& result, std::size_t i) {
    const auto& candidates = *result.inputs->candidates;
    const auto answered = static_cast<std::size_t>(result.answers->primitive[i]);
    const truth::Truth answered_truth = result.band->truth_of_primitive(i, answered, result.convention);
    for (std::size_t pair = candidates.first_pair(i); pair < candidates.first_pair(i + 1); ++pair) {
        if (result.answers->claimed[pair] == 0 || candidates.primitive(pair) == answered) continue;
        const truth::Truth other_truth =
            result.band->truth_of_primitive(i, candidates.primitive(pair), result.convention);
        if (answered_truth.is_hit() && other_truth.is_hit() && compare(other_truth.t, answered_truth.t) == 0)
            return true;
    }
    return false;
}

/// The searched mesh: its columns, which are the same for every form, and the edges that two faces share.
struct SearchedMesh {
    explicit SearchedMesh(const scene::file::Scene& scene)
        : columns(scene::rays::make_shared_mesh(scene)), edges(find_shared_edges(columns->mesh())) {}

    [[nodiscard]] Vec<double> corner(std::uint32_t face, std::size_t k) const {
        const auto& numbers = (*columns)[face].numbers;
        return {numbers[3 * k], numbers[3 * k + 1], numbers[3 * k + 2]};
    }
    /// Normal of the face, on the side towards which it is wound; of any length.
    [[nodiscard]] Vec<double> normal(std::uint32_t face) const {
        return cross(corner(face, 1) - corner(face, 0), corner(face, 2) - corner(face, 0));
    }
    /// Ends of an edge.
    [[nodiscard]] std::array<Vec<double>, 2> ends(const SharedEdge& edge) const {
        const auto& corners = columns->mesh().faces[edge.faces[0]];
        const auto corner_at = [&](std::uint32_t vertex) {
            return corner(edge.faces[0],
                          static_cast<std::size_t>(std::ranges::find(corners, vertex) - corners.begin()));
        };
        return {corner_at(edge.ends[0]), corner_at(edge.ends[1])};
    }

    /// True if the face contains the edge or the vertex that the ray is aimed at.
    [[nodiscard]] bool touches(const AimedRay& aimed_ray, std::uint32_t face) const {
        if (!aimed_ray.vertex) return std::ranges::count(edges[aimed_ray.edge].faces, face) != 0;
        return std::ranges::count(columns->mesh().faces[face], *aimed_ray.vertex) != 0;
    }
    /// Returns the edge that the ray is aimed at, if the face contains it. If the ray is aimed at a vertex of the face,
    /// returns an edge of the face that ends there. Returns null otherwise.
    [[nodiscard]] const SharedEdge* edge_at(const AimedRay& aimed_ray, std::uint32_t face) const {
        if (!touches(aimed_ray, face)) return nullptr;
        if (!aimed_ray.vertex) return &edges[aimed_ray.edge];
        const auto has_vertex_and_face = [&](const SharedEdge& edge) {
            return std::ranges::count(edge.ends, *aimed_ray.vertex) != 0 && std::ranges::count(edge.faces, face) != 0;
        };
        const auto found = std::ranges::find_if(edges, has_vertex_and_face);
        return found == edges.end() ? nullptr : &*found;
    }

    std::shared_ptr<const scene::rays::StoredMesh> columns;
    std::vector<SharedEdge> edges;
};

/// Returns the edge at which ray i of a batch has an outcome, or null. A ray that truly meets two triangles at one t is
/// not a double hit.
const SharedEdge* edge_with_outcome(Outcome outcome, const SearchedMesh& mesh, const AimedRay& aimed_ray,
                                    const evaluate::BandResult& result, std::size_t i) {
    const truth::Truth ray_truth = result.truth(i);
    if (!ray_truth.is_hit() || result.outcomes[i] != outcome) return nullptr;
    const SharedEdge* const edge = mesh.edge_at(aimed_ray, static_cast<std::uint32_t>(ray_truth.primitive));
    return edge != nullptr && outcome == Outcome::double_hit && is_tie(result, i) ? nullptr : edge;
}

/// Finds the nearest ray of a batch with the wanted outcome.
class NearestFinder {
public:
    NearestFinder(Outcome wanted, const SearchedMesh& mesh, const std::vector<AimedRay>& batch,
                  const evaluate::TestedForm& tested_form)
        : outcome_(wanted), mesh_(mesh), batch_(batch), tested_form_(tested_form) {}

    void inspect(const evaluate::BandResult& result) {
        for (std::size_t i = 0; i < batch_.size(); ++i) {
            if (nearest && batch_[i].distance >= nearest->distance) continue;
            const SharedEdge* const edge = edge_with_outcome(outcome_, mesh_, batch_[i], result, i);
            if (edge == nullptr) continue;
            nearest = {.distance = batch_[i].distance,
                       .ray = batch_[i].ray,
                       .faces = edge->faces,
                       .t = result.answers->hit[i] != 0 ? result.answers->t[i] : truth::missing,
                       .true_t = result.band->rounded_truth(i, binary64, tested_form_.form->info->direction,
                                                            result.convention)};
            nearest_index = i;
        }
    }
    /// The nearest ray.
    [[nodiscard]] const AimedRay& nearest_ray() const { return batch_[nearest_index]; }

    std::optional<NearestRay> nearest;
    std::size_t nearest_index = 0;  ///< index in the batch

private:
    Outcome outcome_;
    const SearchedMesh& mesh_;
    const std::vector<AimedRay>& batch_;
    const evaluate::TestedForm& tested_form_;
};

/// Position of an eye, as a distance and a direction from a point of an edge.
struct Eye {
    std::size_t edge = 0;
    double edge_fraction = 0;  ///< position of the point, from 0 to 1; 0 and 1 are the vertices
    Vec<double> direction;     ///< from the point to the eye, of length 1
    double distance = 0;
};

/// Runs the census of one form, or searches for the nearest ray with one outcome.
class EdgeSearch {
public:
    EdgeSearch(const EdgeRequest& request, const SearchedMesh& mesh, const evaluate::TestedForm& tested_form)
        : request_(request),
          file_(request.search),
          mesh_(mesh),
          tested_form_(tested_form),
          format_(tested_form.format.parameters),
          random_(file_.seed) {}

    void run_census(EdgeResults& finding) {
        std::int64_t rays_left = file_.census_ray_count;
        while (rays_left > 0) {
            std::vector<Eye> batch_eyes;
            std::vector<AimedRay> batch = next_batch(batch_eyes);
            std::erase_if(batch,
                          [this](const AimedRay& aimed_ray) { return !file_.distance.contains(aimed_ray.distance); });
            batch.resize(std::min(batch.size(), static_cast<std::size_t>(rays_left)));
            rays_left -= static_cast<std::int64_t>(batch.size());
            count_batch(batch, finding);
        }
    }

    void find_outcome(EdgeResults& finding, std::size_t outcome_index) {
        outcome_index_ = outcome_index;
        const std::int64_t batch_count = (file_.ray_count + eyes_per_batch * rays_per_eye - 1) /
                                         static_cast<std::int64_t>(eyes_per_batch * rays_per_eye);
        // The tolerance allows for the rounding of the eye's position.
        const auto is_near_enough = [this] { return best_ && best_->distance <= file_.distance.low * (1 + 0x1p-10); };
        for (std::int64_t k = 0; k < batch_count && !is_near_enough(); ++k) {
            std::vector<Eye> batch_eyes;
            const std::vector<AimedRay> batch = next_batch(batch_eyes);
            finding.searched_ray_counts[outcome_index_] += batch.size();

            // Only rays that may have the outcome, at a distance of the file, are compared with the truth.
            std::vector<AimedRay> suspects = suspicious_rays(batch, [this](bool may_crack, bool may_hit_twice) {
                return searched_outcomes.at(outcome_index_) == Outcome::crack ? may_crack : may_hit_twice;
            });
            std::erase_if(suspects,
                          [this](const AimedRay& aimed_ray) { return !file_.distance.contains(aimed_ray.distance); });
            if (suspects.empty()) continue;

            const NearestFinder finder = nearest_among(suspects);
            if (!finder.nearest || (best_ && finder.nearest->distance >= best_->distance)) continue;
            // Test the ray again by itself. In a batch, a form is tested on more triangles, because the boxes are as
            // wide as the farthest ray of the batch needs.
            if (!nearest_among({finder.nearest_ray()}).nearest) continue;
            best_ = finder.nearest;
            best_eye_ = batch_eyes[finder.nearest_ray().eye];
        }
        finding.nearest[outcome_index_] = best_;
    }

private:
    static EdgeCounts& count_of(const AimedRay& aimed_ray, EdgeResults& finding) {
        return finding.census.at(static_cast<std::size_t>(aimed_ray.vertex ? EdgeTarget::vertex : EdgeTarget::edge));
    }

    /// Adds the rays of a batch to the census, and their outcomes.
    void count_batch(const std::vector<AimedRay>& batch, EdgeResults& finding) const {
        for (const AimedRay& aimed_ray : batch) ++count_of(aimed_ray, finding).ray_count;
        const std::vector<AimedRay> suspects =
            suspicious_rays(batch, [](bool may_crack, bool may_hit_twice) { return may_crack || may_hit_twice; });
        if (suspects.empty()) return;
        measure(suspects, [&](const evaluate::BandResult& result) {
            for (std::size_t i = 0; i < suspects.size(); ++i)
                for (std::size_t k = 0; k < searched_outcomes.size(); ++k)
                    count_of(suspects[i], finding).outcome_counts.at(k) +=
                        edge_with_outcome(searched_outcomes.at(k), mesh_, suspects[i], result, i) != nullptr;
        });
    }

    Vec<double> random_vector() { return {random_.between(-1, 1), random_.between(-1, 1), random_.between(-1, 1)}; }

    /// Draws a direction on the side towards which the edge's faces are wound.
    Vec<double> random_direction(const SharedEdge& edge) {
        Vec<double> v = random_vector();
        while (!(dot(v, v) <= 1 && dot(v, v) > 0x1p-20)) v = random_vector();
        Vec<double> outward(0, 0, 0);
        for (const std::uint32_t face : edge.faces) {
            const Vec<double> n = mesh_.normal(face);
            outward = outward + 1 / length(n) * n;
        }
        return (dot(v, outward) < 0 ? -1 : 1) / length(v) * v;
    }

    Eye draw_eye_anywhere() {
        Eye eye;
        eye.edge = static_cast<std::size_t>(random_.below(static_cast<int>(mesh_.edges.size())));
        eye.edge_fraction = random_.below(4) == 0 ? random_.below(2) : random_.unit();
        eye.direction = random_direction(mesh_.edges[eye.edge]);
        return eye;
    }

    Eye draw_eye_near(const Eye& best) {
        Eye eye = best;
        const double step = std::ldexp(1, -random_.below(24));
        const bool at_vertex = eye.edge_fraction == 0 || eye.edge_fraction == 1;
        if (!at_vertex) eye.edge_fraction = std::clamp(eye.edge_fraction + step * random_.between(-1, 1), 0.0, 1.0);
        eye.direction = eye.direction + step * random_vector();
        eye.direction = 1 / length(eye.direction) * eye.direction;
        return eye;
    }

    Eye draw_eye() {
        const double high = best_ ? best_->distance : file_.distance.high;
        if (best_ && random_.below(2) == 0) {
            Eye eye = draw_eye_near(best_eye_);
            const double low = std::min(high, std::max(file_.distance.low, high / 16)), u = random_.unit();
            eye.distance = high / (1 + (high / low - 1) * u * u * u);
            return eye;
        }
        Eye eye = draw_eye_anywhere();
        eye.distance = random_.in_octaves(std::min(high, file_.distance.low), high);
        return eye;
    }

    /// Draws the eyes of a batch and their rays.
    std::vector<AimedRay> next_batch(std::vector<Eye>& batch_eyes) {
        std::vector<AimedRay> batch;
        while (batch_eyes.size() < eyes_per_batch) {
            const Eye eye = batch_eyes.emplace_back(draw_eye());
            draw_rays_of_eye(eye, batch_eyes.size() - 1, batch);
        }
        return batch;
    }

    /// Appends the rays of an eye to a batch: one at its point of the edge, the others perturbed.
    void draw_rays_of_eye(const Eye& eye, std::size_t eye_index, std::vector<AimedRay>& batch) {
        const auto round_vector = [this](Vec<double> v) {
            for (int k = 0; k < 3; ++k) v[k] = rounding::to_format(v[k], 0, format_);
            return v;
        };

        // The target.
        const SharedEdge& edge = mesh_.edges[eye.edge];
        const auto [a, b] = mesh_.ends(edge);
        std::optional<std::uint32_t> vertex;
        if (eye.edge_fraction == 0 || eye.edge_fraction == 1) vertex = edge.ends[eye.edge_fraction == 0 ? 0 : 1];
        const Vec<double> point = a + eye.edge_fraction * (b - a);

        // The first ray, in numbers of the format.
        const double edge_length = length(b - a);
        const Vec<double> origin = round_vector(point + eye.distance * edge_length * eye.direction),
                          to_point = point - origin;
        const Vec<double> direction = round_vector((1 + random_.unit()) / length(to_point) * to_point);

        for (std::size_t k = 0; k < rays_per_eye; ++k)
            batch.push_back({.ray = {origin, k == 0 ? direction : perturb(direction)},
                             .distance = length(to_point) / edge_length,
                             .edge = eye.edge,
                             .eye = eye_index,
                             .vertex = vertex});
    }

    Vec<double> perturb(Vec<double> direction) {
        for (int k = 0; k < 3; ++k) {
            const std::int64_t steps = random_.below(2 * file_.ulps + 1) - file_.ulps;
            direction[k] = truth::number_at(truth::ordinal(direction[k], format_) + steps, format_);
        }
        return direction;
    }

    /// Returns the rays of a batch for which `is_wanted(may_crack, may_hit_twice)` is true. A ray may be a crack if the
    /// form claims no face of the edge or vertex that it is aimed at. It may be a double hit if the form claims at
    /// least two faces. The truth of the other rays is not computed, because it takes a hundred times as long.
    template <class IsWanted>
    std::vector<AimedRay> suspicious_rays(const std::vector<AimedRay>& batch, const IsWanted& is_wanted) const {
        if (tested_form_.form->info->direction == intersect::Direction::unit) return batch;

        // Runs the form on the triangles that each ray may meet.
        truth::FormatInputs inputs{.format = tested_form_.format, .rays = block_of(batch), .stop = request_.limit.stop};
        const scene::rays::PrimitiveList<double> primitives =
            scene::rays::primitive_list_of({.rays = {}, .primitives = {}, .mesh = mesh_.columns});
        inputs.primitives = round_primitives(primitives, tested_form_.format.parameters);
        culling::Culler culler(primitives, inputs.rays);
        inputs.candidates = std::make_shared<culling::CandidateLists>(
            *culler.index_for_forms(tested_form_.format.parameters, inputs.primitives), inputs.rays);
        const answer::Answers answers = answer::evaluate(*tested_form_.form, inputs);

        // Counts the claimed triangles of each ray, and those of them at the target.
        std::vector<AimedRay> suspects;
        for (std::size_t i = 0; i < batch.size(); ++i) {
            std::size_t claimed = 0, touched = 0;
            for (std::size_t pair = inputs.candidates->first_pair(i); pair < inputs.candidates->first_pair(i + 1);
                 ++pair) {
                if (answers.claimed[pair] == 0) continue;
                ++claimed;
                touched += mesh_.touches(batch[i], inputs.candidates->primitive(pair));
            }
            if (is_wanted(touched == 0, claimed >= 2)) suspects.push_back(batch[i]);
        }
        return suspects;
    }

    NearestFinder nearest_among(const std::vector<AimedRay>& batch) const {
        NearestFinder finder(searched_outcomes.at(outcome_index_), mesh_, batch, tested_form_);
        measure(batch, [&finder](const evaluate::BandResult& result) { finder.inspect(result); });
        return finder;
    }

    void measure(const std::vector<AimedRay>& batch, const evaluate::Show& show) const {
        request_.limit.stop.check();
        scene::rays::RayGroup group{.rays = block_of(batch), .primitives = {}};
        group.mesh = mesh_.columns;
        culling::Culler culler(scene::rays::primitive_list_of(group), group.rays);
        truth::Band band(std::move(group), request_.limit, &culler);
        const auto inputs = band.inputs_for(tested_form_.format, *tested_form_.form->info);
        evaluate::FormSummary summary(metrics_);
        evaluate::measure_form({tested_form_, metrics_, show}, band, inputs, summary);
    }

    const EdgeRequest& request_;
    const scene::sweep::EdgeSearchFile& file_;
    const SearchedMesh& mesh_;
    const evaluate::TestedForm& tested_form_;
    std::size_t outcome_index_ = 0;  ///< index of the outcome in `searched_outcomes`
    FloatFormat format_;             ///< format of the numbers of rays
    scene::rays::Random random_;
    std::vector<const metric::Metric*> metrics_{metric::find_metric("lost_bits"), metric::find_metric("ulp_error")};
    std::optional<NearestRay> best_;
    Eye best_eye_;
};

}  // namespace

std::vector<EdgeResults> search_edges(const EdgeRequest& request) {
    const SearchedMesh mesh(request.search.scene);
    const auto units = request.share.unit_range(request.tested_forms.size());
    std::vector<EdgeResults> findings(units.size());
    intersect::process::in_parallel(std::size_t{0}, findings.size() * progress_units_per_form, [&](std::size_t k) {
        const std::size_t form_index = k / progress_units_per_form, unit = k % progress_units_per_form;
        EdgeSearch search(request, mesh, request.tested_forms[units.first + form_index]);
        if (unit == searched_outcomes.size()) search.run_census(findings[form_index]);
        else if (!request.census_only) search.find_outcome(findings[form_index], unit);
        request.progress(1);
    });
    return findings;
}

}  // namespace lostbits::measure::edges
