// Code that is not ours runs in this process: when it crashes, hangs or ends the program, someone is told who it was.
#pragma once

#include <string>
#include <vector>

#include "intersect/process/floating_point.hpp"
#include "intersect/process/stop_token.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::doors {

/// While one lives, this thread is inside of foreign code, and computes as that code's users have it. One may live
/// inside of another. Afterwards the thread computes as before; where the code left something else, that is noted (see
/// `changes_noted`). `who` outlives it.
class InForeignCode {
public:
    explicit InForeignCode(const char* who,
                           const process::FloatingPoint& computes = process::FloatingPoint::standard());
    ~InForeignCode();
    InForeignCode(const InForeignCode&) = delete;
    InForeignCode& operator=(const InForeignCode&) = delete;

private:
    int slot_ = -1;
    const char *who_, *outer_;
    process::FloatingPoint before_, computes_;
};

/// While one lives, this thread loads foreign code or asks for its list. What it sets there for the process is set
/// back: a locale (in one of a decimal comma strtod() would read 0.5 as 0, and %g would write it as two cells of a
/// table), and how the processor computes, which `left` tells until the end.
class LoadsForeignCode {
public:
    /// `computes`: what loading the library left, where that is over.
    explicit LoadsForeignCode(const char* who,
                              const process::FloatingPoint& computes = process::FloatingPoint::standard())
        : inside_(who, computes), computes_(computes) {}
    ~LoadsForeignCode();
    LoadsForeignCode(const LoadsForeignCode&) = delete;
    LoadsForeignCode& operator=(const LoadsForeignCode&) = delete;

    /// How this thread computes now.
    [[nodiscard]] static process::FloatingPoint left() { return process::FloatingPoint::current(); }

private:
    InForeignCode inside_;
    process::FloatingPoint computes_;
};

/// While one lives, what ends the program in foreign code is said to be in the probe of that name, which outlives it.
class AsksInProbe {
public:
    explicit AsksInProbe(const char* name);
    ~AsksInProbe();
    AsksInProbe(const AsksInProbe&) = delete;
    AsksInProbe& operator=(const AsksInProbe&) = delete;
};

/// `call` of foreign code through a C interface, from which nothing may be thrown. EnvironmentError, which begins with
/// `who`, where something is.
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

/// Notes what `who` does to how the processor computes; of each the first is kept. A call that leaves another state
/// than it found is noted by its guard.
void note_change(const std::string& who, const std::string& what);
/// The sentences, which begin with `who`.
std::vector<std::string> changes_noted();
/// What is noted of it; empty where nothing is.
std::string change_noted(const std::string& who);

/// Who runs in this thread, for messages; null where no foreign code does.
const char* foreign_code_here() noexcept;

struct GuardTerms {
    double seconds = 30;  ///< that one batch may take
    /// Where it is asked, the program ends as soon as a batch has taken a second: nothing in there would look.
    process::StopToken stop = {};
    /// Called before the program ends for a fault of foreign code; from a signal handler.
    void (*clean_up)() = nullptr;
    void (*ends_with)(int status) = nullptr;  ///< the same, after the words about it, where there are any
};

/// From now on a signal of a crash inside of foreign code, a call of exit() there and a batch that takes too long end
/// the program with a line that names it and what to try, and with Exit::environment. Other crashes stay what they
/// were. A call cannot be ended without the process: other runs in it end with theirs, or wait for the batch.
void guard_foreign_code(const GuardTerms& terms);

}  // namespace lostbits::intersect::doors
