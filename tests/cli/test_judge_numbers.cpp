// Numbers in judged files that are misleading: the other byte order, too few digits, a t behind the ray. Also single
// rays where a bound underflowed, or where two numbers are almost the whole range of a format apart.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <regex>

#include "catch.hpp"
#include "program.hpp"

namespace test_judge_numbers {

using namespace lostbits::test;

namespace {

const std::string head = "ox,oy,oz,dx,dy,dz,hit,t\n";

/// A number with its most significant byte first.
template <class N>
std::string reversed_bytes(N x) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &x, 4);
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(bits >> shift & 255);
    return bytes;
}

}  // namespace

TEST_CASE("judge: raw numbers in the other byte order are refused first") {
    const Scratch scratch;
    std::string bytes;
    for (int i = 0; i < 8; ++i) {
        for (const float x :
             {0.0F, 0.0F, -5.0F - static_cast<float>(i), 0.0F, 0.0F, 1.0F, 4.0F + static_cast<float>(i)})
            bytes += reversed_bytes(x);
    }
    const std::string file = scratch.write("rays.bin", bytes);
    const auto with = [&](const std::string& columns) {
        return run("judge '" + file + "' --columns " + columns + " --sphere 0,0,0,1" + into(scratch));
    };
    const auto reversed = with("ox:f32,oy,oz,dx,dy,dz,t");
    CHECK(reversed.code == 2);
    CHECK(has(reversed.err, "the most significant byte comes first; write --columns ox:f32be,oy,oz,dx,dy,dz,t"));
    CHECK(has(reversed.err, "rays.bin: record 0: oz is "));
    CHECK_FALSE(has(reversed.err, "--miss"));
    const auto right = with("ox:f32be,oy,oz,dx,dy,dz,t");
    CHECK(right.code == 0);
    CHECK(right.err.empty());
    CHECK(has(with("ox:f32be,oy,oz,dx,dy,dz,t --skip 1").err, "bytes"));
}

TEST_CASE("judge: the byte order is recognised from any floats, and from the hit column") {
    const Scratch scratch;
    std::string as_float, as_whole, in_order;
    for (int i = 0; i < 40; ++i) {  // rays from (x, y, 0.4) along z at a sphere around (0, 0, 5), that miss at times
        const float x = 1.37F * std::sin(1.0F + static_cast<float>(i)), y = 0.31F, z = 0.4F;
        const bool hit = x * x + y * y < 1;
        const float t = hit ? 4.6F - std::sqrt(1 - x * x - y * y) : 0;
        std::string ray;
        for (const float number : {x, y, z, 0.0F, 0.0F, 1.0F, t}) ray += reversed_bytes(number);
        as_float += ray + reversed_bytes(hit ? 1.0F : 0.0F);
        as_whole += ray + reversed_bytes(hit ? 1 : 0);
        for (const float number : {x, y, z, 0.0F, 0.0F, 1.0F, t})
            in_order.append(reinterpret_cast<const char*>(&number), 4);
        in_order += std::string(1, hit ? 1 : 0) + std::string(3, 0);
    }
    const auto with = [&](const std::string& bytes, const std::string& columns) {
        const std::string file = scratch.write("rays.bin", bytes);
        return run("judge '" + file + "' --columns " + columns + " --sphere 0,0,5,1" + into(scratch));
    };
    const std::string ray = "ox:f32,oy,oz,dx,dy,dz,t", reversed = "ox:f32be,oy,oz,dx,dy,dz,t";
    CHECK(has(with(as_float, ray + ",hit").err, "write --columns " + reversed + ",hit\n"));
    CHECK(has(with(as_float, ray + ",_ --miss -1").err, "write --columns " + reversed + ",_\n"));
    CHECK(has(with(as_whole, ray + ",hit:i32").err, "write --columns " + reversed + ",hit:i32be\n"));
    const Outcome hit = with(as_whole, reversed + ",hit:i32");
    CHECK(has(hit.err, ": hit is 16777216; most numbers look wrong"));
    CHECK(has(hit.err, "write --columns " + reversed + ",hit:i32be\n"));
    CHECK(with(as_float, reversed + ",hit").err.empty());
    CHECK(with(as_whole, reversed + ",hit:i32be").err.empty());
    CHECK(has(with(in_order, reversed + ",hit:i32be").err,
              "the least significant byte comes first; write --columns " + ray + ",hit:i32\n"));
}

