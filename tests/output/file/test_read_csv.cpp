#include <algorithm>

#include "catch.hpp"
#include "number/error.hpp"
#include "output/file/csv.hpp"
#include "output/file/number_text.hpp"
#include "output/file/read_csv.hpp"
#include "output/helpers.hpp"

namespace test_read_csv {

using namespace lostbits;
using namespace lostbits::output;
using namespace lostbits::output::file;
using namespace lostbits::output::test;

namespace {

output::file::CsvTable table(const std::string& text) { return parse_csv(text, "t.csv"); }

std::string complaint(const std::string& text) {
    try {
        static_cast<void>(table(text));
    } catch (const InputError& error) {
        return error.what();
    }
    return "none";
}

}  // namespace

TEST_CASE("a CSV is read as RFC 4180 and its dialects write it", "[read_csv]") {
    const std::string texts[] = {
        "name,x\n\"a,b\",1\n\"say \"\"so\"\"\",2\n\"two\nlines\",3\n,\"\"\n",
        "name,x\r\n\"a,b\",1\r\n\"say \"\"so\"\"\",2\r\n\"two\nlines\",3\r\n,\"\"\r\n",
        "\xEF\xBB\xBFname,\"x\"\n\"a,b\",\"1\"\n\"say \"\"so\"\"\",2\n\"two\nlines\",3\n,",
    };
    for (const std::string& text : texts) {
        INFO(text);
        const output::file::CsvTable t = table(text);
        REQUIRE(t.columns.size() == 2);
        CHECK(t.columns[0].name == "name");
        CHECK(t.columns[1].name == "x");
        CHECK((t.columns[0].cells == std::vector<std::string_view>{"a,b", "say \"so\"", "two\nlines", ""}));
        CHECK((t.columns[1].cells == std::vector<std::string_view>{"1", "2", "3", ""}));
        CHECK((t.lines == std::vector<std::size_t>{2, 3, 4, 6}));
        CHECK(t.find("x") == &t.columns[1]);
        CHECK(t.find("X") == nullptr);
    }
    CHECK(table("a,b").rows() == 0);
    CHECK(table("a\n\n\"\"\n").rows() == 2);
    // A table that moves keeps its cells, short as the text may be.
    output::file::CsvTable from = table("a\n7");
    const output::file::CsvTable to = std::move(from);
    CHECK(to.columns[0].cells[0] == "7");
}

TEST_CASE("what is no CSV is refused with its line", "[read_csv]") {
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
        const std::string said = complaint(c.text);
        INFO(said);
        CHECK(said.starts_with(c.place));
        CHECK(said.find(c.why) != std::string::npos);
    }
}

TEST_CASE("files that are not there and folders are bad input", "[read_csv]") {
    const Scratch folder;
    CHECK_THROWS_AS(output::file::read_csv(folder / "none.csv"), InputError);
    CHECK_THROWS_AS(output::file::read_csv(folder.path()), InputError);
    std::ofstream(folder / "empty");
    CHECK(output::file::read_file(folder / "empty").empty());
}

TEST_CASE("what the writer writes, the reader reads", "[read_csv]") {
    const Scratch folder;
    output::file::CsvWriter out(folder / "a.csv", {{"text", "string", "", ""}, {"x", "number", "", ""}});
    out.row({"a \"b\", c\r\nd", 0.1});
    out.row({output::file::Cell(), Cell()});
    out.close();
    const output::file::CsvTable t = read_csv(folder / "a.csv");
    CHECK((t.columns[0].cells == std::vector<std::string_view>{"a \"b\", c\r\nd", ""}));
    CHECK((t.columns[1].cells == std::vector<std::string_view>{"0.1", ""}));
}

TEST_CASE("a cell's value is exact and does not depend on how it is written", "[read_csv]") {
    for (const char* same : {"1000", "1e3", "1000.0", "+1E+03", "0001000", "0x1.f4p+9", "0X3E8", "10000e-1"}) {
        INFO(same);
        CHECK(output::file::read_cell(same) == read_cell("1000"));
        CHECK(read_cell(same).approximate() == 1000);
    }
    CHECK(output::file::read_cell("0x1.8p-1074") == read_cell("0x3p-1075"));
    CHECK(read_cell(output::file::decimal(0x1p-20)) == read_cell(output::file::hex(0x1p-20)));
    CHECK_FALSE(read_cell("0.1") == read_cell(hex(0.1)));
    CHECK(read_cell("0.1000000000000000055511151231257827021181583404541015625") == read_cell(hex(0.1)));
    CHECK_FALSE(read_cell("9007199254740993") == read_cell("9007199254740992"));
    CHECK_FALSE(read_cell("0") == read_cell("-0"));
    CHECK_FALSE(read_cell("1") == read_cell("-1"));
    CHECK_FALSE(read_cell("1") == read_cell("10"));
    CHECK(read_cell("1e-2000").kind == output::file::CellValue::Kind::number);
    CHECK(read_cell("-0x0p+0").negative);
    for (const char* nan : {"nan", "NaN", "-nan"}) CHECK(read_cell(nan).kind == output::file::CellValue::Kind::nan);
    for (const char* word : {"inf", "-Infinity", "+INF"})
        CHECK(read_cell(word).kind == output::file::CellValue::Kind::infinity);
    CHECK(read_cell("").kind == output::file::CellValue::Kind::missing);
    for (const char* text : {"-", ".", "e3", "1e", "1e+-3", "1 ", " 1", "1,5", "0x", "0x1p", "nano", "infinit",
                             "1e99999999999", "1f", "--1"}) {
        INFO(text);
        CHECK(read_cell(text).kind == output::file::CellValue::Kind::text);
    }
}

}  // namespace test_read_csv
