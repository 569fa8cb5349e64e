#include "program.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <stdexcept>

#include "catch.hpp"

namespace lostbits::test {

Outcome run(const std::string& arguments, const fs::path& folder, const std::string& before) {
    const Scratch streams;
    const std::string out = (streams.path() / "out").string(), err = (streams.path() / "err").string();
    // CI sets variables that change where libraries run; a test that needs one of them sets it itself. Pictures are not
    // looked at unless a test asks for it.
    const std::string pictures =
        std::getenv("LOSTBITS_IMAGE_MODULE") ? "" : "export LOSTBITS_IMAGE_MODULE='" LOSTBITS_PLAIN_IMAGES "' && ";
    const std::string command =
        "cd '" + folder.string() + "' && unset CI && export LOSTBITS_DATA='" LOSTBITS_DATA_DIR "' && " + pictures +
        "(" + before + " exec '" LOSTBITS_PROGRAM "' " + arguments + ") >'" + out + "' 2>'" + err + "' </dev/null";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), contents(out), contents(err)};
}

std::string end_after(double seconds, const std::string& signal) {
    const long ticks = std::lround(seconds * static_cast<double>(sysconf(_SC_CLK_TCK)));
    // Behind the name in brackets the fields begin with the state; the 12th and 13th are the ticks.
    return " & child=$!; while read -r stat </proc/$child/stat && set -- ${stat##*) } && [ $1 != Z ] && [ $((${12} + "
           "${13})) -lt " +
           std::to_string(ticks) + " ]; do sleep 0.02; done 2>/dev/null; kill -" + signal +
           " $child 2>/dev/null; wait $child; exit $?";
}

Outcome must(const std::string& arguments, const fs::path& folder, const std::string& before) {
    Outcome r = run(arguments, folder, before);
    INFO(arguments << "\n" << r.out << r.err);
    REQUIRE(r.code == 0);
    return r;
}

void check_refused(const Scratch& folder, const std::string& command, const std::vector<RefusedArguments>& rows) {
    const auto before = folder.files();
    for (const RefusedArguments& row : rows) {
        const Outcome r = run(command + " " + row.words, folder.path());
        INFO(command << " " << row.words << "\n" << r.err);
        CHECK(r.code == row.code);
        CHECK(has(r.err, row.says));
        CHECK(r.err.starts_with("lostbits: "));
        // Words of the parser that are not sentences.
        for (const char* raw :
             {"were not expected", "was not expected", " is required\n", "not in {", "TEXT", "Could not"})
            CHECK_FALSE(has(r.err, raw));
        CHECK(r.out.empty());
        CHECK(folder.files() == before);
        CHECK_FALSE(fs::exists(folder / "out"));
        fs::remove_all(folder / "out");  // an argument that is not refused hides the arguments behind it
    }
}

std::set<std::string> commands() {
    std::istringstream help(run("--help").out);
    std::set<std::string> names;
    bool below = false;
    for (std::string line; std::getline(help, line);) {
        if (line.starts_with("Commands:")) below = true;
        else if (below && line.starts_with("  ") && line[2] != ' ') names.insert(line.substr(2, line.find(' ', 2) - 2));
        else if (below && !line.starts_with(' ')) below = false;
    }
    return names;
}

void draw_pictures() { setenv("LOSTBITS_IMAGE_MODULE", LOSTBITS_SHIPPED_IMAGES, 1); }

std::vector<std::string> files_below(const fs::path& folder) {
    std::vector<std::string> names;
    std::error_code gone;  // files that a living run removes meanwhile
    for (auto at = fs::recursive_directory_iterator(folder, gone); at != fs::end(at); at.increment(gone)) {
        if (at->is_regular_file(gone)) names.push_back(at->path().lexically_relative(folder).string());
    }
    std::ranges::sort(names);
    return names;
}

