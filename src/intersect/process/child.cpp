#include "intersect/process/child.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <set>
#include <thread>
#include <utility>

#include "intersect/process/shared_memory.hpp"
#include "number/error.hpp"
#include "text/shell_word.hpp"

extern char** environ;

namespace lostbits::intersect::process {
namespace {

/// Indices of the ends of a pipe.
enum PipeEnd : std::size_t { read_end, write_end };

/// Makes a pipe whose ends close when another program is started, so that no child holds the pipe of another child
/// open.
std::array<int, 2> make_pipe() {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0)
        throw EnvironmentError(std::string("cannot make a pipe: ") + std::strerror(errno) + "; try a smaller -j");
    return ends;
}

/// Waits until the process has ended, but not longer than `time`. Returns true if it has ended. The process is not
/// reaped, so that no other process gets its number.
bool ends_within(int process, std::chrono::milliseconds time) {
    for (auto waited = std::chrono::milliseconds(0); waited <= time; waited += std::chrono::milliseconds(5)) {
        siginfo_t info{};
        const int error = waitid(P_PID, static_cast<id_t>(process), &info, WEXITED | WNOHANG | WNOWAIT);
        if (error != 0 || info.si_pid == process) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
}

/// Ends the descendants of a child that have left its process group (setsid). This process is their subreaper: it
/// adopts them when their parent ends.
class AdoptedDescendants {
public:
    /// Children that this process already has, left by the shell that started it, are not ours to end.
    AdoptedDescendants() {
        for (const int child : child_processes()) own_children_.insert(child);
        prctl(PR_SET_CHILD_SUBREAPER, 1);
    }
    /// Calls `start`, which returns the process that it started, and remembers that process as our own.
    template <class Start>
    int remember_own(const Start& start) {
        const std::scoped_lock lock(mutex_);
        const int child = start();
        own_children_.insert(child);
        return child;
    }
    void end() {
        const std::scoped_lock lock(mutex_);
        for (bool ended_any = true; ended_any;) {  // again, since ending a process leaves us its children
            ended_any = false;
            for (const int child : child_processes()) {
                // A process that a library in this process started is in our own group and stays.
                if (own_children_.contains(child) || getpgid(child) == getpgrp()) continue;
                ended_any = kill(child, SIGKILL) == 0 && waitpid(child, nullptr, 0) == child;
            }
        }
    }

private:
    std::mutex mutex_;
    std::set<int> own_children_;
};
AdoptedDescendants& adopted_descendants() {
    static auto* instance = new AdoptedDescendants;
    return *instance;
}

/// Starts a program in a process group of its own, so that its descendants can be ended with it. A write to a pipe
/// without a reader ends the process, as usual. Returns the error of posix_spawnp.
int spawn_in_own_group(ProgramArguments& program, const posix_spawn_file_actions_t& files, int& process) {
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t defaults;
    sigemptyset(&defaults);
    sigaddset(&defaults, SIGPIPE);
    posix_spawnattr_setsigdefault(&attributes, &defaults);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF);

    std::vector<char*> arguments;
    for (std::string& argument : program) arguments.push_back(argument.data());
    arguments.push_back(nullptr);
    int error = 0;
    adopted_descendants().remember_own([&] {
        error = posix_spawnp(&process, arguments[0], &files, &attributes, arguments.data(), environ);
        return process;
    });
    posix_spawnattr_destroy(&attributes);
    return error;
}

/// Ends a process and all processes that it started, including copies of itself. Returns the status of the process.
int end_process_group(int process) {
    int status = 0;
    kill(-process, SIGKILL);
    waitpid(process, &status, 0);
    adopted_descendants().end();
    return status;
}

}  // namespace

std::string shell_command(const ProgramArguments& arguments) {
    std::string command;
    for (const std::string& argument : arguments) command += (command.empty() ? "" : " ") + text::shell_word(argument);
    return command;
}

std::vector<int> child_processes() {
    std::vector<int> process_ids;
    std::error_code error;
    for (const auto& thread : std::filesystem::directory_iterator("/proc/self/task", error)) {
        std::ifstream list(thread.path() / "children");
        for (int child = 0; list >> child;) process_ids.push_back(child);
    }
    return process_ids;
}

ChildProcess::ChildProcess(const std::string& command, ChildOptions options) : options_(std::move(options)) {
    start({"/bin/sh", "-c", command}, StandardError::inherited);
}

ChildProcess::ChildProcess(const ProgramArguments& program, ChildOptions options) : options_(std::move(options)) {
    start(program, StandardError::output);
}

void ChildProcess::start(ProgramArguments program, StandardError errors) {
    const auto to_child = make_pipe(), from_child = make_pipe();
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_adddup2(&files, to_child[read_end], STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&files, from_child[write_end], STDOUT_FILENO);
    if (errors == StandardError::output) posix_spawn_file_actions_adddup2(&files, from_child[write_end], STDERR_FILENO);
    if (options_.shared_descriptor >= 0)
        posix_spawn_file_actions_adddup2(&files, options_.shared_descriptor, SharedMemory::inherited);

    const int error = spawn_in_own_group(program, files, process_);
    posix_spawn_file_actions_destroy(&files);
    close(to_child[read_end]);
    close(from_child[write_end]);
    input_ = to_child[write_end];
    output_ = from_child[read_end];
    if (error != 0) {
        process_ = -1;
        fail(std::string("cannot be started: ") + std::strerror(error));
    }

    for (const int end : {input_, output_}) fcntl(end, F_SETFL, fcntl(end, F_GETFL) | O_NONBLOCK);
    signal(SIGPIPE, SIG_IGN);  // writing to a child that has ended becomes an error of write()
}

