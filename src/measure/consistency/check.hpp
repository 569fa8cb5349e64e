// The table of checks: a pair of questions that should have one answer is one function of a row on a band, and one row.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "intersect/process/stop_token.hpp"
#include "intersect/simd/packed.hpp"
#include "measure/answer/answers.hpp"
#include "measure/evaluate/evaluate.hpp"
#include "measure/truth/missing.hpp"
#include "scene/rays/rays.hpp"

namespace lostbits::measure::consistency {

/// `not_asked`: there is no such pair of questions at this pixel. `first_alone`, `second_alone`: one is answered with
/// yes (a hit) and the other with no, and at least one of the two answers is wrong. `other_number`: the decisions are
/// alike, the numbers are further apart than they may be. `by_inputs`: they differ as the exact answers do, because the
/// stored numbers of the two questions are not quite the same problem. `unresolved`: the exact answers are not proved.
enum class Accord : std::uint8_t { not_asked, agree, first_alone, second_alone, other_number, by_inputs, unresolved };
inline constexpr std::array<std::string_view, 7> accord_names{
    "not_asked", "agree", "first_alone", "second_alone", "other_number", "by_inputs", "unresolved"};

/// Whether the form is to blame.
inline constexpr bool is_disagreement(Accord a) {
    return a == Accord::first_alone || a == Accord::second_alone || a == Accord::other_number;
}

/// The rays of both questions of a pixel, which `lostbits explain` takes; directions as they are before a form that
/// assumes unit length gets them.
struct TwoRays {
    std::size_t pixel = 0;  ///< of the band
    scene::rays::RayGroup first, second;
};

/// What came of a check over a band: a value a pixel.
struct AccordOfPixels {
    explicit AccordOfPixels(std::size_t pixels) : accord(pixels, Accord::not_asked) {}

    std::vector<Accord> accord;
    /// Of checks that compare numbers: by how many ulps they are apart, and by how many more (or fewer) than the exact
    /// ones; NaN where nothing is compared. Empty for the others.
    std::vector<double> apart, excess;
    std::optional<TwoRays> shown;  ///< the first disagreement

    /// `rays()` makes the two rays; asked of the first disagreement alone.
    template <class Rays>
    void set(std::size_t pixel, Accord how, const Rays& rays) {
        accord[pixel] = how;
        if (is_disagreement(how) && !shown) {
            shown = rays();
            shown->pixel = pixel;
        }
    }
};

/// How two decisions stand to each other, where the exact ones are known.
inline constexpr Accord accord_of(bool first, bool second, bool exact_first, bool exact_second) {
    if (first == second) return Accord::agree;
    if (first == exact_first && second == exact_second) return Accord::by_inputs;
    return first ? Accord::first_alone : Accord::second_alone;
}

/// The answers of a form to some rays, widened to double. Where `hit` is 0 the numbers mean nothing.
struct AllAnswers {
    std::vector<double> t, near, far;
    std::vector<std::uint8_t> hit;

    [[nodiscard]] std::size_t size() const { return hit.size(); }
};

/// How a kernel is called: once with all rays, or once for each.
enum class Calls : std::uint8_t { together, one_by_one };

/// A form in a format, by the kernels that `native` has of it.
struct AskedForm {
    const intersect::table::Intersector& form;
    Format format;
    intersect::process::StopToken stop;
    intersect::simd::PackedRow native;

    /// By the kernels of one ray, or at a register width that this machine has.
    AskedForm(const intersect::table::Intersector& asked, const Format& in, intersect::process::StopToken until = {},
              intersect::simd::Isa isa = intersect::simd::Isa::scalar)
        : form(asked), format(in), stop(until), native(intersect::simd::packed_kernels(asked, isa)) {}
};

/// Rays, whose numbers and ends are of the format, with one solid; or with as many as rays, to each its own, by the
/// kernels of one ray.
AllAnswers ask(const AskedForm& asked, const scene::rays::RayBlock& rays, std::span<const Solid<double>> solids,
               Calls calls = Calls::together);

/// Whether a form can say where a ray is met: an end is compared with that.
bool tells_t(const intersect::Info& info);

/// Of each ray, whether the form meets any of the solids before the ray's `tmax`, as a shadow test asks. The forms that
/// are told the end (boxes) decide by themselves. Of the others a solid counts where the form says that it is hit and
/// its t, or the far side where it tells that, lies in 0 < t < tmax. A near side that is not t is one that the form
/// itself has turned down.
std::vector<std::uint8_t> meets_before_end(const AskedForm& asked, const scene::rays::RayBlock& rays,
                                           std::span<const Solid<double>> solids);

/// A form in a format over the pixels of a band: what every check starts from.
struct RowOnBand {
    RowOnBand(const scene::file::Scene& of, const evaluate::TestedForm& asked, const truth::Band& on);

    const scene::file::Scene& scene;
    const evaluate::TestedForm& row;
    const truth::Band& band;
    AskedForm form;
    truth::FormatInputs inputs;
    std::vector<Solid<double>> solids;
    answer::Answers closest;  ///< what a map shows

    /// The rays of the pixels, as the form takes directions.
    [[nodiscard]] const scene::rays::RayBlock& rays() const { return inputs.rays_for(*row.form->info); }
    [[nodiscard]] std::size_t pixels() const { return closest.hit.size(); }
    [[nodiscard]] const FloatFormat& format() const { return row.format.parameters; }
    [[nodiscard]] bool is_unit() const { return row.form->info->direction == intersect::Direction::unit; }
    /// A ray, its end and all solids, of which there may be too many: then none.
    [[nodiscard]] scene::rays::RayGroup shown(const Ray<double>& ray, double tmax) const;
};

struct Check {
    std::string_view name;    ///< `reverse`
    std::string_view title;   ///< what must agree, in a line
    std::string_view first;   ///< the question that `first_alone` answers with yes
    std::string_view second;  ///< the other
    /// Whether it can be asked of a form on a scene.
    bool (*applies)(const scene::file::Scene&, const intersect::table::Intersector&);
    void (*measure)(const RowOnBand&, AccordOfPixels&);
    bool numbers = false;  ///< it compares numbers, and fills `apart` and `excess`
};

/// In the order of every table.
std::span<const Check> checks();
std::vector<const Check*> all_checks();

// The functions of the table.
void check_beyond(const RowOnBand& on, AccordOfPixels& out);
void check_end(const RowOnBand& on, AccordOfPixels& out);
void check_before(const RowOnBand& on, AccordOfPixels& out);
void check_segment(const RowOnBand& on, AccordOfPixels& out);
void check_short(const RowOnBand& on, AccordOfPixels& out);
void check_light(const RowOnBand& on, AccordOfPixels& out);
void check_packs(const RowOnBand& on, AccordOfPixels& out);
void check_reverse(const RowOnBand& on, AccordOfPixels& out);
void check_placed(const RowOnBand& on, AccordOfPixels& out);

}  // namespace lostbits::measure::consistency
