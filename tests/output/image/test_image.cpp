#include <sys/resource.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <set>

#include "catch.hpp"
#include "number/error.hpp"
#include "output/helpers.hpp"
#include "output/image/image.hpp"

namespace test_image {

using namespace lostbits;
using namespace lostbits::output;
using namespace lostbits::output::image;
using namespace lostbits::output::test;

TEST_CASE("a full disk stops a PNG file and leaves nothing", "[png]") {
    const Scratch folder;
    backend();  // loaded here: the child must not start it under the limit
    std::mt19937 random(5);
    std::vector<std::uint32_t> noise(1024 * 16);
    for (auto& n : noise) n = static_cast<std::uint32_t>(random());
    const auto attempt = [&](rlim_t limit_bytes) {
        return in_child([&] {
            file::ignore_file_size_signal();
            const rlimit limit{limit_bytes, limit_bytes};
            ::setrlimit(RLIMIT_FSIZE, &limit);
            try {
                auto out = backend().open_png(folder / "a.png", 1024, 160);
                const std::span<const Rgb8> rows(reinterpret_cast<const Rgb8*>(noise.data()), 1024 * 16);
                for (int y = 0; y < 160; y += 16) out->write_rows(16, rows);
                out->close();
            } catch (const EnvironmentError& error) {
                const std::string why = error.what();
                return why.find(": cannot write: File too large; free space") != std::string::npos ? 1 : 2;
            }
            return 0;
        });
    };
    // In the header, in the pixels, and within the buffer's last flush.
    for (const rlim_t limit : {rlim_t{100}, rlim_t{300000}, rlim_t{480000}}) {
        CHECK(attempt(limit) == 1);
        CHECK(folder.entries() == 0);
    }
    CHECK(attempt(RLIM_INFINITY) == 0);
    CHECK(folder.entries() == 1);
}

TEST_CASE("a PNG file reads back, and its bytes are reproducible", "[png]") {
    const Scratch folder;
    std::vector<Rgb8> pixels(50 * 30);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        pixels[i] = {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i / 7),
                     static_cast<std::uint8_t>(255 - i)};
    }
    for (const auto* name : {"a.png", "b.png"}) {
        auto png = backend().open_png(folder / name, 50, 30);
        png->write_rows(10, std::span(pixels).first(500));
        png->write_rows(20, std::span(pixels).subspan(500));
        CHECK_FALSE(fs::exists(folder / name));
        png->close();
    }
    const PngImage back = backend().read_png(folder / "a.png");
    CHECK(back.width == 50);
    CHECK(back.height == 30);
    CHECK((back.pixels == pixels));
    CHECK(contents(folder / "a.png") == contents(folder / "b.png"));
    CHECK_THROWS_AS(backend().read_exr(folder / "a.png"), InputError);
    CHECK_THROWS_AS(backend().read_exr(folder / "none.exr"), InputError);
}

TEST_CASE("drawn text keeps its baseline, measures its spaces and accepts any byte", "[text]") {
    const TextBitmap a = backend().render_text("ag|", 16);
    const TextBitmap b = backend().render_text("x", 16);
    CHECK(a.height == b.height);
    CHECK(a.baseline == b.baseline);
    CHECK(a.width > b.width);
    CHECK(std::ranges::count(b.coverage, 255) > 0);
    CHECK(backend().render_text("x ", 16).width > b.width);
    CHECK(backend().render_text("x", 16, FontWeight::bold).coverage != b.coverage);
    CHECK(backend().render_text("\xFF", 16).coverage == backend().render_text("?", 16).coverage);
    CHECK(backend().render_text("x\xC3\xFFy", 16).coverage == backend().render_text("x??y", 16).coverage);
    CHECK(backend().render_text("", 16).width == 0);
    // No letter touches the upper or lower edge of the line box, or is cut at its sides.
    for (char c = '!'; c <= '~'; ++c) {
        const TextBitmap t = backend().render_text(std::string("n") + c + "n", 18);
        INFO(c);
        const auto w = static_cast<std::size_t>(t.width);
        CHECK(std::ranges::count(std::span(t.coverage).last(w), 0) == t.width);
        CHECK(std::ranges::count(std::span(t.coverage).first(w), 0) == t.width);
    }
}

