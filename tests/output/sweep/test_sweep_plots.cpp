// The plots along a sweep: false hits apart from false misses, the first of them to be seen, and no envelope without a
// line.
#include "output/sweep/sweep_plots.hpp"

#include "catch.hpp"
#include "measure/rows.hpp"
#include "output/helpers.hpp"
#include "output/plot/form_look.hpp"
#include "output/plot/line_plot_parts.hpp"

namespace test_sweep_plots {

using namespace lostbits;
using namespace lostbits::output;
using namespace lostbits::output::test;
using lostbits::testing::row;
using lostbits::testing::TextFile;
using measure::answer::Outcome;
using measure::evaluate::FormSummary;

namespace {

constexpr std::uint64_t rays = 1000;
constexpr std::size_t steps = 40;

/// A sweep whose numbers are made up.
struct Made {
    Made()
        : text(
              "schema = \"lostbits-sweep/1\"\ntitle = \"A test\"\nsource = \"-\"\n[family]\nviews = 2\nrays = 16\n"
              "[[axis]]\nname = \"distance\"\nunit = \"r\"\nspacing = \"log2\"\nfrom = 2\nto = \"0x1p20\"\nsteps = 40\n"
              "set = [\"distance\"]\n"),
          sweep(text.path(), LOSTBITS_DATA_DIR) {
        request = {.sweep = &sweep, .rows = {row("sphere.schoolbook", "f32")}, .metrics = {}};
        for (const char* name : {"lost_bits", "inherent_bits"})
            request.metrics.push_back(measure::metric::find_metric(name));
        for (std::size_t k = 0; k < steps; ++k) {
            measure::sweep::SweepStep& step = made.emplace_back();
            step.values = {sweep.axes.front().values[k]};
            step.rows.emplace_back(request.metrics);
            FormSummary& s = step.rows.back();
            s.rays = s.true_hits = s.outcomes[static_cast<std::size_t>(Outcome::agree_hit)] = rays;
        }
    }
    void put(Outcome o, std::size_t step, std::uint64_t n) {
        made[step].rows[0].outcomes[static_cast<std::size_t>(o)] = n;
    }
    [[nodiscard]] output::sweep::MeasuredSweep measured() const { return {request, made, onsets}; }
    [[nodiscard]] Format format() const { return request.rows[0].format; }

    TextFile text;
    scene::sweep::SweepFile sweep;
    measure::sweep::SweepRequest request;
    std::vector<measure::sweep::SweepStep> made;
    std::vector<measure::sweep::Onset> onsets;
};

/// How many pixels have a colour, in the picture and at the highest and the lowest that do.
struct Found {
    int pixels = 0, top = -1, foot = -1;
};
Found find(const image::PngImage& image, image::Rgb8 colour) {
    Found found;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width * 7 / 10; ++x) {  // without the legend
            if (image.pixels[static_cast<std::size_t>(y * image.width + x)] != colour) continue;
            ++found.pixels;
            if (found.top < 0) found.top = y;
            found.foot = y;
        }
    }
    return found;
}

}  // namespace

TEST_CASE("a single false miss of a thousand rays stands clear of none, and is no false hit") {
    const Scratch folder;
    Made made;
    const image::Rgb8 line = plot::look_colour(plot::form_look(*made.request.rows[0].form));
    const auto drawn = [&](Outcome o) {
        output::sweep::write_wrong_plot(folder / "w.png", made.measured(), made.format(), o);
        return find(backend().read_png(folder / "w.png"), line);
    };
    static_cast<void>(backend());
    const Found none = drawn(Outcome::false_miss);
    CHECK(none.pixels > 300);
    CHECK(none.foot - none.top <= 3);  // level, at 0
    for (std::size_t k = 20; k < steps; ++k) made.put(Outcome::false_miss, k, 1);
    const Found first = drawn(Outcome::false_miss);
    CHECK(std::abs(first.foot - none.foot) <= 1);
    CHECK(none.foot - first.top > 30);
    for (std::size_t k = 20; k < steps; ++k) made.put(Outcome::false_miss, k, rays);
    const Found all = drawn(Outcome::false_miss);
    CHECK(first.top - all.top > 200);  // a thousandth is not near to all
    // No ray truly misses, so that none can be a false hit: a line at 0 would say that the form is good at it.
    CHECK(drawn(Outcome::false_hit).pixels == 0);
    made.made[0].rows[0].true_hits = rays - 1;
    const Found hits = drawn(Outcome::false_hit);
    CHECK(hits.pixels > 300);
    CHECK(hits.foot - hits.top <= 3);

    using Outcomes = std::vector<Outcome>;
    CHECK(wrong_outcomes(made.measured(), made.format()) == Outcomes{Outcome::false_hit, Outcome::false_miss});
    made.put(Outcome::not_a_number, 3, 1);
    CHECK(wrong_outcomes(made.measured(), made.format()) ==
          Outcomes{Outcome::false_hit, Outcome::false_miss, Outcome::not_a_number});
}

TEST_CASE("an envelope is drawn beside the line of a form, and not of one that tells no t") {
    const Scratch folder;
    for (const bool tells : {true, false}) {
        Made made;
        for (auto& step : made.made) {
            if (tells) step.rows[0].metrics[0].add(3.0);
            step.rows[0].metrics[1].add(2.0);
            for (auto& metric : step.rows[0].metrics) metric.seal();
        }
        static_cast<void>(backend());
        output::sweep::write_lost_bits_plot(folder / "l.png", made.measured(), made.format(), 0.99);
        const auto image = backend().read_png(folder / "l.png");
        CAPTURE(tells);
        CHECK((find(image, plot::envelope_fill).pixels > 1000) == tells);
    }
}

}  // namespace test_sweep_plots
