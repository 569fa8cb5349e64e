// Foreign code that runs in this process can end it with any status: the status of the program comes from another.
#pragma once

#include <string>

namespace lostbits::analysis::shell {

/// Divides the program in two, once: what returns is the process that does the work. The other waits for it, and never
/// returns. It hands on what `tell_status` was told; where the work ends without that, however it ends, it says so,
/// names `libraries`, removes half-written files and ends with Exit::environment. It hands on signals that are sent to
/// it alone, ends what processes are left behind, and waits at most `seconds` for destructors after the work. This is
/// against accidents: code that looks for the pipe between the two can write to it. Before there are threads.
void supervise(const std::string& libraries, double seconds);

/// To the waiting process, where there is one: the work ends now with this status, and what there was to say is said.
/// Async-signal-safe.
void tell_status(int status) noexcept;
/// An exception that nobody catches: the status, whatever was told before. The other process says so, if there is one.
bool tell_broken(int status) noexcept;

/// Whether a signal was handed on by the waiting process. One that was sent to both comes twice.
[[nodiscard]] bool is_from_supervisor(int sender) noexcept;

}  // namespace lostbits::analysis::shell
