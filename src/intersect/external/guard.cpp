#include "intersect/external/guard.hpp"

#include <locale.h>
#include <signal.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <locale>
#include <map>
#include <memory>
#include <mutex>
#include <thread>

#include "intersect/process/own_state.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::external {
namespace {

using Clock = std::chrono::steady_clock;

/// Read by signal handlers and by the watching thread, and therefore never freed.
const GuardTerms usual_terms;
std::atomic<const GuardTerms*> terms_now{&usual_terms};
const GuardTerms& terms() { return *terms_now.load(); }

/// A running call as the watching thread sees it. If there are more calls at once than slots, the rest go unwatched.
struct Slot {
    std::atomic<const char*> who{nullptr};
    std::atomic<Clock::rep> since{0};
};
std::array<Slot, 256> slots;
/// Name of the foreign code that runs in this thread. Signal handlers read it, so it is initialised at compile
/// time: a lazy initialisation could otherwise run inside a handler.
constinit thread_local std::atomic<const char*> inside{nullptr};
static_assert(std::atomic<const char*>::is_always_lock_free);

/// Name of the running probe, whichever thread runs it; null if none runs.
std::atomic<const char*> probe{nullptr};

/// Changes of the processor's state, by the library or form that makes them.
struct Notes {
    std::mutex lock;
    std::map<std::string, std::string> all;
};
/// Never destroyed: exit handlers may add to it.
Notes& notes() {
    static auto* const kept = new Notes;
    return *kept;
}

/// Prints a message by write(2) alone, since a signal handler may not allocate.
void say(const char* who, const char* what, const char* remedy) {
    const char* const asked = probe.load();
    for (const char* part : {"lostbits: ", who, asked ? ", in the probe \"" : "", asked ? asked : "", asked ? "\"" : "",
                             ": ", what, "; ", remedy, "\n"}) {
        if (write(STDERR_FILENO, part, std::strlen(part)) < 0) return;
    }
}

/// Removes unfinished files. A copy of the process (fork) that foreign code made leaves them: they are not its own.
void clean_up() {
    if (terms().clean_up && !process::is_a_copy()) terms().clean_up();
}

[[noreturn]] void leave(Exit code) {
    if (terms().ends_with) terms().ends_with(static_cast<int>(code));
    _exit(static_cast<int>(code));
}

[[noreturn]] void end(const char* who, const char* what, const char* remedy) {
    clean_up();
    say(who, what, remedy);
    leave(Exit::environment);
}

constexpr const char* try_child = "try --isolate, which runs it in a separate process, or a debugger";

const char* crash_of(int signal) {
    switch (signal) {
        case SIGSEGV: return "crashed: it read or wrote memory that is not its own (SIGSEGV), or used up its stack";
        case SIGBUS: return "crashed: it accessed memory that does not exist (SIGBUS)";
        case SIGFPE: return "crashed: it divided an integer by zero, or had enabled floating-point traps (SIGFPE)";
        case SIGILL: return "crashed: it used an instruction that this processor does not have (SIGILL)";
        default: return "gave up: it called abort(), or an assertion failed (SIGABRT)";
    }
}

void on_crash(int signal) {
    if (const char* const who = inside.load()) end(who, crash_of(signal), try_child);
    clean_up();
    ::signal(signal, SIG_DFL);
    raise(signal);
}

void on_exit_inside() {
    if (const char* const who = inside.load())
        end(who, "called exit()", "a form must return, with an error text if it cannot answer");
}

/// A separate stack for signal handlers, so that a stack overflow can still be reported. The destructor restores the
/// thread's earlier signal stack for two reasons: a later signal would run on freed memory, and the address sanitizer
/// frees the signal stack that it finds at the end of a thread.
class SignalStack {
public:
    SignalStack() : memory_(std::make_unique<char[]>(size)) {
        stack_t stack{};
        stack.ss_sp = memory_.get();
        stack.ss_size = size;
        sigaltstack(&stack, &before_);
    }
    ~SignalStack() { sigaltstack(&before_, nullptr); }
    SignalStack(const SignalStack&) = delete;
    SignalStack& operator=(const SignalStack&) = delete;

private:
    static constexpr std::size_t size = 64 * 1024;
    std::unique_ptr<char[]> memory_;
    stack_t before_{};
};

void have_signal_stack() { thread_local const SignalStack here; }

/// Restores lowered limits; ends the program if the system refuses. If `who` is null, the message names some code that
/// runs now, which need not be the culprit.
void put_back_limits(const char* who) {
    const char* const refused = process::put_back_limits();
    if (refused == nullptr) return;
    for (const Slot& slot : slots)
        if (who == nullptr) who = slot.who.load();
    const std::string what = std::string("lowered a hard limit of the program, ") + refused;
    end(who != nullptr ? who : "a library", what.c_str(), try_child);
}

/// Restores limits after a call, at most every 50 ms: the next output may go to a file, whose size may be limited.
void put_back_limits_at_times(const char* who) {
    static std::atomic<Clock::rep> looked{0};
    const auto now = Clock::now().time_since_epoch();
    if (now - Clock::duration(looked.load(std::memory_order_relaxed)) < std::chrono::milliseconds(50)) return;
    looked.store(now.count(), std::memory_order_relaxed);
    put_back_limits(who);
}

[[noreturn]] void watch_over_calls() {
    for (;;) {
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        put_back_limits(nullptr);
        const auto now = Clock::now().time_since_epoch().count();
        for (const Slot& slot : slots) {
            const char* const who = slot.who.load();
            if (who == nullptr) continue;
            const std::chrono::duration<double> taken = Clock::duration(now - slot.since.load());
            if (terms().stop.is_asked() && taken.count() > 1) {
                clean_up();
                say(who, "was interrupted in the middle of a batch", "finished files are kept");
                leave(Exit::interrupted);
            }
            if (taken.count() > terms().seconds)
                end(who, "has not answered a batch within the time limit",
                    "raise --time-limit SECONDS, or check the code for an endless loop");
        }
    }
}

}  // namespace

