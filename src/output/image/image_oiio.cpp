// The image module: everything that the program uses of OpenImageIO. Built as `lostbits_image` and loaded at run time.
// This file reads and writes; image_cairo.cpp draws.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>
#include <filesystem>
#include <stdexcept>

#include "number/error.hpp"
#include "output/image/image_oiio.hpp"

namespace lostbits::output::image {
namespace {

std::uint8_t to_srgb8(float linear) {
    const float l = std::clamp(linear, 0.0f, 1.0f);
    const float s = l <= 0.0031308f ? 12.92f * l : 1.055f * std::pow(l, 1 / 2.4f) - 0.055f;
    return static_cast<std::uint8_t>(std::lround(s * 255.0f));
}

std::unique_ptr<OIIO::ImageInput> open_input(const std::filesystem::path& path, std::string_view format) {
    // Name the format, because otherwise the library tries the readers of all formats that it knows.
    auto input = OIIO::ImageInput::create(std::string(format));
    OIIO::ImageSpec spec;
    if (!input || !input->open(path.string(), spec)) {
        throw InputError(path.string() + ": cannot read: " + (input ? input->geterror() : OIIO::geterror()) +
                         "; give an existing " + std::string(format) + " file");
    }
    return input;
}

ClaimedPixels claimed_pixels_of(const OIIO::ImageSpec& spec, std::uint64_t max_growth) {
    return {static_cast<std::uint64_t>(spec.width), static_cast<std::uint64_t>(spec.height), spec.pixel_bytes(true),
            max_growth};
}

/// Passes the library's bytes to a file::ByteSink and keeps the first error. The library would turn the error into a
/// flag, or lose it in a destructor.
class SinkProxy final : public OIIO::Filesystem::IOProxy {
public:
    SinkProxy(std::unique_ptr<file::ByteSink> sink, const std::string& path)
        : IOProxy(path, Write), sink_(std::move(sink)) {}

    const char* proxytype() const override { return "lostbits"; }
    bool opened() const override { return true; }
    std::int64_t tell() override { return sink_->tell(); }

    bool seek(std::int64_t offset) override {
        return run_guarded([&] { sink_->seek(offset); });
    }

    std::size_t write(const void* data, std::size_t size) override {
        const auto* bytes = static_cast<const std::byte*>(data);
        return run_guarded([&] { sink_->write({bytes, size}); }) ? size : 0;
    }

    /// Drops all later bytes, because the library writes the end of a picture even when it is told to stop.
    void discard() noexcept { is_discarding_ = true; }

    void rethrow() const {
        if (failure_) std::rethrow_exception(failure_);
    }

    void commit() { sink_->commit(); }

private:
    template <class Action>
    bool run_guarded(Action action) noexcept {
        if (is_discarding_) return true;
        if (failure_) return false;
        try {
            action();
            return true;
        } catch (...) {
            failure_ = std::current_exception();
            return false;
        }
    }

    std::unique_ptr<file::ByteSink> sink_;
    std::exception_ptr failure_;
    bool is_discarding_ = false;
};

OIIO::ImageSpec image_spec(const PngSpec& png) {
    OIIO::ImageSpec spec(png.width, png.height, 3, OIIO::TypeDesc::UINT8);
    for (const auto& [keyword, text] : png.metadata) spec.attribute(keyword, text);
    spec.attribute("oiio:ColorSpace", "sRGB");
    // Heatmaps have few colours and much noise. For 1024 x 1024 pixels, level 2 without filters makes files a third
    // smaller than the default (level 6, every filter tried) in a quarter of its time.
    spec.attribute("png:filter", 8);  // PNG_FILTER_NONE
    spec.attribute("png:compressionLevel", 2);
    return spec;
}

/// A PNG that the library writes through a SinkProxy. Rows come in order, and errors are rethrown.
class OiioPng final : public PngWriter {
public:
    OiioPng(std::unique_ptr<file::ByteSink> sink, const std::string& path, const PngSpec& spec)
        : path_(path),
          width_(spec.width),
          height_(spec.height),
          proxy_(std::move(sink), path),
          out_(OIIO::ImageOutput::create("png")) {
        if (!out_ || !out_->supports("ioproxy"))
            throw EnvironmentError(path + ": OpenImageIO was built without a usable png writer");
        out_->set_ioproxy(&proxy_);
        check(out_->open(path, image_spec(spec)));
    }

