// Numbers, CSV and its description, written and read back.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include "catch.hpp"
#include "number/error.hpp"
#include "output/file/csv.hpp"
#include "output/file/number_text.hpp"
#include "output/file/read_csv.hpp"
#include "output/helpers.hpp"

namespace test_text {

using namespace lostbits;
using namespace lostbits::output::file;
using namespace lostbits::output::test;

namespace {

constexpr double inf = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

CsvTable table(const std::string& text) { return parse_csv(text, "t.csv"); }

}  // namespace

TEST_CASE("numbers for a reader have few digits, and powers of ten where they are very large or small",
          "[number_text]") {
    CHECK(short_decimal(0.0009999, 3) == "0.001");
    CHECK(short_decimal(999900, 3) == "10^6");
    CHECK(short_decimal(-1e-9, 3) == "-10^-9");
    CHECK(short_decimal(12876, 3) == "12900");
    CHECK(short_decimal(2.7777e-6, 3) == "2.78×10^-6");
    CHECK(short_decimal(2.5e8, 3) == "2.5×10^8");
    CHECK(short_decimal(100000, 6) == "100000");
    CHECK(short_decimal(1000000.5, 8) == "1000000.5");
    CHECK(short_decimal(-0.0, 3) == "0");
    CHECK(short_decimal(-std::numeric_limits<double>::infinity(), 3) == "-inf");
    CHECK(short_decimal(3 * 0.1, 6) == "0.3");
}

TEST_CASE("kept bits are rounded down", "[number_text]") {
    CHECK(kept_bits_text(21.97) == "21.9");
    CHECK(kept_bits_text(21.97, 2) == "21.97");
    CHECK(kept_bits_text(24) == "24.0");
    CHECK(kept_bits_text(24 - 1.3 - 0.7) == "22.0");  // 21.999999999999996
    CHECK(kept_bits_text(not_a_number) == "nan");
}

TEST_CASE("numbers are written as the shortest decimal and as exact C hexadecimal", "[number_text]") {
    const struct {
        double x;
        const char *decimal, *hex;
    } rows[] = {{3, "3", "0x1.8p+1"},
                {4100, "4100", "0x1.004p+12"},
                {-4097, "-4097", "-0x1.001p+12"},
                {0.1f, "0.10000000149011612", "0x1.99999ap-4"},
                {0, "0", "0x0p+0"},
                {-0.0, "-0", "-0x0p+0"},
                {not_a_number, "nan", "nan"},
                {-not_a_number, "nan", "nan"},
                {inf, "inf", "inf"},
                {-inf, "-inf", "-inf"}};
    for (const auto& row : rows) {
        CHECK(decimal(row.x) == row.decimal);
        CHECK(hex(row.x) == row.hex);
    }
    CHECK(decimal(0.1) == "0.1");
    CHECK(decimal(0.1f) == "0.1");
    CHECK(decimal(5e-324) == "5e-324");
    CHECK(decimal(-std::numeric_limits<float>::infinity()) == "-inf");
}

TEST_CASE("numbers are read with a dot in every locale, and other text is refused", "[number_text]") {
    CHECK(std::isnan(parse_number("nan").value_or(0)));
    for (const char* text : {"", "-", "--1", "1,5", "1.5x", " 1", "0x", "0x-1", "1e400", "0x1p+5000", "+1"}) {
        INFO(text);
        CHECK_FALSE(parse_number(text).has_value());
    }
    CHECK(nearest_double("15", -1) == 1.5);
    CHECK(nearest_double("1", 400) == inf);
    CHECK(nearest_double("1", -400) == 0);
    CHECK(nearest_double("000", 9000) == 0);
    CHECK(nearest_double("1" + std::string(400, '0'), -400) == 1);
}

TEST_CASE("every bit pattern reads back from its text", "[number_text]") {
    std::mt19937_64 random(7);
    const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x); };
    for (int i = 0; i < 20000; ++i) {
        const auto d = std::bit_cast<double>(i < 64 ? std::uint64_t{1} << i : random());
        for (const double x : {d, -inf, -0.0}) {
            if (std::isnan(x)) continue;
            REQUIRE(bits(parse_number(decimal(x)).value()) == bits(x));
            REQUIRE(bits(parse_number(hex(x)).value()) == bits(x));
            REQUIRE(bits(std::strtod(hex(x).c_str(), nullptr)) == bits(x));
        }
        const auto f = std::bit_cast<float>(i < 32 ? 1u << i : static_cast<std::uint32_t>(random()));
        if (std::isfinite(f)) REQUIRE(std::strtof(decimal(f).c_str(), nullptr) == f);
    }
}

