// `lostbits judge` on single rays where a bound underflowed, and where two numbers lie almost all of a format apart.
#include <filesystem>
#include <regex>

#include "catch.hpp"
#include "program.hpp"

namespace test_judge_bounds {

using namespace lostbits::test;

namespace {

/// The rows that `lostbits judge FILE OPTIONS --rows` writes for one form.
std::vector<std::map<std::string, std::string>> judged(const std::string& text, const std::string& options,
                                                       const std::string& row) {
    const Scratch scratch;
    const std::string file = scratch.write("rays.csv", text);
    must("judge '" + file + "' " + options + " --rows -q" + into(scratch));
    return read_csv(scratch / "out/rays" / (row + ".csv"));
}

}  // namespace

TEST_CASE("a bound whose products underflow is not below the error, and proves no wrong decision") {
    const auto rows = judged(
        "ox,oy,oz,dx,dy,dz,cx,cy,cz,radius\n0,0,-0x1p-99,0,0,16,0,0,0,0x1p-100\n"
        "0x57p-140,-0x5fp-140,0x5p-136,-0x18p+0,-0x28p+0,0x16p+0,-0x9p-140,-0x5p-140,0x1p-137,0x4bp-139\n",
        "--format f32 -i sphere.embree_point --metric bound,bound_ratio,decision,rounding_error",
        "sphere.embree_point.f32");
    REQUIRE(rows.size() == 2);
    CHECK(rows[0].at("rounding_error") == "8388608");
    CHECK(number_in(rows[0].at("bound")) >= 8388608);
    CHECK(number_in(rows[0].at("bound_ratio")) >= 1);
    CHECK(rows[1].at("outcome") == "false_miss");
    CHECK(rows[1].at("decision") == "undecided");

    const auto false_hit = judged(
        "ox,oy,oz,dx,dy,dz\n-4.709943831466693e-25,1.4873191210756734e-26,-8.213276590667404e-25,"
        "4.0748959076499384e-20,-3.916126667006054e-20,7.034124229980253e-17\n",
        "--format f32 --sphere 0,0,0,4.412449099927811e-25 -i sphere.hearn_baker --metric decision,bound,bound_ratio",
        "sphere.hearn_baker.f32");
    REQUIRE(false_hit.size() == 1);
    CHECK(false_hit[0].at("outcome") == "false_hit");
    CHECK(false_hit[0].at("decision") == "undecided");
}

TEST_CASE("rays that part the slabs of a box far stay within what docs/bounds.md says of all floats") {
    // Before a search looked, the page said 3 u, the largest that random rays of short numbers had shown.
    static const std::regex said(R"(\*\*no ray in float needs more than\s+([0-9.]+) u)");
    const std::string page = contents(fs::path(LOSTBITS_REPORTS_DIR).parent_path() / "docs/bounds.md");
    std::smatch bound;
    REQUIRE(std::regex_search(page, bound, said));
    const auto needed = [](const std::string& ray) {
        const auto rows = judged("ox,oy,oz,dx,dy,dz,lox,loy,loz,hix,hiy,hiz\n" + ray,
                                 "--format f32 -i box.filtered --metric padding", "box.filtered.f32");
        return rows.size() == 1 ? number_in(rows[0].at("padding")) : 0;
    };
    const double four = needed(
        "-1.0255415439605713,-1.0519620180130005,0,1.0433335304260254,1.0091681480407715,0,"
        "0.017799438908696175,-3,-1,3,-0.04278666153550148,1\n");
    const double more =
        needed("-0x1.5fcce4p-1,-0x1.1024b2p-1,0,0x1.ff8cb0p+0,0x1.fb3088p+0,0,-8,0x1.0642ccp-1,-1,0x1.76654cp-2,8,1\n");
    CHECK(four == Approx(3.99997).epsilon(1e-5));
    CHECK(more == Approx(5.69).epsilon(1e-3));
    CHECK(four <= number_in(bound[1].str()));
    CHECK(more <= number_in(bound[1].str()));
}

TEST_CASE("the steps between numbers of either sign fill 64 bits, and herbie_bits counts them") {
    // From −3 to 3 there are 2·ord(3) steps, ord(3) = 2^52 (1 + 1023) + 2^51 of binary64: log2(1 + 2·ord(3)).
    const auto rows = judged(
        "ox,oy,oz,dx,dy,dz,cx,cy,cz,radius,hit,t\n0,0,-4,0,0,1,0,0,0,1,1,-3\n"
        "0,0,-0x1.8p1000,0,0,1,0,0,0,0x1p1000,1,-0x1p1000\n",
        "--metric herbie_bits", "file.rays.f64");
    REQUIRE(rows.size() == 2);
    const double binade = 0x1p52, places_of_3 = binade * 1023 + binade * 1 + binade / 2;
    CHECK(number_in(rows[0].at("herbie_bits")) == Approx(std::log2(2 * places_of_3)).epsilon(1e-12));
    const double far = binade * (1000 + 1022 + 1), near = binade * (999 + 1022 + 1);
    CHECK(number_in(rows[1].at("herbie_bits")) == Approx(std::log2(far + near)).epsilon(1e-12));
}

}  // namespace test_judge_bounds
