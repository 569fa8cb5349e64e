// Planes of sweeps with two axes: the EXR against the table, whichever way the axes run.
#include "output/sweep/sweep_plots.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <optional>

#include "catch.hpp"
#include "measure/rows.hpp"
#include "output/file/read_csv.hpp"
#include "output/helpers.hpp"
#include "output/image/pixels.hpp"
#include "output/map/map_colour.hpp"
#include "output/sweep/sweep_files.hpp"

namespace test_sweep_planes {

using namespace lostbits;
using namespace lostbits::output;
using namespace lostbits::output::file;
using namespace lostbits::output::image;
using namespace lostbits::output::map;
using namespace lostbits::output::sweep;
using namespace lostbits::output::test;
using lostbits::test::row;
using lostbits::test::TextFile;

namespace {

constexpr std::size_t columns = 4, lines = 3;

std::string axis(const std::string& name, const std::string& from, const std::string& to, std::size_t steps,
                 const std::string& set) {
    return "[[axis]]\nname = \"" + name + "\"\nunit = \"r\"\nspacing = \"log2\"\nfrom = " + from + "\nto = " + to +
           "\nsteps = " + std::to_string(steps) + "\nset = [\"" + set + "\"]\n";
}

std::string sweep_text(bool x_falls, bool y_falls) {
    const std::string low_x = "8", high_x = "\"0x1p12\"", low_y = "\"0x1p-12\"", high_y = "0.25";
    return "schema = \"lostbits-sweep/1\"\ntitle = \"A test\"\nsource = \"-\"\n[sphere_rays]\nviews = 2\nrays = 16\n" +
           axis("distance", x_falls ? high_x : low_x, x_falls ? low_x : high_x, columns, "distance") +
           axis("gap", y_falls ? high_y : low_y, y_falls ? low_y : high_y, lines, "silhouette_gap");
}

struct Planes {
    Planes(bool x_falls, bool y_falls)
        : text(sweep_text(x_falls, y_falls)),
          sweep(text.path(), LOSTBITS_DATA_DIR),
          // In fp16 squares overflow from 256 radii on.
          request{.sweep = sweep,
                  .tested_forms = {row("sphere.unified", "f32"), row("sphere.schoolbook", "fp16")},
                  .metrics = {}} {
        for (const char* name : {"lost_bits", "inherent_bits", "excess_bits"})
            request.metrics.push_back(measure::metric::find_metric(name));
        steps = measure::sweep::run_sweep(request);
        output::sweep::SweepWriter writer(request, folder.path());
        writer.finish(steps, {});
        output::sweep::write_planes(folder.path(), request, steps, true);
    }
    Scratch folder;
    TextFile text;
    scene::sweep::SweepFile sweep;
    measure::sweep::SweepRequest request;
    std::vector<measure::sweep::SweepStep> steps;
};

float number(std::string_view text) {
    return text.empty() ? std::nanf("") : static_cast<float>(std::strtod(std::string(text).c_str(), nullptr));
}

bool same(float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); }

}  // namespace

