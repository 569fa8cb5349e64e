#include "measure/sweep/mesh_floats.hpp"

#include <algorithm>
#include <cmath>

#include "measure/culling/culling.hpp"
#include "measure/truth/missing.hpp"
#include "scene/rays/solid_list.hpp"

namespace lostbits::measure::sweep {

using answer::Outcome;

namespace {

const std::vector<const metric::Metric*>& measured() {
    static const std::vector<const metric::Metric*> metrics{metric::find_metric("ulp_error")};
    return metrics;
}

/// The floats of a request as one band.
class FloatBand {
public:
    explicit FloatBand(const BlockRequest& request)
        : request_(request),
          group_(group_of(request)),
          culler_(scene::rays::solid_list_of(group_), group_.rays),
          band_(group_, request.truths.front().terms.limit, &culler_),
          inputs_(
              band_.inputs(request.rows.front().format, {.unit_rays = any_unit(request.rows), .own_truth = false})) {}

    void measure(std::size_t row, evaluate::EvaluationSink& sink) const {
        evaluate::FormSummary summary(measured());
        evaluate::measure_row({request_.rows[row], measured(), &sink}, band_, inputs_, summary);
    }
    [[nodiscard]] const truth::StageCounts& stages() const { return band_.stages(); }

private:
    static scene::rays::RayGroup group_of(const BlockRequest& request) {
        scene::rays::RayGroup group;
        const auto wide = [](const Vec<float>& v) { return Vec<double>(v.x, v.y, v.z); };
        for (std::uint64_t i = 0; i < request.floats.size(); ++i) {
            const Ray<float> ray = request.sweep.ray_at(request.ray, scene::sweep::float_at(request.floats.at(i)));
            group.rays.push({wide(ray.origin), wide(ray.direction)});
        }
        group.rays.width = static_cast<int>(group.rays.size());
        group.rays.y1 = 1;
        group.mesh = request.sweep.mesh;
        return group;
    }
    static bool any_unit(const std::vector<evaluate::TestedForm>& rows) {
        return std::ranges::any_of(rows, [](const evaluate::TestedForm& row) {
            return row.form->info->direction == intersect::Direction::unit;
        });
    }

    const BlockRequest& request_;
    scene::rays::RayGroup group_;
    culling::Culler culler_;
    truth::Band band_;
    truth::FormatInputs inputs_;
};

/// Adds up what a row does, float by float in their order.
class Tally final : public evaluate::EvaluationSink {
public:
    explicit Tally(const scene::sweep::FloatRange& floats) : floats_(floats) {}

    void band(const evaluate::BandResult& result) override {
        for (std::size_t i = 0; i < result.outcomes.size(); ++i) {
            const Outcome outcome = result.outcomes[i];
            const std::uint32_t place = floats_.at(i);
            ++tally.outcomes[static_cast<std::size_t>(outcome)];
            if (answer::is_wrong(outcome)) {
                if (!tally.first_wrong) tally.first_wrong = {place, outcome};
                tally.last_wrong = {place, outcome};
            }
            const double ulps = outcome == Outcome::agree_hit ? result.metrics.front()[i] : truth::missing;
            if (std::fabs(ulps) > (tally.worst ? std::fabs(tally.worst->ulps) : -1)) tally.worst = {place, ulps};
            for (std::size_t e = 0; e < first_events.size(); ++e)
                if (!tally.first[e] && happens(first_events[e], outcome, ulps)) tally.first[e] = place;
        }
        if (tally.worst) tally.at_most = std::fabs(tally.worst->ulps);
    }

    FloatTally tally;

private:
    static bool happens(const FirstEvent& event, Outcome outcome, double ulps) {
        if (event.lost_bits == 0) return outcome == event.outcome;
        return std::fabs(ulps) >= std::exp2(event.lost_bits - 1);
    }
    const scene::sweep::FloatRange& floats_;
};

/// The answer at the only float.
class OneAnswer final : public evaluate::EvaluationSink {
public:
    explicit OneAnswer(intersect::Direction unit_of) : unit_of_(unit_of) {}
    void band(const evaluate::BandResult& result) override {
        found = {.outcome = result.outcomes.front(),
                 .t = result.answers->hit.front() != 0 ? result.answers->t.front() : truth::missing,
                 .truth = result.truth(0).is_hit()
                              ? result.band->rounded_truth(0, binary64, unit_of_, result.convention)
                              : truth::missing,
                 .ulps = result.metrics.front().front()};
    }
    MeshAnswer found;

private:
    intersect::Direction unit_of_;
};

}  // namespace

std::vector<FloatTally> try_mesh_floats(const BlockRequest& request, truth::StageCounts& stages) {
    const FloatBand floats(request);
    stages += floats.stages();
    std::vector<FloatTally> tallies;
    for (std::size_t row = 0; row < request.rows.size(); ++row) {
        Tally tally(request.floats);
        floats.measure(row, tally);
        tallies.push_back(tally.tally);
    }
    return tallies;
}

MeshAnswer mesh_answer_at(const BlockRequest& request, std::size_t row) {
    OneAnswer answer(request.rows[row].form->info->direction);
    FloatBand(request).measure(row, answer);
    return answer.found;
}

}  // namespace lostbits::measure::sweep
