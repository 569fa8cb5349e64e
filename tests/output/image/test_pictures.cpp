#include <algorithm>
#include <array>
#include <thread>

#include "catch.hpp"
#include "output/helpers.hpp"
#include "output/image/contact_sheet.hpp"
#include "output/image/heatmap.hpp"
#include "output/image/pixels.hpp"

namespace test_pictures {

using namespace lostbits::output;
using namespace lostbits::output::image;
using namespace lostbits::output::test;

namespace {

ColourScale viridis() { return {"viridis", backend().ramp("viridis", 256), 0, 24}; }

/// Every outcome but the first.
std::vector<LegendEntry> legend_of(const std::string& count) {
    std::vector<LegendEntry> entries;
    for (std::size_t i = 1; i < outcome_colours.size(); ++i)
        entries.push_back({"wrong neighbour", outcome_colours[i], count});
    return entries;
}

/// All samples of a small field have different colours, none of them that of the page.
std::vector<Rgb8> numbered(int width, int height) {
    std::vector<Rgb8> out;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            out.push_back({static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y),
                           static_cast<std::uint8_t>((x >> 8) + 16 * (y >> 8))});
        }
    }
    return out;
}

/// The row of the field's first sample: below the frame, the first line of the frame's colour from the left margin on.
int field_top(const PngImage& image, int field_width) {
    for (int y = 0; y < image.height; ++y) {
        bool run = true;
        for (int x = 0; x < field_width + 2 && run; ++x)
            run = pixel_at(image, image::style::margin + x, y) == image::style::line;
        if (run) return y + 1;
    }
    return -1;
}

}  // namespace

TEST_CASE("a heatmap shows every sample of the field, enlarged by a whole factor", "[heatmap]") {
    const Scratch folder;
    struct Size {
        int width, height, factor;
    };
    for (const auto [width, height, factor] : {Size{64, 64, 6}, Size{400, 30, 1}, Size{1, 1, 384}, Size{7, 1000, 2}}) {
        INFO(width << " x " << height);
        const auto field = numbered(width, height);
        HeatmapWriter map(folder / "m.png", {.title = "A title",
                                             .subtitle = {"a subtitle"},
                                             .width = width,
                                             .height = height,
                                             .scale = viridis(),
                                             .bar_label = "lost bits",
                                             .legend = legend_of("1 (100.0%)")});
        const auto half = static_cast<std::size_t>(width) * static_cast<std::size_t>(height / 2);
        map.write_rows(std::span(field).first(half));
        map.write_rows(std::span(field).subspan(half));
        map.finish(legend_of("1 (0.1%)"));
        const PngImage image = backend().read_png(folder / "m.png");
        const int top = field_top(image, width * factor);
        REQUIRE(top > 0);
        std::int64_t wrong = 0;
        for (int y = 0; y < height * factor; ++y) {
            for (int x = 0; x < width * factor; ++x) {
                const auto sample = static_cast<std::size_t>(y / factor * width + x / factor);
                wrong += pixel_at(image, image::style::margin + 1 + x, top + y) != field[sample];
            }
        }
        CHECK(wrong == 0);
        CHECK(rim_is_blank(image));
    }
}

TEST_CASE("text in a heatmap is never cut off, however long", "[heatmap]") {
    const Scratch folder;
    const std::string sentence =
        "A title of ninety letters or more that says what was measured, of what and in which "
        "format, and on";
    for (const auto& title : {sentence, std::string(120, 'W'), std::string()}) {
        HeatmapWriter map(
            folder / "m.png",
            {.title = title,
             .subtitle = {sentence + sentence, "short"},
             .width = 16,
             .height = 16,
             .scale = viridis(),
             .bar_label = "relative error of the hit point",
             .legend = legend_of("123456789012345 (100.0%), and a remark that is far too long for a legend")});
        map.write_rows(std::vector<Rgb8>(256, Rgb8{1, 2, 3}));
        map.finish(legend_of("123456789012345 (100.0%), and a remark that is far too long for a legend, even longer"));
        CHECK(rim_is_blank(backend().read_png(folder / "m.png")));
    }
}

