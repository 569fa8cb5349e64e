// Properties that drivers report.
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "catch.hpp"
#include "cli/program.hpp"

namespace test_drivers {

using namespace lostbits::test;

TEST_CASE("drivers: each one reports how it rounds, every time the same", "[shader-device]") {
    const Outcome o = must("devices --json");
    CHECK(o.out == run("devices --json").out);
    const auto devices = nlohmann::json::parse(o.out);
    REQUIRE(devices.size() == 2);
    std::set<std::string> digests;
    for (const auto& d : devices) {
        INFO(d.dump(2));
        REQUIRE_FALSE(d.contains("missing"));
        digests.insert(d["digest"].get<std::string>());
        for (const std::string format : {"f32.", "f64."}) {
            // Mesa's compute programs, measured; another driver may say otherwise.
            if (!has(d["renderer"].get<std::string>(), "llvmpipe")) continue;
            for (const std::string operation : {"add", "multiply", "divide", "sqrt"})
                CHECK(d[format + operation] == "correctly rounded");
            CHECK(d[format + "dot"] == (d["device"] == "opengl" ? "x+(y+z)" : "(x+y)+z"));
            CHECK(d[format + "fma"] == "rounds twice");
            CHECK(d[format + "a*b+c"] == "rounds twice");
            CHECK(d[format + "Kahan, precise"] == "as written");
            CHECK(has(d[format + "Kahan"].get<std::string>(), "rewritten"));
            CHECK(d[format + "subnormal given"] == "kept");
            CHECK(has(d[format + "inversesqrt"].get<std::string>(), "up to 1.4"));
            CHECK(d["loops end after"] == "65535 iterations, silently; all loops of a call count together");
        }
    }
    CHECK(digests.size() == 2);
}

TEST_CASE("drivers: list devices prints one line each", "[shader-device]") {
    const Outcome o = must("list devices");
    CHECK(has(o.out, "opengl"));
    CHECK(has(o.out, "vulkan"));
    CHECK(has(o.out, "arithmetic"));
}

}  // namespace test_drivers
