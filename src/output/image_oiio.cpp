// The image module: all of OpenImageIO that the program touches. Built as `lostbits_image`, loaded at run time.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>
#include <mutex>
#include <stdexcept>

#include "number/error.hpp"
#include "output/image.hpp"

namespace lostbits::output {
namespace {

/// Hands the library's bytes to a ByteSink and keeps the first error: the library would turn it into a flag, or, in
/// a destructor, into nothing.
class SinkProxy final : public OIIO::Filesystem::IOProxy {
public:
    SinkProxy(std::unique_ptr<ByteSink> sink, const std::string& path)
        : IOProxy(path, Write), sink_(std::move(sink)) {}

    const char* proxytype() const override { return "lostbits"; }
    bool opened() const override { return true; }
    std::int64_t tell() override { return sink_->tell(); }

    bool seek(std::int64_t offset) override {
        return guarded([&] { sink_->seek(offset); });
    }

    std::size_t write(const void* data, std::size_t size) override {
        const auto* bytes = static_cast<const std::byte*>(data);
        return guarded([&] { sink_->write({bytes, size}); }) ? size : 0;
    }

    /// From here on bytes go nowhere: the library writes a tail even when it is told to stop.
    void discard() noexcept { discarding_ = true; }

    void rethrow() const {
        if (failure_) std::rethrow_exception(failure_);
    }

    void commit() { sink_->commit(); }

private:
    template <class Action>
    bool guarded(Action action) noexcept {
        if (discarding_) return true;
        if (failure_) return false;
        try {
            action();
            return true;
        } catch (...) {
            failure_ = std::current_exception();
            return false;
        }
    }

    std::unique_ptr<ByteSink> sink_;
    std::exception_ptr failure_;
    bool discarding_ = false;
};

/// What EXR and PNG share: an ImageOutput on a SinkProxy, rows in order, errors rethrown.
class ScanlineFile {
public:
    ScanlineFile(std::unique_ptr<ByteSink> sink, const std::string& path, const char* format,
                 const OIIO::ImageSpec& spec)
        : path_(path), height_(spec.height), proxy_(std::move(sink), path), out_(OIIO::ImageOutput::create(format)) {
        if (!out_ || !out_->supports("ioproxy")) {
            throw EnvironmentError(path + ": OpenImageIO was built without a usable " + format + " writer");
        }
        out_->set_ioproxy(&proxy_);
        check(out_->open(path, spec));
        row_bytes_ = out_->spec().scanline_bytes(true);
        opened_ = true;
    }

    /// A file that was not closed ends here. libpng complains on stderr about a picture that lacks rows, so it gets
    /// them, and the bytes go nowhere.
    ~ScanlineFile() {
        if (!out_) return;
        proxy_.discard();
        try {
            const std::vector<std::byte> blank(row_bytes_);
            for (; opened_ && next_ < height_; ++next_) {
                out_->write_scanline(next_, 0, OIIO::TypeDesc::UNKNOWN, blank.data());
            }
        } catch (...) {
        }
    }
    ScanlineFile(const ScanlineFile&) = delete;
    ScanlineFile& operator=(const ScanlineFile&) = delete;

    void write(int y_begin, int rows, std::span<const std::byte> pixels) {
        if (!out_) throw std::logic_error(path_ + ": rows after close");
        if (y_begin != next_ || rows < 0 || rows > height_ - next_) {
            throw std::logic_error(path_ + ": rows " + std::to_string(y_begin) + " + " + std::to_string(rows) +
                                   " out of order, " + std::to_string(next_) + " was next");
        }
        if (pixels.size() != row_bytes_ * static_cast<std::size_t>(rows)) {
            throw std::logic_error(path_ + ": " + std::to_string(pixels.size()) + " bytes for " +
                                   std::to_string(rows) + " rows of " + std::to_string(row_bytes_));
        }
        if (rows == 0) return;
        check(out_->write_scanlines(y_begin, y_begin + rows, 0, OIIO::TypeDesc::UNKNOWN, pixels.data()));
        next_ += rows;
    }

    void close() {
        if (!out_) throw std::logic_error(path_ + ": closed twice");
        if (next_ != height_) {
            throw std::logic_error(path_ + ": closed after " + std::to_string(next_) + " of " +
                                   std::to_string(height_) + " rows");
        }
        check(out_->close());
        out_.reset();  // some formats write their tail only here
        proxy_.rethrow();
        proxy_.commit();
    }

    [[nodiscard]] int next() const noexcept { return next_; }

private:
    void check(bool fine) {
        proxy_.rethrow();
        if (!fine) throw EnvironmentError(path_ + ": cannot write: " + out_->geterror());
    }

