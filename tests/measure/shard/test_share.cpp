// Shares of a run's units: they are consecutive, cover all units, and are as even as possible.
#include <algorithm>

#include "catch.hpp"
#include "measure/shard/share.hpp"

namespace lostbits::test::test_share {

using measure::shard::Share;

TEST_CASE("shares are consecutive, cover all units and differ in size by at most one", "[measure][shard]") {
    for (const std::uint64_t units : {0ULL, 1ULL, 2ULL, 7ULL, 65536ULL, 1000003ULL, 1ULL << 44}) {
        for (const std::uint64_t of : {1ULL, 2ULL, 3ULL, 7ULL, 64ULL, 1000ULL}) {
            INFO(units << " units in " << of << " shares");
            std::uint64_t end = 0, least = units, most = 0;
            for (std::uint64_t number = 1; number <= of; ++number) {
                const auto part = Share{number, of}.unit_range(units);
                REQUIRE(part.first == end);
                REQUIRE(part.last >= part.first);
                end = part.last;
                least = std::min(least, part.size());
                most = std::max(most, part.size());
            }
            CHECK(end == units);
            CHECK(most - least <= 1);
        }
    }
    const auto last = Share{Share::max_count, Share::max_count}.unit_range(std::uint64_t{1} << 44);
    CHECK(last.last == std::uint64_t{1} << 44);
    CHECK(Share{}.is_whole());
    CHECK_FALSE(Share{1, 2}.is_whole());
}

}  // namespace lostbits::test::test_share