InForeignCode::InForeignCode(const char* who, const process::FloatingPoint& fp_state)
    : who_(who), outer_(inside.load()), before_(process::FloatingPoint::current()), fp_state_(fp_state) {
    have_signal_stack();
    process::give_thread_own_folder();
    inside = who;
    fp_state.set();
    const auto now = Clock::now().time_since_epoch().count();
    for (std::size_t i = 0; i < slots.size(); ++i) {
        const char* nobody = nullptr;
        if (slots[i].who.load(std::memory_order_relaxed) != nullptr) continue;
        slots[i].since.store(now);
        if (!slots[i].who.compare_exchange_strong(nobody, who)) continue;
        slot_ = static_cast<int>(i);
        return;
    }
}

InForeignCode::~InForeignCode() {
    if (!process::put_back_own_state(who_))
        end(who_, "closed descriptors that are the program's own",
            "close only what it opened, each descriptor by its number");
    put_back_limits_at_times(who_);
    const auto left = process::FloatingPoint::current();
    before_.set();
    if (left != fp_state_)
        note_change(who_, "changes how the processor computes during a call (" +
                              (left.differences().empty() ? "back to the standard state" : left.differences()) +
                              "); lostbits undoes that after each call; let the code call fegetenv first and fesetenv "
                              "last");
    inside = outer_;
    if (slot_ >= 0) slots[static_cast<std::size_t>(slot_)].who.store(nullptr);
}

ProbeScope::ProbeScope(const char* name) { probe = name; }
ProbeScope::~ProbeScope() {
    probe = nullptr;
    put_back_limits(nullptr);  // every time, as probes are not timed: the report may go to a file
}

LoadsForeignCode::~LoadsForeignCode() {
    fp_state_.set();
    process::put_back_after_loading();
    put_back_limits(foreign_code_here());
    uselocale(LC_GLOBAL_LOCALE);
    std::locale::global(std::locale::classic());  // sets the C locale, too
}

void note_change(const std::string& who, const std::string& what) {
    const std::scoped_lock lock(notes().lock);
    notes().all.try_emplace(who, what);
}

std::vector<std::string> changes_noted() {
    const std::scoped_lock lock(notes().lock);
    std::vector<std::string> sentences;
    for (const auto& [who, what] : notes().all) sentences.push_back(who + ": " + what);
    return sentences;
}

std::string change_noted(const std::string& who) {
    const std::scoped_lock lock(notes().lock);
    const auto found = notes().all.find(who);
    return found == notes().all.end() ? "" : found->second;
}

const char* foreign_code_here() noexcept { return inside.load(); }

void guard_foreign_code(const GuardTerms& wanted) {
    static bool on = false;
    static std::deque<GuardTerms> kept;
    terms_now = &kept.emplace_back(wanted);
    if (on) return;
    on = true;
    process::keep_own_state();
    struct sigaction action {};
    action.sa_handler = on_crash;
    action.sa_flags = SA_ONSTACK;
    for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) sigaction(signal, &action, nullptr);
    std::atexit(on_exit_inside);
    std::thread(watch_over_calls).detach();
}

}  // namespace lostbits::intersect::external
