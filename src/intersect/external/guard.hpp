// Guards foreign code in this process: if it crashes, hangs or ends the program, a message names it.
#pragma once

#include <string>
#include <vector>

#include "intersect/process/floating_point.hpp"
#include "intersect/process/stop_token.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::external {

/// While a guard lives, this thread is inside foreign code, and its floating-point state is the one in which the users
/// of that code compute. Guards may be nested. The destructor restores the earlier state. If the code left another
/// state, the change is noted (see `noted_changes`). `who`, the name of the code for messages, must outlive the guard.
class ForeignCodeScope {
public:
    explicit ForeignCodeScope(const char* who,
                              const process::FloatingPointState& fp_state = process::FloatingPointState::standard());
    ~ForeignCodeScope();
    ForeignCodeScope(const ForeignCodeScope&) = delete;
    ForeignCodeScope& operator=(const ForeignCodeScope&) = delete;

private:
    int slot_ = -1;
    const char *who_, *outer_code_;
    process::FloatingPointState state_before_, fp_state_;
};

/// While a guard lives, this thread loads foreign code or calls the function that returns its list. The guard restores
/// what the code sets for the process: the locale (with a decimal comma, strtod() would read 0.5 as 0, and %g would
/// write it as two cells of a table), and the floating-point state, which `current_state` returns until the
/// guard ends.
class ForeignLoadScope {
public:
    /// `fp_state` is the state that the loading of the library left, if the library is already loaded.
    explicit ForeignLoadScope(const char* who,
                              const process::FloatingPointState& fp_state = process::FloatingPointState::standard())
        : inside_(who, fp_state), fp_state_(fp_state) {}
    ~ForeignLoadScope();
    ForeignLoadScope(const ForeignLoadScope&) = delete;
    ForeignLoadScope& operator=(const ForeignLoadScope&) = delete;

    /// Returns the current floating-point state of this thread.
    [[nodiscard]] static process::FloatingPointState current_state() { return process::FloatingPointState::current(); }

private:
    ForeignCodeScope inside_;
    process::FloatingPointState fp_state_;
};

/// While this object lives, a message about foreign code that ends the program names this probe. The name must outlive
/// it.
class ProbeScope {
public:
    explicit ProbeScope(const char* name);
    ~ProbeScope();
    ProbeScope(const ProbeScope&) = delete;
    ProbeScope& operator=(const ProbeScope&) = delete;
};

/// Runs `call`, which calls foreign code through a C interface and must not throw. Throws EnvironmentError, which
/// begins with `who`, if the code throws.
template <class Call>
auto call_foreign(const char* who, Call&& call) {
    try {
        return call();
    } catch (const Error&) {
        throw;
    } catch (...) {
        throw EnvironmentError(std::string(who) +
                               ": threw an exception through its C interface; catch it there and return its text");
    }
}

/// Notes how `who` changes the floating-point state of the processor; only the first change of each library or form is
/// kept. `ForeignCodeScope` notes a call that does not restore the state.
void note_change(const std::string& who, const std::string& change);
/// Returns the noted changes as sentences that begin with the name of the library or form.
std::vector<std::string> noted_changes();
/// Returns the change noted for one library or form; empty if no change was noted.
std::string find_noted_change(const std::string& who);

/// Name of the foreign code that runs in this thread, for messages; null if no foreign code runs in it.
const char* running_foreign_code() noexcept;

struct GuardOptions {
    double seconds = 30;  ///< limit for one batch
    /// If a stop is requested, the program ends as soon as a batch has taken a second, since foreign code does not
    /// check for a stop.
    process::StopToken stop = {};
    /// Called, possibly from a signal handler, before the program ends for a fault of foreign code.
    void (*clean_up)() = nullptr;
    void (*exit_with)(int status) = nullptr;  ///< called last, with the exit status, before the program ends for a
                                              ///< fault of foreign code
};

/// Guards foreign code from now on. A crash signal inside foreign code, a call of exit() there, or a batch that takes
/// too long ends the program with ExitStatus::environment and a line that names the code and what to try. Other crashes
/// are not changed. A call cannot be ended without the process, so other runs in the process end too, or wait for the
/// batch.
void guard_foreign_code(const GuardOptions& options);

}  // namespace lostbits::intersect::external
