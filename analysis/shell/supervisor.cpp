#include "analysis/shell/process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/random.h>
#include <sys/signalfd.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <optional>
#include <set>
#include <thread>
#include <vector>

#include "intersect/process/child.hpp"
#include "number/error.hpp"
#include "output/file/atomic_file.hpp"
#include "output/file/escape.hpp"

namespace lostbits::analysis::shell {
namespace {

using Clock = std::chrono::steady_clock;

/// A message through the pipe; for `partial_file`, the path follows it. Both together have at most PIPE_BUF bytes, so
/// that messages of two threads do not mix.
struct Message {
    enum Kind : std::uint32_t { status, broken, partial_file };
    std::uint64_t token;
    Kind kind;
    std::uint32_t value;  ///< the status, or the length of the path
};
constexpr std::size_t longest_path = 4096 - sizeof(Message);

/// The processes and the pipe, as the worker knows them; `pipe` is -1 in a program without a supervisor.
struct WorkerLink {
    int pipe = -1;
    pid_t worker = 0, supervisor = 0;
    std::uint64_t token = 0;
};
WorkerLink worker_link;

void send_message(Message::Kind kind, std::uint32_t value, const char* path = nullptr) noexcept {
    if (worker_link.pipe < 0 || getpid() != worker_link.worker || value > longest_path) return;
    const int saved_errno = errno;
    std::array<char, 4096> bytes;
    const Message message{worker_link.token, kind, value};
    std::memcpy(bytes.data(), &message, sizeof message);
    std::size_t size = sizeof message;
    if (path != nullptr) {
        std::memcpy(bytes.data() + size, path, value);
        size += value;
    }
    while (write(worker_link.pipe, bytes.data(), size) < 0 && errno == EINTR) {}
    errno = saved_errno;
}

void report_partial_file(const char* path) noexcept {
    send_message(Message::partial_file, static_cast<std::uint32_t>(std::strlen(path)), path);
}

sigset_t forwarded_signals() {
    sigset_t all;
    sigfillset(&all);
    // Stopping a job stops both processes, and a crash of the supervisor is its own.
    for (const int signal : {SIGTSTP, SIGTTIN, SIGTTOU, SIGCONT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT})
        sigdelset(&all, signal);
    return all;
}

/// True if the reader of standard output or standard error has ended, as `head` does in `lostbits … | head`.
bool has_no_reader() {
    std::array<pollfd, 2> streams{{{STDOUT_FILENO, 0, 0}, {STDERR_FILENO, 0, 0}}};
    return poll(streams.data(), streams.size(), 0) > 0 &&
           std::ranges::any_of(streams, [](const pollfd& stream) { return (stream.revents & POLLERR) != 0; });
}

/// The process that waits for the worker.
class Supervisor {
public:
    Supervisor(int pipe, std::uint64_t token, pid_t worker, std::string libraries, double seconds)
        : pipe_(pipe), token_(token), worker_(worker), libraries_(std::move(libraries)), time_limit_(seconds) {
        const sigset_t signals = forwarded_signals();
        signals_ = signalfd(-1, &signals, SFD_CLOEXEC | SFD_NONBLOCK);
        fcntl(pipe_, F_SETFL, fcntl(pipe_, F_GETFL) | O_NONBLOCK);
    }

    [[noreturn]] void run() {
        while (!has_ended()) {
            std::array<pollfd, 2> sources{{{signals_, POLLIN, 0}, {pipe_, POLLIN, 0}}};
            poll(sources.data(), sources.size(), status_ ? 50 : 1000);
            read_messages();
            read_signals();
            if (status_ && Clock::now() > status_time_ + time_limit_ && !was_slow_) {
                was_slow_ = true;
                kill(worker_, SIGKILL);
            }
            kill_if_stopped_too_long();
        }
        read_messages();
        read_signals();
        kill_orphans();
        end();
    }

private:
    bool has_ended() {
        int wait_status = 0;
        while (waitpid(worker_, &wait_status, WNOHANG | WUNTRACED | WCONTINUED) == worker_) {
            if (!WIFSTOPPED(wait_status) && !WIFCONTINUED(wait_status)) {
                wait_status_ = wait_status;
                return true;
            }
            is_stopped_ = WIFSTOPPED(wait_status);
            stopped_for_ = {};
        }
        return false;
    }

