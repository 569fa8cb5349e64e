// Distinct styles in pictures: of forms in every plot and of the entries of a legend.
#include <map>
#include <set>
#include <tuple>

#include "catch.hpp"
#include "measure/rows.hpp"
#include "output/helpers.hpp"
#include "output/map/form_names.hpp"
#include "output/map/map_colour.hpp"
#include "output/plot/form_look.hpp"
#include "output/plot/line_plot_parts.hpp"
#include "output/trade/trade_files.hpp"

namespace test_looks {

using namespace lostbits;
using namespace lostbits::output;
using intersect::table::Intersector;

namespace {

/// A level line.
plot::Series level(const std::string& label, double y) { return {label, {1, 2, 4}, {y, y, y}, {}, {}}; }

plot::Series with_look(int k, std::size_t look) {
    plot::Series one = level(std::to_string(k), k);
    one.look = look;
    return one;
}

}  // namespace

TEST_CASE("a line keeps its own style, and no two lines share one", "[looks]") {
    using Look = std::tuple<int, int, int, int, std::vector<double>>;
    const auto look_of = [](const plot::PlotLine& line) {
        return Look{line.colour.r, line.colour.g, line.colour.b, line.marker, {line.dashes.begin(), line.dashes.end()}};
    };
    // Next to lines before it, lines after it, or lines without a style.
    const Look alone = look_of(plot::plot_lines(std::vector{with_look(1, 19)})[0]);
    const auto among = plot::plot_lines(std::vector{level("a", 2), with_look(3, 0), with_look(1, 19), level("b", 4)});
    CHECK(look_of(among[2]) == alone);
    CHECK(look_of(plot::plot_lines(std::vector{with_look(1, 0), level("a", 2)})[1]) ==
          look_of(plot::plot_lines(std::vector{with_look(2, 1)})[0]));

    // Every style and pattern, whether requested or not.
    for (const int look_count : {0, 1, 5, 1000}) {
        std::vector<plot::Series> many;
        for (int k = 0; k < 240; ++k) {
            many.push_back(level(std::to_string(k), k));
            if (look_count > 0 && k % 3 == 0) many.back().look = static_cast<std::size_t>(k % look_count);
        }
        std::set<Look> seen;
        for (const plot::PlotLine& line : plot::plot_lines(many)) seen.insert(look_of(line));
        CAPTURE(look_count);
        CHECK(seen.size() == many.size());
    }
}

TEST_CASE("lines that want the same style get different ones while there are colours left", "[looks]") {
    // Three of one colour, and one that keeps its own.
    const auto lines =
        plot::plot_lines(std::vector{with_look(1, 3), with_look(2, 11), with_look(3, 0), with_look(4, 19)});
    std::set<std::array<int, 3>> colours;
    for (const plot::PlotLine& line : lines) colours.insert({line.colour.r, line.colour.g, line.colour.b});
    CHECK(colours.size() == lines.size());
    CHECK(lines[0].colour == plot::look_colour(3));
    CHECK(lines[2].colour == plot::look_colour(0));
    CHECK(lines[1].marker == 1);  // of the style that it asks for
}

TEST_CASE("the style of a form follows from its place in the catalogue, or from its name if external", "[looks]") {
    std::map<Shape, std::set<std::size_t>> looks;
    for (const Intersector& form : intersect::table::catalogue()) {
        const std::size_t look = plot::form_look(form);
        CAPTURE(form.info->name);
        CHECK(look < plot::look_count);
        CHECK(looks[form.shape].insert(look).second);
        CHECK(plot::form_look(Intersector(form)) == look);  // the same for every copy of the row
    }
    // Marches appear beside the forms of both shapes.
    for (const std::size_t look : looks[Shape::sdf]) {
        CHECK_FALSE(looks[Shape::sphere].contains(look));
        CHECK_FALSE(looks[Shape::box].contains(look));
    }
    const auto from_outside = [](const char* name, Shape shape) {
        const intersect::Info info{.name = name, .title = "", .source = ""};
        return plot::form_look({.info = &info, .shape = shape, .native32 = {}, .native64 = {}});
    };
    for (const char* name : {"mine.sphere", "glm.sphere", "a", ""}) {
        const std::size_t look = from_outside(name, Shape::sphere);
        CHECK(look < plot::look_count);
        CHECK(look == from_outside(name, Shape::sphere));
        for (const auto& [shape, taken] : looks) CHECK_FALSE(taken.contains(look));
    }
    CHECK(from_outside("mine.sphere", Shape::sphere) != from_outside("glm.sphere", Shape::sphere));
}

TEST_CASE("no two entries of a legend share a colour in any map", "[looks]") {
    for (const measure::metric::Metric& metric : measure::metric::metrics()) {
        if (metric.depends_on_forms) continue;  // its operations have a test of their own
        CAPTURE(metric.name);
        std::set<std::tuple<int, int, int>> colours;
        const auto entries = map::MetricPaint(metric, binary32).look(true).widest_legend(1);
        for (const image::LegendEntry& entry : entries) {
            CAPTURE(entry.label);
            CHECK(colours.insert({entry.colour.r, entry.colour.g, entry.colour.b}).second);
        }
    }
}

TEST_CASE("every key in speed-accuracy plots has its own style, and the plot says that times are for easy rays",
          "[looks]") {
    std::vector<measure::trade::TradeKernel> kernels;
    for (const auto& row :
         {lostbits::test::row("sphere.unified", "f32"), lostbits::test::row("sphere.unified", "f64")}) {
        for (const char* isa : {"scalar", "128", "256", "512"}) kernels.push_back({row, isa});
    }
    const std::vector<const measure::metric::Metric*> metrics{measure::metric::find_metric("lost_bits"),
                                                              measure::metric::find_metric("excess_bits")};
    const measure::trade::TradeRequest request{.kernels = kernels, .metrics = metrics, .loads = {{"l1", 1024, 0.5}}};
    measure::trade::TradeResult result{.times = {}, .operations = {}, .form_indices = {}, .summaries = {}};
    for (std::size_t k = 0; k < kernels.size(); ++k) {
        result.times.push_back({{}});
        result.operations.emplace_back();
        result.form_indices.push_back(k);
    }
    const auto sets = measure::trade::ray_sets(Shape::sphere);
    for (std::size_t s = 0; s < sets.size(); ++s) {
        auto& rows = result.summaries.emplace_back();
        for (std::size_t k = 0; k < kernels.size(); ++k) rows.emplace_back(metrics);
    }
    const auto spec = trade::make_trade_plot(request, result, 0);
    std::set<std::tuple<int, std::size_t, bool, bool>> seen;
    for (const auto& entry : spec.legend) {
        CAPTURE(entry.label);
        CHECK(seen.insert({entry.marker, entry.is_faint ? 0 : entry.colour, entry.is_faint, entry.is_hollow}).second);
    }
    CHECK(spec.legend.size() == 8);
    CHECK(spec.x.has_decimal_ticks);
    REQUIRE(sets.size() > 1);
    for (std::size_t s = 0; s < sets.size(); ++s) {
        const auto of_set = trade::make_trade_plot(request, result, s);
        const std::string& said = of_set.subtitle.front();
        INFO(said);
        CHECK(said.find("of the set " + std::string(sets[s].name) + ".") != std::string::npos);
        CHECK(said.find("rays like those of the set easy") != std::string::npos);
        CHECK((said.find("the same in the pictures of all sets") != std::string::npos) == (s > 0));
        CHECK(of_set.x.title.find("of the easy set") != std::string::npos);
    }
}

TEST_CASE("a form without a title still has a caption", "[looks]") {
    CHECK(map::title_of({.name = "a.b", .title = "its own", .source = "x"}) == "its own");
    CHECK(map::title_of({.name = "a.b", .title = "", .source = "libfar 1.2"}) == "a form from outside: libfar 1.2");
    CHECK(map::title_of({.name = "a.b", .title = "", .source = ""}) == "a form from outside");
}

}  // namespace test_looks