std::vector<std::map<std::string, std::string>> read_csv(const fs::path& file) {
    std::istringstream in(contents(file));
    const auto split = [](const std::string& line) {
        std::vector<std::string> cells(1);
        bool quoted = false;  // a doubled quote closes and opens again, so its one quote is lost, which no test needs
        for (const char c : line) {
            if (c == '"') quoted = !quoted;
            else if (c == ',' && !quoted) cells.emplace_back();
            else cells.back() += c;
        }
        return cells;
    };
    std::string line;
    std::getline(in, line);
    const auto header = split(line);
    std::vector<std::map<std::string, std::string>> rows;
    while (std::getline(in, line)) {
        const auto cells = split(line);
        if (cells.size() != header.size())
            throw std::runtime_error(file.string() + ": a row with another number of cells: " + line);
        auto& row = rows.emplace_back();
        for (std::size_t i = 0; i < header.size(); ++i) row[header[i]] = cells[i];
    }
    return rows;
}

std::string make_claim_file(const std::vector<ClaimText>& claims, const std::string& head) {
    std::string text = "schema = \"lostbits-claims/1\"\n" + head;
    for (const ClaimText& c : claims)
        text += "[[claim]]\nid = \"" + c.id + "\"\nstatement = \"A sentence\"\nsource = \"" + c.source +
                "\"\nverdict = " + c.verdict + "\n" + c.more + "[claim.given]\n" + c.given + "[claim.expect]\n" +
                c.expect;
    return text;
}

void check_refused_claims(const Scratch& folder, const std::vector<RefusedClaim>& rows, const std::string& head,
                          const std::string& options) {
    for (const RefusedClaim& row : rows) {
        const std::string text = make_claim_file({{"c", row.given, row.expect, row.more, row.verdict}}, head);
        const auto r = run("check '" + folder.write("c.toml", text) + "'" + options, folder.path());
        INFO(text << r.out << r.err);
        CHECK(r.code == 2);
        CHECK(has(r.err, "c.toml:"));
        CHECK(has(r.err, row.says));
    }
}

std::string make_axis(const AxisText& axis) {
    return "[[axis]]\nname = \"" + axis.name + "\"\nspacing = \"" + axis.spacing + "\"\nfrom = " + axis.from +
           "\nto = " + axis.to + "\nsteps = " + std::to_string(axis.steps) + "\nset = [" + axis.set + "]\n";
}

std::string make_sweep_file(const std::string& tables) {
    return "schema = \"lostbits-sweep/1\"\ntitle = \"A test\"\nsource = \"-\"\n" + tables;
}

const std::string small_sweep = make_sweep_file("\n[sphere_rays]\nprojection = \"parallel\"\nviews = 4\nrays = 16\n\n" +
                                                make_axis({"distance_radii", "\"distance\"", "2", "1048576", 20}));

const std::string march_sweep =
    make_sweep_file("[march]\nmax_steps = 100\n[sphere_rays]\ndistance = 4\nimpact_to = 0.9\nviews = 1\nrays = 8\n" +
                    make_axis({"hit_eps", "\"march.hit_eps\"", "1e-3", "\"0x1p-26\"", 6}));

const std::string one_claim = make_claim_file(
    {{"mine", "scene = \"mine.toml\"\n" + form_keys("sphere.press"), metric_keys("false_miss_fraction")}});

std::string scene_text(const std::string& primitives, const std::string& head, const std::string& camera) {
    const bool aims = camera.find("look_at") != std::string::npos || camera.find("extent") != std::string::npos;
    return "schema = \"lostbits-scene/1\"\ntitle = \"A test\"\n" + head + "[camera]\n" + camera +
           (aims ? "" : "look_at = [0, 0, 0]\n") + primitives;
}

const std::string good_scene = R"(schema = "lostbits-scene/1"
title = "A test"
source = "-"
note = "-"
inputs = "shared"
size = [24, 16]

[camera]
kind = "orthographic"
eye = [0.1, 0.2, 5]
look_at = [0, 0, 0]
up = [0, 1, 0]
width = 3

[[sphere]]
centre = [0, 0, 0]
radius = 1
)";

std::string spoil_scene(const std::string& what, const std::string& by) { return replace_text(good_scene, what, by); }

std::string replace_text(std::string text, const std::string& what, const std::string& by) {
    const auto at = text.find(what);
    if (at == std::string::npos) throw std::runtime_error("the text does not contain " + what);
    return text.replace(at, what.size(), by);
}

int count_in(const std::string& text, const std::string& part) {
    int n = 0;
    for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
    return n;
}

}  // namespace lostbits::test
