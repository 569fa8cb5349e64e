#include "intersect/doors/guard.hpp"

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

namespace lostbits::intersect::doors {
namespace {

using Clock = std::chrono::steady_clock;

/// Read by signal handlers and by the thread that watches; kept for good.
const GuardTerms usual_terms;
std::atomic<const GuardTerms*> terms_now{&usual_terms};
const GuardTerms& terms() { return *terms_now.load(); }

/// What the watching thread sees of a call. More calls at once than places go unwatched.
struct Slot {
    std::atomic<const char*> who{nullptr};
    std::atomic<Clock::rep> since{0};
};
std::array<Slot, 256> slots;
/// Read by signal handlers: constant initialisation, so that no access of theirs is the first.
constinit thread_local std::atomic<const char*> inside{nullptr};
static_assert(std::atomic<const char*>::is_always_lock_free);

/// The probe that asks, whichever thread does; null where none does.
std::atomic<const char*> probe{nullptr};

/// What libraries do to how the processor computes, by who does.
struct Notes {
    std::mutex lock;
    std::map<std::string, std::string> all;
};
/// Kept for good: what runs when the program ends may add to it.
Notes& notes() {
    static auto* const kept = new Notes;
    return *kept;
}

/// With write(2) alone: a signal handler may not allocate.
void say(const char* who, const char* what, const char* remedy) {
    const char* const asked = probe.load();
    for (const char* part : {"lostbits: ", who, asked ? ", in the probe \"" : "", asked ? asked : "", asked ? "\"" : "",
                             ": ", what, "; ", remedy, "\n"}) {
        if (write(STDERR_FILENO, part, std::strlen(part)) < 0) return;
    }
}

/// A copy of the process that foreign code made has no files of its own.
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

constexpr const char* try_child = "try --isolate, which runs it in a process of its own, or a debugger";

const char* crash_of(int signal) {
    switch (signal) {
        case SIGSEGV: return "crashed: it read or wrote memory that is not its own (SIGSEGV), or used up its stack";
        case SIGBUS: return "crashed: it read memory that is not there (SIGBUS)";
        case SIGFPE: return "crashed: an integer division by zero, or it had floating-point exceptions trap (SIGFPE)";
        case SIGILL: return "crashed: an instruction that this processor does not have (SIGILL)";
        default: return "gave up: it called abort(), or an assertion failed there (SIGABRT)";
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
        end(who, "called exit()", "a form returns, with an error text where it cannot answer");
}

/// So that a stack that is used up can still be told. Its end gives the thread back what it had: a signal would run on
/// memory that is freed, and the address sanitizer frees what it finds there at the end of a thread.
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

/// Names who it was as well as it can be known: somebody who is inside now.
void put_back_limits(const char* who) {
    const char* const refused = process::put_back_limits();
    if (refused == nullptr) return;
    for (const Slot& slot : slots)
        if (who == nullptr) who = slot.who.load();
    const std::string what = std::string("lowers a hard limit of the program, ") + refused;
    end(who != nullptr ? who : "a library", what.c_str(), try_child);
}

/// After a call, where the last look is a while ago: what is printed next may go to a file.
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
                end(who, "has not answered a batch within the time limit", "raise --time-limit SECONDS, or mend it");
        }
    }
}

}  // namespace

InForeignCode::InForeignCode(const char* who, const process::FloatingPoint& computes)
    : who_(who), outer_(inside.load()), before_(process::FloatingPoint::current()), computes_(computes) {
    have_signal_stack();
    process::give_thread_own_folder();
    inside = who;
    computes.set();
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
        end(who_, "closes descriptors that are the program's own", "close what you opened, each by its number");
    put_back_limits_at_times(who_);
    const auto left = process::FloatingPoint::current();
    before_.set();
    if (left != computes_)
        note_change(who_, "changes in a call how the processor computes (" +
                              (left.words().empty() ? "back to the usual" : left.words()) +
                              "), which is undone after each; call fegetenv before and fesetenv after");
    inside = outer_;
    if (slot_ >= 0) slots[static_cast<std::size_t>(slot_)].who.store(nullptr);
}

AsksInProbe::AsksInProbe(const char* name) { probe = name; }
AsksInProbe::~AsksInProbe() {
    probe = nullptr;
    put_back_limits(nullptr);  // nobody times a probe, and what is said of it may go to a file
}

LoadsForeignCode::~LoadsForeignCode() {
    computes_.set();
    process::put_back_after_loading();
    put_back_limits(foreign_code_here());
    uselocale(LC_GLOBAL_LOCALE);
    std::locale::global(std::locale::classic());  // that of C, too
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

}  // namespace lostbits::intersect::doors
