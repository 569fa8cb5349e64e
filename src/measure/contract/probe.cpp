#include "measure/contract/probe.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "measure/contract/trial.hpp"
#include "number/error.hpp"
#include "shapes/number_names.hpp"

namespace lostbits::measure::contract {

using intersect::Direction;
using intersect::Inside;
using intersect::Roots;
using intersect::external::ForeignForm;

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();

std::string plainest_primitive_text(Shape shape) { return std::string(row_of(shape).texts.simplest); }

/// Text of the plainest ray and its primitive.
std::string plainest_ray_text(Shape shape, const char* joint) {
    const Question q = plainest_question(shape);
    return fmt::format("origin (0, 0, {:g}), direction (0, 0, {:g}){}{}", q.ray.origin.z, q.ray.direction.z, joint,
                       plainest_primitive_text(shape));
}

/// The t at which the plainest ray leaves a shape for the last time. By symmetry, this point is as far from the origin
/// as the point where the opposite ray enters. Infinite for primitives without end.
double last_root_t(Shape shape) {
    const Question q = plainest_question(shape);
    const auto opposite_ends = ends_of(question_along_z(shape, -q.ray.origin.z, -q.ray.direction.z), shape);
    return opposite_ends ? 2 * std::fabs(q.ray.origin.z) - opposite_ends->near
                         : std::numeric_limits<double>::infinity();
}

/// A mistake about a length of a shape, such as a radius: the length that the form uses instead, and its description.
struct LengthMisuse {
    double (*change)(double);
    const char *mistake, *remedy;  ///< {0} is the key
};
constexpr LengthMisuse length_misuses[]{
    {[](double x) { return std::sqrt(x); }, "the form expects the square of the {0}", "; hand over {0} * {0}"},
    {[](double x) { return x * x; }, "the {0} is squared once too often", ""},
    {[](double x) { return 2 * x; }, "the form doubles the {0} (does it compute a diameter?)",
     "; hand over {0}, not 2 * {0}"},
    {[](double x) { return x / 2; }, "the form expects a diameter instead of the {0}", "; hand over 2 * {0}"}};

/// Rays whose answers distinguish mistakes about a length: the plainest ray and some rays beside it, at two lengths.
/// One length is not enough, since 2 doubled is 2 squared. A length of a flat shape only decides how far from the
/// middle the shape is hit.
std::vector<Question> make_questions_about_length(Shape shape, std::size_t index) {
    std::vector<Question> questions{plainest_question(shape), plainest_question(shape, 8)};
    questions[1].ray.origin.x = 0.5;
    questions[1].ray.origin.y = 0.25;
    for (const double x : {0.9, 1.25, 1.75, 2.5, 3.5}) {
        if (!is_flat(shape)) continue;
        questions.push_back(plainest_question(shape));
        questions.back().ray.origin.x = x;
    }

    // The same rays at the other length.
    for (std::size_t i = 0, count = questions.size(); i < count; ++i) {
        Question q = questions[i];
        q.primitive[index] *= 0.75;
        questions.push_back(q);
    }
    return questions;
}

/// Texts: a mistake about the length of a shape, and what to write instead.
struct LengthMistake {
    std::string mistake, remedy;
};

/// Finds the mistake about a length that explains all answers of a form; empty if no mistake explains them.
std::optional<LengthMistake> find_length_mistake(const Trial& trial) {
    const auto length = length_key(trial.shape);
    if (!length) return std::nullopt;

    std::vector<std::pair<Question, Reply>> answered;
    for (const Question& question : make_questions_about_length(trial.shape, length->number_index))
        answered.emplace_back(question, trial.ask(question));

    // A mistake explains an answer that is right for a primitive with the changed length.
    const auto explains = [&](const LengthMisuse& mistake) {
        return std::ranges::all_of(answered, [&](const auto& pair) {
            auto [q, r] = pair;
            q.primitive[length->number_index] = mistake.change(q.primitive[length->number_index]);
            const auto ends = ends_of(q, trial.shape);
            if (!ends) return r.hit == 0;
            return r.hit == 1 && (!trial.reports_t || is_answer(r.near, ends->near));
        });
    };
    const auto found = std::ranges::find_if(length_misuses, explains);
    if (found == std::end(length_misuses)) return std::nullopt;

    const auto text = [&](const char* pattern) { return fmt::format(fmt::runtime(pattern), length->key->name); };
    return LengthMistake{text(found->mistake), text(found->remedy)};
}

/// Tests that a flat shape is hit as far from its middle as its length says, and no farther.
void try_extent(Trial& trial) {
    const auto length_mistake = is_flat(trial.shape) ? find_length_mistake(trial) : std::nullopt;
    if (length_mistake)
        trial.report_broken(length_mistake->mistake + ", which decides where it is hit" + length_mistake->remedy);
}

/// Tests the near root that the form answers for a ray from outside.
void try_t(Trial& trial) {
    const Question q = plainest_question(trial.shape);
    const Reply reply = trial.ask(q);
    const double right_t = ends_of(q, trial.shape)->near;
    const double far_t = ends_of(q, trial.shape)->far, last_t = last_root_t(trial.shape);
    const auto is_far = [&](double t) { return is_answer(t, far_t) || is_answer(t, last_t); };
    if (is_answer(reply.near, right_t))
        return trial.report_kept("the simplest ray gets t = " + text_of(right_t) + ", which is right");

    // Each known mistake has its own remedy.
    const auto ray_text = " (" + plainest_ray_text(trial.shape, ", ") + ": " + text_of(right_t) +
                          " is right, it answers " + text_of(reply.near) + ")";
    if (const auto length_mistake = find_length_mistake(trial))
        return trial.report_broken(length_mistake->mistake + ray_text + length_mistake->remedy);
    if (is_far(reply.near))
        return trial.report_broken("the far root comes first" + ray_text + "; write near before far");
    if (is_answer(reply.near, -right_t) || is_far(-reply.near))
        return trial.report_broken("t has the wrong sign" + ray_text + "; is the direction reversed?");
    if (std::isnan(reply.near))
        return trial.report_broken("t is not a number" + ray_text +
                                   "; compute a t for every hit, and set hit to 0 for a miss");
    trial.report_broken("t is wrong" + ray_text);
}

/// Compares the t for a direction of length 2 with the form's own t for length 1. A t that is wrong for length 1 may
/// still halve as it should, or be a distance.
void try_direction(Trial& trial) {
    if (trial.contract.direction == Direction::unit)
        return trial.report_kept("takes unit directions; others are not tried");
    const std::string say_unit = "say LB_UNIT (unit_direction, direction=unit)";
    const Question q = plainest_question(trial.shape);
    const Reply reply = trial.ask(q), doubled_reply = trial.ask(plainest_question(trial.shape, 5, 2));

    // A direction twice as long must hit too, at half the t.
    if (doubled_reply.hit != 1)
        return trial.report_broken("a direction twice as long misses; it should hit" +
                                   std::string(trial.reports_t ? " at half the t" : "") +
                                   ". The formula may assume length 1; if so, " + say_unit);
    if (!trial.reports_t) return trial.report_kept("takes directions of any length: one twice as long hits too");
    if (is_answer(doubled_reply.near, reply.near / 2))
        return trial.report_kept("takes directions of any length: one twice as long gets half the t");

    // A t that does not change is a distance if a ray from 3 farther away gets 3 more.
    const Reply farther = trial.ask(plainest_question(trial.shape, 8));
    const bool is_unchanged = is_answer(doubled_reply.near, reply.near),
               is_distance = is_unchanged && farther.hit == 1 && is_answer(farther.near, reply.near + 3);
    if (is_distance)
        return trial.report_broken(
            "t is a distance: a direction twice as long changes nothing. Divide t by its length, or " + say_unit);

    // Otherwise the t for length 2 is wrong; this breaks no property if the t for length 1 is wrong already.
    const std::string result_text = "a direction twice as long gives t = " + text_of(doubled_reply.near);
    const double right = ends_of(q, trial.shape)->near;
    if (!is_answer(reply.near, right)) return trial.report_note(result_text + "; the t for length 1 is wrong already");
    trial.report_broken(result_text + " where " + text_of(right / 2) + " is right" +
                        (is_unchanged
                             ? ""
                             : ": its length changes t, but not as a divisor; the formula may assume length 1; "
                               "if so, " +
                                   say_unit));
}

void try_far_root(Trial& trial) {
    const Question q = plainest_question(trial.shape);
    const Reply outside = trial.ask(q);
    const double right = ends_of(q, trial.shape)->far;
    if (is_answer(outside.far, right)) return trial.report_kept("near and far, from outside");
    if (is_answer(outside.near + outside.far, right))
        return trial.report_broken("far is " + text_of(outside.far) + ", the thickness; hand over near + thickness");
    trial.report_broken(
        "far is " + text_of(outside.far) + " where " + text_of(right) +
        " is right; say LB_NEAR (near_root, roots=near) or LB_FIRST (first_root, roots=first) if it answers "
        "only one root");
}

/// Finds a ray along z whose primitive lies behind it. The ray starts above the primitive, or below it if the primitive
/// fills everything above. Empty if the primitive fills both sides.
std::optional<Question> find_question_behind(Shape shape) {
    for (const double sign : {1.0, -1.0}) {
        const Question q = question_along_z(shape, 5 * sign, sign);
        if (const auto ends = ends_of(q, shape); ends && ends->far < 0) return q;
    }
    return std::nullopt;
}

void try_behind(Trial& trial) {
    const std::optional<Question> q = find_question_behind(trial.shape);
    if (!q) return trial.report_note("no ray along the z axis has " + with_article(trial.shape) + " behind it");
    const Reply reply = trial.ask(*q);
    if (trial.contract.roots == Roots::near_only && reply.hit == 1 && reply.near < 0)
        return trial.report_kept("a primitive behind the ray gets t = " + text_of(reply.near) +
                                 ", which counts as a miss");
    if (trial.contract.roots == Roots::both && trial.has_flag(LB_LINE))
        return trial.check(reply.hit == 1, "the answer is for the whole line", "a primitive behind the ray is missed");

    const std::string hit = "a primitive behind the ray is hit";
    trial.check(reply.hit == 0, "a primitive behind the ray is missed",
                !trial.reports_t ? hit +
                                       "; answer a miss there: only a form that answers t may answer for the whole "
                                       "line"
                : trial.contract.roots == Roots::both
                    ? hit + " (t = " + text_of(reply.near) +
                          "); say LB_LINE (whole_line, flags=line) if it answers for the whole line"
                    : hit + " (t = " + text_of(reply.near) + "); answer a miss where t < 0" +
                          (reply.near < 0 ? ", or say LB_NEAR (near_root, roots=near): t < 0 is then a miss" : ""));
}

void try_passing_ray(Trial& trial) {
    Question q = question_along_z(trial.shape, -5, 1);
    q.ray = {{0, 0, -10}, {0.6, 0, 0.8}};  // through the planes of a box, beside it
    if (ends_of(q, trial.shape)) return trial.report_note("no ray passes by " + with_article(trial.shape));
    const Reply reply = trial.ask(q);
    const bool is_nan = trial.reports_t && reply.hit == 1 && std::isnan(reply.near);
    trial.check(reply.hit == 0, "a ray that passes by misses",
                is_nan
                    ? "a ray that passes by hits with a t that is not a number; set hit to 0 there (`return miss`; for "
                      "a shader: miss=)"
                    : "a ray that passes by hits; is this how it marks a miss (for a shader: miss=)?");
}

void try_end(Trial& trial) {
    Question q = plainest_question(trial.shape);
    q.end = 2;
    const bool is_hit = trial.ask(q).hit == 1;
    const ShapeRow& shape_row = row_of(trial.shape);
    const std::string ray_text = "a ray that ends before the " + std::string(shape_row.name);
    if (!shape_row.takes_tmax && !trial.has_flag(LB_RANGE)) {
        if (!is_hit)
            trial.report_note(ray_text + " misses; maps and sweeps give " + std::string(shape_row.plural) + " no ends");
        return;
    }
    if (trial.has_flag(LB_NO_END))
        return trial.report_kept(trial.reports_t ? "the table checks the ends of rays, not the form"
                                                 : "the rays that it gets have no ends");
    trial.check(!is_hit, ray_text + " misses",
                ray_text +
                    " hits; say LB_NO_END (ignores_end, flags=no_end) if it ignores the ends of rays (for a shader: "
                    "float tmax)");
}

/// Checks the answer to the plainest ray with a begin and an end. `range_text` describes the range, `why` its answer.
void check_range(Trial& trial, double start, double end, const std::string& range_text, const std::string& why) {
    Question q = plainest_question(trial.shape);
    q.start = start;
    q.end = end;
    const HitOrMiss right = trial.truth(q);
    const Reply r = trial.ask(q);
    const std::string right_text = !right.hit ? "miss" : trial.reports_t ? "answer " + text_of(right.t) : "hit";
    const std::string reply_text = r.hit != 1                     ? "misses"
                                   : trial.reports_t && right.hit ? "answers " + text_of(r.near)
                                                                  : "hits";
    trial.check(trial.is_right(q, r, trial.contract), range_text + reply_text,
                range_text + reply_text + "; it should " + right_text + ": " + why);
}

/// Tests a form that declares to respect the begin and end of rays.
void try_range(Trial& trial) {
    const Shape shape = trial.shape;
    const Ends<double> ends = *ends_of(plainest_question(shape), shape);

    // Ranges with an end at the first root.
    const std::string first_root_text = "the first root, t = " + text_of(ends.near) + ", ";
    const std::string closed_ends_text = "both ends of a range belong to it, start <= t <= end";
    const bool only_inside_counts = trial.contract.touching == intersect::Touching::miss && has_inside(shape);
    check_range(trial, ends.near, infinity, "a range that begins at " + first_root_text, closed_ends_text);
    check_range(trial, 0, ends.near, "a range that ends at " + first_root_text,
                only_inside_counts ? "if touching is a miss, only the inside counts, and this ray does not reach it"
                                   : closed_ends_text);

    // Ranges that begin after the first root.
    if (ends.far < 8)
        check_range(trial, 8, infinity, "a range that begins behind the primitive, at t = 8, ",
                    "`starts` says where each ray begins");
    if (is_crossed_twice(shape))
        check_range(trial, 4, infinity, "a range that begins inside, at t = 4, ",
                    "otherwise say what it answers from inside");
}

/// Runs a probe in which any answer is allowed: the form only has to return.
void try_unusual_question(Trial& trial, const char* name, const std::string& description, const Question& question) {
    trial.probe(name, [&](Trial&) {
        Reply r;
        try {
            r = trial.ask(question);
        } catch (const EnvironmentError& refused) {
            return trial.report_note(description + ": refused: " + refused.what());
        }
        std::string reply_text = r.hit == 1 ? "hit" : r.hit == 0 ? "miss" : "nothing";
        if (r.hit == 1 && trial.reports_t) reply_text += " at t = " + text_of(r.near);
        if (r.hit > 1) trial.report_broken(description + ": `hit` is not written");
        else trial.report_note(description + ": " + reply_text);
    });
}

void try_unusual_numbers(Trial& trial) {
    const Shape shape = trial.shape;
    const bool takes_unit = trial.contract.direction == Direction::unit;
    if (!takes_unit) {  // a form that takes unit directions may insist on them
        try_unusual_question(trial, "zero-direction", "a direction of length 0", question_along_z(shape, -5, 0));
        try_unusual_question(trial, "nan-direction", "a direction of NaN", question_along_z(shape, -5, nan));
    }
    try_unusual_question(trial, "nan-origin", "an origin of NaN", question_along_z(shape, nan, 1));
    try_unusual_question(trial, "infinite-origin", "an origin at infinity", question_along_z(shape, -infinity, 1));
    try_unusual_question(trial, "point", std::string(row_of(shape).texts.degenerate),
                         question_along_z(shape, -5, 1, 0, 0));

    // Numbers whose squares leave the range of the format.
    const int scale = trial.contract.bits == 32 ? 100 : 600;
    const std::string format = "binary" + std::to_string(trial.contract.bits), power = std::to_string(scale);
    try_unusual_question(trial, "huge", "numbers of 2^" + power + ", whose squares overflow in " + format,
                         question_along_z(shape, -std::ldexp(1, scale), takes_unit ? 1 : std::ldexp(1, scale), 0,
                                          std::ldexp(1, scale - 20)));
    try_unusual_question(trial, "tiny", "numbers of 2^-" + power + ", whose squares are 0 in " + format,
                         question_along_z(shape, -std::ldexp(1, -scale), takes_unit ? 1 : std::ldexp(1, -scale), 0,
                                          std::ldexp(1, -scale - 1)));
}

/// Tests that the form hits with the plainest ray. A form that does not cannot be probed further.
bool probe_hit(Trial& trial) {
    bool hits = false;
    trial.probe("hit", [&hits](Trial& t) {
        hits = t.ask(plainest_question(t.shape)).hit == 1;
        if (!hits && !try_other_side(t))
            t.report_broken("misses the simplest ray: " + plainest_ray_text(t.shape, ", against "));
    });
    return hits;
}

/// Probes the properties of the answers. Probes that only make sense if the t of the plainest ray is right are left
/// out if it is wrong, and named.
void probe_properties(Trial& trial) {
    const bool t_is_right = !trial.has_broken("t") && !trial.has_broken("hit");
    std::string skipped_probes;
    const auto probe_if_right = [&](const char* name, const auto& probe, bool applies = true) {
        if (!applies) return;
        if (t_is_right) trial.probe(name, probe);
        else skipped_probes += (skipped_probes.empty() ? "" : ", ") + std::string(name);
    };

    // Directions and roots.
    trial.probe("direction", try_direction);
    probe_if_right("far", try_far_root, trial.contract.roots == Roots::both);
    probe_if_right("inside", try_inside, is_crossed_twice(trial.shape));
    if (trial.contract.roots == Roots::near_only) probe_if_right("behind", try_behind);
    else trial.probe("behind", try_behind);

    // Sides and borders of the surface.
    trial.probe("aside", try_passing_ray);
    if (is_flat(trial.shape)) trial.probe("facing", try_facing);
    probe_if_right("touching", try_touching);
    if (is_flat(trial.shape)) trial.probe("within", try_in_plane);

    // Starts and ends of rays.
    probe_if_right("at-origin", try_at_origin);
    probe_if_right("close", try_just_ahead, trial.reports_t);
    trial.probe("end", try_end);
    probe_if_right("range", try_range, trial.has_flag(LB_RANGE));

    // Comparisons with the truth on many rays.
    probe_if_right("scale", try_scale);
    if (!trial.has_broken_property()) trial.probe("rays", try_rays);  // otherwise the mistake is known already
    // Half of the rays of this probe come from behind.
    probe_if_right("edges", try_edges, !trial.has_broken("facing") && !trial.has_broken("rays"));

    if (!skipped_probes.empty())
        trial.probe("t", [&](Trial& t) {
            t.report_note(
                std::string(t.has_broken("t") ? "what follows from a wrong t" : "what follows from wrong hits") +
                " is not judged: " + skipped_probes);
        });
}

/// Runs every probe on one form.
std::vector<Observation> run_all_probes(const ForeignForm& form) {
    Trial trial(form);
    probe_calls(trial);
    if (!probe_hit(trial)) return std::move(trial.findings);
    if (trial.reports_t) trial.probe("t", try_t);
    if (!trial.has_broken("t")) trial.probe(trial.reports_t ? "t" : "hit", try_extent);
    probe_properties(trial);
    try_unusual_numbers(trial);
    return std::move(trial.findings);
}

}  // namespace

std::vector<Observation> try_contract(const ForeignForm& form, const ForeignForm* first_root_form) {
    using enum Observation::Verdict;
    std::vector<Observation> findings = run_all_probes(form);
    if (first_root_form == nullptr) return findings;
    bool is_kept = true;
    for (const Observation& t_observation : run_all_probes(*first_root_form)) {
        if (t_observation.verdict != broken) continue;
        is_kept = false;
        if (std::ranges::none_of(findings, [&t_observation](const Observation& observation) {
                return observation.verdict == broken && observation.subject == t_observation.subject;
            }))
            findings.push_back({t_observation.subject, broken, "the t beside near and far: " + t_observation.text});
    }
    if (is_kept)
        findings.push_back({"first", kept, "the t beside near and far is the root that counts, in every probe"});
    return findings;
}

}  // namespace lostbits::measure::contract
