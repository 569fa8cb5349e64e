#include <sys/resource.h>

#include <algorithm>
#include <bit>
#include <numeric>
#include <random>
#include <set>
#include <thread>

#include "catch.hpp"
#include "number/error.hpp"
#include "output/helpers.hpp"
#include "output/image/image.hpp"

namespace test_image {

using namespace lostbits;
using namespace lostbits::output;
using namespace lostbits::output::image;
using namespace lostbits::output::test;

namespace {

// In no order that a sort would give, and two types mixed.
const std::vector<output::image::Channel> channels{
    {"truth.hi", output::image::Channel::Type::f32},  {"class.value", output::image::Channel::Type::u32},
    {"R", output::image::Channel::Type::f32},         {"bits.lost", output::image::Channel::Type::f32},
    {"B", output::image::Channel::Type::f32},         {"G", output::image::Channel::Type::f32},
    {"object.id", output::image::Channel::Type::u32}, {"A.z", output::image::Channel::Type::f32},
};

constexpr int width = 37, height = 41;  // no multiple of the 16 rows of a ZIP block

/// Every pixel's four bytes: special values first, then random bits.
std::vector<std::uint32_t> make_samples() {
    std::vector<std::uint32_t> out(static_cast<std::size_t>(width * height) * channels.size());
    const std::uint32_t special[] = {0x00000000, 0x80000000, 0x7F800000, 0xFF800000, 0x7FC00000, 0xFFC00001,
                                     0x7F800001, 0x00000001, 0x807FFFFF, 0x3F800000, 0xFFFFFFFF, 0x7F7FFFFF};
    std::mt19937 random(3);
    for (std::size_t i = 0; i < out.size(); ++i) {
        const std::size_t pixel = i / channels.size();
        out[i] = pixel < std::size(special) ? special[pixel] : static_cast<std::uint32_t>(random());
    }
    return out;
}

void write_exr(const fs::path& path, const std::vector<std::uint32_t>& samples, std::initializer_list<int> steps) {
    auto exr = backend().open_exr(
        path, {width, height, channels, {{"lostbits:form", "sphere.schoolbook"}, {"lostbits:command", "map x"}}});
    const auto bytes = std::as_bytes(std::span(samples));
    const std::size_t row = static_cast<std::size_t>(width) * channels.size() * 4;
    int y = 0;
    for (const int rows : steps) {
        exr->write_rows(y, rows,
                        bytes.subspan(static_cast<std::size_t>(y) * row, static_cast<std::size_t>(rows) * row));
        y += rows;
    }
    exr->close();
}

std::uint32_t bits_at(const output::image::ExrChannel& channel, std::size_t i) {
    if (const auto* f = std::get_if<std::vector<float>>(&channel.samples)) return std::bit_cast<std::uint32_t>((*f)[i]);
    return std::get<std::vector<std::uint32_t>>(channel.samples)[i];
}

}  // namespace

TEST_CASE("what is written under a name reads back under it, bit for bit", "[exr]") {
    const Scratch folder;
    const auto samples = make_samples();
    write_exr(folder / "a.exr", samples, {1, 15, 20, 5});
    const output::image::ExrImage image = backend().read_exr(folder / "a.exr");
    REQUIRE(image.width == width);
    REQUIRE(image.height == height);
    REQUIRE(image.channels.size() == channels.size());
    for (std::size_t c = 0; c < channels.size(); ++c) {
        const output::image::ExrChannel* channel = image.find(channels[c].name);
        REQUIRE(channel != nullptr);
        CHECK((channel->samples.index() == 1) == (channels[c].type == output::image::Channel::Type::u32));
        std::size_t wrong = 0;
        for (std::size_t i = 0; i < static_cast<std::size_t>(width * height); ++i) {
            wrong += bits_at(*channel, i) != samples[i * channels.size() + c];
        }
        INFO(channels[c].name);
        CHECK(wrong == 0);
    }
    CHECK(image.find("no.such") == nullptr);
    const auto has = [&](const char* key, const char* value) {
        return std::ranges::count(image.attributes, std::pair<std::string, std::string>(key, value)) == 1;
    };
    CHECK(has("lostbits:form", "sphere.schoolbook"));
    CHECK(has("lostbits:command", "map x"));
    CHECK(has("compression", "zip"));
}

TEST_CASE("the same pixels give the same bytes, however they are cut into rows", "[exr]") {
    const Scratch folder;
    const auto samples = make_samples();
    write_exr(folder / "a.exr", samples, {41});
    std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // a date would differ now
    write_exr(folder / "b.exr", samples, {3, 3, 35});
    CHECK(contents(folder / "a.exr") == contents(folder / "b.exr"));
    const auto year = contents(folder / "a.exr").find("capDate");
    if (year != std::string::npos) {
        for (const auto& [key, value] : backend().read_exr(folder / "a.exr").attributes) {
            if (key == "DateTime") CHECK(value.empty());
        }
    }
}

TEST_CASE("an EXR appears only when closed, and rows must come in order", "[exr]") {
    const Scratch folder;
    const std::vector<std::uint32_t> row(4 * 2);
    const auto bytes = std::as_bytes(std::span(row));
    {
        auto exr = backend().open_exr(
            folder / "a.exr",
            {4, 2, {{"x.a", output::image::Channel::Type::f32}, {"x.b", output::image::Channel::Type::u32}}, {}});
        CHECK_THROWS_AS(exr->write_rows(1, 1, bytes), std::logic_error);
        CHECK_THROWS_AS(exr->write_rows(0, 2, bytes), std::logic_error);
        exr->write_rows(0, 1, bytes);
        CHECK_THROWS_AS(exr->close(), std::logic_error);
        CHECK_FALSE(fs::exists(folder / "a.exr"));
        CHECK(folder.entries() == 1);
    }
    CHECK(folder.entries() == 0);
    CHECK_THROWS_AS(backend().open_exr(folder / "a.exr", {4, 0, {{"x", {}}}, {}}), std::logic_error);
    CHECK_THROWS_AS(backend().open_exr(folder / "a.exr", {4, 4, {{"x", {}}, {"x", {}}}, {}}), std::logic_error);
    CHECK_THROWS_AS(backend().open_exr(folder.path(), {4, 4, {{"x", {}}}, {}}), EnvironmentError);
}

TEST_CASE("a full disk stops an EXR and a PNG, and nothing is left", "[exr][png]") {
    const Scratch folder;
    backend();  // loaded here: the child must not start it under the limit
    const auto attempt = [&](rlim_t limit_bytes, auto write) {
        return in_child([&] {
            lostbits::output::file::ignore_file_size_signal();
            const rlimit limit{limit_bytes, limit_bytes};
            ::setrlimit(RLIMIT_FSIZE, &limit);
            try {
                write();
            } catch (const EnvironmentError& error) {
                return std::string(error.what()).find(": cannot write: File too large; free space") != std::string::npos
                           ? 1
                           : 2;
            }
            return 0;
        });
    };
    std::mt19937 random(5);
    std::vector<std::uint32_t> noise(1024 * 16);
    for (auto& n : noise) n = static_cast<std::uint32_t>(random());
    const auto exr = [&] {
        auto out = backend().open_exr(folder / "a.exr", {1024, 160, {{"x", output::image::Channel::Type::u32}}, {}});
        for (int y = 0; y < 160; y += 16) out->write_rows(y, 16, std::as_bytes(std::span(noise)));
        out->close();
    };
    const auto png = [&] {
        auto out = backend().open_png(folder / "a.png", 1024, 160);
        const std::span<const Rgb8> row(reinterpret_cast<const output::image::Rgb8*>(noise.data()), 1024 * 16);
        for (int y = 0; y < 160; y += 16) out->write_rows(16, row);
        out->close();
    };
    // In the header, in the pixels, and within the buffer's last flush.
    for (const rlim_t limit : {rlim_t{100}, rlim_t{300000}, rlim_t{480000}}) {
        CHECK(attempt(limit, exr) == 1);
        CHECK(attempt(limit, png) == 1);
        CHECK(folder.entries() == 0);
    }
    CHECK(attempt(RLIM_INFINITY, exr) == 0);
    CHECK(attempt(RLIM_INFINITY, png) == 0);
    CHECK(folder.entries() == 2);
}

TEST_CASE("files are written from several threads at once", "[exr]") {
    const Scratch folder;
    const auto samples = make_samples();
    backend();
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t) {
        threads.emplace_back([&, t] {
            for (int i = 0; i < 5; ++i) {
                write_exr(folder / (std::to_string(t) + "-" + std::to_string(i)), samples, {41});
            }
        });
    }
    for (auto& thread : threads) thread.join();
    const std::string first = contents(folder / "0-0");
    CHECK(first.size() > 1000);
    for (const auto& entry : fs::directory_iterator(folder.path())) CHECK(contents(entry.path()) == first);
    CHECK(folder.entries() == 20);
}

