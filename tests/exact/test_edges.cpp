// Rays at edges and vertices of triangles: decisions of the truth in packs, compared with signs of integers with a
// fixed number of words. LOSTBITS_EXACT_RAYS sets the number of rays in floats; a hundredth as many are in doubles.
// `./run test --long` tries 10^9 (CMakeLists.txt).
#include <sstream>

#include "catch.hpp"
#include "exact/ask.hpp"
#include "exact/check.hpp"
#include "exact/edges.hpp"

namespace test_edges {

using namespace lostbits::exact;

namespace {

constexpr std::size_t batch = 1000;
const ShapeTest& triangle = shapes[2];

/// Interval of batches whose t is checked too, and which the slower program decides as well.
constexpr std::size_t each_wholly = 64;

struct Tally {
    std::size_t ray_count = 0, hits = 0, edges = 0, vertices = 0, begin = 0, differ = 0, by[3] = {};
    std::string first;

    void add(const std::vector<Problem>& problems, const std::vector<std::uint8_t>& hit, bool with_rim = true) {
        for (std::size_t i = 0; i < problems.size(); ++i) {
            const PassingRay right = pass(problems[i]);
            const int touched = right.touched();
            ++ray_count, ++by[right.by];
            hits += hit[i], edges += touched == 1, vertices += touched == 2, begin += right.meets() && right.ahead == 0;
            const bool is_met = right.meets() && (with_rim || touched == 0);
            if (is_met != (hit[i] != 0) && differ++ == 0)
                first = paste(triangle, problems[i], {.hit = hit[i] != 0, .as_float = NAN, .as_double = NAN});
        }
    }
    [[nodiscard]] std::string words() const {
        std::ostringstream text;
        text << ray_count << " rays, " << hits << " hits, " << edges << " of them on an edge, " << vertices
             << " at a vertex, " << begin << " where the ray begins; judged in two words " << by[0] << ", in four "
             << by[1] << ", in any number " << by[2];
        return text.str();
    }
};

void check_wholly(TruthRoute way, const std::vector<Problem>& problems) {
    std::vector<Answer> answers;
    ask(triangle.name, way, problems, answers);
    const Findings found = check(triangle, problems, answers, tightness_of(way), 10);
    INFO("way " << static_cast<int>(way) << ": " << words_of(found.fault) << "\n"
                << paste(triangle, problems[found.first_wrong], answers[found.first_wrong]));
    REQUIRE(found.wrong_count == 0);
}

Tally ask_rays(std::initializer_list<TruthRoute> ways, std::size_t rays, std::uint64_t seed) {
    Tally tally;
    Chance chance(seed);
    std::vector<Problem> problems(batch);
    std::vector<std::uint8_t> hit;
    for (std::size_t round = 0; tally.ray_count < rays; ++round)
        for (const TruthRoute way : ways) {
            draw_at_edges(way != TruthRoute::doubles, chance, problems);
            decide(triangle.name, way, true, problems, hit);
            tally.add(problems, hit);
            if (round % each_wholly == 0) check_wholly(way, problems);
        }
    return tally;
}

void hold(const Tally& tally) {
    INFO(tally.words() << "\n" << tally.first);
    CHECK(tally.differ == 0);
    CHECK(tally.hits > tally.ray_count / 4);
    CHECK(tally.hits < tally.ray_count * 3 / 4);
    CHECK(tally.edges > tally.ray_count / 200);
    CHECK(tally.vertices > tally.ray_count / 500);
    CHECK(tally.begin > tally.ray_count / 2000);
    for (const std::size_t some : tally.by) CHECK(some > 0);
    if (is_ray_count_given()) WARN(tally.words());
}

}  // namespace

TEST_CASE("exact: rays at edges and vertices of triangles are decided exactly", "[exact][edges]") {
    hold(ask_rays({TruthRoute::floats_for_ulps, TruthRoute::floats}, ray_count_or(200'000), 21));
    hold(ask_rays({TruthRoute::doubles}, is_ray_count_given() ? ray_count_or(0) / 100 : 20'000, 22));
}

/// The two questions differ only in whether the rim belongs to the triangle.
TEST_CASE("exact: rays at edges distinguish a triangle from one without its rim", "[exact][edges]") {
    Chance chance(23);
    std::vector<Problem> problems(20 * batch);
    std::vector<std::uint8_t> hit;
    for (const TruthRoute way : {TruthRoute::floats_for_ulps, TruthRoute::floats, TruthRoute::doubles}) {
        draw_at_edges(way != TruthRoute::doubles, chance, problems);
        decide(triangle.name, way, false, problems, hit);
        Tally open, closed;
        open.add(problems, hit, false), closed.add(problems, hit);
        INFO(open.first);
        CHECK(open.differ == 0);
        CHECK(closed.differ == closed.edges + closed.vertices);
        CHECK(closed.differ > problems.size() / 100);
    }
}

/// An edge that counts as outside where it is met, for one edge after the other, and an origin that is passed over.
TEST_CASE("exact: a sign that is wrong at zero is detected", "[exact][edges]") {
    Chance chance(24);
    std::vector<Problem> problems(20 * batch);
    draw_at_edges(true, chance, problems);
    for (std::size_t sign = 0; sign < 4; ++sign) {
        std::vector<std::uint8_t> hit;
        for (const Problem& problem : problems) {
            const PassingRay right = pass(problem);
            hit.push_back(right.meets() && (sign < 3 ? right.edges[sign] : right.ahead) != 0);
        }
        Tally tally;
        tally.add(problems, hit);
        CHECK(tally.differ > (sign < 3 ? 50 : 5));
    }
}

}  // namespace test_edges
