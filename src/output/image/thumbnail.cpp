#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "output/image/contact_sheet.hpp"

namespace lostbits::output::image {
namespace {

constexpr int longest = 160;

int shrunk(int side, int longer) {
    return std::max(1, static_cast<int>((static_cast<std::int64_t>(side) * longest + longer / 2) / longer));
}

}  // namespace

Thumbnail::Thumbnail(int field_width, int field_height) : field_width_(field_width), field_height_(field_height) {
    if (field_width <= 0 || field_height <= 0) throw std::logic_error("thumbnail: a field without samples");
    const int longer = std::max(field_width, field_height);
    if (longer <= longest) {
        factor_ = longest / longer;
        width_ = field_width * factor_;
        height_ = field_height * factor_;
    } else {
        width_ = shrunk(field_width, longer);
        height_ = shrunk(field_height, longer);
    }
}

void Thumbnail::add_rows(int y_begin, std::span<const Rgb8> samples) {
    const auto width = static_cast<std::size_t>(field_width_);
    const auto rows = samples.size() / width;
    if (samples.size() % width != 0) throw std::logic_error("thumbnail: a part of a row");
    if (y_begin < 0 || y_begin > field_height_ || rows > static_cast<std::size_t>(field_height_ - rows_) ||
        rows > static_cast<std::size_t>(field_height_ - y_begin)) {
        throw std::logic_error("thumbnail: rows outside the field");
    }
    if (pixels_.empty()) {
        const auto count = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
        pixels_.resize(count);
        if (factor_ == 0) sums_.assign(3 * count, 0);
    }
    for (std::size_t i = 0; i < rows; ++i) {
        add_row(y_begin + static_cast<int>(i), samples.subspan(i * width, width));
    }
    rows_ += static_cast<int>(rows);
    if (complete() && factor_ == 0) resolve();
}

void Thumbnail::add_row(int y, std::span<const Rgb8> samples) {
    const auto out_width = static_cast<std::size_t>(width_);
    if (factor_ > 0) {
        for (int j = y * factor_; j < (y + 1) * factor_; ++j) {
            auto out = pixels_.begin() + j * width_;
            for (const Rgb8 sample : samples) out = std::fill_n(out, factor_, sample);
        }
        return;
    }
    // On an axis cut into field · thumbnail parts, sample y covers [y·t, (y+1)·t) and pixel j covers [j·f, (j+1)·f):
    // all overlaps are whole numbers, and those of one pixel sum to f.
    const auto overlap = [](std::int64_t sample, std::int64_t pixel, std::int64_t f, std::int64_t t) {
        return static_cast<std::uint64_t>(std::min((sample + 1) * t, (pixel + 1) * f) -
                                          std::max(sample * t, pixel * f));
    };
    const auto first_pixel = [](std::int64_t sample, std::int64_t f, std::int64_t t) { return sample * t / f; };
    const auto last_pixel = [](std::int64_t sample, std::int64_t f, std::int64_t t) {
        return ((sample + 1) * t - 1) / f;
    };
    for (auto j = first_pixel(y, field_height_, height_); j <= last_pixel(y, field_height_, height_); ++j) {
        const std::uint64_t wy = overlap(y, j, field_height_, height_);
        std::uint64_t* out = sums_.data() + 3 * out_width * static_cast<std::size_t>(j);
        for (std::int64_t x = 0; x < field_width_; ++x) {
            const Rgb8 s = samples[static_cast<std::size_t>(x)];
            for (auto i = first_pixel(x, field_width_, width_); i <= last_pixel(x, field_width_, width_); ++i) {
                const std::uint64_t w = wy * overlap(x, i, field_width_, width_);
                out[3 * i] += w * linear_light(s.r);
                out[3 * i + 1] += w * linear_light(s.g);
                out[3 * i + 2] += w * linear_light(s.b);
            }
        }
    }
}

void Thumbnail::resolve() {
    const std::uint64_t weight = static_cast<std::uint64_t>(field_width_) * static_cast<std::uint64_t>(field_height_);
    const auto average = [&](std::uint64_t sum) {
        return srgb_byte(static_cast<std::uint16_t>((sum + weight / 2) / weight));
    };
    for (std::size_t p = 0; p < pixels_.size(); ++p) {
        pixels_[p] = {average(sums_[3 * p]), average(sums_[3 * p + 1]), average(sums_[3 * p + 2])};
    }
    sums_ = {};
}

const std::vector<Rgb8>& Thumbnail::pixels() const {
    if (!complete()) throw std::logic_error("thumbnail: rows are lacking");
    return pixels_;
}

}  // namespace lostbits::output::image
