#include "started_program.hpp"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <thread>

#include "program.hpp"

namespace lostbits::test {

StartedProgram::StartedProgram(const std::vector<std::string>& words, const fs::path& folder,
                               const std::vector<int>& ignored) {
    std::vector<std::string> owned{LOSTBITS_PROGRAM};
    owned.insert(owned.end(), words.begin(), words.end());
    std::vector<char*> arguments;
    for (std::string& word : owned) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const std::string where = folder.string(), out = where + "/out.txt", err = where + "/err.txt";
    pid_ = ::fork();
    if (pid_ < 0) throw std::runtime_error("no process");
    if (pid_ > 0) return;
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, nullptr);
    for (int signal = 1; signal < 32; ++signal) ::signal(signal, SIG_DFL);
    for (const int signal : ignored) ::signal(signal, SIG_IGN);
    const int to_out = ::open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666),
              to_err = ::open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
    if (::chdir(where.c_str()) != 0 || ::dup2(to_out, 1) < 0 || ::dup2(to_err, 2) < 0) ::_exit(126);
    ::close(to_out);
    ::close(to_err);
    ::setenv("LOSTBITS_DATA", LOSTBITS_DATA_DIR, 1);
    ::unsetenv("CI");
    ::execv(arguments[0], arguments.data());
    ::_exit(127);
}

StartedProgram::~StartedProgram() {
    if (over_) return;
    send(SIGKILL);
    ::waitpid(pid_, &status_, 0);
}

bool StartedProgram::ended() {
    over_ = over_ || ::waitpid(pid_, &status_, WNOHANG) == pid_;
    return over_;
}

bool StartedProgram::wait_until(const std::function<bool()>& is) {
    while (!is()) {
        if (ended()) return false;
        std::this_thread::sleep_for(std::chrono::microseconds(500));
    }
    return true;
}

int StartedProgram::wait() {
    if (!over_) ::waitpid(pid_, &status_, 0);
    over_ = true;
    return WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_);
}

bool has_partial_files(const fs::path& folder) {
    return std::ranges::any_of(files_below(folder),
                               [](const std::string& name) { return name.find(".partial-") != std::string::npos; });
}

}  // namespace lostbits::test