TEST_CASE("a CSV file has exactly the expected bytes", "[csv]") {
    const Scratch folder;
    CsvWriter csv(folder / "t.csv", {{"form", "string", "", "the form"},
                                     {"rays", "integer", "", "rays"},
                                     {"ulp_error_max", "number", "ulp", "worst"},
                                     {"ok", "boolean", "", "whether it holds"}});
    csv.add_row({"plain", 3, 0.1, true});
    csv.add_row({"comma, \"quote\"", std::uint64_t{18446744073709551615u}, 0.1f, false});
    csv.add_row({"line\nbreak\r", -4, not_a_number, Cell()});
    csv.add("\xC3\xA9").add(Cell()).add(-inf).add(true).end_row();
    csv.add_row({"bad \xFF\xC0\x80 utf-8", 0, 7, false});
    REQUIRE_FALSE(fs::exists(folder / "t.csv"));
    csv.close();
    CHECK(contents(folder / "t.csv") ==
          "form,rays,ulp_error_max,ok\n"
          "plain,3,0.1,1\n"
          "\"comma, \"\"quote\"\"\",18446744073709551615,0.1,0\n"
          "\"line\nbreak\r\",-4,nan,\n"
          "\xC3\xA9,,-inf,1\n"
          "bad \xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD utf-8,0,7,0\n");
    // A lone missing cell is not a blank line.
    CsvWriter lone(folder / "lone.csv", {{"only", "number", "", ""}});
    lone.add_row({Cell()});
    lone.add_row({1});
    lone.close();
    CHECK(contents(folder / "lone.csv") == "only\n\"\"\n1\n");
}

