// Cracks, double hits, wrong neighbours and triangles out of order, counted again from every triangle's own answer and
// own truth.
#include <algorithm>
#include <map>
#include <vector>

#include "catch.hpp"
#include "intersect/process/parallel.hpp"
#include "measure/evaluate/evaluate.hpp"
#include "measure/rows.hpp"
#include "scene/file/scene.hpp"

namespace lostbits::test::test_mesh_outcomes {

using measure::answer::Outcome;
using measure::truth::Truth;

namespace {

using intersect::AtOrigin;

/// Of every ray of a scene the triangles that it truly meets, by the words on its origin and without an index.
class Meetings {
public:
    using Met = std::map<std::size_t, Truth>;

    explicit Meetings(const scene::file::Scene& scene) {
        const measure::truth::Band band(scene, 0, scene.height);
        const std::size_t triangles = scene::rays::SolidList(scene::rays::shared_solids(scene)).size();
        for (const AtOrigin word : {AtOrigin::hit, AtOrigin::miss}) met_[word].resize(band.pixels());
        intersect::process::in_parallel(std::size_t{0}, band.pixels(), [&](std::size_t i) {
            for (std::size_t s = 0; s < triangles; ++s) {
                const Truth closed = band.truth_of_solid(i, s, AtOrigin::hit);
                const Truth ahead = closed.on_surface ? band.truth_of_solid(i, s, AtOrigin::miss) : closed;
                if (closed.is_hit()) met_.at(AtOrigin::hit)[i].emplace(s, closed);
                if (ahead.is_hit()) met_.at(AtOrigin::miss)[i].emplace(s, ahead);
            }
        });
    }
    [[nodiscard]] const Met& of(std::size_t ray, AtOrigin word) const { return met_.at(word)[ray]; }

private:
    std::map<AtOrigin, std::vector<Met>> met_;
};

/// Recounts the outcomes of a band from every triangle asked alone.
class Recount {
public:
    Recount(const measure::evaluate::TestedForm& row, const Meetings& meetings) : row_(row), meetings_(meetings) {}

    void band(const measure::evaluate::BandResult& result) {
        const auto& in = *result.inputs;
        const auto& mesh = in.solids.mesh()->mesh();
        for (std::size_t i = 0; i < result.outcomes.size(); ++i) {
            const Ray<double> ray = in.rays[i];
            std::vector<std::size_t> claimed;
            // A form is not asked about a triangle whose box the ray passes at a distance, which it may claim.
            for (std::size_t pair = in.candidates->first(i); pair < in.candidates->first(i + 1); ++pair) {
                const std::size_t s = in.candidates->solid(pair);
                if (test::asked_alone(row_, ray, in.solids[s])) claimed.push_back(s);
            }
            wrong += !(result.convention == intersect::Convention(result.convention.at_origin));
            const std::size_t place = static_cast<std::size_t>(result.y0 * result.width) + i;
            const Meetings::Met& met = meetings_.of(place, result.convention.at_origin);
            std::vector<Truth> apart;
            for (const auto& [s, truth] : met)
                if (std::ranges::none_of(apart, [&](const Truth& t) { return compare(t.t, truth.t) == 0; }))
                    apart.push_back(truth);
            const Outcome outcome = result.outcomes[i];
            ++counts[outcome];
            const auto truly =
                met.empty() ? met.end() : std::ranges::min_element(met, [](const auto& a, const auto& b) {
                    return compare(a.second.t, b.second.t) < 0;
                });
            const bool odd = claimed.size() % 2 != apart.size() % 2;
            const auto beside = [&](std::size_t a, std::size_t b) { return mesh.share_a_vertex(a, b); };
            if (outcome == Outcome::crack) {
                REQUIRE(truly != met.end());
                const auto near = [&](std::size_t s) { return beside(s, truly->first); };
                wrong += std::ranges::any_of(claimed, near) || !odd || mesh.has_border(truly->first);
            } else if (outcome == Outcome::false_miss) {
                wrong += !claimed.empty() || truly == met.end() || (odd && !mesh.has_border(truly->first));
            } else if (outcome == Outcome::double_hit) {
                const auto first = static_cast<std::size_t>(result.answers->object[i]);
                const auto twice = [&](std::size_t s) {
                    return s != first && beside(s, first) &&
                           !(met.contains(s) && met.contains(first) && compare(met.at(s).t, met.at(first).t) != 0);
                };
                wrong += std::ranges::none_of(claimed, twice) || !odd;
            } else if (outcome == Outcome::wrong_neighbour) {
                const auto first = static_cast<std::size_t>(result.answers->object[i]);
                const auto there = met.find(first);
                wrong += truly == met.end() || !beside(first, truly->first) ||
                         (there != met.end() && compare(there->second.t, truly->second.t) == 0);
            } else if (outcome == Outcome::out_of_order || outcome == Outcome::wrong_object) {
                const auto first = static_cast<std::size_t>(result.answers->object[i]);
                const auto nearer = [&](std::size_t s) {
                    return met.contains(s) && !beside(s, first) && compare(met.at(s).t, met.at(first).t) < 0;
                };
                const bool passed = met.contains(first) && std::ranges::any_of(claimed, nearer);
                // Of triangles that are met at one t any is the first.
                const auto is_beside = [&](const auto& m) {
                    return compare(m.second.t, truly->second.t) != 0 || beside(first, m.first);
                };
                wrong += truly == met.end() || std::ranges::all_of(met, is_beside) ||
                         passed != (outcome == Outcome::out_of_order);
            } else if (outcome == Outcome::agree_hit) {
                const auto there = met.find(static_cast<std::size_t>(result.answers->object[i]));
                wrong += there == met.end() || compare(there->second.t, truly->second.t) != 0;
            } else if (outcome == Outcome::agree_miss) {
                wrong += !claimed.empty() || !met.empty();
            }
        }
    }

