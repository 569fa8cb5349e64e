// Errors that end a run without a result: one type each, with the exit status that a shell sees.
#pragma once

#include <stdexcept>
#include <string>

namespace lostbits {

/// Exit status of the program. A script can tell "the answer is no" from "the input was wrong".
enum class ExitStatus : int {
    done = 0,              ///< done, and every selected claim holds
    answer_is_no = 1,      ///< done, and a claim failed or a difference was found
    bad_input = 2,         ///< wrong usage, or a file with wrong contents
    environment = 3,       ///< unwritable file, full disk, missing library or CPU feature
    nothing_selected = 4,  ///< a glob or filter that matches nothing
    unproved = 5,          ///< done, but the truth of some rays could not be proved
    internal = 70,         ///< a bug in lostbits
    interrupted = 130,     ///< a signal stopped the run; finished files are kept
};

/// An error that a person reads: what is wrong, why, and what to try.
class Error : public std::runtime_error {
public:
    Error(ExitStatus status, const std::string& message) : std::runtime_error(message), status_(status) {}
    [[nodiscard]] ExitStatus status() const noexcept { return status_; }

private:
    ExitStatus status_;
};

/// Bad input; `message` starts with `file:line:col:` if a file caused it.
struct InputError : Error {
    explicit InputError(const std::string& message) : Error(ExitStatus::bad_input, message) {}
};

/// The machine prevents the run: an unwritable folder, a full disk, a missing module.
struct EnvironmentError : Error {
    explicit EnvironmentError(const std::string& message) : Error(ExitStatus::environment, message) {}
};

/// A selection that matches nothing.
struct NothingSelected : Error {
    explicit NothingSelected(const std::string& message) : Error(ExitStatus::nothing_selected, message) {}
};

/// A request to stop the run, see intersect/process/stop_token.hpp.
struct Interrupted : Error {
    Interrupted() : Error(ExitStatus::interrupted, "interrupted") {}
};

}  // namespace lostbits
