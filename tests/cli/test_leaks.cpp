// Commands of every kind under LeakSanitizer, which is preloaded into the program as it ships. tests/leak_sanitizer.txt
// lists the leaks that it ignores, with the reason.
#include <cstdlib>

#include "catch.hpp"
#include "program.hpp"

namespace test_leaks {

using namespace lostbits::test;

namespace {

constexpr int leaks = 23;

std::string leak_environment(const std::string& exceptions) {
    return std::string("LD_PRELOAD='") + LOSTBITS_LEAK_SANITIZER + "' LSAN_OPTIONS=exitcode=" + std::to_string(leaks) +
           ":suppressions='" + exceptions + "'";
}

}  // namespace

TEST_CASE("no command leaks memory except for the listed reasons") {
    const Scratch scratch;
    scratch.write("mine.toml", good_scene);
    scratch.write("rays.csv", "ox,oy,oz,dx,dy,dz,hit,t\n0,0,-5,0,0,1,1,4\n");
    const std::string library = std::string(" --plugin ") + LOSTBITS_LIBRARIES + "/schoolbook.so";
    for (const std::string& words :
         {std::string("list forms"), std::string("map mine.toml -i sphere.press -f f32 --pixels csv --exr -o map"),
          std::string("explain near-benign --pixel 16,12 -i sphere.schoolbook -f f32"),
          std::string("sweep sphere-tilt -i sphere.press -f f32 --seeds 0 --steps 5 -o sweep"),
          std::string("judge rays.csv --sphere 0,0,0,1 -i sphere.press -o judge"),
          std::string("check --filter 'float.*'"),
          std::string("report mine.toml -i sphere.press -f f32 --no-claims -o page"),
          "map mine.toml -i example.schoolbook -f f32 -o plugin" + library,
          "map mine.toml -i example.schoolbook -f f32 -o alone --isolate" + library}) {
        const auto r = must(words, scratch.path(), leak_environment(LOSTBITS_LEAK_EXCEPTIONS));
        CHECK_FALSE(has(r.err, "detected memory leaks"));  // with a library, the checking process is not the ending one
    }
    // The leaks are found, and only the list suppresses them.
    const std::string lost = leak_environment("/dev/null") + " '" + LOSTBITS_LEAKING + "' 2>/dev/null";
    CHECK(WEXITSTATUS(std::system(lost.c_str())) == leaks);
    CHECK(has(run("map mine.toml -i example.schoolbook -f f32 -o again" + library, scratch.path(),
                  leak_environment("/dev/null"))
                  .err,
              "detected memory leaks"));
}

}  // namespace test_leaks
