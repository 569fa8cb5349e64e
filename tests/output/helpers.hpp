// Helper of the output tests: runs work in a child process.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "output/image/image.hpp"
#include "scratch.hpp"

namespace lostbits::output::test {

namespace fs = std::filesystem;

using lostbits::test::contents, lostbits::test::Scratch;

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
inline const bool module_is_known = ::setenv("LOSTBITS_IMAGE_MODULE", LOSTBITS_TEST_IMAGE_MODULE, 0) == 0;
inline output::image::ImageBackend& backend() { return output::image::image_backend(); }

}  // namespace lostbits::output::test
