// Probes the answers of a form to rays that start inside, touch, or start on the surface. Also probes the state in
// which the form leaves the processor.
#include "intersect/external/guard.hpp"
#include "measure/contract/random_questions.hpp"
#include "measure/contract/trial.hpp"

namespace lostbits::measure::contract {

using intersect::AtOrigin;
using intersect::Facing;
using intersect::Inside;
using intersect::Roots;
using intersect::Touching;

namespace {

/// Kinds of answers, by the roots of the line.
enum class RightAnswer { miss, zero, near, exit, unsigned_near, other };

RightAnswer answer_of(const Reply& reply, double near, double far) {
    if (reply.hit != 1) return RightAnswer::miss;
    if (std::fabs(reply.near) <= 0x1p-20) return RightAnswer::zero;
    if (is_answer(reply.near, far)) return RightAnswer::exit;
    if (is_answer(reply.near, near)) return RightAnswer::near;
    return is_answer(reply.near, -near) ? RightAnswer::unsigned_near : RightAnswer::other;
}

/// A ray from inside along z, with its reply and the t at which the line enters and leaves.
struct RayFromInside {
    RayFromInside(const Trial& trial, double z) : start_z(z), reply(trial.ask(question_along_z(trial.shape, z, 1))) {
        intersect::external::Contract exits = trial.contract;
        exits.inside = Inside::exit;
        exits.roots = Roots::first_only;
        exits.facing = Facing::both;
        far = truth_by(exits, question_along_z(trial.shape, z, 1)).t;
        near = -truth_by(exits, question_along_z(trial.shape, z, -1)).t;
    }
    [[nodiscard]] RightAnswer answer() const { return answer_of(reply, near, far); }
    [[nodiscard]] bool far_is_right() const { return is_answer(reply.far, far); }
    [[nodiscard]] std::string reply_text(bool with_far) const {
        if (reply.hit != 1) return "a miss";
        return text_of(reply.near) + (with_far ? " and " + text_of(reply.far) : "");
    }
    [[nodiscard]] std::string roots() const { return text_of(near) + " and " + text_of(far); }

    double start_z;
    Reply reply;
    double near = 0, far = 0;
};

/// Two rays off the centre, so that the two roots of a ray have different magnitudes.
struct RaysFromInside {
    explicit RaysFromInside(const Trial& trial) : up(trial, 1), down(trial, -1) {}
    RayFromInside up, down;

