#include "measure/contract/probe.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <exception>
#include <mutex>
#include <thread>

#include "measure/contract/asked.hpp"
#include "number/error.hpp"

namespace lostbits::measure::contract {

using intersect::AtOrigin;
using intersect::Direction;
using intersect::Roots;
using intersect::Touching;
using intersect::doors::Contract;
using intersect::doors::ForeignForm;

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();

bool is_answer(double x, double right) { return std::fabs(x - right) <= 0x1p-10 * std::max(1.0, std::fabs(right)); }

std::string text_of(double x) {
    if (std::isnan(x)) return "NaN";
    std::array<char, 32> text{};
    return {text.data(), static_cast<std::size_t>(std::snprintf(text.data(), text.size(), "%.7g", x))};
}

/// The same bits, and a NaN is a NaN.
bool same(const Reply& a, const Reply& b) {
    const auto equal = [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); };
    return a.hit == b.hit && equal(a.near, b.near) && equal(a.far, b.far);
}

bool all_same(const std::vector<Reply>& a, const std::vector<Reply>& b) { return std::ranges::equal(a, b, same); }

/// A solid of half-width 2 around the origin, or around (0, 0, z): the ray of `along` meets it from z − 2 to z + 2.
Question along(Shape shape, double from, double direction, double z = 0, double half = 2) {
    Question q{.ray = {0, 0, from, 0, 0, direction}, .solid = {0, 0, z, half, 0, 0}};
    if (shape == Shape::box) q.solid = {-half, -half, z - half, half, half, z + half};
    return q;
}

/// Many rays that come from everywhere and meet the solid or do not.
std::vector<Question> many(Shape shape) {
    std::vector<Question> questions;
    std::uint32_t state = 1;
    const auto random = [&state] {
        state = state * 1664525U + 1013904223U;
        return static_cast<double>(state >> 16) / 32768 - 1;
    };
    for (int i = 0; i < 501; ++i) {
        Question q = along(shape, 0, 1);
        for (int k = 0; k < 3; ++k) q.ray[static_cast<std::size_t>(k)] = 8 * random();
        double length = 0;
        for (int k = 0; k < 3; ++k) {
            q.ray[static_cast<std::size_t>(k) + 3] = 2 * random() - q.ray[static_cast<std::size_t>(k)];
            length += q.ray[static_cast<std::size_t>(k) + 3] * q.ray[static_cast<std::size_t>(k) + 3];
        }
        for (int k = 3; k < 6; ++k) q.ray[static_cast<std::size_t>(k)] /= std::sqrt(length);
        questions.push_back(q);
    }
    return questions;
}

/// What is tried of one form.
class Trial {
public:
    explicit Trial(const ForeignForm& form)
        : form_(form), contract_(form.contract), shape_(contract_.shape), tells_t_(contract_.roots != Roots::none) {}

    std::vector<Observation> run() {
        try_batches();
        try_threads();
        const Reply plain = ask(along(shape_, -5, 1));
        if (plain.hit != 1) {
            broken("hit", "misses the plainest ray: origin (0, 0, -5), direction (0, 0, 1), against " + solid_words());
            return std::move(findings_);
        }
        if (tells_t_) try_size(plain);
        try_direction();
        if (tells_t_) try_roots();
        try_behind();
        try_aside();
        try_touching();
        if (shape_ == Shape::sphere) try_origin_on_surface();
        try_ends();
        try_extremes();
        return std::move(findings_);
    }

private:
    void add(const char* subject, Observation::Verdict verdict, std::string words) {
        findings_.push_back({subject, verdict, std::move(words)});
    }
    void kept(const char* subject, std::string words) { add(subject, Observation::Verdict::kept, std::move(words)); }
    void broken(const char* subject, std::string words) {
        add(subject, Observation::Verdict::broken, std::move(words));
    }
    void told(const char* subject, std::string words) { add(subject, Observation::Verdict::told, std::move(words)); }
    void hold(bool good, const char* subject, const std::string& yes, const std::string& no) {
        add(subject, good ? Observation::Verdict::kept : Observation::Verdict::broken, good ? yes : no);
    }

