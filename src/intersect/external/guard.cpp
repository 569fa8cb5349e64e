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

#include "intersect/process/process_state.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::external {
namespace {

using Clock = std::chrono::steady_clock;

/// The options are read by signal handlers and by the watching thread, and therefore never freed.
const GuardOptions default_options;
std::atomic<const GuardOptions*> current_options{&default_options};
const GuardOptions& options() { return *current_options.load(); }

/// A running call as the watching thread sees it. If more calls run at once than fit in the array, the rest are not
/// watched.
struct WatchedCall {
    std::atomic<const char*> who{nullptr};
    std::atomic<Clock::rep> start_time{0};
};
std::array<WatchedCall, 256> watched_calls;
/// Name of the foreign code that runs in this thread. Signal handlers read it, so it is initialised at compile
/// time: a lazy initialisation could otherwise run inside a handler.
constinit thread_local std::atomic<const char*> running_code{nullptr};
static_assert(std::atomic<const char*>::is_always_lock_free);

/// Name of the running probe, whichever thread runs it; null if none runs.
std::atomic<const char*> running_probe{nullptr};

/// Changes of the processor's state, by the name of the library or form that made them.
struct StateChanges {
    std::mutex lock;
    std::map<std::string, std::string> by_name;
};
/// Never destroyed: exit handlers may add to it.
StateChanges& state_changes() {
    static auto* const instance = new StateChanges;
    return *instance;
}

/// Prints a message by write(2) alone, since a signal handler may not allocate.
void print_message(const char* who, const char* problem, const char* remedy) {
    const char* const probe_name = running_probe.load();
    for (const char* part : {"lostbits: ", who, probe_name ? ", in the probe \"" : "", probe_name ? probe_name : "",
                             probe_name ? "\"" : "", ": ", problem, "; ", remedy, "\n"}) {
        if (write(STDERR_FILENO, part, std::strlen(part)) < 0) return;
    }
}

/// Removes unfinished files. A copy of the process (fork) that foreign code made leaves them: they are not its own.
void clean_up() {
    if (options().clean_up && !process::is_forked_copy()) options().clean_up();
}

[[noreturn]] void exit_program(ExitStatus status) {
    if (options().exit_with) options().exit_with(static_cast<int>(status));
    _exit(static_cast<int>(status));
}

[[noreturn]] void end_with_message(const char* who, const char* problem, const char* remedy) {
    clean_up();
    print_message(who, problem, remedy);
    exit_program(ExitStatus::environment);
}

constexpr const char* isolation_advice = "try --isolate, which runs it in a separate process, or a debugger";

const char* crash_text(int signal) {
    switch (signal) {
        case SIGSEGV: return "crashed: it read or wrote memory that is not its own (SIGSEGV), or used up its stack";
        case SIGBUS: return "crashed: it accessed memory that does not exist (SIGBUS)";
        case SIGFPE: return "crashed: it divided an integer by zero, or had enabled floating-point traps (SIGFPE)";
        case SIGILL: return "crashed: it used an instruction that this processor does not have (SIGILL)";
        default: return "gave up: it called abort(), or an assertion failed (SIGABRT)";
    }
}

void on_crash(int signal) {
    if (const char* const who = running_code.load()) end_with_message(who, crash_text(signal), isolation_advice);
    clean_up();
    ::signal(signal, SIG_DFL);
    raise(signal);
}

void report_exit_inside() {
    if (const char* const who = running_code.load())
        end_with_message(who, "called exit()", "a form must return, with an error text if it cannot answer");
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
        sigaltstack(&stack, &stack_before_);
    }
    ~SignalStack() { sigaltstack(&stack_before_, nullptr); }
    SignalStack(const SignalStack&) = delete;
    SignalStack& operator=(const SignalStack&) = delete;

private:
    static constexpr std::size_t size = 64 * 1024;
    std::unique_ptr<char[]> memory_;
    stack_t stack_before_{};
};

void set_up_signal_stack() { thread_local const SignalStack signal_stack; }

/// Restores lowered limits; ends the program if the system refuses. If `who` is null, the message names some code that
/// is running now, which need not be the code that lowered the limit.
void restore_limits_or_end(const char* who) {
    const char* const lowered_limit = process::restore_limits();
    if (lowered_limit == nullptr) return;
    for (const WatchedCall& call : watched_calls)
        if (who == nullptr) who = call.who.load();
    const std::string problem = std::string("lowered a hard limit of the program, ") + lowered_limit;
    end_with_message(who != nullptr ? who : "a library", problem.c_str(), isolation_advice);
}

