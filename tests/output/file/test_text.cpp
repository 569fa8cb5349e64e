#include <bit>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include "catch.hpp"
#include "output/file/csv.hpp"
#include "output/file/datapackage.hpp"
#include "output/file/number_text.hpp"
#include "output/helpers.hpp"

namespace test_text {

using namespace lostbits::output;
using namespace lostbits::output::file;
using namespace lostbits::output::test;

namespace {
constexpr double inf = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
}  // namespace

TEST_CASE("decimals are the shortest that read back", "[number_text]") {
    CHECK(lostbits::output::file::decimal(0.1) == "0.1");
    CHECK(decimal(0.1f) == "0.1");
    CHECK(decimal(static_cast<double>(0.1f)) == "0.10000000149011612");
    CHECK(decimal(4100.0) == "4100");
    CHECK(decimal(-0.0) == "-0");
    CHECK(decimal(5e-324) == "5e-324");
    CHECK(decimal(not_a_number) == "nan");
    CHECK(decimal(-not_a_number) == "nan");
    CHECK(decimal(inf) == "inf");
    CHECK(decimal(-inf) == "-inf");
    CHECK(decimal(-std::numeric_limits<float>::infinity()) == "-inf");
}

TEST_CASE("hex floats are exact and in C's form", "[number_text]") {
    CHECK(lostbits::output::file::hex(3.0) == "0x1.8p+1");
    CHECK(hex(-0.0) == "-0x0p+0");
    CHECK(hex(0.0) == "0x0p+0");
    CHECK(hex(-4097.0) == "-0x1.001p+12");
    CHECK(hex(not_a_number) == "nan");
    CHECK(hex(-inf) == "-inf");
}

TEST_CASE("text is read with a dot, whatever the locale says, and nothing but a number is one", "[number_text]") {
    for (const double x : {0.1, -0.0, 1e308, 5e-324, -0x1.8p+3, 0x1p-1074, 123456.0, inf, -inf}) {
        for (const std::string& text : {decimal(x), hex(x)}) {
            INFO(text);
            REQUIRE(number_in(text).has_value());
            CHECK(std::bit_cast<std::uint64_t>(*number_in(text)) == std::bit_cast<std::uint64_t>(x));
        }
    }
    CHECK(std::isnan(number_in("nan").value_or(0)));
    for (const char* text : {"", "-", "--1", "1,5", "1.5x", " 1", "0x", "0x-1", "1e400", "0x1p+5000", "+1"}) {
        INFO(text);
        CHECK_FALSE(number_in(text).has_value());
    }
    CHECK(nearest_double("15", -1) == 1.5);
    CHECK(nearest_double("1", 400) == inf);
    CHECK(nearest_double("1", -400) == 0);
    CHECK(nearest_double("000", 9000) == 0);
    CHECK(nearest_double("1" + std::string(400, '0'), -400) == 1);
}

TEST_CASE("every bit pattern reads back from its text", "[number_text]") {
    std::mt19937_64 random(7);
    for (int i = 0; i < 20000; ++i) {
        const double d = std::bit_cast<double>(i < 64 ? std::uint64_t{1} << i : random());
        if (std::isfinite(d)) {
            const std::string text = lostbits::output::file::decimal(d);
            double back = 0;
            std::from_chars(text.data(), text.data() + text.size(), back);
            REQUIRE(std::bit_cast<std::uint64_t>(back) == std::bit_cast<std::uint64_t>(d));
            REQUIRE(std::bit_cast<std::uint64_t>(std::strtod(lostbits::output::file::hex(d).c_str(), nullptr)) ==
                    std::bit_cast<std::uint64_t>(d));
        }
        const float f = std::bit_cast<float>(i < 32 ? 1u << i : static_cast<std::uint32_t>(random()));
        if (std::isfinite(f)) {
            const std::string text = lostbits::output::file::decimal(f);
            float back = 0;
            std::from_chars(text.data(), text.data() + text.size(), back);
            REQUIRE(std::bit_cast<std::uint32_t>(back) == std::bit_cast<std::uint32_t>(f));
        }
    }
}

TEST_CASE("a CSV file has exactly these bytes", "[csv]") {
    const Scratch folder;
    lostbits::output::file::CsvWriter csv(folder / "t.csv", {{"form", "string", "", "the form"},
                                                             {"rays", "integer", "", "rays"},
                                                             {"ulp_error_max", "number", "ulp", "worst"},
                                                             {"ok", "boolean", "", "whether it holds"}});
    csv.row({"plain", 3, 0.1, true});
    csv.row({"comma, \"quote\"", std::uint64_t{18446744073709551615u}, 0.1f, false});
    csv.row({"line\nbreak\r", -4, not_a_number, lostbits::output::file::Cell()});
    csv.add("\xC3\xA9").add(Cell()).add(-inf).add(true).end_row();
    csv.row({"bad \xFF\xC0\x80 utf-8", 0, 7, false});
    REQUIRE_FALSE(fs::exists(folder / "t.csv"));
    csv.close();
    CHECK(contents(folder / "t.csv") ==
          "form,rays,ulp_error_max,ok\n"
          "plain,3,0.1,1\n"
          "\"comma, \"\"quote\"\"\",18446744073709551615,0.1,0\n"
          "\"line\nbreak\r\",-4,nan,\n"
          "\xC3\xA9,,-inf,1\n"
          "bad \xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD utf-8,0,7,0\n");
}

TEST_CASE("a lone missing cell is not a blank line", "[csv]") {
    const Scratch folder;
    lostbits::output::file::CsvWriter csv(folder / "t.csv", {{"only", "number", "", ""}});
    csv.row({lostbits::output::file::Cell()});
    csv.row({1});
    csv.close();
    CHECK(contents(folder / "t.csv") == "only\n\"\"\n1\n");
}

TEST_CASE("wrong rows are faults of the program", "[csv]") {
    const Scratch folder;
    lostbits::output::file::CsvWriter csv(folder / "t.csv", {{"a", "integer", "", ""}, {"b", "number", "", ""}});
    CHECK_THROWS_AS(csv.add("text"), std::logic_error);
    CHECK_THROWS_AS(csv.add(1.5), std::logic_error);
    csv.add(1);
    CHECK_THROWS_AS(csv.end_row(), std::logic_error);
    CHECK_THROWS_AS(csv.close(), std::logic_error);
    csv.add(2);
    CHECK_THROWS_AS(csv.add(3), std::logic_error);
    CHECK_THROWS_AS(CsvWriter(folder / "u.csv", {{"a", "float", "", ""}}), std::logic_error);
    CHECK_THROWS_AS(CsvWriter(folder / "u.csv", {{"a", "string", "", ""}, {"a", "string", "", ""}}), std::logic_error);
    CHECK_FALSE(fs::exists(folder / "u.csv"));
}

TEST_CASE("UTF-8 is kept and anything else replaced", "[csv]") {
    const std::string good = "a\xC2\x80\xE0\xA0\x80\xEF\xBF\xBF\xF0\x90\x80\x80\xF4\x8F\xBF\xBF";
    CHECK(lostbits::output::file::valid_utf8(good) == good);
    const std::string mark = "\xEF\xBF\xBD";
    CHECK(valid_utf8("\xC1\xBF") == mark + mark);                        // overlong
    CHECK(valid_utf8("\xED\xA0\x80") == mark + mark + mark);             // surrogate
    CHECK(valid_utf8("\xF4\x90\x80\x80") == mark + mark + mark + mark);  // past U+10FFFF
    CHECK(valid_utf8("ab\xE2\x82") == "ab" + mark + mark);               // cut short
}

TEST_CASE("a data package describes its columns", "[datapackage]") {
    const Scratch folder;
    const std::vector<lostbits::output::file::DataResource> resources{
        {"Scene A/summary.csv",
         "One row a form",
         {{"form", "string", "", "the form"},
          {"lost_bits_max", "number", "bits", "worst \xFF pixel"},
          {"ok", "boolean", "", "holds"}}}};
    lostbits::output::file::write_datapackage(folder / "datapackage.json", "Map of A", resources);
    write_datapackage(folder / "again.json", "Map of A", resources);
    const std::string text = contents(folder / "datapackage.json");
    CHECK(text == contents(folder / "again.json"));
    const auto json = nlohmann::json::parse(text);
    CHECK(json["name"] == "map-of-a");
    const auto& resource = json["resources"].at(0);
    CHECK(resource["name"] == "scene-a/summary");
    CHECK(resource["path"] == "Scene A/summary.csv");
    CHECK(resource["dialect"]["lineTerminator"] == "\n");
    const auto& fields = resource["schema"]["fields"];
    REQUIRE(fields.size() == 3);
    CHECK(fields[1]["type"] == "number");
    CHECK(fields[1]["unit"] == "bits");
    CHECK_FALSE(fields[0].contains("unit"));
    CHECK(fields[2]["trueValues"] == nlohmann::json::array({"1"}));
    CHECK(resource["schema"]["missingValues"] == nlohmann::json::array({""}));
    CHECK(text.find("\"profile\"") < text.find("\"resources\""));
}

}  // namespace test_text
