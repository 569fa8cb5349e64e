// The table of checks: a pair of questions is one function of a row on a band, and one row.
#pragma once

#include <span>
#include <string_view>

#include "measure/answer/answers.hpp"
#include "measure/consistency/accord.hpp"
#include "measure/consistency/all_answers.hpp"
#include "measure/evaluate/evaluate.hpp"

namespace lostbits::measure::consistency {

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
    [[nodiscard]] const FloatFormat& format() const { return row.format.shape; }
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

/// The closest hit, and a shadow test that ends one number of the format after it.
void check_beyond(const RowOnBand& on, AccordOfPixels& out);
/// The same with an end exactly at it: by convention, yes or no, but always the same.
void check_end(const RowOnBand& on, AccordOfPixels& out);
/// The same with an end one number before it.
void check_before(const RowOnBand& on, AccordOfPixels& out);
/// From the origin to the point that the pixel shows: direction q − p up to t = 1, and (q − p)/|q − p| up to |q − p|.
void check_segment(const RowOnBand& on, AccordOfPixels& out);
/// The same where both end at 1 − 1e-4 of the way.
void check_short(const RowOnBand& on, AccordOfPixels& out);
/// The same from the light to the point that the pixel shows, where the scene has a light.
void check_light(const RowOnBand& on, AccordOfPixels& out);
/// Rays one by one, and together at every register width of this machine: bit by bit.
void check_packs(const RowOnBand& on, AccordOfPixels& out);
/// The segment from p to q and the same from q to p: one chord.
void check_reverse(const RowOnBand& on, AccordOfPixels& out);
/// Solids under matrices against those whose numbers say where they stand; and the other way round.
void check_placed(const RowOnBand& on, AccordOfPixels& out);

}  // namespace lostbits::measure::consistency