TEST_CASE("judge: decimals too short for a format are told apart from lost bits") {
    const Scratch scratch;
    const auto said = [&](const char* pattern, const std::string& options, bool wide = false, double step = 0.37 / 3) {
        std::string text = head;
        for (int i = 0; i < 30; ++i) {
            const double z = -3 - step * i, t = -z - 1;
            std::array<char, 64> row{};
            std::snprintf(row.data(), row.size(), pattern, wide ? z : static_cast<float>(z),
                          wide ? t : static_cast<float>(t));
            text += row.data();
        }
        const auto r =
            must("judge '" + scratch.write("rays.csv", text) + "' --sphere 0,0,0,1" + options + into(scratch));
        return r.err;
    };
    const std::string six = "0,0,%.6g,0,0,1,1,%.6g\n", f32 = " --answer-format f32";
    CHECK(has(said(six.c_str(), f32), "its numbers have at most 6 digits, but f32 needs 9; bits"));
    CHECK(has(said("0,0,%.7g,0,0,1,1,%.7g\n", f32), "at most 7 digits"));
    CHECK(has(said(six.c_str(), f32), "print with %.9g (std::setprecision(9))"));
    CHECK(said("0,0,%.9g,0,0,1,1,%.9g\n", f32).empty());
    CHECK(said("0,0,%a,0,0,1,1,%a\n", f32).empty());
    // With f64 as the format, six digits look like floats too, which would not be better.
    CHECK(has(said(six.c_str(), ""), "at most 6 digits, but f64 needs 17 (f32 needs 9)"));
    CHECK_FALSE(has(said(six.c_str(), ""), "--answer-format f32"));
    CHECK(has(said("0,0,%.8g,0,0,1,1,%.8g\n", ""), "at most 8 digits, but f64 needs 17"));
    // Nine digits, or as many of a float, look like floats.
    for (const char* pattern : {"0,0,%.9g,0,0,1,1,%.9g\n", "0,0,%.17g,0,0,1,1,%.17g\n"}) {
        CHECK(has(said(pattern, ""), "reported hits is a float, or the decimal of one, but was judged as "));
        CHECK(has(said(pattern, ""), "--answer-format f32"));
        CHECK_FALSE(has(said(pattern, ""), "digits"));
    }
    CHECK(has(said("0,0,%.12g,0,0,1,1,%.12g\n", "", true), "at most 12 digits"));
    CHECK_FALSE(has(said("0,0,%.12g,0,0,1,1,%.12g\n", "", true), "--answer-format f32"));
    CHECK(said("0,0,%.17g,0,0,1,1,%.17g\n", "", true).empty());
    // Few digits that are exactly the number are enough.
    CHECK(said("0,0,%.7g,0,0,1,1,%.7g\n", f32, false, 1 / 64.0).empty());
}

TEST_CASE("judge: a contract can say that the near root behind the ray is a miss") {
    const Scratch scratch;
    std::string text = head;
    for (int i = 0; i < 20; ++i) {
        const double z = -0.5 + i / 32.0;
        text += "0,0," + std::to_string(z) + ",0,0,1,1," + std::to_string(-1 - z) + "\n";
    }
    const std::string file = scratch.write("rays.csv", text);
    const auto with = [&](const std::string& options) {
        return run("judge '" + file + "' --answer-format f32 --sphere 0,0,0,1" + options + into(scratch));
    };
    CHECK(has(with("").err, "the near root, behind the ray; say --inside near: t < 0 is then a miss"));
    const Outcome near = with(" --inside near");
    CHECK(near.code == 0);
    CHECK(near.err.empty());
    const auto row = read_csv(scratch / "out/rays/summary.csv").front();
    CHECK(row.at("agree_miss") == "20");
    CHECK(row.at("false_hit") == "0");
}

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

TEST_CASE("judge: a bound with underflowing products still holds and proves no wrong decision") {
    const auto rows = judged(
        "ox,oy,oz,dx,dy,dz,cx,cy,cz,radius\n0,0,-0x1p-99,0,0,16,0,0,0,0x1p-100\n"
        "0x57p-140,-0x5fp-140,0x5p-136,-0x18p+0,-0x28p+0,0x16p+0,-0x9p-140,-0x5p-140,0x1p-137,0x4bp-139\n",
        "--answer-format f32 -i sphere.embree_point --metric bound,bound_ratio,decision,rounding_error",
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
        "--answer-format f32 --sphere 0,0,0,4.412449099927811e-25 -i sphere.hearn_baker --metric "
        "decision,bound,bound_ratio",
        "sphere.hearn_baker.f32");
    REQUIRE(false_hit.size() == 1);
    CHECK(false_hit[0].at("outcome") == "false_hit");
    CHECK(false_hit[0].at("decision") == "undecided");
}

TEST_CASE("judge: rays that separate the slabs of a box stay within the bound of docs/bounds.md") {
    // Before a search looked, the page said 3 u, the largest that random rays of short numbers had shown.
    static const std::regex said(R"(No ray in float needs more than\s+([0-9.]+) u)");
    const std::string page = contents(fs::path(LOSTBITS_REPORTS_DIR).parent_path() / "docs/bounds.md");
    std::smatch bound;
    REQUIRE(std::regex_search(page, bound, said));
    const auto needed = [](const std::string& ray) {
        const auto rows = judged("ox,oy,oz,dx,dy,dz,lox,loy,loz,hix,hiy,hiz\n" + ray,
                                 "--answer-format f32 -i box.filtered --metric padding", "box.filtered.f32");
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

TEST_CASE("judge: steps between numbers of both signs need 64 bits, and herbie_bits counts them") {
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

}  // namespace test_judge_numbers