    /// A file that was not closed is abandoned, and its bytes are dropped. libpng insists on finishing a picture: if
    /// rows are missing it complains on stderr or, after a failed write, compresses forever. So its writer is leaked:
    /// the buffers of one row, in a run that is ending anyway.
    ~OiioPng() override {
        if (!out_) return;
        proxy_.discard();
        static_cast<void>(out_.release());
    }
    OiioPng(const OiioPng&) = delete;
    OiioPng& operator=(const OiioPng&) = delete;

    void write_rows(int row_count, std::span<const Rgb8> pixels) override {
        const FloatingPointGuard guard;
        if (!out_) throw std::logic_error(path_ + ": rows after close");
        if (row_count < 0 || row_count > height_ - next_row_ ||
            pixels.size() != static_cast<std::size_t>(width_) * static_cast<std::size_t>(row_count))
            throw std::logic_error(path_ + ": " + std::to_string(pixels.size()) + " pixels for " +
                                   std::to_string(row_count) + " rows of " + std::to_string(width_) + ", and " +
                                   std::to_string(height_ - next_row_) + " rows are missing");
        if (row_count == 0) return;
        check(out_->write_scanlines(next_row_, next_row_ + row_count, 0, OIIO::TypeDesc::UNKNOWN, pixels.data()));
        next_row_ += row_count;
    }

    void close() override {
        const FloatingPointGuard guard;
        if (!out_) throw std::logic_error(path_ + ": closed twice");
        if (next_row_ != height_) {
            throw std::logic_error(path_ + ": closed after " + std::to_string(next_row_) + " of " +
                                   std::to_string(height_) + " rows");
        }
        check(out_->close());
        out_.reset();  // the tail may be written only here
        proxy_.rethrow();
        proxy_.commit();
    }

private:
    void check(bool is_written) {
        proxy_.rethrow();
        if (!is_written) throw EnvironmentError(path_ + ": cannot write: " + out_->geterror());
    }

    std::string path_;
    int width_, height_, next_row_ = 0;
    SinkProxy proxy_;  // outlives out_, whose destructor still writes to it
    std::unique_ptr<OIIO::ImageOutput> out_;
};

class OiioBackend final : public ImageBackend {
public:
    OiioBackend() {
        const FloatingPointGuard guard;
        // The caller spreads files over its own threads, and the library's pools would compete with them.
        OIIO::attribute("threads", 1);
        OIIO::attribute("exr_threads", -1);
    }

    std::vector<Rgb8> ramp(std::string_view name, int steps) override {
        static constexpr std::string_view ramp_names[] = {"viridis", "inferno", "magma", "plasma", "turbo"};
        if (std::find(std::begin(ramp_names), std::end(ramp_names), name) == std::end(ramp_names)) {
            throw InputError("unknown colour ramp \"" + std::string(name) +
                             "\"; try viridis, inferno, magma, plasma or turbo");
        }
        if (steps < 2) throw std::logic_error("a colour ramp of fewer than two steps");

        // The library paints a ramp of positions.
        const FloatingPointGuard guard;
        OIIO::ImageBuf positions(OIIO::ImageSpec(steps, 1, 1, OIIO::TypeDesc::FLOAT));
        for (int i = 0; i < steps; ++i) {
            const float p = static_cast<float>(i) / static_cast<float>(steps - 1);
            positions.setpixel(i, 0, &p, 1);
        }
        const OIIO::ImageBuf colours =
            OIIO::ImageBufAlgo::color_map(positions, 0, OIIO::string_view(name.data(), name.size()));
        if (colours.has_error()) throw EnvironmentError("cannot make the colour ramp: " + colours.geterror());

        std::vector<Rgb8> out;
        for (int i = 0; i < steps; ++i) {
            float rgb[3] = {};
            colours.getpixel(i, 0, rgb, 3);
            out.push_back({to_srgb8(rgb[0]), to_srgb8(rgb[1]), to_srgb8(rgb[2])});
        }
        return out;
    }

