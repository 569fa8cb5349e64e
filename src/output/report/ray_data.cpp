#include "output/report/map_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>

#include "intersect/process/parallel.hpp"
#include "measure/attribution/explanation.hpp"
#include "output/attribution/explain_text.hpp"
#include "scene/rays/composed_forms.hpp"

namespace lostbits::output::report {

using measure::attribution::Explanation;
namespace {

/// Pixel of the median of the finite errors; ties go to the first pixel. Nothing if no error is finite.
std::optional<std::size_t> median_pixel(std::span<const float> error_sizes) {
    std::vector<std::size_t> finite_pixels;
    for (std::size_t i = 0; i < error_sizes.size(); ++i) {
        if (std::isfinite(error_sizes[i])) finite_pixels.push_back(i);
    }
    if (finite_pixels.empty()) return {};
    const auto middle = finite_pixels.begin() + static_cast<std::ptrdiff_t>(finite_pixels.size() / 2);
    std::ranges::nth_element(finite_pixels, middle, {}, [&](std::size_t i) { return std::pair{error_sizes[i], i}; });
    return *middle;
}

/// Indices from `first` to before `last`.
struct IndexRange {
    std::size_t first, last;
    [[nodiscard]] double offset_from_middle(std::size_t i) const {
        return static_cast<double>(i) + 0.5 - static_cast<double>(first + last) / 2;
    }
};

/// Range of part k of `n` adjacent pixels.
IndexRange part_range(std::size_t n, std::size_t k) { return {k * n / parts_each_way, (k + 1) * n / parts_each_way}; }

/// Worst pixel of a part of a picture, or nothing if no pixel has an error. Among equally bad pixels, the one nearest
/// to the middle of the part.
std::optional<std::size_t> worst_pixel(std::span<const float> error_sizes, std::size_t width, IndexRange columns,
                                       IndexRange rows) {
    std::optional<std::size_t> worst_index;
    std::pair<float, double> worst{-1, 0};  // the error, and minus the distance from the middle
    for (std::size_t y = rows.first; y < rows.last; ++y) {
        for (std::size_t x = columns.first; x < columns.last; ++x) {
            const std::size_t i = y * width + x;
            const std::pair candidate{error_sizes[i],
                                      -std::hypot(columns.offset_from_middle(x), rows.offset_from_middle(y))};
            if (std::isnan(error_sizes[i]) || candidate <= worst) continue;
            worst_index = i;
            worst = candidate;
        }
    }
    return worst_index;
}

Json operation_json(const attribution::OperationRow& r) {
    const auto value = [&r](double x) { return r.digits == 0 ? Json(x != 0) : number_json(x); };
    return Json::array({r.node, r.name, r.formula, value(r.computed), value(r.exact), r.digits, r.error_ulps,
                        r.cancelled, r.local_bits, r.rounding_ulps, r.contribution_ulps, r.is_culprit,
                        r.is_branch_flipped});
}

Json lines_json(const std::string& text) {
    Json lines = Json::array();
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
}

/// The table of `explain`, and the sentences above and below it.
Json ray_json(const ChosenRay& chosen, const Explanation& explanation,
              const std::optional<attribution::MarchEnd>& march) {
    const attribution::OperationView view(explanation);
    const attribution::OperationTable table = attribution::operation_table(explanation, view, false);
    Json json{{"x", chosen.x},
              {"y", chosen.y},
              {"why", chosen.reasons},
              {"says", lines_json(attribution::make_verdict(explanation, march).text())},
              {"sums", lines_json(attribution::sums_text(explanation, view))},
              {"subject", view.subject()},
              {"earlier", table.first_node},
              {"rows", json_array(table.rows, operation_json)}};
    if (explanation.primitive_count > 1 && is_primitive(explanation.form->shape))
        json["primitive"] = explanation.primitive_index;
    return json;
}

}  // namespace

std::vector<ChosenRay> choose_rays(const FormSummary& summary, std::span<const float> error_sizes, int width) {
    std::vector<ChosenRay> chosen;

    // A ray that is chosen again gets a further reason.
    const auto add = [&chosen](std::int64_t x, int y, std::string reason) {
        const auto known_ray = std::ranges::find_if(chosen, [&](const ChosenRay& r) { return r.x == x && r.y == y; });
        if (known_ray == chosen.end()) chosen.push_back({static_cast<int>(x), y, {std::move(reason)}});
        else known_ray->reasons.push_back(std::move(reason));
    };
    const auto picture_width = static_cast<std::size_t>(width);
    const auto add_pixel = [&](std::size_t i, const char* reason) {
        add(static_cast<std::int64_t>(i % picture_width), static_cast<int>(i / picture_width), reason);
    };

    // Rays that the summary names.
    if (const auto* const worst = summary.worst_ray()) add(worst->x, worst->y, "worst ray");
    for (const measure::answer::Outcome wrong : measure::answer::wrong_decisions) {
        if (const auto* const first = summary.first_of(wrong))
            add(first->x, first->y,
                fmt::format("{}: the first", measure::answer::outcome_names[static_cast<std::size_t>(wrong)]));
    }
    if (summary.worst.x >= 0) add(summary.worst.x, summary.worst.y, "largest error");

    // Rays chosen by the sizes of their errors.
    if (const auto i = median_pixel(error_sizes)) add_pixel(*i, "median error");
    for (std::size_t part = 0; part < parts_each_way * parts_each_way; ++part) {
        const IndexRange columns = part_range(picture_width, part % parts_each_way),
                         rows = part_range(error_sizes.size() / picture_width, part / parts_each_way);
        if (const auto i = worst_pixel(error_sizes, picture_width, columns, rows))
            add_pixel(*i, "worst in its part of the picture");
    }
    return chosen;
}

Json rays_json(const MapStudy& study, const TestedForm& tested_form, const std::vector<ChosenRay>& rays) {
    const auto* const generator = scene::rays::generator_of(*tested_form.form);
    const scene::file::Scene scene = generator ? with_ray_generator(*study.scene, *generator) : *study.scene;
    std::vector<Json> explained(rays.size());
    intersect::process::in_parallel(0, rays.size(), [&](std::size_t i) {
        measure::answer::OneRay ray(scene, rays[i].x, rays[i].y, study.limit);
        ray.set_touching(tested_form.touching);
        const Explanation explanation = measure::attribution::explain_alone(*tested_form.form, tested_form.format, ray);
        explained[i] =
            ray_json(rays[i], explanation, attribution::find_march_end(*tested_form.form, tested_form.format, ray));
    });
    return json_array(explained, [](const Json& json) { return json; });
}

}  // namespace lostbits::output::report
