// `lostbits offsets` from the outside.
#include <map>
#include <regex>

#include "catch.hpp"
#include "program.hpp"

namespace test_offsets {

using namespace lostbits::test;

namespace {

/// Colours of the lines of a plot by their names in the legend, where the sample of a line follows its name.
std::map<std::string, std::string> colours_of(const std::string& svg) {
    static const std::regex entry(R"re(>([\w-]+)</text>\n<path fill="none" stroke="(#\w+)")re");
    std::map<std::string, std::string> colours;
    for (std::sregex_iterator at(svg.begin(), svg.end(), entry), end; at != end; ++at) colours[(*at)[1]] = (*at)[2];
    return colours;
}

}  // namespace

TEST_CASE("a strategy has the same colour in the plots of wrong rays and of sizes") {
    draw_pictures();
    const Scratch scratch;
    must("offsets near-benign --size 12x9 --along distance --points computed --figure svg" + into(scratch));
    const std::string stem = "out/near-benign/along.distance.sphere.half_b.f32.computed.inside.";
    const auto wrong = colours_of(contents(scratch / (stem + "wrong.svg"))),
               sizes = colours_of(contents(scratch / (stem + "size.svg")));
    std::size_t shared = 0;
    for (const auto& [name, colour] : sizes) {
        const auto other = wrong.find(name);
        if (other == wrong.end()) continue;  // it shares a line there
        INFO(name);
        CHECK(other->second == colour);
        ++shared;
    }
    CHECK(shared >= 4);
}

}  // namespace test_offsets
