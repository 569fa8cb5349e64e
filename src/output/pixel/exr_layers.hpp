// Layers of an EXR file: each states its channels and how their samples are computed.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "output/image/exr_parts.hpp"
#include "output/image/image.hpp"

namespace lostbits::output::pixel {

/// Text for an attribute that gives each name its index: `0 agree_hit, 1 agree_miss`.
[[nodiscard]] std::string numbered_list(const auto& names, const char* separator = ", ") {
    std::string text;
    for (std::size_t k = 0; k < names.size(); ++k)
        text += (k ? separator : "") + std::to_string(k) + " " + std::string(names[k]);
    return text;
}

/// Layers that are computed from a Band: its pixels from left to right and from top to bottom.
template <class Band>
class ExrLayers {
public:
    /// Adds channels. `write(band, i, samples)` writes the samples of pixel i, one per channel, as 32-bit words.
    template <class Write>
    void add(std::vector<image::Channel> channels, Write write) {
        fills_.push_back({channels_.size(),
                          [write](const Band& band, std::uint32_t* samples, std::size_t pixels, std::size_t stride) {
                              for (std::size_t i = 0; i < pixels; ++i) write(band, i, samples + i * stride);
                          }});
        channels_.insert(channels_.end(), channels.begin(), channels.end());
    }
    /// Adds a channel of type FLOAT: `value_of(band, i)`, rounded to binary32.
    template <class ValueOf>
    void add_number(std::string name, ValueOf value_of) {
        add({{std::move(name)}}, [value_of](const Band& band, std::size_t i, std::uint32_t* sample) {
            *sample = image::float_word(value_of(band, i));
        });
    }
    /// Adds a channel of type UINT: `value_of(band, i)`.
    template <class ValueOf>
    void add_uint(std::string name, ValueOf value_of) {
        add({{std::move(name), image::Channel::Type::u32}},
            [value_of](const Band& band, std::size_t i, std::uint32_t* sample) {
                *sample = static_cast<std::uint32_t>(value_of(band, i));
            });
    }
    /// Adds the channels R, G and B: `colour_of(band, i)` in linear light.
    template <class ColourOf>
    void add_preview(ColourOf colour_of) {
        add({{"R"}, {"G"}, {"B"}}, [colour_of](const Band& band, std::size_t i, std::uint32_t* sample) {
            for (const std::uint32_t word : image::preview_words(colour_of(band, i))) *sample++ = word;
        });
    }

    [[nodiscard]] const std::vector<image::Channel>& channels() const { return channels_; }
    /// Samples of this number of pixels, as `image::ExrBook::write_rows` takes them.
    [[nodiscard]] std::vector<std::uint32_t> samples(const Band& band, std::size_t pixels) const {
        std::vector<std::uint32_t> result(pixels * channels_.size());
        for (const auto& [first_channel, fill] : fills_)
            fill(band, result.data() + first_channel, pixels, channels_.size());
        return result;
    }

private:
    struct Fill {
        std::size_t first_channel;  ///< index of the first channel that `write` fills
        std::function<void(const Band&, std::uint32_t* samples, std::size_t pixels, std::size_t stride)> write;
    };
    std::vector<image::Channel> channels_;
    std::vector<Fill> fills_;
};

}  // namespace lostbits::output::pixel
