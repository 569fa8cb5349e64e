// Table of checks. A check is a pair of questions that should have the same answer: one function of a row on a band,
// and one row of the table.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "intersect/process/stop_token.hpp"
#include "intersect/simd/packed.hpp"
#include "measure/answer/answers.hpp"
#include "measure/culling/culling.hpp"
#include "measure/evaluate/evaluate.hpp"
#include "measure/truth/missing.hpp"
#include "scene/rays/rays.hpp"

namespace lostbits::measure::consistency {

/// Result of a check at a pixel.
///
/// - `not_asked`: the pixel has no such pair of questions.
/// - `first_alone`, `second_alone`: one answer is yes (a hit) and the other no; at least one of them is wrong.
/// - `other_number`: the decisions are the same, but the numbers differ by more than they may.
/// - `by_inputs`: the answers differ as the exact answers do, because the stored numbers of the two questions are not
///   quite the same problem.
/// - `unresolved`: the exact answers are not proved.
enum class CheckResult : std::uint8_t {
    not_asked,
    agree,
    first_alone,
    second_alone,
    other_number,
    by_inputs,
    unresolved
};
inline constexpr std::array<std::string_view, 7> check_result_names{
    "not_asked", "agree", "first_alone", "second_alone", "other_number", "by_inputs", "unresolved"};

/// True if the form is to blame.
inline constexpr bool is_disagreement(CheckResult a) {
    return a == CheckResult::first_alone || a == CheckResult::second_alone || a == CheckResult::other_number;
}

/// Rays of both questions of a pixel, for `lostbits explain`. Directions are not yet normalised for a form that assumes
/// unit length.
struct TwoRays {
    std::size_t pixel = 0;  ///< index in the band
    scene::rays::RayGroup first, second;
};

/// Results of a check over a band, one for each pixel.
struct PixelCheckResults {
    explicit PixelCheckResults(std::size_t pixels) : results(pixels, CheckResult::not_asked) {}

    std::vector<CheckResult> results;
    /// For checks that compare numbers: the difference in ulps, and its excess over (or shortfall from) the difference
    /// of the exact numbers. NaN if nothing is compared; empty for other checks.
    std::vector<double> apart, excess;
    std::optional<TwoRays> shown;  ///< the first disagreement

    /// Sets the result of a pixel. `rays()` makes the two rays; called only for the first disagreement.
    template <class Rays>
    void set(std::size_t pixel, CheckResult how, const Rays& rays) {
        results[pixel] = how;
        if (is_disagreement(how) && !shown) {
            shown = rays();
            shown->pixel = pixel;
        }
    }
};

/// Result of comparing two decisions whose exact values are known.
inline constexpr CheckResult check_result_of(bool first, bool second, bool exact_first, bool exact_second) {
    if (first == second) return CheckResult::agree;
    if (first == exact_first && second == exact_second) return CheckResult::by_inputs;
    return first ? CheckResult::first_alone : CheckResult::second_alone;
}

/// Answers of a form to some rays, widened to double. The numbers are meaningless where `hit` is 0.
struct AllAnswers {
    std::vector<double> t, near, far;
    std::vector<std::uint8_t> hit;

    [[nodiscard]] std::size_t size() const { return hit.size(); }
};

/// Calls of a kernel: one with all rays, or one for each ray.
enum class Calls : std::uint8_t { together, one_by_one };

/// A form in a format, evaluated by the kernels in `native`.
struct FormKernels {
    const intersect::table::Intersector& form;
    Format format;
    intersect::process::StopToken stop;
    intersect::simd::PackedRow native;

    /// Uses the kernels of one ray, or those of a register width that this machine has.
    FormKernels(const intersect::table::Intersector& tested, const Format& tested_in,
                intersect::process::StopToken stop_token = {}, intersect::simd::Isa isa = intersect::simd::Isa::scalar)
        : form(tested), format(tested_in), stop(stop_token), native(intersect::simd::packed_kernels(tested, isa)) {}
};

/// Evaluates the form on rays whose numbers and ends are in the format. With one primitive, all rays are tested against
/// it. With as many primitives as rays, each ray is tested against its own, by the kernels of one ray.
AllAnswers answers_of(const FormKernels& kernels, const scene::rays::RayBlock& rays,
                      std::span<const Primitive<double>> primitives, Calls calls = Calls::together);

/// True if the form answers t, which an end can be compared with.
bool tells_t(const intersect::Info& info);

/// A form in a format over the pixels of a band: the input of every check.
struct FormOnBand {
    FormOnBand(const scene::file::Scene& tested_scene, const evaluate::TestedForm& tested,
               const truth::Band& tested_band);

    const scene::file::Scene& scene;
    const evaluate::TestedForm& row;
    const truth::Band& band;
    FormKernels form;
    truth::FormatInputs inputs;
    answer::Answers closest;  ///< answers as in a map

