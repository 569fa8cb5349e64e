// Everything that is to be said of one ray and one form.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "measure/answer/one_ray.hpp"
#include "measure/blame/attribution.hpp"
#include "measure/blame/rerun.hpp"
#include "measure/truth/missing.hpp"

namespace lostbits::measure::blame {

/// How a form fares on the ray.
struct Standing {
    const intersect::table::Intersector* form = nullptr;
    answer::Outcome outcome = answer::Outcome::agree_miss;
    double t = 0;                  ///< its answer
    double ulps = truth::missing;  ///< (t − t*)/ulp(t*); NaN unless both hit
    double lost = truth::missing;  ///< bits; NaN unless both hit
    /// The mean over the ray's `neighbours`, or over the pixels around it where a camera makes the ray, a wrong
    /// decision as all bits; NaN where nobody asked, or none is proved.
    double around = truth::missing;
    bool other_question = false;  ///< its contract has another truth on this ray than that of the form it is beside
    bool is_right() const { return outcome == answer::Outcome::agree_hit || outcome == answer::Outcome::agree_miss; }
    /// A right decision before a wrong one, then fewer lost bits: on this ray alone, which may be luck.
    bool beats(const Standing& other) const;
};

/// What a form says of the solid that a ray truly meets first, asked of it alone, where it hit another one instead.
struct TrueSolid {
    int solid = 0;  ///< from 0
    bool hit = false;
    double t = 0;                      ///< the form's answer; means nothing for a miss
    bool exact_hit = false;            ///< the form's decision without rounding
    double exact_t = 0;                ///< and its t
    scene::rays::RayGroup alone = {};  ///< the ray, as the format holds it, with that solid
};

struct Explanation {
    const intersect::table::Intersector* form;
    Format format;
    std::vector<std::string> names = {};  ///< of the inputs, in the tape's order
    std::vector<double> inputs = {};      ///< as the form received them
    Range<double> range = {};             ///< of the ray, in the format and in the unit of the form's t
    bool made_ray = false;                ///< a camera's: the true ray is the ideal one, and the form's is computed
    ///  the direction as the ray has it, where the form received it normalised and rounded
    std::optional<Vec<double>> given = {};
    bool rounded_inputs = false;                     ///< the format cannot hold the ray or a solid as they were given
    std::optional<intersect::Touching> judged = {};  ///< as closed or open solids; absent: by each form's own word
    int solid = 0, solids = 1;  ///< which of the scene's solids the form was asked of, from 0; of a march all together
    Shape shape = {};           ///< of that solid
    Tape tape = {};
    Attribution attribution = {};
    std::optional<Counterfactuals> culprit_alone = {};  ///< of the culprit, where there is one
    Standing standing = {};
    bool hit = false;  ///< the form's decision
    truth::Truth::Decision truth = truth::Truth::Decision::miss;
    std::optional<double> true_t = {};  ///< t*, correctly rounded to binary64
    /// Where a ray that truly misses would hit if its range had no end, and if it began at 0, as the form tells t.
    std::optional<double> beyond_end = {}, before_begin = {};
    double condition = 0;                  ///< κ; NaN for a miss
    double inherent = 0;                   ///< bits of the envelope; NaN for a miss
    double beyond = 0;                     ///< lost bits beyond the envelope, see `truth::excess_bits`
    std::optional<TrueSolid> missed = {};  ///< where the form hits another solid than the ray; of a march never
    /// What a map calls the ray, where it is of a mesh: a crack, a double hit, a wrong neighbour or out of order.
    std::optional<answer::Outcome> in_mesh = {};
    /// Forms of the same shape in the same format that are right on the ray and lose less around it, the least first.
    std::vector<Standing> better = {};
    std::vector<Standing> beside = {};  ///< of the forms that were named beside it: how they fare
    std::vector<const intersect::table::Intersector*> unasked =
        {};                 ///< and those of another shape, or not in the format
    int pixels_around = 0;  ///< over how many the means are; 0: over the ray's `neighbours`
    /// Of forms from outside that were asked whether they do better: why they did not answer.
    std::vector<std::string> silent = {};

    /// Lost bits beyond the envelope.
    [[nodiscard]] double excess() const { return beyond; }
    /// Whether the form says where it hits, and not only that it does.
    [[nodiscard]] bool tells_t() const { return form->info->roots != intersect::Roots::none; }
    /// Whether the operations are known: those of a form that is compiled elsewhere are not.
    [[nodiscard]] bool has_tape() const { return tape.size() > 0; }
    /// The ulp of the format at the subject's exact value (of the larger side of a comparison).
    [[nodiscard]] double ulp_of_subject() const;
    /// The live cancellation of most bits that the error of operation `from` goes through, none where there is none of
    /// two bits or more.
    [[nodiscard]] NodeId amplifier(NodeId from) const;
    /// Says if the form would hit `missed` first without rounding.
    [[nodiscard]] bool rounding_turned_order() const;
    /// Decisions on the way to the answer that rounding turned: live choices, and the form's own.
    [[nodiscard]] std::vector<NodeId> turned() const;
};

/// What a form does on the ray, and not what others do there: `better`, `beside` and `around` stay as they are.
Explanation explain_alone(const intersect::table::Intersector& form, const Format& format, const answer::OneRay& ray);

/// The pixel that a ray is from, of a scene whose camera says who makes its rays (`scene::file::with_rays`).
struct PixelOf {
    const scene::file::Scene* scene;
    int x, y;
    truth::TruthLimit limit = {};
};

/// The same, and which forms do better. That is asked of all whose faults cannot end this process
/// (`doors::is_harmless`), and of those `beside` the form whatever they are: one from outside may crash or hang, and
/// would take the answer with it. Where a camera makes the ray the other ways to make it are asked too. Rays near the
/// one that was made say nothing of what making it costs, so that `around` is then the mean over the pixels around it.
Explanation explain(const intersect::table::Intersector& form, const Format& format, const answer::OneRay& ray,
                    std::span<const intersect::table::Intersector* const> beside = {},
                    const std::optional<PixelOf>& pixel = {});

inline constexpr int neighbours = 64;

/// So many rays against these solids, each number moved by an ulp of the format down, up or not at all, by a rule that
/// draws nothing. A 0 stays one, and so does what is not finite: an ulp of 0 is no small change of a direction.
std::vector<answer::OneRay> neighbours_of(const answer::OneRay& ray, const answer::OneRay::Inputs& in,
                                          const FloatFormat& format, const std::vector<Solid<double>>& solids);

}  // namespace lostbits::measure::blame