    [[nodiscard]] RightAnswer answer() const { return up.answer() == down.answer() ? up.answer() : RightAnswer::other; }
    [[nodiscard]] bool far_is_right() const { return up.far_is_right() && down.far_is_right(); }
    [[nodiscard]] std::string text(bool with_far) const {
        return "from (0, 0, 1) and (0, 0, -1), inside, along (0, 0, 1) it answers " + up.reply_text(with_far) +
               ", and " + down.reply_text(with_far);
    }
    [[nodiscard]] std::string roots() const { return up.roots() + ", and " + down.roots(); }
};

/// Text on a wrong answer to a ray that starts inside, exactly beside the centre: of all points of the line, the origin
/// is the closest to the centre. Empty if the answer is right, and for shapes that are flat or have an axis.
std::string mistake_beside_centre(const Trial& trial) {
    if (is_flat(trial.shape) || has_axis(trial.shape) || !has_inside(trial.shape)) return "";
    Question q = question_along_z(trial.shape, 0, 1);
    q.ray.origin.x = 1;
    const HitOrMiss right = trial.truth(q), answer = read_reply(trial.contract, trial.ask(q), q);
    if (answer.hit == right.hit && (!right.hit || is_answer(answer.t, right.t))) return "";
    return "a ray from inside that starts exactly beside the centre, from (1, 0, 0) along (0, 0, 1), is answered "
           "with " +
           answer_text(trial, answer) + "; " + answer_text(trial, right) + " is right";
}

void try_interval(Trial& trial, const RaysFromInside& rays) {
    const RightAnswer answer = rays.answer();
    const bool is_clipped = trial.has_flag(LB_CLIPPED), is_far_right = rays.far_is_right();
    const bool zero_is_right = inside_returns_zero(trial.shape) && trial.contract.inside != Inside::exit;

    // The two rays miss, or have the whole interval, or one that is clipped to the ray.
    if (answer == RightAnswer::miss) {
        trial.check(trial.contract.inside == Inside::miss, "a ray from inside misses",
                    "a ray from inside misses; say LB_INSIDE_MISS (inside_misses, inside=miss)");
    } else if (answer == RightAnswer::near && is_far_right) {
        if (is_clipped) trial.report_note("from inside, near is behind: it is not clipped to the ray");
        else trial.report_kept("from inside, near is behind and far ahead");
    } else if (answer == RightAnswer::zero && is_far_right) {
        if (is_clipped || zero_is_right) trial.report_kept("from inside, near is 0 and far ahead: clipped to the ray");
        else
            trial.report_broken(
                "from inside, near is clipped to 0; say LB_CLIPPED and LB_EXIT (clipped; flags=clipped, "
                "at_origin=exit)");
    } else {
        trial.report_broken(rays.text(true) + "; " + rays.roots() + " are right");
    }
}

/// Property to write for this answer; empty if no property describes it.
std::string property_for_answer(RightAnswer answer, Roots roots) {
    const bool is_near_only = roots == Roots::near_only;
    switch (answer) {
        case RightAnswer::miss: return "LB_INSIDE_MISS (inside_misses, inside=miss)";
        case RightAnswer::zero: return "LB_INSIDE_ZERO (inside_zero, inside=zero)";
        case RightAnswer::exit:
            return is_near_only ? "LB_FIRST (first_root, roots=first)" : "LB_INSIDE_EXIT (inside_exit, inside=exit)";
        case RightAnswer::near: return "LB_NEAR (near_root, roots=near)";
        case RightAnswer::unsigned_near:
        case RightAnswer::other: break;
    }
    return "";
}

RightAnswer stated_answer_inside(const intersect::external::Contract& contract) {
    switch (contract.inside) {
        case Inside::exit: return RightAnswer::exit;
        case Inside::zero: return RightAnswer::zero;
        case Inside::near: return RightAnswer::near;
        case Inside::miss: return RightAnswer::miss;
        case Inside::usual: break;
    }
    if (contract.roots == Roots::near_only) return RightAnswer::miss;
    return inside_returns_zero(contract.shape) ? RightAnswer::zero : RightAnswer::exit;
}

constexpr std::array<const char*, 6> answer_texts{"misses",
                                                  "is answered with 0",
                                                  "is answered with the near root, behind it",
                                                  "is answered with the exit",
                                                  "is answered with the near root without its sign",
                                                  "is answered with something else"};

std::string property_for_facing(Facing facing) {
    return facing == Facing::front ? "LB_FACING_FRONT (facing_front, facing=front)"
                                   : "LB_FACING_BACK (facing_back, facing=back)";
}

/// Contract properties for a surface at the origin.
constexpr std::array<AtOrigin, 3> all_at_origin{AtOrigin::hit, AtOrigin::miss, AtOrigin::exit};
constexpr std::array<const char*, 3> at_origin_texts{
    "LB_HIT (at_origin=hit)", "LB_MISS (origin_misses, at_origin=miss)", "LB_EXIT (origin_exits, at_origin=exit)"};

}  // namespace

void try_inside(Trial& trial) {
    const RaysFromInside rays(trial);
    const intersect::external::Contract& contract = trial.contract;
    if (contract.roots == Roots::both) return try_interval(trial, rays);

    // Without a t, only the decision counts.
    const RightAnswer answer = rays.answer(), stated_answer = stated_answer_inside(contract);
    if (!trial.reports_t) {
        const bool hits = stated_answer != RightAnswer::miss;
        return trial.check((rays.up.reply.hit == 1) == hits && (rays.down.reply.hit == 1) == hits,
                           hits ? "a ray from inside hits" : "a ray from inside misses",
                           hits ? "a ray from inside misses; say LB_INSIDE_MISS (inside_misses, inside=miss)"
                                : "a ray from inside hits; leave out inside=miss");
    }

    // For the near root alone, the table reads a near root behind the ray as a miss.
    const std::string text = std::string("a ray from inside ") + answer_texts[static_cast<std::size_t>(answer)];
    const bool are_both_misses = contract.roots == Roots::near_only &&
                                 (answer == RightAnswer::near || answer == RightAnswer::miss) &&
                                 (stated_answer == RightAnswer::near || stated_answer == RightAnswer::miss);
    if (answer == stated_answer || are_both_misses) {
        const std::string mistake = mistake_beside_centre(trial);
        return mistake.empty() ? trial.report_kept(text) : trial.report_broken(mistake);
    }

    const std::string property = property_for_answer(answer, contract.roots);
    trial.report_broken(
        text + (property.empty() ? ": " + rays.text(false) + "; the roots are " + rays.roots() : "; say " + property));
}

void try_facing(Trial& trial) {
    const bool is_met = trial.ask(question_along_z(trial.shape, 5, -1)).hit == 1;
    const Facing facing = trial.contract.facing;
    if (facing == Facing::both)
        return trial.check(is_met, "both sides are met",
                           "the front is not met; say " + property_for_facing(Facing::back));
    trial.check(!is_met, "the other side is not met", "the other side is met as well; leave facing out");
}

bool try_other_side(Trial& trial) {
    if (!is_flat(trial.shape) || trial.ask(question_along_z(trial.shape, 5, -1)).hit != 1) return false;
    const Facing stated = trial.contract.facing, facing_met = stated == Facing::front ? Facing::back : Facing::front;
    trial.report_broken((stated == Facing::front  ? "the back is met, not the front as stated"
                         : stated == Facing::back ? "the front is met, not the back as stated"
                                                  : "only the front is met, not the back") +
                        ("; say " + property_for_facing(facing_met)));
    return true;
}

void try_touching(Trial& trial) {
    // The ray is a tangent, or runs in the plane of a face or through a rim: it hits the closed primitive and misses
    // the open one.
    intersect::external::Contract closed = trial.contract, open = trial.contract;
    closed.touching = Touching::hit;
    open.touching = Touching::miss;
    Question q = question_along_z(trial.shape, -5, 1);
    const auto touches = [&](double x) {
        q.ray.origin.x = x;
        return trial.truth(q, closed).hit && !trial.truth(q, open).hit;
    };
    if (!touches(2) && !touches(1)) return;  // a plane has no rim

    // The same touch from three distances and on both sides.
    const std::string ray_text(row_of(trial.shape).texts.touching_ray);
    int hits = 0, tested = 0;
    for (const double start_z : {-5.0, -4.0, -7.0}) {
        for (const double side : {1.0, -1.0}) {
            Question question = q;
            question.ray.origin.x *= side;
            question.ray.origin.z = start_z;
            const double right = trial.truth(question, closed).t;
            const HitOrMiss answer = read_reply(closed, trial.ask(question), question);
            // A march stops short of a tangent by the square root of its epsilon.
            if (trial.reports_t && answer.hit && !(std::fabs(answer.t - right) <= 0.5))
                return trial.report_broken(ray_text + " is answered with t = " + text_of(answer.t) + "; " +
                                           text_of(right) + " is right");
            ++tested;
            hits += answer.hit;
        }
    }
    if (hits > 0 && hits < tested)
        return trial.report_note(ray_text + " hits in " + std::to_string(hits) + " of " + std::to_string(tested) +
                                 " places: rounding decides, or the side that it is on");

    // A wrong decision is rounding if a ray beside the touch, which should be decided the other way, gets it too.
    const bool should_hit = trial.contract.touching == Touching::hit, is_hit = hits > 0;
    const double offset = trial.contract.bits == 32 ? 0x1p-20 : 0x1p-49;  // eight numbers of the format
    Question neighbour = q;
    neighbour.ray.origin.x += is_hit ? offset : -offset;
    if (is_hit != should_hit && (trial.ask(neighbour).hit == 1) == is_hit)
        return trial.report_note(ray_text + (is_hit ? " hits, and so does one " : " misses, and so does one ") +
                                 text_of(offset) + (is_hit ? " outside" : " inside") + ": rounding decides");
    trial.check(is_hit == should_hit, ray_text + (is_hit ? " hits" : " misses"),
                ray_text + (is_hit ? " hits; say LB_HIT (touching=hit)"
                                   : " misses; say LB_MISS (touching_misses, touching=miss)"));
}

void try_in_plane(Trial& trial) {
    // Rays in the plane of the primitive: through its centre from either side, off the centre, from inside it and
    // beside it. Two further rays run beside the plane.
    constexpr double rays[][4]{{-5, 0, -2, 1}, {5, 0, -2, -1}, {-5, 0.5, -2, 1}, {-5, -1, -2, 1},
                               {0, 0, -2, 1},  {5, 9, -2, -1}, {-5, 0, -1, 1},   {0.25, 0, -3, -1}};
    for (const auto& [x, y, z, dx] : rays) {
        Question q = question_along_z(trial.shape, z, 0);
        q.ray = {{x, y, z}, {dx, 0, 0}};
        const Reply r = trial.ask(q);
        if (!read_reply(trial.contract, r, q).hit || trial.truth(q).hit) continue;
        return trial.report_broken((z == -2 ? "a ray in its plane" : "a ray beside its plane") + std::string(" hits") +
                                   (trial.reports_t ? " at t = " + text_of(r.near) : "") +
                                   "; it should miss, since it does not cross it");
    }
    trial.report_kept("rays in its plane and beside it miss");
}

namespace {

/// A ray along z from a point of the surface, with the reply of the form.
struct RayFromSurface {
    Question question;
    Reply reply;
    bool goes_in;

