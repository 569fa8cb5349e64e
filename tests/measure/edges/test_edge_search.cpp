// The search along edges: its ray exists, lies within its range, and is the same on any number of threads.
#include "measure/edges/edge_search.hpp"

#include <algorithm>
#include <cmath>

#include "catch.hpp"
#include "measure/rows.hpp"
#include "measure/tape/contraction.hpp"
#include "number/rounded.hpp"
#include "scratch.hpp"

namespace test_edge_search {

using namespace lostbits;
using namespace lostbits::test;
using measure::answer::Outcome;
using measure::edges::EdgeCounts, measure::edges::EdgeResults;
using measure::edges::NearestRay;
using scene::sweep::EdgeSearchFile;

namespace {

std::string search_text(const std::string& more) {
    return "schema = \"lostbits-sweep/1\"\ntitle = \"A test\"\nsource = \"-\"\n[edge_search]\n" + more;
}

EdgeSearchFile search_of(const Scratch& folder, const std::string& more) {
    return EdgeSearchFile(folder.write("edges.toml", search_text(more)), LOSTBITS_DATA_DIR);
}

std::vector<EdgeResults> found_by(const EdgeSearchFile& search,
                                  const std::vector<measure::evaluate::TestedForm>& tested_forms) {
    return measure::edges::search_edges({.search = search, .tested_forms = tested_forms});
}

bool equal(const std::vector<EdgeResults>& a, const std::vector<EdgeResults>& b) {
    const auto same_ray = [](const std::optional<NearestRay>& x, const std::optional<NearestRay>& y) {
        if (!x || !y) return x.has_value() == y.has_value();
        return x->distance == y->distance && x->ray.origin == y->ray.origin && x->ray.direction == y->ray.direction &&
               x->faces == y->faces && x->true_t == y->true_t &&
               (x->t == y->t || (std::isnan(x->t) && std::isnan(y->t)));
    };
    const auto same_count = [](const EdgeCounts& x, const EdgeCounts& y) {
        return x.ray_count == y.ray_count && x.outcome_counts == y.outcome_counts;
    };
    return std::ranges::equal(a, b, [&](const EdgeResults& x, const EdgeResults& y) {
        return x.searched_ray_counts == y.searched_ray_counts && std::ranges::equal(x.nearest, y.nearest, same_ray) &&
               std::ranges::equal(x.census, y.census, same_count);
    });
}

}  // namespace

TEST_CASE("the nearest ray of an edge search leaks or hits twice, triangle by triangle", "[edges]") {
    const Scratch folder;
    const auto search = search_of(folder, "scene = \"mesh-icosphere-near\"\ndistance = [1, 65536]\nrays = 32768\n");
    const auto primitives = scene::rays::make_shared_primitives(search.scene);
    const std::vector rows{row("triangle.undivided", "f32"), row("triangle.havel_herout", "f32"),
                           row("triangle.plucker", "f32"), row("triangle.filtered", "f32")};
    const auto found = found_by(search, rows);
    REQUIRE(found.size() == rows.size());
    for (std::size_t r = 0; r < rows.size(); ++r) {
        for (std::size_t k = 0; k < measure::edges::searched_outcomes.size(); ++k) {
            CHECK(found[r].searched_ray_counts.at(k) <= 32768);
            const auto& nearest = found[r].nearest.at(k);
            if (!nearest) continue;
            INFO(rows[r].form->info->name << ", " << k);
            const Ray<double>& ray = nearest->ray;
            CHECK(search.distance.contains(nearest->distance));
            for (const Vec<double>& v : {ray.origin, ray.direction})
                for (int axis = 0; axis < 3; ++axis) CHECK(rounding::to_format(v[axis], 0, binary32) == v[axis]);
            std::vector<std::size_t> claimed, met;
            for (std::size_t s = 0; s < primitives.size(); ++s) {
                if (evaluate_alone(rows[r], ray, primitives[s])) claimed.push_back(s);
                if (measure::truth::find_truth(ray, primitives[s], {}, rows[r].convention()).is_hit()) met.push_back(s);
            }
            const auto is_of_edge = [&](std::size_t s) {
                return std::ranges::find(nearest->faces, static_cast<std::uint32_t>(s)) != nearest->faces.end();
            };
            CHECK(std::ranges::any_of(met, is_of_edge));
            const auto neighbours = std::ranges::count_if(claimed, [&](std::size_t s) {
                return search.scene.mesh->share_a_vertex(s, nearest->faces[0]) ||
                       search.scene.mesh->share_a_vertex(s, nearest->faces[1]);
            });
            if (measure::edges::searched_outcomes.at(k) == Outcome::crack)
                CHECK(std::ranges::none_of(claimed, is_of_edge));
            else CHECK(neighbours >= 2);
        }
    }
    CHECK(found[0].nearest[0].has_value());
    CHECK(found[0].nearest[1].has_value());
    CHECK(found[1].nearest[0].has_value());
    CHECK(found[2].nearest[1].has_value());
    for (const auto& nothing : found[3].nearest) CHECK_FALSE(nothing.has_value());
}

TEST_CASE("an edge search finds the leak that contraction opens in a watertight test", "[edges][contraction]") {
    const Scratch folder;
    const auto search = search_of(folder,
                                  "scene = \"mesh-icosphere-near\"\ndistance = [\"0x1p-10\", \"0x1p20\"]\n"
                                  "rays = 32768\n");
    const measure::evaluate::TestedForm plain = row("triangle.woop", "f32");
    const auto found = found_by(search, {plain, {&measure::tape::contract_form(*plain.form), plain.format}});
    CHECK_FALSE(found[0].nearest[0].has_value());
    CHECK(found[1].nearest[0].has_value());
}

TEST_CASE("a census counts the cracks that contraction opens, at edges and not at vertices", "[edges][contraction]") {
    const Scratch folder;
    const auto search = search_of(folder,
                                  "scene = \"mesh-icosphere-near\"\ndistance = [\"0x1p-10\", \"0x1p20\"]\n"
                                  "rays = 1\ncensus = 8000\n");
    const measure::evaluate::TestedForm plain = row("triangle.woop", "f32");
    const std::vector rows{plain,
                           {&measure::tape::contract_form(*plain.form), plain.format},
                           row("triangle.filtered", "f32"),
                           row("triangle.undivided", "f32")};
    const auto found = measure::edges::search_edges({.search = search, .tested_forms = rows, .census_only = true});
    for (const EdgeResults& one : found) {
        CHECK(one.census[0].ray_count + one.census[1].ray_count == 8000);
        CHECK(one.census[0].ray_count > 4 * one.census[1].ray_count / 2);
        CHECK(one.searched_ray_counts == decltype(one.searched_ray_counts){});
    }
    const auto cracks = [&](std::size_t row, std::size_t target) {
        return found[row].census.at(target).outcome_counts[0];
    };
    CHECK(cracks(0, 0) + cracks(0, 1) == 0);
    CHECK(cracks(1, 0) > 40);
    CHECK(found[0].census[0].outcome_counts[1] > 40);
    for (std::size_t target : {0, 1}) {
        CHECK(found[2].census.at(target).outcome_counts == std::array<std::uint64_t, 2>{});
        CHECK(cracks(3, target) > 40);
    }
}

TEST_CASE("an edge search does not depend on other rows, shards or repetition", "[edges]") {
    const Scratch folder;
    const auto search = search_of(folder, "scene = \"mesh-icosphere-near\"\nrays = 4096\nseed = 5\n");
    const std::vector rows{row("triangle.undivided", "f32"), row("triangle.projection", "f32")};
    const auto all = found_by(search, rows), again = found_by(search, rows);
    CHECK(equal(all, again));
    CHECK(equal(found_by(search, {rows[1]}), {all[1]}));
    const auto second = measure::edges::search_edges({.search = search, .tested_forms = rows, .share = {2, 2}});
    CHECK(equal(second, {all[1]}));
    const auto other = search_of(folder, "scene = \"mesh-icosphere-near\"\nrays = 4096\nseed = 6\n");
    CHECK_FALSE(equal(found_by(other, rows), all));
}

TEST_CASE("an edge search with more rays never finds a farther ray", "[edges]") {
    const Scratch folder;
    const std::string scene = "scene = \"mesh-icosphere-near\"\n";
    const auto few = search_of(folder, scene + "rays = 2048\n"), many = search_of(folder, scene + "rays = 16384\n");
    const std::vector rows{row("triangle.undivided", "f32")};
    const auto a = found_by(few, rows).front().nearest, b = found_by(many, rows).front().nearest;
    for (std::size_t k = 0; k < a.size(); ++k) {
        REQUIRE(a.at(k).has_value());
        REQUIRE(b.at(k).has_value());
        CHECK(b.at(k)->distance <= a.at(k)->distance);
    }
    CHECK((b[0]->distance < a[0]->distance || b[1]->distance < a[1]->distance));
}

TEST_CASE("an edge search refuses primitives without edges", "[edges]") {
    const Scratch folder;
    const auto refuses = [&](const std::string& more, const std::string& why) {
        try {
            search_of(folder, more);
            FAIL("accepted: " << more);
        } catch (const InputError& error) {
            INFO(error.what());
            CHECK(std::string(error.what()).find(why) != std::string::npos);
        }
    };
    refuses("scene = \"near-benign\"\n", "has no mesh");
    refuses("scene = \"mesh-icosphere-near\"\ndistance = [4, 2]\n", "low <= high");
    refuses("scene = \"mesh-icosphere-near\"\ndistance = [0, 2]\n", "above 0");
    refuses("scene = \"mesh-icosphere-near\"\nulps = -1\n", "ulps");
    refuses("scene = \"mesh-icosphere-near\"\nrayz = 5\n", "rayz");
    refuses("scene = \"mesh-icosphere-nea\"\n", "mesh-icosphere-near");
}

}  // namespace test_edge_search
