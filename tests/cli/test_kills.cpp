// Two runs that replace each other in one folder and are killed at random moments: 16 times, 40 times in the long
// tests; LOSTBITS_KILLS=1000 for more.
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <map>
#include <random>
#include <thread>

#include "catch.hpp"
#include "counts.hpp"
#include "program.hpp"
#include "started_program.hpp"

namespace test_kills {

using namespace lostbits::test;

namespace {

using Clock = std::chrono::steady_clock;
using Files = std::map<std::string, std::string>;

Files files_in(const fs::path& folder) {
    Files files;
    for (const std::string& name : files_below(folder)) files[name] = contents(folder / name);
    return files;
}

/// One of two commands that write the same folder, and the files that it leaves there if nothing disturbs it.
struct Command {
    std::vector<std::string> words;
    Files right = {};
    double seconds = 0;

    void try_alone(const Scratch& scratch, const fs::path& folder) {
        const auto start = Clock::now();
        REQUIRE(StartedProgram(words, scratch.path()).wait() == 0);
        seconds = std::chrono::duration<double>(Clock::now() - start).count();
        right = files_in(folder);
    }
};

struct Counts {
    int killed = 0, terminated = 0, unharmed = 0;  ///< SIGKILL, SIGTERM, and done before the signal or in spite of it
    int unfinished = 0, partial = 0;               ///< folders that said so, and ones with half-written files
};

/// True if every file is as one of the two commands writes it. In a folder that is marked as unfinished, a list of
/// names may be shorter, and half-written files may exist.
bool is_sound(const Files& found, const Files& a, const Files& b) {
    if (!found.contains("UNFINISHED.txt")) {
        Files whole = found;
        std::erase_if(whole, [](const auto& file) { return has(file.first, ".partial-"); });
        return whole.empty() || whole == a || whole == b;
    }
    return std::ranges::all_of(found, [&](const auto& file) {
        const auto& [name, bytes] = file;
        if (has(name, ".partial-") || name == "UNFINISHED.txt" || name == "manifest.json") return true;
        return (a.contains(name) && a.at(name) == bytes) || (b.contains(name) && b.at(name) == bytes);
    });
}

/// Kills a run after a time drawn from its whole duration and somewhat more.
void kill_once(const Scratch& scratch, const Command& command, std::mt19937& random, Counts& counts) {
    const bool kills = std::bernoulli_distribution(0.5)(random);
    StartedProgram started(command.words, scratch.path());
    std::this_thread::sleep_for(
        std::chrono::duration<double>(std::uniform_real_distribution<double>(0, 1.1 * command.seconds)(random)));
    started.send(kills ? SIGKILL : SIGTERM);
    const int code = started.wait();
    INFO(contents(scratch / "err.txt"));
    // SIGTERM may come before the program has installed its handler.
    REQUIRE((code == 0 || code == 130 || code == 128 + SIGKILL || code == 128 + SIGTERM));
    ++(code == 0 ? counts.unharmed : kills ? counts.killed : counts.terminated);
}

void kill_often(const Scratch& scratch, const fs::path& folder, Command a, Command b) {
    const char* const wanted = std::getenv("LOSTBITS_KILLS");
    const int kills = wanted != nullptr ? std::atoi(wanted) / 2 : is_long() ? 20 : 8;
    a.try_alone(scratch, folder);
    fs::remove_all(scratch / "out");
    b.try_alone(scratch, folder);
    std::mt19937 random(19);
    Counts counts;
    for (int k = 0; k < kills; ++k) {
        kill_once(scratch, std::bernoulli_distribution(0.5)(random) ? a : b, random, counts);
        const Files found = files_in(folder);
        counts.unfinished += found.contains("UNFINISHED.txt");
        counts.partial += has_partial_files(folder);
        INFO("after " << k + 1 << " kills");
        REQUIRE(is_sound(found, a.right, b.right));
    }
    REQUIRE(StartedProgram(a.words, scratch.path()).wait() == 0);
    CHECK(files_in(folder) == a.right);
    CHECK(files_below(scratch / "out").size() == a.right.size());
    if (wanted != nullptr)
        std::cout << a.words.front() << ": " << counts.killed << " killed, " << counts.terminated << " asked to end, "
                  << counts.unharmed << " done all the same; afterwards " << counts.unfinished
                  << " folders said that they were not finished and " << counts.partial
                  << " held half-written files; none was damaged, and the next run left nothing\n";
}

}  // namespace

TEST_CASE("maps killed while they replace each other damage nothing, and the next run cleans up") {
    const Scratch scratch;
    scratch.write("mine.toml", good_scene);
    kill_often(
        scratch, scratch / "out/mine",
        {{"map", "mine.toml", "-i", "sphere.p*,sphere.h*", "-f", "f32", "--pixels", "csv", "-o", "out"}},
        {{"map", "mine.toml", "-i", "sphere.p*", "-f", "f32,f64", "--metric", "lost_bits,ulp_error", "-o", "out"}});
}

TEST_CASE("sweeps killed while they replace each other damage nothing, and the next run cleans up") {
    const Scratch scratch;
    scratch.write("small.toml", small_sweep);
    const std::vector<std::string> words{"sweep", "small.toml", "-i", "sphere.p*", "--seeds", "0", "-o", "out"};
    auto other = words;
    other.insert(other.end(), {"-f", "f32"});
    kill_often(scratch, scratch / "out/small", {words}, {other});
}

}  // namespace test_kills
