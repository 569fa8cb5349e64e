// The plots along a sweep: false hits apart from false misses, the first of them to be seen, no envelope without a
// line, and where numbers stop meaning anything.
#include "output/image/figure.hpp"
#include "output/sweep/sweep_plots.hpp"

#include <cmath>

#include "catch.hpp"
#include "measure/rows.hpp"
#include "output/helpers.hpp"
#include "output/plot/form_look.hpp"
#include "output/plot/line_plot_parts.hpp"

namespace test_sweep_plots {

using namespace lostbits;
using namespace lostbits::output;
using namespace lostbits::output::test;
using lostbits::test::row;
using lostbits::test::TextFile;
using measure::answer::Outcome;
using measure::evaluate::FormSummary;

namespace {

constexpr std::uint64_t rays = 1000;
constexpr std::size_t steps = 40;

/// A sphere of radius 1 along the distance in radii, or one of another axis.
std::string make_sweep_file(const std::string& distribution, const std::string& axis, const std::string& from,
                            const std::string& to, std::size_t count = 9) {
    return "schema = \"lostbits-sweep/1\"\ntitle = \"A test\"\nsource = \"-\"\n[sphere_rays]\nviews = 2\n" +
           distribution + "\n[[axis]]\nname = \"" + axis + "\"\nspacing = \"log2\"\nfrom = " + from + "\nto = " + to +
           "\nsteps = " + std::to_string(count) + "\nset = [\"" + axis + "\"]\n";
}

std::optional<output::sweep::AxisPart> part_of(const std::string& text, const FloatFormat& format) {
    const TextFile file(text);
    return output::sweep::too_far_part(scene::sweep::SweepFile(file.path(), LOSTBITS_DATA_DIR), format);
}

/// A sweep whose numbers are made up.
struct MadePlots {
    MadePlots()
        : text(make_sweep_file("rays = 16", "distance", "2", "\"0x1p20\"", steps)),
          sweep(text.path(), LOSTBITS_DATA_DIR),
          request{.sweep = sweep, .tested_forms = {row("sphere.schoolbook", "f32")}, .metrics = {}} {
        for (const char* name : {"lost_bits", "inherent_bits"})
            request.metrics.push_back(measure::metric::find_metric(name));
        for (std::size_t k = 0; k < steps; ++k) {
            measure::sweep::SweepStep& step = made.emplace_back();
            step.values = {sweep.axes.front().values[k]};
            step.summaries.emplace_back(request.metrics);
            FormSummary& s = step.summaries.back();
            s.ray_count = s.true_hit_count = s.outcomes[static_cast<std::size_t>(Outcome::agree_hit)] = rays;
        }
    }
    void put(Outcome o, std::size_t step, std::uint64_t n) {
        made[step].summaries[0].outcomes[static_cast<std::size_t>(o)] = n;
    }
    [[nodiscard]] output::sweep::MeasuredSweep measured() const { return {request, made, onsets}; }
    [[nodiscard]] Format format() const { return request.tested_forms[0].format; }

    TextFile text;
    scene::sweep::SweepFile sweep;
    measure::sweep::SweepRequest request;
    std::vector<measure::sweep::SweepStep> made;
    std::vector<measure::sweep::Onset> onsets;
};

/// Number of pixels with a colour, and the highest and lowest line that has one.
struct FoundMarks {
    int pixels = 0, top = -1, foot = -1;
};
FoundMarks find(const image::PngImage& image, image::Rgb8 colour) {
    FoundMarks found;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width * 7 / 10; ++x) {  // without the legend
            if (image.pixels[y * image.width + x] != colour) continue;
            ++found.pixels;
            if (found.top < 0) found.top = y;
            found.foot = y;
        }
    }
    return found;
}

}  // namespace