TEST_CASE("rows of the wrong length are program errors", "[csv]") {
    const Scratch folder;
    CsvWriter csv(folder / "t.csv", {{"a", "integer", "", ""}, {"b", "number", "", ""}});
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

TEST_CASE("valid UTF-8 is kept and anything else is replaced", "[csv]") {
    const std::string good = "a\xC2\x80\xE0\xA0\x80\xEF\xBF\xBF\xF0\x90\x80\x80\xF4\x8F\xBF\xBF";
    CHECK(to_valid_utf8(good) == good);
    const std::string mark = "\xEF\xBF\xBD";
    CHECK(to_valid_utf8("\xC1\xBF") == mark + mark);                        // overlong
    CHECK(to_valid_utf8("\xED\xA0\x80") == mark + mark + mark);             // surrogate
    CHECK(to_valid_utf8("\xF4\x90\x80\x80") == mark + mark + mark + mark);  // past U+10FFFF
    CHECK(to_valid_utf8("ab\xE2\x82") == "ab" + mark + mark);               // cut short
}

TEST_CASE("a data package describes its columns", "[datapackage]") {
    const Scratch folder;
    const std::vector<DataResource> resources{{"Scene A/summary.csv",
                                               "One row a form",
                                               {{"form", "string", "", "the form"},
                                                {"lost_bits_max", "number", "bits", "worst \xFF pixel"},
                                                {"ok", "boolean", "", "holds"}}}};
    write_datapackage(folder / "datapackage.json", "Map of A", resources);
    const std::string text = contents(folder / "datapackage.json");
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

TEST_CASE("CSV is read by RFC 4180 and in its common dialects", "[read_csv]") {
    for (const char* text : {"name,x\n\"a,b\",1\n\"say \"\"so\"\"\",2\n\"two\nlines\",3\n,\"\"\n",
                             "name,x\r\n\"a,b\",1\r\n\"say \"\"so\"\"\",2\r\n\"two\nlines\",3\r\n,\"\"\r\n",
                             "\xEF\xBB\xBFname,\"x\"\n\"a,b\",\"1\"\n\"say \"\"so\"\"\",2\n\"two\nlines\",3\n,"}) {
        INFO(text);
        const CsvTable t = table(text);
        REQUIRE(t.columns.size() == 2);
        CHECK(t.columns[0].name == "name");
        CHECK((t.columns[0].cells == std::vector<std::string_view>{"a,b", "say \"so\"", "two\nlines", ""}));
        CHECK((t.columns[1].cells == std::vector<std::string_view>{"1", "2", "3", ""}));
        CHECK((t.lines == std::vector<std::size_t>{2, 3, 4, 6}));
        CHECK(t.find("x") == &t.columns[1]);
        CHECK(t.find("X") == nullptr);
    }
    CHECK(table("a,b").rows() == 0);
    CHECK(table("a\n\n\"\"\n").rows() == 2);
    // A table that moves keeps its cells, short as the text may be.
    CsvTable from = table("a\n7");
    const CsvTable to = std::move(from);
    CHECK(to.columns[0].cells[0] == "7");
}

TEST_CASE("a malformed CSV file is refused with its line, and a path that is not a file too", "[read_csv]") {
    const struct {
        std::string text;
        const char *place, *why;
    } cases[] = {
        {"a,b\n1,2\n3\n", "t.csv:3: ", "1 cell where the header has 2"},
        {"a,b\n\"1\n\n\",2\n3,4,5\n", "t.csv:5: ", "3 cells where the header has 2"},
        {"a,b\n1,2\n\n", "t.csv:3: ", "1 cell where"},
        {"", "t.csv:1: ", "empty"},
        {"a,b\n1,\"2\n3,4\n", "t.csv:2: ", "never ends"},
        {"a,b\n1,2\"\n", "t.csv:2: ", "unquoted"},
        {"a,b\n1,\"2\"3\n", "t.csv:2: ", "after a closing quote"},
        {"a,a\n1,2\n", "t.csv:1: ", "twice"},
        {"a,b\r1,2\r", "t.csv:1: ", "carriage return"},
        {std::string("a,b\n1,\0\n", 8), "t.csv:2: ", "NUL"},
    };
    for (const auto& c : cases) {
        INFO(c.text);
        std::string said = "none";
        try {
            static_cast<void>(table(c.text));
        } catch (const InputError& error) {
            said = error.what();
        }
        INFO(said);
        CHECK(said.starts_with(c.place));
        CHECK(said.find(c.why) != std::string::npos);
    }
    const Scratch folder;
    CHECK_THROWS_AS(read_csv(folder / "none.csv"), InputError);
    CHECK_THROWS_AS(read_csv(folder.path()), InputError);
}

TEST_CASE("the value of a cell is exact, however it is written", "[read_csv]") {
    for (const char* same : {"1000", "1e3", "1000.0", "+1E+03", "0001000", "0x1.f4p+9", "0X3E8", "10000e-1"}) {
        INFO(same);
        CHECK(read_cell(same) == read_cell("1000"));
        CHECK(read_cell(same).to_double() == 1000);
    }
    CHECK(read_cell("0x1.8p-1074") == read_cell("0x3p-1075"));
    CHECK(read_cell(decimal(0x1p-20)) == read_cell(hex(0x1p-20)));
    CHECK(read_cell("0.1000000000000000055511151231257827021181583404541015625") == read_cell(hex(0.1)));
    for (const auto& [a, b] :
         {std::pair("0.1", "0x1.999999999999ap-4"), std::pair("9007199254740993", "9007199254740992"),
          std::pair("0", "-0"), std::pair("1", "-1"), std::pair("1", "10")})
        CHECK_FALSE(read_cell(a) == read_cell(b));
    CHECK(read_cell("-0x0p+0").is_negative);
    using enum CellValue::Kind;
    const std::pair<CellValue::Kind, std::vector<const char*>> kinds[] = {
        {number, {"1e-2000", "-0x0p+0"}},
        {nan, {"nan", "NaN", "-nan"}},
        {infinity, {"inf", "-Infinity", "+INF"}},
        {missing, {""}},
        {text,
         {"-", ".", "e3", "1e", "1e+-3", "1 ", " 1", "1,5", "0x", "0x1p", "nano", "infinit", "1e99999999999", "1f",
          "--1"}}};
    for (const auto& [kind, cells] : kinds) {
        for (const char* cell : cells) {
            INFO(cell);
            CHECK(read_cell(cell).kind == kind);
        }
    }
}

}  // namespace test_text