    /// Rays of the pixels, for the form's kind of direction.
    [[nodiscard]] const scene::rays::RayBlock& rays() const { return inputs.rays_for(*row.form->info); }
    [[nodiscard]] std::size_t pixels() const { return closest.hit.size(); }
    [[nodiscard]] const FloatFormat& format() const { return row.format.parameters; }
    [[nodiscard]] bool is_unit() const { return row.form->info->direction == intersect::Direction::unit; }
    /// The primitives that a ray may meet: all, or those of a large mesh that a tree finds. With the index of each.
    struct Candidates {
        std::vector<std::uint32_t> indices;
        std::vector<Primitive<double>> primitives;
    };
    [[nodiscard]] Candidates candidates(const Ray<double>& ray) const { return candidates(std::span(&ray, 1)); }
    /// The primitives that any of the rays may meet.
    [[nodiscard]] Candidates candidates(std::span<const Ray<double>> rays) const;
    /// Calls `act(primitive, rays, places)` for each primitive that any of the rays may meet, with those rays and their
    /// places among `all`.
    template <class Act>
    void by_primitive(const scene::rays::RayBlock& all, const Act& act) const {
        const RaysOfPrimitives pairs(*this, all);
        for (std::size_t k = 0; k < pairs.size(); ++k) pairs.call(k, act);
    }
    /// A ray, its end and all primitives; without primitives if there are too many.
    [[nodiscard]] scene::rays::RayGroup shown(const Ray<double>& ray, double tmax) const;

private:
    /// The rays that each primitive may be met by.
    class RaysOfPrimitives {
    public:
        RaysOfPrimitives(const FormOnBand& band_form, const scene::rays::RayBlock& all);
        [[nodiscard]] std::size_t size() const {
            return band_form_.tree_ ? runs_.size() : band_form_.inputs.primitives.size();
        }
        template <class Act>
        void call(std::size_t k, const Act& act) const {
            if (!band_form_.tree_) return act(band_form_.inputs.primitives[k], all_, places_);
            const auto [begin, end] = runs_[k];
            const std::span<const std::size_t> places = std::span(places_).subspan(begin, end - begin);
            act(band_form_.inputs.primitives[primitives_[begin]], rays_at(places), places);
        }

    private:
        [[nodiscard]] scene::rays::RayBlock rays_at(std::span<const std::size_t> places) const;

        const FormOnBand& band_form_;
        const scene::rays::RayBlock& all_;
        std::vector<std::size_t> places_;                        ///< of rays; without a tree those of all
        std::vector<std::uint32_t> primitives_;                  ///< for each of them
        std::vector<std::pair<std::size_t, std::size_t>> runs_;  ///< begin and end of each primitive's rays
    };

    std::shared_ptr<const culling::PrimitiveIndex> tree_;  ///< for large meshes; null: all primitives are tested
};

/// For each ray, 1 if the form meets the primitive, or any that the ray may meet, before the ray's `tmax`, as in a
/// shadow test. Forms that take the end of a ray (boxes) decide by themselves. For other forms a primitive counts if it
/// is hit and its t, or the far side if the form answers that, lies in 0 < t < tmax. A near side that differs from t
/// does not count: the form itself has rejected it.
std::vector<std::uint8_t> meets_before_end(const FormKernels& kernels, const scene::rays::RayBlock& rays,
                                           const Primitive<double>& primitive);
std::vector<std::uint8_t> meets_before_end(const FormOnBand& band_form, const scene::rays::RayBlock& rays);

struct Check {
    std::string_view name;    ///< `reverse`
    std::string_view title;   ///< line that says what must agree
    std::string_view first;   ///< the question whose yes is `first_alone`
    std::string_view second;  ///< the other question
    /// True if the check applies to a form on a scene.
    bool (*applies)(const scene::file::Scene&, const intersect::table::Intersector&);
    void (*measure)(const FormOnBand&, PixelCheckResults&);
    bool numbers = false;  ///< compares numbers, and fills `apart` and `excess`
};

/// Checks in the order of every table.
std::span<const Check> checks();
std::vector<const Check*> all_checks();

// Functions of the table.
void check_beyond(const FormOnBand& band_form, PixelCheckResults& out);
void check_end(const FormOnBand& band_form, PixelCheckResults& out);
void check_before(const FormOnBand& band_form, PixelCheckResults& out);
void check_segment(const FormOnBand& band_form, PixelCheckResults& out);
void check_short(const FormOnBand& band_form, PixelCheckResults& out);
void check_light(const FormOnBand& band_form, PixelCheckResults& out);
void check_packs(const FormOnBand& band_form, PixelCheckResults& out);
void check_reverse(const FormOnBand& band_form, PixelCheckResults& out);
void check_placed(const FormOnBand& band_form, PixelCheckResults& out);

}  // namespace lostbits::measure::consistency
