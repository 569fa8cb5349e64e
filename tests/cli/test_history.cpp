// `lostbits check --save` and `--against`: how measured values move from one run to another.
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "catch.hpp"
#include "program.hpp"

namespace test_history {

using namespace lostbits::test;

TEST_CASE("history: measured claims are kept, and changes are shown to the last bit") {
    const Scratch scratch;
    const auto in = [&scratch](const char* name) { return "'" + (scratch.path() / name).string() + "'"; };
    const std::string check = "check --filter 'float.*' ";
    must(check + "--save " + in("before.json"));
    auto baseline = nlohmann::json::parse(contents(scratch / "before.json"));
    CHECK(baseline["schema"] == "lostbits-baseline/1");
    REQUIRE(baseline["claims"].size() >= 2);

    const auto same = must(check + "--against " + in("before.json") + " --moves " + in("moves.md"));
    CHECK(has(same.out, "no measured value moved; " + std::to_string(baseline["claims"].size()) + " are the same"));
    CHECK(has(contents(scratch / "moves.md"), "no measured value moved"));

    // The first was an ulp less, the last was not there; one is gone, and another was never selected here.
    const std::string first = baseline["claims"][0]["id"], last = baseline["claims"].back()["id"];
    const double now = std::strtod(baseline["claims"][0]["measured_hex"].get<std::string>().c_str(), nullptr);
    char hex[40];
    std::snprintf(hex, sizeof hex, "%a", std::nextafter(now, -HUGE_VAL));
    baseline["claims"][0]["measured_hex"] = hex;
    baseline["claims"][0]["measured"] = std::nextafter(now, -HUGE_VAL);
    baseline["claims"].erase(baseline["claims"].size() - 1);
    auto gone = baseline["claims"][0];
    gone["id"] = "float.gone|*";
    baseline["claims"].push_back(gone);
    gone["id"] = "other.unselected";
    baseline["claims"].push_back(gone);
    scratch.write("before.json", baseline.dump());
    const auto moved =
        must(check + "--against " + in("before.json") + " --moves " + in("moves.md") + " --junit " + in("junit.xml"));
    CHECK(has(moved.out, "3 measured values moved"));
    CHECK(has(moved.out, first));
    CHECK(has(moved.out, "new: agrees"));
    CHECK(has(moved.out, "gone"));
    CHECK_FALSE(has(moved.out, "other.unselected"));
    const std::string table = contents(scratch / "moves.md");
    CHECK(has(table, "| float.gone\\|* |"));
    const std::string junit = contents(scratch / "junit.xml");
    CHECK(has(junit, "<property name=\"moved\" value=\""));
    CHECK(has(junit, " before, "));
    CHECK(has(junit, "new, not in the earlier run"));
}

TEST_CASE("a wrong baseline and options that need one are refused") {
    const Scratch scratch;
    must("check --filter 'float.*' --save good.json", scratch.path());
    const auto good = nlohmann::json::parse(contents(scratch / "good.json"));
    std::vector<Refused> rows{{"--against none.json", "none.json"},
                              {"--moves m.md", "add --against BASELINE.json"},
                              {"--profile timing --save x.json", "--profile timing cannot be combined with"}};
    const auto add = [&](const std::string& text, const std::string& says) {
        const std::string name = "b" + std::to_string(rows.size()) + ".json";
        scratch.write(name, text);
        rows.push_back({"--against " + name, says});
    };
    for (const char* text : {"", "{}", "[]", "{\"schema\": \"lostbits-baseline/2\"}",
                             "{\"schema\": \"lostbits-baseline/1\", \"program\": 3}",
                             R"({"schema": "lostbits-baseline/1", "program": "", "compiler": "", "command": "",
                                 "claims": [{"id": "a", "quantity": "b", "state": "agrees",
                                             "measured_hex": "0x1p+0\u0000 more", "expected_hex": ["0", "1"]}]})"})
        add(text, "name a file that `lostbits check --save` wrote");
    const auto change = [&](const char* key, const nlohmann::json& value, const std::string& says) {
        auto baseline = good;
        baseline["claims"][1][key] = value;
        add(baseline.dump(), says);
    };
    change("id", good["claims"][0]["id"], "twice");
    change("state", "splendid", "in the state \"splendid\", which is not a state of claims");
    change("measured_hex", "0x1p99999", "\"0x1p99999\" is not a number in the range of a double");
    change("measured", 5, "one of the two was edited");
    change("measured", "nan", "one of the two was edited");
    change("quantity", 1, "a key is missing or has the wrong type");
    add("{\"schema\":\n  \"lostbits-baseline/1\",,", ".json:2:25: not valid JSON from here on");
    add("{}", "it has no schema, but only lostbits-baseline/1 can be read");
    check_refused(scratch, "check --filter 'float.*'", rows);
}

TEST_CASE("a baseline of other claims or of another quantity is reported") {
    const Scratch scratch;
    const std::string place = (scratch / "b.json").string(), check = "check --filter 'float.*' --against '";
    must("check --filter 'float.*' --save '" + place + "'");
    auto baseline = nlohmann::json::parse(contents(place));
    baseline["claims"][0]["quantity"] = "p99 of something else";
    scratch.write("b.json", baseline.dump());
    const auto moved = run(check + place + "'");
    CHECK(has(moved.out, "1 measured value moved"));
    CHECK(has(moved.out, "agrees, but of another quantity"));
    for (auto& claim : baseline["claims"]) claim["id"] = "other." + claim["id"].get<std::string>();
    scratch.write("b.json", baseline.dump());
    CHECK(has(run(check + place + "'").out, "no claim is in both runs"));
}

}  // namespace test_history