TEST_CASE("a plot of one false miss in a thousand rays differs from that of none, and of a false hit") {
    const Scratch folder;
    MadePlots made;
    const image::Rgb8 line = plot::look_colour(plot::form_look(*made.request.tested_forms[0].form));
    const auto drawn = [&](Outcome o) {
        output::image::save_figure(folder / "w.png",
                                   output::sweep::draw_outcome_plot(made.measured(), made.format(), o));
        return find(backend().read_png(folder / "w.png"), line);
    };
    static_cast<void>(backend());
    const FoundMarks none = drawn(Outcome::false_miss);
    CHECK(none.pixels > 300);
    CHECK(none.foot - none.top <= 3);  // level, at 0
    for (std::size_t k = 20; k < steps; ++k) made.put(Outcome::false_miss, k, 1);
    const FoundMarks first = drawn(Outcome::false_miss);
    CHECK(std::abs(first.foot - none.foot) <= 1);
    CHECK(none.foot - first.top > 30);
    for (std::size_t k = 20; k < steps; ++k) made.put(Outcome::false_miss, k, rays);
    const FoundMarks all = drawn(Outcome::false_miss);
    CHECK(first.top - all.top > 200);  // a thousandth is not near to all
    // No ray truly misses, so that none can be a false hit: a line at 0 would say that the form is good at it.
    CHECK(drawn(Outcome::false_hit).pixels == 0);
    CHECK(backend().read_png(folder / "w.png").height < 200);  // a sentence, without a frame
    made.made[0].summaries[0].true_hit_count = rays - 1;
    const FoundMarks hits = drawn(Outcome::false_hit);
    CHECK(hits.pixels > 300);
    CHECK(hits.foot - hits.top <= 3);

    using Outcomes = std::vector<Outcome>;
    CHECK(wrong_outcomes(made.measured(), made.format()) == Outcomes{Outcome::false_hit, Outcome::false_miss});
    made.put(Outcome::not_a_number, 3, 1);
    CHECK(wrong_outcomes(made.measured(), made.format()) ==
          Outcomes{Outcome::false_hit, Outcome::false_miss, Outcome::not_a_number});
}

TEST_CASE("an envelope is drawn for a form that returns t, and not for one that does not") {
    const Scratch folder;
    for (const bool tells : {true, false}) {
        MadePlots made;
        for (auto& step : made.made) {
            if (tells) step.summaries[0].metrics[0].add(3.0);
            step.summaries[0].metrics[1].add(2.0);
            for (auto& metric : step.summaries[0].metrics) metric.seal();
        }
        static_cast<void>(backend());
        output::image::save_figure(folder / "l.png",
                                   output::sweep::draw_lost_bits_plot(made.measured(), made.format(), 0.99));
        const auto image = backend().read_png(folder / "l.png");
        CAPTURE(tells);
        CHECK((find(image, plot::envelope_fill).pixels > 1000) == tells);
    }
}

TEST_CASE("an ulp of the distance is as wide as the sphere from 2^p radii on", "[too_far]") {
    // In [2^24, 2^25) an ulp of a float is 2, the width of a unit sphere; before that it is 1.
    const std::string text = make_sweep_file("rays = 2\nradius = 1", "distance", "4", "\"0x1p40\"");
    const auto single = part_of(text, binary32);
    REQUIRE(single.has_value());
    CHECK(std::fabs(single->from / 0x1p24 - 1) <= 0x1p-8);
    CHECK(single->to == 0x1p40);
    CHECK_FALSE(part_of(text, binary64).has_value());
    const auto brain = part_of(text, bfloat16);
    REQUIRE(brain.has_value());
    CHECK(std::fabs(brain->from / 0x1p8 - 1) <= 0x1p-5);
    CHECK_FALSE(part_of(make_sweep_file("rays = 2\nradius = 1", "distance", "4", "1024"), binary32).has_value());
    const auto all = part_of(make_sweep_file("rays = 2\nradius = 1", "distance", "\"0x1p30\"", "\"0x1p40\""), binary32);
    REQUIRE(all.has_value());
    CHECK((all->from == 0x1p30 && all->to == 0x1p40));
    // The direction of the axis does not matter.
    const auto falling = part_of(make_sweep_file("rays = 2\nradius = 1", "distance", "\"0x1p40\"", "4"), binary32);
    REQUIRE(falling.has_value());
    CHECK((falling->from == single->from && falling->to == single->to));
}

TEST_CASE("a quantile over too few agreed hits leaves a gap", "[too_far]") {
    measure::evaluate::FormSummary s;
    s.ray_count = s.true_hit_count = 100;
    s.metrics.resize(1);
    for (int k = 0; k < 10; ++k) s.metrics[0].add(3);
    s.metrics[0].seal();
    auto& agreed = s.outcomes[static_cast<std::size_t>(measure::answer::Outcome::agree_hit)];
    agreed = 10;
    CHECK(output::sweep::drawn_quantile(s, 0, 0.5) == 3);
    agreed = 9;
    CHECK(std::isnan(output::sweep::drawn_quantile(s, 0, 0.5)));
    CHECK(output::sweep::gap_text() == "no value where fewer than 10 % of the hits agree");
}

}  // namespace test_sweep_plots
