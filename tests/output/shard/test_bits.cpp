// Malformed bits of shards.
#include <sys/resource.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "catch.hpp"
#include "output/shard/fields.hpp"

namespace test_bits {

using namespace lostbits;
using output::shard::BitReader;
using output::shard::bits_of;

namespace {

template <class T>
void read(const std::string& bits) {
    T found{};
    BitReader reader(bits);
    reader(found);
}

}  // namespace

TEST_CASE("shard: a list that declares more entries than the file holds is refused", "[output]") {
    for (const std::uint64_t size :
         {std::uint64_t{2}, std::uint64_t{1} << 61, std::numeric_limits<std::uint64_t>::max()}) {
        const std::string bits = bits_of(size, std::uint64_t{1});
        INFO(size);
        CHECK_THROWS_AS(read<std::vector<double>>(bits), std::out_of_range);
        CHECK_THROWS_AS(read<std::vector<std::string>>(bits), std::out_of_range);
        CHECK_THROWS_AS(read<std::string>(bits_of(size) + "?"), std::out_of_range);
    }
}

TEST_CASE("shard: a list takes memory only for the entries that the file holds", "[output]") {
    using Summaries = std::vector<measure::evaluate::FormSummary>;
    const std::uint64_t claimed = 30 << 20;  // where a summary takes hundreds of bytes, gigabytes
    std::string bits = bits_of(claimed);
    bits.resize(sizeof claimed + claimed, '\x7f');
    rlimit limit{}, less{};
    REQUIRE(getrlimit(RLIMIT_AS, &limit) == 0);
    std::uint64_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    less = limit;
    less.rlim_cur = std::min<rlim_t>(limit.rlim_cur, pages * 4096 + (1 << 30));
    REQUIRE(setrlimit(RLIMIT_AS, &less) == 0);
    CHECK_THROWS_AS(read<Summaries>(bits), std::out_of_range);
    CHECK(setrlimit(RLIMIT_AS, &limit) == 0);
}

TEST_CASE("shard: a bool other than 0 or 1 is refused", "[output]") {
    bool answer = false;
    BitReader reader(bits_of(true));
    reader(answer);
    CHECK(answer);
    CHECK_THROWS_AS(read<bool>("\2"), std::out_of_range);
    CHECK_THROWS_AS(read<std::optional<double>>(std::string("\xff", 1) + std::string(8, '\0')), std::out_of_range);
}

}  // namespace test_bits
