// Table of checks. A check asks a form two questions that should have the same answer. Each check is one function and
// one row of the table.
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
/// - `not_asked`: the check has no questions at this pixel.
/// - `first_alone`, `second_alone`: only the first (second) answer is yes, a hit. At least one of the answers is wrong.
/// - `other_number`: the decisions are the same, but the numbers differ by more than they may.
/// - `by_inputs`: the answers differ as the exact answers do, because the stored numbers of the two questions differ
///   slightly.
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

/// True if the form causes the difference.
inline constexpr bool is_disagreement(CheckResult a) {
    return a == CheckResult::first_alone || a == CheckResult::second_alone || a == CheckResult::other_number;
}

/// Rays of both questions at a pixel, for `lostbits explain`. The directions are not yet normalised for a form that
/// assumes unit length.
struct RayPair {
    std::size_t pixel = 0;  ///< index in the band
    scene::rays::RayGroup first, second;
};

/// Results of a check over a band, one for each pixel.
struct PixelCheckResults {
    explicit PixelCheckResults(std::size_t pixels) : results(pixels, CheckResult::not_asked) {}

    std::vector<CheckResult> results;
    /// For checks that compare numbers: `apart` is the difference of the two answers in ulps, and `excess` is that
    /// difference minus the difference of the exact numbers. NaN if nothing is compared; empty for other checks.
    std::vector<double> apart, excess;
    std::optional<RayPair> first_disagreement;

    /// Sets the result of a pixel. `make_rays()` returns the rays of both questions; it is called only for the first
    /// disagreement.
    template <class Rays>
    void set(std::size_t pixel, CheckResult result, const Rays& make_rays) {
        results[pixel] = result;
        if (is_disagreement(result) && !first_disagreement) {
            first_disagreement = make_rays();
            first_disagreement->pixel = pixel;
        }
    }
};

/// Compares two decisions whose exact values are known.
inline constexpr CheckResult check_result_of(bool first, bool second, bool exact_first, bool exact_second) {
    if (first == second) return CheckResult::agree;
    if (first == exact_first && second == exact_second) return CheckResult::by_inputs;
    return first ? CheckResult::first_alone : CheckResult::second_alone;
}

/// Answers of a form for some rays, widened to double. The numbers of a ray are meaningless if its `hit` is 0.
struct AllAnswers {
    std::vector<double> t, near, far;
    std::vector<std::uint8_t> hit;

    [[nodiscard]] std::size_t size() const { return hit.size(); }
};

/// Grouping of rays into calls of a kernel: one call with all rays, or one for each ray.
enum class CallGrouping : std::uint8_t { together, one_by_one };

/// A form in a format, and the kernels in `native` that evaluate it.
struct FormKernels {
    const intersect::table::Intersector& form;
    Format format;
    intersect::process::StopToken stop;
    intersect::simd::PackedFormKernels native;

    /// Uses the kernels for single rays, or those of a register width that this machine has.
    FormKernels(const intersect::table::Intersector& evaluated_form, const Format& evaluated_format,
                intersect::process::StopToken stop_token = {}, intersect::simd::Isa isa = intersect::simd::Isa::scalar)
        : form(evaluated_form),
          format(evaluated_format),
          stop(stop_token),
          native(intersect::simd::packed_kernels(evaluated_form, isa)) {}
};

/// Evaluates the form on rays whose numbers and ends are in the format. A single primitive is tested with all rays.
/// With as many primitives as rays, ray i is tested against primitive i, by the kernels for single rays.
AllAnswers evaluate_all(const FormKernels& kernels, const scene::rays::RayBlock& rays,
                        std::span<const Primitive<double>> primitives, CallGrouping grouping = CallGrouping::together);

/// True if the form reports t, so that an end can be compared with it.
bool returns_t(const intersect::Info& info);

/// A form in a format on the pixels of a band: the input of every check.
struct FormOnBand {
    FormOnBand(const scene::file::Scene& tested_scene, const evaluate::TestedForm& tested_form,
               const truth::Band& tested_band);

    const scene::file::Scene& scene;
    const evaluate::TestedForm& tested_form;
    const truth::Band& band;
    FormKernels kernels;
    truth::FormatInputs inputs;
    answer::Answers closest_hits;  ///< as in a map

