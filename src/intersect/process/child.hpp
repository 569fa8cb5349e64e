// A process that gets requests on its standard input and answers on its standard output.
#pragma once

#include <chrono>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "intersect/process/stop_token.hpp"

namespace lostbits::intersect::process {

/// A word as a shell reads it back: in single quotes where it holds more than letters, digits and _./=,:+-.
[[nodiscard]] std::string shell_word(std::string_view word);

/// Number of times that the two ends of a pipe poll before they sleep; between two polls they yield the processor.
/// Waking on another processor takes up to 40 µs, many times as long as a batch; if both share a processor, the other
/// side runs at once.
inline constexpr int looks_before_sleep = 30;

/// The processes whose parent is this one, adopted ones among them.
[[nodiscard]] std::vector<int> children();

struct ChildTerms {
    std::string who;             ///< begins messages
    std::string timeout_advice;  ///< what the program's author may have overlooked if no answer comes, or empty
    double seconds = 30;         ///< limit for one answer
    int shared = -1;             ///< the descriptor of a SharedMemory that the process inherits, or -1
    StopToken stop = {};         ///< stop request of the caller: checked by every wait for an answer
};

/// A program and its arguments, passed as they stand: no shell reads them. Without a slash the program is looked for in
/// PATH.
using ProgramArguments = std::vector<std::string>;
/// The same as one would type it in a shell.
[[nodiscard]] std::string shell_command(const ProgramArguments& words);

class Child {
public:
    /// Starts `command` by the shell, in a process group of its own; its standard error is ours. EnvironmentError.
    Child(const std::string& command, ChildTerms terms);
    /// Starts a program without a shell; its standard error is part of its output.
    Child(const ProgramArguments& program, ChildTerms terms);
    /// Closes the input of the process, which tells it to end. If it does not end within a second, a signal ends it.
    /// Ends what is left in its group, too.
    ~Child();
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;

    /// Reads a line of its output, without the line's end. EnvironmentError if there is none in time, or if it is
    /// longer than 4096 bytes.
    std::string read_line();
    /// Writes all of `request` while it reads exactly the size of `answer`; the time limit is for both together.
    void exchange(std::span<const std::byte> request, std::span<std::byte> answer);
    /// Reads exactly the size of `answer`.
    void read(std::span<std::byte> answer);

    struct Ended {
        std::string output;
        int status;  ///< as returned by waitpid
    };
    /// Reads until its output and the process have ended, with one time limit for both; processes that it started are
    /// ended too.
    Ended read_to_end();

    /// Subject of the requests from now on, for messages.
    void about(const std::string& what) { about_ = what; }
    /// Throws EnvironmentError, which begins with `who` of the terms and says how the process ended if it did.
    [[noreturn]] void fail(const std::string& what);

private:
    using Clock = std::chrono::steady_clock;

    enum class Errors { ours, output };
    void start(ProgramArguments words, Errors errors);
    void write_some(std::span<const std::byte>& request);
    /// Number of bytes read; at least one.
    std::size_t read_some(std::span<std::byte> into);
    void wait_for(short events_of_input, Clock::time_point until, bool& can_write, bool& can_read);
    [[noreturn]] void fail_late();
    [[nodiscard]] std::string how_it_ended();

    std::string about_;
    ChildTerms terms_;
    int process_ = -1, input_ = -1, output_ = -1;
    bool output_ended_ = false;
};

}  // namespace lostbits::intersect::process