TEST_CASE("text is wrapped and shortened between letters of any size", "[text]") {
    const std::string text = [] {
        std::string many;
        for (int i = 0; i < 40; ++i) many += i % 2 == 0 ? "≤" : "²";
        return many;
    }();
    const int all = backend().render_text(text, 13).width;
    for (const int width : {1, 20, 37, 100, all}) {
        INFO(width);
        int sum = 0;
        for (const TextBitmap& line : wrap_text(text, 13, FontWeight::regular, width)) sum += line.width;
        CHECK(sum == all);  // a `?` would be of another width
        const TextBitmap fitted = fit_text(text, 9, FontWeight::regular, width);
        CHECK((fitted.width <= width || width == 1));
        // Whole letters: some from the beginning, some from the end.
        bool found = fitted.coverage == backend().render_text(text, 9).coverage;
        for (std::size_t head = 1; head <= 20; ++head) {
            for (std::size_t tail = 0; tail <= 20; ++tail) {
                std::string shorter;
                for (std::size_t i = 0; i < head; ++i) shorter += i % 2 == 0 ? "≤" : "²";
                shorter += "…";
                for (std::size_t i = 40 - tail; i < 40; ++i) shorter += i % 2 == 0 ? "≤" : "²";
                found |= fitted.coverage == backend().render_text(shorter, 9).coverage;
            }
        }
        CHECK(found);
    }
}

TEST_CASE("a title of several lines is drawn as one title", "[text]") {
    const std::array<std::string, 1> lines{"c\td"}, line{"c d"};
    CHECK((heading("a\nb", lines, 400).pixels() == heading("a b", line, 400).pixels()));
}

TEST_CASE("the legend shows only what occurs, and a colour bar where there is a scale", "[heatmap]") {
    const Scratch folder;
    const auto make = [&](std::vector<LegendEntry> entries, bool bar) {
        HeatmapSpec spec{.title = "T",
                         .subtitle = {},
                         .width = 8,
                         .height = 8,
                         .scale = {},
                         .bar_label = "lost bits",
                         .legend = legend_of("64")};
        if (bar) spec.scale = viridis();
        HeatmapWriter map(folder / "m.png", std::move(spec));
        map.write_rows(std::vector<Rgb8>(64, Rgb8{1, 2, 3}));
        map.finish(entries);
        return backend().read_png(folder / "m.png");
    };
    const auto all = make(legend_of("7"), true);
    for (std::size_t i = 1; i < outcome_colours.size(); ++i) CHECK(count_of(all, outcome_colours[i]) >= 100);
    const auto one = make({legend_of("7")[2]}, true);
    CHECK(count_of(one, outcome_colours[3]) >= 100);
    CHECK(count_of(one, outcome_colours[2]) == 0);
    CHECK(one.height == all.height);
    std::int64_t missing = 0;
    const auto ramp = backend().ramp("viridis", 256);
    for (const Rgb8 colour : ramp) missing += count_of(one, colour) == 0;
    CHECK(missing == 0);  // a bar of 384 pixels shows the whole ramp
    CHECK(count_of(make({}, false), ramp[200]) == 0);
}

TEST_CASE("a heatmap is complete or absent, and its bytes are reproducible", "[heatmap]") {
    const Scratch folder;
    const HeatmapSpec spec{.title = "T",
                           .subtitle = {},
                           .width = 4,
                           .height = 3,
                           .scale = viridis(),
                           .bar_label = "bits",
                           .legend = legend_of("9")};
    const auto field = numbered(4, 3);
    {
        HeatmapWriter map(folder / "m.png", spec);
        CHECK_THROWS_AS(map.write_rows(std::span(field).first(5)), std::logic_error);
        map.write_rows(std::span(field).first(8));
        CHECK_THROWS_AS(map.write_rows(std::span(field).first(8)), std::logic_error);
        CHECK_THROWS_AS(map.finish({}), std::logic_error);
        CHECK_FALSE(fs::exists(folder / "m.png"));
    }
    CHECK(folder.entries() == 0);
    for (const auto* name : {"a", "b"}) {
        HeatmapWriter map(folder / name, spec);
        map.write_rows(field);
        map.finish(legend_of("4"));
    }
    CHECK(contents(folder / "a") == contents(folder / "b"));
}

namespace {

std::vector<std::string> words(const std::string& stem, std::size_t count) {
    std::vector<std::string> out;
    for (std::size_t i = 0; i < count; ++i) out.push_back(stem + std::to_string(i));
    return out;
}

/// A sheet whose cells each hold one colour of their own, fed by `threads` threads.
PngImage sheet_of(const fs::path& path, std::size_t forms, std::size_t formats, unsigned threads) {
    ContactSheet sheet(
        path, {.title = "A contact sheet with a title that is longer than a small page is wide, so that it wraps",
               .subtitle = {"one line", "another"},
               .column_labels = words("sphere.a_rather_long_name_", forms),
               .row_labels = words("p", formats),
               .field_width = 64,
               .field_height = 32,
               .scales = {viridis()},
               .bar_label = "lost bits"});
    std::vector<std::thread> workers;
    for (unsigned t = 0; t < threads; ++t) {
        workers.emplace_back([&, t] {
            for (std::size_t cell = t; cell < forms * formats; cell += threads) {
                const Rgb8 colour{static_cast<std::uint8_t>(3 * cell + 1), 200, 3};
                const std::vector<Rgb8> rows(64 * 16, colour);
                sheet.add_rows(cell % forms, cell / forms, 16, rows);
                sheet.add_rows(cell % forms, cell / forms, 0, rows);
                sheet.set_note(cell % forms, cell / forms,
                               "p99 3.2 bits, 4% false miss, and more words than there is room for in the cell");
            }
        });
    }
    for (auto& worker : workers) worker.join();
    sheet.finish(legend_of("12 (0.9%)"));
    return backend().read_png(path);
}

}  // namespace