TEST_CASE("letters beyond ASCII are drawn, and a box where the font lacks one", "[text]") {
    std::set<std::vector<std::uint8_t>> seen;
    const std::vector<const char*> letters{"?", "e", "é", "×", "°", "²", "≤", "−", "…", "→", "θ", "ä", "\xE7\x90\x83"};
    for (const char* letter : letters) {
        const TextBitmap drawn = backend().render_text(letter, 16);
        INFO(letter);
        CHECK(std::ranges::any_of(drawn.coverage, [](std::uint8_t c) { return c > 200; }));
        CHECK(seen.insert(drawn.coverage).second);
    }
    // DejaVu Sans has no ideographs: they are one box.
    CHECK(backend().render_text("\xE7\x90\x83", 16).coverage == backend().render_text("\xE4\xBA\xBA", 16).coverage);
    CHECK(backend().render_text("2²", 16).width ==
          backend().render_text("2", 16).width + backend().render_text("²", 16).width);
}

TEST_CASE("exponents are raised within the line, and names of forms and files are unchanged", "[text]") {
    for (const int size : {9, 11, 13, 18}) {
        INFO(size);
        const auto drawn = [size](const char* text) { return backend().render_text(text, size); };
        const TextBitmap power = drawn("2^-10"), flat = drawn("2-10");
        CHECK(power.height == flat.height);
        CHECK(power.baseline == flat.baseline);
        // One `^` less, and smaller letters where there are any.
        CHECK(power.width < drawn("2^").width + drawn("-10").width);
        CHECK((power.width < flat.width || size == 9));
        const auto ink_between = [&](const TextBitmap& text, int from, int to) {
            const auto first = text.coverage.begin() + std::ptrdiff_t{from} * text.width;
            return std::accumulate(first, text.coverage.begin() + std::ptrdiff_t{to} * text.width, 0);
        };
        // Nothing but the 2 stands on the baseline, and nothing is cut off at the top.
        CHECK(ink_between(power, power.baseline - 2, power.baseline) ==
              ink_between(drawn("2"), power.baseline - 2, power.baseline));
        const auto flat_width = [&](std::string_view text) {
            int sum = 0;
            for (const char c : text) sum += drawn(std::string(1, c).c_str()).width;
            return sum;
        };
        for (const char* number : {"[-2^10", "from 10^3 on", "2^0.5)", "2^10-3"}) {
            INFO(number);
            CHECK(drawn(number).width < flat_width(number));
        }
        // Bases other than 2 and 10, and parts of names, have no exponent.
        for (const char* name : {"a^2", "12^2", "a/2^3", "rays-2^10", "2^10.csv", "2^3rd", "r^2 - l^2", "^10"}) {
            INFO(name);
            CHECK(drawn(name).width == flat_width(name));
        }
        CHECK(drawn("box.a^box.b").width == drawn("box.a").width + drawn("^").width + drawn("box.b").width);
        // A full stop stands on the line, and so does the text after a number.
        CHECK(drawn("2^10.").width == drawn("2^10").width + drawn(".").width);
        CHECK(drawn("2^10-3").width == drawn("2^10").width + drawn("-3").width);
        CHECK(drawn("^").width > 0);
        CHECK(drawn("^-").width == drawn("^").width + drawn("-").width);
    }
}

TEST_CASE("a line of text may be longer than any picture", "[text]") {
    const TextBitmap text = backend().render_text(std::string(9000, 'W'), 16);
    CHECK(text.width > 30000);
    CHECK(text.coverage.size() == static_cast<std::size_t>(text.width) * static_cast<std::size_t>(text.height));
}

// Hidden, because it needs a process in which no test has loaded the module yet. The next test starts one.
TEST_CASE("a missing image module says what to do in a child process", "[.missing_module]") {
    std::string text;
    try {
        static_cast<void>(image_backend());
    } catch (const EnvironmentError& error) {
        text = error.what();
    }
    CHECK(text.find("/nonexistent/lostbits_image.so: cannot load") != std::string::npos);
    CHECK(text.find("libopenimageio") != std::string::npos);
    CHECK(text.find("lostbits_image`") != std::string::npos);
}

TEST_CASE("a missing image module says what to do", "[image]") {
    const std::string program = fs::read_symlink("/proc/self/exe").string();
    const std::string tail = "' '[.missing_module]' >/dev/null 2>&1";
    CHECK(std::system(("LOSTBITS_IMAGE_MODULE=/nonexistent/lostbits_image.so '" + program + tail).c_str()) == 0);
    CHECK(std::system(("LOSTBITS_IMAGE_MODULE=/dev/null '" + program + tail).c_str()) != 0);
}

}  // namespace test_image
