// The temporary files that this process is writing: what a signal handler removes. Of atomic_file.cpp alone.
#pragma once

#include <csignal>

#include <atomic>
#include <cstddef>
#include <string>

namespace lostbits::output::file {

/// While one lives, its thread runs no signal handler, and one that removes the files waits for it: a file that is
/// created just behind the handler's back would stay (a run ended by SIGSEGV left one). Throws Interrupted where the
/// files have been removed.
class Creation {
public:
    Creation();
    ~Creation();
    Creation(const Creation&) = delete;
    Creation& operator=(const Creation&) = delete;

private:
    void leave() noexcept;
    sigset_t before_{};
};

/// Puts a name where a signal handler finds it.
std::atomic<char*>* register_partial(const std::string& partial);
/// True when this thread took the name back, false when a signal handler did (and removed the file).
bool unregister_partial(std::atomic<char*>* slot) noexcept;
/// Whether a file of that prefix, with so many letters behind it, is being written.
bool is_live(const std::string& prefix, std::size_t letters);

}  // namespace lostbits::output::file