ChildProcess::~ChildProcess() {
    if (input_ >= 0) close(input_);
    if (output_ >= 0) close(output_);
    if (process_ <= 0) return;
    ends_within(process_, std::chrono::seconds(1));
    end_process_group(process_);
}

std::string ChildProcess::end_and_describe() {
    if (process_ <= 0 || !ends_within(process_, std::chrono::milliseconds(200))) return "";
    const int status = end_process_group(process_);
    process_ = -1;
    if (WIFSIGNALED(status))
        return std::string(" (it was ended by signal ") + std::to_string(WTERMSIG(status)) + ", " +
               strsignal(WTERMSIG(status)) + ")";
    const int code = WEXITSTATUS(status);
    return code == 127 ? " (the shell did not find the command)"
                       : " (it ended with status " + std::to_string(code) + ")";
}

void ChildProcess::fail(const std::string& problem) {
    const std::string ending = output_ended_ ? end_and_describe() : "";
    throw EnvironmentError(options_.who + ": " + (subject_.empty() ? "" : subject_ + " ") + problem + ending);
}

void ChildProcess::fail_after_time_limit() {
    fail("has not answered within the time limit; " +
         (options_.timeout_advice.empty() ? "" : options_.timeout_advice + "; ") +
         "raise --time-limit SECONDS if it needs longer");
}

void ChildProcess::wait_for(short events_of_input, Clock::time_point deadline, bool& can_write, bool& can_read) {
    for (;;) {
        options_.stop.check();
        std::array<pollfd, 2> polled_ends{{{output_, POLLIN, 0}, {events_of_input ? input_ : -1, events_of_input, 0}}};
        const auto milliseconds_left =
            std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
        if (milliseconds_left <= 0) fail_after_time_limit();
        const int ready = poll(polled_ends.data(), polled_ends.size(),
                               static_cast<int>(std::min<decltype(milliseconds_left)>(milliseconds_left, 200)));
        if (ready < 0 && errno != EINTR) fail(std::string("poll: ") + std::strerror(errno));
        if (ready <= 0) continue;
        const auto& [polled_output, polled_input] = polled_ends;
        can_read = polled_output.revents != 0;
        can_write = polled_input.revents != 0;
        return;
    }
}

void ChildProcess::write_some(std::span<const std::byte>& request) {
    const ssize_t written = ::write(input_, request.data(), request.size());
    if (written >= 0) {
        request = request.subspan(static_cast<std::size_t>(written));
    } else if (errno == EPIPE) {
        output_ended_ = true;
        fail("ended before it had read a whole batch");
    } else if (errno != EAGAIN && errno != EINTR) {
        fail(std::string("cannot be written to: ") + std::strerror(errno));
    }
}

std::size_t ChildProcess::read_some(std::span<std::byte> buffer) {
    const ssize_t received = ::read(output_, buffer.data(), buffer.size());
    if (received > 0) return static_cast<std::size_t>(received);
    if (received < 0 && (errno == EAGAIN || errno == EINTR)) return 0;
    output_ended_ = true;
    fail("ended before it had written a whole answer");
}

void ChildProcess::exchange(std::span<const std::byte> request, std::span<std::byte> answer) {
    const auto deadline =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options_.seconds));
    if (!request.empty()) write_some(request);  // most requests fit into the pipe at once and need no poll

    // Asks again at once for a while: a fast answer arrives sooner than a sleeping process wakes up.
    for (int poll_count = 0; poll_count < polls_before_sleep && request.empty() && !answer.empty(); ++poll_count) {
        answer = answer.subspan(read_some(answer));
        if (!answer.empty()) sched_yield();
    }

    while (!request.empty() || !answer.empty()) {
        bool can_write = false, can_read = false;
        wait_for(request.empty() ? short{0} : short{POLLOUT}, deadline, can_write, can_read);
        if (can_write) write_some(request);
        if (!can_read) continue;
        if (answer.empty()) return;  // the child answered early, or has ended; the next read shows which
        answer = answer.subspan(read_some(answer));
    }
}

ChildProcess::ChildEnd ChildProcess::read_to_end() {
    const auto deadline =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options_.seconds));
    ChildEnd result{};
    close(std::exchange(input_, -1));

    for (std::array<char, 4096> buffer;;) {
        bool can_write = false, can_read = false;
        wait_for(0, deadline, can_write, can_read);
        const ssize_t received = ::read(output_, buffer.data(), buffer.size());
        if (received > 0) result.output.append(buffer.data(), static_cast<std::size_t>(received));
        else if (received == 0 || (errno != EAGAIN && errno != EINTR)) break;
    }

    // The process may have closed its output and still run.
    while (!ends_within(process_, std::chrono::milliseconds(20))) {
        options_.stop.check();
        if (Clock::now() > deadline) fail_after_time_limit();
    }

    result.status = end_process_group(process_);
    process_ = -1;
    return result;
}

void ChildProcess::read(std::span<std::byte> answer) { exchange({}, answer); }

std::string ChildProcess::read_line() {
    std::string line;
    for (;;) {
        std::byte character{};
        read({&character, 1});
        if (static_cast<char>(character) == '\n') return line;
        line += static_cast<char>(character);
        if (line.size() > 4096)
            fail("wrote a line of more than 4096 bytes; see docs/pipe.md for the header that it must begin with");
    }
}

}  // namespace lostbits::intersect::process
