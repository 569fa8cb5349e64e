#include "measure/edges/nearest.hpp"

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

constexpr std::size_t eyes = 16, rays_of_eye = 32;

/// One ray of a batch.
struct Aimed {
    Ray<double> ray;
    double distance;  ///< from the eye, in lengths of the edge
    std::size_t edge, eye;
    std::optional<std::uint32_t> vertex;  ///< aimed at; absent: a point between the ends of the edge
};

scene::rays::RayBlock block_of(const std::vector<Aimed>& batch) {
    scene::rays::RayBlock rays;
    for (const Aimed& one : batch) rays.push(one.ray);
    rays.set_as_list();
    return rays;
}

/// True if the form also claims another triangle that the ray truly meets at the same t as the answered one.
bool is_tie(const evaluate::BandResult& result, std::size_t i) {
    const auto& candidates = *result.inputs->candidates;
    const auto met = static_cast<std::size_t>(result.answers->object[i]);
    const truth::Truth there = result.band->truth_of_primitive(i, met, result.convention);
    for (std::size_t pair = candidates.first(i); pair < candidates.first(i + 1); ++pair) {
        if (result.answers->claimed[pair] == 0 || candidates.primitive(pair) == met) continue;
        const truth::Truth here = result.band->truth_of_primitive(i, candidates.primitive(pair), result.convention);
        if (there.is_hit() && here.is_hit() && compare(here.t, there.t) == 0) return true;
    }
    return false;
}

/// The mesh in the form in which every row receives it.
struct Subject {
    explicit Subject(const scene::file::Scene& scene)
        : columns(scene::rays::shared_mesh(scene)), edges(shared_edges(columns->mesh())) {}

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
        const auto of = [&](std::uint32_t vertex) {
            return corner(edge.faces[0],
                          static_cast<std::size_t>(std::ranges::find(corners, vertex) - corners.begin()));
        };
        return {of(edge.ends[0]), of(edge.ends[1])};
    }

    /// True if the face has the edge or the vertex that the ray is aimed at.
    [[nodiscard]] bool touches(const Aimed& one, std::uint32_t face) const {
        if (!one.vertex) return std::ranges::count(edges[one.edge].faces, face) != 0;
        return std::ranges::count(columns->mesh().faces[face], *one.vertex) != 0;
    }
    /// Edge of the face that the ray is aimed at, or that ends at the vertex that it is aimed at; null if the face has
    /// neither.
    [[nodiscard]] const SharedEdge* edge_at(const Aimed& one, std::uint32_t face) const {
        if (!touches(one, face)) return nullptr;
        if (!one.vertex) return &edges[one.edge];
        const auto has_both = [&](const SharedEdge& edge) {
            return std::ranges::count(edge.ends, *one.vertex) != 0 && std::ranges::count(edge.faces, face) != 0;
        };
        const auto found = std::ranges::find_if(edges, has_both);
        return found == edges.end() ? nullptr : &*found;
    }

    std::shared_ptr<const scene::rays::MeshColumns> columns;
    std::vector<SharedEdge> edges;
};

/// Returns the edge at which ray i of a batch has an outcome, or null. If a ray truly meets two triangles at
/// one t, that is no double hit.
const SharedEdge* edge_with(Outcome outcome, const Subject& subject, const Aimed& one,
                            const evaluate::BandResult& result, std::size_t i) {
    const truth::Truth truth = result.truth(i);
    if (!truth.is_hit() || result.outcomes[i] != outcome) return nullptr;
    const SharedEdge* const edge = subject.edge_at(one, static_cast<std::uint32_t>(truth.object));
    return edge != nullptr && outcome == Outcome::double_hit && is_tie(result, i) ? nullptr : edge;
}

/// Finds the nearest ray of a batch with the wanted outcome.
class Judge {
public:
    Judge(Outcome wanted, const Subject& subject, const std::vector<Aimed>& batch, const evaluate::TestedForm& row)
        : wanted_(wanted), subject_(subject), batch_(batch), row_(row) {}

