// Code that is not ours runs in this process: when it crashes, hangs or ends the program, someone is told who it was.
#pragma once

#include <string>

namespace lostbits::intersect::doors {

/// While one lives, this thread is inside of foreign code. `who` outlives it.
class InForeignCode {
public:
    explicit InForeignCode(const char* who);
    ~InForeignCode();
    InForeignCode(const InForeignCode&) = delete;
    InForeignCode& operator=(const InForeignCode&) = delete;

private:
    int slot_;
};

/// While one lives, this thread loads foreign code or asks for its list. A locale that is set there is set back: in one
/// of a decimal comma strtod() would read 0.5 as 0, and %g would write it as two cells of a table.
class LoadsForeignCode {
public:
    explicit LoadsForeignCode(const char* who) : inside_(who) {}
    ~LoadsForeignCode();
    LoadsForeignCode(const LoadsForeignCode&) = delete;
    LoadsForeignCode& operator=(const LoadsForeignCode&) = delete;

private:
    InForeignCode inside_;
};

struct GuardTerms {
    double seconds = 30;  ///< that one batch may take
    /// Called before the program ends for a fault of foreign code; from a signal handler.
    void (*clean_up)() = nullptr;
    void (*ends_with)(int status) = nullptr;  ///< the same, after the words about it, where there are any
};

/// From now on a signal of a crash inside of foreign code, a call of exit() there and a batch that takes too long end
/// the program with a line that names it and what to try, and with Exit::environment. Other crashes stay what they
/// were.
void guard_foreign_code(const GuardTerms& terms);

}  // namespace lostbits::intersect::doors
