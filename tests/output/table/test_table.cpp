#include "output/table/table.hpp"

#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "catch.hpp"
#include "output/helpers.hpp"
#include "output/table/shared_columns.hpp"

namespace test_table {

using namespace lostbits::output::table;
using namespace lostbits::output::test;

namespace {

struct Part {
    double x;
    std::uint64_t count;
};
struct Row {
    std::string name;
    std::optional<Part> own;
    const Part* shared;
};

Table<Part> part_columns(const std::string& prefix) {
    Table<Part> table;
    table.add_exact({prefix + "_x", "ulp", "a number", &Part::x});
    return table.add({prefix + "_count", "a count", &Part::count});
}

Table<Row> row_table() {
    Table<Row> table{{"name", "what it is", &Row::name}};
    table.add(part_columns("own"), &Row::own);
    table.add(part_columns("shared"), &Row::shared);
    return table.add({"small", "1", "missing where it is not small",
                      [](const Row& r) { return when(r.own && r.own->count < 9, 0.5); }});
}

}  // namespace

TEST_CASE("the type of a column is that of its values", "[table]") {
    struct Any {
        double x;
        bool is;
    };
    const Table<Any> table{{"member", "", &Any::x},
                           {"narrow", "", [](const Any& r) { return static_cast<float>(r.x); }},
                           {"missing", "", or_missing(&Any::x)},
                           {"is", "", &Any::is},
                           {"place", "", [](const Any& r) { return r.is ? 1 : 0; }},
                           {"there", "", [](const Any& r) { return when(r.is, std::uint64_t{3}); }},
                           {"text", "", [](const Any& r) { return r.is ? "a" : "b"; }},
                           {"maybe", "", [](const Any& r) { return when(r.is, std::string_view("a")); }},
                           {{"known later", "integer", "", ""}, [](const Any&) { return 1; }}};
    std::string types;
    for (const auto& column : table.columns()) types += column.type + " ";
    CHECK(types == "number number number boolean integer integer string string integer ");
    CHECK(table.begin()[2].value({std::numeric_limits<double>::quiet_NaN(), true}).is_missing());
    CHECK(table.begin()[5].value({0, false}).is_missing());
    CHECK(table.begin()[5].value({0, true}).text() == "3");
}

TEST_CASE("a table writes the values of its columns, and nothing for a missing part", "[table]") {
    const Scratch folder;
    const Part shared{0.75, 9};
    TableFile<Row> file(folder / "", "rows.csv", "One row per row", row_table());
    file.add({"both", Part{0.1, 3}, &shared});
    file.add({"shared", std::nullopt, &shared});
    file.add({"own", Part{std::numeric_limits<double>::infinity(), 12}, nullptr});
    file.add({"none", std::nullopt, nullptr});
    close_tables(folder / "", "Rows", file);
    const std::string rows = contents(folder / "rows.csv");
    CHECK(rows ==
          "name,own_x,own_x_hex,own_count,shared_x,shared_x_hex,shared_count,small\n"
          "both,0.1,0x1.999999999999ap-4,3,0.75,0x1.8p-1,9,0.5\n"
          "shared,,,,0.75,0x1.8p-1,9,\n"
          "own,inf,inf,12,,,,\n"
          "none,,,,,,,\n");
    // The package has the same columns, with their types and units.
    const auto package = nlohmann::json::parse(contents(folder / "datapackage.json"));
    const auto& resource = package.at("resources").at(0);
    CHECK(resource.at("path") == "rows.csv");
    CHECK(resource.at("title") == "One row per row");
    std::string header;
    for (const auto& field : resource.at("schema").at("fields"))
        header += (header.empty() ? "" : ",") + field.at("name").get<std::string>();
    CHECK(rows.starts_with(header + "\n"));
    const auto& exact = resource.at("schema").at("fields").at(2);
    CHECK(exact.at("type") == "string");
    CHECK(exact.at("unit") == "ulp");
    CHECK(exact.at("description") == "the same, exactly");
}

TEST_CASE("a cell of the wrong type for its column is refused", "[table]") {
    const Table<Row> table{{{"name", "integer", "", "no number"}, [](const Row& r) { return r.name; }}};
    lostbits::output::file::CsvWriter csv(table.columns());
    CHECK_THROWS_AS(table.add_row(csv, Row{"text", {}, nullptr}), std::logic_error);
}

TEST_CASE("meanings are given for existing columns only", "[table]") {
    Table<Row> table = row_table();
    table.set_meaning("own_count", "another");
    table.set_meaning("no_such", "nothing");
    CHECK(table.columns().at(3).meaning == "another");
    CHECK(table.columns().size() == row_table().columns().size());
    CHECK(table.find("no_such") == nullptr);
}

TEST_CASE("numbers of nothing are missing", "[table]") {
    CHECK(!fraction_or_missing(0, 0));
    CHECK(fraction_or_missing(1, 4) == 0.25);
    struct Numbers {
        lostbits::measure::metric::Distribution sizes;
    } numbers;
    const auto largest = percentile(&Numbers::sizes, 100);
    CHECK(!largest(numbers));
    numbers.sizes.add(3);
    numbers.sizes.add(5);
    CHECK(largest(numbers) == 5);
}

}  // namespace test_table