    std::string path_;
    int height_;
    int next_ = 0;
    std::size_t row_bytes_ = 0;
    bool opened_ = false;
    SinkProxy proxy_;  // outlives out_, whose destructor still writes to it
    std::unique_ptr<OIIO::ImageOutput> out_;
};

OIIO::ImageSpec exr_spec(const ExrSpec& in) {
    OIIO::ImageSpec spec(in.width, in.height, static_cast<int>(in.channels.size()), OIIO::TypeDesc::FLOAT);
    spec.channelnames.clear();
    spec.channelformats.clear();
    for (const auto& channel : in.channels) {
        spec.channelnames.push_back(channel.name);
        spec.channelformats.emplace_back(channel.type == Channel::Type::u32 ? OIIO::TypeDesc::UINT
                                                                           : OIIO::TypeDesc::FLOAT);
    }
    spec.alpha_channel = -1;
    spec.z_channel = -1;
    spec.attribute("compression", "zip");
    for (const auto& [key, value] : in.attributes) spec.attribute(key, value);
    spec.attribute("DateTime", "");  // left out, the library writes the time of day
    return spec;
}

class OiioExr final : public ExrWriter {
public:
    OiioExr(std::unique_ptr<ByteSink> sink, const std::string& path, const ExrSpec& spec)
        : file_(std::move(sink), path, "openexr", exr_spec(spec)) {}
    void write_rows(int y_begin, int rows, std::span<const std::byte> pixels) override {
        file_.write(y_begin, rows, pixels);
    }
    void close() override { file_.close(); }

private:
    ScanlineFile file_;
};

class OiioPng final : public PngWriter {
public:
    OiioPng(std::unique_ptr<ByteSink> sink, const std::string& path, int width, int height)
        : file_(std::move(sink), path, "png", png_spec(width, height)) {}
    void write_rows(int rows, std::span<const Rgb8> pixels) override {
        file_.write(file_.next(), rows, std::as_bytes(pixels));
    }
    void close() override { file_.close(); }

private:
    static OIIO::ImageSpec png_spec(int width, int height) {
        OIIO::ImageSpec spec(width, height, 3, OIIO::TypeDesc::UINT8);
        spec.attribute("oiio:ColorSpace", "sRGB");
        return spec;
    }
    ScanlineFile file_;
};

std::uint8_t to_srgb8(float linear) {
    const float l = std::clamp(linear, 0.0f, 1.0f);
    const float s = l <= 0.0031308f ? 12.92f * l : 1.055f * std::pow(l, 1 / 2.4f) - 0.055f;
    return static_cast<std::uint8_t>(std::lround(s * 255.0f));
}

std::unique_ptr<OIIO::ImageInput> open_input(const std::filesystem::path& path, std::string_view format) {
    auto in = OIIO::ImageInput::open(path.string());
    if (!in) {
        throw InputError(path.string() + ": cannot read: " + OIIO::geterror() + "; give an existing " +
                         std::string(format) + " file");
    }
    if (format != in->format_name()) {
        throw InputError(path.string() + ": is " + in->format_name() + ", not " + std::string(format));
    }
    return in;
}

class OiioBackend final : public ImageBackend {
public:
    OiioBackend() {
        // The caller spreads files over its own threads; the library's pools would only fight them.
        OIIO::attribute("threads", 1);
        OIIO::attribute("exr_threads", -1);
    }

