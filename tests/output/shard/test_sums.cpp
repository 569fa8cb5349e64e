// Results of parts of a study add up to the bits of the whole, whatever the parts.
#include <random>

#include "catch.hpp"
#include "measure/consistency/consistency.hpp"
#include "measure/offset/offsets.hpp"
#include "measure/render/render.hpp"
#include "measure/rows.hpp"
#include "measure/study/bands.hpp"
#include "measure/study/study.hpp"
#include "output/shard/fields.hpp"

namespace test_sums {

using namespace lostbits;
using measure::study::add_up;
using measure::study::run_share;
using measure::study::run_study;
using output::shard::bits_of;
using test::load;
using test::row;

namespace {

/// Joins the shards of a study, which were written as bits and read back.
template <class Study>
std::vector<typename Study::Summary> join_shards(Study study, std::uint64_t shards) {
    auto all = measure::study::empty_summaries(study);
    for (std::uint64_t k = 1; k <= shards; ++k) {
        study.share = {k, shards};
        output::shard::BitReader bits(bits_of(run_share(study)));
        std::vector<typename Study::Summary> part;
        bits(part);
        CHECK(bits.is_at_end());
        add_up(all, std::move(part));
    }
    return all;
}

/// Checks that parts give the bits of the whole.
template <class Study>
void check_parts(const Study& study) {
    const std::string whole = bits_of(run_share(study));
    for (const std::uint64_t shards : {1, 2, 5}) {
        INFO(shards << " shards");
        const bool same = bits_of(join_shards(study, shards)) == whole;
        CHECK(same);
    }
}

}  // namespace

TEST_CASE("study: shards of every study add up to the bits of the whole", "[output][study]") {
    const auto touching = load("offset-touching", 6, 40);
    const std::vector rows{row("sphere.half_b", "f32"), row("sphere.press", "bf16")};
    check_parts(measure::consistency::ConsistencyStudy{
        .scene = touching, .tested_forms = rows, .checks = measure::consistency::select_checks(touching, rows)});
    check_parts(
        measure::offset::OffsetStudy{.scene = touching,
                                     .tested_forms = {{rows[0]}, {rows[1], measure::offset::HitPointKind::projected}},
                                     .strategies = {&measure::offset::strategies().front()},
                                     .search_quiet_offset = false});
    const auto acne = load("raycast-acne", 8, 4200);  // two bands
    check_parts(measure::render::RenderStudy{.scene = acne,
                                             .stages = {scene::file::Stage::visible, scene::file::Stage::shadows},
                                             .tested_forms = {row("sphere.half_b", "f32")}});
}

TEST_CASE("study: bands are blocks of 16 lines, and shards never split one", "[output][study]") {
    const auto scene = load("near-benign", 4, 70);
    measure::consistency::ConsistencyStudy study{
        .scene = scene, .tested_forms = {row("sphere.press", "f32")}, .checks = measure::consistency::all_checks()};
    std::vector<int> lines;
    for (const std::uint64_t k : {1, 2, 3}) {
        study.share = {k, 3};
        run_share(study,
                  {[&lines](std::size_t, const auto& band) { lines.push_back(band.y0 * 100 + band.scanlines); }});
    }
    CHECK(lines == std::vector<int>{16, 1616, 3216, 4816, 6406});
    CHECK(measure::study::lines_per_band(1024, 32768) == 32);
    CHECK(measure::study::lines_per_band(70000, 32768) == 16);
}

TEST_CASE("study: lists of different sizes cannot be added", "[output][study]") {
    std::vector<std::uint64_t> all{1, 2};
    CHECK_THROWS_AS(add_up(all, std::vector<std::uint64_t>{1}), std::out_of_range);
    add_up(all, std::vector<std::uint64_t>{3, 4});
    CHECK(all == std::vector<std::uint64_t>{4, 6});
    std::optional<int> first;
    add_up(first, std::optional(3));
    add_up(first, std::optional(4));
    CHECK(first == 3);
}

}  // namespace test_sums
