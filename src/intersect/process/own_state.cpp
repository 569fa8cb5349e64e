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
#include <cstdlib>
#include <cstring>
#include <functional>
#include <map>
#include <string>
#include <string_view>

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
/// Never destroyed: what runs at the end asks, too.
std::map<std::string, std::string, std::less<>>& kept_environment() {
    static auto* all = new std::map<std::string, std::string, std::less<>>;
    return *all;
}
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
    for (char** entry = environ; entry != nullptr && *entry != nullptr; ++entry) {
        const std::string_view text = *entry;
        const auto equals = text.find('=');
        if (equals != std::string_view::npos)
            kept_environment().emplace(text.substr(0, equals), text.substr(equals + 1));
    }
    pthread_atfork(nullptr, nullptr, [] { is_forked.store(true); });
    is_kept.store(true);
}

bool has_foreign_code() noexcept { return is_kept.load(); }

const char* own_environment(const char* name) {
    if (!is_kept.load()) return std::getenv(name);
    const auto place = kept_environment().find(std::string_view(name));
    return place == kept_environment().end() ? nullptr : place->second.c_str();
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
