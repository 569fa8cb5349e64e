// Explanation of one ray and one form.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "measure/answer/one_ray.hpp"
#include "measure/attribution/attribution.hpp"
#include "measure/attribution/rerun.hpp"
#include "measure/truth/missing.hpp"

namespace lostbits::measure::attribution {

/// Result of a form on the ray.
struct FormResult {
    const intersect::table::Intersector* form = nullptr;
    answer::Outcome outcome = answer::Outcome::agree_miss;
    double t = 0;                       ///< the form's answer
    double ulps = truth::missing;       ///< (t − t*)/ulp(t*); NaN unless both hit
    double lost_bits = truth::missing;  ///< bits; NaN unless both hit
    /// Mean lost bits over the ray's neighbours (`make_neighbours`), or over the pixels around it if a camera makes the
    /// ray. A wrong decision counts as all bits. NaN if not computed, or if no truth is proved.
    double mean_lost_nearby = truth::missing;
    bool has_other_truth = false;  ///< its contract gives the ray another truth than the contract of the explained form
    bool is_right() const { return outcome == answer::Outcome::agree_hit || outcome == answer::Outcome::agree_miss; }
};

/// Answer of a form on one primitive alone: the one that the ray truly meets first, if the form hits another one.
struct TruePrimitive {
    int index = 0;  ///< index of the primitive, from 0
    bool hit = false;
    double t = 0;                                  ///< the form's answer; meaningless for a miss
    bool is_exact_hit = false;                     ///< the form's decision without rounding
    double exact_t = 0;                            ///< the form's t without rounding
    scene::rays::RayGroup ray_and_primitive = {};  ///< the ray, as the format holds it, with that primitive
};

struct Explanation {
    const intersect::table::Intersector* form;
    Format format;
    std::vector<std::string> input_names = {};  ///< in the order of the tape
    std::vector<double> input_values = {};      ///< as the form received them
    Range<double> range = {};                   ///< range of the ray, in the format and in the unit of the form's t
    bool is_generated_ray = false;  ///< a camera makes the ray: the true ray is ideal, the form's is computed
    /// Direction of the ray, if the form received it normalised and rounded
    std::optional<Vec<double>> given_direction = {};
    bool has_rounded_inputs = false;                   ///< the format cannot represent the ray or a primitive as given
    std::optional<intersect::Touching> touching = {};  ///< touching convention of all forms; absent: each form's own
    int primitive_index = 0;  ///< index of the primitive that is explained, from 0; a march meets all of them
    int primitive_count = 1;
    Shape shape = {};  ///< shape of that primitive
    Tape tape = {};
    Attribution attribution = {};
    std::optional<Counterfactuals> culprit_alone = {};  ///< effects of the culprit alone, if there is one
    FormResult result = {};
    bool hit = false;  ///< the form's decision
    truth::Truth::Decision truth = truth::Truth::Decision::miss;
    std::optional<double> true_t = {};  ///< t*, correctly rounded to binary64
    /// For a ray that truly misses: the t of its hit if its range had no end (`t_beyond_tmax`), and if its range began
    /// at 0 (`t_before_tmin`), in the unit of the form's t.
    std::optional<double> t_beyond_tmax = {}, t_before_tmin = {};
    double condition = 0;      ///< κ; NaN for a miss
    double inherent_bits = 0;  ///< bits of the envelope; NaN for a miss
    double excess_bits = 0;    ///< lost bits beyond the envelope, see `truth::excess_bits`
    /// Set if the form hits another primitive than the ray truly meets; never for a march.
    std::optional<TruePrimitive> missed_primitive = {};
    /// Outcome at a mesh: a crack, a double hit, a wrong neighbour or out of order; absent for other rays.
    std::optional<answer::Outcome> mesh_outcome = {};
    /// Forms of the same shape in the same format that are right on the ray and lose fewer bits near it, best first.
    std::vector<FormResult> better_forms = {};
    std::vector<FormResult> compared_forms = {};  ///< results of the forms that were named for comparison
    /// Named forms of another shape, or not available in the format.
    std::vector<const intersect::table::Intersector*> incomparable_forms = {};
    int nearby_pixel_count = 0;  ///< number of rays in the means; 0: the ray's neighbours (`make_neighbours`) are used
    /// Errors of external intersectors that were tried in the comparison and did not answer.
    std::vector<std::string> failures = {};

    /// True if the form answers t, and not only hit or miss.
    [[nodiscard]] bool returns_t() const { return form->info->roots != intersect::Roots::none; }
    /// True if the operations are known; those of a compiled external function are not.
    [[nodiscard]] bool has_tape() const { return tape.size() > 0; }
    /// The ulp of the format at the subject's exact value (for a comparison, at the larger side).
    [[nodiscard]] double ulp_of_subject() const;
    /// The cancellation that loses the most bits among all live ones that the error of operation `from` goes through;
    /// `no_node` if none loses two bits.
    [[nodiscard]] NodeId find_amplifier(NodeId from) const;
    /// True if the form would hit `missed_primitive` first without rounding.
    [[nodiscard]] bool rounding_changed_order() const;
    /// Decisions that rounding changed on the path to the answer: choices that are live, and the form's own decision.
    [[nodiscard]] std::vector<NodeId> find_changed_decisions() const;
};

/// Explains the form on the ray without comparing it with others: `better_forms`, `compared_forms` and
/// `mean_lost_nearby` keep their defaults.
Explanation explain_alone(const intersect::table::Intersector& form, const Format& format, const answer::OneRay& ray);

/// The pixel of a ray, in a scene whose camera names a ray generator (`scene::file::with_ray_generator`).
struct ScenePixel {
    const scene::file::Scene* scene;
    int x, y;
    truth::ProofLimit limit = {};
};

/// Explains the form on the ray and finds forms that do better. Compares all forms that cannot end this process by a
/// crash or a hang (`external::is_safe_to_run`): the explanation would be lost too. Compares the forms in `named_forms`
/// in any case. If a camera makes the ray, compares the other ray generators too. Rays near a generated ray do not show
/// the error of generating it, so `mean_lost_nearby` is then the mean over the pixels around it.
Explanation explain(const intersect::table::Intersector& form, const Format& format, const answer::OneRay& ray,
                    std::span<const intersect::table::Intersector* const> named_forms = {},
                    const std::optional<ScenePixel>& pixel = {});

inline constexpr int neighbour_count = 64;

/// Makes `neighbour_count` rays near this one, with these primitives. Each number moves by one ulp of the format down,
/// up or not at all, in the same way in every run. 0 and values that are not finite stay: an ulp of 0 is not a small
/// change of a direction.
std::vector<answer::OneRay> make_neighbours(const answer::OneRay& ray, const answer::OneRay::Inputs& in,
                                            const FloatFormat& format,
                                            const std::vector<Primitive<double>>& primitives);

}  // namespace lostbits::measure::attribution
