// The pictures of a rendered scene on one page, each beside the certified one.
#pragma once

#include <filesystem>
#include <vector>

#include "measure/picture/render.hpp"
#include "output/image/contact_sheet.hpp"
#include "output/map/row_names.hpp"

namespace lostbits::output::picture {

/// Forms across, the certified picture first; stages and formats down.
class RenderSheet final : public measure::picture::RenderSink {
public:
    /// Opens `path`. `request` must outlive it.
    RenderSheet(image::ImageBackend& backend, const std::filesystem::path& path,
                const measure::picture::RenderRequest& request);

    void reference(int y0, int rows, std::span<const measure::picture::TruePixel> truth) override;
    void row(std::size_t row, const measure::picture::RenderBand& band) override;
    /// Draws the page and gives the file its final name.
    void finish(const std::vector<measure::picture::RenderSummary>& summaries);

private:
    /// The certified picture stands in the first.
    [[nodiscard]] std::size_t column(std::size_t row) const { return 1 + grid_.places[row].form; }
    [[nodiscard]] std::size_t line(std::size_t stage, std::size_t format) const {
        return stage * grid_.formats.size() + format;
    }

    const measure::picture::RenderRequest& request_;
    map::RowGrid grid_;
    std::optional<image::ContactSheet> sheet_;
};

}  // namespace lostbits::output::picture