TEST_CASE("the channels of a plane are the numbers of the table, columns rising, the highest row on top") {
    const std::pair<const char*, const char*> pairs[] = {
        {"bits.lost_p50", "lost_bits_p50"},          {"bits.lost_p99", "lost_bits_p99"},
        {"bits.lost_max", "lost_bits_max"},          {"condition.inherent_p99", "inherent_bits_p99"},
        {"condition.excess_p99", "excess_bits_p99"}, {"class.false_hit", "false_hit"},
        {"class.false_miss", "false_miss"},          {"class.not_a_number", "not_a_number"}};
    std::map<std::string, std::string> bytes;
    for (const bool x_falls : {false, true}) {
        for (const bool y_falls : {true, false}) {
            const Planes planes(x_falls, y_falls);
            CAPTURE(x_falls, y_falls);
            CHECK((planes.sweep.axes[0].values.front() > planes.sweep.axes[0].values.back()) == x_falls);
            const output::file::CsvTable table = read_csv(planes.folder / "samples.csv");
            REQUIRE(table.rows() == columns * lines * 2);
            bool varies = false, any_wrong = false;
            for (const std::string stem : {"sphere.unified.f32", "sphere.schoolbook.fp16"}) {
                const output::image::ExrImage exr = backend().read_exr(planes.folder / (stem + ".exr"));
                REQUIRE((exr.width == static_cast<int>(columns) && exr.height == static_cast<int>(lines)));
                CHECK(exr.channels.size() == std::size(pairs));
                std::size_t seen = 0;
                for (std::size_t r = 0; r < table.rows(); ++r) {
                    const auto cell = [&](const char* name) { return table.find(name)->cells[r]; };
                    if (std::string(cell("form")) + "." + std::string(cell("format")) != stem) continue;
                    ++seen;
                    // 8·2^(3i) and 2^(−12 + 5j): where a pixel lies follows from its values alone.
                    const auto column = static_cast<std::size_t>((std::log2(number(cell("distance"))) - 3) / 3);
                    const auto line = lines - 1 - static_cast<std::size_t>((std::log2(number(cell("gap"))) + 12) / 5);
                    for (const auto& [channel, name] : pairs) {
                        CAPTURE(stem, channel, column, line);
                        REQUIRE(exr.find(channel) != nullptr);
                        const auto& samples = std::get<std::vector<float>>(exr.find(channel)->samples);
                        const float count = std::string_view(channel).starts_with("class.") ? 32.f : 1.f;
                        const float got = samples[line * columns + column];
                        CHECK(same(got, number(cell(name)) / count));
                        varies |= !same(got, samples[0]);
                        any_wrong |= count > 1 && got > 0;
                    }
                }
                CHECK(seen == columns * lines);
                const auto attribute = [&](const std::string& name) {
                    for (const auto& [key, value] : exr.attributes) {
                        if (key == "lostbits:" + name) return value;
                    }
                    return std::string("none");
                };
                CHECK(attribute("schema") == "lostbits-plane/1");
                CHECK(attribute("sweep") == "t");
                CHECK(attribute("form") + "." + attribute("format") == stem);
                CHECK((attribute("x") == "distance" && attribute("y") == "gap"));
                CHECK(attribute("x_values") == "8 64 512 4096");
                CHECK(attribute("y_values") == "0.25 0.0078125 0.000244140625");
                // The same plane, whichever way the axes run.
                for (const std::string& file : {stem + ".exr", stem + ".png", std::string("contact.png")}) {
                    const auto [first, fresh] = bytes.try_emplace(file, contents(planes.folder / file));
                    CHECK_FALSE(first->second.empty());
                    CHECK(first->second == contents(planes.folder / file));
                }
            }
            CHECK(varies);
            CHECK(any_wrong);
        }
    }
}

TEST_CASE("a plane's picture marks wrong forms by outline and outcome colour, and its sheet pales hard problems") {
    const Planes planes(false, false);
    const std::size_t lost = 0, excess = 2;
    const auto sheet = backend().read_png(planes.folder / "contact.png");
    CHECK(rim_is_blank(sheet));
    const LostBitsScale on_sheet(planes.request.tested_forms);
    for (std::size_t r = 0; r < 2; ++r) {
        const measure::evaluate::TestedForm& what = planes.request.tested_forms[r];
        const auto image =
            backend().read_png(planes.folder / (std::string(what.form->info->name) + "." + what.format.name + ".png"));
        CHECK(rim_is_blank(image));
        const output::image::ColourScale scale =
            metric_scale(*measure::metric::find_metric("lost_bits"), what.format.parameters);
        int plain_cells = 0, wrong_cells = 0;
        std::map<double, int> highest;  // in the sheet, of the first column's gaps
        for (const measure::sweep::SweepStep& step : planes.steps) {
            const measure::evaluate::FormSummary& s = step.summaries[r];
            const double p99 = s.metrics[lost].quantile(0.99);
            constexpr measure::answer::Outcome kinds[] = {measure::answer::Outcome::false_hit,
                                                          measure::answer::Outcome::false_miss,
                                                          measure::answer::Outcome::not_a_number};
            const measure::answer::Outcome worst =
                std::ranges::max(kinds, {}, [&](measure::answer::Outcome o) { return s.count(o); });
            const auto wrong = s.count(kinds[0]) + s.count(kinds[1]) + s.count(kinds[2]);
            CAPTURE(what.format.name, step.values[0], step.values[1], wrong, p99);
            std::optional<output::image::Rgb8> expected, small;
            if (2 * wrong > s.ray_count) {
                expected = small = output::image::outcome_colours[static_cast<std::size_t>(worst)];
                ++wrong_cells;
            } else if (s.agreement().is_enough()) {
                const bool plain = p99 >= 1 && s.metrics[excess].quantile(0.99) < 1;
                expected = scale.colour_of_value(p99);
                small = on_sheet.colour(p99, what.format.parameters);
                if (plain) small = make_paler(*small);
                plain_cells += plain;
            }
            if (expected) CHECK(find_block(image, *expected, 40, 40).has_value());
            if (!small) continue;
            const auto block = find_block(sheet, *small, 40, 40);
            REQUIRE(block);
            if (step.values[0] == planes.sweep.axes[0].values[0]) highest[step.values[1]] = block->second;
        }
        if (r == 1) CHECK(wrong_cells > 0);
        if (r == 0) CHECK(plain_cells > 0);
        // Upwards the gap grows: where two lines have one colour, both are found where the upper is.
        if (r == 0) CHECK(highest.begin()->second > highest.rbegin()->second);
    }
}

}  // namespace test_sweep_planes
