// The schoolbook formula in a library that sets the user's locale for the whole program: when it is loaded, and when it
// is asked for its forms.
#include <clocale>
#include <cstdlib>
#include <cstring>
#include <locale>

#define lostbits_forms schoolbook_forms
#include "schoolbook.cpp"
#undef lostbits_forms

namespace {

/// Ends the program if the test's locale with a decimal comma is missing: otherwise nothing would be tested.
bool take_locale() {
    std::locale::global(std::locale(""));
    const char* const wanted = std::getenv("LC_ALL");
    const bool comma = std::strcmp(std::localeconv()->decimal_point, ",") == 0;
    if (comma != (wanted != nullptr && std::strncmp(wanted, "de_DE", 5) == 0)) std::abort();
    return comma;
}

const bool when_loaded = take_locale();

}  // namespace

extern "C" __attribute__((visibility("default"))) const lb_form* lostbits_forms(int abi, std::size_t* count) {
    take_locale();
    return schoolbook_forms(abi, count);
}
