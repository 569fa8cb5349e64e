// The README and docs/sweep.md show what the tool makes now: the committed pictures and the
// table are made again and compared.

#include "catch.hpp"
#include "counts.hpp"
#include "output/image/image.hpp"
#include "program.hpp"

namespace test_readme {

using namespace lostbits::test;

TEST_CASE("the picture and the table of the README are what the program makes") {
    draw_pictures();
    const Scratch scratch;
    must("map rtg-fig-7-3-4100-oblique" + into(scratch, ""));
    const auto made = scratch / "rtg-fig-7-3-4100-oblique";
    const fs::path kept = LOSTBITS_REPORTS_DIR "/readme";
    CHECK(contents(made / "summary.csv") == contents(kept / "summary.csv"));
    auto& backend = lostbits::output::image::image_backend();
    const auto now = backend.read_png(made / "contact.png"), then = backend.read_png(kept / "contact.png");
    CHECK(now.width == then.width);
    CHECK(now.height == then.height);
    // Pixels, not bytes: another zlib packs the same picture differently.
    CHECK((now.pixels == then.pixels));

    if (!is_long()) return;  // 8 s
    must("sweep sphere-distance -f f32" + into(scratch, ""));
    const auto plot = backend.read_png(scratch / "sphere-distance/lost_bits_p50.f32.png"),
               kept_plot = backend.read_png(kept / "lost_bits_p50.f32.png");
    CHECK((plot.pixels == kept_plot.pixels));
}

TEST_CASE("the scene of the README can be mapped as it stands there") {
    const std::string readme = contents(LOSTBITS_REPORTS_DIR "/../README.md");
    const auto begin = readme.find("```toml\n") + 8;
    REQUIRE(begin != std::string::npos + 8);
    const Scratch scratch;
    const std::string file = scratch.write("mine.toml", readme.substr(begin, readme.find("```", begin) - begin));
    must("map '" + file + "' --size 24x24 -i sphere.press -f f32" + into(scratch, ""));
    CHECK(std::stod(read_csv(scratch / "mine/summary.csv").front().at("agree_hit")) > 100);
}

}  // namespace test_readme
