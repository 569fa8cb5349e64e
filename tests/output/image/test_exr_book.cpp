// EXR files of several parts, read back by OpenImageIO, which did not write them.
#include <sys/resource.h>

#include <algorithm>
#include <bit>
#include <random>
#include <thread>

#include "catch.hpp"
#include "number/error.hpp"
#include "output/helpers.hpp"
#include "output/image/exr_book.hpp"

namespace test_exr_book {

using namespace lostbits;
using namespace lostbits::output;
using namespace lostbits::output::image;
using namespace lostbits::output::test;

namespace {

constexpr int width = 37, height = 41;  // no multiple of the 16 lines of a block
constexpr auto f32 = Channel::Type::f32, u32 = Channel::Type::u32;

/// Three parts with different channels, in an order that sorting would not give; the last belongs to a later run.
std::vector<ExrPart> three_parts() {
    const auto part = [](const char* name, std::vector<Channel> channels, int run) {
        return ExrPart{
            name, {width, height, std::move(channels), {{"lostbits:form", name}, {"lostbits:command", "map x"}}}, run};
    };
    return {part("sphere.b.f32", {{"t.hi", f32}, {"class.object", u32}, {"R", f32}, {"a.z", f32}}, 0),
            part("sphere.a.f64", {{"x.only", u32}}, 0),
            part("truth", {{"of_a_name_longer_than_31_letters.hi", f32}, {"truth.word0", u32}}, 1)};
}

/// The samples of a part: special values first, then smooth or random ones, line by line, for blocks that compress and
/// blocks that do not.
std::vector<std::uint32_t> samples_of(const ExrPart& part) {
    constexpr std::uint32_t special[] = {0x00000000, 0x80000000, 0x7F800000, 0xFF800000, 0x7FC00000, 0xFFC00001,
                                         0x7F800001, 0x00000001, 0x807FFFFF, 0x3F800000, 0xFFFFFFFF, 0x7F7FFFFF};
    std::mt19937 random(static_cast<unsigned>(part.name.size()));
    std::vector<std::uint32_t> out(static_cast<std::size_t>(width * height) * part.spec.channels.size());
    for (std::size_t i = 0; i < out.size(); ++i) {
        const std::size_t pixel = i / part.spec.channels.size();
        out[i] = pixel < std::size(special) ? special[pixel]
                 : pixel < 16 * width       ? 0x40000000 + static_cast<std::uint32_t>(i)
                                            : static_cast<std::uint32_t>(random());
    }
    return out;
}

void write_block(ExrBook& book, const std::vector<ExrPart>& parts, std::size_t p, int y, int rows) {
    auto samples = samples_of(parts[p]);
    const std::size_t line = width * parts[p].spec.channels.size();
    samples.resize(std::max(samples.size(), static_cast<std::size_t>(y + rows) * line));  // rows beyond the last, too
    book.write_rows(p, y, rows,
                    std::as_bytes(std::span(samples).subspan(static_cast<std::size_t>(y) * line,
                                                             static_cast<std::size_t>(rows) * line)));
}

std::uint32_t bits_at(const ExrChannel& channel, std::size_t i) {
    if (const auto* f = std::get_if<std::vector<float>>(&channel.samples)) return std::bit_cast<std::uint32_t>((*f)[i]);
    return std::get<std::vector<std::uint32_t>>(channel.samples)[i];
}

void check_part(const ExrPart& part, const ExrImage& image) {
    const auto samples = samples_of(part);
    const auto& channels = part.spec.channels;
    REQUIRE((image.width == width && image.height == height && image.channels.size() == channels.size()));
    for (std::size_t c = 0; c < channels.size(); ++c) {
        INFO(part.name << " " << channels[c].name);
        const ExrChannel* channel = image.find(channels[c].name);
        REQUIRE(channel != nullptr);
        CHECK((channel->samples.index() == 1) == (channels[c].type == u32));
        std::size_t wrong = 0;
        for (std::size_t i = 0; i < static_cast<std::size_t>(width * height); ++i)
            wrong += bits_at(*channel, i) != samples[i * channels.size() + c];
        CHECK(wrong == 0);
    }
    for (const auto& attribute : part.spec.attributes) CHECK(std::ranges::count(image.attributes, attribute) == 1);
    CHECK(image.find("no.such") == nullptr);
}

}  // namespace

TEST_CASE("each part of an EXR book reads back under its name, bit for bit", "[exr]") {
    const Scratch folder;
    const auto parts = three_parts();
    ExrBook book(folder / "a.exr", parts);
    for (const std::size_t p : {2, 0, 1}) write_block(book, parts, p, 0, height);
    CHECK_FALSE(fs::exists(folder / "a.exr"));
    book.close();
    CHECK(backend().exr_parts(folder / "a.exr") == std::vector<std::string>{"sphere.b.f32", "sphere.a.f64", "truth"});
    for (std::size_t p = 0; p < parts.size(); ++p) check_part(parts[p], backend().read_exr(folder / "a.exr", p));
    CHECK_THROWS_AS(backend().read_exr(folder / "a.exr", 3), InputError);
}

TEST_CASE("an EXR book of one unnamed part is a file without parts", "[exr]") {
    const Scratch folder;
    auto parts = three_parts();
    for (auto& part : parts) {
        part.name.clear();
        ExrBook book(folder / "a.exr", {part});
        write_block(book, {part}, 0, 0, 15);
        write_block(book, {part}, 0, 15, height - 15);
        book.close();
        CHECK(backend().exr_parts(folder / "a.exr") == std::vector<std::string>{""});
        check_part(part, backend().read_exr(folder / "a.exr"));
    }
}

TEST_CASE("the bytes of an EXR book do not depend on the order of parts or the number of threads", "[exr]") {
    const Scratch folder;
    const auto parts = three_parts();
    const auto write = [&](const char* name, const auto& serve_all) {
        ExrBook book(folder / name, parts);
        serve_all(book);
        book.close();
    };
    write("a.exr", [&](ExrBook& book) {
        for (const std::size_t p : {0, 1, 2}) write_block(book, parts, p, 0, height);
    });
    write("b.exr", [&](ExrBook& book) {
        for (int y = 0; y < height; y += 3)
            for (const std::size_t p : {2, 1, 0}) write_block(book, parts, p, y, std::min(3, height - y));
    });
    write("c.exr", [&](ExrBook& book) {
        std::vector<std::jthread> threads;
        for (const std::size_t p : {0, 1, 2})
            threads.emplace_back([&, p] {
                for (int y = 0; y < height; ++y) write_block(book, parts, p, y, 1);
            });
    });
    CHECK(contents(folder / "a.exr").size() > 1000);
    CHECK(contents(folder / "a.exr") == contents(folder / "b.exr"));
    CHECK(contents(folder / "a.exr") == contents(folder / "c.exr"));
}

TEST_CASE("an EXR book appears only when closed, and refuses what no reader would accept", "[exr]") {
    const Scratch folder;
    const auto parts = three_parts();
    {
        ExrBook book(folder / "a.exr", parts);
        CHECK_THROWS_AS(write_block(book, parts, 0, 1, 1), std::logic_error);
        CHECK_THROWS_AS(book.write_rows(0, 0, 1, {}), std::logic_error);
        for (const std::size_t p : {0, 1}) write_block(book, parts, p, 0, height);
        CHECK_THROWS_AS(write_block(book, parts, 0, height, 1), std::logic_error);
        CHECK_THROWS_AS(book.close(), std::logic_error);
        CHECK(folder.entries() == 1);
    }
    CHECK(folder.entries() == 0);
    const auto refused = [&](auto change) {
        auto changed = three_parts();
        change(changed);
        CHECK_THROWS_AS(ExrBook(folder / "a.exr", changed), std::logic_error);
    };
    refused([](auto& p) { p.clear(); });
    refused([](auto& p) { p[1].name = p[0].name; });
    refused([](auto& p) { p[1].name.clear(); });
    refused([](auto& p) { p[1].spec.channels.clear(); });
    refused([](auto& p) { p[0].spec.channels[1].name = "t.hi"; });
    refused([](auto& p) { p[2].spec.height = 1; });
    CHECK_THROWS_AS(ExrBook(folder.path(), parts), EnvironmentError);
    CHECK(folder.entries() == 0);
}

TEST_CASE("a full disk stops an EXR book, is reported to every part, and leaves no file", "[exr]") {
    const Scratch folder;
    const auto parts = three_parts();
    const auto attempt = [&](rlim_t limit_bytes) {
        return in_child([&] {
            file::ignore_file_size_signal();
            const rlimit limit{limit_bytes, limit_bytes};
            ::setrlimit(RLIMIT_FSIZE, &limit);
            std::vector<ExrPart> many;  // more bytes than the file's buffer holds
            for (int p = 0; p < 200; ++p) {
                many.push_back(parts[0]);
                many.back().name += std::to_string(p);
            }
            int failure_count = 0;
            ExrBook book(folder / "a.exr", many);
            const auto fails_to_write = [&](std::size_t p, int y) {
                try {
                    write_block(book, many, p, y, std::min(16, height - y));
                } catch (const EnvironmentError& error) {
                    return std::string(error.what()).find(": cannot write: File too large; free space") !=
                           std::string::npos;
                }
                return false;
            };
            for (int y = 0; y < height; y += 16) {
                for (std::size_t p = 0; p < many.size() && failure_count < 5; ++p)
                    failure_count += fails_to_write(p, y);
            }
            if (failure_count == 0) book.close();
            return failure_count == 5 ? 1 : failure_count == 0 ? 0 : 2;
        });
    };
    CHECK(attempt(1000000) == 1);
    CHECK(folder.entries() == 0);
    CHECK(attempt(RLIM_INFINITY) == 0);
    CHECK(folder.entries() == 1);
}

TEST_CASE("other programs can read every part of an EXR book", "[exr]") {
    INFO("oiiotool comes with openimageio-tools");
    REQUIRE(std::system("oiiotool --version >/dev/null 2>&1") == 0);
    const Scratch folder;
    const auto parts = three_parts();
    ExrBook book(folder / "a.exr", parts);
    for (const std::size_t p : {0, 1, 2}) write_block(book, parts, p, 0, height);
    book.close();
    const std::string out = (folder / "info").string();
    REQUIRE(std::system(("oiiotool --info -v -a " + (folder / "a.exr").string() + " >" + out + " 2>&1").c_str()) == 0);
    const std::string info = contents(out);
    INFO(info);
    CHECK(info.find("3 subimages: 37x41") != std::string::npos);
    for (const auto& part : parts) CHECK(info.find("name: \"" + part.name + "\"") != std::string::npos);
    CHECK(info.find("class.object (uint)") != std::string::npos);
    CHECK(info.find("compression: \"zip\"") != std::string::npos);
    CHECK(info.find("half") == std::string::npos);
    CHECK(info.find("DateTime") == std::string::npos);
}

}  // namespace test_exr_book
