// Cracks, double hits, wrong neighbours and triangles out of order, counted again from every triangle's own answer and
// own truth.
#include <algorithm>
#include <map>
#include <vector>

#include "catch.hpp"
#include "measure/evaluate/evaluate.hpp"
#include "measure/rows.hpp"
#include "scene/file/scene.hpp"

namespace lostbits::test::test_mesh_outcomes {

using measure::answer::Outcome;
using measure::truth::find_truth;
using measure::truth::Truth;

namespace {

/// Recounts the outcomes of a band from every triangle asked alone; what is truly met without an index.
class Recount final : public measure::evaluate::EvaluationSink {
public:
    explicit Recount(const measure::evaluate::TestedForm& row) : row_(row) {}

    void band(const measure::evaluate::BandResult& result) override {
        const auto& in = *result.inputs;
        const auto& mesh = in.solids.mesh()->mesh();
        for (std::size_t i = 0; i < result.outcomes.size(); ++i) {
            const Ray<double> ray = in.rays[i];
            std::vector<std::size_t> claimed;
            std::map<std::size_t, Truth> met;
            std::vector<Truth> apart;
            for (std::size_t s = 0; s < in.solids.size(); ++s) {
                const Solid<double> solid = in.solids[s];
                if (is_asked(in, i, s) && testing::asked_alone(row_, ray, solid)) claimed.push_back(s);
                const Truth truth = find_truth(ray, solid, {}, result.convention);
                if (!truth.is_hit()) continue;
                met.emplace(s, truth);
                if (std::ranges::none_of(apart, [&](const Truth& t) { return compare(t.t, truth.t) == 0; }))
                    apart.push_back(truth);
            }
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
                           !(met.contains(s) && met.contains(first) && compare(met[s].t, met[first].t) != 0);
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
                    return met.contains(s) && !beside(s, first) && compare(met[s].t, met[first].t) < 0;
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
    /// A form is not asked about a triangle whose box the ray passes at a distance, which it may claim.
    static bool is_asked(const measure::truth::FormatInputs& in, std::size_t ray, std::size_t solid) {
        const auto& lists = *in.candidates;
        for (std::size_t pair = lists.first(ray); pair < lists.first(ray + 1); ++pair)
            if (lists.solid(pair) == solid) return true;
        return false;
    }
    const measure::evaluate::TestedForm& row_;
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
            request.rows.push_back(testing::row(form, "f32"));
        std::vector<Recount> again;
        for (const auto& row : request.rows) again.emplace_back(row);
        std::vector<measure::evaluate::EvaluationSink*> sinks;
        for (Recount& one : again) sinks.push_back(&one);
        const auto summaries = measure::evaluate::evaluate_rows(request, sinks);
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
