// Registry of the temporary files that this process is writing, which a signal handler can read.
#include "output/file/atomic_file.hpp"

#include <poll.h>
#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <mutex>
#include <new>

#include "number/error.hpp"

namespace lostbits::output::file {
namespace {

// A signal handler may not lock or allocate, so the registry is a list of arrays that only grows. The thread or handler
// that sets a slot to null owns its string from then on. The handler never frees a string: it leaks, but the process is
// about to end.
struct Slots {
    std::array<std::atomic<char*>, 1024> names{};
    std::atomic<Slots*> next{nullptr};
};
Slots first_slots;
// Threads read and free names under this mutex. The handler frees no name and does not lock the mutex.
std::mutex names_mutex;
std::atomic<void (*)(const char*) noexcept> partial_listener{nullptr};
static_assert(std::atomic<char*>::is_always_lock_free && std::atomic<Slots*>::is_always_lock_free);

std::atomic<int> threads_creating{0};
std::atomic<bool> is_process_ending{false};

/// Calls `use` on each slot until a call returns true. Returns false if none does.
template <class Use>
bool any_slot(const Use& use) {
    for (Slots* block = &first_slots; block != nullptr; block = block->next.load()) {
        if (std::any_of(block->names.begin(), block->names.end(), use)) return true;
    }
    return false;
}

void add_slots() {
    auto new_block = std::make_unique<Slots>();
    for (Slots* block = &first_slots;;) {
        Slots* next = nullptr;
        if (block->next.compare_exchange_strong(next, new_block.get())) break;
        block = next;
    }
    static_cast<void>(new_block.release());  // lives as long as the process
}

}  // namespace

CreationGuard::CreationGuard() {
    sigset_t all_signals;
    sigfillset(&all_signals);
    pthread_sigmask(SIG_BLOCK, &all_signals, &previous_mask_);
    ++threads_creating;
    if (!is_process_ending) return;
    end_creation();
    throw Interrupted();
}
CreationGuard::~CreationGuard() { end_creation(); }

void CreationGuard::end_creation() noexcept {
    --threads_creating;
    pthread_sigmask(SIG_SETMASK, &previous_mask_, nullptr);
}

std::atomic<char*>* register_partial_file(const std::string& partial) {
    char* const name = ::strdup(partial.c_str());
    if (name == nullptr) throw std::bad_alloc();

    std::atomic<char*>* free_slot = nullptr;
    const auto take_slot = [&](std::atomic<char*>& slot) {
        char* expected = nullptr;
        if (!slot.compare_exchange_strong(expected, name)) return false;
        free_slot = &slot;
        return true;
    };
    while (!any_slot(take_slot)) add_slots();

    if (const auto listener = partial_listener.load()) listener(name);
    return free_slot;
}

bool unregister_partial_file(std::atomic<char*>* slot) noexcept {
    const std::lock_guard lock(names_mutex);
    char* name = slot->exchange(nullptr);
    std::free(name);
    return name != nullptr;
}

bool is_being_written(const std::string& prefix, std::size_t letter_count) {
    const std::lock_guard lock(names_mutex);
    return any_slot([&](const std::atomic<char*>& slot) {
        const char* const name = slot.load();
        return name != nullptr && std::strncmp(name, prefix.c_str(), prefix.size()) == 0 &&
               std::strlen(name) == prefix.size() + letter_count;
    });
}

void remove_partial_files() noexcept {
    const int saved_errno = errno;
    is_process_ending = true;
    // Waits at most a second: a forked copy of the process has the count but not the thread.
    for (int k = 0; k < 1000 && threads_creating > 0; ++k) ::poll(nullptr, 0, 1);
    any_slot([](std::atomic<char*>& slot) {
        if (const char* const name = slot.exchange(nullptr)) ::unlink(name);
        return false;
    });
    errno = saved_errno;
}

void listen_to_partial_files(void (*listener)(const char*) noexcept) noexcept { partial_listener = listener; }

}  // namespace lostbits::output::file
