// What a form answers from inside, where it touches, and from the surface itself; and what it leaves the processor in.
#include "intersect/doors/guard.hpp"
#include "measure/contract/trial.hpp"

namespace lostbits::measure::contract {

using intersect::AtOrigin;
using intersect::Facing;
using intersect::Inside;
using intersect::Roots;
using intersect::Touching;

namespace {

/// What an answer is, by the roots that the line has.
enum class Answer { miss, zero, near, exit, unsigned_near, other };

Answer answer_of(const Reply& r, double near, double far) {
    if (r.hit != 1) return Answer::miss;
    if (std::fabs(r.near) <= 0x1p-20) return Answer::zero;
    if (is_answer(r.near, far)) return Answer::exit;
    if (is_answer(r.near, near)) return Answer::near;
    return is_answer(r.near, -near) ? Answer::unsigned_near : Answer::other;
}

/// Two rays off the middle, so that no root has the size of the other.
struct FromInside {
    explicit FromInside(const Trial& trial)
        : up(trial.ask(along(trial.shape, 1, 1))), down(trial.ask(along(trial.shape, -1, 1))) {}
    Reply up, down;  ///< roots -3 and 1; -1 and 3

    [[nodiscard]] Answer answer() const {
        const Answer one = answer_of(up, -3, 1), other = answer_of(down, -1, 3);
        return one == other ? one : Answer::other;
    }
    [[nodiscard]] bool far_is_right() const { return is_answer(up.far, 1) && is_answer(down.far, 3); }
    [[nodiscard]] std::string words(bool both) const {
        const auto told = [both](const Reply& r) {
            if (r.hit != 1) return std::string("a miss");
            return text_of(r.near) + (both ? " and " + text_of(r.far) : "");
        };
        return "from (0, 0, 1) and (0, 0, -1), inside, along (0, 0, 1) it answers " + told(up) + ", and " + told(down);
    }
};

void try_interval(Trial& trial, const FromInside& inside) {
    const Answer answer = inside.answer();
    const bool clipped = trial.says(LB_CLIPPED), right = inside.far_is_right();
    const bool zero_is_right = zero_inside(trial.shape) && trial.contract.inside != Inside::exit;
    if (answer == Answer::miss) {
        trial.hold(trial.contract.inside == Inside::miss, "a ray from inside misses",
                   "a ray from inside misses; say LB_INSIDE_MISS (inside_misses, inside=miss)");
    } else if (answer == Answer::near && right) {
        if (clipped) trial.told("from inside, near is behind: it is not clipped to the ray");
        else trial.kept("from inside, near is behind and far ahead");
    } else if (answer == Answer::zero && right) {
        if (clipped || zero_is_right) trial.kept("from inside, near is 0 and far ahead: clipped to the ray");
        else
            trial.broken(
                "from inside, near is clipped to 0; say LB_CLIPPED and LB_EXIT (clipped; flags=clipped, "
                "at_origin=exit)");
    } else {
        trial.broken(inside.words(true) + "; -3 and 1, and -1 and 3 are right");
    }
}

/// What to write for what it does; empty where there is no word for it.
std::string word_for(Answer answer, Roots roots) {
    const bool near = roots == Roots::near_only;
    switch (answer) {
        case Answer::miss: return "LB_INSIDE_MISS (inside_misses, inside=miss)";
        case Answer::zero: return "LB_INSIDE_ZERO (inside_zero, inside=zero)";
        case Answer::exit:
            return near ? "LB_FIRST (first_root, roots=first)" : "LB_INSIDE_EXIT (inside_exit, inside=exit)";
        case Answer::near: return "LB_NEAR (near_root, roots=near)";
        case Answer::unsigned_near:
        case Answer::other: break;
    }
    return "";
}

Answer promised_inside(const intersect::doors::Contract& c) {
    switch (c.inside) {
        case Inside::exit: return Answer::exit;
        case Inside::zero: return Answer::zero;
        case Inside::near: return Answer::near;
        case Inside::miss: return Answer::miss;
        case Inside::usual: break;
    }
    if (c.roots == Roots::near_only) return Answer::miss;
    return zero_inside(c.shape) ? Answer::zero : Answer::exit;
}

constexpr std::array<const char*, 6> answer_words{"misses",
                                                  "is answered with 0",
                                                  "is answered with the near root, behind it",
                                                  "is answered with the exit",
                                                  "is answered with the near root without its sign",
                                                  "is answered with something else"};

std::string word_for(Facing facing) {
    return facing == Facing::front ? "LB_FACING_FRONT (facing_front, facing=front)"
                                   : "LB_FACING_BACK (facing_back, facing=back)";
}

/// What is flat is neither entered nor left.
void try_on_flat(Trial& trial, const Reply& ray, const Reply& back) {
    const intersect::doors::Contract& c = trial.contract;
    const std::string surface = "a surface at the origin ";
    if (trial.tells_t && ray.hit == 1 && std::fabs(ray.near) > 0x1p-20)
        return trial.broken(surface + "is answered with t = " + text_of(ray.near) + "; 0 or a miss would be right");
    const bool counts = ray.hit == 1;
    trial.hold(counts == (c.at_origin != AtOrigin::miss), surface + (counts ? "counts" : "is passed over"),
               surface + (counts ? "counts; say LB_HIT (at_origin=hit)"
                                 : "is passed over; say LB_MISS (origin_misses, at_origin=miss)"));
    if ((back.hit == 1) != (counts && c.facing == Facing::both))
        trial.broken(surface + (back.hit == 1 ? "counts on its other side" : "counts on one of its sides alone"));
}

/// Of a plane, which has no rim to touch: what runs in it does not cross it, by either word.
void try_within(Trial& trial) {
    Question q = along(trial.shape, -2, 0);
    q.ray[0] = -5, q.ray[3] = 1;
    const std::string what(row_of(trial.shape).words.touching);
    trial.hold(trial.ask(q).hit == 0, what + " misses", what + " hits; it should miss, since it does not cross it");
}

}  // namespace

void try_inside(Trial& trial) {
    const FromInside inside(trial);
    const intersect::doors::Contract& c = trial.contract;
    if (c.roots == Roots::both) return try_interval(trial, inside);
    const Answer answer = inside.answer(), promised = promised_inside(c);
    if (!trial.tells_t) {
        const bool hits = promised != Answer::miss;
        return trial.hold((inside.up.hit == 1) == hits && (inside.down.hit == 1) == hits,
                          hits ? "a ray from inside hits" : "a ray from inside misses",
                          hits ? "a ray from inside misses; say LB_INSIDE_MISS (inside_misses, inside=miss)"
                               : "a ray from inside hits; leave out that it misses (inside=miss)");
    }
    const std::string what = std::string("a ray from inside ") + answer_words[static_cast<std::size_t>(answer)];
    const bool behind = c.roots == Roots::near_only && (answer == Answer::near || answer == Answer::miss) &&
                        (promised == Answer::near || promised == Answer::miss);
    if (answer == promised || behind) return trial.kept(what);
    const std::string word = word_for(answer, c.roots);
    trial.broken(what + (word.empty() ? ": " + inside.words(false) + "; the roots are -3 and 1, and -1 and 3"
                                      : "; say " + word));
}

void try_facing(Trial& trial) {
    const bool met = trial.ask(along(trial.shape, 5, -1)).hit == 1;
    const Facing facing = trial.contract.facing;
    if (facing == Facing::both)
        return trial.hold(met, "both sides are met", "the front is not met; say " + word_for(Facing::back));
    trial.hold(!met, "the other side is not met", "the other side is met as well; leave facing out");
}

bool try_other_side(Trial& trial) {
    if (!is_flat(trial.shape) || trial.ask(along(trial.shape, 5, -1)).hit != 1) return false;
    const Facing met = trial.contract.facing == Facing::front ? Facing::back : Facing::front;
    trial.broken("of the two sides one is met; say " + word_for(met));
    return true;
}

void try_touching(Trial& trial) {
    Question q = along(trial.shape, -5, 1);
    q.ray[0] = 0x1p10;
    if (is_flat(trial.shape) && ends_of(q, trial.shape)) return try_within(trial);
    q.ray[0] = 2;  // a tangent; of a box a ray in the plane of a face
    if (is_flat(trial.shape) && !ends_of(q, trial.shape)) q.ray[0] = 1;  // a triangle, which is half as wide there
    const Reply touch = trial.ask(q);
    q.ray[0] = -q.ray[0];
    const Reply other = trial.ask(q);
    const bool promised = trial.contract.touching == Touching::hit;
    const std::string what(row_of(trial.shape).words.touching);
    // A march stops short of a tangent by the root of its epsilon.
    const auto ends = ends_of(q, trial.shape);
    for (const Reply& r : {touch, other}) {
        if (ends && trial.tells_t && r.hit == 1 && !(std::fabs(r.near - ends->near) <= 0.5))
            return trial.broken(what + " is answered with t = " + text_of(r.near) + "; " + text_of(ends->near) +
                                " is right");
    }
    if (touch.hit != other.hit) return trial.told(what + " hits on one side of the solid and misses on the other");
    trial.hold((touch.hit == 1) == promised, what + (touch.hit == 1 ? " hits" : " misses"),
               what + (touch.hit == 1 ? " hits; say LB_HIT (touching=hit)"
                                      : " misses; say LB_MISS (touching_misses, touching=miss)"));
}

void try_at_origin(Trial& trial) {
    const intersect::doors::Contract& c = trial.contract;
    const bool leaves = is_crossed_twice(trial.shape) && c.inside != Inside::miss && c.roots != Roots::near_only;
    const Reply in = trial.ask(along(trial.shape, -2, 1)), out = trial.ask(along(trial.shape, -2, -1));
    if (c.roots == Roots::both) {  // the table takes the one that counts
        if (in.hit != 1) trial.broken("a ray that starts on the surface and goes in misses");
        else if (trial.says(LB_CLIPPED) && !zero_inside(trial.shape))
            trial.hold(out.hit == 1 || c.at_origin == AtOrigin::miss, "an entry at the origin is passed over",
                       "a ray that starts on the surface and goes out misses; say LB_MISS (origin_misses, "
                       "at_origin=miss)");
        return;
    }
    if (is_flat(trial.shape)) return try_on_flat(trial, in, out);
    if (!trial.tells_t) {
        const bool enters = leaves || c.at_origin == AtOrigin::hit;
        trial.hold(
            (in.hit == 1) == enters, enters ? "a ray that starts on the surface and goes in hits" : "it misses",
            enters ? "a ray that starts on the surface and goes in misses" : "a ray that starts on the surface hits");
        if (zero_inside(trial.shape)) return;
        const bool exits = leaves && c.at_origin != AtOrigin::miss;
        return trial.hold((out.hit == 1) == exits, exits ? "one that goes out hits" : "one that goes out misses",
                          exits ? "one that goes out misses; say LB_MISS (origin_misses, at_origin=miss)"
                                : "one that goes out hits; say LB_HIT or LB_EXIT (at_origin=hit, exit)");
    }
    const Answer entry = answer_of(in, 0, 4), exit = answer_of(out, -4, 0);
    const bool zero = entry == Answer::zero, passed = entry == (leaves ? Answer::exit : Answer::miss);
    const bool out_is_zero = exit == Answer::zero;
    if (!zero && !passed)
        return trial.broken(
            in.hit != 1 ? "a ray that starts on the surface and goes in misses"
                        : "a ray that starts on the surface and goes in is answered with t = " + text_of(in.near) +
                              "; 0 or " + (leaves ? "4" : "a miss") + " would be right");
    // Where exits do not count, one at the origin does not either.
    const bool told_out = !zero_inside(trial.shape) && leaves;
    const AtOrigin does = zero ? AtOrigin::hit : told_out && out_is_zero ? AtOrigin::exit : AtOrigin::miss;
    if (zero && told_out && !out_is_zero)
        return trial.broken(
            "a surface at the origin counts where the ray goes in (t = 0), and not where it goes out (" +
            (out.hit == 1 ? "t = " + text_of(out.near) : std::string("a miss")) + "); no word says that");
    const bool either = !told_out && !zero && c.at_origin != AtOrigin::hit;
    constexpr std::array<const char*, 3> does_words{"a surface at the origin counts: t = 0",
                                                    "a surface at the origin is passed over",
                                                    "an entry at the origin is passed over, an exit is t = 0"};
    constexpr std::array<const char*, 3> say_words{"LB_HIT (at_origin=hit)", "LB_MISS (origin_misses, at_origin=miss)",
                                                   "LB_EXIT (origin_exits, at_origin=exit)"};
    const auto place = static_cast<std::size_t>(does);
    trial.hold(does == c.at_origin || either, does_words[place],
               std::string(does_words[place]) + "; say " + say_words[place]);
}

void try_close(Trial& trial) {
    const double ahead = trial.contract.bits == 32 ? 0x1p-15 : 0x1p-30;
    const Reply r = trial.ask(along(trial.shape, -2 - ahead, 1));
    const std::string surface = "a surface " + text_of(ahead) + " ahead ";
    if (r.hit == 1 && std::fabs(r.near) <= 4 * ahead) return trial.kept(surface + "is met");
    trial.broken(surface + (r.hit == 1 ? "is answered with t = " + text_of(r.near) : std::string("is a miss")) +
                 ": it seems to have a least t, as a tmin or an epsilon; no word says that, let the caller have it");
}

Observation observe_state(const intersect::doors::ForeignForm& form) {
    const std::string& loaded = form.contract.state;
    const std::string where =
        loaded.empty() ? "" : "loading its library leaves the processor with " + loaded + ", and it is run so";
    const std::string noted = intersect::doors::change_noted(intersect::doors::name_in_messages(form));
    if (!noted.empty()) return {"state", Observation::Verdict::broken, noted + (where.empty() ? "" : "; " + where)};
    if (!where.empty()) return {"state", Observation::Verdict::told, where + ", as its users run it; nothing else is"};
    return {"state", Observation::Verdict::kept, "the processor rounds to nearest in it and keeps subnormal numbers"};
}

}  // namespace lostbits::measure::contract
