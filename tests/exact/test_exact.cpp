// Truth of every shape, compared with an answer that shares nothing with it: its own polynomials, its own numbers, and
// integers of GMP where those do not decide. LOSTBITS_EXACT_RAYS=1000000 sets the number of random rays; a tenth as
// many are constructed. `./run test --long` tries 10^8 for each shape, and 10^7 with transforms (CMakeLists.txt).
#include <algorithm>
#include <cmath>
#include <random>
#include <sstream>

#include "catch.hpp"
#include "exact/ask.hpp"
#include "exact/draw.hpp"

namespace test_exact {

using namespace lostbits::exact;

namespace {

constexpr std::size_t batch = 1000;

/// One problem in so many is decided without an error, even if the quick check decides.
constexpr std::size_t each_exactly = 1000;

/// Counts for rays of one kind.
struct Tally {
    std::size_t ray_count = 0, hits = 0, exactly = 0;

    void ask_some(const ShapeTest& shape, TruthRoute way, std::vector<Problem>& problems) {
        static std::vector<Answer> answers;
        ask(shape.name, way, problems, answers);
        const Findings found = check(shape, problems, answers, tightness_of(way), each_exactly);
        ray_count += found.ray_count, hits += found.hits, exactly += found.exact_count;
        INFO("way " << static_cast<int>(way) << ": " << words_of(found.fault) << "\n"
                    << paste(shape, problems[found.first_wrong], answers[found.first_wrong]));
        REQUIRE(found.wrong_count == 0);
    }
};

/// The routes by turns, and every combination of open ends.
template <class Draw>
Tally ask_all(const ShapeTest& shape, std::size_t rays, std::uint64_t seed, std::initializer_list<TruthRoute> ways,
              Draw draw) {
    Tally tally;
    Chance chance(seed);
    std::vector<Problem> problems(batch);
    std::size_t round = 0;
    while (tally.ray_count < rays)
        for (const TruthRoute way : ways) {
            const Ends ends{.open_tmin = round % 2 == 1, .open_tmax = round / 2 % 2 == 1};
            draw(shape, way == TruthRoute::floats || way == TruthRoute::floats_for_ulps, ends, chance, problems);
            tally.ask_some(shape, way, problems);
            ++round;
        }
    return tally;
}

/// Draws problems and gives them transforms of every kind in turn, or of every kind but inverses.
template <class Draw, class Place>
auto transformed(const Draw& draw, const Place& place, bool inverses = true) {
    return [draw, place, inverses, drawn = 0](const ShapeTest& shape, bool floats, Ends ends, Chance& chance,
                                              std::vector<Problem>& problems) mutable {
        draw(shape, floats, ends, chance, problems);
        const int kind = drawn++ % 4;  // and for three routes: every pair after twelve batches
        place(floats, {.is_inverse = inverses && kind % 2 == 1, .orientation = kind / 2 % 2 == 1 ? -1 : 1}, chance,
              problems);
    };
}

template <class Random, class Made, class Through>
void hold(const ShapeTest& shape, std::size_t rays, const Random& draw_random, const Made& draw_made,
          const Through& draw_through) {
    const auto ways = {TruthRoute::floats_for_ulps, TruthRoute::floats, TruthRoute::doubles};
    const Tally random = ask_all(shape, rays, 1, ways, draw_random);
    const Tally made = ask_all(shape, rays / 10, 2, ways, draw_made);
    const Tally one = ask_all(shape, rays / 100, 3, {TruthRoute::one_by_one}, draw_made);
    const Tally through = ask_all(shape, rays / 100, 4, {TruthRoute::interface}, draw_through);
    for (const auto& [name, tally] : {std::pair("random", random), std::pair("made", made), std::pair("alone", one),
                                      std::pair("interface", through)}) {
        std::ostringstream counts;
        counts << shape.name << ", " << name << ": " << tally.ray_count << " rays, " << tally.hits << " hits, "
               << tally.exactly << " without an error";
        INFO(counts.str());
        CHECK(tally.hits > tally.ray_count / 20);
        CHECK(tally.hits < tally.ray_count);
        if (is_ray_count_given()) WARN(counts.str());
    }
}

void hold(const ShapeTest& shape) { hold(shape, ray_count_or(40'000), draw_random, draw_made, draw_random); }

void hold_transformed(const ShapeTest& shape) {
    hold(shape, ray_count_or(12'000), transformed(draw_random, place_at_random), transformed(draw_made, place_as_made),
         transformed(draw_random, place_at_random, false));
}

}  // namespace

TEST_CASE("exact: every shape is tested here", "[exact]") {
    const auto there = all_shapes();
    REQUIRE(there.size() == shapes.size());
    for (const auto& [name, numbers] : there) {
        INFO(name);
        CHECK(numbers <= max_primitive_numbers);
        CHECK(std::ranges::count(shapes, name, &ShapeTest::name) == 1);
    }
}

TEST_CASE("exact: the sphere", "[exact]") { hold(shapes[0]); }
TEST_CASE("exact: the box", "[exact]") { hold(shapes[1]); }
TEST_CASE("exact: the triangle", "[exact]") { hold(shapes[2]); }
TEST_CASE("exact: the ellipsoid", "[exact]") { hold(shapes[3]); }
TEST_CASE("exact: the cylinder", "[exact]") { hold(shapes[4]); }
TEST_CASE("exact: the capsule", "[exact]") { hold(shapes[5]); }
TEST_CASE("exact: the tube", "[exact]") { hold(shapes[6]); }
TEST_CASE("exact: the cone", "[exact]") { hold(shapes[7]); }
TEST_CASE("exact: the disc", "[exact]") { hold(shapes[8]); }
TEST_CASE("exact: the plane", "[exact]") { hold(shapes[9]); }
TEST_CASE("exact: the torus", "[exact]") { hold(shapes[10]); }

TEST_CASE("exact: the transformed sphere", "[exact]") { hold_transformed(shapes[0]); }
TEST_CASE("exact: the transformed box", "[exact]") { hold_transformed(shapes[1]); }
TEST_CASE("exact: the transformed triangle", "[exact]") { hold_transformed(shapes[2]); }
TEST_CASE("exact: the transformed ellipsoid", "[exact]") { hold_transformed(shapes[3]); }
TEST_CASE("exact: the transformed cylinder", "[exact]") { hold_transformed(shapes[4]); }
TEST_CASE("exact: the transformed capsule", "[exact]") { hold_transformed(shapes[5]); }
TEST_CASE("exact: the transformed tube", "[exact]") { hold_transformed(shapes[6]); }
TEST_CASE("exact: the transformed cone", "[exact]") { hold_transformed(shapes[7]); }
TEST_CASE("exact: the transformed disc", "[exact]") { hold_transformed(shapes[8]); }
TEST_CASE("exact: the transformed plane", "[exact]") { hold_transformed(shapes[9]); }
TEST_CASE("exact: the transformed torus", "[exact]") { hold_transformed(shapes[10]); }

TEST_CASE("exact: nothing is hit under a singular matrix", "[exact]") {
    Chance chance(6);
    std::vector<Problem> problems(500);
    std::vector<Answer> answers;
    for (const ShapeTest& shape : shapes)
        for (const bool is_inverse : {false, true}) {
            draw_made(shape, false, {}, chance, problems);
            place_as_made(false, {.is_inverse = is_inverse}, chance, problems);
            for (Problem& problem : problems)
                for (std::size_t c = 0; c < 3; ++c) problem.matrix[8 + c] = problem.matrix[c] + problem.matrix[4 + c];
            ask(shape.name, TruthRoute::one_by_one, problems, answers);
            INFO(shape.name);
            CHECK(std::ranges::count(answers, true, &Answer::hit) == 0);
            CHECK(check(shape, problems, answers, 0x1p-72, 1).wrong_count == 0);
        }
}

TEST_CASE("exact: an open range end at infinity excludes no hit of a ray along the side of a cone", "[exact]") {
    // This was once answered with a miss: a t² + 2 h t + c has a = 0.
    std::vector<Problem> problems{
        {.ray = {-3, -3, 1, 1, 1, 0}, .primitive = {1, 1, 1, 1, 0, 1, 1, 0}, .tmin = 1.5, .open_tmax = true},
        {.ray = {0, -2, -2, 0, 2, 1}, .primitive = {0, 2, 0, 0, 0, 0, 1, 0}, .tmin = 0.25, .open_tmax = true}};
    std::vector<Answer> answers;
    for (const TruthRoute way : {TruthRoute::doubles, TruthRoute::one_by_one, TruthRoute::interface}) {
        ask("cone", way, problems, answers);
        CHECK(std::ranges::count(answers, true, &Answer::hit) == 2);
        CHECK(check(shapes[7], problems, answers, 0x1p-72, 1).wrong_count == 0);
    }
}

TEST_CASE("exact: a ray that nearly passes through the apex of a cone enters it after the apex, by 2^-1074 in t",
          "[exact]") {
    // The answer was once the other root, that of the mirror image: a < 0, and 2 is between the roots.
    const std::vector<Problem> problems{
        {.ray = {-1, -1, 2, 0, 0x1p-1074, -1}, .primitive = {-1, -1, -1, -1, -1, 0, 1, 0}, .tmin = 1.5, .tmax = 3}};
    std::vector<Answer> answers;
    for (const TruthRoute way : {TruthRoute::doubles, TruthRoute::one_by_one}) {
        ask("cone", way, problems, answers);
        CHECK(answers.front().hit);
        CHECK(answers.front().low > 0);
        CHECK(check(shapes[7], problems, answers, 0x1p-72, 1).wrong_count == 0);
    }
}

TEST_CASE("exact: entries of a box are distinguished where their products underflow", "[exact]") {
    // The answer was once the third entry, although the second is the largest: n m of the first two lay below 2^-1000,
    // and neither was compared with the third.
    std::vector<Problem> problems{
        {.ray = {0x1.d3f589a2ffaa4p-350, 0x1.b42c9d43deaa1p-467, -0x1.a8487834180eep-694, -0x1.e03c85ef1ab3bp-639,
                 -0x1.68f4b37afe469p-859, -0x1.3f63d3e79a6c3p-321},
         .primitive = {-0x1.10076565324f1p+933, -0x1.28ce4fe233f98p-148, -0x1.35ff7bebf3e05p+995,
                       0x1.a3003b63c8f8ep-717, -0x1.a24b3f5789123p-395, -0x1.c01be7ec08c84p+60}}};
    std::mt19937_64 engine(11);
    const auto power = [&engine](int low, int high) {
        return std::ldexp(std::uniform_real_distribution<double>(1, 2)(engine),
                          std::uniform_int_distribution<int>(low, high)(engine));
    };
    while (problems.size() < 20'000) {
        Problem& p = problems.emplace_back();
        for (std::size_t i = 0; i < 3; ++i) {
            p.ray[i] = power(-900, -700), p.ray[3 + i] = power(-900, -300);
            p.primitive[i] = power(-600, 100), p.primitive[3 + i] = 0x1p1000;
        }
    }
    std::vector<Answer> answers;
    for (const TruthRoute way : {TruthRoute::doubles, TruthRoute::one_by_one}) {
        ask("box", way, problems, answers);
        CHECK(std::ranges::count(answers, true, &Answer::hit) == 20'000);
        CHECK(check(shapes[1], problems, answers, tightness_of(way), 1).wrong_count == 0);
    }
}

TEST_CASE("exact: a slightly wrong answer is detected, quickly and exactly", "[exact]") {
    Chance chance(5);
    std::vector<Answer> answers;
    for (const ShapeTest& shape : shapes)
        for (const bool made : {false, true}) {
            // A torus takes as long as thirty other primitives.
            std::vector<Problem> problems(shape.name == "torus" ? 500 : 2000);
            (made ? draw_made : draw_random)(shape, false, {}, chance, problems);
            ask(shape.name, TruthRoute::doubles, problems, answers);
            const auto count_wrong = [&](const auto& spoil, std::size_t exactly) {
                std::vector<Answer> spoilt = answers;
                for (Answer& a : spoilt) spoil(a);
                return check(shape, problems, spoilt, 0x1p-72, exactly).wrong_count;
            };
            const auto count = [&](const auto& is) {
                return static_cast<std::size_t>(std::ranges::count_if(answers, is));
            };
            const std::size_t away = count([](const Answer& a) { return a.hit && a.high != 0; });
            const std::size_t floats = count([](const Answer& a) { return a.hit && a.as_float != 0; });
            const std::size_t doubles = count([](const Answer& a) { return a.hit && a.as_double != 0; });
            INFO(shape.name << (made ? ", made" : ", random"));
            REQUIRE(floats > 100);
            for (const std::size_t exactly : {std::size_t{1}, problems.size() + 1}) {
                CHECK(count_wrong([](Answer&) {}, exactly) == 0);
                CHECK(count_wrong([](Answer& a) { a.hit = !a.hit; }, exactly) == problems.size());
                CHECK(count_wrong([](Answer& a) { a.low += 0x1p-71 * a.high; }, exactly) == away);
                CHECK(count_wrong([](Answer& a) { a.bound = 0x1p-71 * a.high; }, exactly) == away);
                CHECK(count_wrong([](Answer& a) { a.as_double = std::nextafter(a.as_double, 0); }, exactly) == doubles);
                CHECK(count_wrong([](Answer& a) { a.as_float = std::nextafter(static_cast<float>(a.as_float), 0.0F); },
                                  exactly) == floats);
            }
        }
}

}  // namespace test_exact
