// Cracks, double hits, wrong neighbours and triangles out of order, counted again from each triangle's own answer and
// truth.
#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "intersect/process/parallel.hpp"
#include "measure/evaluate/map.hpp"
#include "measure/rows.hpp"
#include "number/real.hpp"
#include "scene/file/scene.hpp"

namespace lostbits::test::test_mesh_outcomes {

using measure::answer::Outcome;
using measure::truth::Truth;

namespace {

using intersect::AtOrigin;

/// Triangles that every ray of a scene truly meets, for both values of `at_origin`, found without an index.
class PassingPixelsByForm {
public:
    using Met = std::map<std::size_t, Truth>;

    explicit PassingPixelsByForm(const scene::file::Scene& scene) {
        const measure::truth::Band band(scene, 0, scene.height);
        const std::size_t triangles = scene::rays::PrimitiveList(scene::rays::make_shared_primitives(scene)).size();
        for (const AtOrigin word : {AtOrigin::hit, AtOrigin::miss}) met_[word].resize(band.pixel_count());
        intersect::process::in_parallel(std::size_t{0}, band.pixel_count(), [&](std::size_t i) {
            for (std::size_t s = 0; s < triangles; ++s) {
                const Truth closed = band.truth_of_primitive(i, s, AtOrigin::hit);
                const Truth ahead = closed.on_surface ? band.truth_of_primitive(i, s, AtOrigin::miss) : closed;
                if (closed.is_hit()) met_.at(AtOrigin::hit)[i].emplace(s, closed);
                if (ahead.is_hit()) met_.at(AtOrigin::miss)[i].emplace(s, ahead);
            }
        });
    }
    [[nodiscard]] const Met& of(std::size_t ray, AtOrigin word) const { return met_.at(word)[ray]; }

private:
    std::map<AtOrigin, std::vector<Met>> met_;
};

/// 1 from the side to which the corners turn left, −1 from the other, 0 along the plane.
int facing_of(const Ray<double>& ray, const Primitive<double>& triangle) {
    const auto at = [&](std::size_t k) {
        const auto& numbers = triangle.numbers;
        return Vec<Real>(Real(numbers[3 * k]), Real(numbers[3 * k + 1]), Real(numbers[3 * k + 2]));
    };
    const Vec<Real> d(Real(ray.direction.x), Real(ray.direction.y), Real(ray.direction.z));
    const Real m = dot(d, cross(Vec<Real>(at(1) - at(0)), Vec<Real>(at(2) - at(0))));
    return m < 0 ? 1 : m > 0 ? -1 : 0;
}

/// Recounts the outcomes of a band from every triangle tested alone.
class Recount {
public:
    Recount(const measure::evaluate::TestedForm& row, const PassingPixelsByForm& meetings)
        : row_(row), meetings_(meetings) {}