/// Restores limits after a call, at most every 50 ms: the next output may go to a file, whose size may be limited.
void restore_limits_sometimes(const char* who) {
    static std::atomic<Clock::rep> last_check{0};
    const auto now = Clock::now().time_since_epoch();
    if (now - Clock::duration(last_check.load(std::memory_order_relaxed)) < std::chrono::milliseconds(50)) return;
    last_check.store(now.count(), std::memory_order_relaxed);
    restore_limits_or_end(who);
}

/// Ends the program if a call runs for too long: beyond the time limit, or beyond a second after an interrupt.
void end_if_overdue(const char* who, std::chrono::duration<double> duration) {
    if (options().stop.is_requested() && duration.count() > 1) {
        clean_up();
        print_message(who, "was interrupted in the middle of a batch", "finished files are kept");
        exit_program(ExitStatus::interrupted);
    }
    if (duration.count() > options().seconds)
        end_with_message(who, "has not answered a batch within the time limit",
                         "raise --time-limit SECONDS, or check the code for an endless loop");
}

[[noreturn]] void watch_over_calls() {
    for (;;) {
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        restore_limits_or_end(nullptr);
        const auto now = Clock::now().time_since_epoch().count();
        for (const WatchedCall& call : watched_calls)
            if (const char* const who = call.who.load())
                end_if_overdue(who, Clock::duration(now - call.start_time.load()));
    }
}

}  // namespace

ForeignCodeScope::ForeignCodeScope(const char* who, const process::FloatingPointState& fp_state)
    : who_(who),
      outer_code_(running_code.load()),
      state_before_(process::FloatingPointState::current()),
      fp_state_(fp_state) {
    set_up_signal_stack();
    process::make_working_folder_private();
    running_code = who;
    fp_state.apply();

    // Takes a free slot for the watching thread, if there is one.
    const auto now = Clock::now().time_since_epoch().count();
    for (std::size_t i = 0; i < watched_calls.size(); ++i) {
        const char* no_code = nullptr;
        if (watched_calls[i].who.load(std::memory_order_relaxed) != nullptr) continue;
        watched_calls[i].start_time.store(now);
        if (!watched_calls[i].who.compare_exchange_strong(no_code, who)) continue;
        slot_ = static_cast<int>(i);
        return;
    }
}

ForeignCodeScope::~ForeignCodeScope() {
    if (!process::restore_process_state(who_))
        end_with_message(who_, "closed descriptors that are the program's own",
                         "close only what it opened, each descriptor by its number");
    restore_limits_sometimes(who_);

    const auto state_after = process::FloatingPointState::current();
    state_before_.apply();
    if (state_after != fp_state_)
        note_change(who_,
                    "changes how the processor computes during a call (" +
                        (state_after.differences().empty() ? "back to the standard state" : state_after.differences()) +
                        "); lostbits undoes that after each call; let the code call fegetenv first and fesetenv "
                        "last");

    running_code = outer_code_;
    if (slot_ >= 0) watched_calls[slot_].who.store(nullptr);
}

ProbeScope::ProbeScope(const char* name) { running_probe = name; }
ProbeScope::~ProbeScope() {
    running_probe = nullptr;
    restore_limits_or_end(nullptr);  // every time, as probes are not timed: the report may go to a file
}

ForeignLoadScope::~ForeignLoadScope() {
    fp_state_.apply();
    process::restore_after_loading();
    restore_limits_or_end(running_foreign_code());
    uselocale(LC_GLOBAL_LOCALE);
    std::locale::global(std::locale::classic());  // sets the C locale, too
}

void note_change(const std::string& who, const std::string& change) {
    const std::scoped_lock lock(state_changes().lock);
    state_changes().by_name.try_emplace(who, change);
}

std::vector<std::string> noted_changes() {
    const std::scoped_lock lock(state_changes().lock);
    std::vector<std::string> sentences;
    for (const auto& [who, change] : state_changes().by_name) sentences.push_back(who + ": " + change);
    return sentences;
}

std::string find_noted_change(const std::string& who) {
    const std::scoped_lock lock(state_changes().lock);
    const auto entry = state_changes().by_name.find(who);
    return entry == state_changes().by_name.end() ? "" : entry->second;
}

const char* running_foreign_code() noexcept { return running_code.load(); }

void guard_foreign_code(const GuardOptions& new_options) {
    static bool is_guarding = false;
    static std::deque<GuardOptions> all_options;
    current_options = &all_options.emplace_back(new_options);
    if (is_guarding) return;
    is_guarding = true;
    process::save_process_state();

    struct sigaction action {};
    action.sa_handler = on_crash;
    action.sa_flags = SA_ONSTACK;
    for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) sigaction(signal, &action, nullptr);
    std::atexit(report_exit_inside);
    std::thread(watch_over_calls).detach();
}

}  // namespace lostbits::intersect::external
