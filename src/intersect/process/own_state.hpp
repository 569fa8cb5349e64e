// Process state that foreign code may change and must not: the identity of the process, and what all threads share.
#pragma once

namespace lostbits::intersect::process {

/// Remembers the process, its working folder, its environment, its umask, its limits (`ulimit`) and its handling of
/// stop signals. Call it before anything foreign is loaded; later calls change nothing.
void keep_own_state();

/// True if it was called: from then on a library may be the cause of anything odd.
[[nodiscard]] bool has_foreign_code() noexcept;

/// getenv in the environment that `keep_own_state` remembers, or in the present one before that call. So a variable
/// that a library sets decides neither where the data lie nor what the picture module is.
[[nodiscard]] const char* own_environment(const char* name);

/// True if this process is a copy (fork) of the one that `keep_own_state` remembers.
[[nodiscard]] bool is_a_copy() noexcept;

/// Call before foreign code runs in this thread. It makes the working folder private to this thread, if the system
/// allows that: other threads may be opening files.
void give_thread_own_folder() noexcept;

/// Call after foreign code has returned. Restores the working folder. If the code has made a copy of the process and
/// the copy returned too, the copy ends here, with a line that begins with `who`: otherwise it would measure and write
/// as the process itself does. Does nothing before `keep_own_state`. False if the code has closed descriptors that are
/// the process's own: since then results may have been written to another file.
[[nodiscard]] bool put_back_own_state(const char* who) noexcept;

/// Restores limits that foreign code has lowered: after a library was loaded, ten times a second, and before a file is
/// opened or written. Returns the name of a limit if the system refuses that (a hard limit can be lowered by anybody,
/// but raised only by root), else null. Async-signal-safe.
const char* put_back_limits() noexcept;

/// Call after a library was loaded: restores also the umask, the mask of signals, and the handling of SIGINT, SIGTERM
/// and SIGHUP. (One system call for each of them after every batch of a thousand rays would be a tenth of a quick
/// form's time.)
void put_back_after_loading() noexcept;

}  // namespace lostbits::intersect::process