    void add_band(const measure::evaluate::BandResult& result) {
        const auto& in = *result.inputs;
        const auto& mesh = in.primitives.mesh()->mesh();
        for (std::size_t i = 0; i < result.outcomes.size(); ++i) {
            const Ray<double> ray = in.rays[i];
            std::vector<std::size_t> claimed;
            // A form is not run on a triangle whose box the ray passes at a distance, although it might claim the
            // triangle.
            for (std::size_t pair = in.candidates->first_pair(i); pair < in.candidates->first_pair(i + 1); ++pair) {
                const std::size_t s = in.candidates->primitive(pair);
                if (test::evaluate_alone(row_, ray, in.primitives[s])) claimed.push_back(s);
            }
            wrong += !(result.convention == intersect::Convention(result.convention.at_origin));
            const std::size_t place = static_cast<std::size_t>(result.y0 * result.width) + i;
            const PassingPixelsByForm::Met& met = meetings_.of(place, result.convention.at_origin);
            const Outcome outcome = result.outcomes[i];
            ++counts[outcome];
            const auto truly =
                met.empty() ? met.end() : std::ranges::min_element(met, [](const auto& a, const auto& b) {
                    return compare(a.second.t, b.second.t) < 0;
                });
            const auto beside = [&](std::size_t a, std::size_t b) { return mesh.share_a_vertex(a, b); };
            const auto facing = [&](std::size_t s) { return facing_of(ray, in.primitives[s]); };
            const auto twice = [&](std::size_t s, std::size_t first) {
                return s != first && beside(s, first) && facing(s) * facing(first) >= 0 &&
                       !(met.contains(s) && met.contains(first) && compare(met.at(s).t, met.at(first).t) != 0);
            };
            // Steps through the surface, where the number of claims is known.
            const auto steps = [&](const std::vector<std::size_t>& faces) {
                std::size_t count = 0;
                for (auto s = faces.begin(); s != faces.end(); ++s)
                    count += std::none_of(faces.begin(), s, [&](std::size_t before) {
                        return met.contains(*s) && met.contains(before) && facing(*s) == facing(before) &&
                               compare(met.at(*s).t, met.at(before).t) == 0;
                    });
                return count;
            };
            std::vector<std::size_t> crossed;
            for (const auto& [s, truth] : met) crossed.push_back(s);
            bool odd = steps(claimed) % 2 != steps(crossed) % 2;
            for (const std::size_t a : claimed)
                for (const std::size_t b : claimed)
                    if (a != b && beside(a, b) && !(met.contains(a) && met.contains(b))) odd = false;
            if (outcome == Outcome::crack) {
                const auto near = [&](std::size_t s) { return truly != met.end() && beside(s, truly->first); };
                wrong += std::ranges::any_of(claimed, near) || !odd || truly == met.end();
            } else if (outcome == Outcome::false_miss) {
                const bool border = std::ranges::any_of(met, [&](const auto& other) {
                    return compare(other.second.t, truly->second.t) == 0 && mesh.has_border(other.first);
                });
                wrong += !claimed.empty() || truly == met.end() || (odd && !border);
            } else if (outcome == Outcome::false_hit) {
                wrong += claimed.empty() || truly != met.end();
            } else if (outcome == Outcome::double_hit) {
                const auto first = static_cast<std::size_t>(result.answers->primitive[i]);
                wrong += std::ranges::none_of(claimed, [&](std::size_t s) { return twice(s, first); });
            } else if (outcome == Outcome::wrong_neighbour) {
                const auto first = static_cast<std::size_t>(result.answers->primitive[i]);
                const auto there = met.find(first);
                wrong += truly == met.end() || !beside(first, truly->first) ||
                         (there != met.end() && compare(there->second.t, truly->second.t) == 0);
            } else if (outcome == Outcome::out_of_order || outcome == Outcome::wrong_primitive) {
                const auto first = static_cast<std::size_t>(result.answers->primitive[i]);
                const auto nearer = [&](std::size_t s) {
                    return met.contains(s) && !beside(s, first) && compare(met.at(s).t, met.at(first).t) < 0;
                };
                const bool passed = met.contains(first) && std::ranges::any_of(claimed, nearer);
                // Any of the triangles that are hit at one t counts as the first.
                const auto is_beside = [&](const auto& m) {
                    return compare(m.second.t, truly->second.t) != 0 || beside(first, m.first);
                };
                wrong += truly == met.end() || std::ranges::all_of(met, is_beside) ||
                         passed != (outcome == Outcome::out_of_order);
            } else if (outcome == Outcome::agree_hit) {
                const auto there = met.find(static_cast<std::size_t>(result.answers->primitive[i]));
                wrong += there == met.end() || compare(there->second.t, truly->second.t) != 0;
                wrong += std::ranges::any_of(claimed, [&](std::size_t s) { return twice(s, there->first); });
            } else if (outcome == Outcome::agree_miss) {
                wrong += !claimed.empty() || !met.empty();
            }
        }
    }

