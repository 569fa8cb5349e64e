#include <cmath>
#include <limits>

#include "catch.hpp"
#include "output/file/number_text.hpp"
#include "output/report/text.hpp"

namespace test_json {

using namespace lostbits::output;
using namespace lostbits::output::report;

TEST_CASE("numbers on the page are the CSV's decimals", "[json]") {
    for (const double x : {1.0, -0.0, 0.1, 12.818665731680333, 1e300, 0x1p-1074, 5e-324, 1e23, 9007199254740993.0})
        CHECK(report::compact_json(number_json(x)) == file::decimal(x));
}

TEST_CASE("a number that is not finite is null or a word in JSON", "[json]") {
    constexpr double inf = std::numeric_limits<double>::infinity();
    CHECK(report::compact_json(number_json(std::nan(""))) == "null");
    CHECK(report::compact_json(number_json(inf)) == "\"inf\"");
    CHECK(report::compact_json(number_json(-inf)) == "\"-inf\"");
}

TEST_CASE("JSON of the page is safe inside a script element and keeps the order of its members", "[json]") {
    const Json json{
        {"</script>", "a < b & \"c\"\n"}, {"b", Json::array({true, 1, 2.5, nullptr})}, {"a", Json::object()}};
    const std::string text = report::compact_json(json);
    CHECK(text == R"({"\u003c/script>":"a \u003c b & \"c\"\n","b":[true,1,2.5,null],"a":{}})");
    CHECK(Json::parse(text) == json);
    CHECK(report::compact_json(Json("\xff")) == "\"\xEF\xBF\xBD\"");
}

TEST_CASE("text between backquotes is code on the page", "[text]") {
    CHECK(prose_html("For `lostbits offsets`: a < b") == "For <code>lostbits offsets</code>: a &lt; b");
    CHECK(prose_html("one ` alone") == "one ` alone");
    CHECK(prose_html("`a<` and `b`") == "<code>a&lt;</code> and <code>b</code>");
    CHECK(prose_html("").empty());
}

}  // namespace test_json
