#include "intersect/process/process_state.hpp"

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

constexpr std::array<int, 3> stop_signals{SIGINT, SIGTERM, SIGHUP};

using Resource = std::decay_t<decltype(RLIMIT_AS)>;  // the type that glibc gives the constants, or int
struct Limit {
    Resource resource;
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
    std::array<struct sigaction, stop_signals.size()> actions{};
    struct stat folder_status {};
    std::array<rlimit, limits.size()> old_limits{};
};
OwnState remembered;
/// Never destroyed: exit handlers read it too.
std::map<std::string, std::string, std::less<>>& remembered_environment() {
    static auto* environment = new std::map<std::string, std::string, std::less<>>;
    return *environment;
}
std::atomic<bool> is_remembered{false}, is_forked{false};

}  // namespace

void save_process_state() {
    if (is_remembered.load()) return;
    remembered.process = getpid();
    remembered.folder = open(".", O_PATH | O_DIRECTORY | O_CLOEXEC);
    if (remembered.folder >= 0) fstat(remembered.folder, &remembered.folder_status);
    for (std::size_t i = 0; i < limits.size(); ++i) getrlimit(limits[i].resource, &remembered.old_limits[i]);

    remembered.umask = umask(0);
    umask(remembered.umask);
    pthread_sigmask(SIG_SETMASK, nullptr, &remembered.mask);
    for (std::size_t i = 0; i < stop_signals.size(); ++i) sigaction(stop_signals[i], nullptr, &remembered.actions[i]);

    for (char** entry = environ; entry != nullptr && *entry != nullptr; ++entry) {
        const std::string_view text = *entry;
        const auto equals = text.find('=');
        if (equals != std::string_view::npos)
            remembered_environment().emplace(text.substr(0, equals), text.substr(equals + 1));
    }

    pthread_atfork(nullptr, nullptr, [] { is_forked.store(true); });
    is_remembered.store(true);
}

bool has_foreign_code() noexcept { return is_remembered.load(); }

const char* own_environment(const char* name) {
    if (!is_remembered.load()) return std::getenv(name);
    const auto entry = remembered_environment().find(std::string_view(name));
    return entry == remembered_environment().end() ? nullptr : entry->second.c_str();
}

bool is_forked_copy() noexcept { return is_remembered.load() && getpid() != remembered.process; }

void make_working_folder_private() noexcept {
    thread_local const int unshare_error = is_remembered.load() ? unshare(CLONE_FS) : 0;
    static_cast<void>(unshare_error);  // a sandbox may refuse the call; then the folder stays shared
}

bool restore_process_state(const char* who) noexcept {
    if (!is_remembered.load()) return true;
    if (is_forked.load() && is_forked_copy()) {
        for (const char* part : {"lostbits: ", who != nullptr ? who : "a library",
                                 ": made a copy of this program (fork), which returned from the call as if it were the "
                                 "program; the copy was ended; call exec or _exit in it\n"}) {
            if (write(STDERR_FILENO, part, std::strlen(part)) < 0) break;
        }
        _exit(static_cast<int>(ExitStatus::environment));
    }
    if (remembered.folder < 0 || fchdir(remembered.folder) == 0) return true;
    // The folder may no longer be accessible, which is not the fault of foreign code. It is the fault of that code if
    // the descriptor no longer names the folder.
    struct stat now {};
    return fstat(remembered.folder, &now) == 0 && now.st_dev == remembered.folder_status.st_dev &&
           now.st_ino == remembered.folder_status.st_ino;
}

const char* restore_limits() noexcept {
    if (!is_remembered.load()) return nullptr;
    for (std::size_t i = 0; i < limits.size(); ++i) {
        const Resource resource = limits[i].resource;
        const rlimit& old_limit = remembered.old_limits[i];
        rlimit current_limit{};
        if (getrlimit(resource, &current_limit) != 0 ||
            (current_limit.rlim_cur >= old_limit.rlim_cur && current_limit.rlim_max >= old_limit.rlim_max))
            continue;
        if (setrlimit(resource, &old_limit) == 0) continue;
        // The hard limit was lowered and cannot be raised. The lowered limit will do if the former soft limit fits.
        const rlimit lowered_limit{std::min(old_limit.rlim_cur, current_limit.rlim_max), current_limit.rlim_max};
        if (setrlimit(resource, &lowered_limit) != 0 || lowered_limit.rlim_cur < old_limit.rlim_cur)
            return limits[i].name;
    }
    return nullptr;
}

void restore_after_loading() noexcept {
    if (!is_remembered.load()) return;
    umask(remembered.umask);
    pthread_sigmask(SIG_SETMASK, &remembered.mask, nullptr);
    for (std::size_t i = 0; i < stop_signals.size(); ++i) sigaction(stop_signals[i], &remembered.actions[i], nullptr);
}

}  // namespace lostbits::intersect::process
