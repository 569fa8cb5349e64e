// A running program, for tests that end it.
#pragma once

#include <signal.h>
#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace lostbits::test {

/// A run of the program that goes on while the test looks. It receives signals like a program that was started at a
/// terminal; its output goes to `out` and `err`.
class StartedProgram {
public:
    /// Starts `lostbits WORDS` in `folder`; `ignored` are signals that are ignored from its start on.
    StartedProgram(const std::vector<std::string>& words, const std::filesystem::path& folder,
                   const std::vector<int>& ignored = {});
    ~StartedProgram();
    StartedProgram(const StartedProgram&) = delete;
    StartedProgram& operator=(const StartedProgram&) = delete;

    void send(int signal) const { ::kill(pid_, signal); }
    /// Waits until `is` holds, checking every half millisecond; false if the run ended before.
    bool wait_until(const std::function<bool()>& is);
    /// Its exit status, or 128 + the signal that ended it.
    int wait();

private:
    bool ended();
    pid_t pid_;
    int status_ = 0;
    bool over_ = false;
};

/// True if a run is writing a file below this folder, or was killed while it did.
bool has_partial_files(const std::filesystem::path& folder);

}  // namespace lostbits::test
