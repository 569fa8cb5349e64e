// Layers of an EXR file: each states its channels and how their samples are computed.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "output/image/exr_parts.hpp"
#include "output/image/image.hpp"

namespace lostbits::output::pixel {

/// Text for an attribute that gives each name its number: `0 agree_hit, 1 agree_miss`.
[[nodiscard]] std::string numbered(const auto& names, const char* between = ", ") {
    std::string text;
    for (std::size_t k = 0; k < names.size(); ++k)
        text += (k ? between : "") + std::to_string(k) + " " + std::string(names[k]);
    return text;
}

/// Layers that are computed from a Band: its pixels from left to right and from top to bottom.
template <class Band>
class ExrLayers {
public:
    /// Adds channels. `put(band, i, samples)` writes the samples of pixel i, one per channel, as 32-bit words.
    template <class Put>
    void add(std::vector<image::Channel> channels, Put put) {
        fills_.push_back(
            {channels_.size(), [put](const Band& band, std::uint32_t* at, std::size_t n, std::size_t stride) {
                 for (std::size_t i = 0; i < n; ++i) put(band, i, at + i * stride);
             }});
        channels_.insert(channels_.end(), channels.begin(), channels.end());
    }
    /// Adds a channel of type FLOAT: `of(band, i)`, rounded to binary32.
    template <class Of>
    void add_number(std::string name, Of of) {
        add({{std::move(name)}},
            [of](const Band& band, std::size_t i, std::uint32_t* at) { *at = image::float_word(of(band, i)); });
    }
    /// Adds a channel of type UINT: `of(band, i)`.
    template <class Of>
    void add_uint(std::string name, Of of) {
        add({{std::move(name), image::Channel::Type::u32}}, [of](const Band& band, std::size_t i, std::uint32_t* at) {
            *at = static_cast<std::uint32_t>(of(band, i));
        });
    }
    /// Adds the channels R, G and B in linear light.
    template <class Of>
    void add_preview(Of of) {
        add({{"R"}, {"G"}, {"B"}}, [of](const Band& band, std::size_t i, std::uint32_t* at) {
            for (const std::uint32_t word : image::preview_words(of(band, i))) *at++ = word;
        });
    }

    [[nodiscard]] const std::vector<image::Channel>& channels() const { return channels_; }
    /// Samples of this number of pixels, as `image::ExrBook::write_rows` takes them.
    [[nodiscard]] std::vector<std::uint32_t> samples(const Band& band, std::size_t pixels) const {
        std::vector<std::uint32_t> all(pixels * channels_.size());
        for (const auto& [place, fill] : fills_) fill(band, all.data() + place, pixels, channels_.size());
        return all;
    }

private:
    struct Fill {
        std::size_t place;  ///< index of its first channel
        std::function<void(const Band&, std::uint32_t* at, std::size_t pixels, std::size_t stride)> put;
    };
    std::vector<image::Channel> channels_;
    std::vector<Fill> fills_;
};

}  // namespace lostbits::output::pixel
