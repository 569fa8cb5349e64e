// Input that commands refuse, with the messages: the rows of refused.txt, run on the files that they name.
#include <map>
#include <set>
#include <sstream>

#include "catch.hpp"
#include "every_float.hpp"
#include "program.hpp"

namespace test_refused {

using namespace lostbits::test;

namespace {

struct Section {
    std::string command;
    std::vector<RefusedArguments> rows;
};

std::vector<Section> sections() {
    std::vector<Section> all;
    std::istringstream lines(contents(LOSTBITS_REFUSED));
    for (std::string line; std::getline(lines, line);) {
        if (line.empty() || line[0] == '#') continue;
        if (line[0] == '$') {
            all.push_back({line.size() > 2 ? line.substr(2) : "", {}});
            continue;
        }
        const auto arrow = line.find("=> ");
        INFO(line);
        REQUIRE(arrow != std::string::npos);
        RefusedArguments row{line.substr(0, arrow), line.substr(arrow + 3)};
        if (row.words.size() > 1 && std::isdigit(row.words[0]) && row.words[1] == ' ') {
            row.code = row.words[0] - '0';
            row.words.erase(0, 2);
        }
        all.back().rows.push_back(row);
    }
    return all;
}

/// The command of a row.
std::string command_of(const Section& section, const RefusedArguments& row) {
    const std::string words = section.command.empty() ? row.words : section.command;
    return words.substr(0, words.find(' '));
}

using Files = std::map<std::string, std::string>;

std::string with_mesh(const std::string& file) { return scene_text("[[mesh]]\nfile = \"" + file + "\"\n"); }

Files scenes() {
    std::string endless = "schema = \"lostbits-scene/1\"\nx";
    for (int i = 0; i < 60000; ++i) endless += ".a";
    return {
        {"mine.toml", good_scene},
        {"other.toml", good_scene},
        {"scene.toml", good_scene},
        {"key.toml", spoil_scene("look_at", "lookat")},
        {"negative.toml", spoil_scene("radius = 1", "radius = -1")},
        {"book.toml", spoil_scene("title = \"", "title = \"" + std::string(400, 'x'))},
        {"deep.toml", endless + " = 1\n"},
        {"hole.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nf 1 2 9\n"},
        {"hole.toml", with_mesh("hole.obj")},
        {"vast.obj", "v -1e300 -1 0\nv 1 -1 0\nv 1 1 0\nf 1 2 3\n"},
        {"vast.toml", with_mesh("vast.obj")},
        {"frac.ply",
         "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement "
         "face 1\nproperty list uchar float vertex_indices\nend_header\n-1 -1 0\n1 -1 0\n1 1 0\n-1 1 0\n3 0 1.5 2\n"},
        {"frac.toml", with_mesh("frac.ply")},
        {"counted.ply", "ply\nformat ascii 1.0\nelement vertex 1.5\n"},
        {"counted.toml", with_mesh("counted.ply")},
        {"deep.gltf", std::string(15000, '[')},
        {"deep.gltf.toml", with_mesh("deep.gltf")},
        {"nul.obj", std::string("v -1 -1 0\nv 1 -1 0\nv 1 1 0\n\0f 1 2 3\n", 36)},
        {"nul.toml", with_mesh("nul.obj")},
        {"goes-on.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\n# in C:\\meshes\\\nf 1 2 3\nf 1 3 2\n"},
        {"goes-on.toml", with_mesh("goes-on.obj")},
        {"cut.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n"},
        {"cut.toml", with_mesh("cut.stl")},
        {"outside.gltf",
         "{\"asset\": {\"version\": \"2.0\"}, \"meshes\": [{\"primitives\": [{\"attributes\": {\"POSITION\": 0}}]}], "
         "\"accessors\": [{\"bufferView\": 0, \"componentType\": 5126, \"count\": 3, \"type\": \"VEC3\"}], "
         "\"bufferViews\": [{\"buffer\": 0, \"byteLength\": 36}], \"buffers\": [{\"byteLength\": 36, \"uri\": "
         "\"../a.bin\"}]}"},
        {"outside.toml", with_mesh("outside.gltf")},
        {"thin.toml", scene_text("[[triangle]]\na = [1, 1, 1]\nb = [2, 2, 2]\nc = [3, 3, \"0x1.8000001p1\"]\n")},
        {"boxes.toml",
         spoil_scene("[[sphere]]\ncentre = [0, 0, 0]\nradius = 1\n", "[[box]]\nlo = [0, 0, 0]\nhi = [1, 1, 1]\n")}};
}

Files sweeps() {
    const auto spoil = [](const std::string& what, const std::string& by) {
        return replace_text(small_sweep, what, by);
    };
    const std::string head = "schema = \"lostbits-sweep/1\"\ntitle = \"t\"\nsource = \"-\"\n",
                      noted = head + "note = \"-\"\n", every = every_float_to("0x1.6bp10"),
                      one_case = head +
                                 "[[case]]\nname = \"one\"\nspheres = [{ centre = [0, 0, 5], radius = 2 }]\n"
                                 "rays = [{ origin = [0, 0, 0], direction = [0, 0, 1] }]\n",
                      search = head +
                               "[search]\norigin = [-8, 8]\ndirection = [-1, 1]\ncentre = [-1, 1]\nradius = [0.5, 2]\n"
                               "starts = 2\ngenerations = 8\n";
    return {
        {"s.toml", small_sweep},
        {"set.toml", spoil("distance\"]", "distanse\"]")},
        {"form.toml", spoil("distance_radii", "form")},
        {"f.toml", small_sweep + "\n[[axis]]\nname = \"impact\"\nspacing = \"every_float\"\n"
                                 "from = \"0x1.fffff0p-1\"\nto = \"0x1.fffff8p-1\"\nset = [\"impact_to\"]\n"},
        {"axis.toml",
         noted + "scene = \"near-bening\"\n[[axis]]\nname = \"a\"\nfrom = 1\nto = 2\nset = [\"sphere[0].radius\"]\n"},
        {"edges.toml", noted + "[edge_search]\nscene = \"near-bening\"\n"},
        {"family.toml", head + "[sphere_rays]\n[[axis]]\n"},
        {"cases.toml", one_case},
        {"range.toml", replace_text(one_case, "1] }]", "1], tmin = 5, tmax = 4 }]")},
        {"nan-range.toml", replace_text(one_case, "1] }]", "1], tmin = \"nan\" }]")},
        {"search.toml", search},
        {"bit.toml", search + "metric = \"lost_bit\"\n"},
        {"culprit.toml", search + "metric = \"culprit\"\n"},
        {"every.toml", every},
        {"bare.toml", replace_text(every, "[sphere]", "[sphere_of_nothing]")}};
}

/// A .npy file of rays that form a picture of one row.
std::string rays_in_a_row(int count) {
    std::string head =
        "{'descr': [('ox','<f4'),('oy','<f4'),('oz','<f4'),('dx','<f4'),('dy','<f4'),('dz','<f4')], "
        "'fortran_order': False, 'shape': (1, " +
        std::to_string(count) + "), }";
    head += std::string(180 - head.size(), ' ') + '\n';  // 192 bytes with the ten in front
    std::string bytes = std::string("\x93NUMPY\x01\x00", 8) + static_cast<char>(head.size()) + '\0' + head;
    const float ray[] = {0, 0, -5, 0, 0, 1};
    for (int i = 0; i < count; ++i) bytes.append(reinterpret_cast<const char*>(ray), sizeof ray);
    return bytes;
}

Files rays_and_tables() {
    const std::string bare = "ox,oy,oz,dx,dy,dz", head = bare + ",hit,t\n", good = "0,0,-5,0,0,1,1,4\n",
                      primitive = bare + ",cx,cy,cz,radius\n", ray = "0,0,0,0,0,1,0,0,5,1\n",
                      table = "form,ulp_error\npress,";
    return {{"rays.csv", head + good},
            {"word.csv", head + good + "0,0,-5,0,0,1,1,x\n"},
            {"third.csv",
             "ox,oy,oz,dx,dy,dz,hit,t,object\n0,0,-5,0,0,1,1,4,0\n0,0,-5,0,0,1,0,,-1\n"
             "0,0,-5,0,0,1,1,4,77\n"},
            {"cells.csv", head + good + "0,0,-5,0,0,1\n"},
            {"head.csv", head},
            {"bare.csv", bare + "\n0,0,-5,0,0,1\n"},
            {"empty.csv", ""},
            {"no-rays.csv", primitive},
            {"nan.csv", primitive + ray + "nan,0,0,0,0,1,0,0,5,1\n"},
            {"zero.csv", primitive + "0,0,0,0,0,0,0,0,5,1\n"},
            {"columns.csv", "a,b,c\n1,2,3\n"},
            {"solid.csv", bare + "\n0,0,0,0,0,1\n"},
            {"one.csv", primitive + ray},
            {"a.csv", table + "1\n"},
            {"b.csv", table + "2\n"},
            {"ragged.csv", table + "1\n\nx,2\n"},
            {"wide.npy", rays_in_a_row(65537)},
            {"bad.exr", "no picture"},
            {"other.exr", "nor this"},
            {"c.txt", "text"}};
}

Files claims() {
    const std::string inside = "scene = \"camera-inside\"\n" + form_keys("sphere.unit_half_b"),
                      missed = metric_keys("false_miss_fraction", "[1, 1]"),
                      times = "timing = \"one_ray_many_boxes\"\nkernel = \"scalar\"\ndata = \"l1\"\n" +
                              form_keys("box.signs") + "over = { kernel = \"128\" }\n";
    return {{"wide.toml", make_claim_file({{"a", inside, missed}})},
            {"twice.toml", make_claim_file({{"a", inside, missed}, {"a", inside, missed}})},
            {"t.toml",
             make_claim_file({{"t", times, metric_keys("speed_ratio", "[1e-3, 1e3]")}}, "profile = \"timing\"\n")}};
}

/// The rows of these commands, or of all others.
void hold(const std::set<std::string>& commands_of_rows, bool these) {
    draw_pictures();
    const Scratch scratch;
    for (const Files& files : {scenes(), sweeps(), rays_and_tables(), claims()})
        for (const auto& [name, text] : files) scratch.write(name, text);
    fs::create_directory(scratch / "folder");
    for (const Section& section : sections()) {
        std::vector<RefusedArguments> rows;
        for (const RefusedArguments& row : section.rows)
            if (commands_of_rows.contains(command_of(section, row)) == these) rows.push_back(row);
        check_refused(scratch, section.command, rows);
    }
}

}  // namespace

TEST_CASE("map refuses wrong input with the expected messages") { hold({"map"}, true); }
TEST_CASE("explain and sweep refuse wrong input with the expected messages") { hold({"explain", "sweep"}, true); }
TEST_CASE("every other command refuses wrong input with the expected messages") {
    hold({"map", "explain", "sweep"}, false);
}

TEST_CASE("every command has a refused input in the tests or a reason why not") {
    std::set<std::string> known{"manual"}, refusing;  // takes no words
    std::size_t rows = 0;
    for (const Section& section : sections())
        for (const RefusedArguments& row : section.rows) {
            const std::string typed = section.command + " " + row.words;
            INFO(typed << "=> " << row.says);
            CHECK_FALSE(has(typed, row.says));  // the arguments may be repeated in the message, whatever is wrong
            refusing.insert(command_of(section, row));
            ++rows;
        }
    CHECK(rows > 330);
    for (const std::string& command : commands()) {
        INFO(command);
        CHECK((refusing.contains(command) || known.contains(command)));
    }
}

}  // namespace test_refused
