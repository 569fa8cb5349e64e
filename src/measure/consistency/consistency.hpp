// Compares the answers of a form to the same question asked in two ways, over the pixels of a scene.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "measure/consistency/check.hpp"
#include "measure/metric/measured_column.hpp"
#include "measure/metric/statistics.hpp"

namespace lostbits::measure::consistency {

/// First disagreement of a check: a pixel of the picture and both rays.
struct ShownDisagreement {
    int x = 0, y = 0;
    TwoRays rays;
};

/// Results of one check over all pixels of a row.
struct CheckSummary {
    std::array<std::uint64_t, accord_names.size()> count{};
    metric::Distribution apart, excess;  ///< for checks that compare numbers, in ulps
    std::optional<ShownDisagreement> shown;

    [[nodiscard]] std::uint64_t of(Accord a) const { return count[static_cast<std::size_t>(a)]; }
    /// Number of pixels that have both questions.
    [[nodiscard]] std::uint64_t asked() const;
    /// Number of differences that the form is to blame for; `decisions` counts those in the decision.
    [[nodiscard]] std::uint64_t disagreements() const { return decisions() + of(Accord::other_number); }
    [[nodiscard]] std::uint64_t decisions() const { return of(Accord::first_alone) + of(Accord::second_alone); }
};

/// One summary for each check of the request. A check that does not apply has only `not_asked`.
using RowChecks = std::vector<CheckSummary>;

/// Results of a row on some scanlines, for each check in the order of the request.
struct ConsistencyBand {
    int y0 = 0, rows = 0, width = 0;
    std::vector<AccordOfPixels> checks;
};

struct ConsistencyRequest {
    const scene::file::Scene& scene;
    std::vector<evaluate::TestedForm> rows;  ///< with forms of primitives
    std::vector<const Check*> checks;
    truth::TruthLimit limit{};
    std::function<void(std::uint64_t)> progress = [](std::uint64_t) {};  ///< receives the pixels of each band of a row
};

/// Checks that apply to at least one of the rows on a scene.
std::vector<const Check*> checks_for(const scene::file::Scene& scene, const std::vector<evaluate::TestedForm>& rows,
                                     std::vector<const Check*> among = all_checks());

/// True if the form is of a primitive; forms that march are not compared.
bool can_be_compared(const intersect::table::Intersector& form);

/// Runs the checks; one element for each row. `show` receives the bands of each row from top to bottom, different rows
/// at the same time. Results do not depend on the number of threads or the width of registers.
std::vector<RowChecks> run_consistency(
    const ConsistencyRequest& request,
    const std::function<void(std::size_t row, const ConsistencyBand& band)>& show = {});

/// A column of the summary, after check, form and format. The CSV and the claims use the same table.
using ConsistencyColumn = metric::MeasuredColumn<const CheckSummary&>;
std::span<const ConsistencyColumn> consistency_columns();

}  // namespace lostbits::measure::consistency