    std::vector<Rgb8> ramp(std::string_view name, int steps) override {
        static constexpr std::string_view known[] = {"viridis", "inferno", "magma", "plasma", "turbo"};
        if (std::find(std::begin(known), std::end(known), name) == std::end(known)) {
            throw InputError("unknown colour ramp '" + std::string(name) +
                             "'; try viridis, inferno, magma, plasma or turbo");
        }
        if (steps < 2) throw std::logic_error("a colour ramp of fewer than two steps");
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

    TextBitmap render_text(std::string_view ascii, int size, bool bold) override {
        std::string text(ascii);
        for (char& c : text) {
            if (c < ' ' || c > '~') c = '?';
        }
        const char* font = bold ? "DejaVuSans-Bold" : "DejaVuSans";
        // The box of DejaVu Sans in em: a common line box keeps the baselines of different words level.
        TextBitmap out;
        out.baseline = static_cast<int>(std::ceil(0.93 * size));
        out.height = out.baseline + static_cast<int>(std::ceil(0.24 * size));
        const std::lock_guard lock(text_mutex_);
        // A leading or trailing space has no ink, and text_size measures ink: frame it with two bars.
        const OIIO::ROI bar = OIIO::ImageBufAlgo::text_size("||", size, font);
        const OIIO::ROI framed = OIIO::ImageBufAlgo::text_size("|" + text + "|", size, font);
        if (!bar.defined() || !framed.defined()) {
            throw EnvironmentError(std::string("cannot draw text: font ") + font +
                                   " not found; install the package fonts-dejavu-core");
        }
        out.width = std::max(framed.width() - bar.width(), 0);
        out.coverage.assign(static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height), 0);
        if (out.width == 0) return out;
        OIIO::ImageBuf ink(OIIO::ImageSpec(out.width, out.height, 1, OIIO::TypeDesc::FLOAT));
        OIIO::ImageBufAlgo::zero(ink);
        if (!OIIO::ImageBufAlgo::render_text(ink, 0, out.baseline, text, size, font, 1.0f)) {
            throw EnvironmentError("cannot draw text: " + ink.geterror());
        }
        for (int y = 0; y < out.height; ++y) {
            for (int x = 0; x < out.width; ++x) {
                float c = 0;
                ink.getpixel(x, y, &c, 1);
                out.coverage[static_cast<std::size_t>(y * out.width + x)] =
                    static_cast<std::uint8_t>(std::lround(std::clamp(c, 0.0f, 1.0f) * 255.0f));
            }
        }
        return out;
    }

    ExrImage read_exr(const std::filesystem::path& path) override;
    PngImage read_png(const std::filesystem::path& path) override;

protected:
    std::unique_ptr<ExrWriter> make_exr(std::unique_ptr<ByteSink> sink, const std::string& path,
                                        const ExrSpec& spec) override {
        return std::make_unique<OiioExr>(std::move(sink), path, spec);
    }
    std::unique_ptr<PngWriter> make_png(std::unique_ptr<ByteSink> sink, const std::string& path, int width,
                                        int height) override {
        return std::make_unique<OiioPng>(std::move(sink), path, width, height);
    }

private:
    std::mutex text_mutex_;
};

ExrImage OiioBackend::read_exr(const std::filesystem::path& path) {
    const auto in = open_input(path, "openexr");
    const OIIO::ImageSpec& spec = in->spec();
    const auto count = static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height);
    const auto stride = spec.pixel_bytes(true);
    std::vector<std::byte> pixels(count * stride);
    if (!in->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::UNKNOWN, pixels.data())) {
        throw InputError(path.string() + ": cannot read: " + in->geterror());
    }
    ExrImage out{spec.width, spec.height, {}, {}};
    std::size_t offset = 0;
    for (int c = 0; c < spec.nchannels; ++c) {
        const OIIO::TypeDesc type = spec.channelformat(c);
        const auto gather = [&](auto convert) {
            std::vector<decltype(convert(pixels.data()))> samples(count);
            for (std::size_t i = 0; i < count; ++i) samples[i] = convert(pixels.data() + i * stride + offset);
            out.channels.push_back({spec.channel_name(c), std::move(samples)});
        };
        if (type == OIIO::TypeDesc::UINT) {
            gather([](const std::byte* p) { std::uint32_t u; std::memcpy(&u, p, sizeof u); return u; });
        } else if (type == OIIO::TypeDesc::FLOAT) {
            gather([](const std::byte* p) { float f; std::memcpy(&f, p, sizeof f); return f; });
        } else {
            gather([type](const std::byte* p) {
                float f = 0;
                OIIO::convert_pixel_values(type, p, OIIO::TypeDesc::FLOAT, &f, 1);
                return f;
            });
        }
        offset += type.size();
    }
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
    const auto in = open_input(path, "png");
    const OIIO::ImageSpec& spec = in->spec();
    if (spec.nchannels != 3 || spec.format != OIIO::TypeDesc::UINT8) {
        throw InputError(path.string() + ": not an 8-bit RGB picture");
    }
    PngImage out{spec.width, spec.height, {}};
    out.pixels.resize(static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height));
    if (!in->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, out.pixels.data())) {
        throw InputError(path.string() + ": cannot read: " + in->geterror());
    }
    return out;
}

}  // namespace
}  // namespace lostbits::output

extern "C" __attribute__((visibility("default"))) int lostbits_image_abi() {
    return lostbits::output::image_module_abi;
}

/// The one instance, never destroyed: files may still be open when static objects go.
extern "C" __attribute__((visibility("default"))) lostbits::output::ImageBackend* lostbits_image_backend() {
    static auto* backend = new lostbits::output::OiioBackend;
    return backend;
}
