// The targets of the fuzzers without libFuzzer: on inputs that fuzzing found, and on seeds with a few changed bytes.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

#include "catch.hpp"
#include "cli/program.hpp"
#include "fuzz/fuzz.hpp"
#include "scene/rays/random.hpp"

namespace lostbits::test {
namespace {

namespace fs = std::filesystem;
using fuzz::Target;

/// Path of the module that reads pictures.
const bool module_is_known = setenv("LOSTBITS_IMAGE_MODULE", LOSTBITS_IMAGE_MODULE_FILE, 1) == 0;

std::string bytes_of(const fs::path& file) {
    std::ostringstream text;
    text << std::ifstream(file, std::ios::binary).rdbuf();
    return text.str();
}

std::vector<fs::path> files_in(const fs::path& folder) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.is_regular_file()) files.push_back(entry.path());
    std::ranges::sort(files);
    return files;
}

/// Up to four changes: a changed byte, a piece left out, a piece repeated.
std::string change_bytes(std::string bytes, scene::rays::Random& random) {
    for (int changes = 1 + random.below(4); changes > 0 && !bytes.empty(); --changes) {
        const auto at = static_cast<std::size_t>(random.below(static_cast<int>(bytes.size())));
        const auto length = static_cast<std::size_t>(1 + random.below(40));
        switch (random.below(4)) {
            case 0: bytes[at] = static_cast<char>(random.below(256)); break;
            case 1: bytes.erase(at, length); break;
            case 2: bytes.insert(at, std::string(bytes.substr(at, length))); break;
            default: bytes.insert(at, std::array{"-", "1e999", "[", "\"", "\n", "nan", ",", "0x1p-1074"}[length % 8]);
        }
    }
    return bytes;
}

}  // namespace

TEST_CASE("inputs that fuzzing found are refused with a message, or read", "[fuzz]") {
    REQUIRE(module_is_known);
    std::size_t tried = 0;
    for (const Target& target : fuzz::targets) {
        const fs::path folder = fs::path(LOSTBITS_FUZZ_DIR) / "found" / target.name;
        if (!fs::exists(folder)) continue;
        for (const fs::path& file : files_in(folder)) {
            INFO(file);
            CHECK_NOTHROW(target.run(bytes_of(file)));
            ++tried;
        }
    }
    CHECK(tried > 0);
}

TEST_CASE("every seed of the fuzzers is read or refused, also with some bytes changed", "[fuzz]") {
    constexpr std::size_t changed_seeds = under_sanitizer ? 40 : 400;  // for one target, over all its seeds
    scene::rays::Random random(19);
    for (const Target& target : fuzz::targets) {
        const auto seeds = files_in(fs::path(LOSTBITS_FUZZ_SEEDS) / target.name);
        INFO(target.name);
        CHECK(!seeds.empty());
        for (const fs::path& file : seeds) {
            const std::string bytes = bytes_of(file);
            INFO(file);
            CHECK_NOTHROW(target.run(bytes));
            for (std::size_t i = 0; i < changed_seeds / seeds.size() + 1; ++i) {
                const std::string other = change_bytes(bytes, random);
                INFO(other);
                REQUIRE_NOTHROW(target.run(other));
            }
        }
    }
}

}  // namespace lostbits::test
