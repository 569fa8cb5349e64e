// What a signal handler does to files that are being written.
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "catch.hpp"
#include "number/error.hpp"
#include "output/file/atomic_file.hpp"
#include "output/helpers.hpp"

namespace test_partial_files {

using namespace lostbits;
using namespace lostbits::output;
using namespace lostbits::output::file;
using namespace lostbits::output::test;

TEST_CASE("a signal handler removes the partial files and keeps the finished ones", "[atomic_file]") {
    const Scratch folder;
    const int answer = in_child([&] {
        std::signal(SIGTERM, [](int) {
            output::file::remove_partial_files();
            ::_exit(42);
        });
        output::file::AtomicFile finished(folder / "finished");
        finished.commit();
        std::vector<std::unique_ptr<AtomicFile>> files;
        for (int i = 0; i < 200; ++i) files.push_back(std::make_unique<AtomicFile>(folder / std::to_string(i)));
        if (folder.entries() != 201) return 1;
        std::raise(SIGTERM);
        return 2;
    });
    REQUIRE(answer == 42);
    REQUIRE(folder.entries() == 1);
    REQUIRE(fs::exists(folder / "finished"));
}

TEST_CASE("commit after the signal handler ran says interrupted", "[atomic_file]") {
    const Scratch folder;
    const int answer = in_child([&] {
        output::file::AtomicFile file(folder / "a");
        file.write("x");
        output::file::remove_partial_files();
        try {
            file.commit();
        } catch (const Interrupted&) {
            return 42;
        }
        return 1;
    });
    REQUIRE(answer == 42);
    REQUIRE(folder.entries() == 0);
}

TEST_CASE("no thread makes a file behind the back of the signal handler", "[atomic_file]") {
    const Scratch folder;
    for (int k = 0; k < 50; ++k) {
        const int answer = in_child([&] {
            std::signal(SIGTERM, [](int) {
                output::file::remove_partial_files();
                ::_exit(42);
            });
            std::atomic<int> made = 0;
            const auto make_files = [&](char name) {
                try {
                    for (;; ++made) AtomicFile(folder / std::string(1, name)).write("x");
                } catch (const Interrupted&) {}
            };
            std::thread first(make_files, 'a'), second(make_files, 'b');
            while (made < 20) std::this_thread::yield();
            std::raise(SIGTERM);
            return 2;
        });
        REQUIRE(answer == 42);
        REQUIRE(folder.entries() == 0);
    }
}

}  // namespace test_partial_files
