// The ways a run can end without an answer, one type each, with the exit code a shell sees.
#pragma once

#include <stdexcept>
#include <string>

namespace lostbits {

/// Exit codes of the program: a script tells "the answer is no" from "the question was wrong".
enum class Exit : int {
    done = 0,              ///< done, and every selected claim holds
    answer_is_no = 1,      ///< done, and a claim failed or a difference was found
    bad_input = 2,         ///< usage, or a file that does not say what it should
    environment = 3,       ///< unwritable file, full disk, missing library or CPU feature
    nothing_selected = 4,  ///< a glob or filter that matches nothing
    internal = 70,         ///< a fault of ours, or a reference that did not converge
    interrupted = 130,     ///< a signal stopped the run; finished files are kept
};

/// An error that a person reads: what is wrong, why, and what to try.
class Error : public std::runtime_error {
public:
    Error(Exit code, const std::string& message) : std::runtime_error(message), code_(code) {}
    [[nodiscard]] Exit code() const noexcept { return code_; }

private:
    Exit code_;
};

/// Bad input; `message` starts with `file:line:col:` where a file is to blame.
struct InputError : Error {
    explicit InputError(const std::string& message) : Error(Exit::bad_input, message) {}
};

/// The machine is in the way: a folder that cannot be written, a full disk, a missing module.
struct EnvironmentError : Error {
    explicit EnvironmentError(const std::string& message) : Error(Exit::environment, message) {}
};

/// A selection that selects nothing.
struct NothingSelected : Error {
    explicit NothingSelected(const std::string& message) : Error(Exit::nothing_selected, message) {}
};

/// Somebody asked the run to stop, see intersect/process/stop_token.hpp.
struct Interrupted : Error {
    Interrupted() : Error(Exit::interrupted, "interrupted") {}
};

}  // namespace lostbits