    void look_at(const evaluate::BandResult& result) {
        for (std::size_t i = 0; i < batch_.size(); ++i) {
            if (nearest && batch_[i].distance >= nearest->distance) continue;
            const SharedEdge* const edge = edge_with(wanted_, subject_, batch_[i], result, i);
            if (edge == nullptr) continue;
            nearest = {.distance = batch_[i].distance,
                       .ray = batch_[i].ray,
                       .faces = edge->faces,
                       .t = result.answers->hit[i] != 0 ? result.answers->t[i] : truth::missing,
                       .truth = result.band->rounded_truth(i, binary64, row_.form->info->direction, result.convention)};
            place = i;
        }
    }
    /// The nearest ray.
    [[nodiscard]] const Aimed& aimed() const { return batch_[place]; }

    std::optional<NearestRay> nearest;
    std::size_t place = 0;  ///< index in the batch

private:
    Outcome wanted_;
    const Subject& subject_;
    const std::vector<Aimed>& batch_;
    const evaluate::TestedForm& row_;
};

/// Position of an eye: a distance in a direction from a point of an edge.
struct Eye {
    std::size_t edge = 0;
    double along = 0;  ///< position of the point, as a fraction of the edge from one end; 0 and 1 are vertices
    Vec<double> away;  ///< direction, of length 1
    double distance = 0;
};

/// The census of one row, or the search for one outcome.
class Search {
public:
    Search(const EdgeRequest& request, const Subject& subject, const evaluate::TestedForm& row)
        : request_(request),
          file_(request.search),
          subject_(subject),
          row_(row),
          format_(row.format.parameters),
          random_(file_.seed) {}

    void count(EdgeFinding& finding) {
        std::int64_t left = file_.census;
        while (left > 0) {
            std::vector<Eye> drawn;
            std::vector<Aimed> batch = next_batch(drawn);
            std::erase_if(batch, [this](const Aimed& one) { return !file_.distance.holds(one.distance); });
            batch.resize(std::min(batch.size(), static_cast<std::size_t>(left)));
            left -= static_cast<std::int64_t>(batch.size());
            const auto counts = [&finding](const Aimed& one) -> EdgeCount& {
                return finding.census.at(static_cast<std::size_t>(one.vertex ? EdgeTarget::vertex : EdgeTarget::edge));
            };
            for (const Aimed& one : batch) ++counts(one).rays;
            const std::vector<Aimed> few =
                suspicious(batch, [](bool may_crack, bool may_hit_twice) { return may_crack || may_hit_twice; });
            if (few.empty()) continue;
            measure(few, [&](const evaluate::BandResult& result) {
                for (std::size_t i = 0; i < few.size(); ++i)
                    for (std::size_t k = 0; k < searched_outcomes.size(); ++k)
                        counts(few[i]).outcomes.at(k) +=
                            edge_with(searched_outcomes.at(k), subject_, few[i], result, i) != nullptr;
            });
        }
    }

    void find(EdgeFinding& finding, std::size_t wanted) {
        wanted_ = wanted;
        const std::int64_t litters =
            (file_.rays + eyes * rays_of_eye - 1) / static_cast<std::int64_t>(eyes * rays_of_eye);
        // The tolerance allows for the rounding of an eye.
        const auto is_as_near_as_asked = [this] {
            return best_ && best_->distance <= file_.distance.low * (1 + 0x1p-10);
        };
        for (std::int64_t k = 0; k < litters && !is_as_near_as_asked(); ++k) {
            std::vector<Eye> drawn;
            const std::vector<Aimed> batch = next_batch(drawn);
            finding.rays[wanted_] += batch.size();
            std::vector<Aimed> few = suspicious(batch, [this](bool may_crack, bool may_hit_twice) {
                return searched_outcomes.at(wanted_) == Outcome::crack ? may_crack : may_hit_twice;
            });
            std::erase_if(few, [this](const Aimed& one) { return !file_.distance.holds(one.distance); });
            if (few.empty()) continue;
            const Judge judge = judged(few);
            if (!judge.nearest || (best_ && judge.nearest->distance >= best_->distance)) continue;
            // The ray is tested again alone. Among more rays a form is tested on more triangles, since the boxes are as
            // wide as the farthest ray needs.
            if (!judged({judge.aimed()}).nearest) continue;
            best_ = judge.nearest;
            best_eye_ = drawn[judge.aimed().eye];
        }
        finding.nearest[wanted_] = best_;
    }

private:
    Vec<double> random_vector() { return {random_.between(-1, 1), random_.between(-1, 1), random_.between(-1, 1)}; }

