#include "intersect/process/own_state.hpp"

#include <fcntl.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstring>

#include "number/error.hpp"

namespace lostbits::intersect::process {
namespace {

constexpr std::array<int, 3> stopping{SIGINT, SIGTERM, SIGHUP};

struct OwnState {
    pid_t process = 0;
    int folder = -1;
    mode_t umask = 0;
    sigset_t mask{};
    std::array<struct sigaction, stopping.size()> actions{};
};
OwnState kept;
std::atomic<bool> is_kept{false}, is_forked{false};

}  // namespace

void keep_own_state() {
    if (is_kept.load()) return;
    kept.process = getpid();
    kept.folder = open(".", O_PATH | O_DIRECTORY | O_CLOEXEC);
    kept.umask = umask(0);
    umask(kept.umask);
    pthread_sigmask(SIG_SETMASK, nullptr, &kept.mask);
    for (std::size_t i = 0; i < stopping.size(); ++i) sigaction(stopping[i], nullptr, &kept.actions[i]);
    pthread_atfork(nullptr, nullptr, [] { is_forked.store(true); });
    is_kept.store(true);
}

bool is_a_copy() noexcept { return is_kept.load() && getpid() != kept.process; }

void give_thread_own_folder() noexcept {
    thread_local const int refused = is_kept.load() ? unshare(CLONE_FS) : 0;
    static_cast<void>(refused);  // by a sandbox
}

void put_back_own_state(const char* who) noexcept {
    if (!is_kept.load()) return;
    if (is_forked.load() && is_a_copy()) {
        for (const char* part : {"lostbits: ", who != nullptr ? who : "a library",
                                 ": made a copy of this program (fork) that came back from the call as if it were the "
                                 "program; the copy is ended; call exec or _exit in it\n"}) {
            if (write(STDERR_FILENO, part, std::strlen(part)) < 0) break;
        }
        _exit(static_cast<int>(Exit::environment));
    }
    if (kept.folder >= 0) static_cast<void>(fchdir(kept.folder));
}

void put_back_after_loading() noexcept {
    if (!is_kept.load()) return;
    umask(kept.umask);
    pthread_sigmask(SIG_SETMASK, &kept.mask, nullptr);
    for (std::size_t i = 0; i < stopping.size(); ++i) sigaction(stopping[i], &kept.actions[i], nullptr);
}

}  // namespace lostbits::intersect::process