    std::map<Outcome, std::uint64_t> counts;
    std::uint64_t wrong = 0;

private:
    const measure::evaluate::TestedForm& row_;
    const Meetings& meetings_;
};

scene::file::Scene smaller(const char* name, std::initializer_list<std::pair<std::string, std::string>> changes) {
    const auto found = scene::file::find_scene(name, LOSTBITS_DATA_DIR);
    scene::file::LoadOptions options{.size = std::pair{32, 32}};
    for (const auto& [path, value] : changes)
        options.overrides.push_back(scene::toml::parse_override(path + "=" + value));
    return scene::file::load_scene(found.path, options).front();
}

}  // namespace

TEST_CASE("outcomes of meshes are those of triangles asked one by one", "[outcome][mesh]") {
    std::map<Outcome, std::uint64_t> counts;
    for (const auto& scene :
         {smaller("mesh-icosphere-edges", {{"mesh[0].levels", "2"}}), smaller("mesh-grid-vertices", {}),
          smaller("mesh-tube-far", {{"mesh[0].along", "16"}}), smaller("mesh-sheets-far", {})}) {
        measure::evaluate::EvaluationRequest request{
            .scene = &scene, .rows = {}, .metrics = {measure::metric::find_metric("lost_bits")}};
        for (const char* form : {"triangle.undivided", "triangle.plucker", "triangle.baldwin_weber",
                                 "triangle.havel_herout", "triangle.filtered"})
            request.rows.push_back(test::row(form, "f32"));
        std::vector<Recount> again;
        const Meetings meetings(scene);
        for (const auto& row : request.rows) again.emplace_back(row, meetings);
        const auto summaries = measure::evaluate::evaluate_rows(request, measure::evaluate::shown_to_each(again));
        for (std::size_t r = 0; r < again.size(); ++r) {
            INFO(scene.id << ", " << request.rows[r].form->info->name);
            CHECK(again[r].wrong == 0);
            for (const auto& [outcome, count] : again[r].counts) {
                CHECK(summaries[r].count(outcome) == count);
                counts[outcome] += count;
            }
        }
    }
    for (const Outcome seen : {Outcome::agree_hit, Outcome::agree_miss, Outcome::false_hit, Outcome::crack,
                               Outcome::double_hit, Outcome::wrong_neighbour, Outcome::out_of_order})
        CHECK(counts[seen] > 5);
}

}  // namespace lostbits::test::test_mesh_outcomes