    /// A direction on the side towards which the edge's faces are wound.
    Vec<double> random_direction(const SharedEdge& edge) {
        Vec<double> v = random_vector();
        while (!(dot(v, v) <= 1 && dot(v, v) > 0x1p-20)) v = random_vector();
        Vec<double> outward(0, 0, 0);
        for (const std::uint32_t face : edge.faces) {
            const Vec<double> n = subject_.normal(face);
            outward = outward + 1 / length(n) * n;
        }
        return (dot(v, outward) < 0 ? -1 : 1) / length(v) * v;
    }

    Eye anywhere() {
        Eye eye;
        eye.edge = static_cast<std::size_t>(random_.below(static_cast<int>(subject_.edges.size())));
        eye.along = random_.below(4) == 0 ? random_.below(2) : random_.unit();
        eye.away = random_direction(subject_.edges[eye.edge]);
        return eye;
    }

    Eye near(const Eye& best) {
        Eye eye = best;
        const double step = std::ldexp(1, -random_.below(24));
        const bool at_vertex = eye.along == 0 || eye.along == 1;
        if (!at_vertex) eye.along = std::clamp(eye.along + step * random_.between(-1, 1), 0.0, 1.0);
        eye.away = eye.away + step * random_vector();
        eye.away = 1 / length(eye.away) * eye.away;
        return eye;
    }

    Eye draw() {
        const double high = best_ ? best_->distance : file_.distance.high;
        if (best_ && random_.below(2) == 0) {
            Eye eye = near(best_eye_);
            const double low = std::min(high, std::max(file_.distance.low, high / 16)), u = random_.unit();
            eye.distance = high / (1 + (high / low - 1) * u * u * u);
            return eye;
        }
        Eye eye = anywhere();
        eye.distance = random_.in_octaves(std::min(high, file_.distance.low), high);
        return eye;
    }

    std::vector<Aimed> next_batch(std::vector<Eye>& drawn) {
        std::vector<Aimed> batch;
        const auto stored = [this](Vec<double> v) {
            for (int k = 0; k < 3; ++k) v[k] = rounding::to_format(v[k], 0, format_);
            return v;
        };
        while (drawn.size() < eyes) {
            const Eye eye = drawn.emplace_back(draw());
            const SharedEdge& edge = subject_.edges[eye.edge];
            const auto [a, b] = subject_.ends(edge);
            std::optional<std::uint32_t> vertex;
            if (eye.along == 0 || eye.along == 1) vertex = edge.ends[eye.along == 0 ? 0 : 1];
            const double size = length(b - a);
            const Vec<double> point = a + eye.along * (b - a), origin = stored(point + eye.distance * size * eye.away),
                              to = point - origin;
            const Vec<double> direction = stored((1 + random_.unit()) / length(to) * to);
            for (std::size_t k = 0; k < rays_of_eye; ++k)
                batch.push_back({{origin, k == 0 ? direction : moved(direction)},
                                 length(to) / size,
                                 eye.edge,
                                 drawn.size() - 1,
                                 vertex});
        }
        return batch;
    }

