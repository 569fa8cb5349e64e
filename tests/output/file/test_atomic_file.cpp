#include <sys/resource.h>
#include <sys/stat.h>
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
#include "output/file/result_folder.hpp"
#include "output/helpers.hpp"

namespace test_atomic_file {

using namespace lostbits;
using namespace lostbits::output;
using namespace lostbits::output::file;
using namespace lostbits::output::test;

namespace {

/// The message of the EnvironmentError that ends `work`; empty if the work ends without one.
template <class Work>
std::string find_refusal(Work work) {
    try {
        work();
    } catch (const EnvironmentError& error) {
        return error.what();
    }
    return {};
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// The process ends by 42 at SIGTERM, its partial files removed.
void remove_at_signal() {
    std::signal(SIGTERM, [](int) {
        remove_partial_files();
        ::_exit(42);
    });
}

}  // namespace

TEST_CASE("a file gets its final name only on commit, and has one writer", "[atomic_file]") {
    const Scratch folder;
    AtomicFile file(folder / "a.csv");
    REQUIRE(folder.entries() == 1);
    file.write("one,");
    file.write("two\n");
    REQUIRE_FALSE(fs::exists(folder / "a.csv"));
    REQUIRE(fs::directory_iterator(folder.path())->path().filename().string().starts_with(".a.csv.partial-"));
    REQUIRE_THROWS_AS(AtomicFile(folder / "a.csv"), std::logic_error);
    file.commit();
    REQUIRE(contents(folder / "a.csv") == "one,two\n");
    REQUIRE(folder.entries() == 1);
    REQUIRE_THROWS_AS(file.write("late"), std::logic_error);
    REQUIRE_THROWS_AS(file.commit(), std::logic_error);
}

TEST_CASE("an abandoned write leaves the old file unchanged", "[atomic_file]") {
    const Scratch folder;
    { AtomicFile(folder / "a").write("lost"); }
    REQUIRE(folder.entries() == 0);
    write_file(folder / "a", "old");
    { AtomicFile(folder / "a").write("new, cut short"); }
    REQUIRE(contents(folder / "a") == "old");
    REQUIRE(folder.entries() == 1);
}

TEST_CASE("seek can overwrite across the buffer's edge, and tell follows", "[atomic_file]") {
    const Scratch folder;
    std::string expected(600000, 'x');
    AtomicFile file(folder / "a");
    file.write(expected);
    REQUIRE(file.tell() == 600000);
    for (const std::int64_t at : {0, 262143, 599998}) {
        file.seek(at);
        REQUIRE(file.tell() == at);
        file.write("ab");
        expected.replace(static_cast<std::size_t>(at), 2, "ab");
        REQUIRE(file.tell() == at + 2);
    }
    file.commit();
    REQUIRE(contents(folder / "a") == expected);
}

TEST_CASE("missing folders are created, and a path that cannot be written is refused at once", "[atomic_file]") {
    const Scratch folder;
    AtomicFile(folder / "x/y/z.csv").commit();
    REQUIRE(fs::exists(folder / "x/y/z.csv"));

    for (const auto& [name, why] : {std::pair<std::string, std::string>("x", "x: cannot write: Is a directory; "),
                                    {"x/y/z.csv/w.csv", "z.csv: cannot use as a folder: Not a directory"},
                                    {"x/y/z.csv/deep/w.csv", "Not a directory"},
                                    {std::string(300, 'n'), "File name too long"}})
        CHECK(contains(find_refusal([&] { AtomicFile(folder / name); }), why));
    REQUIRE(folder.entries() == 1);
}

TEST_CASE("an unwritable folder or file is refused before any work", "[atomic_file]") {
    const Scratch folder;
    { AtomicFile(folder / "mine").commit(); }
    ::chmod((folder / "mine").c_str(), 0444);
    ::chmod(folder.path().c_str(), 0555);
    const int answer = in_child([&] {
        if (::getuid() == 0 && ::setuid(65534) != 0) return 9;  // permissions do not bind root
        for (const auto& [name, why] : {std::pair("a", "a: cannot create: Permission denied; "),
                                        {"s/a", "cannot create the folder: Permission"},
                                        {"mine", "cannot overwrite: Permission denied"}})
            if (!contains(find_refusal([&] { AtomicFile(folder / name); }), why)) return 1;
        return 0;
    });
    ::chmod(folder.path().c_str(), 0755);
    REQUIRE(answer == 0);
    REQUIRE(folder.entries() == 1);
}

TEST_CASE("a full disk is reported and leaves no file", "[atomic_file]") {
    const Scratch folder;
    const auto fill = [&](std::size_t bytes) {
        return in_child([&] {
            ignore_file_size_signal();
            const rlimit limit{100000, 100000};
            ::setrlimit(RLIMIT_FSIZE, &limit);
            const std::string message = find_refusal([&] { write_file(folder / "big", std::string(bytes, 'x')); });
            if (message.empty()) return 1;
            return message == (folder / "big").string() +
                                  ": cannot write: File too large; free space or choose another place"
                       ? 0
                       : 2;
        });
    };
    REQUIRE(fill(90000) == 1);  // it fits
    REQUIRE(fs::file_size(folder / "big") == 90000);
    fs::remove(folder / "big");
    REQUIRE(fill(110000) == 0);   // seen in commit
    REQUIRE(fill(1000000) == 0);  // seen in write
    REQUIRE(folder.entries() == 0);
}

TEST_CASE("a device is written in place, never replaced", "[atomic_file]") {
    REQUIRE(find_refusal([] { write_file("/dev/full", "x"); }) ==
            "/dev/full: cannot write: No space left on device; free space or choose another place");
    REQUIRE(fs::is_character_file("/dev/full"));
    write_file("/dev/null", "x");
    REQUIRE(fs::is_character_file("/dev/null"));
}

TEST_CASE("a symbolic link is kept and its target is replaced", "[atomic_file]") {
    const Scratch folder;
    { AtomicFile(folder / "real/target").commit(); }
    fs::create_symlink("real/target", folder / "link");
    write_file(folder / "link", "new");
    REQUIRE(fs::is_symlink(folder / "link"));
    REQUIRE(contents(folder / "real/target") == "new");
}

TEST_CASE("a file that is being written is never taken for abandoned", "[atomic_file]") {
    const Scratch folder;
    std::atomic<bool> done = false;
    std::thread remover([&] {
        while (!done.load()) {
            std::error_code gone;
            for (auto at = fs::directory_iterator(folder.path(), gone); at != fs::end(at); at.increment(gone)) {
                if (at->path().filename().string().find(".partial-") != std::string::npos)
                    remove_abandoned_file(at->path());
            }
        }
    });
    for (int i = 0; i < 300; ++i) CHECK_NOTHROW(write_file(folder / "a", "new"));
    done = true;
    remover.join();
    CHECK(contents(folder / "a") == "new");
}

TEST_CASE("a signal handler removes all partial files, as many as the machine allows", "[atomic_file]") {
    const Scratch folder;
    const int answer = in_child([&] {
        raise_open_file_limit();
        rlimit limit{};
        if (::getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur < 5200) return 3;
        const ResultFolder mine(folder.path(), {"lostbits map a", "lostbits 0"}, {});
        std::vector<std::unique_ptr<AtomicFile>> files;
        for (int i = 0; i < 5000; ++i) files.push_back(std::make_unique<AtomicFile>(folder / std::to_string(i)));
        if (folder.entries() != 5000) return 1;
        remove_partial_files();
        return folder.entries() == 0 ? 2 : 1;
    });
    if (answer == 3) WARN("this machine lets a process have fewer than 5200 files open");
    else CHECK(answer == 2);
}

TEST_CASE("a signal handler removes the partial files and keeps the finished ones", "[atomic_file]") {
    const Scratch folder;
    const int answer = in_child([&] {
        remove_at_signal();
        write_file(folder / "finished", "");
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

TEST_CASE("commit after the signal handler ran reports an interruption", "[atomic_file]") {
    const Scratch folder;
    const int answer = in_child([&] {
        AtomicFile file(folder / "a");
        file.write("x");
        remove_partial_files();
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

TEST_CASE("no thread creates a file while the signal handler runs", "[atomic_file]") {
    const Scratch folder;
    for (int k = 0; k < 50; ++k) {
        const int answer = in_child([&] {
            remove_at_signal();
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

TEST_CASE("a folder is marked as unfinished from the first result to the last", "[result_folder]") {
    const Scratch folder;
    const auto unfinished = [&] { return ResultFolder::unfinished_sentence(folder.path()); };
    const auto write = [&](const std::string& name) { write_file(folder / name, name); };
    const Provenance first{"lostbits map a", "lostbits 0"}, second{"lostbits map b", "lostbits 0"};
    {
        ResultFolder mine(folder.path(), first, {});
        CHECK(unfinished().empty());
        write("a.csv");
        CHECK(contains(unfinished(), "a run is writing to it now"));
        CHECK(contains(contents(folder / "UNFINISHED.txt"), "lostbits map a"));
        write("b.csv");
    }
    CHECK(unfinished().empty());
    CHECK(folder.entries() == 3);  // with the list
    // A folder whose run ends by an exception.
    CHECK_THROWS_AS(
        [&] {
            ResultFolder mine(folder.path(), second, {});
            write("b.csv");
            throw Interrupted();
        }(),
        Interrupted);
    CHECK(contains(unfinished(), "the run that wrote it was stopped; run the command in its UNFINISHED.txt again"));
    CHECK_FALSE(fs::exists(folder / "a.csv"));
    {
        ResultFolder mine(folder.path(), second, {});
        CHECK(contains(unfinished(), "was stopped"));
        write("b.csv");
    }
    CHECK(unfinished().empty());
    CHECK(folder.entries() == 2);
}

TEST_CASE("the limit on open files is raised to the hard limit", "[atomic_file]") {
    REQUIRE(in_child([] {
                rlimit limit{};
                ::getrlimit(RLIMIT_NOFILE, &limit);
                limit.rlim_cur = 64;
                ::setrlimit(RLIMIT_NOFILE, &limit);
                raise_open_file_limit();
                rlimit after{};
                ::getrlimit(RLIMIT_NOFILE, &after);
                return after.rlim_cur == limit.rlim_max && after.rlim_cur > 64 ? 0 : 1;
            }) == 0);
}

}  // namespace test_atomic_file
