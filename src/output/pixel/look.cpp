#include "output/pixel/look.hpp"

#include <fmt/format.h>

#include "measure/truth/missing.hpp"

namespace lostbits::output::pixel {

using image::LegendEntry;

std::vector<LegendEntry> Look::legend(const CategoryCounts& counts, std::uint64_t pixels) const {
    if (make_legend) return make_legend(&counts, pixels);
    std::vector<LegendEntry> entries;
    for (std::size_t k = 0; k < categories.size(); ++k) {
        if (counts[k] > 0 && !categories[k].name.empty())
            entries.push_back({categories[k].name, categories[k].colour, count_text(counts[k], pixels)});
    }
    return entries;
}

std::vector<LegendEntry> Look::widest_legend(std::uint64_t pixels) const {
    if (make_legend) return make_legend(nullptr, pixels);
    std::vector<LegendEntry> entries;
    for (const Category& category : categories) {
        if (!category.name.empty()) entries.push_back({category.name, category.colour, widest_count(pixels)});
    }
    return entries;
}

image::ColourScale magnitude_scale(double low, double high) {
    return {"viridis", image::image_backend().ramp("viridis", 256), low, high, image::Spacing::log2};
}

namespace {

std::string percent_text(double percent) {
    return percent > 0 && percent < 0.1 ? "<0.1%" : fmt::format("{:.1f}%", percent);
}

}  // namespace

std::string count_text(std::uint64_t count, std::uint64_t total) {
    const double percentage = 100.0 * static_cast<double>(count) / static_cast<double>(total);
    return fmt::format("{} ({})", count, percentage > 99.9 && percentage < 100 ? ">99.9%" : percent_text(percentage));
}

std::string widest_count(std::uint64_t pixels) { return fmt::format("{} (>99.9%)", pixels); }

std::string fraction_text(std::uint64_t count, std::uint64_t total) {
    return total == 0 ? "-" : percent_text(100 * measure::truth::fraction(count, total));
}

}  // namespace lostbits::output::pixel