    [[nodiscard]] Reply ask(const Question& q) const { return contract::ask(form_, q); }
    [[nodiscard]] std::string solid_words() const {
        return shape_ == Shape::sphere ? "a sphere of radius 2 around the origin"
                                       : "a box from -2 to 2 in each component";
    }

    void try_batches() {
        const auto questions = many(shape_);
        const auto all = contract::ask(form_, questions);
        const auto unwritten = std::ranges::find_if(all, [](const Reply& r) { return r.hit > 1; });
        if (unwritten != all.end())
            broken("answers", "`hit` is " + std::to_string(unwritten->hit) +
                                  " for a ray of a batch; it must be written, as "
                                  "1 or 0, for each");
        hold(all_same(all, contract::ask(form_, questions)), "same again", "the same batch has the same answers",
             "the same batch asked twice has other answers: it keeps something from the first, or reads what nobody "
             "wrote");
        std::vector<Reply> single;
        for (const Question& q : questions) single.push_back(ask(q));
        hold(all_same(all, single), "batches", "a ray has the same answer in a batch and alone",
             "a ray has another answer in a batch than alone");
        hold(all_same(all, contract::ask(form_, questions, true)), "solids",
             "one solid for all rays, or one for each: the same answers",
             "solids of their own for each ray (solid_stride) are not looked at; step by solid_stride from ray to ray");
    }

    void try_threads() {
        if ((contract_.flags & LB_ONE_THREAD) != 0) return;
        const auto questions = many(shape_);
        const auto alone = contract::ask(form_, questions);
        std::vector<std::thread> threads;
        std::atomic<bool> good = true;
        std::exception_ptr failed;
        std::mutex lock;
        for (int t = 0; t < 4; ++t) {
            threads.emplace_back([&] {
                try {
                    for (int k = 0; k < 20; ++k) good = good && all_same(alone, contract::ask(form_, questions));
                } catch (...) {
                    const std::scoped_lock hold_it(lock);
                    failed = std::current_exception();
                }
            });
        }
        for (std::thread& t : threads) t.join();
        if (failed) std::rethrow_exception(failed);
        hold(good, "threads", "four threads at once have the same answers",
             "four threads at once have other answers; say LB_ONE_THREAD (one_thread)");
    }

    /// Near as it is told, of a ray that comes from outside.
    void try_size(const Reply& plain) {
        if (is_answer(plain.near, 3)) return kept("t", "the plainest ray is met at t = 3, as it is");
        const auto where = " (origin (0, 0, -5), direction (0, 0, 1), " + solid_words() + ": 3 is right, it says " +
                           text_of(plain.near) + ")";
        if (shape_ == Shape::sphere && is_answer(plain.near, 5 - std::sqrt(2.0)))
            return broken("t", "the radius is taken for its square" + where + "; hand over radius * radius");
        if (shape_ == Shape::sphere && is_answer(plain.near, 1))
            return broken("t", "the radius is squared once too often" + where);
        if (shape_ == Shape::sphere && is_answer(plain.near, 4))
            return broken("t", "the radius is taken for a diameter" + where + "; hand over 2 * radius");
        if (is_answer(plain.near, 7))
            return broken("t", "the far root comes first" + where + "; write near before far");
        if (is_answer(plain.near, -3) || is_answer(plain.near, -7))
            return broken("t", "t has the wrong sign" + where + "; is the direction reversed?");
        broken("t", "t is something else" + where);
    }

    void try_direction() {
        const Reply twice = ask(along(shape_, -5, 2));
        if (contract_.direction == Direction::unit) {
            if (tells_t_ && twice.hit == 1 && is_answer(twice.near, 1.5))
                told("direction", "takes unit directions, and is right for others too: the promise could be LB_ANY");
            else kept("direction", "takes unit directions, and gets no others");
            return;
        }
        if (twice.hit != 1)
            return broken("direction",
                          "a direction twice as long misses; say LB_UNIT (unit_direction, direction=unit)");
        if (!tells_t_ || is_answer(twice.near, 1.5))
            return kept("direction", tells_t_ ? "of any length: twice as long, half the t"
                                              : "of any length: twice as long hits as well");
        broken("direction",
               is_answer(twice.near, 3)
                   ? "t is a distance: a direction twice as long changes nothing. Divide by its length, or say LB_UNIT "
                     "(unit_direction, direction=unit)"
                   : "a direction twice as long gives t = " + text_of(twice.near) +
                         " where 1.5 is right; say LB_UNIT (unit_direction, direction=unit)");
    }

