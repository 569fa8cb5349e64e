#include "analysis/shell/process.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>

#include "number/error.hpp"
#include "output/file/atomic_file.hpp"

namespace lostbits::analysis::shell {
namespace {

std::atomic<bool> asked_to_stop{false};

/// Handles a signal that asks to stop. A second one ends the process. With a supervisor, a signal to the whole group
/// arrives twice, directly and passed on, so each way has its own flag.
void ask_to_stop(int, siginfo_t* info, void*) {
    static std::atomic<bool> asked_directly{false}, asked_by_supervisor{false};
    asked_to_stop.store(true);
    std::atomic<bool>& asked = is_from_supervisor(info->si_pid) ? asked_by_supervisor : asked_directly;
    if (!asked.exchange(true)) return;
    output::file::remove_partial_files();
    report_status(static_cast<int>(ExitStatus::interrupted));
    _exit(static_cast<int>(ExitStatus::interrupted));
}

/// Removes partial files and raises the signal again. The signal is blocked in this handler. It ends the process as
/// soon as the handler returns, so the parent sees the usual cause of death.
void clean_up_and_end(int signal, siginfo_t*, void*) {
    output::file::remove_partial_files();
    ::signal(signal, SIG_DFL);
    raise(signal);
}

void install_handler(int signal, void (*handler)(int, siginfo_t*, void*)) {
    struct sigaction action {};
    if (sigaction(signal, nullptr, &action) != 0 || (action.sa_flags & SA_SIGINFO) != 0 || action.sa_handler != SIG_DFL)
        return;
    action.sa_sigaction = handler;
    action.sa_flags = SA_ONSTACK | SA_SIGINFO;
    sigaction(signal, &action, nullptr);
}

}  // namespace

void open_standard_streams() {
    constexpr std::array<int, 3> placeholder_modes{O_WRONLY, O_RDONLY, O_RDONLY};
    for (int fd = 0; fd < 3; ++fd) {
        if (::fcntl(fd, F_GETFD) >= 0 || errno != EBADF) continue;
        const int opened = ::open("/dev/null", placeholder_modes[static_cast<unsigned>(fd)]);
        // open takes the lowest free number, which is fd. If /dev/null does not exist, a folder does as well.
        if (opened < 0) static_cast<void>(::open("/", O_RDONLY | O_DIRECTORY));
    }
}

intersect::process::StopToken stop_by_signal() { return intersect::process::StopToken(asked_to_stop); }

void install_signal_handlers() {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGXCPU}) install_handler(signal, ask_to_stop);
    for (const int signal : {SIGQUIT, SIGUSR1, SIGUSR2, SIGALRM, SIGVTALRM, SIGPROF, SIGPIPE, SIGIO, SIGPWR, SIGSTKFLT,
                             SIGSYS, SIGTRAP, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT})
        install_handler(signal, clean_up_and_end);
    output::file::ignore_file_size_signal();
}

}  // namespace lostbits::analysis::shell
