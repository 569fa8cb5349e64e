#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "catch.hpp"
#include "output/file/progress.hpp"

namespace test_progress {

using namespace lostbits::output;
using namespace lostbits::output::file;

namespace {

/// Text that `work` writes to its descriptor.
template <class Work>
std::string read_output_of(Work work) {
    int ends[2];
    REQUIRE(::pipe(ends) == 0);
    work(ends[1]);
    ::close(ends[1]);
    std::string out;
    char buffer[4096];
    for (ssize_t n = 0; (n = ::read(ends[0], buffer, sizeof buffer)) > 0;) out.append(buffer, static_cast<size_t>(n));
    ::close(ends[0]);
    return out;
}

}  // namespace

TEST_CASE("a progress line shows how much is done and how long it takes", "[progress]") {
    CHECK(progress_line("map", 1, 4, 30, 80) ==
          "map [##########..............................]  25%  30s elapsed, 1m30s left");
    CHECK(progress_line("map", 0, 4, 1, 36) == "map   0%  1s elapsed, ? left");
    CHECK(progress_line("map", 4, 4, 1, 80).find("100%") != std::string::npos);
    CHECK(progress_line("map", 9, 4, 1, 80).find("100%") != std::string::npos);
    for (int columns = 1; columns < 200; ++columns) {
        REQUIRE(progress_line("a label", 3, 7, 4000, columns).size() < static_cast<std::size_t>(columns));
    }
}

TEST_CASE("durations are written in fitting units", "[progress]") {
    CHECK(duration_text(7) == "7s");
    CHECK(duration_text(125) == "2m05s");
    CHECK(duration_text(3780) == "1h03m");
    CHECK(duration_text(-1) == "?");
}

TEST_CASE("progress is not drawn on a pipe, when quiet, or when switched off", "[progress]") {
    const auto run = [](Progress::Mode mode, bool quiet) {
        return read_output_of([&](int fd) {
            Progress bar(2, "map", mode, quiet, fd);
            bar.advance();
            std::this_thread::sleep_for(std::chrono::milliseconds(210));
            bar.advance();
        });
    };
    CHECK(run(Progress::Mode::automatic, false).empty());
    CHECK(run(Progress::Mode::bar, true).empty());
    CHECK(run(Progress::Mode::none, false).empty());
    CHECK_FALSE(run(Progress::Mode::bar, false).empty());
}

TEST_CASE("the progress bar counts from all threads and erases itself", "[progress]") {
    const std::string out = read_output_of([](int fd) {
        Progress bar(4000, "map", Progress::Mode::bar, false, fd);
        bar.advance(0);
        bar.print_line("note");
        std::vector<std::thread> threads;
        for (int t = 0; t < 4; ++t) {
            threads.emplace_back([&] {
                for (int i = 0; i < 1000; ++i) bar.advance();
            });
        }
        for (auto& thread : threads) thread.join();
        REQUIRE(bar.done() == 4000);
        bar.finish();
        bar.advance();
    });
    CHECK(out.find("map [") != std::string::npos);
    CHECK(out.find("note\n") != std::string::npos);
    CHECK(out.find('\x1b') == std::string::npos);  // no colours off a terminal
    REQUIRE(out.ends_with('\r'));
    const auto last = out.find_last_of('\r', out.size() - 2);
    CHECK(out.find_first_not_of(' ', last + 1) == out.size() - 1);  // the last thing on the screen is blank
}

TEST_CASE("a time estimate comes from the first part of the work, and on long runs only") {
    CHECK(estimate_text("s", {1, 1}, {2, 3}, 100) == "lostbits: s will take about 3m19s: its first 2 % took 3s");
    CHECK(estimate_text("s", {1, 0}, {2, 2}, 16) == "lostbits: s will take about 30s: its first 12 % took 2s");
    // A slow start does not count for the pace: once, or once a band.
    CHECK_FALSE(estimate_text("s", {1, 10}, {5, 12}, 40));
    CHECK(estimate_text("s", {1, 10}, {5, 12}, 41) == "lostbits: s will take about 30s: its first 12 % took 12s");
    CHECK(estimate_text("s", {1, 10}, {5, 12}, 41, 3) == "lostbits: s will take about 50s: its first 12 % took 12s");
    CHECK_FALSE(estimate_text("s", {1, 50}, {1, 50}, 100));    // no pace is known yet
    CHECK_FALSE(estimate_text("s", {1, 10}, {2, 11.9}, 100));  // and it is not certain
    CHECK_FALSE(estimate_text("s", {1, 0}, {2, 2}, 14));       // over in 26 s
    CHECK_FALSE(estimate_text("s", {1, 0}, {100, 90}, 100));   // over
}

TEST_CASE("a short or quiet run prints no time estimate") {
    CHECK(read_output_of([](int fd) {
              Progress progress(1000, "s", Progress::Mode::none, false, fd);
              Estimate estimate(progress, "s", 1000, false);
              for (int i = 0; i < 1000; ++i) estimate.advance(1);
          }).empty());
    const std::string once = read_output_of([](int fd) {
        Progress loud(1000000, "s", Progress::Mode::none, false, fd),
            quiet(1000000, "q", Progress::Mode::none, true, fd);
        Estimate of_loud(loud, "s", 1000000, false), of_quiet(quiet, "q", 1000000, true);
        for (const int wait : {0, 2100, 0}) {
            std::this_thread::sleep_for(std::chrono::milliseconds(wait));
            of_loud.advance(1);
            of_quiet.advance(1);
        }
    });
    CHECK(once.starts_with("lostbits: s will take about "));
    CHECK(std::count(once.begin(), once.end(), '\n') == 1);
}

}  // namespace test_progress