TEST_CASE("other programs read the EXR", "[exr]") {
    INFO("oiiotool comes with openimageio-tools");
    REQUIRE(std::system("oiiotool --version >/dev/null 2>&1") == 0);
    const Scratch folder;
    write_exr(folder / "a.exr", make_samples(), {41});
    const std::string out = (folder / "info").string();
    REQUIRE(std::system(("oiiotool --info -v " + (folder / "a.exr").string() + " >" + out + " 2>&1").c_str()) == 0);
    const std::string info = contents(out);
    INFO(info);
    CHECK(info.find("37 x   41, 8 channel") != std::string::npos);
    CHECK(info.find("class.value (uint)") != std::string::npos);
    CHECK(info.find("half") == std::string::npos);
    CHECK(info.find("lostbits:form: \"sphere.schoolbook\"") != std::string::npos);
}

TEST_CASE("a PNG reads back and its bytes repeat", "[png]") {
    const Scratch folder;
    std::vector<output::image::Rgb8> pixels(50 * 30);
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
    const output::image::PngImage back = backend().read_png(folder / "a.png");
    CHECK(back.width == 50);
    CHECK(back.height == 30);
    CHECK((back.pixels == pixels));
    CHECK(contents(folder / "a.png") == contents(folder / "b.png"));
    CHECK_THROWS_AS(backend().read_exr(folder / "a.png"), InputError);
    CHECK_THROWS_AS(backend().read_exr(folder / "none.exr"), InputError);
}

