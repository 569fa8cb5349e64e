// The pictures of a rendered scene on one page, each beside the certified one.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "measure/picture/render.hpp"
#include "output/image/contact_sheet.hpp"

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
    [[nodiscard]] std::size_t line(std::size_t stage, std::size_t format) const {
        return stage * formats_.size() + format;
    }

    const measure::picture::RenderRequest& request_;
    std::vector<std::string> forms_{"certified"}, formats_;
    std::vector<std::size_t> column_, format_;  ///< of each row of the request
    std::optional<image::ContactSheet> sheet_;
};

}  // namespace lostbits::output::picture
