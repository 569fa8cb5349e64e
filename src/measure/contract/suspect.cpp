#include "measure/contract/suspect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "measure/map/culprit_order.hpp"
#include "measure/truth/missing.hpp"

namespace lostbits::measure::contract {
namespace {

constexpr std::size_t most_rays = 4096;

using Line = Ends<double>;

/// In double: good to many more bits than are asked about.
std::optional<Line> line_through(const Ray<double>& ray, const Solid<double>& solid) {
    const auto line = visit(solid, [&ray](const auto& shape) { return ends_of(*shape.span(ray)); });
    return line && line->near <= line->far ? line : std::nullopt;
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

/// The answer for the ray whose origin is the direction, and the other way round.
bool fits_exchanged(const Judged& j) {
    const auto line = line_through({j.ray.direction, j.ray.origin}, j.solid);
    const bool ahead = line && line->far >= 0;
    if (!ahead || !j.hit || std::isnan(j.t)) return ahead == j.hit;
    return is_about(j.t, line->near >= 0 ? line->near : line->far);
}

/// Where the line enters and leaves, of a ray that starts between.
std::optional<Line> line_from_inside(const Judged& j) {
    const auto line = line_through(j.ray, j.solid);
    return j.hit && line && line->near < 0 && line->far > 0 ? line : std::nullopt;
}

/// Something that a contract may have said wrongly: whether it explains an answer.
struct Reason {
    const char* words;       ///< what seems to be wrong
    const char* to_library;  ///< what to write where an intersector answered
    const char* to_file;     ///< and where a file holds the answers
    std::function<bool(const Judged&)> explains;
    /// Whether it would change every answer: then it explains the right ones too, or it is not the reason. A march that
    /// ends early misses near the rim, as a smaller sphere would, and is right in the middle, where that is not.
    bool of_all = false;
    /// Whether it needs a hit to be seen: an intersector that never hits is no sign of it.
    bool by_a_hit = false;
};

const std::vector<Reason>& reasons() {
    static const std::vector<Reason> all{
        {"t is a distance, not the ray's parameter: it seems to take directions of unit length",
         "say so (unit_direction, direction=unit)", "say --direction unit",
         [](const Judged& j) { return !j.unit && is_in_other_measure(j); }},
        {"t is the ray's parameter, not a distance",
         "leave out what says that directions have unit length (unit_direction, direction=unit)",
         "leave --direction unit out", [](const Judged& j) { return j.unit && is_in_other_measure(j); }},
        {"the radius seems to be taken for its square", "hand over radius * radius",
         "the answers are for spheres of radius sqrt(r); write that radius",
         [](const Judged& j) { return fits_radius(j, std::sqrt(j.solid.numbers[3])); }, true},
        {"the radius seems to be squared once too often", "hand over radius",
         "the answers are for spheres of radius r * r; write that radius",
         [](const Judged& j) { return fits_radius(j, j.solid.numbers[3] * j.solid.numbers[3]); }, true},
        {"the radius seems to be taken for a diameter", "hand over 2 * radius",
         "the answers are for spheres of half the radius; write that radius (--sphere)",
         [](const Judged& j) { return fits_radius(j, j.solid.numbers[3] / 2); }, true},
        {"a diameter seems to be handed over for the radius", "hand over radius",
         "the answers are for spheres of twice the radius; write that radius (--sphere)",
         [](const Judged& j) { return fits_radius(j, j.solid.numbers[3] * 2); }, true},
        {"it answers 0 from inside, where another t is right", "say so (inside_zero, inside=zero)", "say --inside zero",
         [](const Judged& j) { return j.t == 0 && line_from_inside(j) && !is_about(0, j.true_t); }},
        {"from inside it answers with the exit, where 0 is right", "say so (inside_exit, inside=exit)",
         "say --inside exit",
         [](const Judged& j) {
             const auto line = line_from_inside(j);
             return line && j.truly_hits && j.true_t == 0 && is_about(j.t, line->far);
         }},
        {"from inside it answers with the near root without its sign",
         "the root is behind the ray; the first with t >= 0 is asked for",
         "the root is behind the ray; the first with t >= 0 is right",
         [](const Judged& j) {
             const auto line = line_from_inside(j);
             return line && !is_about(-line->near, j.true_t) && is_about(j.t, -line->near);
         }},
        {"it answers with the far root, the exit in place of the entry",
         "the first with t >= 0 is asked for, or near before far (roots)", "the first with t >= 0 is right",
         [](const Judged& j) {
             const auto line = line_through(j.ray, j.solid);
             return j.hit && line && !is_about(line->far, j.true_t) && is_about(j.t, line->far);
         }},
        {"t has the wrong sign", "is the direction reversed?", "is the direction reversed?",
         [](const Judged& j) { return j.hit && j.truly_hits && is_about(j.t, -j.true_t); }},
        {"it hits what lies behind the ray", "say that it answers for the whole line (whole_line, flags=line)",
         "write hit = 0 where t < 0, or leave out hit and say --miss negative",
         [](const Judged& j) {
             const auto line = line_through(j.ray, j.solid);
             return j.hit && !j.truly_hits && line && line->far < 0;
         }},
        {"the origin and the direction seem to be exchanged", "a ray comes as ox, oy, oz, dx, dy, dz",
         "look at the names of the columns: ox, oy, oz are the origin", fits_exchanged, true, true},
    };
    return all;
}

bool explain_most(const std::vector<Judged>& some, const std::function<bool(const Judged&)>& explains) {
    return 10 * static_cast<std::size_t>(std::ranges::count_if(some, explains)) >= 9 * some.size();
}

/// `1000` for 1000.02: a factor as far as 2^-8 of it is known, and with the name of units where they have it.
std::string factor_text(double factor) {
    struct Units {
        double factor;
        const char* words;
    };
    constexpr Units known[] = {{1000, "millimetres for metres"}, {0.001, "metres for millimetres"},
                               {100, "centimetres for metres"},  {0.01, "metres for centimetres"},
                               {0.0254, "metres for inches"},    {1 / 0.0254, "inches for metres"},
                               {0.3048, "metres for feet"},      {1 / 0.3048, "feet for metres"},
                               {25.4, "millimetres for inches"}, {2.54, "centimetres for inches"}};
    for (const Units& units : known) {
        if (is_about(factor, units.factor))
            return fmt::format("{:.4g} times what is right: {}?", units.factor, units.words);
    }
    return fmt::format("{:.3g} times what is right", factor);
}

/// The one factor by which nine in ten of the wrong answers are off; empty where there is none, or where all true t are
/// alike, so that any one answer would be.
std::string other_units(const std::vector<Judged>& wrong) {
    std::vector<double> factors, truths;
    for (const Judged& j : wrong) {
        if (!j.hit || !j.truly_hits || !(j.true_t > 0) || !std::isfinite(j.t) || j.t == 0) continue;
        factors.push_back(j.t / j.true_t);
        truths.push_back(j.true_t);
    }
    if (10 * factors.size() < 9 * wrong.size()) return "";
    std::ranges::nth_element(factors, factors.begin() + static_cast<std::ptrdiff_t>(factors.size() / 2));
    const double factor = factors[factors.size() / 2];
    const auto [least, most] = std::ranges::minmax(truths);
    if (is_about(least, most)) return "";
    const auto fits = [factor](const Judged& j) { return j.hit && j.truly_hits && is_about(j.t, factor * j.true_t); };
    return explain_most(wrong, fits) ? "t is in other units: it is " + factor_text(factor) : "";
}

/// How many are wrong in which way, where nothing known explains them.
std::string ways_of(const std::vector<Judged>& wrong) {
    std::size_t missed = 0, hit = 0, no_number = 0;
    for (const Judged& j : wrong) {
        missed += !j.hit;
        hit += j.hit && !j.truly_hits;
        no_number += j.hit && j.truly_hits && !std::isfinite(j.t);
    }
    std::string words;
    const auto add = [&words](std::size_t n, const char* what) {
        if (n > 0) words += fmt::format("{}{} {}", words.empty() ? "" : ", ", n, what);
    };
    add(hit, "hit what they should miss");
    add(missed, "miss what they should hit");
    add(no_number, "have a t that is not a finite number");
    add(wrong.size() - hit - missed - no_number, "have a t that is off by more than 0.4%");
    return words;
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

std::string suspicion(const std::vector<Judged>& rays, Whose whose) {
    std::vector<Judged> asked, wrong;
    for (const Judged& j : rays) {
        if (j.hit || j.truly_hits) asked.push_back(j);
        if (!is_right(j)) wrong.push_back(j);
    }
    if (wrong.empty() || 2 * wrong.size() < asked.size()) return "";
    const std::string count = fmt::format("wrong on {} of {} rays: ", wrong.size(), asked.size());
    for (const Reason& reason : reasons()) {
        const auto by_a_hit = [&reason](const Judged& j) { return j.hit && reason.explains(j); };
        if (reason.by_a_hit && std::ranges::none_of(wrong, by_a_hit)) continue;
        if (explain_most(wrong, reason.explains) && (!reason.of_all || explain_most(asked, reason.explains)))
            return fmt::format("{}{}; {}", count, reason.words,
                               whose == Whose::file ? reason.to_file : reason.to_library);
    }
    if (const std::string units = other_units(wrong); !units.empty()) return count + units;
    return count + ways_of(wrong) + "; no mistake that is known here explains nine in ten of them";
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