    TextBitmap render_text(std::string_view utf8, int size, FontWeight weight) override {
        return cairo_text(utf8, size, weight);
    }
    std::vector<std::uint8_t> cover(std::span<const Figure> figures, const PixelBox& box) override {
        return cairo_coverage(figures, box);
    }
    void write_pdf(file::ByteSink& sink, const Canvas& canvas, const FileMetadata& metadata) override {
        cairo_pdf(sink, canvas, metadata);
    }
    std::vector<std::string> exr_parts(const std::filesystem::path& path) override;
    ExrImage read_exr(const std::filesystem::path& path, std::size_t part) override;
    PngImage read_png(const std::filesystem::path& path) override;

protected:
    std::unique_ptr<PngWriter> make_png(std::unique_ptr<file::ByteSink> sink, const std::string& path,
                                        const PngSpec& spec) override {
        return std::make_unique<OiioPng>(std::move(sink), path, spec);
    }
};

std::vector<std::string> OiioBackend::exr_parts(const std::filesystem::path& path) {
    const FloatingPointGuard guard;
    static_cast<void>(ExrHeads(path));
    const auto input = open_input(path, "openexr");
    std::vector<std::string> names;
    for (int part = 0; input->seek_subimage(part, 0); ++part)
        names.push_back(input->spec().get_string_attribute("oiio:subimagename"));
    return names;
}

/// Reads a number of type `To` from the bytes at `p`.
template <class To>
To read_bytes(const std::byte* p) {
    To number;
    std::memcpy(&number, p, sizeof number);
    return number;
}

/// Takes the channels apart: pixels lie one after the other, each with its samples in the order of the channels.
std::vector<ExrChannel> split_channels(const OIIO::ImageSpec& spec, const std::vector<std::byte>& pixels) {
    const std::size_t stride = spec.pixel_bytes(true), pixel_count = pixels.size() / stride;
    std::vector<ExrChannel> channels;
    std::size_t offset = 0;
    for (int c = 0; c < spec.nchannels; ++c) {
        const OIIO::TypeDesc type = spec.channelformat(c);
        const auto gather = [&](auto convert) {
            std::vector<decltype(convert(pixels.data()))> samples(pixel_count);
            for (std::size_t i = 0; i < pixel_count; ++i) samples[i] = convert(pixels.data() + i * stride + offset);
            channels.push_back({spec.channel_name(c), std::move(samples)});
        };
        if (type == OIIO::TypeDesc::UINT) gather(read_bytes<std::uint32_t>);
        else if (type == OIIO::TypeDesc::FLOAT) gather(read_bytes<float>);
        else
            gather([type](const std::byte* p) {
                float f = 0;
                OIIO::convert_pixel_values(type, p, OIIO::TypeDesc::FLOAT, &f, 1);
                return f;
            });
        offset += type.size();
    }
    return channels;
}

ExrImage OiioBackend::read_exr(const std::filesystem::path& path, std::size_t part) {
    const FloatingPointGuard guard;
    static_cast<void>(ExrHeads(path));
    const auto input = open_input(path, "openexr");
    const int part_index = static_cast<int>(part);
    if (!input->seek_subimage(part_index, 0))
        throw InputError(path.string() + ": cannot read part " + std::to_string(part) + ": " + input->geterror());

    const OIIO::ImageSpec& spec = input->spec();
    require_pixel_memory(path, claimed_pixels_of(spec, 0), 2);  // the headers were checked against the file
    const auto pixel_count = static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height);
    std::vector<std::byte> pixels(pixel_count * spec.pixel_bytes(true));
    if (!input->read_image(part_index, 0, 0, spec.nchannels, OIIO::TypeDesc::UNKNOWN, pixels.data())) {
        throw InputError(path.string() + ": cannot read: " + input->geterror());
    }

    ExrImage out{spec.width, spec.height, split_channels(spec, pixels), {}};
    std::sort(out.channels.begin(), out.channels.end(), [](auto& a, auto& b) { return a.name < b.name; });
    for (const auto& attribute : spec.extra_attribs) {
        if (attribute.type() == OIIO::TypeDesc::STRING) {
            out.attributes.emplace_back(attribute.name().string(), attribute.get_string());
        }
    }
    std::sort(out.attributes.begin(), out.attributes.end());
    return out;
}

PngImage OiioBackend::read_png(const std::filesystem::path& path) {
    const FloatingPointGuard guard;
    const auto input = open_input(path, "png");
    const OIIO::ImageSpec& spec = input->spec();
    if (spec.nchannels != 3 || spec.format != OIIO::TypeDesc::UINT8) {
        throw InputError(path.string() + ": not an 8-bit RGB picture");
    }
    require_pixel_memory(path, claimed_pixels_of(spec, 1032), 1);  // deflate: RFC 1951
    PngImage out{spec.width, spec.height, {}};
    out.pixels.resize(static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height));
    if (!input->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, out.pixels.data())) {
        throw InputError(path.string() + ": cannot read: " + input->geterror());
    }
    return out;
}

}  // namespace
}  // namespace lostbits::output::image

extern "C" __attribute__((visibility("default"))) int lostbits_image_abi() {
    return lostbits::output::image::image_module_abi;
}

/// The only instance. It is never destroyed, because files may still be open when static objects are destroyed.
extern "C" __attribute__((visibility("default"))) lostbits::output::image::ImageBackend* lostbits_image_backend() {
    static auto* backend = new lostbits::output::image::OiioBackend;
    return backend;
}