    [[nodiscard]] std::string text(const Trial& trial) const {
        const HitOrMiss answer = read_reply(trial.contract, reply, question);
        return !answer.hit ? "misses" : trial.reports_t ? "is answered with t = " + text_of(answer.t) : "hits";
    }
};

/// Rays in both directions from the surface at z = -2, and from the surface at z = 2 if there is one. Leaves out a side
/// that the form does not meet from afar: missing this side from the surface too is a matter of `facing`, not of
/// `at_origin`.
std::vector<RayFromSurface> rays_from_surface(const Trial& trial) {
    std::vector<RayFromSurface> rays;
    const bool may_be_one_sided = is_flat(trial.shape) && trial.contract.facing == Facing::both;
    const auto add = [&](double z, double direction, bool goes_in) {
        if (may_be_one_sided && trial.ask(question_along_z(trial.shape, -5 * direction, direction)).hit != 1) return;
        const Question q = question_along_z(trial.shape, z, direction);
        rays.push_back({q, trial.ask(q), goes_in});
    };
    const double inward = entry_sign(trial.shape);
    add(-2, inward, true);
    add(-2, -inward, false);
    if (is_crossed_twice(trial.shape)) {
        add(2, -1, true);
        add(2, 1, false);
    }
    return rays;
}

/// If a form answers near and far, the table picks the root that counts, whatever the contract says about the origin.
/// The form only has to answer both roots.
bool is_right_from_surface(const Trial& trial, const RayFromSurface& ray_from_surface,
                           const intersect::external::Contract& other_contract) {
    if (other_contract.roots == Roots::both)
        return ray_from_surface.reply.hit == 1 || !trial.truth(ray_from_surface.question, other_contract).hit;
    return trial.is_right(ray_from_surface.question, ray_from_surface.reply, other_contract);
}

bool are_all_right(const Trial& trial, const std::vector<RayFromSurface>& rays,
                   const intersect::external::Contract& other_contract) {
    return std::ranges::all_of(rays, [&](const RayFromSurface& ray_from_surface) {
        return is_right_from_surface(trial, ray_from_surface, other_contract);
    });
}

}  // namespace

void try_at_origin(Trial& trial) {
    const std::vector<RayFromSurface> rays = rays_from_surface(trial);
    const bool is_flat_shape = is_flat(trial.shape);
    const std::string surface_text = "a surface at the origin ";
    const std::string inward_text = "a ray that starts on the surface and goes in ",
                      outward_text = ", one that goes out ";

    const bool any_hits = std::ranges::any_of(
        rays, [](const RayFromSurface& ray_from_surface) { return ray_from_surface.reply.hit == 1; });
    // If a form answers only the near root, the table drops a t of 0. A form that answers the first root has to drop a
    // t of 0 itself.
    const bool hits_count = any_hits && trial.contract.roots != Roots::near_only,
               are_hits_dropped = any_hits && !hits_count;
    const std::string behaviour = is_flat_shape && are_hits_dropped && trial.contract.at_origin == AtOrigin::miss
                                      ? surface_text + "gets t = 0, which counts as a miss"
                                  : is_flat_shape
                                      ? surface_text + (any_hits ? "counts" : "is passed over")
                                      : inward_text + rays[0].text(trial) + outward_text + rays[1].text(trial);
    const bool contradicts_miss = is_flat_shape && hits_count && trial.contract.at_origin == AtOrigin::miss;
    if (!contradicts_miss && are_all_right(trial, rays, trial.contract)) return trial.report_kept(behaviour);

    // Finds the property that would make all answers right, or else reports the first wrong one.
    for (const AtOrigin property : all_at_origin) {
        intersect::external::Contract other = trial.contract;
        other.at_origin = property;
        if (is_consistent(other) && are_all_right(trial, rays, other))
            return trial.report_broken(behaviour + "; say " + at_origin_texts[static_cast<std::size_t>(property)]);
    }
    for (const RayFromSurface& ray_from_surface : rays) {
        if (is_right_from_surface(trial, ray_from_surface, trial.contract)) continue;
        const HitOrMiss right = trial.truth(ray_from_surface.question);
        return trial.report_broken((is_flat_shape              ? surface_text
                                    : ray_from_surface.goes_in ? inward_text
                                                               : "a ray that starts on the surface and goes out ") +
                                   ray_from_surface.text(trial) + "; " +
                                   (!right.hit        ? "a miss is right"
                                    : trial.reports_t ? text_of(right.t) + " is right"
                                                      : "it should hit"));
    }
}

void try_just_ahead(Trial& trial) {
    const double gap = trial.contract.bits == 32 ? 0x1p-15 : 0x1p-30;
    const double inward = entry_sign(trial.shape);
    const Reply r = trial.ask(question_along_z(trial.shape, -2 - inward * gap, inward));
    const std::string surface_text = "a surface " + text_of(gap) + " ahead ";
    if (r.hit == 1 && std::fabs(r.near) <= 4 * gap) return trial.report_kept(surface_text + "is met");
    trial.report_broken(
        surface_text + (r.hit == 1 ? "is answered with t = " + text_of(r.near) : std::string("is a miss")) +
        ": it seems to have a least t, such as a tmin or an epsilon. No property declares that; leave it to the "
        "caller");
}

Observation observe_state(const intersect::external::ForeignForm& form) {
    const std::string& state_after_load = form.contract.state;
    const std::string load_text = state_after_load.empty() ? ""
                                                           : "loading its library leaves the processor with " +
                                                                 state_after_load + ", and it runs in that state";
    const std::string change_text = intersect::external::find_noted_change(intersect::external::name_in_messages(form));
    if (!change_text.empty())
        return {"state", Observation::Verdict::broken, change_text + (load_text.empty() ? "" : "; " + load_text)};
    if (!load_text.empty())
        return {"state", Observation::Verdict::noted, load_text + ", as for its users; nothing else does"};
    return {"state", Observation::Verdict::kept, "it computes with rounding to nearest and with subnormal numbers"};
}

}  // namespace lostbits::measure::contract
