// liblostbits.so from a C translation unit (client.c), and the symbols that the library exports.
#include <cstdio>
#include <string>

#include "catch.hpp"

extern "C" {
int client_maps_a_text(void);
int client_hears_what_is_wrong(void);
int client_measures_its_own_form(void);
int client_writes_operations(void);
int client_judges_arrays(void);
int client_gives_ranges_and_groups(void);
int client_judges_answers_about_a_mesh(void);
int client_asks_for_studies_and_a_choice(void);
int client_stops(void);
int client_runs_in_threads(void);
int client_forks(void);
}

namespace lostbits::test {

TEST_CASE("a C program maps a scene from text in memory", "[library]") { CHECK(client_maps_a_text() == 0); }
TEST_CASE("a C program gets error messages", "[library]") { CHECK(client_hears_what_is_wrong() == 0); }
TEST_CASE("a C program measures a form of its own", "[library]") { CHECK(client_measures_its_own_form() == 0); }
TEST_CASE("a form runs from the list of its operations", "[library]") { CHECK(client_writes_operations() == 0); }
TEST_CASE("arrays are judged in place", "[library]") { CHECK(client_judges_arrays() == 0); }
TEST_CASE("rays can have ranges and groups", "[library]") { CHECK(client_gives_ranges_and_groups() == 0); }
TEST_CASE("answers about a mesh can be judged", "[library]") { CHECK(client_judges_answers_about_a_mesh() == 0); }
TEST_CASE("studies and a choice by length run through the library", "[library]") {
    CHECK(client_asks_for_studies_and_a_choice() == 0);
}
TEST_CASE("a stopped call reports it, and the next one runs", "[library]") { CHECK(client_stops() == 0); }
TEST_CASE("several threads can map at the same time", "[library]") { CHECK(client_runs_in_threads() == 0); }

TEST_CASE("a forked process can map", "[library]") { CHECK(client_forks() == 0); }

TEST_CASE("the library exports the functions of lostbits.h and nothing else", "[library]") {
    FILE* const names = popen("nm -D --defined-only --format=posix '" LOSTBITS_LIBRARY "'", "r");
    REQUIRE(names != nullptr);
    std::size_t own = 0;
    char line[4096];
    while (std::fgets(line, sizeof line, names) != nullptr) {
        const std::string name(line, std::string(line).find(' '));
        INFO(name);
        // Symbols that templates of the standard library and of TBB make unique are visible however they are compiled.
        const bool templates = name.starts_with("_Z");
        CHECK((templates || name.starts_with("lostbits_")));
        own += name.starts_with("lostbits_");
    }
    CHECK(pclose(names) == 0);
    CHECK(own == 32);
}

}  // namespace lostbits::test
