#include "program.hpp"

#include <sys/wait.h>

#include <cstdlib>
#include <sstream>
#include <stdexcept>

namespace lostbits::test {

Outcome run(const std::string& arguments, const fs::path& folder, const std::string& before) {
    const Scratch streams;
    const std::string out = (streams.path() / "out").string(), err = (streams.path() / "err").string();
    // CI changes where libraries run: what a test expects of it, it says.
    // Pictures are not looked at unless a test says so.
    const std::string pictures =
        std::getenv("LOSTBITS_IMAGE_MODULE") ? "" : "export LOSTBITS_IMAGE_MODULE='" LOSTBITS_PLAIN_IMAGES "' && ";
    const std::string command =
        "cd '" + folder.string() + "' && unset CI && export LOSTBITS_DATA='" LOSTBITS_DATA_DIR "' && " + pictures +
        "(" + before + " exec '" LOSTBITS_PROGRAM "' " + arguments + ") >'" + out + "' 2>'" + err + "' </dev/null";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), contents(out), contents(err)};
}

void draw_pictures() { setenv("LOSTBITS_IMAGE_MODULE", LOSTBITS_SHIPPED_IMAGES, 1); }

std::vector<std::map<std::string, std::string>> read_csv(const fs::path& file) {
    std::istringstream in(contents(file));
    const auto split = [](const std::string& line) {
        std::vector<std::string> cells(1);
        bool quoted = false;  // a doubled quote leaves and enters: its one quote is lost, which no test asks for
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

const std::string small_sweep = R"(schema = "lostbits-sweep/1"
title = "A test"
source = "-"

[family]
projection = "parallel"
views = 4
rays = 16

[[axis]]
name = "distance_radii"
spacing = "log2"
from = 2
to = 1048576
steps = 20
set = ["distance"]
)";

const std::string march_sweep = R"(schema = "lostbits-sweep/1"
title = "A test"
source = "-"
[march]
max_steps = 100
[family]
distance = 4
impact_to = 0.9
views = 1
rays = 8
[[axis]]
name = "hit_eps"
spacing = "log2"
from = 1e-3
to = "0x1p-26"
steps = 6
set = ["march.hit_eps"]
)";

const std::string one_claim = R"(schema = "lostbits-claims/1"
[[claim]]
id = "mine"
statement = "It is so"
source = "-"
verdict = "holds"
[claim.given]
scene = "mine.toml"
form = "sphere.press"
format = "f32"
[claim.expect]
metric = "false_miss_fraction"
in = [0, 1]
)";

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

std::string spoilt(const std::string& what, const std::string& by) {
    std::string text = good_scene;
    const auto at = text.find(what);
    if (at == std::string::npos) throw std::runtime_error("the scene does not contain " + what);
    return text.replace(at, what.size(), by);
}

}  // namespace lostbits::test
