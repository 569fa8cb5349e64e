// What happens on Ctrl-C: the run stops at the next safe point, and nothing half-written stays.
#pragma once

namespace lostbits::analysis {

/// SIGINT, SIGTERM, SIGHUP (a closed terminal) and SIGXCPU ask the run to stop; a second one removes partial files and
/// leaves at once. A write past the file-size limit fails instead of killing the process.
void install_signal_handlers();

}  // namespace lostbits::analysis