TEST_CASE("text keeps its baseline, measures its spaces and survives any byte", "[text]") {
    const output::image::TextBitmap a = backend().render_text("ag|", 16);
    const output::image::TextBitmap b = backend().render_text("x", 16);
    CHECK(a.height == b.height);
    CHECK(a.baseline == b.baseline);
    CHECK(a.width > b.width);
    CHECK(std::ranges::count(b.coverage, 255) > 0);
    CHECK(backend().render_text("x ", 16).width > b.width);
    CHECK(backend().render_text("x", 16, true).coverage != b.coverage);
    CHECK(backend().render_text("\xFF", 16).coverage == backend().render_text("?", 16).coverage);
    CHECK(backend().render_text("x\xC3\xFFy", 16).coverage == backend().render_text("x??y", 16).coverage);
    CHECK(backend().render_text("", 16).width == 0);
    // No letter touches the upper or lower edge of the line box, or is cut at its sides.
    for (char c = '!'; c <= '~'; ++c) {
        const output::image::TextBitmap t = backend().render_text(std::string("n") + c + "n", 18);
        INFO(c);
        const auto w = static_cast<std::size_t>(t.width);
        CHECK(std::ranges::count(std::span(t.coverage).last(w), 0) == t.width);
        CHECK(std::ranges::count(std::span(t.coverage).first(w), 0) == t.width);
    }
}

