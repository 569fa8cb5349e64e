#include "intersect/process/own_state.hpp"

#include <fcntl.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <type_traits>

#include "number/error.hpp"

namespace lostbits::intersect::process {
namespace {

constexpr std::array<int, 3> stopping{SIGINT, SIGTERM, SIGHUP};

using Resource = std::decay_t<decltype(RLIMIT_AS)>;  // glibc's own type, or int
struct Limit {
    Resource number;
    const char* name;
};
constexpr std::array limits{Limit{RLIMIT_AS, "the size of memory (ulimit -v)"},
                            Limit{RLIMIT_CORE, "the size of a core file (ulimit -c)"},
                            Limit{RLIMIT_CPU, "the time on a processor (ulimit -t)"},
                            Limit{RLIMIT_DATA, "the size of data (ulimit -d)"},
                            Limit{RLIMIT_FSIZE, "the size of files (ulimit -f)"},
                            Limit{RLIMIT_NOFILE, "the number of open files (ulimit -n)"},
                            Limit{RLIMIT_NPROC, "the number of processes (ulimit -u)"},
                            Limit{RLIMIT_STACK, "the size of the stack (ulimit -s)"}};

struct OwnState {
    pid_t process = 0;
    int folder = -1;
    mode_t umask = 0;
    sigset_t mask{};
    std::array<struct sigaction, stopping.size()> actions{};
    struct stat folder_is {};
    std::array<rlimit, limits.size()> had{};
};
OwnState kept;
/// Never destroyed: exit handlers read it too.
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
    if (kept.folder >= 0) fstat(kept.folder, &kept.folder_is);
    for (std::size_t i = 0; i < limits.size(); ++i) getrlimit(limits[i].number, &kept.had[i]);
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
    static_cast<void>(refused);  // a sandbox may refuse; then the folder stays shared
}

bool put_back_own_state(const char* who) noexcept {
    if (!is_kept.load()) return true;
    if (is_forked.load() && is_a_copy()) {
        for (const char* part : {"lostbits: ", who != nullptr ? who : "a library",
                                 ": made a copy of this program (fork), which returned from the call as if it were the "
                                 "program; the copy was ended; call exec or _exit in it\n"}) {
            if (write(STDERR_FILENO, part, std::strlen(part)) < 0) break;
        }
        _exit(static_cast<int>(Exit::environment));
    }
    if (kept.folder < 0 || fchdir(kept.folder) == 0) return true;
    // The folder may no longer be accessible, which is not the fault of foreign code. Only a descriptor that no longer
    // names it is.
    struct stat now {};
    return fstat(kept.folder, &now) == 0 && now.st_dev == kept.folder_is.st_dev && now.st_ino == kept.folder_is.st_ino;
}

const char* put_back_limits() noexcept {
    if (!is_kept.load()) return nullptr;
    for (std::size_t i = 0; i < limits.size(); ++i) {
        const Resource resource = limits[i].number;
        const rlimit& own = kept.had[i];
        rlimit now{};
        if (getrlimit(resource, &now) != 0 || (now.rlim_cur >= own.rlim_cur && now.rlim_max >= own.rlim_max)) continue;
        if (setrlimit(resource, &own) == 0) continue;
        // The hard limit was lowered and cannot be raised. What is left of it will do if the former soft limit fits.
        const rlimit most{std::min(own.rlim_cur, now.rlim_max), now.rlim_max};
        if (setrlimit(resource, &most) != 0 || most.rlim_cur < own.rlim_cur) return limits[i].name;
    }
    return nullptr;
}

void put_back_after_loading() noexcept {
    if (!is_kept.load()) return;
    umask(kept.umask);
    pthread_sigmask(SIG_SETMASK, &kept.mask, nullptr);
    for (std::size_t i = 0; i < stopping.size(); ++i) sigaction(stopping[i], &kept.actions[i], nullptr);
}

}  // namespace lostbits::intersect::process
