// A process that is asked over its standard input and answers on its standard output.
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

/// So often the two ends of a pipe look for what is due before they sleep, and give the processor away in between. To
/// wake on another processor takes up to 40 µs, many times as long as a batch does; where both share one, the other
/// runs at once.
inline constexpr int looks_before_sleep = 30;

/// The processes whose parent is this one, adopted ones among them.
[[nodiscard]] std::vector<int> children();

struct ChildTerms {
    std::string who;      ///< begins messages
    std::string duty;     ///< what its author may have overlooked where no answer comes, or nothing
    double seconds = 30;  ///< that an answer may take
    int shared = -1;      ///< the descriptor of a SharedRoom that it gets at, or -1
    StopToken stop = {};  ///< of who started it: asked while anyone waits for an answer
};

/// A program and its words, each as it stands: no shell reads them. Without a slash it is looked for in PATH.
using ProgramWords = std::vector<std::string>;
/// The same as somebody would type it.
[[nodiscard]] std::string shell_command(const ProgramWords& words);

class Child {
public:
    /// Starts `command` by the shell, in a process group of its own; its standard error is ours. EnvironmentError.
    Child(const std::string& command, ChildTerms terms);
    /// Starts a program so; what it writes on its standard error is part of its output.
    Child(const ProgramWords& program, ChildTerms terms);
    /// Closes its input, which tells it to end, and ends it with a signal where it does not within a second; and what
    /// else is left in its group.
    ~Child();
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;

    /// A line of its output, without the line's end. EnvironmentError where there is none in time, or where it is
    /// longer than 4096 bytes.
    std::string read_line();
    /// Writes all of `request` while it reads exactly as much as `answer` holds; within the time limit together.
    void exchange(std::span<const std::byte> request, std::span<std::byte> answer);
    /// Reads exactly so much.
    void read(std::span<std::byte> answer);

    struct Ended {
        std::string output;
        int status;  ///< as waitpid tells it
    };
    /// Reads until its output and itself have ended, within the time limit together; what else it started ends, too.
    Ended read_to_end();

    /// What it is asked about from now on, for messages.
    void about(const std::string& what) { about_ = what; }
    /// EnvironmentError that begins with `who` of the terms, and says how the process ended where it did.
    [[noreturn]] void fail(const std::string& what);

private:
    using Clock = std::chrono::steady_clock;

    enum class Errors { ours, output };
    void start(ProgramWords words, Errors errors);
    void write_some(std::span<const std::byte>& request);
    /// How many bytes came; at least one.
    std::size_t read_some(std::span<std::byte> room);
    void wait_for(short events_of_input, Clock::time_point until, bool& can_write, bool& can_read);
    [[noreturn]] void fail_late();
    [[nodiscard]] std::string how_it_ended();

    std::string about_;
    ChildTerms terms_;
    int process_ = -1, input_ = -1, output_ = -1;
    bool output_ended_ = false;
};

}  // namespace lostbits::intersect::process