TEST_CASE("a contact sheet shows every cell once and complete", "[contact_sheet]") {
    const Scratch folder;
    for (const auto& [forms, formats] : {std::pair<std::size_t, std::size_t>{22, 3}, {1, 1}, {8, 2}, {7, 1}}) {
        INFO(forms << " x " << formats);
        const auto image = sheet_of(folder / "a.png", forms, formats, 3);
        static_cast<void>(sheet_of(folder / "b.png", forms, formats, 1));
        CHECK(contents(folder / "a.png") == contents(folder / "b.png"));  // however many threads fed it
        for (std::size_t cell = 0; cell < forms * formats; ++cell) {
            CHECK(count_of(image, {static_cast<std::uint8_t>(3 * cell + 1), 200, 3}) == 128 * 64);
        }
        CHECK(rim_is_blank(image));
        CHECK(image.width < 1500);
    }
}

TEST_CASE("each row of a contact sheet has its own colour bar where formats differ", "[contact_sheet]") {
    const Scratch folder;
    const auto ramp = backend().ramp("viridis", 256);
    const auto sheet = [&](const char* name, std::size_t forms, std::vector<ColourScale> scales) {
        ContactSheet page(folder / name, {.title = "T",
                                          .subtitle = {},
                                          .column_labels = words("form_", forms),
                                          .row_labels = {"f32", "f64"},
                                          .field_width = 64,
                                          .field_height = 64,
                                          .scales = std::move(scales),
                                          .bar_label = "bits"});
        page.finish({});
        return backend().read_png(folder / name);
    };
    const auto both = sheet("two.png", 2, {{"viridis", ramp, 0, 24}, {"viridis", ramp, 0, 53}});
    const auto one = sheet("one.png", 2, {{"viridis", ramp, 0, 24}});
    CHECK(count_of(one, ramp.back()) > 0);
    CHECK(count_of(both, ramp.back()) >= 32);  // sixteen pixels wide, in each bar
    // Nine forms are two blocks, and every block has its bars.
    const auto blocks = sheet("blocks.png", 9, {{"viridis", ramp, 0, 24}, {"viridis", ramp, 0, 53}});
    CHECK(count_of(blocks, ramp.back()) == 2 * count_of(both, ramp.back()));
    CHECK(rim_is_blank(blocks));
    CHECK_THROWS_AS(sheet("three.png", 2, {viridis(), viridis(), viridis()}), std::logic_error);
}

TEST_CASE("forms that are alike in every format share a column, and a headline takes a line", "[contact_sheet]") {
    const Scratch folder;
    const auto sheet = [&](bool collapses, const char* note, const char* headline) {
        ContactSheet page(folder / "s.png", {.title = "T",
                                             .subtitle = {},
                                             .column_labels = words("form_", 8),
                                             .row_labels = {"f32", "f64"},
                                             .field_width = 160,
                                             .field_height = 160,
                                             .scales = {},
                                             .bar_label = "",
                                             .collapses = collapses});
        for (std::size_t form = 0; form < 8; ++form) {
            page.add_rows(form, 0, 0, std::vector<Rgb8>(160 * 160, Rgb8{1, 2, 3}));
            // The last form has another picture in one format.
            page.add_rows(form, 1, 0, std::vector<Rgb8>(160 * 160, Rgb8{4, 5, static_cast<std::uint8_t>(form == 7)}));
        }
        page.set_note(3, 0, note);
        page.finish({}, {}, headline);
        return backend().read_png(folder / "s.png");
    };
    constexpr std::int64_t cell = 160 * 160;
    const auto all = sheet(false, "", ""), few = sheet(true, "", ""), noted = sheet(true, "another note", "");
    CHECK(count_of(all, {1, 2, 3}) == 8 * cell);
    CHECK(count_of(few, {1, 2, 3}) == 2 * cell);
    CHECK(count_of(few, {4, 5, 0}) == cell);
    CHECK(count_of(few, {4, 5, 1}) == cell);
    CHECK(count_of(noted, {1, 2, 3}) == 3 * cell);
    CHECK(few.height < all.height);
    CHECK(rim_is_blank(few));
    CHECK(sheet(true, "", "A headline").height == few.height + style::line_height(style::text_size));
}

