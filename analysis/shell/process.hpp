// What the process settles with the system before anything else: its streams, and what signals do.
#pragma once

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

}  // namespace lostbits::analysis::shell
