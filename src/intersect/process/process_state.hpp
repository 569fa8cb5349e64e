// State of the process that foreign code must not change, although it can: the process itself, and all that its threads
// share.
#pragma once

namespace lostbits::intersect::process {

/// Remembers the process, its working folder, its environment, its umask, its limits (`ulimit`) and its handling of
/// stop signals. Call it before any foreign code is loaded; later calls have no effect.
void save_process_state();

/// True if `save_process_state` was called: from then on a foreign library may be the cause of a fault.
[[nodiscard]] bool has_foreign_code() noexcept;

/// getenv in the environment that `save_process_state` remembers, or in the current environment before that call. So a
/// variable that a library sets decides neither where the data lie nor which file the picture module is.
[[nodiscard]] const char* own_environment(const char* name);

/// True if this process is a copy (fork) of the process that `save_process_state` remembers.
[[nodiscard]] bool is_forked_copy() noexcept;

/// Makes the working folder private to this thread, if the system allows that: other threads may be opening files. Call
/// it before foreign code runs in this thread.
void make_working_folder_private() noexcept;

/// Restores the working folder. Call it after foreign code has returned. If the code has made a copy of the process and
/// the copy returned too, the copy ends here, with a line that begins with `who`: otherwise the copy would measure and
/// write as the process itself does. Has no effect before `save_process_state`. Returns false if the code has closed
/// descriptors of the process: since then results may have been written to another file.
[[nodiscard]] bool restore_process_state(const char* who) noexcept;

/// Restores limits that foreign code has lowered: after a library was loaded, ten times a second, and before a file is
/// opened or written. Returns the name of a limit if the system refuses to restore it (everybody can lower a hard
/// limit, but only root can raise it), else null. Async-signal-safe.
const char* restore_limits() noexcept;

/// Restores also the umask, the mask of signals, and the handling of SIGINT, SIGTERM and SIGHUP. Call it after a
/// library was loaded. (One system call for each of these after every batch of a thousand rays would take a tenth of a
/// quick form's time.)
void restore_after_loading() noexcept;

}  // namespace lostbits::intersect::process
