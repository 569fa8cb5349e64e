// Runs that share a folder, and runs that are ended from outside. The results in the folder are complete and from one
// run, or are marked as unfinished.
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "catch.hpp"
#include "counts.hpp"
#include "program.hpp"
#include "started_program.hpp"

namespace test_faults {

using namespace lostbits::test;
using Json = nlohmann::json;

namespace {

/// Command that runs something as process 1 of its own container; empty if this machine forbids it.
std::string in_container() {
    for (const char* words : {"unshare -p -f --mount-proc", "unshare -U -r -p -f --mount-proc"}) {
        if (std::system((std::string(words) + " true 2>/dev/null").c_str()) == 0) return words;
    }
    return "";
}

/// A file that a living run holds, as another container would: under a lock.
class LockedFile {
public:
    explicit LockedFile(const fs::path& path) : fd_(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {
        REQUIRE(fd_ >= 0);
        REQUIRE(::flock(fd_, LOCK_EX) == 0);
    }
    ~LockedFile() { ::close(fd_); }
    LockedFile(const LockedFile&) = delete;
    LockedFile& operator=(const LockedFile&) = delete;

private:
    int fd_;
};

const std::vector<std::string> slow{"map",    "mine.toml", "-i",       "sphere.*", "-f", "f32,f64",
                                    "--size", "80x80",     "--pixels", "csv",      "-o", "out"};

}  // namespace

TEST_CASE("two containers with equal process ids keep their half-written files, and both runs finish") {
    const Scratch scratch;
    scratch.write("mine.toml", good_scene);
    const std::string claims = scratch.write("claims.toml", one_claim);
    const std::string container = in_container();
    if (container.empty()) WARN("no containers here: tried without one");
    const fs::path other = scratch / ".claims.csv.partial-1";
    const LockedFile held(other);
    // The word `exec` that follows is for the outer shell; the program becomes process 1 of the container.
    const std::string before = container.empty() ? "" : "exec " + container + " sh -c 'shift; exec \"$@\"' sh";
    must("check " + claims + " --export-csv claims.csv", scratch.path(), before);
    CHECK(fs::exists(other));
    CHECK(read_csv(scratch / "claims.csv").size() == 1);
}

TEST_CASE("two containers that write one folder at a time do not mix their results") {
    const Scratch scratch;
    scratch.write("mine.toml", good_scene);
    const std::string container = in_container();
    const auto both = [&](const std::string& words) {
        return "map mine.toml -i 'sphere.*' -f f32 --size 60x60 -o out & first=$!; " + container +
               " \"" LOSTBITS_PROGRAM "\" " + words + "; second=$?; wait $first; echo $? $second";
    };
    for (int k = 0; k < 3; ++k) {
        const auto r = run(both("map mine.toml -i sphere.press -f f64 --size 60x60 -o out"), scratch.path());
        const bool first = has(r.out, "0 2"), second = has(r.out, "2 0");
        CHECK((first || second || has(r.out, "0 0")));
        CHECK((has(r.out, "0 0") || has(r.err, "another run is writing to this folder")));
        const auto folder = scratch / "out/mine";
        std::vector<std::string> listed = Json::parse(contents(folder / "manifest.json")).at("files");
        listed.emplace_back("manifest.json");
        std::ranges::sort(listed);
        CHECK(files_below(folder) == listed);
        for (const std::string& name : listed) CHECK(fs::file_size(folder / name) > 0);
    }
}

TEST_CASE("the remains of a dead run's file are removed when the file is written again") {
    const Scratch scratch;
    scratch.write("mine.toml", good_scene);
    const std::string claims = scratch.write("claims.toml", one_claim);
    for (const char* left : {".claims.csv.partial-4711", ".claims.csv.partial-abcdefghijkl", ".other.csv.partial-1"})
        scratch.write(left, "half a line");
    must("check " + claims + " --export-csv claims.csv", scratch.path());
    CHECK(scratch.files() ==
          std::vector<std::string>{".other.csv.partial-1", "claims.csv", "claims.toml", "mine.toml"});
}

TEST_CASE("signals ignored at the start stay ignored") {
    const Scratch scratch;
    scratch.write("mine.toml", good_scene);
    for (const int signal : {SIGHUP, SIGINT, SIGTERM, SIGUSR1, SIGQUIT}) {
        INFO("signal " << signal);
        StartedProgram started(slow, scratch.path(), {signal});
        REQUIRE(started.wait_until([&] { return has_partial_files(scratch / "out"); }));
        for (int k = 0; k < 2; ++k) started.send(signal);
        CHECK(started.wait() == 0);
    }
}

TEST_CASE("a run ended by any signal leaves no half-written file") {
    const Scratch scratch;
    scratch.write("mine.toml", good_scene);
    for (const int signal : {SIGQUIT, SIGUSR1, SIGUSR2, SIGALRM, SIGVTALRM, SIGPROF, SIGPIPE, SIGABRT, SIGSEGV, SIGTERM,
                             SIGINT, SIGHUP, SIGXCPU}) {
        INFO("signal " << signal);
        StartedProgram started(slow, scratch.path());
        REQUIRE(started.wait_until([&] { return has_partial_files(scratch / "out"); }));
        started.send(signal);
        const bool asks = signal == SIGTERM || signal == SIGINT || signal == SIGHUP || signal == SIGXCPU;
        CHECK(started.wait() == (asks ? 130 : 128 + signal));
        CHECK_FALSE(has_partial_files(scratch.path()));
        if (asks) CHECK(has(contents(scratch / "err.txt"), "lostbits: interrupted\n"));  // nothing is finished
    }
}

TEST_CASE("a run over scenes that is interrupted reports how many are finished") {
    const Scratch scratch;
    for (const char* name : {"mine.toml", "other.toml"}) scratch.write(name, good_scene);
    auto words = slow;
    words.insert(words.begin() + 2, "other.toml");
    StartedProgram started(words, scratch.path());
    REQUIRE(started.wait_until([&] {
        return fs::exists(scratch / "out/mine/contact.png") && !fs::exists(scratch / "out/mine/UNFINISHED.txt") &&
               has_partial_files(scratch / "out/other");
    }));
    started.send(SIGTERM);
    CHECK(started.wait() == 130);
    CHECK(has(contents(scratch / "err.txt"), "lostbits: interrupted: the files of 1 finished scene are kept\n"));
    CHECK(fs::exists(scratch / "out/mine/summary.csv"));
}

TEST_CASE("closed standard streams do not end up in a file") {
    const Scratch scratch;
    scratch.write("mine.toml", good_scene);
    const std::string words = "map mine.toml -i sphere.press -f f32 --pixels csv --progress bar -v -o ";
    must(words + "right", scratch.path());
    for (const char* closed : {"2>&-", "<&- 2>&-", "<&- >&- 2>&-", ">&- 2>&-", "<&-"}) {
        INFO(closed);
        const auto r = run(words + "out " + closed, scratch.path());
        // An error that cannot be printed is reported by the exit status alone.
        CHECK(r.code == (has(closed, ">&- ") ? 3 : 0));
        for (const std::string& name : files_below(scratch / "right/mine")) {
            if (name != "manifest.json")
                CHECK(contents(scratch / "out/mine" / name) == contents(scratch / "right/mine" / name));
        }
        fs::remove_all(scratch / "out");
    }
}

TEST_CASE("a run killed while it replaces results leaves a note that they are not finished") {
    const Scratch scratch;
    scratch.write("mine.toml", good_scene);
    const fs::path folder = scratch / "out/mine";
    std::vector<std::string> other = slow;
    other[5] = "f64,f32";
    int caught = 0;
    for (int k = 0; k < 20 && caught < (is_long() ? 3 : 1); ++k) {
        REQUIRE(StartedProgram(slow, scratch.path()).wait() == 0);
        CHECK_FALSE(fs::exists(folder / "UNFINISHED.txt"));
        StartedProgram started(other, scratch.path());
        // The first of the new results replaces the old ones.
        if (!started.wait_until([&] { return !fs::exists(folder / "summary.csv"); })) continue;
        started.send(SIGKILL);
        if (started.wait() != 128 + SIGKILL || fs::exists(folder / "summary.csv")) continue;
        ++caught;
        CHECK(has(contents(folder / "UNFINISHED.txt"), "lostbits map mine.toml"));
        const auto r = run("diff out out", scratch.path());
        CHECK(has(r.err,
                  "out/mine: is not finished: the run that wrote it was stopped; run the command in its UNFINISHED.txt "
                  "again"));
    }
    CHECK(caught > 0);
    REQUIRE(StartedProgram(slow, scratch.path()).wait() == 0);
    CHECK_FALSE(fs::exists(folder / "UNFINISHED.txt"));
    CHECK_FALSE(has_partial_files(scratch.path()));
    CHECK_FALSE(has(run("diff out out", scratch.path()).err, "not finished"));
}

namespace {

/// A shell that mounts something privately and then becomes the program; empty if this machine forbids it. `mount` is
/// its first command.
std::string with_mount(const std::string& mount, const Scratch& scratch) {
    for (const char* words : {"unshare -m", "unshare -U -r -m"}) {
        const std::string shell = std::string(words) + " sh -c '" + mount + " && shift && exec \"$@\"' sh ";
        if (std::system(("cd '" + scratch.path().string() + "' && " + shell + " x true 2>/dev/null").c_str()) == 0)
            return "exec " + shell;
    }
    WARN("nothing can be mounted here");
    return "";
}

}  // namespace

TEST_CASE("results are complete and marked so, even if nobody reads standard output") {
    const Scratch scratch;
    scratch.write("mine.toml", good_scene);
    scratch.write("rays.csv", "ox,oy,oz,dx,dy,dz,hit,t\n0,0,-5,0,0,1,1,4\n");
    scratch.write("tilt.toml", small_sweep);
    for (const char* words :
         {"map mine.toml -v -i 'sphere.p*' -f f32,f64", "render mine.toml -v", "offsets mine.toml -i sphere.half_b",
          "consistency mine.toml -i sphere.half_b", "sweep tilt.toml -v -i sphere.press -f f32",
          "judge rays.csv --sphere 0,0,0,1 -i sphere.press -f f32", "map mine.toml -i sphere.press -f f32 --shard 1/1",
          "mend mine.toml --size 8x8 -i sphere.half_b --bits 5", "diff before after --draw"}) {
        INFO(words);
        const bool compares = std::string(words).starts_with("diff");
        if (compares) {
            must("map mine.toml -i sphere.press -f f32 --pixels csv -o before", scratch.path());
            must("map mine.toml -i sphere.press -f f32 --pixels csv --set 'sphere[0].radius=0.9' -o after",
                 scratch.path());
        }
        // Descriptors whose other end was closed before the program begins.
        run(std::string(words) + (compares ? " out" : " -o out") + " | true", scratch.path(), "sleep 0.2;");
        int lists = 0;
        for (const std::string& file : files_below(scratch / "out")) {
            CHECK_FALSE(has(file, "UNFINISHED"));
            CHECK_FALSE(has(file, ".partial-"));
            lists += fs::path(file).filename() == "manifest.json";
        }
        CHECK(lists == 1);
        fs::remove_all(scratch / "out");
    }
}

TEST_CASE("an earlier result that cannot be removed is an error") {
    const Scratch scratch;
    scratch.write("mine.toml", good_scene);
    const std::string words = "map mine.toml -i sphere.press -f f32 -o out", old = "out/mine/sphere.press.f32.csv";
    must(words + " --pixels csv", scratch.path());
    REQUIRE(fs::exists(scratch / old));
    // A mounted file cannot be removed, not even by root.
    if (const std::string mount = with_mount("mount --bind " + old + " " + old, scratch); !mount.empty()) {
        const auto r = run(words, scratch.path(), mount);
        INFO(r.err);
        CHECK(r.code == 3);
        CHECK(has(r.err, old + ": is a result of an earlier run and cannot be removed: "));
        CHECK(fs::exists(scratch / "out/mine/UNFINISHED.txt"));
    }
    if (geteuid() == 0) return;  // permissions are for others
    fs::create_directories(scratch / "out/mine/pictures");
    fs::permissions((scratch / old).parent_path(), fs::perms::owner_read | fs::perms::owner_exec);
    const auto r = run(words, scratch.path());
    fs::permissions((scratch / old).parent_path(), fs::perms::owner_all);
    CHECK(r.code == 3);
}

TEST_CASE("choose answers without times where the temporary folder forbids running programs") {
    const Scratch scratch;
    scratch.write("mine.toml", good_scene);
    fs::create_directories(scratch / "noexec");
    const std::string mount = with_mount("mount -t tmpfs -o noexec tmpfs noexec && export TMPDIR=$PWD/noexec", scratch);
    if (mount.empty()) return;
    // Stands for a compiler: it writes some library.
    const std::string compiler = scratch.write(
        "compiler", "#!/bin/sh\nwhile [ \"$1\" != -o ]; do shift; done\ncp '" LOSTBITS_PLAIN_IMAGES "' \"$2\"\n");
    fs::permissions(compiler, fs::perms::owner_all);
    const auto r = run("mend mine.toml --size 8x8 -i sphere.half_b --bits 20 --price --emit e.hpp -o out --compiler '" +
                           compiler + "'",
                       scratch.path(), mount);
    INFO(r.err << r.out);
    CHECK(r.code == 0);
    CHECK(has(r.out, "mended.so: cannot be loaded: "));
    CHECK(has(r.out, "set TMPDIR to another one"));
    CHECK(fs::exists(scratch / "e.hpp"));
    CHECK(fs::exists(scratch / "out/mine/mend.csv"));
}

TEST_CASE("a path with a symbolic-link loop is bad input for every option") {
    const Scratch scratch;
    scratch.write("mine.toml", good_scene);
    scratch.write("mesh.toml", replace_text(good_scene, "[[sphere]]", "[[mesh]]\nfile = \"loop/a.gltf\"\n[[sphere]]"));
    fs::create_symlink("loop", scratch / "pool");
    fs::create_symlink("pool", scratch / "loop");
    for (const char* words :
         {"map loop/x.toml -i sphere.press -o out", "map loop.toml -i sphere.press -o out", "map mesh.toml -o out",
          "map mine.toml -i sphere.press --plugin ./loop -o out", "map mine.toml --shader loop -o out",
          "judge loop/x.csv --sphere 0,0,0,1 -o out", "sweep loop -o out", "sweep loop/x.toml -o out", "check loop",
          "check loop/x.toml", "diff loop loop", "diff mine.toml loop", "diff loop/a.csv mine.toml",
          "merge loop -o out", "report loop -o out", "choose loop --bits 3 -o out",
          "mend loop --bits 3 -i sphere.press", "list scenes --data loop"}) {
        const auto r = run(words, scratch.path());
        INFO(words << "\n" << r.err);
        CHECK(r.code == 2);
        CHECK(r.err.starts_with("lostbits: "));
        CHECK_FALSE(has(r.err, "filesystem error"));
    }
}

TEST_CASE("a mesh whose buffer is a folder is refused as bad input") {
    const Scratch scratch;
    fs::create_directories(scratch / "folder");
    scratch.write("a.gltf",
                  R"({"asset": {"version": "2.0"}, "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
                      "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
                      "bufferViews": [{"buffer": 0, "byteLength": 36}],
                      "buffers": [{"byteLength": 36, "uri": "folder"}]})");
    scratch.write("mesh.toml", scene_text("[[mesh]]\nfile = \"a.gltf\"\n"));
    const auto r = run("map mesh.toml -o out", scratch.path());
    INFO(r.err);
    CHECK(r.code == 2);
    CHECK(has(r.err, "is a folder"));
}

TEST_CASE("a mesh too large for memory is refused with its line, and fewer triangles are advised") {
    if (under_sanitizer) return;
    const Scratch scratch;
    scratch.write("mesh.toml", scene_text("[[mesh]]\nmake = \"grid\"\nparts = [4096, 4096]\n"));
    const auto r = run("map mesh.toml -i triangle.woop -f f32 -o out", scratch.path(), "ulimit -v 300000;");
    INFO(r.err);
    CHECK(r.code == 3);
    CHECK(has(r.err, "fewer triangles"));
}

TEST_CASE("shards in a path with a line break are merged") {
    const Scratch scratch;
    scratch.write("a\nb\\c/mine.toml", good_scene);
    for (const char* k : {"1/2", "2/2"})
        must("-q map 'a\nb\\c/mine.toml' -i sphere.press -f f32 -o parts --shard " + std::string(k), scratch.path());
    must("-q merge parts -o joined", scratch.path());
    must("-q map 'a\nb\\c/mine.toml' -i sphere.press -f f32 -o whole", scratch.path());
    must("-q diff --strict joined whole", scratch.path());
}

}  // namespace test_faults
