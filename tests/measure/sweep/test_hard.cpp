// The worst rays that searches found, kept in data/hard. Each ray still has the measured value in its name.
#include <fmt/format.h>

#include <regex>
#include <set>

#include "catch.hpp"
#include "measure/rows.hpp"
#include "measure/sweep/sweep.hpp"
#include "scene/sweep/search_file.hpp"

namespace test_hard {

using namespace lostbits;
using namespace lostbits::test;

TEST_CASE("every hard ray has the measured value in its name") {
    // `sphere.press in f32: lost_bits 6.40002`, or an outcome in place of a metric and its value, perhaps with how far
    // away the sphere is.
    static const std::regex name(R"((\S+) in (\S+): (\w+)(?: at (\S+) radii)?(?: (\S+))?)");
    int files = 0, values = 0, decisions = 0, distances = 0;
    for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(LOSTBITS_DATA_DIR) / "hard")) {
        const scene::sweep::CaseFile file(entry.path());
        ++files;
        std::set<std::string> rows;
        for (std::size_t i = 0; i < file.size(); ++i) {
            INFO(file.id << ": " << file.name(i));
            std::smatch part;
            REQUIRE(std::regex_match(file.name(i), part, name));
            rows.insert(part[1].str() + " " + part[2].str());
            const std::string what = part[3].str();
            const bool is_value = part[5].matched;
            const measure::metric::Metric* metric = measure::metric::find_metric(is_value ? what : "lost_bits");
            REQUIRE(metric != nullptr);
            const measure::sweep::CaseRequest request{.file = file,
                                                      .tested_forms = {row(part[1].str(), part[2].str())},
                                                      .metrics = {metric, measure::metric::find_metric("excess_bits")}};
            // In the file the numbers are those of the format: rounding to it again must change none.
            for (const auto& group : file.rays(i, request.tested_forms[0].format.parameters)) {
                const auto exact = file.rays(i, binary64).front();
                CHECK(group.rays.ox == exact.rays.ox);
                CHECK(group.rays.dz == exact.rays.dz);
                CHECK(group.primitives[0].numbers == exact.primitives[0].numbers);
            }
            if (part[4].matched) {
                ++distances;
                const auto group = file.rays(i, binary64).front();
                const double radii = scene::sweep::distance_in_radii(group.rays[0], group.primitives[0].sphere());
                CHECK(fmt::format("{:.6g}", radii) == part[4].str());
            }
            const measure::evaluate::FormSummary s = measure::sweep::run_cases_together(request, 0, {i});
            REQUIRE(s.ray_count == 1);
            if (is_value) {
                ++values;
                CHECK(s.count(measure::answer::Outcome::agree_hit) == 1);
                CHECK(fmt::format("{:.6g}", s.metrics[0].quantile(1)) == part[5].str());
            } else {
                ++decisions;
                const auto outcome = std::ranges::find(measure::answer::outcome_names, what);
                REQUIRE(outcome != measure::answer::outcome_names.end());
                CHECK(s.outcomes[outcome - measure::answer::outcome_names.begin()] == 1);
            }
        }
        CHECK(rows.size() == file.size());  // a row is named once
        if (!file.accepts(Shape::sphere)) continue;
        for (const measure::evaluate::TestedForm& tested_form : all_rows(Shape::sphere, {"f32", "f64"})) {
            INFO(file.id << " lacks " << tested_form.form->info->name << " in " << tested_form.format.name);
            CHECK(rows.count(std::string(tested_form.form->info->name) + " " + tested_form.format.name) == 1);
        }
    }
    CHECK(files >= 2);
    CHECK(values > 60);
    CHECK(decisions >= 9);
    CHECK(distances > 20);
}

}  // namespace test_hard
