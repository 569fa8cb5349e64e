// Whether a form answers a question alike however it is put: over the pixels of a scene.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "measure/consistency/check.hpp"
#include "measure/metric/measured_column.hpp"
#include "measure/metric/statistics.hpp"

namespace lostbits::measure::consistency {

/// Where a check first found a disagreement: a pixel of the picture and both rays.
struct ShownDisagreement {
    int x = 0, y = 0;
    TwoRays rays;
};

/// What came of one check over all pixels of a row.
struct CheckSummary {
    std::array<std::uint64_t, accord_names.size()> count{};
    metric::Distribution apart, excess;  ///< of checks that compare numbers, in ulps
    std::optional<ShownDisagreement> shown;

    [[nodiscard]] std::uint64_t of(Accord a) const { return count[static_cast<std::size_t>(a)]; }
    /// Pixels of which both questions were asked.
    [[nodiscard]] std::uint64_t asked() const;
    /// Those where the form is to blame for a difference; in the decision alone.
    [[nodiscard]] std::uint64_t disagreements() const { return decisions() + of(Accord::other_number); }
    [[nodiscard]] std::uint64_t decisions() const { return of(Accord::first_alone) + of(Accord::second_alone); }
};

/// One summary for each check of the request; none of its questions asked where it does not apply.
using RowChecks = std::vector<CheckSummary>;

/// A row on some scanlines; the pixels of each check, in the order of the request.
struct ConsistencyBand {
    int y0 = 0, rows = 0, width = 0;
    std::vector<AccordOfPixels> checks;
};

struct ConsistencyRequest {
    const scene::file::Scene& scene;
    std::vector<evaluate::TestedForm> rows;  ///< of forms of spheres or boxes
    std::vector<const Check*> checks;
    truth::TruthLimit limit{};
    std::function<void(std::uint64_t)> progress = [](std::uint64_t) {};  ///< after each band of a row: its pixels
};

/// Those checks that can be asked of at least one of the rows on a scene.
std::vector<const Check*> checks_for(const scene::file::Scene& scene, const std::vector<evaluate::TestedForm>& rows,
                                     std::vector<const Check*> among = all_checks());

/// Whether a form can be asked: of a sphere or a box.
bool can_be_compared(const intersect::table::Intersector& form);

/// One element a row. `show` gets the bands of each row from top to bottom; different rows at the same time. The
/// results do not depend on the number of threads or the width of registers.
std::vector<RowChecks> run_consistency(
    const ConsistencyRequest& request,
    const std::function<void(std::size_t row, const ConsistencyBand& band)>& show = {});

/// A column of the summary after check, form and format; the CSV and the claims read the same rows.
using ConsistencyColumn = metric::MeasuredColumn<const CheckSummary&>;
std::span<const ConsistencyColumn> consistency_columns();

}  // namespace lostbits::measure::consistency
