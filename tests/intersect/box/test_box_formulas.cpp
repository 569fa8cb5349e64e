// Box forms in floats, compared with each other and with fractions: the purpose of paddings.
#include <map>
#include <string_view>

#include "catch.hpp"
#include "intersect/ask_row.hpp"
#include "intersect/box/box_exact.hpp"
#include "measure/truth/box_distributions.hpp"
#include "shapes/lift.hpp"

namespace lostbits::test::test_box_formulas {

namespace {

bool hits(const intersect::table::Intersector& form, const BoxSample& sample) {
    return ask_row<float>(form, lift_ray<float>(sample.ray), lift_primitive<float>(Primitive<double>(sample.box)),
                          static_cast<float>(sample.tmax))
        .hit;
}

}  // namespace

TEST_CASE("forms without padding miss true hits of rays aimed at an edge", "[intersect][box][formula]") {
    std::map<std::string_view, long> misses;
    long met = 0;
    test::Seeded rng(0xed9e);
    const auto* const at_edge =
        std::ranges::find(test::box_distributions, std::string_view("at edge"), &test::BoxDistribution::name);
    for (int i = 0; i < 60000; ++i) {
        const BoxSample s = at_edge->draw(rng, binary32);
        if (ray_in_box(exactly(s.ray, s.box, s.tmax), true).is_empty()) continue;
        ++met;
        for (const auto& form : intersect::table::intersectors(Shape::box)) misses[form.info->name] += !hits(form, s);
    }
    CHECK(met > 30000);
    for (const char* padded : {"box.pbrt_padded", "box.max_mult", "box.embree_robust", "box.embree_padded"})
        CHECK(misses.at(padded) == 0);
    CHECK(misses.at("box.signs") > met / 50);
    CHECK(misses.at("box.tinybvh") == misses.at("box.signs"));  // no zeros in these directions
    CHECK(misses.at("box.bvh_robust") < misses.at("box.signs") / 100);
    CHECK(misses.at("box.divide") < misses.at("box.signs") / 3);     // one rounding less
    CHECK(misses.at("box.embree_fma") > misses.at("box.signs"));     // o·inv, rounded before it cancels
    CHECK(misses.at("box.baseline") > 3 * misses.at("box.signs"));   // and misses where tmin = tmax
    CHECK(misses.at("box.exclusive") == misses.at("box.baseline"));  // no NaN on these rays
}

TEST_CASE("a padding of two ulps is not quite enough for box.max_mult", "[intersect][box][formula]") {
    // Three roundings on either side can separate near and far by 6u = 1.5·2^-22. Among 5·10^7 random rays across an
    // edge this was the only one found; pbrt_padded's 1 + 2γ(3) and embree_robust's 3ε on both sides missed none.
    const Ray<double> ray{{-0x1.9b6154p-1, -0x1.0cca1ep+1, 0}, {0x1.d53502p+0, 0x1.c9cd8ap+2, 0}};
    const Box<double> target{{-100, 0x1.26c638p+1, -1}, {0x1.4c71dcp-2, 100, 1}};
    const BoxSample s{ray, target, HUGE_VAL};
    CHECK_FALSE(ray_in_box(exactly(ray, target, HUGE_VAL), false).is_empty());
    for (const auto& form : intersect::table::intersectors(Shape::box)) {
        if (form.info->name == "box.max_mult") CHECK_FALSE(hits(form, s));
        if (form.info->name == "box.pbrt_padded" || form.info->name == "box.embree_robust") CHECK(hits(form, s));
    }
}

}  // namespace lostbits::test::test_box_formulas