    void try_roots() {
        const Reply outside = ask(along(shape_, -5, 1)), inside = ask(along(shape_, 0, 1));
        if (contract_.roots == Roots::both) {
            hold(is_answer(outside.far, 7), "roots", "near and far, from outside",
                 "far is " + text_of(outside.far) +
                     " where 7 is right; say LB_NEAR (roots=near) or LB_FIRST (roots=first) where it tells one");
            const bool clipped = inside.hit == 1 && inside.near == 0 && is_answer(inside.far, 2);
            if (inside.hit == 1 && is_answer(inside.near, -2) && is_answer(inside.far, 2))
                kept("inside", "from inside, near is behind and far ahead");
            else if (clipped) told("inside", "from inside, near is 0 and far ahead: near is clipped to the ray");
            else inside_otherwise(inside);
            return;
        }
        if (contract_.roots == Roots::near_only) {
            if (inside.hit == 0) kept("inside", "one root: a ray from inside has no answer");
            else
                told("inside", "a ray from inside is answered with t = " + text_of(inside.near) +
                                   "; LB_NEAR (roots=near) promises nothing there, LB_FIRST (roots=first) would");
            return;
        }
        if (inside.hit == 1 && (is_answer(inside.near, 2) || (shape_ == Shape::box && is_answer(inside.near, 0))))
            return kept("inside", shape_ == Shape::box ? "a ray from inside is answered"
                                                       : "a ray from inside is answered with the far surface");
        inside_otherwise(inside);
    }

    void inside_otherwise(const Reply& inside) {
        broken("inside",
               inside.hit == 0
                   ? "a ray that starts inside misses; say LB_NEAR (near_root, roots=near) where that is meant"
                   : "a ray that starts in the middle is answered with " + text_of(inside.near) +
                         (contract_.roots == Roots::both ? " and " + text_of(inside.far) + "; -2 and 2 are right"
                                                         : "; 2 is right"));
    }

    void try_behind() {
        const Reply behind = ask(along(shape_, 5, 1));
        const bool line = (contract_.flags & LB_LINE) != 0;
        if (line) return hold(behind.hit == 1, "behind", "the whole line counts", "a solid behind the ray is missed");
        hold(behind.hit == 0, "behind", "what lies behind the ray is missed",
             "a solid behind the ray is hit" + (tells_t_ ? " (t = " + text_of(behind.near) + ")" : std::string()) +
                 "; say LB_LINE (whole_line, flags=line) where it answers for the whole line");
    }

    void try_aside() {
        Question q = along(shape_, -5, 1);
        q.ray = {0, 0, -10, 0.6, 0, 0.8};  // through the planes of a box, beside it
        hold(ask(q).hit == 0, "aside", "a ray that passes by misses",
             "a ray that passes by hits; is this how it says that it misses (of a shader: miss=)?");
    }

    void try_touching() {
        Question q = along(shape_, -5, 1);
        q.ray[0] = 2;  // a tangent; of a box a ray in the plane of a face
        const Reply touch = ask(q);
        q.ray[0] = -2;
        const Reply other = ask(q);
        const bool promised = contract_.touching == Touching::hit;
        const std::string what = shape_ == Shape::sphere ? "a ray that touches" : "a ray in the plane of a face";
        if (touch.hit != other.hit)
            return told("touching", what + " hits on one side of the solid and misses on the other");
        hold((touch.hit == 1) == promised, "touching", what + (touch.hit == 1 ? " hits" : " misses"),
             what + (touch.hit == 1 ? " hits; say LB_HIT (touching=hit)"
                                    : " misses; say LB_MISS (touching_misses, touching=miss)"));
    }