TEST_CASE("letters beyond ASCII are themselves, and what the font lacks is a box", "[text]") {
    std::set<std::vector<std::uint8_t>> seen;
    const std::vector<const char*> letters{"?", "e", "é", "×", "°", "²", "≤", "−", "…", "→", "θ", "ä", "\xE7\x90\x83"};
    for (const char* letter : letters) {
        const output::image::TextBitmap drawn = backend().render_text(letter, 16);
        INFO(letter);
        CHECK(std::ranges::any_of(drawn.coverage, [](std::uint8_t c) { return c > 200; }));
        CHECK(seen.insert(drawn.coverage).second);
    }
    // DejaVu Sans has no ideographs: they are one box.
    CHECK(backend().render_text("\xE7\x90\x83", 16).coverage == backend().render_text("\xE4\xBA\xBA", 16).coverage);
    CHECK(backend().render_text("2²", 16).width ==
          backend().render_text("2", 16).width + backend().render_text("²", 16).width);
}

TEST_CASE("exponents are raised within the line box, and the names of forms stay as they are", "[text]") {
    for (const int size : {9, 11, 13, 18}) {
        INFO(size);
        const auto drawn = [size](const char* text) { return backend().render_text(text, size); };
        const output::image::TextBitmap power = drawn("2^-10"), flat = drawn("2-10");
        CHECK(power.height == flat.height);
        CHECK(power.baseline == flat.baseline);
        // One `^` less, and smaller letters where there are any.
        CHECK(power.width < drawn("2^").width + drawn("-10").width);
        CHECK((power.width < flat.width || size == 9));
        const auto ink_between = [&](const output::image::TextBitmap& text, int from, int to) {
            const auto first = text.coverage.begin() + std::ptrdiff_t{from} * text.width;
            return std::accumulate(first, text.coverage.begin() + std::ptrdiff_t{to} * text.width, 0);
        };
        // Nothing but the 2 stands on the baseline, and nothing is cut off at the top.
        CHECK(ink_between(power, power.baseline - 2, power.baseline) ==
              ink_between(drawn("2"), power.baseline - 2, power.baseline));
        CHECK(ink_between(drawn("^10"), 0, power.baseline) > 0);
        CHECK(ink_between(drawn("^10"), power.baseline - 1, power.height) == 0);
        CHECK(drawn("box.a^box.b").width == drawn("box.a").width + drawn("^").width + drawn("box.b").width);
        // A dot that ends a sentence stands on the line, and so does what follows a number.
        CHECK(drawn("2^10.").width == drawn("2^10").width + drawn(".").width);
        CHECK(drawn("2^10-3").width == drawn("2^10").width + drawn("-3").width);
        CHECK(drawn("^").width > 0);
        CHECK(drawn("^-").width == drawn("^").width + drawn("-").width);
    }
}

TEST_CASE("a line of text may be longer than any picture", "[text]") {
    const output::image::TextBitmap text = backend().render_text(std::string(9000, 'W'), 16);
    CHECK(text.width > 30000);
    CHECK(text.coverage.size() == static_cast<std::size_t>(text.width) * static_cast<std::size_t>(text.height));
}

// Hidden: it needs a process in which no test has loaded the module yet. The next test starts one.
TEST_CASE("in a process of its own, a missing module says what to do", "[.missing_module]") {
    std::string text;
    try {
        static_cast<void>(output::image::image_backend());
    } catch (const EnvironmentError& error) {
        text = error.what();
    }
    CHECK(text.find("/nonexistent/lostbits_image.so: cannot load") != std::string::npos);
    CHECK(text.find("libopenimageio") != std::string::npos);
    CHECK(text.find("lostbits_image`") != std::string::npos);
}

TEST_CASE("a missing module says what to do", "[image]") {
    const std::string program = fs::read_symlink("/proc/self/exe").string();
    const std::string tail = "' '[.missing_module]' >/dev/null 2>&1";
    CHECK(std::system(("LOSTBITS_IMAGE_MODULE=/nonexistent/lostbits_image.so '" + program + tail).c_str()) == 0);
    CHECK(std::system(("LOSTBITS_IMAGE_MODULE=/dev/null '" + program + tail).c_str()) != 0);
}

}  // namespace test_image