    /// Kills a worker that has been stopped for longer than the limit, since a stopped worker enforces no time limit.
    /// Only time in which the supervisor runs counts: a terminal stops the whole job, and the supervisor with it.
    void kill_if_stopped_too_long() {
        const auto now = Clock::now();
        if (is_stopped_) stopped_for_ += std::min<Clock::duration>(now - last_check_, std::chrono::seconds(1));
        last_check_ = now;
        if (!is_stopped_ || stopped_for_ < time_limit_ || was_stopped_) return;
        was_stopped_ = true;
        kill(worker_, SIGKILL);
    }

    void read_signals() {
        for (signalfd_siginfo info; read(signals_, &info, sizeof info) == sizeof info;) {
            const auto signal = static_cast<int>(info.ssi_signo);
            if (signal == SIGCHLD) continue;
            received_signals_.insert(signal);
            // The terminal and the kernel signal both processes, so only signals from a process are passed on.
            if (info.ssi_code == SI_USER || info.ssi_code == SI_QUEUE || info.ssi_code == SI_TKILL)
                kill(worker_, signal);
        }
    }

    void read_messages() {
        std::array<char, 65536> buffer;
        for (ssize_t byte_count; (byte_count = read(pipe_, buffer.data(), buffer.size())) > 0;)
            unread_.append(buffer.data(), static_cast<std::size_t>(byte_count));

        // Leaves an incomplete message for the next call.
        std::size_t offset = 0;
        for (Message message; unread_.size() - offset >= sizeof message;) {
            std::memcpy(&message, unread_.data() + offset, sizeof message);
            const std::size_t path = message.kind == Message::partial_file ? message.value : 0;
            if (message.token != token_ || path > longest_path) return unread_.clear();
            if (unread_.size() - offset < sizeof message + path) break;
            if (path > 0) {
                partial_files_.emplace_back(unread_, offset + sizeof message, path);
            } else if (!status_ || message.kind == Message::broken) {
                status_ = static_cast<int>(message.value);
                status_time_ = Clock::now();
                is_broken_ = message.kind == Message::broken;
            }
            offset += sizeof message + path;
        }
        unread_.erase(0, offset);
    }

    /// Kills the processes that the worker, or a copy of it, started. They are children of this process now.
    static void kill_orphans() {
        const auto deadline = Clock::now() + std::chrono::seconds(5);
        while (Clock::now() < deadline) {
            while (waitpid(-1, nullptr, WNOHANG) > 0) {}
            if (errno == ECHILD) return;
            for (const int child : intersect::process::child_processes()) kill(child, SIGKILL);
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
        }
    }

    [[noreturn]] void end() {
        if (status_ && WIFEXITED(wait_status_) && !is_broken_) _exit(*status_);
        for (const std::string& path : partial_files_) unlink(path.c_str());
        const int signal = WIFSIGNALED(wait_status_) ? WTERMSIG(wait_status_) : 0;
        // A signal from outside ended the worker, or the reader of its output has ended: end by the same signal.
        if (!status_ && (received_signals_.contains(signal) || (signal == SIGPIPE && has_no_reader()))) {
            ::signal(signal, SIG_DFL);
            sigset_t signal_set;
            sigemptyset(&signal_set);
            sigaddset(&signal_set, signal);
            raise(signal);
            sigprocmask(SIG_UNBLOCK, &signal_set, nullptr);
        }

        const std::string text =
            fmt::format("lostbits: {}: {}; try --isolate, which runs each library in its own process\n", libraries_,
                        crash_text(signal));
        const std::string safe = output::file::terminal_text(text);
        static_cast<void>(write(STDERR_FILENO, safe.data(), safe.size()));
        _exit(is_broken_ ? *status_ : static_cast<int>(ExitStatus::environment));
    }