    void try_origin_on_surface() {
        const Reply in = ask(along(shape_, -2, 1));
        if (!tells_t_ || in.hit != 1) {
            if (in.hit != 1 && contract_.roots != Roots::near_only)
                broken("at_origin", "a ray that starts on the surface and goes in misses");
            return;
        }
        const bool zero = in.near == 0, far = is_answer(in.near, 4), promised = contract_.at_origin == AtOrigin::hit;
        // Of both roots the table takes the one that counts.
        if (contract_.roots == Roots::both || contract_.roots == Roots::near_only) return;
        if (zero || far)
            hold(zero == promised, "at_origin",
                 zero ? "a surface at the origin counts: t = 0" : "a surface at the origin is passed over",
                 zero ? "a surface at the origin counts (t = 0); say LB_HIT (at_origin=hit)"
                      : "a surface at the origin is passed over; say LB_MISS (origin_misses, at_origin=miss)");
        else
            broken("at_origin", "a ray that starts on the surface and goes in is answered with t = " +
                                    text_of(in.near) + "; 0 or 4 would be right");
    }

    void try_ends() {
        Question q = along(shape_, -5, 1);
        q.end = 2;
        const bool before = ask(q).hit == 1;
        const bool ignores = (contract_.flags & LB_NO_END) != 0;
        if (shape_ == Shape::sphere) {
            if (!before) told("end", "a ray that ends before the sphere misses; maps and sweeps give spheres no ends");
            return;
        }
        if (ignores) return kept("end", "the ends of rays are looked at by the table, not by the form");
        hold(!before, "end", "a ray that ends before the box misses",
             std::string("a ray that ends before the box hits; ") +
                 (tells_t_ ? "say LB_NO_END (ignores_end, flags=no_end) where ends are not looked at"
                           : "a form that tells no t must look at ends itself (of a shader: float tmax)"));
    }

    /// One that must only be lived through.
    void try_odd(const std::string& what, const Question& q) {
        Reply r;
        try {
            r = ask(q);
        } catch (const EnvironmentError& refused) {
            return told("odd numbers", what + ": refused: " + refused.what());
        }
        std::string says = r.hit == 1 ? "hit" : r.hit == 0 ? "miss" : "nothing";
        if (r.hit == 1 && tells_t_) says += " at t = " + text_of(r.near);
        if (r.hit > 1) broken("odd numbers", what + ": `hit` is not written");
        else told("odd numbers", what + ": " + says);
    }

    void try_extremes() {
        Question q = along(shape_, -5, 0);
        try_odd("a direction of length 0", q);
        q = along(shape_, -5, nan);
        try_odd("a direction of NaN", q);
        q = along(shape_, nan, 1);
        try_odd("an origin of NaN", q);
        q = along(shape_, -infinity, 1);
        try_odd("an origin at infinity", q);
        q = along(shape_, -5, 1, 0, 0);
        try_odd(shape_ == Shape::sphere ? "a radius of 0" : "a box that is a point", q);
        const int scale = contract_.bits == 32 ? 100 : 600;
        const std::string format = "binary" + std::to_string(contract_.bits), power = std::to_string(scale);
        q = along(shape_, -std::ldexp(1, scale), std::ldexp(1, scale), 0, std::ldexp(1, scale - 20));
        try_odd("numbers of 2^" + power + ", whose squares are no " + format + " numbers", q);
        q = along(shape_, -std::ldexp(1, -scale), std::ldexp(1, -scale), 0, std::ldexp(1, -scale - 1));
        try_odd("numbers of 2^-" + power + ", whose squares are 0 in " + format, q);
    }

    const ForeignForm& form_;
    const Contract& contract_;
    Shape shape_;
    bool tells_t_;
    std::vector<Observation> findings_;
};

}  // namespace

std::vector<Observation> try_contract(const ForeignForm& form) { return Trial(form).run(); }

}  // namespace lostbits::measure::contract
