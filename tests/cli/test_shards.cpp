// `--shard` and `lostbits merge`, from the outside: shards in any order give the bytes of the whole run.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "catch.hpp"
#include "counts.hpp"
#include "every_float.hpp"
#include "program.hpp"

namespace test_shards {

using namespace lostbits::test;

namespace {

const std::string every_float = every_float_to("0x1.6bp11");

struct Row {
    std::string words;         ///< up to the folder of the results
    std::vector<int> numbers;  ///< how many shards, one after the other; in the short tests the last
    std::string out = "-o";
};

const Row rows[] = {
    // Bands of 512 lines: four of them, the last one short.
    {"map near-benign -i sphere.schoolbook -i sphere.unified -f f32 -f f64 --size 16x1800 --pictures all",
     {1, 2, 3, 7}},
    {"map near-benign -i sphere.schoolbook -f f32 --pixels csv --exr --envelope --metric lost_bits,culprit "
     "--bits 8 --size 8x1800 --pictures all",
     {3}},
    {"map near-benign two.toml -i sphere.press -f f32 --against sphere.unified --size 16x1800", {3}},
    {"sweep every.toml -i sphere.press -i sphere.schoolbook -i sphere.unified", {1, 2, 3, 7}},
    // Two binades, three blocks: some shards have nothing to do.
    {"sweep short.toml -i sphere.press", {11}},
    {"sweep small.toml -i sphere.schoolbook -i sphere.unified -i sphere.press", {2, 7}},
    {"sweep box-nearly-parallel extremes/scale -f f32", {3}},
    {"sweep worst/near --worst -i sphere.schoolbook -i sphere.press -f f32 --set starts=2", {2, 5}},
    {"sweep worst/mesh-edges --worst -i triangle.undivided -i triangle.plucker -f f32 --set rays=2048", {2, 3}},
    {"judge rays.csv --sphere 0,0,0,1 --answer-format f32 -i sphere.schoolbook -f f64 --rows --worst-rays 5",
     {1, 9, 3}},
    {"judge rays.csv --sphere 0,0,0,1 --answer-format f32 -i sphere.schoolbook -f f64 --size 200x330 --metric "
     "lost_bits,ulp_error",
     {2}},
    {"judge rays.csv --sphere 0,0,0,1 --answer-format f32 -i sphere.schoolbook --rows --by mine --tolerance 0.5 --bits "
     "20",
     {4}},
    // Bands of 16 lines: five of them, the last one short.
    {"consistency offset-touching --size 12x70 -i sphere.half_b,sphere.press -f f32,bf16 --pixels csv --pictures all",
     {1, 2, 7, 3}},
    {"offsets offset-touching --size 8x40 -f f32 --strategy 'offset.[ib]*' --pixels csv --pictures all", {1, 2, 4, 3}},
    {"offsets near-benign --size 10x20 -f f32 --strategy offset.integer --points computed --along radius", {2}},
    {"render raycast-acne --size 16x4200 -i sphere.half_b -f f32,f64 --stage visible,shadows --pictures all",
     {1, 2, 4, 3}},
    {"check --filter 'float.*'", {1, 2, 5}, "--report"},
};

/// 200 x 330 rays, two pieces of a file and a bit, from 4096 away at a sphere, with the answers of a float.
std::string rays_csv() {
    std::string rays = "ox,oy,oz,dx,dy,dz,t,mine\n";
    for (int i = 0; i < 200 * 330; ++i) {
        const double x = (i % 200 - 100) / 128.0, y = (i / 200 - 165) / 128.0;
        const double below = 1 - x * x - y * y;
        rays += std::to_string(x) + "," + std::to_string(y) + ",4096,0,0,-1,";
        rays += (below > 0 ? std::to_string(4096 - std::sqrt(below) + (i % 1000 == 7 ? 1 : 0)) : "") + "," +
                std::to_string(i / 33000) + "\n";
    }
    return rays;
}

std::string shell_word(const fs::path& path) { return "'" + path.string() + "'"; }

std::string shard_of(int k, int n) { return " --shard " + std::to_string(k) + "/" + std::to_string(n); }

/// Paths of the shards of a run, by number.
fs::path shard_folder(const fs::path& parts, int k, int n) {
    return parts / ("shard-" + std::to_string(k) + "-of-" + std::to_string(n));
}

void check_same(const fs::path& whole, const fs::path& joined) {
    const auto files = files_below(whole);
    REQUIRE(!files.empty());
    CHECK(files == files_below(joined));
    for (const std::string& name : files) {
        INFO(name);
        const bool same = contents(whole / name) == contents(joined / name);
        CHECK(same);
    }
    must("-q diff --strict " + shell_word(whole) + " " + shell_word(joined));
}

/// The run of each row of a command, and each number of shards of it, run in a shuffled order and joined in another.
void check_rows(const std::string& command) {
    const Scratch scratch;
    const std::pair<const char*, std::string> files[] = {{"every.toml", every_float},
                                                         {"short.toml", every_float_to("0x1.6bp10")},
                                                         {"small.toml", small_sweep},
                                                         {"two.toml", good_scene},
                                                         {"rays.csv", command == "judge" ? rays_csv() : ""}};
    for (const auto& [name, text] : files) scratch.write(name, text);
    const auto must = [&](const std::string& words, int code) {
        const auto r = run("-q " + words, scratch.path());
        INFO(words << ": " << r.err);
        REQUIRE(r.code == code);
    };
    std::mt19937 random(7);
    for (const Row& row : rows) {
        if (!row.words.starts_with(command + " ")) continue;
        for (const char* folder : {"whole", "parts", "joined"}) fs::remove_all(scratch / folder);
        INFO(row.words);
        const auto whole = run("-q " + row.words + " " + row.out + " whole", scratch.path());
        REQUIRE(whole.code <= 1);
        for (const int n : row.numbers) {
            if (!is_long() && n != row.numbers.back()) continue;
            INFO(n << " shards");
            fs::remove_all(scratch / "parts");
            std::vector<int> order(static_cast<std::size_t>(n));
            std::iota(order.begin(), order.end(), 1);
            std::ranges::shuffle(order, random);
            for (const int k : order) {
                must(row.words + shard_of(k, n) + " " + row.out + " parts", 0);
                CHECK(fs::exists(shard_folder(scratch / "parts", k, n) / "shard.state"));
            }
            std::ranges::shuffle(order, random);
            std::string folders;
            for (const int k : order) folders += " " + shard_folder("parts", k, n).string();
            // The folder that holds all shards gives the same result.
            for (const std::string& parts : {folders, std::string(" parts")}) {
                fs::remove_all(scratch / "joined");
                must("merge" + parts + " -o joined", whole.code);
                check_same(scratch / "whole", scratch / "joined");
            }
        }
    }
}

}  // namespace

TEST_CASE("shards of a map give the pictures, pixel tables, EXR and bits needed of the whole map") {
    check_rows("map");
}

TEST_CASE("shards of every kind of sweep give the files of the whole") { check_rows("sweep"); }

TEST_CASE("shards of a file of rays give the files of the whole, as a list and as a picture") { check_rows("judge"); }

TEST_CASE("shards of a study give its pictures, tables and EXR") {
    for (const char* const study : {"consistency", "offsets", "render"}) check_rows(study);
}

TEST_CASE("shards of claims give the report of the whole") { check_rows("check"); }

TEST_CASE("every command that can be split into shards is tested so") {
    for (const std::string& command : commands()) {
        INFO(command);
        const bool has_row =
            std::ranges::any_of(rows, [&](const Row& row) { return row.words.starts_with(command + " "); });
        CHECK(has(run(command + " --help").out, "--shard") == has_row);
    }
}

TEST_CASE("a file of rays that does not fill its picture is refused when its shards are merged") {
    const Scratch scratch;
    scratch.write("rays.csv", rays_csv());
    must("judge rays.csv --sphere 0,0,0,1 --answer-format f32 --size 200x331 --shard 1/1 -o p", scratch.path());
    const auto merged = run("merge p -o j", scratch.path());
    CHECK(merged.code == 2);
    CHECK(has(merged.err, "give --size as columns x rows"));
    CHECK_FALSE(fs::exists(scratch / "j/rays/summary.csv"));
}

TEST_CASE("shards of claims give no verdicts themselves") {
    const Scratch scratch;
    const auto says = [&](const std::string& options, const std::string& what) {
        const auto r = run("check --filter 'float.*' " + options);
        CHECK(r.code == 2);
        CHECK(has(r.err, what));
    };
    says("--shard 1/2", "needs a folder for the shards; add --report FOLDER");
    says("--shard 1/2 --report '" + (scratch / "r").string() + "' --junit x.xml", "a shard does not judge claims");
    CHECK(scratch.files().empty());
    const fs::path parts = scratch / "parts", junit = scratch / "junit.xml";
    for (const int k : {1, 2}) must("-q check --filter 'float.*'" + shard_of(k, 2) + " --report " + shell_word(parts));
    must("-q merge " + shell_word(parts) + " -o " + shell_word(scratch / "out") + " --junit " + shell_word(junit));
    CHECK(has(contents(junit), "<testsuite name=\"lostbits claims\""));
}

TEST_CASE("a file that is not a shard of the run is refused, and nothing is written") {
    const Scratch scratch;
    const std::string file = scratch.write("s.toml", every_float);
    const std::string command = "sweep " + shell_word(file) + " -i sphere.press";
    const fs::path parts = scratch / "parts", out = scratch / "out";
    const auto refused = [&](const std::string& arguments, const std::string& says) {
        const auto r = run(arguments + " -o " + shell_word(out));
        CHECK(r.code == 2);
        CHECK(has(r.err, says));
        CHECK_FALSE(fs::exists(out));
    };
    for (const char* word : {"a/b", "3", "/", "3/", "/3", "-1/3", "1/3x", "1.5/3", "1//3", ""})
        refused(command + " --shard '" + word + "'", *word == 0 ? "--shard" : "is not a shard; write K/N");
    refused(command + " --shard 0/3", "--shard 0/3: the shards of 3 are numbered from 1 to 3");
    refused(command + " --shard 4/3", "--shard 4/3: the shards of 3 are numbered from 1 to 3");
    refused(command + " --shard 1/0", "a run is divided into 1 to 1000000 shards");
    refused(command + " --shard 1/99999999999999999999", "is not a shard");

    CHECK(has(run(command + " --shard 1/2 -o -").err, "-o -: a shard has no table"));

    for (const int k : {1, 2, 3, 4}) must("-q " + command + shard_of(k, 4) + " -o " + shell_word(parts));
    const auto folder = [&](int k) { return " " + shell_word(shard_folder(parts, k, 4)); };
    refused("merge" + folder(1) + folder(3), "2 of 4 shards are missing: 2 and 4; nothing was joined");
    refused("merge" + folder(1) + folder(2) + folder(3), "1 of 4 shards is missing: 4; nothing was joined");
    refused("merge" + folder(1) + folder(2) + folder(3), " --shard 4/4` for it, with the -o of the others");
    refused("merge " + shell_word(scratch / "nowhere"), "does not exist");
    fs::create_directories(scratch / "empty");
    refused("merge " + shell_word(scratch / "empty"), "has no shard");
    fs::create_directories(scratch / "copy");
    fs::copy(shard_folder(parts, 2, 4), scratch / "copy/again");
    refused("merge " + shell_word(parts) + " " + shell_word(scratch / "copy"), "is shard 2/4, and so is");
    // A shard that is named twice is the same file.
    must("-q merge " + shell_word(parts) + folder(2) + " -o " + shell_word(scratch / "twice"));

    const fs::path other = scratch / "other";
    must("-q sweep " + shell_word(file) + " -i sphere.unified --shard 2/4 -o " + shell_word(other));
    refused("merge" + folder(1) + folder(3) + folder(4) + " " + shell_word(other), "is a shard of another run");
    const fs::path thirds = scratch / "thirds";
    must("-q " + command + " --shard 2/3 -o " + shell_word(thirds));
    refused("merge" + folder(1) + folder(3) + folder(4) + " " + shell_word(thirds), "the run was divided in two ways");

    // One byte of a shard is changed.
    const fs::path state = shard_folder(parts, 3, 4) / "shard.state";
    const std::string good = contents(state);
    std::string bad = good;
    bad[bad.size() / 2] = static_cast<char>(bad[bad.size() / 2] ^ 1);
    scratch.write("parts/shard-3-of-4/shard.state", bad);
    refused("merge " + shell_word(parts), "is damaged");
    scratch.write("parts/shard-3-of-4/shard.state", good.substr(0, good.size() - 9));
    refused("merge " + shell_word(parts), "is damaged");
    scratch.write("parts/shard-3-of-4/shard.state", good);

    // The sweep has changed since.
    scratch.write("s.toml", every_float + "# changed\n");
    refused("merge " + shell_word(parts), "have changed: a scene");
    must("-q " + command + " --shard 2/4 -o " + shell_word(scratch / "newer"));
    refused("merge" + folder(1) + folder(3) + folder(4) + " " + shell_word(scratch / "newer"),
            "was measured with other files");
}

TEST_CASE("a forged shard is refused before any result is written") {
    const Scratch scratch;
    scratch.write("mine.toml", good_scene);
    must("-q map mine.toml -i sphere.press -f f32 --shard 1/1 -o parts", scratch.path());
    const std::string good = contents(scratch / "parts/shard-1-of-1/shard.state");
    const auto bytes_of = [](std::uint64_t n) { return std::string(reinterpret_cast<const char*>(&n), sizeof n); };
    const auto refused = [&](const std::string& more) {
        std::string forged = good.substr(0, good.size() - 8) + more;
        std::uint64_t hash = 14695981039346656037U;  // the file's own, so it alone does not show the error
        for (const char c : forged) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211U;
        scratch.write("parts/shard-1-of-1/shard.state", forged + bytes_of(hash));
        const auto r = run("merge parts -o out", scratch.path());
        CHECK(r.code == 2);
        CHECK(has(r.err, "is damaged, or not the file of a shard"));
        CHECK_FALSE(fs::exists(scratch / "out"));
    };
    refused("trailing");
    refused(bytes_of(3) + "map" + bytes_of(1U << 20U) + "x");
    refused(bytes_of(5) + "map x" + bytes_of(1) + "x");  // a job that does not exist
    scratch.write("parts/shard-1-of-1/shard.state", good);
    must("merge parts -o out", scratch.path());
}

TEST_CASE("a killed shard leaves nothing half-written, and resumes with --resume or reruns") {
    const Scratch scratch;
    const std::string text = every_float_to("0x1.6bp18");  // some seconds of work
    const std::string file = scratch.write("s.toml", text);
    const std::string command = "sweep " + shell_word(file) + " -i sphere.schoolbook";
    must("-q " + command + " -o " + shell_word(scratch / "whole"));
    const fs::path parts = scratch / "parts";
    const std::string first = "-q -j 1 " + command + " --shard 1/2 -o " + shell_word(parts);
    const fs::path folder = shard_folder(parts, 1, 2);
    const auto end_by = [&](const std::string& signal) { run(first + end_after(0.4, signal)); };
    end_by("KILL");
    CHECK_FALSE(fs::exists(folder / "shard.state"));
    end_by("TERM");  // SIGINT is ignored by what a shell starts in the background
    CHECK_FALSE(fs::exists(folder / "shard.state"));
    CHECK(fs::exists(folder / "s/unfinished.state"));  // not there: the machine does all of the work in so little time
    const auto refused = run(command + " --shard 1/3 --resume -o " + shell_word(scratch / "thirds"));
    CHECK(refused.code == 2);
    must(first + " --resume");
    CHECK(files_below(folder) == std::vector<std::string>{"manifest.json", "shard.state"});
    must("-q " + command + " --shard 2/2 -o " + shell_word(parts));
    must("-q merge " + shell_word(parts) + " -o " + shell_word(scratch / "joined"));
    check_same(scratch / "whole", scratch / "joined");
}

}  // namespace test_shards
