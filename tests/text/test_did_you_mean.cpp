// Suggestions for misspelled names.
#include <string>
#include <vector>

#include "catch.hpp"
#include "text/did_you_mean.hpp"

namespace test_did_you_mean {

using namespace lostbits::text;

TEST_CASE("the edit distance counts inserted, deleted, replaced and swapped letters") {
    CHECK(edit_distance("", "") == 0);
    CHECK(edit_distance("", "abc") == 3);
    CHECK(edit_distance("abc", "") == 3);
    CHECK(edit_distance("radius", "radius") == 0);
    CHECK(edit_distance("raduis", "radius") == 1);
    CHECK(edit_distance("radis", "radius") == 1);
    CHECK(edit_distance("radiuus", "radius") == 1);
    CHECK(edit_distance("redius", "radius") == 1);
    CHECK(edit_distance("Radius", "radius") == 0);
    CHECK(edit_distance("kitten", "sitting") == 3);
    CHECK(edit_distance("sitting", "kitten") == 3);
}

TEST_CASE("a suggestion is a name that a typing slip explains") {
    const std::vector<std::string> forms{"sphere.schoolbook", "sphere.press", "sphere.half_b"};
    CHECK(closest("sphere.schoolbok", forms) == "sphere.schoolbook");
    CHECK(closest("sphere.prss", forms) == "sphere.press");
    CHECK_FALSE(closest("box.slab", forms));
    CHECK(closest("F32", {"f16", "f32"}) == "f32");
    CHECK_FALSE(closest("eye", {"fov_deg"}));
    CHECK_FALSE(closest("o", {"c"}));            // one letter is no misspelling of another
    CHECK(closest("ab", {"aa", "bb"}) == "aa");  // the first of equals
    CHECK(closest("press", forms) == "sphere.press");
    CHECK(closest("pres", forms) == "sphere.press");  // a slip in the last part
    CHECK(closest("near", {"extremes/contact", "worst/near"}) == "worst/near");
    CHECK_FALSE(closest("sphere", forms));
    CHECK_FALSE(closest("x", {"far-2.5"}));
    CHECK_FALSE(closest("word", {}));
    CHECK(closest("sphere-dist", {"sphere-tilt", "sphere-distance"}) == "sphere-distance");
    CHECK(closest("ulps", {"lost_bits", "ulp_error"}) == "ulp_error");
    CHECK_FALSE(closest("ulps", {"ulp_error", "ulp_bound"}));
    CHECK(closest("ouput", {"set", "out", "size"}) == "out");
    CHECK(closest("output", {"set", "out", "size"}) == "out");
}

TEST_CASE("an error ends with advice") {
    CHECK(did_you_mean("camra", {"size", "camera"}) == R"(did you mean "camera"?)");
    CHECK(did_you_mean("zzz", {"size", "camera"}) == R"(known here: "size", "camera")");
    CHECK(did_you_mean("rtg", {"box", "my-rtg", "rtg-4", "rtg-2"}) ==
          R"(names that contain it: "rtg-4", "rtg-2", "my-rtg")");
    CHECK(did_you_mean("zzz", {}).empty());
    const std::vector<std::string> many{"a0", "a1", "a2", "a3", "a4", "a5", "a6",
                                        "a7", "a8", "a9", "b0", "b1", "b2", "b3"};
    CHECK(did_you_mean("zzzzz", many).ends_with(R"("b1" and 2 more)"));
}

}  // namespace test_did_you_mean
