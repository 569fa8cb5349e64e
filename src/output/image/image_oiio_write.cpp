// The writing half of the image module.
#include "output/image/image_oiio.hpp"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <exception>
#include <stdexcept>

#include "number/error.hpp"

namespace lostbits::output::image {

using file::ByteSink;

namespace {

/// Hands the library's bytes to a ByteSink and keeps the first error: the library would turn it into a flag, or, in
/// a destructor, into nothing.
class SinkProxy final : public OIIO::Filesystem::IOProxy {
public:
    SinkProxy(std::unique_ptr<ByteSink> sink, const std::string& path) : IOProxy(path, Write), sink_(std::move(sink)) {}

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

    [[nodiscard]] bool failed() const noexcept { return failure_ != nullptr; }

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

OIIO::ImageSpec image_spec(const PngSpec& png) {
    OIIO::ImageSpec spec(png.width, png.height, 3, OIIO::TypeDesc::UINT8);
    for (const auto& [keyword, text] : png.words) spec.attribute(keyword, text);
    spec.attribute("oiio:ColorSpace", "sRGB");
    // Of 1024 x 1024 heatmaps, which have few colours and much noise, level 2 without filters makes files a third
    // smaller than the default (level 6, every filter tried) in a quarter of its time.
    spec.attribute("png:filter", 8);  // PNG_FILTER_NONE
    spec.attribute("png:compressionLevel", 2);
    return spec;
}

/// An ImageOutput on a SinkProxy, rows in order, errors rethrown.
class OiioPng final : public PngWriter {
public:
    OiioPng(std::unique_ptr<ByteSink> sink, const std::string& path, const PngSpec& spec)
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

    /// A file that was not closed ends here, and its bytes go nowhere. libpng insists on finishing a picture: with rows
    /// lacking it complains on stderr or, after a failed write, compresses for ever. Its writer is let go instead: a
    /// leak of one row's buffers in a run that is ending anyway.
    ~OiioPng() override {
        if (!out_) return;
        proxy_.discard();
        static_cast<void>(out_.release());
    }
    OiioPng(const OiioPng&) = delete;
    OiioPng& operator=(const OiioPng&) = delete;

    void write_rows(int rows, std::span<const Rgb8> pixels) override {
        const KeepsFloatingPoint same;
        if (!out_) throw std::logic_error(path_ + ": rows after close");
        if (rows < 0 || rows > height_ - next_ ||
            pixels.size() != static_cast<std::size_t>(width_) * static_cast<std::size_t>(rows))
            throw std::logic_error(path_ + ": " + std::to_string(pixels.size()) + " pixels for " +
                                   std::to_string(rows) + " rows of " + std::to_string(width_) + ", and " +
                                   std::to_string(height_ - next_) + " rows are lacking");
        if (rows == 0) return;
        check(out_->write_scanlines(next_, next_ + rows, 0, OIIO::TypeDesc::UNKNOWN, pixels.data()));
        next_ += rows;
    }

    void close() override {
        const KeepsFloatingPoint same;
        if (!out_) throw std::logic_error(path_ + ": closed twice");
        if (next_ != height_) {
            throw std::logic_error(path_ + ": closed after " + std::to_string(next_) + " of " +
                                   std::to_string(height_) + " rows");
        }
        check(out_->close());
        out_.reset();  // the tail may be written only here
        proxy_.rethrow();
        proxy_.commit();
    }

private:
    void check(bool fine) {
        proxy_.rethrow();
        if (!fine) throw EnvironmentError(path_ + ": cannot write: " + out_->geterror());
    }

    std::string path_;
    int width_, height_, next_ = 0;
    SinkProxy proxy_;  // outlives out_, whose destructor still writes to it
    std::unique_ptr<OIIO::ImageOutput> out_;
};

}  // namespace

std::unique_ptr<PngWriter> oiio_png(std::unique_ptr<ByteSink> sink, const std::string& path, const PngSpec& spec) {
    return std::make_unique<OiioPng>(std::move(sink), path, spec);
}

}  // namespace lostbits::output::image
