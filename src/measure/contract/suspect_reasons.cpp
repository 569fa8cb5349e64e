// Predicts the answer that each mistake in a contract would give.
#include "measure/contract/suspect_reasons.hpp"

#include <fmt/format.h>

#include <optional>

namespace lostbits::measure::contract {
namespace {

using Line = Ends<double>;

/// The t at which the line of a ray enters and leaves; empty if it misses. Computed in double, which is accurate to
/// many more bits than the comparison needs.
std::optional<Line> line_through(const Ray<double>& ray, const Primitive<double>& primitive) {
    const auto line = with_span(ray, primitive, [](const auto& span) { return ends_of(span); });
    return line && line->near <= line->far ? line : std::nullopt;
}

bool is_answer_of(const AnswerSample& sample, const Ray<double>& ray, const Primitive<double>& primitive) {
    const auto line = line_through(ray, primitive);
    const bool is_ahead = line && line->far >= 0;
    if (!is_ahead || !sample.hit || std::isnan(sample.t)) return is_ahead == sample.hit;
    return is_about(sample.t, line->near >= 0 ? line->near : line->far);
}

/// True if the answer is that for another ray or another primitive. A wrong answer that fits the ray's own line does
/// not count: its error concerns the end of the ray, a touch or a side. If the two rays are nearly the same, such an
/// answer would fit any exchange.
bool fits_instead(const AnswerSample& sample, const Ray<double>& ray, const Primitive<double>& primitive) {
    return is_answer_of(sample, ray, primitive) &&
           (is_right(sample) || !is_answer_of(sample, sample.ray, sample.primitive));
}

/// True if the answer is that for a primitive with another length. If the length does not change, only right answers
/// fit.
bool fits_length(const AnswerSample& sample, const ShapeRow& shape_row, double (*change)(double)) {
    if (sample.primitive.shape != shape_row.shape) return false;
    Primitive<double> other = sample.primitive;
    double& length = other.numbers[length_key(shape_row.shape)->number_index];
    const double old_length = length;
    length = change(old_length);
    return is_about(length, old_length) ? is_right(sample) : fits_instead(sample, sample.ray, other);
}

/// True if the answer is that for a primitive whose numbers are `factor` times as large.
bool fits_scaled(const AnswerSample& sample, double factor) {
    Primitive<double> other = sample.primitive;
    for (std::size_t k = 0; k < other.shape_numbers().size(); ++k) other.numbers[k] *= factor;
    return fits_instead(sample, sample.ray, other);
}

Vec<double> swap_y_and_z(const Vec<double>& v) { return {v.x, v.z, v.y}; }

bool is_other_t(const AnswerSample& sample) {
    return sample.hit && sample.truly_hits && !is_about(sample.other_t, sample.true_t) &&
           is_about(sample.t, sample.other_t);
}

/// The t at which the line enters and leaves, for a hit of a ray that starts in between; otherwise empty.
std::optional<Line> line_from_inside(const AnswerSample& sample) {
    const auto line = line_through(sample.ray, sample.primitive);
    return sample.hit && line && line->near < 0 && line->far > 0 ? line : std::nullopt;
}

/// Mistake about a length of a shape, such as a radius: {0} is the key, {1} its letter, {2} the shape, {3} its plural.
struct LengthErrorCase {
    const char *mistake, *library_remedy, *file_remedy;
    double (*change)(double);
};
constexpr LengthErrorCase length_error_cases[] = {
    {"the intersector seems to expect the square of the {0}", "hand over {0} * {0}",
     "the answers are for {3} of {0} sqrt({1}); write that {0}", [](double x) { return std::sqrt(x); }},
    {"the {0} seems to be squared once too often", "hand over {0}",
     "the answers are for {3} of {0} {1} * {1}; write that {0}", [](double x) { return x * x; }},
    {"the intersector seems to expect a diameter instead of the {0}", "hand over 2 * {0}",
     "the answers are for {3} of half the {0}; write that {0} (--{2})", [](double x) { return x / 2; }},
    {"the intersector seems to get a diameter instead of the {0}", "hand over {0}",
     "the answers are for {3} of twice the {0}; write that {0} (--{2})", [](double x) { return x * 2; }}};

void add_length_reasons(const ShapeRow& shape_row, std::vector<SuspectedMistake>& list) {
    const auto length = length_key(shape_row.shape);
    if (!length) return;
    const auto text = [&](const char* pattern) {
        return fmt::format(fmt::runtime(pattern), length->key->name, length->key->short_name, shape_row.name,
                           shape_row.plural);
    };
    for (const LengthErrorCase& error_case : length_error_cases)
        list.push_back({text(error_case.mistake), text(error_case.library_remedy), text(error_case.file_remedy),
                        [&shape_row, change = error_case.change](const AnswerSample& sample) {
                            return fits_length(sample, shape_row, change);
                        },
                        SuspectedMistake::AffectedAnswers::all});
}

/// Mistakes about the unit of t.
std::vector<SuspectedMistake> list_unit_reasons() {
    return {{"t is a distance, not the ray's parameter, as if directions had unit length",
             "say so (unit_direction, direction=unit)", "say --direction unit",
             [](const AnswerSample& sample) { return !sample.is_unit && is_other_t(sample); }},
            {"t is the ray's parameter, not a distance", "leave out the property unit_direction (direction=unit)",
             "leave out --direction unit",
             [](const AnswerSample& sample) { return sample.is_unit && is_other_t(sample); }}};
}

/// Mistakes about rays that start inside.
std::vector<SuspectedMistake> list_inside_reasons() {
    return {
        {"it answers 0 from inside, where another t is right", "say so (inside_zero, inside=zero)", "say --inside zero",
         [](const AnswerSample& sample) {
             return sample.t == 0 && line_from_inside(sample) && !is_about(0, sample.true_t);
         }},
        {"from inside it answers with the exit, where 0 is right", "say so (inside_exit, inside=exit)",
         "say --inside exit",
         [](const AnswerSample& sample) {
             const auto line = line_from_inside(sample);
             return line && sample.truly_hits && sample.true_t == 0 && is_about(sample.t, line->far);
         }},

        // The near root, which is behind the ray.
        {"from inside it answers with the near root, behind the ray",
         "say so (near_root, roots=near): t < 0 is then a miss", "say --inside near: t < 0 is then a miss",
         [](const AnswerSample& sample) {
             const auto line = line_from_inside(sample);
             return line && is_about(sample.t, line->near);
         }},
        {"from inside it answers with the near root without its sign",
         "the root is behind the ray; answer the first with t >= 0",
         "the root is behind the ray; the first with t >= 0 is right", [](const AnswerSample& sample) {
             const auto line = line_from_inside(sample);
             return line && !is_about(-line->near, sample.true_t) && is_about(sample.t, -line->near);
         }}};
}

/// Mistakes about the root that is the answer.
std::vector<SuspectedMistake> list_root_reasons() {
    return {{"it answers with the far root, the exit in place of the entry",
             "answer the first with t >= 0, or near before far (roots)", "the first with t >= 0 is right",
             [](const AnswerSample& sample) {
                 const auto line = line_through(sample.ray, sample.primitive);
                 return sample.hit && line && !is_about(line->far, sample.true_t) && is_about(sample.t, line->far);
             }},
            {"t has the wrong sign", "is the direction reversed?", "is the direction reversed?",
             [](const AnswerSample& sample) {
                 return sample.hit && sample.truly_hits && is_about(sample.t, -sample.true_t);
             }}};
}

/// Mistakes about the numbers of a ray, and about where it begins.
std::vector<SuspectedMistake> list_ray_reasons() {
    using AffectedAnswers = SuspectedMistake::AffectedAnswers;
    return {{"the direction seems to be reversed: the answers are those for -d", "hand over the direction of the ray",
             "write -dx, -dy, -dz",
             [](const AnswerSample& sample) {
                 return !std::isnan(sample.t) &&
                        fits_instead(sample, {sample.ray.origin, -sample.ray.direction}, sample.primitive);
             },
             AffectedAnswers::all},

            // The ray, or its line.
            {"it hits what lies behind the ray", "say that it answers for the whole line (whole_line, flags=line)",
             "write hit = 0 where t < 0, or leave out hit and say --miss negative",
             [](const AnswerSample& sample) {
                 const auto line = line_through(sample.ray, sample.primitive);
                 return sample.hit && !sample.truly_hits && line && line->far < 0 && !(sample.t > 0);
             },
             AffectedAnswers::wrong},

            // Numbers in the wrong place.
            {"the origin and the direction seem to be exchanged", "a ray comes as ox, oy, oz, dx, dy, dz",
             "look at the names of the columns: ox, oy, oz are the origin",
             [](const AnswerSample& sample) {
                 return fits_instead(sample, {sample.ray.direction, sample.ray.origin}, sample.primitive);
             },
             AffectedAnswers::all},
            {"the direction seems to be the point where the ray ends: the answers are those for d - o",
             "hand over the direction, end - origin", "write dx - ox, dy - oy, dz - oz as the direction",
             [](const AnswerSample& sample) {
                 return fits_instead(sample, {sample.ray.origin, sample.ray.direction - sample.ray.origin},
                                     sample.primitive);
             },
             AffectedAnswers::all},
            {"y and z of the rays seem to be exchanged, compared with those of the primitive",
             "hand over both with the same axis upwards", "write oy and oz, and dy and dz, the other way round",
             [](const AnswerSample& sample) {
                 return fits_instead(sample, {swap_y_and_z(sample.ray.origin), swap_y_and_z(sample.ray.direction)},
                                     sample.primitive);
             },
             AffectedAnswers::all}};
}

void add_known_unit_reasons(std::vector<SuspectedMistake>& list) {
    for (const KnownUnits& units : known_units)
        list.push_back(
            {fmt::format("the primitive seems to be in other units than the rays, {:.4g} times as large ({}?)",
                         units.factor, units.text),
             "hand over both in the same units", "write both in the same units",
             [factor = units.factor](const AnswerSample& sample) { return fits_scaled(sample, 1 / factor); },
             SuspectedMistake::AffectedAnswers::all});
}

std::vector<SuspectedMistake> list_all_reasons() {
    std::vector<SuspectedMistake> list = list_unit_reasons();
    const auto append = [&list](const std::vector<SuspectedMistake>& more) {
        list.insert(list.end(), more.begin(), more.end());
    };
    for (const ShapeRow& shape_row : shape_rows) add_length_reasons(shape_row, list);
    append(list_inside_reasons());
    append(list_root_reasons());
    append(list_ray_reasons());
    add_known_unit_reasons(list);
    list.push_back({"hit seems to be inverted, 1 where the ray misses", "hit is 1 where the ray hits",
                    "write 1 for a hit and 0 for a miss",
                    [](const AnswerSample& sample) { return sample.hit != sample.truly_hits; },
                    SuspectedMistake::AffectedAnswers::decisions});
    return list;
}

}  // namespace

const std::vector<SuspectedMistake>& reasons() {
    static const std::vector<SuspectedMistake> list = list_all_reasons();
    return list;
}

}  // namespace lostbits::measure::contract
