// A drawing as SVG and PDF: text stays text, hostile text stays text, and the same drawing gives the same bytes.
#include <array>
#include <cstdlib>
#include <pugixml.hpp>
#include <string>

#include "catch.hpp"
#include "output/file/result_folder.hpp"
#include "output/helpers.hpp"
#include "output/image/figure.hpp"
#include "output/image/heatmap.hpp"
#include "output/plot/plot_axis.hpp"

namespace test_figure {

using namespace lostbits::output;
using namespace lostbits::output::image;
using namespace lostbits::output::test;

namespace {

const std::string hostile = "a<b & \"c\" 'd' ]]> \x01\x1b[31m \xe2\x80\xae reversed";

/// Something of every kind.
Canvas drawing() {
    Canvas canvas(200, 100);
    canvas.fill(10, 10, 20, 5, style::line);
    canvas.fill(-5, 30, 10, 5, style::line);
    canvas.text(10, 20, backend().render_text("at 2^-10 bits", 13), style::ink);
    canvas.text(5, 5, plot::rotate_left(backend().render_text("upwards", 13)), style::ink);
    canvas.text(10, 60, backend().render_text(hostile, 9, FontWeight::bold), style::soft_ink);
    canvas.field({100, 20, 40, 20}, 2, {{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {9, 9, 9}});
    Stroke stroke({20, 20, 100, 60});
    stroke.polyline(std::array<Point, 3>{{{30, 30}, {50.126, 40}, {60, 35}}}, 1.5, std::array<double, 2>{4, 3});
    stroke.disc({70, 50}, 3);
    stroke.polygon(std::array<Point, 3>{{{80, 60}, {90, 60}, {85, 70}}});
    stroke.paint(canvas, {1, 2, 3}, 0.5);
    stroke.polyline(std::array<Point, 2>{{{30, 30}, {500, 30}}}, 1);
    stroke.paint(canvas, {4, 5, 6});
    return canvas;
}

pugi::xml_document parsed(const std::string& svg) {
    pugi::xml_document document;
    const auto result = document.load_string(svg.c_str(), pugi::parse_full | pugi::parse_ws_pcdata);
    INFO(result.description() << " at " << result.offset);
    CHECK(result);
    return document;
}

/// All text of the elements of that name below a node, one after the other.
std::string texts_of(const pugi::xml_node& root, const char* name) {
    std::string all;
    for (const auto& found : root.select_nodes((std::string(".//") + name + "//text()").c_str()))
        all += found.node().value();
    return all;
}

std::string output_of(const std::string& command) {
    std::string text;
    FILE* const pipe = ::popen(command.c_str(), "r");
    for (int c; pipe != nullptr && (c = std::fgetc(pipe)) != EOF;) text += static_cast<char>(c);
    if (pipe != nullptr) ::pclose(pipe);
    return text;
}

}  // namespace

TEST_CASE("an SVG keeps text as text and every figure as a shape", "[figure]") {
    const std::string svg = svg_text(drawing());
    CHECK(svg == svg_text(drawing()));
    const auto document = parsed(svg);
    const auto root = document.child("svg");
    CHECK(std::string(root.attribute("viewBox").value()) == "0 0 200 100");
    CHECK(std::string(root.attribute("font-family").value()).starts_with("DejaVu Sans"));
    const std::string texts = texts_of(root, "text");
    CHECK(texts.find("upwards") != std::string::npos);
    CHECK(texts.find("at 2-10 bits") != std::string::npos);  // the exponent is raised
    CHECK(texts.find("a<b & \"c\" 'd' ]]>") != std::string::npos);
    CHECK(texts.find('\x1b') == std::string::npos);
    const auto exponent = root.select_node(".//tspan[.='-10']").node();
    const auto base = root.select_node(".//tspan[starts-with(.,'at')]").node();
    CHECK(exponent.attribute("y").as_double() < base.attribute("y").as_double());
    CHECK(exponent.attribute("font-size").as_int() < base.attribute("font-size").as_int());
    CHECK(root.select_nodes(".//circle").size() == 1);
    CHECK(std::string(root.select_node(".//path[@stroke-dasharray='4 3']").node().attribute("d").value()) ==
          "M30 30l20.13 10 9.87-5");
    // Only parts that extend beyond their box are clipped, by a box of their own.
    const auto inner = root.child("svg");
    CHECK(std::string(inner.attribute("viewBox").value()) == "20 20 100 60");
    CHECK(inner.select_nodes(".//path").size() == 1);
    CHECK(std::string(root.select_node(".//image").node().attribute("width").value()) == "40");
    // The part of a rectangle on the page.
    CHECK(svg.find("M0 30h5v5h-5z") != std::string::npos);
}

TEST_CASE("the files of a picture are of the kinds that the run asks for, and record its command", "[figure]") {
    const Scratch scratch;
    const auto write = [&](const char* name, std::vector<std::string> kinds) {
        const auto folder = scratch.path() / name;
        std::vector<std::filesystem::path> paths;
        for (const std::string& kind : kinds.empty() ? std::vector<std::string>{"png"} : kinds)
            paths.push_back(folder / ("plot.f32." + kind));
        const file::ResultFolder own(folder, {"lostbits map '" + hostile + "'", "lostbits 1"},
                                     {.figures = std::move(kinds)});
        save_figure(folder / "plot.f32.png", drawing());
        CHECK(figure_paths(folder / "plot.f32.png") == paths);
        HeatmapWriter heatmap(folder / "map.png", {.title = hostile,
                                                   .subtitle = {},
                                                   .width = 3,
                                                   .height = 2,
                                                   .scale = ColourScale("viridis", backend().ramp("viridis", 8), 0, 24),
                                                   .bar_label = "lost bits",
                                                   .legend = {{"false hit", outcome_colours[2], "6 (100%)"}},
                                                   .widest_caption = "mean 3.2"});
        for (int row = 0; row < 2; ++row) heatmap.write_rows(std::vector<Rgb8>(3, {1, 2, 3}));
        heatmap.finish(std::vector<LegendEntry>{{"false hit", outcome_colours[2], "6 (100%)"}}, "mean 3.2");
        return folder;
    };
    const auto all = write("all", {"svg", "pdf", "png"}), again = write("all again", {"pdf", "svg"}),
               usual = write("usual", {});
    for (const char* name : {"plot.f32", "map"}) {
        const auto file = [&](const fs::path& folder, const char* ending) {
            return folder / (std::string(name) + ending);
        };
        CHECK(contents(file(all, ".png")) == contents(file(usual, ".png")));
        CHECK(contents(file(all, ".svg")) == contents(file(again, ".svg")));
        CHECK(contents(file(all, ".pdf")) == contents(file(again, ".pdf")));
        CHECK(contents(file(all, ".pdf")).starts_with("%PDF-1."));
        CHECK_FALSE(fs::exists(file(again, ".png")));
        CHECK_FALSE(fs::exists(file(usual, ".svg")));
        const auto document = parsed(contents(file(all, ".svg")));
        CHECK(texts_of(document, "metadata").find("lostbits map 'a<b & \"c\"") != std::string::npos);
    }
    const auto map = parsed(contents(all / "map.svg"));
    for (const char* said : {"a<b & \"c\" 'd'", "lost bits", "false hit  6 (100%)", "mean 3.2", "24"})
        CHECK(texts_of(map, "text").find(said) != std::string::npos);
    CHECK(map.select_nodes(".//image").size() == 2);  // the field and the ramp
    if (std::system("pdftotext -v >/dev/null 2>&1") != 0) return;
    const std::string said = output_of("pdftotext -layout '" + (all / "map.pdf").string() + "' -");
    for (const char* part : {"lost bits", "false hit", "mean 3.2"}) CHECK(said.find(part) != std::string::npos);
    const std::string plot = output_of("pdftotext '" + (all / "plot.f32.pdf").string() + "' -");
    CHECK(plot.find("upwards") != std::string::npos);
    CHECK(plot.find("2^-10") != std::string::npos);
}

}  // namespace test_figure
