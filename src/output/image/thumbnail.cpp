// Shrinks or enlarges a field to a thumbnail.
#include <algorithm>
#include <array>
#include <stdexcept>

#include "output/image/contact_sheet.hpp"

namespace lostbits::output::image {
namespace {

constexpr int max_side = 160;

int shrunk_side(int side, int longer) {
    return std::max(1, static_cast<int>((static_cast<std::int64_t>(side) * max_side + longer / 2) / longer));
}

}  // namespace

Thumbnail::Thumbnail(int field_width, int field_height, Shrink shrink)
    : field_width_(field_width), field_height_(field_height), shrink_(shrink) {
    if (field_width <= 0 || field_height <= 0) throw std::logic_error("thumbnail: a field without samples");
    const int longer = std::max(field_width, field_height);
    if (longer <= max_side) {
        factor_ = max_side / longer;
        width_ = field_width * factor_;
        height_ = field_height * factor_;
    } else {
        width_ = shrunk_side(field_width, longer);
        height_ = shrunk_side(field_height, longer);
    }
}

void Thumbnail::add_rows(int y_begin, std::span<const Rgb8> samples) {
    const auto width = static_cast<std::size_t>(field_width_);
    const auto rows = samples.size() / width;
    if (samples.size() % width != 0) throw std::logic_error("thumbnail: an incomplete row");
    if (y_begin < 0 || y_begin > field_height_ || rows > static_cast<std::size_t>(field_height_ - added_rows_) ||
        rows > static_cast<std::size_t>(field_height_ - y_begin)) {
        throw std::logic_error("thumbnail: rows outside the field");
    }

    if (pixels_.empty()) {
        const auto count = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
        pixels_.resize(count);
        if (factor_ == 0 && shrink_ == Shrink::average) {
            pixel_sums_.assign(3 * count, 0);
            column_overlaps_ = overlaps(field_width_, width_);
            row_overlaps_ = overlaps(field_height_, height_);
        }
    }

    for (std::size_t i = 0; i < rows; ++i) {
        add_row(y_begin + static_cast<int>(i), samples.subspan(i * width, width));
    }
    added_rows_ += static_cast<int>(rows);
    if (is_complete() && factor_ == 0 && shrink_ == Shrink::average) average_sums();
}

/// Along each axis, pixel i of `thumbnail` pixels takes sample ⌊(2i + 1)·field/(2·thumbnail)⌋ of `field` samples. If
/// thumbnail ≤ field, no two pixels take the same sample.
void Thumbnail::pick_row(int y, std::span<const Rgb8> samples) {
    const auto middle = [](std::int64_t i, std::int64_t field, std::int64_t thumbnail) {
        return (2 * i + 1) * field / (2 * thumbnail);
    };
    // The pixel whose middle lies in this row, if any, is the pixel in which the row begins, or the next one.
    std::int64_t j = static_cast<std::int64_t>(y) * height_ / field_height_;
    if (middle(j, field_height_, height_) != y) ++j;
    if (j >= height_ || middle(j, field_height_, height_) != y) return;
    for (int i = 0; i < width_; ++i) {
        pixels_[j * width_ + i] = samples[middle(i, field_width_, width_)];
    }
}

void Thumbnail::add_row(int y, std::span<const Rgb8> samples) {
    if (factor_ > 0) {
        for (int j = y * factor_; j < (y + 1) * factor_; ++j) {
            auto out = pixels_.begin() + j * width_;
            for (const Rgb8 sample : samples) out = std::fill_n(out, factor_, sample);
        }
        return;
    }
    if (shrink_ == Shrink::pick) return pick_row(y, samples);
    average_row(y, samples);
}

void Thumbnail::average_row(int y, std::span<const Rgb8> samples) {
    const auto out_width = static_cast<std::size_t>(width_);
    // A row of samples is summed once; its sums are then added to one or two rows of pixels, because the weights are
    // products.
    static const auto light_of_byte = [] {
        std::array<std::uint64_t, 256> values{};
        for (std::size_t i = 0; i < values.size(); ++i) values[i] = linear_light(static_cast<std::uint8_t>(i));
        return values;
    }();
    row_sums_.assign(3 * (out_width + 1), 0);
    for (std::size_t x = 0; x < samples.size(); ++x) {
        const Overlap& overlap = column_overlaps_[x];
        const Rgb8 sample = samples[x];
        std::uint64_t* const out = row_sums_.data() + 3 * overlap.pixel;
        const std::array<std::uint64_t, 3> light{light_of_byte[sample.r], light_of_byte[sample.g],
                                                 light_of_byte[sample.b]};
        for (std::size_t c = 0; c < 3; ++c) out[c] += overlap.weight * light[c];
        if (overlap.next_weight == 0) continue;
        for (std::size_t c = 0; c < 3; ++c) out[c + 3] += overlap.next_weight * light[c];
    }

    const Overlap& overlap = row_overlaps_[y];
    for (const auto& [pixel, weight] :
         {std::pair(overlap.pixel, overlap.weight), std::pair(overlap.pixel + 1, overlap.next_weight)}) {
        if (weight == 0) continue;
        std::uint64_t* const out = pixel_sums_.data() + 3 * out_width * pixel;
        for (std::size_t i = 0; i < 3 * out_width; ++i) out[i] += weight * row_sums_[i];
    }
}

/// On an axis cut into field · thumbnail parts, sample x covers [x·thumbnail, (x+1)·thumbnail) and pixel i covers
/// [i·field, (i+1)·field). All overlaps are whole numbers, and the overlaps of one pixel sum to `field`. If thumbnail
/// ≤ field, a sample meets at most two pixels.
std::vector<Thumbnail::Overlap> Thumbnail::overlaps(std::int64_t field, std::int64_t thumbnail) {
    std::vector<Overlap> list;
    for (std::int64_t x = 0; x < field; ++x) {
        const std::int64_t pixel = x * thumbnail / field, end = (pixel + 1) * field;
        const std::int64_t weight = std::min((x + 1) * thumbnail, end) - x * thumbnail;
        list.push_back({static_cast<std::size_t>(pixel), static_cast<std::uint64_t>(weight),
                        static_cast<std::uint64_t>(thumbnail - weight)});
    }
    return list;
}

void Thumbnail::average_sums() {
    const std::uint64_t weight = static_cast<std::uint64_t>(field_width_) * static_cast<std::uint64_t>(field_height_);
    const auto average = [&](std::uint64_t sum) {
        return srgb_byte(static_cast<std::uint16_t>((sum + weight / 2) / weight));
    };
    for (std::size_t p = 0; p < pixels_.size(); ++p) {
        pixels_[p] = {average(pixel_sums_[3 * p]), average(pixel_sums_[3 * p + 1]), average(pixel_sums_[3 * p + 2])};
    }
    pixel_sums_ = {};
}

const std::vector<Rgb8>& Thumbnail::pixels() const {
    if (!is_complete()) throw std::logic_error("thumbnail: rows are missing");
    return pixels_;
}

}  // namespace lostbits::output::image
