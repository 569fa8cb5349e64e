// The offsets of a scene on one page: the smallest safe offset, and what becomes of every strategy.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "measure/offset/offsets.hpp"
#include "output/image/contact_sheet.hpp"
#include "output/offset/offset_colour.hpp"

namespace lostbits::output::offset {

/// `integer` of `offset.integer`.
[[nodiscard]] std::string short_name(const measure::offset::Strategy& strategy);

/// The smallest safe offset and the strategies across; forms, formats, kinds of points and sides down.
class OffsetSheet final : public measure::offset::OffsetSink {
public:
    /// Opens `path`. `request` must outlive it.
    OffsetSheet(image::ImageBackend& backend, const std::filesystem::path& path,
                const measure::offset::OffsetRequest& request);

    void band(std::size_t row, const measure::offset::OffsetBand& band) override;
    /// Draws the page and gives the file its final name.
    void finish(const std::vector<measure::offset::OffsetSummary>& summaries);

private:
    void add_notes(std::size_t line, const measure::offset::SideSummary& side);

    const measure::offset::OffsetRequest& request_;
    image::ColourScale scale_;
    std::optional<image::ContactSheet> sheet_;
    std::array<bool, shown_labels.size()> shown_{};
    std::array<bool, 4> needed_{};
};

}  // namespace lostbits::output::offset
