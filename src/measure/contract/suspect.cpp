#include "measure/contract/suspect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <optional>

namespace lostbits::measure::contract {
namespace {

using Line = Ends<double>;

/// In double: good to many more bits than are asked about.
std::optional<Line> line_through(const Ray<double>& ray, const Solid<double>& solid) {
    const auto line = with_span(ray, solid, [](const auto& span) { return ends_of(span); });
    return line && line->near <= line->far ? line : std::nullopt;
}

bool is_about(double x, double y) { return std::fabs(x - y) <= 0x1p-8 * std::fabs(y); }

bool is_right(const Judged& j) {
    if (j.hit != j.truly_hits) return false;
    return !j.hit || std::isnan(j.t) || j.t == j.true_t || is_about(j.t, j.true_t);
}

bool is_answer_of(const Judged& j, const Ray<double>& ray, const Solid<double>& solid) {
    const auto line = line_through(ray, solid);
    const bool ahead = line && line->far >= 0;
    if (!ahead || !j.hit || std::isnan(j.t)) return ahead == j.hit;
    return is_about(j.t, line->near >= 0 ? line->near : line->far);
}

/// The answer for another ray or another solid. One that is wrong and yet that of the ray's own line is about an end, a
/// touch or a side: where both rays are alike it would be a sign of any exchange.
bool fits(const Judged& j, const Ray<double>& ray, const Solid<double>& solid) {
    return is_answer_of(j, ray, solid) && (is_right(j) || !is_answer_of(j, j.ray, j.solid));
}

/// The answer for a solid of another length. A length that would be the same explains what is right.
bool fits_length(const Judged& j, const ShapeRow& row, double (*change)(double)) {
    if (j.solid.shape != row.shape) return false;
    Solid<double> other = j.solid;
    double& length = other.numbers[length_key(row.shape)->number];
    const double is = length;
    length = change(is);
    return is_about(length, is) ? is_right(j) : fits(j, j.ray, other);
}

/// The answer for a solid whose numbers are so many times as large.
bool fits_scaled(const Judged& j, double factor) {
    Solid<double> other = j.solid;
    for (std::size_t k = 0; k < other.used().size(); ++k) other.numbers[k] *= factor;
    return fits(j, j.ray, other);
}

Vec<double> y_for_z(const Vec<double>& v) { return {v.x, v.z, v.y}; }

bool is_in_other_measure(const Judged& j) {
    return j.hit && j.truly_hits && !is_about(j.other_measure, j.true_t) && is_about(j.t, j.other_measure);
}

/// Where the line enters and leaves, of a ray that starts between.
std::optional<Line> line_from_inside(const Judged& j) {
    const auto line = line_through(j.ray, j.solid);
    return j.hit && line && line->near < 0 && line->far > 0 ? line : std::nullopt;
}

/// Something that a contract may have said wrongly: whether it explains an answer.
struct Reason {
    /// Which answers it speaks about, and has to explain.
    enum class About : std::uint8_t {
        t,      ///< the t of hits that should be: decisions are wrong beside it, by arithmetic as a rule
        wrong,  ///< every wrong answer
        all,    ///< as it would change every answer, the right ones too. A march that ends early misses near the rim,
                ///< as a smaller sphere would, and is right in the middle, where that is not
        decisions  ///< hits and misses alone, all of them, in both ways
    };
    std::string words;       ///< what seems to be wrong
    std::string to_library;  ///< what to write where an intersector answered
    std::string to_file;     ///< and where a file holds the answers
    std::function<bool(const Judged&)> explains;
    About about = About::t;
};

struct Units {
    double factor;
    const char* words;
};
constexpr Units known_units[] = {{1000, "millimetres for metres"}, {0.001, "metres for millimetres"},
                                 {100, "centimetres for metres"},  {0.01, "metres for centimetres"},
                                 {0.0254, "metres for inches"},    {1 / 0.0254, "inches for metres"},
                                 {0.3048, "metres for feet"},      {1 / 0.3048, "feet for metres"},
                                 {25.4, "millimetres for inches"}, {2.54, "centimetres for inches"}};

/// What is made of a shape's length, of a radius: {0} is the key, {1} its letter, {2} the shape, {3} several.
struct LengthMistake {
    const char *words, *to_library, *to_file;
    double (*change)(double);
};
constexpr LengthMistake length_mistakes[] = {
    {"the {0} seems to be taken for its square", "hand over {0} * {0}",
     "the answers are for {3} of {0} sqrt({1}); write that {0}", [](double x) { return std::sqrt(x); }},
    {"the {0} seems to be squared once too often", "hand over {0}",
     "the answers are for {3} of {0} {1} * {1}; write that {0}", [](double x) { return x * x; }},
    {"the {0} seems to be taken for a diameter", "hand over 2 * {0}",
     "the answers are for {3} of half the {0}; write that {0} (--{2})", [](double x) { return x / 2; }},
    {"a diameter seems to be handed over for the {0}", "hand over {0}",
     "the answers are for {3} of twice the {0}; write that {0} (--{2})", [](double x) { return x * 2; }}};

void add_lengths(const ShapeRow& row, std::vector<Reason>& all) {
    const auto length = length_key(row.shape);
    if (!length) return;
    const auto text = [&](const char* words) {
        return fmt::format(fmt::runtime(words), length->key->name, length->key->letter, row.name, row.plural);
    };
    for (const LengthMistake& m : length_mistakes)
        all.push_back({text(m.words), text(m.to_library), text(m.to_file),
                       [&row, change = m.change](const Judged& j) { return fits_length(j, row, change); },
                       Reason::About::all});
}

std::vector<Reason> all_reasons() {
    using About = Reason::About;
    std::vector<Reason> all{
        {"t is a distance, not the ray's parameter: it seems to take directions of unit length",
         "say so (unit_direction, direction=unit)", "say --direction unit",
         [](const Judged& j) { return !j.unit && is_in_other_measure(j); }},
        {"t is the ray's parameter, not a distance",
         "leave out what says that directions have unit length (unit_direction, direction=unit)",
         "leave --direction unit out", [](const Judged& j) { return j.unit && is_in_other_measure(j); }},
    };
    for (const ShapeRow& row : shape_rows) add_lengths(row, all);
    const Reason more[] = {
        {"it answers 0 from inside, where another t is right", "say so (inside_zero, inside=zero)", "say --inside zero",
         [](const Judged& j) { return j.t == 0 && line_from_inside(j) && !is_about(0, j.true_t); }},
        {"from inside it answers with the exit, where 0 is right", "say so (inside_exit, inside=exit)",
         "say --inside exit",
         [](const Judged& j) {
             const auto line = line_from_inside(j);
             return line && j.truly_hits && j.true_t == 0 && is_about(j.t, line->far);
         }},
        {"from inside it answers with the near root, behind the ray",
         "say so (near_root, roots=near), by which t < 0 is a miss", "say --inside near, by which t < 0 is a miss",
         [](const Judged& j) {
             const auto line = line_from_inside(j);
             return line && is_about(j.t, line->near);
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
        {"the direction seems to be reversed: the answers are those for -d", "hand over the direction of the ray",
         "write -dx, -dy, -dz",
         [](const Judged& j) {
             return !std::isnan(j.t) && fits(j, {j.ray.origin, -j.ray.direction}, j.solid);
         },
         About::all},
        {"it hits what lies behind the ray", "say that it answers for the whole line (whole_line, flags=line)",
         "write hit = 0 where t < 0, or leave out hit and say --miss negative",
         [](const Judged& j) {
             const auto line = line_through(j.ray, j.solid);
             return j.hit && !j.truly_hits && line && line->far < 0 && !(j.t > 0);
         },
         About::wrong},
        {"the origin and the direction seem to be exchanged", "a ray comes as ox, oy, oz, dx, dy, dz",
         "look at the names of the columns: ox, oy, oz are the origin",
         [](const Judged& j) {
             return fits(j, {j.ray.direction, j.ray.origin}, j.solid);
         },
         About::all},
        {"the direction seems to be the point where the ray ends: the answers are those for d - o",
         "hand over the direction, end - origin", "write dx - ox, dy - oy, dz - oz as the direction",
         [](const Judged& j) {
             return fits(j, {j.ray.origin, j.ray.direction - j.ray.origin}, j.solid);
         },
         About::all},
        {"y and z of the rays seem to be exchanged against those of the solid",
         "hand over both with the same axis upwards", "write oy and oz, and dy and dz, the other way round",
         [](const Judged& j) {
             return fits(j, {y_for_z(j.ray.origin), y_for_z(j.ray.direction)}, j.solid);
         },
         About::all},
    };
    all.insert(all.end(), std::begin(more), std::end(more));
    for (const Units& units : known_units)
        all.push_back({fmt::format("the solid seems to be in other units than the rays, {:.4g} times as large ({}?)",
                                   units.factor, units.words),
                       "hand over both in the same units", "write both in the same units",
                       [factor = units.factor](const Judged& j) { return fits_scaled(j, 1 / factor); }, About::all});
    all.push_back({"hit seems to be inverted, 1 where the ray misses", "hit is 1 where the ray hits",
                   "write 1 for a hit and 0 for a miss", [](const Judged& j) { return j.hit != j.truly_hits; },
                   About::decisions});
    return all;
}

const std::vector<Reason>& reasons() {
    static const std::vector<Reason> all = all_reasons();
    return all;
}

using Explains = std::function<bool(const Judged&)>;

std::size_t count_unexplained(const std::vector<Judged>& some, const Explains& explains) {
    return some.size() - static_cast<std::size_t>(std::ranges::count_if(some, explains));
}

/// Nine in ten of some answers, of which there is one at least.
bool explains_most(const std::vector<Judged>& some, const Explains& explains) {
    return !some.empty() && 10 * count_unexplained(some, explains) <= some.size();
}

/// `1000` for 1000.02: a factor as far as 2^-8 of it is known, and with the name of units where they have it.
std::string factor_text(double factor) {
    for (const Units& units : known_units) {
        if (is_about(factor, units.factor))
            return fmt::format("{:.4g} times what is right: {}?", units.factor, units.words);
    }
    return fmt::format("{:.3g} times what is right", factor);
}

/// A factor of units, or a power of two or ten: one that is written on purpose.
bool is_round(double factor) {
    const auto is_power = [factor](double base) {
        return is_about(factor, std::pow(base, std::round(std::log(factor) / std::log(base))));
    };
    return factor > 0 && (is_power(2) || is_power(10) || std::ranges::any_of(known_units, [factor](const Units& units) {
                              return is_about(factor, units.factor);
                          }));
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
    const auto add = [&words](std::size_t n, const char* one, const char* more) {
        if (n > 0) words += fmt::format("{}{} {}", words.empty() ? "" : ", ", n, n == 1 ? one : more);
    };
    add(hit, "hits what it should miss", "hit what they should miss");
    add(missed, "misses what it should hit", "miss what they should hit");
    add(no_number, "has a t that is not a finite number", "have a t that is not a finite number");
    add(wrong.size() - hit - missed - no_number, "has a t that is off by more than 0.4%",
        "have a t that is off by more than 0.4%");
    return words;
}

/// The answers that something is said of: of rays that hit or should, or of fewer.
struct Asked {
    std::vector<Judged> all, wrong, right_misses;  ///< what is rightly missed stands beside `all`
    std::uint64_t more_right_misses = 0;           ///< beside those, known by their number alone

    Asked() = default;
    template <class Belongs>
    Asked(const std::vector<Judged>& rays, const Belongs& belongs) {
        for (const Judged& j : rays) add(j, belongs(j));
    }
    explicit Asked(const std::vector<Judged>& rays)
        : Asked(rays, [](const Judged& j) { return j.hit || j.truly_hits; }) {}

    void add(const Judged& j, bool belongs = true) {
        if (!j.hit && !j.truly_hits) return right_misses.push_back(j);
        if (!belongs) return;
        all.push_back(j);
        if (!is_right(j)) wrong.push_back(j);
    }

    /// Every second of each kind of answer, and the others: what is made from one half is tested on the other.
    [[nodiscard]] std::array<Asked, 2> halves() const {
        std::array<Asked, 2> two;
        std::array<std::size_t, 8> seen{};
        const auto divide = [&](const std::vector<Judged>& some) {
            for (const Judged& j : some) {
                const std::size_t kind = (j.hit ? 1U : 0U) + (j.truly_hits ? 2U : 0U) + (is_right(j) ? 4U : 0U);
                two[seen[kind]++ % 2].add(j);
            }
        };
        divide(all), divide(right_misses);
        for (Asked& half : two) half.more_right_misses = more_right_misses / 2;
        return two;
    }

    [[nodiscard]] bool is_mostly_wrong() const { return !wrong.empty() && 2 * wrong.size() >= all.size(); }
    [[nodiscard]] std::string count(const char* which) const {
        if (all.size() == 1) return fmt::format("wrong on the one ray that {}: ", which);
        return fmt::format("wrong on {} of the {} rays that {}: ", wrong.size(), all.size(), which);
    }
    /// Whether a reason explains nine in ten of the wrong answers; of one that would change right ones too, nine in ten
    /// of all and of the hits, and what is rightly missed counts against it.
    [[nodiscard]] bool is_explained_by(const Reason& reason) const {
        using About = Reason::About;
        if (!explains_most(wrong, reason.explains)) return false;
        if (reason.about == About::t || reason.about == About::wrong) return true;
        std::vector<Judged> hits;
        std::ranges::copy_if(all, std::back_inserter(hits), [](const Judged& j) { return j.hit; });
        const bool decides = reason.about == About::decisions;
        const std::size_t unexplained = count_unexplained(all, reason.explains) +
                                        count_unexplained(right_misses, reason.explains) +
                                        (decides ? more_right_misses : 0);
        return 10 * unexplained <= all.size() && explains_most(hits, reason.explains) &&
               2 * unexplained < unexplained_by_constants(hits, decides);
    }

private:
    /// What the better of two leaves open that say the same of every ray: that it is missed, and that it is hit where
    /// it truly is. A guess that does no better explains nothing.
    [[nodiscard]] std::size_t unexplained_by_constants(const std::vector<Judged>& hits, bool decides) const {
        const std::size_t misses = all.size() - hits.size() + right_misses.size() + more_right_misses;
        const auto is_no_more_than_a_hit = [decides](const Judged& j) {
            return decides || std::isnan(j.t) || is_right(j);
        };
        return std::min(hits.size(), misses + count_unexplained(hits, is_no_more_than_a_hit));
    }
};

/// The one factor by which nine in ten of the wrong answers are off, made from every second one and tested on the
/// others; empty where there is none. Where all true t are alike any one answer would be, so there it has to be a round
/// one of answers that are not all the same.
std::string other_units(const std::array<Asked, 2>& halves) {
    std::vector<double> factors, truths, answers;
    for (const Judged& j : halves[0].wrong) {
        if (!j.hit || !j.truly_hits || !(j.true_t > 0) || !std::isfinite(j.t) || j.t == 0) continue;
        factors.push_back(j.t / j.true_t);
        truths.push_back(j.true_t);
        answers.push_back(j.t);
    }
    if (factors.empty()) return "";
    std::ranges::nth_element(factors, factors.begin() + static_cast<std::ptrdiff_t>(factors.size() / 2));
    const double factor = factors[factors.size() / 2];
    const auto [least, most] = std::ranges::minmax(truths);
    const auto [lowest, highest] = std::ranges::minmax(answers);
    if (is_about(least, most) && (lowest == highest || !is_round(factor))) return "";
    const auto fits = [factor](const Judged& j) { return j.hit && j.truly_hits && is_about(j.t, factor * j.true_t); };
    const bool in_both =
        std::ranges::all_of(halves, [&fits](const Asked& half) { return explains_most(half.wrong, fits); });
    return in_both ? "t is in other units: it is " + factor_text(factor) : "";
}

}  // namespace

std::string suspicion(const std::vector<Judged>& rays, Whose whose, std::uint64_t more_misses) {
    Asked asked(rays);
    asked.more_right_misses = more_misses;
    // Of rays that both hit, where there are enough of them, t alone is asked about.
    const Asked both(rays, [](const Judged& j) { return j.hit && j.truly_hits; });
    const bool most_hit = 2 * both.all.size() >= asked.all.size();
    if (!asked.is_mostly_wrong()) return "";
    const std::array<Asked, 2> halves = asked.halves(), halves_of_both = both.halves();
    for (const Reason& reason : reasons()) {
        const bool about_t = reason.about == Reason::About::t;
        if (about_t && !(most_hit && both.is_mostly_wrong())) continue;
        const auto explained = [&reason](const Asked& half) { return half.is_explained_by(reason); };
        if (!std::ranges::all_of(about_t ? halves_of_both : halves, explained)) continue;
        return fmt::format("{}{}; {}", about_t ? both.count("hit and should") : asked.count("hit or should"),
                           reason.words, whose == Whose::file ? reason.to_file : reason.to_library);
    }
    if (const std::string units = most_hit ? other_units(halves_of_both) : ""; !units.empty())
        return both.count("hit and should") + units;
    return asked.count("hit or should") + ways_of(asked.wrong) +
           "; no mistake that is known here explains nine in ten of them";
}

}  // namespace lostbits::measure::contract