    /// Returns the rays of the pixels, with unit directions if the form assumes them.
    [[nodiscard]] const scene::rays::RayBlock& rays() const { return inputs.rays_for(*tested_form.form->info); }
    [[nodiscard]] std::size_t pixel_count() const { return closest_hits.hit.size(); }
    [[nodiscard]] const FloatFormat& format() const { return tested_form.format.parameters; }
    [[nodiscard]] bool takes_unit_directions() const {
        return tested_form.form->info->direction == intersect::Direction::unit;
    }
    /// The primitives that rays may meet, and their indices: all primitives, or the triangles of a large mesh that a
    /// tree finds.
    struct Candidates {
        std::vector<std::uint32_t> indices;
        std::vector<Primitive<double>> primitives;
    };
    [[nodiscard]] Candidates candidates(const Ray<double>& ray) const { return candidates(std::span(&ray, 1)); }
    /// Returns the primitives that any of the rays may meet.
    [[nodiscard]] Candidates candidates(std::span<const Ray<double>> rays) const;
    /// Calls `act(primitive, rays, ray_indices)` for each primitive that any of the rays may meet, with these rays and
    /// their indices in `all_rays`.
    template <class Act>
    void for_each_primitive(const scene::rays::RayBlock& all_rays, const Act& act) const {
        const RaysOfPrimitives rays_of_primitives(*this, all_rays);
        for (std::size_t k = 0; k < rays_of_primitives.size(); ++k) rays_of_primitives.call(k, act);
    }
    /// Returns a ray with its end and all primitives, or without primitives if there are too many, for `lostbits
    /// explain`.
    [[nodiscard]] scene::rays::RayGroup group_to_explain(const Ray<double>& ray, double tmax) const;

private:
    /// For each primitive, the rays that may meet it.
    class RaysOfPrimitives {
    public:
        RaysOfPrimitives(const FormOnBand& band_form, const scene::rays::RayBlock& all_rays);
        [[nodiscard]] std::size_t size() const {
            return band_form_.tree_ ? runs_.size() : band_form_.inputs.primitives.size();
        }
        template <class Act>
        void call(std::size_t k, const Act& act) const {
            if (!band_form_.tree_) return act(band_form_.inputs.primitives[k], all_rays_, ray_indices_);
            const auto [begin, end] = runs_[k];
            const std::span<const std::size_t> ray_indices = std::span(ray_indices_).subspan(begin, end - begin);
            act(band_form_.inputs.primitives[primitives_[begin]], rays_at(ray_indices), ray_indices);
        }

    private:
        [[nodiscard]] scene::rays::RayBlock rays_at(std::span<const std::size_t> ray_indices) const;

        const FormOnBand& band_form_;
        const scene::rays::RayBlock& all_rays_;
        std::vector<std::size_t> ray_indices_;   ///< grouped by primitive; without a tree, 0, 1, …
        std::vector<std::uint32_t> primitives_;  ///< index of the primitive for each element of `ray_indices_`
        std::vector<std::pair<std::size_t, std::size_t>> runs_;  ///< begin and end of each primitive's elements
    };

    std::shared_ptr<const culling::PrimitiveIndex> tree_;  ///< for large meshes; null if all primitives are tested
};

/// Returns 1 for each ray on which the form finds a hit before the ray's `tmax`, as in a shadow test. The first
/// overload tests one primitive, the second all primitives that the ray may meet. Forms that take the end of a ray
/// (boxes) decide by themselves. For other forms, a primitive counts if it is hit and its t, or its far side if the
/// form answers that, lies in 0 < t < tmax. A near side that differs from t does not count, because the form itself has
/// rejected it.
std::vector<std::uint8_t> find_hits_before_tmax(const FormKernels& kernels, const scene::rays::RayBlock& rays,
                                                const Primitive<double>& primitive);
std::vector<std::uint8_t> find_hits_before_tmax(const FormOnBand& band_form, const scene::rays::RayBlock& rays);

struct Check {
    std::string_view name;            ///< `reverse`
    std::string_view title;           ///< says in one line what must agree
    std::string_view first_question;  ///< the question whose yes is `first_alone`
    std::string_view second_question;
    /// True if the check applies to a form on a scene.
    bool (*applies)(const scene::file::Scene&, const intersect::table::Intersector&);
    void (*measure)(const FormOnBand&, PixelCheckResults&);
    bool compares_numbers = false;  ///< if true, `measure` fills `apart` and `excess`
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
