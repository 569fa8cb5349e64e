// Sets up the process before anything else: its standard streams, its signal handlers, and a second process that waits
// for it. The second process is needed because foreign code in this one can end it with any status.
#pragma once

#include <string>

#include "intersect/process/stop_token.hpp"

namespace lostbits::analysis::shell {

/// Opens /dev/null in place of a standard input, output or error that is closed. Otherwise the next file of the run
/// would get descriptor 1 or 2, and messages would be written into it. The input is opened for writing and the outputs
/// for reading, so that reading a closed input or writing to a closed output still fails and is reported.
void open_standard_streams();

/// Installs the signal handlers.
///   - SIGINT, SIGTERM, SIGHUP (a closed terminal) and SIGXCPU ask the run to stop at the next safe point, by
///     `stop_by_signal`. A second one removes partial files and ends the process at once.
///   - Every other signal that ends a process removes partial files first.
///   - A signal that was ignored at the start (`nohup`, a background job of a script) stays ignored. A signal that
///     already has a handler (of a sanitizer) keeps it.
///   - A write past the file-size limit fails instead of killing the process.
void install_signal_handlers();

/// The token that such a signal sets. It stops all work of the program.
intersect::process::StopToken stop_by_signal();

/// Splits the program in two processes, once. The call returns in the worker, which does the work; the supervisor waits
/// for the worker and never returns. Call it before any thread is started. The supervisor
///   - exits with the status that `report_status` was given;
///   - if the worker ends without a status, in any way: says so, names `libraries`, removes partial files and exits
///     with ExitStatus::environment;
///   - passes on signals that are sent to it alone;
///   - kills processes that the worker left behind;
///   - waits at most `seconds` for destructors after the work.
/// It protects from accidents only: code that looks for the pipe between the two can write to it.
void supervise(const std::string& libraries, double seconds);

/// Reports to the supervisor, if there is one, that the work ends now with this status and that all messages are
/// printed. Async-signal-safe.
void report_status(int status) noexcept;
/// Reports an uncaught exception to the supervisor. Its status replaces a status that was reported before. The
/// supervisor prints the message. Returns false if there is no supervisor.
bool report_uncaught_exception(int status) noexcept;

/// True if the signal was passed on by the supervisor. A signal that was sent to both processes arrives twice.
[[nodiscard]] bool is_from_supervisor(int sender) noexcept;

}  // namespace lostbits::analysis::shell
