// Rays that are grouped by a column of their file, compared with the same rays judged alone.
#include "measure/judge/files_of_answers.hpp"
#include "measure/judge/judge.hpp"
#include "measure/rows.hpp"

namespace test_groups {
using namespace lostbits;
using namespace lostbits::measure;
using judge::JudgeRequest, judge::JudgeResult;
using scene::test::Columns;
using test::add_answers, test::all_metrics, test::make_ray_columns, test::require_same;

TEST_CASE("the summary of a group is that of its rays alone") {
    const evaluate::TestedForm row = test::row("sphere.press", "f32");
    const std::vector<Primitive<double>> primitives{Sphere<double>{{0, 0, 0}, 1}};
    scene::rays::RayBlock rays;
    std::vector<double> kinds;
    for (int i = 0; i < 40000; ++i) {  // more than one piece
        const double x = 2.4 * (i % 200) / 200 - 1.2, y = 2.4 * (i / 200) / 200.0 - 1.2;
        rays.push({{static_cast<float>(x), static_cast<float>(y), -900}, {0, 0, 1}});
        kinds.push_back(i % 7 == 0 ? 2 : i % 3);
    }
    rays.width = static_cast<int>(rays.size());
    rays.y1 = 1;
    const truth::Band band(scene::rays::RayGroup{rays, primitives, {}});
    const auto answers = answer::evaluate(*row.form, band.inputs(row.format, {}));
    const auto judged = [&](const std::optional<double> only) {
        scene::rays::RayBlock some;
        answer::Answers of_some;
        std::vector<double> own;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            if (only && kinds[i] != *only) continue;
            some.push(rays[i]);
            of_some.t.push_back(answers.t[i]);
            of_some.hit.push_back(answers.hit[i]);
            own.push_back(kinds[i]);
        }
        Columns columns = make_ray_columns(some);
        add_answers(columns, of_some);
        columns.add("kind", own);
        const scene::test::ScratchRayFile file("kinds.bin", scene::test::to_bytes<float>(columns));
        const auto ray_file = scene::ray_file::open_ray_file(
            file.path(),
            {.columns = columns.joined_names(":f32"), .primitive = Shape::sphere, .keeps_own_columns = true});
        const judge::FileForm form("kinds", Shape::sphere, *row.form->info);
        JudgeRequest request{.primitives = primitives, .file_answers_form = &form.form(), .metrics = all_metrics};
        request.tested_forms = {{&form.form(), row.format}};
        if (!only) request.group_column = 0;
        return judge::run_judge(*ray_file, request, {});
    };
    const JudgeResult all = judged({});
    REQUIRE(all.groups.all().size() == 3);
    for (const evaluate::Group& group : all.groups.all()) {
        INFO(group.value);
        JudgeResult alone = judged(std::stod(group.value));
        // Their indices differ.
        alone.summaries[0].worst.x = group.summaries[0].worst.x;
        for (std::size_t k = 0; k < alone.summaries[0].faults.size(); ++k) {
            REQUIRE((alone.summaries[0].faults[k] == nullptr) == (group.summaries[0].faults[k] == nullptr));
            if (alone.summaries[0].faults[k]) alone.summaries[0].faults[k]->x = group.summaries[0].faults[k]->x;
        }
        require_same(alone.summaries[0], group.summaries[0]);
    }
}

TEST_CASE("groups are sorted by number, and groups named by words follow") {
    evaluate::Groups groups, more;
    for (const char* value : {"10", "glass", "9", "-2.5", "1e3", "", "9"}) groups.add(value, 1, {});
    groups.at("9").summaries[0].ray_count = 4;
    for (const char* value : {"9", "100"}) more.add(value, 1, {});
    more.at("9").summaries[0].ray_count = 3;
    groups.append(std::move(more));
    std::string all;
    for (const evaluate::Group& group : groups.all()) all += group.value + ";";
    CHECK(all == "-2.5;9;10;100;1e3;;glass;");
    CHECK(groups.at("9").summaries[0].ray_count == 7);
}

}  // namespace test_groups
