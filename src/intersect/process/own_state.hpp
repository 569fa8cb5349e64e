// What foreign code in this process may change and must not: which process goes on, and what all threads share.
#pragma once

namespace lostbits::intersect::process {

/// Remembers the process, its working folder, its environment, its umask, its limits (`ulimit`) and what it does about
/// signals that ask it to stop. Before anything foreign is loaded; later calls change nothing.
void keep_own_state();

/// Whether it was called: whatever is odd from then on may be a library's doing.
[[nodiscard]] bool has_foreign_code() noexcept;

/// getenv of the environment that `keep_own_state` remembers, of the present one before: what a library sets decides
/// neither where the data lie nor what the picture module is.
[[nodiscard]] const char* own_environment(const char* name);

/// Whether this process is a copy (fork) of the one that `keep_own_state` remembers.
[[nodiscard]] bool is_a_copy() noexcept;

/// Before foreign code runs in this thread: a working folder that it changes is this thread's alone, where the system
/// allows that; the others may be opening files.
void give_thread_own_folder() noexcept;

/// After foreign code has returned: the working folder is set back. Where the code has made a copy of
/// the process and the copy returned, too, the copy ends here, with a line that begins with `who`: it would otherwise
/// measure and write as the process itself does. Nothing before `keep_own_state`. False where the code has closed
/// descriptors that are the process's own: results may be written to another file since.
[[nodiscard]] bool put_back_own_state(const char* who) noexcept;

/// Limits that foreign code has lowered are as they were: after a library was loaded, ten times a second, and before a
/// file is opened or written. Their name where the system refuses that (a hard limit can be lowered, and raised by root
/// alone), else null. Async-signal-safe.
const char* put_back_limits() noexcept;

/// After a library was loaded: also the umask, the mask of signals, and what SIGINT, SIGTERM and SIGHUP do. (A call to
/// the system for each of them after every batch of a thousand rays would be a tenth of a quick form's time.)
void put_back_after_loading() noexcept;

}  // namespace lostbits::intersect::process
