// A child process that gets requests on its standard input and answers on its standard output.
#pragma once

#include <chrono>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "intersect/process/stop_token.hpp"

namespace lostbits::intersect::process {

/// Number of times that each end of a pipe polls before it sleeps; between two polls it yields the processor. Waking on
/// another processor takes up to 40 µs, many times as long as a batch. If both ends share a processor, the other end
/// runs at once.
inline constexpr int polls_before_sleep = 30;

/// Returns the ids of the processes whose parent is this process, including adopted ones.
[[nodiscard]] std::vector<int> child_processes();

struct ChildOptions {
    std::string who;             ///< begin of messages
    std::string timeout_advice;  ///< advice to the program's author for the case that no answer comes; may be empty
    double seconds = 30;         ///< limit for one answer
    int shared_descriptor = -1;  ///< the descriptor of a SharedMemory that the process inherits, or -1
    StopToken stop = {};         ///< stop request of the caller; every wait for an answer checks it
};

/// A program and its arguments, passed unchanged: no shell reads them. A program without a slash is looked for in PATH.
using ProgramArguments = std::vector<std::string>;
/// The program and its arguments as one would type them in a shell.
[[nodiscard]] std::string shell_command(const ProgramArguments& arguments);

class ChildProcess {
public:
    /// Starts `command` by the shell, in a process group of its own; its standard error is ours. Throws
    /// EnvironmentError if the command cannot be started.
    ChildProcess(const std::string& command, ChildOptions options);
    /// Starts a program without a shell; its standard error becomes a part of its output.
    ChildProcess(const ProgramArguments& program, ChildOptions options);
    /// Closes the input of the process, which tells it to end. If the process does not end within a second, a signal
    /// ends it. Processes that are left in its group are ended, too.
    ~ChildProcess();
    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;

    /// Reads a line of the child's output, without the end of the line. Throws EnvironmentError if there is no line
    /// within the time limit, or if the line is longer than 4096 bytes.
    std::string read_line();
    /// Writes all of `request` while it reads exactly the size of `answer`. The time limit is for both together.
    void exchange(std::span<const std::byte> request, std::span<std::byte> answer);
    /// Reads exactly the size of `answer`.
    void read(std::span<std::byte> answer);

    struct ChildEnd {
        std::string output;
        int status;  ///< as returned by waitpid
    };
    /// Reads until the output and the process have ended, with one time limit for both. Processes that the child
    /// started are ended, too.
    ChildEnd read_to_end();

    /// Sets the subject that messages about the following requests name, such as a form.
    void set_subject(const std::string& subject) { subject_ = subject; }
    /// Throws EnvironmentError, which begins with `who` of the options and says how the process ended if it has ended.
    [[noreturn]] void fail(const std::string& problem);

private:
    using Clock = std::chrono::steady_clock;

    enum class StandardError { inherited, output };
    void start(ProgramArguments program, StandardError errors);
    void write_some(std::span<const std::byte>& request);
    /// Returns the number of bytes read; 0 if no bytes are there yet.
    std::size_t read_some(std::span<std::byte> buffer);
    void wait_for(short events_of_input, Clock::time_point deadline, bool& can_write, bool& can_read);
    [[noreturn]] void fail_after_time_limit();
    [[nodiscard]] std::string end_and_describe();

    std::string subject_;
    ChildOptions options_;
    int process_ = -1, input_ = -1, output_ = -1;
    bool output_ended_ = false;
};

}  // namespace lostbits::intersect::process