    std::map<Outcome, std::uint64_t> counts;
    std::uint64_t wrong = 0;

private:
    const measure::evaluate::TestedForm& row_;
    const PassingPixelsByForm& meetings_;
};

scene::file::Scene smaller(const char* name, std::initializer_list<std::pair<std::string, std::string>> changes) {
    const auto found = scene::file::find_scene(name, LOSTBITS_DATA_DIR);
    scene::file::LoadOptions options{.size = std::pair{32, 32}};
    for (const auto& [path, value] : changes)
        options.overrides.push_back(scene::toml::parse_override(path + "=" + value));
    return scene::file::load_scene(found.path, options).front();
}

}  // namespace

TEST_CASE("outcomes of meshes agree with triangles tested one by one", "[outcome][mesh]") {
    std::map<Outcome, std::uint64_t> counts;
    for (const auto& scene :
         {smaller("mesh-icosphere-edges", {{"mesh[0].levels", "2"}}), smaller("mesh-grid-vertices", {}),
          smaller("mesh-tube-far", {{"mesh[0].along", "16"}}), smaller("mesh-sheets-far", {})}) {
        measure::evaluate::MapStudy request{
            .scene = &scene, .tested_forms = {}, .metrics = {measure::metric::find_metric("lost_bits")}};
        for (const char* form : {"triangle.undivided", "triangle.plucker", "triangle.baldwin_weber",
                                 "triangle.havel_herout", "triangle.filtered"})
            request.tested_forms.push_back(test::row(form, "f32"));
        std::vector<Recount> again;
        const PassingPixelsByForm meetings(scene);
        for (const auto& row : request.tested_forms) again.emplace_back(row, meetings);
        const auto summaries = measure::evaluate::run_map(request, measure::evaluate::show_to_each(again));
        for (std::size_t r = 0; r < again.size(); ++r) {
            INFO(scene.id << ", " << request.tested_forms[r].form->info->name);
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

namespace {

measure::evaluate::FormSummary summary_of(const scene::file::Scene& scene, const char* form) {
    const measure::evaluate::MapStudy request{.scene = &scene,
                                              .tested_forms = {test::row(form, "f32")},
                                              .metrics = {measure::metric::find_metric("lost_bits")}};
    return std::move(measure::evaluate::run_map(request).front());
}

}  // namespace

TEST_CASE("a watertight form that hits both triangles of an edge is not reported as a crack", "[outcome][mesh]") {
    // Pixel (35, 8): it claims one triangle, and two that share an edge whose value is 0: one step or two, no light.
    const auto found = scene::file::find_scene("mesh-icosphere-parallel", LOSTBITS_DATA_DIR);
    scene::file::LoadOptions options;
    options.overrides.push_back(scene::toml::parse_override("camera.eye=[251658.24, 314572.8, 335544.32]"));
    const auto scene = scene::file::load_scene(found.path, options).front();
    for (const char* form : {"triangle.woop", "triangle.filtered"})
        CHECK(summary_of(scene, form).count(Outcome::crack) == 0);
    CHECK(summary_of(scene, "triangle.undivided").count(Outcome::crack) > 80);
}

TEST_CASE("a leak exactly on an inner edge is a crack, also of triangles at the border of a mesh", "[outcome][mesh]") {
    const test::TextFile file(
        "schema = \"lostbits-scene/1\"\ntitle = \"t\"\nsource = \"-\"\nsize = [65, 65]\n[camera]\n"
        "kind = \"orthographic\"\neye = [0, 0, 1]\nlook_at = [0, 0, 0]\nup = [0, 1, 0]\nwidth = \"35.35533906\"\n"
        "[[mesh]]\nmake = \"grid\"\nparts = [2, 2]\nwidth = \"70.71\"\nheight = \"70.71\"\n");
    const auto summary = summary_of(scene::file::load_scene(file.path()).front(), "triangle.havel_herout");
    CHECK(summary.count(Outcome::crack) == 165);
    CHECK(summary.count(Outcome::false_miss) == 0);
}

TEST_CASE("a miss exactly at the border of a mesh is not a crack, also at a vertex of the border", "[outcome][mesh]") {
    // Every ray of the last column of pixels passes the border, and two of them a corner of the grid.
    const test::TextFile file(
        "schema = \"lostbits-scene/1\"\ntitle = \"t\"\nsource = \"-\"\nsize = [5, 5]\n[camera]\n"
        "kind = \"pixel_plane\"\neye = [0.5, 0.25, 4]\nextent = [-2.5, -2.5, 2.5, 2.5]\n"
        "[[mesh]]\nmake = \"grid\"\nparts = [4, 4]\nwidth = 4\nheight = 4\n");
    for (const char* const form : {"triangle.havel_herout", "triangle.woop_once"}) {
        const auto summary = summary_of(scene::file::load_scene(file.path()).front(), form);
        INFO(form);
        CHECK(summary.count(Outcome::false_miss) > 0);
        CHECK(summary.count(Outcome::crack) == (std::string_view(form) == "triangle.woop_once" ? 0 : 9));
        CHECK(summary.count(Outcome::double_hit) == 0);
    }
}

}  // namespace lostbits::test::test_mesh_outcomes