TEST_CASE("the forms that differ most come first: the best, the worst, and the most different", "[contact_sheet]") {
    const Scratch folder;
    constexpr std::size_t forms = 9;
    ContactSheet sheet(folder / "s.png", {.title = "T",
                                          .subtitle = {},
                                          .column_labels = words("form_", forms),
                                          .row_labels = {"f32"},
                                          .field_width = 160,
                                          .field_height = 160,
                                          .scales = {},
                                          .bar_label = "",
                                          .collapses = true});
    // Neighbours among the first five are nearly alike, the others are far apart.
    const auto colour = [](std::size_t form) {
        return Rgb8{static_cast<std::uint8_t>(form < 5 ? form : 40 * (form - 4)), 9, 9};
    };
    for (std::size_t form = 0; form < forms; ++form)
        sheet.add_rows(form, 0, 0, std::vector<Rgb8>(160 * 160, colour(form)));
    std::vector<std::size_t> order(forms);
    for (std::size_t k = 0; k < forms; ++k) order[k] = k;
    sheet.finish({}, order);
    const auto image = backend().read_png(folder / "s.png");
    const auto row_of = [&](std::size_t form) {
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x)
                if (pixel_at(image, x, y) == colour(form)) return y;
        return -1;
    };
    for (const std::size_t telling : {0, 4, 5, 6, 7, 8}) CHECK(row_of(telling) == row_of(0));
    for (const std::size_t other : {1, 2, 3}) CHECK(row_of(other) > row_of(0) + 160);
}

TEST_CASE("a cell enlarges the samples around a pixel in the corner that is farthest away", "[contact_sheet]") {
    const Scratch folder;
    ContactSheet sheet(folder / "s.png", {.title = "T",
                                          .subtitle = {},
                                          .column_labels = {"a"},
                                          .row_labels = {"f32"},
                                          .field_width = 160,
                                          .field_height = 160,
                                          .scales = {},
                                          .bar_label = "",
                                          .zooms = true});
    std::vector<Rgb8> field(160 * 160, Rgb8{1, 2, 3});
    field[20 * 160 + 30] = {250, 0, 7};
    sheet.add_rows(0, 0, 0, field);
    sheet.set_zoom(0, 0, 30, 20);
    sheet.finish({});
    const auto image = backend().read_png(folder / "s.png");
    // The sample itself, and 5 by 5 pixels of the inset.
    CHECK(count_of(image, {250, 0, 7}) == 1 + 5 * 5);
    CHECK(rim_is_blank(image));
}

TEST_CASE("the legend of a sheet takes the space of the classes that occur", "[contact_sheet]") {
    const Scratch folder;
    const auto height = [&](std::vector<LegendEntry> legend) {
        ContactSheet sheet(folder / "s.png", {.title = "T",
                                              .subtitle = {},
                                              .column_labels = {"a", "b"},
                                              .row_labels = {"f32"},
                                              .field_width = 64,
                                              .field_height = 64});
        sheet.finish(legend);
        return backend().read_png(folder / "s.png").height;
    };
    const auto entries = legend_of("9 (1.0%)");
    CHECK(height({}) < height({entries[0]}));
    CHECK(height({entries[0]}) < height(entries));
}

TEST_CASE("a cell without data is drawn as empty, and a wrong cell is refused", "[contact_sheet]") {
    const Scratch folder;
    const SheetSpec spec{.title = "T",
                         .subtitle = {},
                         .column_labels = {"a", "b"},
                         .row_labels = {"f32"},
                         .field_width = 64,
                         .field_height = 64,
                         .scales = {},
                         .bar_label = ""};
    ContactSheet sheet(folder / "s.png", spec);
    sheet.add_rows(0, 0, 0, std::vector<Rgb8>(64 * 64, Rgb8{1, 2, 3}));
    sheet.add_rows(1, 0, 0, std::vector<Rgb8>(64 * 63, Rgb8{4, 5, 6}));
    CHECK_THROWS_AS(sheet.add_rows(2, 0, 0, std::vector<Rgb8>(64)), std::logic_error);
    CHECK_THROWS_AS(sheet.set_note(0, 1, ""), std::logic_error);
    CHECK_FALSE(fs::exists(folder / "s.png"));
    sheet.finish({});
    const auto image = backend().read_png(folder / "s.png");
    CHECK(count_of(image, {1, 2, 3}) == 128 * 128);
    CHECK(count_of(image, {4, 5, 6}) == 0);
    auto formless = spec;
    formless.column_labels = {};
    CHECK_THROWS_AS(ContactSheet(folder / "t.png", formless), std::logic_error);
}

}  // namespace test_pictures
