// All checks of a scene on one page.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "output/consistency/accord_colour.hpp"
#include "output/image/contact_sheet.hpp"

namespace lostbits::output::consistency {

/// Checks across; forms and formats down.
class ConsistencySheet final : public measure::consistency::ConsistencySink {
public:
    /// Opens `path`. `request` must outlive it.
    ConsistencySheet(image::ImageBackend& backend, const std::filesystem::path& path,
                     const measure::consistency::ConsistencyRequest& request);

    void band(std::size_t row, const measure::consistency::ConsistencyBand& band) override;
    /// Draws the page and gives the file its final name.
    void finish(const std::vector<measure::consistency::RowChecks>& rows);

private:
    const measure::consistency::ConsistencyRequest& request_;
    image::ColourScale scale_;
    std::optional<image::ContactSheet> sheet_;
    std::vector<AccordCounts> shown_;  ///< one a row: rows come at the same time
};

}  // namespace lostbits::output::consistency