    Vec<double> moved(Vec<double> direction) {
        for (int k = 0; k < 3; ++k) {
            const std::int64_t steps = random_.below(2 * file_.ulps + 1) - file_.ulps;
            direction[k] = truth::number_at(truth::ordinal(direction[k], format_) + steps, format_);
        }
        return direction;
    }

    /// Rays of a batch for which `wanted(may_crack, may_hit_twice)` holds, judged by what the form claims: for a crack
    /// no face of the edge or vertex, for a double hit two faces. The truth of the others is not computed, since it
    /// takes a hundred times as long.
    template <class Wanted>
    std::vector<Aimed> suspicious(const std::vector<Aimed>& batch, const Wanted& wanted) const {
        if (row_.form->info->direction == intersect::Direction::unit) return batch;
        truth::FormatInputs inputs{.format = row_.format, .rays = block_of(batch), .stop = request_.limit.stop};
        const scene::rays::PrimitiveList<double> all =
            scene::rays::primitive_list_of({.rays = {}, .primitives = {}, .mesh = subject_.columns});
        inputs.primitives = round_primitives(all, row_.format.parameters);
        culling::Culler culler(all, inputs.rays);
        inputs.candidates = std::make_shared<culling::CandidateLists>(
            *culler.for_forms(row_.format.parameters, inputs.primitives), inputs.rays);
        const answer::Answers answers = answer::evaluate(*row_.form, inputs);
        std::vector<Aimed> few;
        for (std::size_t i = 0; i < batch.size(); ++i) {
            std::size_t claimed = 0, touched = 0;
            for (std::size_t pair = inputs.candidates->first(i); pair < inputs.candidates->first(i + 1); ++pair) {
                if (answers.claimed[pair] == 0) continue;
                ++claimed;
                touched += subject_.touches(batch[i], inputs.candidates->primitive(pair));
            }
            if (wanted(touched == 0, claimed >= 2)) few.push_back(batch[i]);
        }
        return few;
    }

    Judge judged(const std::vector<Aimed>& batch) const {
        Judge judge(searched_outcomes.at(wanted_), subject_, batch, row_);
        measure(batch, [&judge](const evaluate::BandResult& result) { judge.look_at(result); });
        return judge;
    }

    void measure(const std::vector<Aimed>& batch, const evaluate::Show& show) const {
        request_.limit.stop.check();
        scene::rays::RayGroup group{.rays = block_of(batch), .primitives = {}};
        group.mesh = subject_.columns;
        culling::Culler culler(scene::rays::primitive_list_of(group), group.rays);
        truth::Band band(std::move(group), request_.limit, &culler);
        const auto inputs = band.inputs_for(row_.format, *row_.form->info);
        evaluate::FormSummary summary(metrics_);
        evaluate::measure_row({row_, metrics_, show}, band, inputs, summary);
    }

    const EdgeRequest& request_;
    const scene::sweep::EdgeSearchFile& file_;
    const Subject& subject_;
    const evaluate::TestedForm& row_;
    std::size_t wanted_ = 0;  ///< index of the outcome in `searched_outcomes`
    FloatFormat format_;      ///< format of the numbers of rays
    scene::rays::Random random_;
    std::vector<const metric::Metric*> metrics_{metric::find_metric("lost_bits"), metric::find_metric("ulp_error")};
    std::optional<NearestRay> best_;
    Eye best_eye_;
};

}  // namespace

std::vector<EdgeFinding> find_nearest(const EdgeRequest& request) {
    const Subject subject(request.search.scene);
    const auto units = request.share.of_units(request.rows.size());
    std::vector<EdgeFinding> found(units.size());
    intersect::process::in_parallel(std::size_t{0}, found.size() * edge_units, [&](std::size_t k) {
        const std::size_t row = k / edge_units, unit = k % edge_units;
        Search search(request, subject, request.rows[units.first + row]);
        if (unit == searched_outcomes.size()) search.count(found[row]);
        else if (!request.census_alone) search.find(found[row], unit);
        request.progress(1);
    });
    return found;
}

}  // namespace lostbits::measure::edges
