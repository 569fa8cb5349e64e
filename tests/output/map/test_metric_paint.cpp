// Colours and captions of maps.
#include <algorithm>
#include <array>
#include <limits>
#include <memory>

#include "catch.hpp"
#include "measure/metric/metric_set.hpp"
#include "measure/rows.hpp"
#include "output/attribution/explain_command.hpp"
#include "output/helpers.hpp"
#include "output/map/finding.hpp"
#include "output/map/map_colour.hpp"
#include "output/map/map_pictures.hpp"

namespace test_metric_paint {

using namespace lostbits::output;
using namespace lostbits::output::map;
using namespace lostbits::output::test;
using lostbits::binary32;
using lostbits::binary64;
using lostbits::measure::answer::Outcome;
using lostbits::measure::evaluate::FormSummary;
using lostbits::measure::metric::find_metric;
using lostbits::measure::metric::Metric;

namespace {

/// A row of 1000 pixels with these lost bits on its agreed hits, and these outcomes beside them.
FormSummary summary_of(double lost, std::initializer_list<std::pair<Outcome, std::uint64_t>> outcomes) {
    FormSummary s({find_metric("lost_bits")});
    s.ray_count = 1000;
    for (const auto& [outcome, n] : outcomes) s.outcomes[static_cast<std::size_t>(outcome)] = n;
    for (const Outcome o : {Outcome::agree_hit, Outcome::false_miss, Outcome::wrong_primitive})
        s.true_hit_count += s.count(o);
    for (std::uint64_t i = 0; i < s.count(Outcome::agree_hit); ++i) s.metrics[0].add(lost);
    return s;
}

/// A number of pixels with an outcome and a value.
struct Pixels {
    Outcome outcome;
    double value;
    std::uint64_t count;
};
constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// Legend for a picture of these pixels.
std::vector<image::LegendEntry> legend_of(const MetricPaint& paint, std::initializer_list<Pixels> all) {
    const pixel::Look look = paint.look(true);
    pixel::CategoryCounts counts(look.categories.size());
    std::uint64_t pixels = 0;
    for (const auto& [outcome, value, count] : all) {
        counts[paint.pixel(outcome, value).category] += count;
        pixels += count;
    }
    return look.legend(counts, pixels);
}

bool has_word(const std::string& text, const char* words) { return text.find(words) != std::string::npos; }

std::string glance(const FormSummary& summary, const lostbits::FloatFormat& format = binary32,
                   const char* name = "lost_bits") {
    return MetricPaint(*find_metric(name), format).short_summary(summary, 0);
}

}  // namespace

TEST_CASE("the colour of lost bits is a share of the significand in every format", "[metric_paint]") {
    const Metric& lost = *find_metric("lost_bits");
    const auto single = metric_scale(lost, binary32), wide = metric_scale(lost, binary64);
    CHECK(single.hi() == 24);
    CHECK(wide.hi() == 53);
    for (const double share : {0.0, 0.125, 0.25, 0.5, 1.0})
        CHECK(single.colour_of_value(24 * share) == wide.colour_of_value(53 * share));
    CHECK(single.colour_of_value(6) ==
          single.colour_at_position(0.5));  // a quarter of the significand is half of the ramp
    CHECK(single.colour_of_value(1) != single.colour_of_value(0));
    CHECK(wide.colour_of_value(23) != wide.colour_of_value(53));  // not as bad as it gets: 30 are kept
    // Kept bits are not a loss, so their scale is even.
    CHECK(metric_scale(*find_metric("correct_bits"), binary32).colour_of_value(12) == single.colour_at_position(0.5));
    CHECK_FALSE(MetricPaint(lost, binary32).shares_bar_with(*find_metric("correct_bits")));
}

TEST_CASE("scales of magnitudes fit the format", "[metric_paint]") {
    for (const char* name : {"ulp_error", "model_error", "input_error", "rounding_error"}) {
        CHECK(metric_scale(*find_metric(name), binary32).hi() == 0x1p24);
        CHECK(metric_scale(*find_metric(name), binary64).hi() == 0x1p53);
    }
    CHECK(metric_scale(*find_metric("relative_error"), binary32).lo() == 0x1p-30);
    CHECK(metric_scale(*find_metric("relative_error"), binary64).lo() == 0x1p-59);
    CHECK(metric_scale(*find_metric("condition"), binary64).lo() == 1);
    const auto scale = metric_scale(*find_metric("ulp_error"), binary64, BarRange{1, 16});
    CHECK(scale.colour_of_value(4) == scale.colour_at_position(0.5));
    const auto bits = metric_scale(*find_metric("lost_bits"), binary64, BarRange{2, 6});
    CHECK(bits.colour_of_value(4) == bits.colour_at_position(0.5));
}

TEST_CASE("captions begin with decisions and count the hits behind a quantile", "[metric_paint]") {
    CHECK(glance(summary_of(12, {{Outcome::agree_hit, 400}, {Outcome::agree_miss, 600}})) ==
          "p99 12.0 lost, 12.0/24 kept\nof 400 agreed hits");
    // Kept bits are rounded down, and both numbers add up.
    CHECK(glance(summary_of(2.0625, {{Outcome::agree_hit, 400}, {Outcome::agree_miss, 600}})) ==
          "p99 2.1 lost, 21.9/24 kept\nof 400 agreed hits");
    CHECK(glance(summary_of(22.75, {{Outcome::agree_hit, 400}, {Outcome::agree_miss, 600}}), binary64) ==
          "p99 22.8 lost, 30.2/53 kept\nof 400 agreed hits");
    // Shares are of all pixels, for every kind of wrong decision, with the most frequent first.
    CHECK(glance(summary_of(18, {{Outcome::agree_hit, 200},
                                 {Outcome::false_miss, 50},
                                 {Outcome::false_hit, 20},
                                 {Outcome::wrong_primitive, 730}})) ==
          "73% wrong primitive, 5.0% false miss, 2.0% other\np99 18.0 lost, 6.0/24 kept\nof 200 agreed hits");
    CHECK(glance(summary_of(0.7, {{Outcome::agree_hit, 5}, {Outcome::false_miss, 895}, {Outcome::agree_miss, 100}})) ==
          "90% false miss\nno p99: 5 of 900 hits agree");
    CHECK(glance(summary_of(0, {{Outcome::false_miss, 900}, {Outcome::agree_miss, 100}})) ==
          "90% false miss\nno correct hit");
    CHECK(glance(summary_of(0, {{Outcome::agree_miss, 1000}})) == "no ray hits");
    CHECK(MetricPaint(*find_metric("lost_bits"), binary32)
              .caption(summary_of(1, {{Outcome::agree_hit, 999}, {Outcome::not_a_number, 1}}), 0) ==
          "0.1% NaN; 99 of 100 hits: at most 1.0 lost, 23.0/24 kept; of 999 agreed hits");
    // A value that is withheld is not explained.
    CHECK(MetricPaint(*find_metric("lost_bits"), binary32)
              .caption(summary_of(0.7, {{Outcome::agree_hit, 5}, {Outcome::false_miss, 995}}), 0) ==
          ">99% false miss; no p99: 5 of 1000 hits agree");
    CHECK(has_word(MetricPaint(*find_metric("lost_bits"), binary32).quantile_note(), "99 of 100"));
    CHECK(MetricPaint(*find_metric("apart"), binary32).quantile_note().empty());
}

TEST_CASE("the difference of two forms has a unit, a count, and a legend where they do not both hit",
          "[metric_paint]") {
    const Metric& apart = *find_metric("apart");
    const MetricPaint paint(apart, binary32);
    FormSummary s({&apart});
    s.ray_count = 1000;
    for (int i = 0; i < 300; ++i) s.metrics[0].add(i < 200 ? 0.0 : 3.0);
    CHECK(paint.short_summary(s, 0) == "median 0 ulp\nlargest 3 ulp\nof 300 rays that both forms hit");
    const auto legend = legend_of(
        paint, {{Outcome::agree_hit, 0, 200}, {Outcome::agree_hit, 3, 100}, {Outcome::agree_miss, none, 700}});
    REQUIRE(legend.size() == 1);
    CHECK(has_word(legend.front().label, "not both hit"));
    CHECK(legend.front().count == "700 (70.0%)");
    CHECK(legend.front().colour == paint.colour(Outcome::agree_hit, none));
    CHECK(legend.front().colour != image::outcome_colours[static_cast<std::size_t>(Outcome::not_a_number)]);
    CHECK(paint.look(false).widest_legend(1000).size() == 1);
    CHECK(paint.short_summary(FormSummary({&apart}), 0) == "no ray that both forms hit");
    CHECK(has_word(paint.note(), "where both forms hit"));
}

TEST_CASE("every metric is a number with a scale or a category with a name, and can be drawn", "[metric_paint]") {
    lostbits::measure::metric::MetricSet made;
    std::vector<const Metric*> all;
    for (const char* name : {"tolerance:0.1", "enough_bits:12", "contribution:c", "cancellation:c", "step:origin"})
        all.push_back(made.find(name));
    for (const Metric& metric : lostbits::measure::metric::metrics())
        if (!metric.depends_on_forms) all.push_back(&metric);
    for (const Metric* m : all) {
        REQUIRE(m != nullptr);
        CAPTURE(m->name);
        const MetricPaint paint(*m, binary32);
        CHECK(paint.scale().has_value() == m->categories.empty());
        for (std::size_t o = 0; o < image::outcome_colours.size(); ++o) {
            const image::Rgb8 drawn = paint.colour(static_cast<Outcome>(o), none);
            CHECK(std::ranges::find(image::outcome_colours, drawn) != image::outcome_colours.end());
        }
        const auto legend = paint.look(true).widest_legend(1);
        for (std::size_t c = 0; c < m->categories.size(); ++c) {
            const image::Rgb8 drawn = paint.colour(Outcome::agree_hit, static_cast<double>(c));
            CHECK(std::ranges::count(legend, drawn, &image::LegendEntry::colour) == 1);
        }
        // A row whose only ray is a hit without a value.
        FormSummary s({m});
        s.ray_count = s.true_hit_count = s.outcomes[0] = 1;
        CHECK(legend_of(paint, {{Outcome::agree_hit, none, 1}}).size() <= 1);
        CHECK((paint.short_summary(s, 0) + paint.caption(s, 0) + paint.note() + paint.widest_caption(1)).size() > 1);
    }
}

TEST_CASE("shares of culprits are of the rays that have a culprit, and the picture says so", "[metric_paint]") {
    static constexpr std::array<std::string_view, 3> operations{"no rounding", "b*b - c", "sqrt(d)"};
    Metric culprit = *find_metric("culprit");
    culprit.categories = operations;
    const MetricPaint paint(culprit, binary32);
    FormSummary s({&culprit});
    s.ray_count = 1000;
    s.outcomes[static_cast<std::size_t>(Outcome::agree_miss)] = 700;
    s.outcomes[static_cast<std::size_t>(Outcome::agree_hit)] = 300;
    s.categories = {{100, 150, 50}};
    CHECK(paint.short_summary(s, 0) == "75% of 200 culprits:\nb*b - c");
    const auto legend = legend_of(paint, {{Outcome::agree_hit, 0, 100},
                                          {Outcome::agree_hit, 1, 150},
                                          {Outcome::agree_hit, 2, 50},
                                          {Outcome::agree_miss, none, 700}});
    CHECK(paint.caption(s, 0) == "75% of 200 culprits: b*b - c");
    REQUIRE(legend.size() == 4);
    CHECK(legend[0].count == "150 (75.0%)");
    CHECK(legend[1].count == "50 (25.0%)");
    CHECK(legend[2].count == "100");  // a share of another whole, so no share is shown
    CHECK(legend[3].count == "700");
    CHECK(has_word(paint.note(), "of the rays that have a culprit"));
}

TEST_CASE("a sheet marks the formats that also got rounded inputs", "[metric_paint]") {
    lostbits::scene::file::Scene scene;
    const auto note = [&scene](std::initializer_list<const char*> formats) {
        std::vector<lostbits::measure::evaluate::TestedForm> tested_forms;
        for (const char* name : formats) tested_forms.push_back(lostbits::test::row("sphere.unified", name));
        return input_note(scene, tested_forms);
    };
    CHECK(note({"f32", "f64", "p24", "p30"}).empty());
    CHECK(note({"f32", "fp16"}).starts_with("in fp16 the inputs are rounded too"));
    CHECK(note({"bf16", "f32", "p11", "tf32", "bf16"}).starts_with("in bf16, p11 and tf32 the inputs"));
    CHECK(has_word(note({"p23"}), "input_error"));
    scene.inputs = lostbits::scene::file::InputRounding::own;
    CHECK(note({"f32"}).starts_with("each format rounds the ideal scene itself"));
}

TEST_CASE("a quantile of zero is written as 0", "[metric_paint]") {
    CHECK(glance(summary_of(0, {{Outcome::agree_hit, 1000}}), binary32, "excess_bits") ==
          "p99 0 bits\nof 1000 agreed hits");
    CHECK(glance(summary_of(0.25, {{Outcome::agree_hit, 1000}}), binary32, "relative_error") ==
          "p99 0.25\nof 1000 agreed hits");
}

TEST_CASE("a hit without a value has the colour of its outcome, and the legend names it", "[metric_paint]") {
    const MetricPaint paint(*find_metric("lost_bits"), binary32);
    CHECK(paint.colour(Outcome::agree_hit, none) == image::outcome_colours[0]);
    CHECK(legend_of(paint, {{Outcome::agree_hit, 3, 600}, {Outcome::agree_miss, none, 400}}).size() == 1);
    const auto legend = legend_of(
        paint, {{Outcome::agree_hit, 3, 600}, {Outcome::agree_miss, none, 400}, {Outcome::agree_hit, none, 7}});
    REQUIRE(legend.size() == 2);
    CHECK(legend.back().count == "7 (0.7%)");
    CHECK(legend.back().label == "correct hit without a value");
    CHECK(legend.back().colour == image::outcome_colours[0]);
    CHECK(paint.colour(Outcome::wrong_primitive, 0) == image::outcome_colours[6]);
}

TEST_CASE("a sheet is sorted by fewest wrong decisions, then by smallest 99th percentile", "[metric_paint]") {
    const auto of = [](double lost, std::uint64_t missed) {
        FormSummary s = summary_of(lost, {{Outcome::agree_hit, 900 - missed}, {Outcome::false_miss, missed}});
        for (auto& metric : s.metrics) metric.seal();
        return s;
    };
    const FormSummary bad = of(0, 40), good = of(3, 0), better = of(2, 0), blind = of(0, 880);
    // The second cell of the first form, in another format, does not count.
    const std::vector<SheetCell> cells{{0, &bad}, {0, &better}, {1, &good}, {2, &blind}, {3, &better}, {4, &good}};
    CHECK(best_first(5, cells, 0) == std::vector<std::size_t>{3, 1, 4, 0, 2});
    // With as many wrong decisions but too few hits for a 99th percentile, a form comes later.
    const FormSummary few = summary_of(0, {{Outcome::agree_miss, 900}});
    CHECK(best_first(2, std::vector<SheetCell>{{0, &few}, {1, &good}}, 0) == std::vector<std::size_t>{1, 0});

    const MetricPaint paint(*find_metric("lost_bits"), binary32);
    FormSummary seen = of(3, 0);
    CHECK_FALSE(has_word(cell_note(paint, seen, 0), "worst"));
    seen.worst.x = 17;
    seen.worst.y = 4;
    CHECK(has_word(cell_note(paint, seen, 0), "\nworst pixel 17,4"));
    // A wrong decision is worse than any error.
    seen.outcomes[static_cast<std::size_t>(Outcome::false_hit)] = 1;
    const auto place = std::ranges::find(lostbits::measure::evaluate::wrong_decisions, Outcome::false_hit) -
                       lostbits::measure::evaluate::wrong_decisions.begin();
    seen.faults[place] = std::make_unique<lostbits::measure::evaluate::WorstRay>();
    seen.faults[place]->x = 5;
    seen.faults[place]->y = 6;
    CHECK(has_word(cell_note(paint, seen, 0), "\nworst pixel 5,6"));
    // The command above the sheet can be pasted for forms from outside, too.
    const lostbits::scene::file::Scene scene{};
    const auto above = [&](const std::string& named = "mine.toml", const std::string& sheet_with_explanations = "") {
        std::string text;
        for (const auto& line : sheet_subtitle({scene, named, {}, paint, false, false, sheet_with_explanations}))
            text += line + "\n";
        return text;
    };
    CHECK(has_word(above(), "lostbits explain mine.toml --pixel X,Y -i FORM -f FORMAT shows how"));
    attribution::set_plugin_options(" --plugin mine.so");
    CHECK(has_word(above(), "lostbits explain mine.toml --pixel X,Y -i FORM -f FORMAT --plugin mine.so shows how"));
    attribution::set_plugin_options("");
    // Rays of a file have no scene to name.
    CHECK_FALSE(has_word(above(""), "--pixel"));
    CHECK(has_word(above(""), "in the column worst_explain"));
    // The second sheet of a run refers to the one that explains.
    CHECK(has_word(above("mine.toml", "other/contact"), "as explained in other/contact"));
    CHECK_FALSE(has_word(above("mine.toml", "other/contact"), "--pixel"));
    CHECK_FALSE(has_word(cell_note(MetricPaint(*find_metric("iterations"), binary32), seen, 0), "worst"));
}

TEST_CASE("a map says in a sentence which form is best and which is worst", "[finding]") {
    using O = Outcome;
    const auto says = [](auto... each) {
        std::vector<FormSummary> summaries;
        (summaries.push_back(std::move(each)), ...);
        lostbits::measure::evaluate::MapStudy request{.tested_forms = {lostbits::test::row("sphere.unified", "f32"),
                                                                       lostbits::test::row("sphere.schoolbook", "f32"),
                                                                       lostbits::test::row("sphere.press", "f32")},
                                                      .metrics = {find_metric("lost_bits")}};
        request.tested_forms.erase(request.tested_forms.begin() + static_cast<std::ptrdiff_t>(summaries.size()),
                                   request.tested_forms.end());
        return finding_text(request, summaries);
    };
    const auto right = [](double lost) { return summary_of(lost, {{O::agree_hit, 500}, {O::agree_miss, 500}}); };
    CHECK(says(right(2), right(2.5)) == "Both forms keep 21.5 of 24 bits in f32");
    CHECK(says(right(9), right(2), right(5)) == "schoolbook keeps 22 of 24 bits in f32; unified keeps 15");
    CHECK(says(right(2)) == "unified keeps 22 of 24 bits in f32");
    // Of equals the first is named, which is the one whose name stands above their column of the sheet.
    CHECK(says(right(2), right(9), right(9)) == "unified keeps 22 of 24 bits in f32; schoolbook keeps 15");
    CHECK(says(right(2), summary_of(1, {{O::agree_hit, 500}, {O::agree_miss, 275}, {O::false_hit, 225}})) ==
          "unified keeps 22 of 24 bits in f32; schoolbook hits 45 % of the empty rays");
    CHECK(says(right(2), summary_of(1, {{O::false_miss, 500}, {O::agree_miss, 500}})) ==
          "unified keeps 22 of 24 bits in f32; schoolbook misses all 500 true hits");
    CHECK(says(right(2), summary_of(1, {{O::not_a_number, 1000}})) ==
          "unified keeps 22 of 24 bits in f32; schoolbook returns NaN for all 1000 rays");
    CHECK(says(summary_of(2, {{O::agree_hit, 498}, {O::agree_miss, 500}, {O::false_miss, 2}})) ==
          "unified keeps 22 of 24 bits in f32 and misses 2 of the 500 true hits");
    CHECK(says(summary_of(2, {{O::agree_miss, 1000}}), summary_of(2, {{O::agree_miss, 1000}})).empty());
}

}  // namespace test_metric_paint
