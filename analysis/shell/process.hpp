// What the process settles with the system before anything else: its streams, what signals do, and a second process
// that waits for it: foreign code that runs in this one can end it with any status.
#pragma once

#include <string>

#include "intersect/process/stop_token.hpp"

namespace lostbits::analysis::shell {

/// Opens what is closed of standard input, output and error on /dev/null. Otherwise the next file of the run would be
/// descriptor 1 or 2, and messages would be written into it. Each is opened the other way round: reading a closed input
/// or writing to a closed output still fails, and is reported.
void open_standard_streams();

/// SIGINT, SIGTERM, SIGHUP (a closed terminal) and SIGXCPU ask the run to stop at the next safe point, by
/// `stop_by_signal`; a second one removes partial files and leaves at once. Every other signal that ends a process
/// removes them first. A signal that was ignored at the start (`nohup`, a job of a script in the background) stays
/// ignored, and one that somebody handles (a sanitizer) stays theirs. A write past the file-size limit fails instead of
/// killing the process.
void install_signal_handlers();

/// Asked by such a signal: of everything that the program does.
intersect::process::StopToken stop_by_signal();

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
