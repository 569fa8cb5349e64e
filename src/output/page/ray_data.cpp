#include "output/page/ray_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>

#include "intersect/process/parallel.hpp"
#include "measure/blame/explanation.hpp"
#include "output/blame/explain_text.hpp"
#include "scene/rays/made_rows.hpp"

namespace lostbits::output::page {

using measure::blame::Explanation;
using measure::evaluate::EvaluationRequest;
using measure::evaluate::FormSummary;
using measure::evaluate::TestedForm;

namespace {

/// The pixel of the median error of the finite ones, the first of equal ones; none where there are none.
std::vector<std::size_t> median_of(std::span<const float> sizes) {
    std::vector<std::size_t> all;
    for (std::size_t i = 0; i < sizes.size(); ++i) {
        if (std::isfinite(sizes[i])) all.push_back(i);
    }
    if (all.empty()) return all;
    const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
    std::ranges::nth_element(all, middle, {}, [&](std::size_t i) { return std::pair{sizes[i], i}; });
    return {*middle};
}

/// Of each part of a picture its worst pixel, the first of equally bad ones; of parts without an error none.
std::vector<std::size_t> worst_of_parts(std::span<const float> sizes, std::size_t width) {
    constexpr std::size_t parts = parts_each_way;
    const std::size_t height = sizes.size() / width;
    std::vector<std::size_t> all;
    for (std::size_t part = 0; part < parts * parts; ++part) {
        const std::size_t column = part % parts, line = part / parts;
        float largest = -1;
        std::size_t found = 0;
        for (std::size_t y = line * height / parts; y < (line + 1) * height / parts; ++y) {
            for (std::size_t x = column * width / parts; x < (column + 1) * width / parts; ++x) {
                if (!(sizes[y * width + x] > largest)) continue;
                found = y * width + x;
                largest = sizes[found];
            }
        }
        if (largest >= 0) all.push_back(found);
    }
    return all;
}

Json row_json(const blame::OperationRow& r) {
    const auto value = [&r](double x) { return r.digits == 0 ? Json(x != 0) : number_json(x); };
    return Json::array({r.node, r.name, r.formula, value(r.computed), value(r.exact), r.digits, r.off, r.cancelled,
                        r.local, r.own, r.share, r.culprit, r.turned});
}

Json lines_json(const std::string& text) {
    Json lines = Json::array();
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
}

std::optional<blame::MarchEnd> end_of_march(const TestedForm& row, const measure::answer::OneRay& ray) {
    if (!row.form->log) return {};
    return blame::MarchEnd{measure::answer::march_log(*row.form, row.format, ray),
                           ray.inputs(*row.form, row.format).all.march.value()};
}

/// The sentences that stand above the table of `explain` and below it, and the table.
Json ray_json(const ChosenRay& at, const Explanation& x, const std::optional<blame::MarchEnd>& march) {
    const blame::OperationWords words(x);
    const blame::OperationTable table = blame::operation_table(x, words, false);
    Json json{{"x", at.x},
              {"y", at.y},
              {"why", at.why},
              {"says", lines_json(blame::verdict_alone(x, march))},
              {"sums", lines_json(blame::sums_text(x, words))},
              {"subject", words.subject()},
              {"earlier", table.first},
              {"rows", array_of(table.rows, row_json)}};
    if (x.solids > 1 && is_solid(x.form->shape)) json["solid"] = x.solid;
    return json;
}

}  // namespace

std::vector<ChosenRay> choose_rays(const FormSummary& summary, std::span<const float> sizes, int width) {
    std::vector<ChosenRay> all;
    const auto add = [&all](std::int64_t x, int y, std::string why) {
        const auto found = std::ranges::find_if(all, [&](const ChosenRay& r) { return r.x == x && r.y == y; });
        if (found == all.end()) all.push_back({static_cast<int>(x), y, {std::move(why)}});
        else found->why.push_back(std::move(why));
    };
    const auto add_pixel = [&](std::size_t i, const char* why) {
        const auto w = static_cast<std::size_t>(width);
        add(static_cast<std::int64_t>(i % w), static_cast<int>(i / w), why);
    };
    if (const auto* const worst = summary.worst_ray()) add(worst->x, worst->y, "worst ray");
    for (const measure::answer::Outcome wrong : measure::answer::wrong_decisions) {
        if (const auto* const first = summary.first_of(wrong))
            add(first->x, first->y,
                fmt::format("{}: the first", measure::answer::outcome_names[static_cast<std::size_t>(wrong)]));
    }
    if (summary.worst.x >= 0) add(summary.worst.x, summary.worst.y, "largest error");
    for (const std::size_t i : median_of(sizes)) add_pixel(i, "median error");
    for (const std::size_t i : worst_of_parts(sizes, static_cast<std::size_t>(width)))
        add_pixel(i, "worst of its part");
    return all;
}

Json rays_json(const EvaluationRequest& request, const TestedForm& row, const std::vector<ChosenRay>& rays) {
    const auto* const maker = scene::rays::maker_of(*row.form);
    const scene::file::Scene scene = maker ? with_rays(*request.scene, *maker) : *request.scene;
    std::vector<Json> explained(rays.size());
    intersect::process::in_parallel(0, rays.size(), [&](std::size_t i) {
        measure::answer::OneRay ray(scene, rays[i].x, rays[i].y, request.limit);
        ray.judge_by(row.judged);
        const Explanation x = measure::blame::explain_alone(*row.form, row.format, ray);
        explained[i] = ray_json(rays[i], x, end_of_march(row, ray));
    });
    return array_of(explained, [](const Json& json) { return json; });
}

}  // namespace lostbits::output::page
