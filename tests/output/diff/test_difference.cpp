#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "catch.hpp"
#include "number/error.hpp"
#include "output/diff/difference.hpp"
#include "output/file/csv.hpp"
#include "output/file/number_text.hpp"

namespace test_difference {

using namespace lostbits;
using namespace lostbits::output;
using namespace lostbits::output::diff;
using namespace lostbits::output::file;

namespace {

constexpr float inf = std::numeric_limits<float>::infinity();
constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();

output::file::CsvTable table(const std::string& text) { return parse_csv(text, "t.csv"); }

output::diff::CompareOptions within(std::initializer_list<const char*> tolerances,
                                    std::vector<std::string> ignored = {}) {
    CompareOptions options;
    for (const char* t : tolerances) options.tolerances.push_back(parse_tolerance(t));
    options.ignored = std::move(ignored);
    return options;
}

/// Differences of two tables of one row and one column.
output::diff::Comparison cells(const std::string& a, const std::string& b, const CompareOptions& options = {},
                               const std::string& column = "x") {
    return compare(table(column + "\n" + quoted_field(a) + "\n"), table(column + "\n" + quoted_field(b) + "\n"),
                   options);
}

bool says(const output::diff::Comparison& c, const std::string& what) {
    return std::ranges::any_of(c.differences, [&](const output::diff::Difference& d) { return d.text == what; });
}

output::image::ExrImage image_of(std::vector<float> x, std::vector<std::uint32_t> id = {1, 2, 3, 4}) {
    return {2,
            2,
            {{"class.id", std::move(id)}, {"err.ulp", std::move(x)}},
            {{"lostbits:command", "map"}, {"lostbits:form", "sphere.press"}}};
}

}  // namespace

TEST_CASE("diff: tables of earlier versions are compared under today's names") {
    const auto before = table("form,wrong_object,fault_outcome\nx,3,wrong_object\n");
    const auto now = table("form,wrong_primitive,fault_outcome\nx,3,wrong_primitive\n");
    CHECK(output::diff::compare(before, now, {}).is_same());
    CHECK(output::diff::compare(table("form,wrong_object\nx,3\n"), table("form,wrong_primitive\nx,4\n"), {}).count ==
          1);
}

TEST_CASE("diff: without a tolerance, numbers are compared by exact value and text by bytes", "[difference]") {
    for (const auto& [a, b] :
         {std::pair{"1e3", "1000"}, {"nan", "NaN"}, {"inf", "Infinity"}, {"a b", "a b"}, {"", ""}}) {
        INFO(a << " " << b);
        CHECK(cells(a, b).is_same());
    }
    for (const auto& [a, b] : {std::pair{"1", "1.0000000000000000000001"},
                               {"0", "-0"},
                               {"a", "A"},
                               {"9007199254740993", "9007199254740992"},
                               {"1", "one"}}) {
        INFO(a << " " << b);
        CHECK(cells(a, b).count == 1);
        CHECK(cells(b, a).count == 1);
    }
    CHECK(cells("a", "A").columns[0].not_finite_count == 0);
}

TEST_CASE("diff: a tolerance never covers NaN, infinities, missing values and text", "[difference]") {
    const auto generous = within({"*=1e300,1e300"});
    REQUIRE(cells("1", "1e200", generous).is_same());
    const char* kinds[] = {"1", "nan", "", "inf", "-inf", "text"};
    for (const char* a : kinds) {
        for (const char* b : kinds) {
            INFO('"' << a << "\" \"" << b << '"');
            const output::diff::Comparison c = cells(a, b, generous);
            CHECK(c.is_same() == (std::string_view(a) == b));
            CHECK(c.columns[0].not_finite_count == (c.is_same() ? 0 : 1));
            CHECK(c.columns[0].absolute.position.empty());
        }
    }
}

TEST_CASE("diff: a tolerance is absolute or relative, symmetric, and compared without rounding", "[difference]") {
    // In double, 0.4 - 0.3 is more than 0.1.
    CHECK(cells("0.3", "0.4", within({"x=0.1"})).is_same());
    CHECK(cells("0.3", "0.4000000000000000000000000001", within({"x=0.1"})).count == 1);
    CHECK(cells("90", "100", within({"x=0,0.1"})).is_same());
    CHECK(cells("100", "90", within({"x=0,0.1"})).is_same());
    CHECK(cells("100", "89.9999999999999999999", within({"x=0,0.1"})).count == 1);
    CHECK(cells("-90", "-100", within({"x=0,0.1"})).is_same());
    CHECK(cells("-1", "1", within({"x=1.9,1.9"})).count == 1);
    CHECK(cells("1", "2", within({"x=1"})).is_same());
    CHECK(cells("0", "-0", within({"x=0"})).is_same());
    CHECK(cells("1", "2", within({"y=1"})).count == 1);
    CHECK(cells("1", "2", within({"[w-y]=1"})).is_same());
    CHECK(cells("1", "2", within({"*=1", "x=0.5"})).count == 1);
    CHECK(cells("1", "2", within({"x=0.5", "*=1"})).is_same());
}

TEST_CASE("diff: numbers far apart are compared as exact fractions are", "[difference]") {
    using Fraction = boost::multiprecision::cpp_rational;
    using boost::multiprecision::cpp_int;
    std::mt19937 random(3);
    const auto drawn = [&](int low, int high) { return std::uniform_int_distribution<int>(low, high)(random); };
    const auto power = [](int e) {
        const cpp_int p = boost::multiprecision::pow(cpp_int(10), static_cast<unsigned>(std::abs(e)));
        return e < 0 ? Fraction(1, p) : Fraction(p);
    };
    struct Number {
        std::string text;
        Fraction value;
    };
    const auto number = [&](int low, int high) {
        const int digits = drawn(low, high), exponent = drawn(-60, 60);
        return Number{std::to_string(digits) + "e" + std::to_string(exponent), Fraction(digits) * power(exponent)};
    };
    int same = 0;
    for (int i = 0; i < 20000; ++i) {
        const Number a = number(-999, 999), b = number(-999, 999);
        const Number absolute =
            drawn(0, 1) == 1 ? number(0, 999) : Number{a.text.substr(a.text[0] == '-'), abs(a.value)};
        const int percent = drawn(0, 4) * 50;
        const std::string relative = fmt::format("{}e-2", percent);
        const Fraction apart = abs(a.value - b.value), larger = std::max(abs(a.value), abs(b.value));
        const bool right = apart <= absolute.value || apart <= Fraction(percent, 100) * larger;
        INFO(a.text << " and " << b.text << " within " << absolute.text << ", " << relative);
        REQUIRE(cells(a.text, b.text, within({("x=" + absolute.text + "," + relative).c_str()})).is_same() == right);
        same += right;
        const auto found = cells(a.text, b.text);
        if (apart == 0) continue;
        REQUIRE(found.columns[0].absolute.value == Approx(static_cast<double>(apart)).epsilon(1e-12));
        REQUIRE(found.columns[0].relative.value ==
                Approx(static_cast<double>(Fraction(apart / larger))).epsilon(1e-12));
    }
    CHECK(same > 1000);
    CHECK(same < 19000);
    CHECK(cells("1e9999", "1e-9999").count == 1);
    CHECK(cells("0", "1e-9999", within({"x=1e-9999"})).is_same());
    CHECK(cells("1e-9999", "1e9999", within({"x=1e9999"})).is_same());
    CHECK(cells("-1e-9999", "1e9999", within({"x=1e9999"})).count == 1);
}

TEST_CASE("diff: as few columns as possible are reported as moved", "[difference]") {
    std::mt19937 random(4);
    const std::string names = "abcdefg";
    const auto header = [](const std::string& order) {
        std::string text;
        for (const char c : order) text += (text.empty() ? "" : ",") + std::string(1, c);
        return text + "\n";
    };
    for (int i = 0; i < 300; ++i) {
        std::string order = names;
        std::ranges::shuffle(order, random);
        // The longest part that is in order, among all 2^7.
        std::size_t longest = 0;
        for (unsigned chosen = 0; chosen < 128; ++chosen) {
            std::string part;
            for (std::size_t k = 0; k < order.size(); ++k) part += (chosen >> k & 1U) != 0 ? order.substr(k, 1) : "";
            if (std::ranges::is_sorted(part)) longest = std::max(longest, part.size());
        }
        INFO(order);
        REQUIRE(compare(table(header(names)), table(header(order)), {}).count == names.size() - longest);
    }
}

TEST_CASE("diff: hexadecimal columns are exact text unless a tolerance names them", "[difference]") {
    CHECK(cells("0x1p+1", "0x2p+0", {}, "t_hex").count == 1);
    CHECK(cells("0x1p+1", "0x2p+0", {}, "t_hexed").is_same());
    CHECK(cells("0x1p+1", "0x2p+0", within({"t=1"}), "t_hex").count == 1);
    CHECK(cells("0x1p+1", "0x2p+0", within({"t_hex=0"}), "t_hex").is_same());
    CHECK(cells("0x1p+1", "0x1.8p+1", within({"t_hex=1"}), "t_hex").is_same());
    CHECK(cells("0x1p+1", "0x1.8p+1", within({"t_hex=0.5"}), "t_hex").count == 1);
}

TEST_CASE("diff: a wrong tolerance is refused", "[difference]") {
    for (const char* bad : {"x", "=1", "x=", "x=-1", "x=nan", "x=inf", "x=1,", "x=1,-2", "x=1,2,3", "x=1e"}) {
        INFO(bad);
        CHECK_THROWS_AS(output::diff::parse_tolerance(bad), InputError);
    }
    const output::diff::Tolerance t = parse_tolerance("a=b=0.5,1e-3");
    CHECK(t.column == "a=b");
    CHECK(t.absolute.to_double() == 0.5);
    CHECK(t.relative.to_double() == 1e-3);
}

TEST_CASE("diff: missing, added and moved columns are reported, and the others compared by name", "[difference]") {
    const output::file::CsvTable a = table("a,b,c,d,e\n1,2,3,4,5\n");
    const output::diff::Comparison c = compare(a, table("a,c,d,b,f\n1,3,9,2,6\n"), {});
    CHECK(c.count == 4);
    CHECK(says(c, "column e is missing in the second"));
    CHECK(says(c, "column f is added in the second"));
    CHECK(says(c, "column b moved from place 2 to place 4"));
    CHECK(says(c, "d: 4 != 9 (abs 5, rel 0.5556)"));
    CHECK((c.names == std::vector<std::string>{"a", "b", "c", "d", "e", "f"}));
    CHECK(compare(a, table("a,c,d,b,f\n1,3,9,2,6\n"), within({}, {"[b-f]"})).is_same());
    CHECK(compare(a, table("b,c,d,e,a\n2,3,4,5,1\n"), {}).count == 1);
    CHECK(compare(a, a, {}).is_same());
}

TEST_CASE("diff: rows are matched by position, and different numbers of rows are reported", "[difference]") {
    const output::diff::Comparison c = compare(table("x\n1\n2\n3\n"), table("x\n1\n5\n"), {});
    CHECK(c.count == 2);
    CHECK(says(c, "rows: 3 != 2; the first 2 are compared"));
    CHECK(says(c, "x: 2 != 5 (abs 3, rel 0.6)"));
    CHECK(c.differences[0].line == 3);
}

TEST_CASE("diff: rows of claims are matched by their id, wherever they stand", "[difference]") {
    const CsvTable before = table("id,measured\na,1\nb,2\nc,3\n");
    CHECK(compare(before, table("id,measured\nc,3\na,1\nb,2\n"), {}).is_same());
    const output::diff::Comparison c = compare(before, table("id,measured\nnew,7\nc,4\na,1\n"), {});
    CHECK(c.count == 3);
    CHECK(c.rows == 2);
    CHECK(c.differing_rows == 1);
    CHECK(says(c, "\"c\": measured: 3 != 4 (abs 1, rel 0.25)"));
    CHECK(says(c, "\"b\": missing in the second"));
    CHECK(says(c, "\"new\": added in the second"));
    // An id that occurs twice does not identify a row.
    CHECK(says(compare(table("id,x\na,1\na,2\n"), table("id,x\na,1\n"), {}), "rows: 2 != 1; the first 1 are compared"));
}

TEST_CASE("diff: line numbers are those of the first file, and text is shown on one line", "[difference]") {
    const output::diff::Comparison c = compare(table("t,x\n\"a\nb\",1\nc,2\n"), table("t,x\n\"a\nB\",1\nc,\n"), {});
    REQUIRE(c.count == 2);
    CHECK(c.differences[0].line == 2);
    CHECK(c.differences[0].text == "t: \"a\\nb\" != \"a\\nB\"");
    CHECK(c.differences[1].line == 4);
    CHECK(c.differences[1].text == "x: 2 != (empty)");
}

TEST_CASE("diff: the largest differences and their places are shown, up to the requested number of lines",
          "[difference]") {
    std::string a = "x,y\n", b = a;
    for (int i = 1; i <= 50; ++i) {
        a += std::to_string(i) + ",0\n";
        b += std::to_string(i == 30 ? 90 : i + 1) + ",0\n";
    }
    output::diff::CompareOptions options;
    for (const std::uint64_t most : {0, 20, 50, 60}) {
        options.max_listed = most;
        const output::diff::Comparison c = compare(table(a), table(b), options);
        CHECK(c.count == 50);
        CHECK(c.differences.size() == std::min<std::uint64_t>(most, 50));
        REQUIRE(c.columns.size() == 2);
        CHECK(c.columns[0].count == 50);
        CHECK(c.columns[0].absolute.value == 60);
        CHECK(c.columns[0].absolute.position == "line 31");
        CHECK(c.columns[0].relative.value == Approx(60.0 / 90));
        CHECK(c.columns[1].count == 0);
        CHECK(c.columns[1].absolute.position.empty());
    }
    // A difference within the tolerance is measured all the same.
    const output::diff::Comparison c = compare(table(a), table(b), within({"x=60"}));
    CHECK(c.is_same());
    CHECK(c.columns[0].absolute.value == 60);
    // Neither leaves the range of a double, nor vanishes in it.
    CHECK(cells("1e400", "2e400").columns[0].relative.value == Approx(0.5));
    CHECK(cells("1", "1.00000000000000000001").columns[0].absolute.value == Approx(1e-20));
}

TEST_CASE("diff: EXR samples are compared bit by bit, NaNs are equal, and a tolerance is for floats only",
          "[difference]") {
    const float payload = std::bit_cast<float>(0x7FC01234u);
    REQUIRE(std::isnan(payload));
    CHECK(compare(image_of({1, not_a_number, inf, 0}), image_of({1, payload, inf, 0}), {}).is_same());
    const output::diff::Comparison c = compare(image_of({1, 2, 3, 4}), image_of({1, 2, 3.5, 4}), {});
    REQUIRE(c.count == 1);
    CHECK(c.differences[0].text == "err.ulp at 0,1: 3 != 3.5 (abs 0.5, rel 0.1429)");
    CHECK(c.columns[1].absolute.position == "0,1");
    const auto half = within({"err.*=0.5"});
    CHECK(compare(image_of({1, 2, 3, 0.0F}), image_of({1, 2, 3.5, -0.0F}), half).is_same());
    CHECK(compare(image_of({1, 2, 3, 0.0F}), image_of({1, 2, 3, -0.0F}), {}).count == 1);
    CHECK(compare(image_of({1, 2, 3, 4}), image_of({1, 2, 3.75, 4}), half).count == 1);
    CHECK(compare(image_of({1, 2, 3, 4}), image_of({1, 2, 3.75, 4}), within({"err.*=0,0.25"})).is_same());
    const auto generous = within({"*=1e30,1e30"});
    for (const float other : {inf, -inf, not_a_number}) {
        CHECK(compare(image_of({1, 2, 3, 4}), image_of({1, 2, other, 4}), generous).columns[1].not_finite_count == 1);
        CHECK(compare(image_of({1, 2, other, 4}), image_of({1, 2, 3, 4}), generous).count == 1);
    }
    CHECK(compare(image_of({inf, 0, 0, 0}), image_of({-inf, 0, 0, 0}), generous).count == 1);
    const output::diff::Comparison codes =
        compare(image_of({1, 2, 3, 4}), image_of({1, 2, 3, 4}, {1, 7, 3, 4}), generous);
    REQUIRE(codes.count == 1);
    CHECK(codes.differences[0].text == "class.id at 1,0: 2 != 7");
    CHECK(compare(image_of({1, 2, 3, 4}), image_of({1, 2, 3, 4}, {1, 7, 3, 4}), within({}, {"class.*"})).is_same());
}

TEST_CASE("diff: EXR sizes, channels, types and attributes are compared", "[difference]") {
    const output::image::ExrImage a = image_of({1, 2, 3, 4});
    output::image::ExrImage b = image_of({9, 2, 3, 4});
    b.width = 4, b.height = 1;
    CHECK(says(compare(a, b, {}), "size: 2x2 != 4x1"));
    CHECK(compare(a, b, {}).count == 1);

    b = image_of({1, 2, 3, 4});
    b.channels[1].name = "err.other";
    const output::diff::Comparison renamed = compare(a, b, {});
    CHECK(renamed.count == 2);
    CHECK(says(renamed, "channel err.ulp is missing in the second"));
    CHECK(says(renamed, "channel err.other is added in the second"));
    CHECK((renamed.names == std::vector<std::string>{"class.id", "err.ulp", "err.other"}));
    CHECK(compare(a, b, within({}, {"err.*"})).is_same());

    b = image_of({1, 2, 3, 4});
    b.channels[1].samples = std::vector<std::uint32_t>{1, 2, 3, 4};
    CHECK(says(compare(a, b, within({"*=9"})), "channel err.ulp: type f32 != u32"));

    b = image_of({1, 2, 3, 4});
    b.attributes = {
        {"lostbits:command", "another"}, {"lostbits:compiler", "another"}, {"lostbits:form", "sphere.press"}};
    CHECK(compare(a, b, {}).is_same());
    b.attributes.back().second = "sphere.unified";
    CHECK(says(compare(a, b, {}), "attribute lostbits:form: \"sphere.press\" != \"sphere.unified\""));
    b.attributes.pop_back();
    CHECK(says(compare(a, b, {}), "attribute lostbits:form: \"sphere.press\" != (absent)"));
}

TEST_CASE("diff: PNG files are compared by pixels and other files by bytes", "[difference]") {
    const output::image::PngImage a{2, 1, {{1, 2, 3}, {4, 5, 6}}};
    CHECK(compare(a, a, {}).is_same());
    const output::diff::Comparison c = compare(a, {2, 1, {{1, 2, 3}, {4, 5, 57}}}, {});
    REQUIRE(c.count == 1);
    CHECK(c.differences[0].text == "pixel at 1,0: 4,5,6 != 4,5,57");
    CHECK(c.columns[0].absolute.value == 51);
    CHECK(c.columns[0].relative.value == Approx(0.2));
    CHECK(says(compare(a, {1, 2, a.pixels}, {}), "size: 2x1 != 1x2"));

    CHECK(output::diff::compare_bytes("abc", "abc").is_same());
    const output::diff::Comparison bytes = compare_bytes("a\nbc", "a\nbx!");
    REQUIRE(bytes.count == 1);
    CHECK(bytes.differences[0].line == 2);
    CHECK(bytes.differences[0].text == "bytes differ from byte 3 on; 4 != 5 bytes in total");
    CHECK(compare_bytes("ab", "ac").differences[0].text == "bytes differ from byte 1 on");
    CHECK(compare_bytes("abc", "ab").count == 1);
    CHECK(compare_bytes("", "a").count == 1);
}

}  // namespace test_difference
