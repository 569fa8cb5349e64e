// Guards foreign code in this process: if it crashes, hangs or ends the program, a message names it.
#pragma once

#include <string>
#include <vector>

#include "intersect/process/floating_point.hpp"
#include "intersect/process/stop_token.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::external {

/// While one lives, this thread is inside foreign code and computes as that code's users have it. Guards may be nested.
/// Afterwards the thread computes as before; if the code left another state, that is noted (see `changes_noted`). `who`
/// outlives it.
class InForeignCode {
public:
    explicit InForeignCode(const char* who,
                           const process::FloatingPoint& fp_state = process::FloatingPoint::standard());
    ~InForeignCode();
    InForeignCode(const InForeignCode&) = delete;
    InForeignCode& operator=(const InForeignCode&) = delete;

private:
    int slot_ = -1;
    const char *who_, *outer_;
    process::FloatingPoint before_, fp_state_;
};

/// While one lives, this thread loads foreign code or asks for its list. It restores what that code sets for the
/// process: the locale (with a decimal comma, strtod() would read 0.5 as 0, and %g would write it as two cells of a
/// table), and how the processor computes, which `left` returns until the end.
class LoadsForeignCode {
public:
    /// `fp_state`: the state that loading the library left, if loading is over.
    explicit LoadsForeignCode(const char* who,
                              const process::FloatingPoint& fp_state = process::FloatingPoint::standard())
        : inside_(who, fp_state), fp_state_(fp_state) {}
    ~LoadsForeignCode();
    LoadsForeignCode(const LoadsForeignCode&) = delete;
    LoadsForeignCode& operator=(const LoadsForeignCode&) = delete;

    /// How this thread computes now.
    [[nodiscard]] static process::FloatingPoint left() { return process::FloatingPoint::current(); }

private:
    InForeignCode inside_;
    process::FloatingPoint fp_state_;
};

/// While one lives, a message about foreign code that ends the program names this probe. The name outlives it.
class ProbeScope {
public:
    explicit ProbeScope(const char* name);
    ~ProbeScope();
    ProbeScope(const ProbeScope&) = delete;
    ProbeScope& operator=(const ProbeScope&) = delete;
};

/// Runs `call` of foreign code through a C interface, from which nothing may be thrown. EnvironmentError, which begins
/// with `who`, if something is.
template <class Call>
auto call_of(const char* who, Call&& call) {
    try {
        return call();
    } catch (const Error&) {
        throw;
    } catch (...) {
        throw EnvironmentError(std::string(who) +
                               ": threw an exception through its C interface; catch it there and return its text");
    }
}

/// Notes how `who` changes the state of the processor; the first change of each is kept. The guard of a call notes a
/// call that leaves another state than it found.
void note_change(const std::string& who, const std::string& what);
/// The notes, as sentences that begin with `who`.
std::vector<std::string> changes_noted();
/// The note about one library or form; empty if there is none.
std::string change_noted(const std::string& who);

/// Name of the foreign code that runs in this thread, for messages; null if there is none.
const char* foreign_code_here() noexcept;

struct GuardTerms {
    double seconds = 30;  ///< limit for one batch
    /// If a stop is requested, the program ends as soon as a batch has taken a second: foreign code does not check for
    /// it.
    process::StopToken stop = {};
    /// Called from a signal handler, before the program ends for a fault of foreign code.
    void (*clean_up)() = nullptr;
    void (*ends_with)(int status) = nullptr;  ///< the same, after the message about the fault, if there is one
};

/// Guards foreign code from now on. A crash signal inside foreign code, a call of exit() there, or a batch that takes
/// too long ends the program with Exit::environment and a line that names the code and what to try. Other crashes are
/// not changed. A call cannot be ended without the process: other runs in it end too, or wait for the batch.
void guard_foreign_code(const GuardTerms& terms);

}  // namespace lostbits::intersect::external
