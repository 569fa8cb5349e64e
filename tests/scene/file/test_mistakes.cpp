// Every key of scenes and sweeps, wrong in each way that applies to any key: the error names its place and the key, and
// the key is documented.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <vector>

#include "catch.hpp"
#include "scene/scene_text.hpp"
#include "scene/sweep/case_file.hpp"
#include "scene/sweep/exhaustive_file.hpp"
#include "scene/sweep/search_file.hpp"
#include "scene/sweep/sweep_file.hpp"

namespace test_mistakes {

using namespace lostbits;
using namespace lostbits::scene::test;

namespace {

struct Line {
    std::string text, key, table;  ///< `a = 1`, `a`, and the header that it stands under
};

struct Sample {
    std::string name;
    std::vector<Line> lines;

    explicit Sample(const fs::path& file) : name(file.stem().string()) {
        std::ifstream text(file);
        std::string table;
        for (std::string line; std::getline(text, line);) {
            if (line.starts_with('[')) table = line;
            lines.push_back({line, line.starts_with('[') ? "" : line.substr(0, line.find(' ')), table});
        }
    }

    /// Message of the error after one line is replaced by another.
    [[nodiscard]] std::string error_with(std::size_t place, const std::string& line) const {
        const Scratch folder;
        std::string all;
        for (std::size_t i = 0; i < lines.size(); ++i) all += (i == place ? line : lines[i].text) + '\n';
        const fs::path file = folder.write("t.toml", all);
        const bool is_scene = lines[0].text.find("scene") != std::string::npos;
        return error_in(folder,
                        [&] { is_scene ? static_cast<void>(scene::file::load_scene(file)) : read_sweep(file); });
    }

private:
    static void read_sweep(const fs::path& file) {
        using namespace scene::sweep;
        switch (read_sweep_kind(file)) {
            case SweepKind::axes: SweepFile(file, LOSTBITS_DATA_DIR); break;
            case SweepKind::cases: CaseFile{file}; break;
            case SweepKind::search: SearchFile{file}; break;
            case SweepKind::edge_search: EdgeSearchFile(file, LOSTBITS_DATA_DIR); break;
            case SweepKind::every_float: ExhaustiveFile(file, LOSTBITS_DATA_DIR); break;
        }
    }
};

/// Calls `check` with each key of each sample; together the samples have every key.
template <class Check>
void for_each_key(const Check& check) {
    const fs::path folder = fs::path(LOSTBITS_DATA_DIR).parent_path() / "tests/scene/mistakes";
    std::size_t keys = 0;
    for (const auto& entry : fs::directory_iterator(folder)) {
        const Sample sample(entry.path());
        INFO(sample.name);
        REQUIRE(sample.error_with(0, sample.lines[0].text) == "no error");
        for (std::size_t i = 0; i < sample.lines.size(); ++i) {
            if (sample.lines[i].key.empty()) continue;
            INFO(sample.lines[i].table << " " << sample.lines[i].key);
            check(sample, i);
            ++keys;
        }
    }
    CHECK(keys > 200);
}

bool is_at(const std::string& error, std::size_t line) {
    return error.starts_with("t.toml:" + std::to_string(line + 1) + ":");
}

}  // namespace

TEST_CASE("a wrong value is reported with its position, its key and advice") {
    const std::set<std::string> texts{"title", "source", "note", "name", "unit", "label", "format", "metric"};
    for_each_key([&](const Sample& sample, std::size_t i) {
        const auto& [text, key, table] = sample.lines[i];
        for (const std::string value : {"nan", "-inf", "1979-05-27", "[[]]", "\"1e400 !\"", "\"\\u009b\""}) {
            // The numbers of cases may be of any format, including nan, so a message has their place alone.
            const bool is_quantity = table.starts_with("[[case");
            if (is_quantity && table == "[[case.rays]]" && (value == "nan" || value == "-inf")) continue;
            const std::string error = sample.error_with(i, key + " = " + value);
            INFO(value << "\n" << error);
            if (value == "\"1e400 !\"" && texts.contains(key) && error == "no error") continue;
            CHECK(is_at(error, i));
            CHECK((is_quantity || has(error, key)));
            CHECK((has(error, "; ") || has(error, "expected") || has(error, "must be")));  // what to write
        }
    });
}

TEST_CASE("a missing, misspelt or repeated key is reported or has a default") {
    // Without these keys nothing else has a meaning, or keys beside them are missing and are reported first.
    const std::set<std::string> leading{"schema", "make", "kind", "all"};
    for_each_key([&](const Sample& sample, std::size_t i) {
        const auto& [text, key, table] = sample.lines[i];
        if (leading.contains(key) || (key == "scene" && table.empty())) return;
        const std::string missing = sample.error_with(i, ""), misspelt = sample.error_with(i, key[0] + text),
                          twice = sample.error_with(i, text + "\n" + text);
        INFO(missing << "\n" << misspelt);
        CHECK((missing == "no error" || (missing.starts_with("t.toml:") && has(missing, key))));
        CHECK(is_at(misspelt, i));
        CHECK(has(misspelt, "did you mean \"" + key + "\"?"));
        CHECK(is_at(twice, i + 1));
        CHECK(has(twice, key));
    });
}

TEST_CASE("every key of a scene or a sweep is documented in data/README.md") {
    std::ifstream file(fs::path(LOSTBITS_DATA_DIR) / "README.md");
    const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    const std::size_t of_sweeps = text.find("## sweeps/"), end = text.find("## hard/");
    std::set<std::string> of_scene, of_sweep;
    for_each_key([&](const Sample& sample, std::size_t i) {
        auto& known = has(sample.lines[0].text, "sweep") ? of_sweep : of_scene;
        // An error about an unknown key ends with all names that are known there, if they are at most a dozen.
        const std::string error = sample.error_with(i, sample.lines[i].text + "\nqqqqqqqq = 1");
        static const std::regex name("\"([a-z_]+)\"");
        for (std::sregex_iterator at(error.begin(), error.end(), name), last; at != last; ++at) known.insert((*at)[1]);
        known.insert(sample.lines[i].key);
    });
    std::set<std::string> of_shapes{"schema"};  // stand there by example
    for (const ShapeRow& row : shape_rows) {
        of_shapes.insert({std::string(row.name), std::string(row.plural)});
        for (const Key& key : row.keys) of_shapes.emplace(key.name);
    }
    const auto require_documented = [&](const std::set<std::string>& keys, const std::string& about) {
        for (const std::string& key : keys) {
            if (of_shapes.contains(key)) continue;
            INFO(key);
            CHECK(std::regex_search(about, std::regex("`[^`]*\\b" + key + "\\b")));
        }
    };
    require_documented(of_scene, text.substr(0, of_sweeps));
    require_documented(of_sweep, text.substr(of_sweeps, end - of_sweeps));
}

}  // namespace test_mistakes
