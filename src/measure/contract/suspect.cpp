#include "measure/contract/suspect.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>

#include "measure/map/culprit_order.hpp"
#include "measure/truth/missing.hpp"

namespace lostbits::measure::contract {
namespace {

constexpr std::size_t most_rays = 4096;

/// Where the line enters and leaves a solid, in double: good to many more bits than are asked about.
struct Line {
    double near, far;
};

std::optional<Line> line_through(const Ray<double>& ray, const Solid<double>& solid) {
    if (solid.shape == Shape::box) {
        Line line{-HUGE_VAL, HUGE_VAL};
        for (int k = 0; k < 3; ++k) {
            const double a = (solid.box().lo[k] - ray.origin[k]) / ray.direction[k];
            const double b = (solid.box().hi[k] - ray.origin[k]) / ray.direction[k];
            line = {std::fmax(line.near, std::fmin(a, b)), std::fmin(line.far, std::fmax(a, b))};
        }
        return line.near <= line.far ? std::optional(line) : std::nullopt;
    }
    const Sphere<double> sphere = solid.sphere();
    const Vec<double> f = ray.origin - sphere.centre, d = ray.direction;
    const double a = dot(d, d), middle = -dot(f, d) / a;
    const Vec<double> beside = f + middle * d;
    const double left = sphere.radius * sphere.radius - dot(beside, beside);
    if (!(left >= 0)) return std::nullopt;
    return Line{middle - std::sqrt(left / a), middle + std::sqrt(left / a)};
}

bool is_about(double x, double y) { return std::fabs(x - y) <= 0x1p-8 * std::fabs(y); }

bool is_right(const Judged& j) {
    if (j.hit != j.truly_hits) return false;
    return !j.hit || std::isnan(j.t) || is_about(j.t, j.true_t);
}

/// The answer for a sphere of another radius. A radius that would be the same explains what is right.
bool fits_radius(const Judged& j, double radius) {
    if (j.solid.shape != Shape::sphere) return false;
    if (is_about(radius, j.solid.sphere().radius)) return is_right(j);
    Sphere<double> other = j.solid.sphere();
    other.radius = radius;
    const auto line = line_through(j.ray, Solid<double>(other));
    const bool ahead = line && line->far >= 0;
    if (!ahead || !j.hit || std::isnan(j.t)) return ahead == j.hit;
    return is_about(j.t, line->near >= 0 ? line->near : line->far);
}

bool is_in_other_measure(const Judged& j) {
    return j.hit && j.truly_hits && !is_about(j.other_measure, j.true_t) && is_about(j.t, j.other_measure);
}

/// Something that a contract may have said wrongly: whether it explains an answer.
struct Reason {
    const char* words;
    std::function<bool(const Judged&)> explains;
    /// Whether it would change every answer: then it explains the right ones too, or it is not the reason. A march that
    /// ends early misses near the rim, as a smaller sphere would, and is right in the middle, where that is not.
    bool of_all = false;
};

const std::array<Reason, 9>& reasons() {
    static const std::array<Reason, 9> all{{
        {"t is a distance, not the ray's parameter: it seems to take directions of unit length; say so "
         "(unit_direction, direction=unit, --direction unit)",
         [](const Judged& j) { return !j.unit && is_in_other_measure(j); }},
        {"t is the ray's parameter, not a distance: leave out what says that directions have unit length "
         "(unit_direction, direction=unit, --direction unit)",
         [](const Judged& j) { return j.unit && is_in_other_measure(j); }},
        {"the radius seems to be taken for its square; hand over radius * radius",
         [](const Judged& j) { return fits_radius(j, std::sqrt(j.solid.numbers[3])); }, true},
        {"the radius seems to be squared once too often; hand over radius",
         [](const Judged& j) { return fits_radius(j, j.solid.numbers[3] * j.solid.numbers[3]); }, true},
        {"the radius seems to be taken for a diameter; hand over 2 * radius, or write the radius that was meant "
         "(--sphere)",
         [](const Judged& j) { return fits_radius(j, j.solid.numbers[3] / 2); }, true},
        {"a diameter seems to be handed over for the radius",
         [](const Judged& j) { return fits_radius(j, j.solid.numbers[3] * 2); }, true},
        {"it answers with the far root; the first with t >= 0 is asked for, or near before far (roots)",
         [](const Judged& j) {
             const auto line = line_through(j.ray, j.solid);
             return j.hit && line && !is_about(line->far, j.true_t) && is_about(j.t, line->far);
         }},
        {"t has the wrong sign; is the direction reversed?",
         [](const Judged& j) { return j.hit && j.truly_hits && is_about(j.t, -j.true_t); }},
        {"it hits what lies behind the ray; say that it answers for the whole line (whole_line, flags=line)",
         [](const Judged& j) {
             const auto line = line_through(j.ray, j.solid);
             return j.hit && !j.truly_hits && line && line->far < 0;
         }},
    }};
    return all;
}

/// What a row makes of the rays of a band.
void judge(const truth::Band& band, const map::MapRow& row, std::vector<Judged>& rays) {
    const truth::FormatInputs in =
        band.inputs(row.format, {.unit_rays = row.form->info->direction == intersect::Direction::unit});
    const answer::Answers answers = answer::evaluate(*row.form, in);
    const bool unit = row.form->info->direction == intersect::Direction::unit;
    for (std::size_t i = 0; i < band.pixels() && rays.size() < most_rays; ++i) {
        const truth::Truth& truth = band.truth(i, row.convention());
        if (truth.decision == truth::Truth::Decision::unresolved) continue;
        const int object = truth.is_hit() ? truth.object : std::max(0, answers.object[i]);
        rays.push_back(judged(in.rays_for(*row.form->info)[i], in.solids[static_cast<std::size_t>(object)], truth, unit,
                              answers.hit[i] != 0, answers.t[i]));
    }
}

}  // namespace

Judged judged(const Ray<double>& ray, const Solid<double>& solid, const truth::Truth& truth, bool unit, bool hit,
              double t) {
    Judged j{.ray = ray, .solid = solid, .truly_hits = truth.is_hit(), .unit = unit, .hit = hit, .t = t};
    const auto number = [](const truth::Certified& x) { return std::ldexp(x.hi, static_cast<int>(x.exponent)); };
    if (truth.is_hit()) {
        j.true_t = number(unit ? truth.distance : truth.t);
        j.other_measure = number(unit ? truth.t : truth.distance);
    }
    return j;
}

std::string suspicion(const std::vector<Judged>& rays) {
    std::vector<Judged> asked, wrong;
    for (const Judged& j : rays) {
        if (j.hit || j.truly_hits) asked.push_back(j);
        if (!is_right(j)) wrong.push_back(j);
    }
    if (wrong.empty() || 2 * wrong.size() < asked.size()) return "";
    const auto explained = [](const std::vector<Judged>& some, const Reason& reason) {
        return 10 * static_cast<std::size_t>(std::ranges::count_if(some, reason.explains)) >= 9 * some.size();
    };
    for (const Reason& reason : reasons()) {
        if (explained(wrong, reason) && (!reason.of_all || explained(asked, reason)))
            return "wrong on " + std::to_string(wrong.size()) + " of " + std::to_string(asked.size()) +
                   " rays: " + reason.words;
    }
    return "";
}

std::string suspicion(const scene::file::Scene& scene, const map::MapRow& row) {
    const scene::file::Scene small = map::small_picture_of(scene, 64);
    truth::Culler culler(small);
    std::vector<Judged> rays;
    judge(truth::Band(small, 0, small.height, {}, &culler), row, rays);
    return suspicion(rays);
}

std::string suspicion(std::vector<scene::rays::RayGroup> groups, const map::MapRow& row) {
    std::vector<Judged> rays;
    for (scene::rays::RayGroup& group : groups) {
        if (rays.size() >= most_rays) break;
        judge(truth::Band(std::move(group)), row, rays);
    }
    return suspicion(rays);
}

}  // namespace lostbits::measure::contract
