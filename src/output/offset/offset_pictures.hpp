// The offsets of a scene on one page, and a picture each: the smallest safe offset, and what becomes of every strategy.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "measure/offset/offsets.hpp"
#include "output/pixel/columns.hpp"

namespace lostbits::output::offset {

/// `integer` of `offset.integer`.
[[nodiscard]] std::string short_name(const measure::offset::Strategy& strategy);
/// `sphere.half_b.f32.computed`
[[nodiscard]] std::string row_name(const measure::offset::OffsetRow& row);
/// `away from the solid`, `into the solid`
[[nodiscard]] std::string in_words(measure::offset::Side side);

/// The smallest safe offset and the strategies across; forms, formats, kinds of points and sides down.
class OffsetPictures final : public measure::offset::OffsetSink {
public:
    /// Opens the sheet and, in the folder `singles`, a picture for each of its cells:
    /// `<form>.<format>.<point>.<side>.safe.png` and `….<strategy>.png`. `request` must outlive it.
    OffsetPictures(const measure::offset::OffsetRequest& request, const std::filesystem::path& sheet,
                   const std::filesystem::path& singles = {});

    void band(std::size_t row, const measure::offset::OffsetBand& band) override {
        files_.take(row, band, band.y0, band.is_point.size());
    }
    /// Draws the page and gives the files their final names.
    void finish(const std::vector<measure::offset::OffsetSummary>& summaries);

private:
    void add_notes(std::size_t line, const measure::offset::SideSummary& side);

    const measure::offset::OffsetRequest& request_;
    pixel::ColumnFiles<measure::offset::OffsetBand> files_;
};

}  // namespace lostbits::output::offset
