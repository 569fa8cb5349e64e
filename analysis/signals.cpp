#include "signals.hpp"

#include <unistd.h>

#include <csignal>

#include "number/interruption.hpp"
#include "output/file/atomic_file.hpp"

namespace lostbits::analysis {
namespace {

void on_signal(int) {
    if (!asked_to_stop.exchange(true)) return;
    output::file::remove_partial_files();
    _exit(static_cast<int>(Exit::interrupted));
}

}  // namespace

void install_signal_handlers() {
    struct sigaction action {};
    action.sa_handler = on_signal;
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGXCPU}) sigaction(signal, &action, nullptr);
    output::file::ignore_file_size_signal();
}

}  // namespace lostbits::analysis
