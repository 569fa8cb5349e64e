// What the tests of output files share: a folder that goes away, whole files, and work in a child process.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "output/image/image.hpp"

namespace lostbits::output::test {

namespace fs = std::filesystem;

/// A fresh folder, removed with all it holds.
class Scratch {
public:
    Scratch() {
        std::string name = (fs::temp_directory_path() / "lostbits-test-XXXXXX").string();
        path_ = ::mkdtemp(name.data());
    }
    ~Scratch() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;

    [[nodiscard]] fs::path operator/(const std::string& name) const { return path_ / name; }
    [[nodiscard]] const fs::path& path() const { return path_; }
    [[nodiscard]] std::size_t entries() const {
        return static_cast<std::size_t>(std::distance(fs::directory_iterator(path_), fs::directory_iterator()));
    }

private:
    fs::path path_;
};

inline std::string slurp(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// Runs `work` in a child process and returns its answer 0..99; 100 for an exception, 101 for a signal.
template <class Work>
int in_child(Work work) {
    const pid_t child = ::fork();
    if (child == 0) {
        int answer = 100;
        try {
            answer = work();
        } catch (...) {}
        ::_exit(answer);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 101;
}

/// The module that this build made, wherever the test program lies.
inline output::image::ImageBackend& backend() {
    ::setenv("LOSTBITS_IMAGE_MODULE", LOSTBITS_TEST_IMAGE_MODULE, 0);
    return output::image::image_backend();
}

}  // namespace lostbits::output::test
