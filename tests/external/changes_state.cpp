// The schoolbook formula in a library that changes how the processor computes. CHANGES says which state it changes.
// WHEN says at which time: when it is loaded, when it is asked for its forms, in every call, or in a thread of its own.
#include <sys/syscall.h>
#include <unistd.h>
#include <xmmintrin.h>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <thread>

#define lostbits_forms schoolbook_forms
#include "schoolbook.cpp"
#undef lostbits_forms

namespace {

bool is(const char* variable, const char* value) {
    const char* const said = std::getenv(variable);
    return said != nullptr && std::string(said) == value;
}

void change() {
    unsigned state = _mm_getcsr();
    if (is("CHANGES", "rounding")) state |= 0x4000U;  // up
    if (is("CHANGES", "flush")) state |= 0x8000U;
    if (is("CHANGES", "denormals")) state |= 0x0040U;
    _mm_setcsr(state);
    if (is("CHANGES", "x87")) {
        const std::uint16_t short_words = 0x007F;
        asm volatile("fldcw %0" : : "m"(short_words));
    }
}

const bool when_loaded = [] {
    if (is("WHEN", "load")) change();
    if (is("WHEN", "thread")) std::thread(change).join();
    return true;
}();

const lb_form* right_forms = nullptr;

template <std::size_t which>
const char* run_and_change(const lb_batch* batch) {
    if (is("WHEN", "call")) change();
    return right_forms[which].run(batch);
}

}  // namespace

// A thread pool calls this while it waits, if this library is preloaded.
extern "C" __attribute__((visibility("default"))) int sched_yield() noexcept {
    if (is("WHEN", "yield")) change();
    return static_cast<int>(syscall(SYS_sched_yield));
}

extern "C" __attribute__((visibility("default"))) const lb_form* lostbits_forms(int abi, std::size_t* count) {
    right_forms = schoolbook_forms(abi, count);
    if (right_forms == nullptr || *count != 2) return nullptr;
    if (is("WHEN", "list")) change();
    static std::array<lb_form, 2> forms{right_forms[0], right_forms[1]};
    forms[0].run = run_and_change<0>;
    forms[1].run = run_and_change<1>;
    return forms.data();
}