    [[nodiscard]] std::string crash_text(int signal) const {
        const char* const signal_name = signal != 0 ? strsignal(signal) : "";
        if (is_broken_)
            return "an uncaught exception ended the program: in a thread that the library started, or while it was "
                   "loaded or unloaded";
        if (was_slow_) return "hangs while the program ends, in a destructor or a function given to atexit()";
        if (status_)
            return fmt::format(
                "crashed while the program ended (signal {}, {}), in a destructor or a function given to atexit(); "
                "the results are complete",
                signal, signal_name);

        // From here on the results are not complete.
        if (was_stopped_)
            return fmt::format(
                "stopped the program (as SIGSTOP does), and nothing continued it within {:g} seconds; its results are "
                "not complete",
                time_limit_.count());
        if (signal == SIGKILL) return "the program was killed in the middle of its work, perhaps for lack of memory";
        if (signal != 0)
            return fmt::format(
                "the program crashed outside of every call (signal {}, {}), perhaps in a thread that the "
                "library started; its results are not complete",
                signal, signal_name);
        return fmt::format(
            "ended the program in the middle of its work, by _exit(), quick_exit() or the like, or closed file "
            "descriptors of the program (status {}); its results are not complete",
            WEXITSTATUS(wait_status_));
    }

    int pipe_, signals_ = -1, wait_status_ = 0;
    std::uint64_t token_;
    pid_t worker_;
    std::string libraries_, unread_;
    std::chrono::duration<double> time_limit_;
    Clock::time_point status_time_{}, last_check_ = Clock::now();
    Clock::duration stopped_for_{};
    std::optional<int> status_;
    /// Names received so far; many of these files have their final names by now.
    std::vector<std::string> partial_files_;
    std::set<int> received_signals_;
    bool was_slow_ = false, is_broken_ = false, is_stopped_ = false, was_stopped_ = false;
};

std::uint64_t random_token() {
    std::uint64_t token = 0;
    if (getrandom(&token, sizeof token, GRND_NONBLOCK) != sizeof token)
        token = static_cast<std::uint64_t>(Clock::now().time_since_epoch().count());
    return token;
}

}  // namespace

void supervise(const std::string& libraries, double seconds) {
    if (worker_link.pipe >= 0) return;
    std::array<int, 2> pipe_ends{};
    if (std::fflush(stdout) != 0 || pipe2(pipe_ends.data(), O_CLOEXEC) != 0)
        throw EnvironmentError(std::string("cannot start a second process: ") + std::strerror(errno));

    // The supervisor waits for signals and for the end of the worker, so it must not miss any.
    const WorkerLink link{.pipe = pipe_ends[1], .supervisor = getpid(), .token = random_token()};
    signal(SIGCHLD, SIG_DFL);  // if it were ignored, waitpid could not tell how the worker ended
    const sigset_t signals = forwarded_signals();
    sigset_t previous_mask;
    sigprocmask(SIG_BLOCK, &signals, &previous_mask);
    prctl(PR_SET_CHILD_SUBREAPER, 1);  // before fork: the worker may start processes at once
    const pid_t worker = fork();
    if (worker < 0)
        throw EnvironmentError(std::string("cannot start a second process: ") + std::strerror(errno) +
                               "; try --isolate");
    if (worker > 0) {
        close(pipe_ends[1]);
        Supervisor(pipe_ends[0], link.token, worker, libraries, seconds).run();
    }

    // The worker runs the rest.
    close(pipe_ends[0]);
    worker_link = link;
    worker_link.worker = getpid();
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != link.supervisor) _exit(static_cast<int>(ExitStatus::environment));
    output::file::listen_to_partial_files(report_partial_file);
    sigprocmask(SIG_SETMASK, &previous_mask, nullptr);
}

bool report_uncaught_exception(int status) noexcept {
    send_message(Message::broken, static_cast<std::uint32_t>(status));
    return worker_link.pipe >= 0;
}

void report_status(int status) noexcept { send_message(Message::status, static_cast<std::uint32_t>(status)); }

bool is_from_supervisor(int sender) noexcept { return worker_link.supervisor != 0 && sender == worker_link.supervisor; }

}  // namespace lostbits::analysis::shell
