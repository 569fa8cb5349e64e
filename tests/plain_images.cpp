// Pictures for tests that do not look at them: an image module that keeps what is drawn and skips the library, which
// takes half a second of processor to load. A PNG is its size, its words and its pixels, as they were handed over: the
// bytes still tell whether two pictures are the same.
#include <algorithm>
#include <span>

#include "number/error.hpp"
#include "output/image/canvas.hpp"
#include "output/image/image.hpp"

namespace {

using namespace lostbits::output;
using namespace lostbits::output::image;

class PlainFile {
public:
    explicit PlainFile(std::unique_ptr<file::ByteSink> sink) : sink_(std::move(sink)) {}
    template <class T>
    void put(std::span<const T> some) {
        sink_->write(std::as_bytes(some));
    }
    void put(const std::string& text) { put(std::span<const char>(text + "\n")); }
    void put(const std::vector<std::pair<std::string, std::string>>& words) {
        for (const auto& [key, value] : words) put(key + " " + value);
    }
    void commit() { sink_->commit(); }

private:
    std::unique_ptr<file::ByteSink> sink_;
};

class PlainPng final : public PngWriter {
public:
    PlainPng(std::unique_ptr<file::ByteSink> sink, const PngSpec& spec) : file_(std::move(sink)) {
        file_.put("png " + std::to_string(spec.width) + " " + std::to_string(spec.height));
        file_.put(spec.metadata);
    }
    void write_rows(int /*rows*/, std::span<const Rgb8> pixels) override { file_.put(pixels); }
    void close() override { file_.commit(); }

private:
    PlainFile file_;
};

class PlainImages final : public ImageBackend {
public:
    std::vector<Rgb8> ramp(std::string_view name, int steps) override {
        std::vector<Rgb8> colours;
        const auto blue = static_cast<std::uint8_t>(name.front());
        for (int i = 0; i < steps; ++i) {
            const auto grey = static_cast<std::uint8_t>(255 * i / (steps - 1));
            colours.push_back({grey, grey, blue});
        }
        return colours;
    }
    /// A letter is a block as dark as its code.
    TextBitmap render_text(std::string_view utf8, int size, FontWeight weight) override {
        const int wide = std::max(1, size / 2 + (weight == FontWeight::bold)), high = size + size / 4;
        TextBitmap out{wide * static_cast<int>(utf8.size()), high, size, {}};
        out.runs.push_back({std::string(utf8), size, 0, size * 1.0, out.width * 1.0});
        for (int y = 0; y < high; ++y)
            for (const char c : utf8)
                out.coverage.insert(out.coverage.end(), static_cast<std::size_t>(wide), static_cast<std::uint8_t>(c));
        return out;
    }
    /// A figure is its corners, each as dark as the line is thick.
    std::vector<std::uint8_t> cover(std::span<const Figure> figures, const PixelBox& box) override {
        std::vector<std::uint8_t> covered(static_cast<std::size_t>(box.width) * static_cast<std::size_t>(box.height));
        for (const Figure& figure : figures) {
            for (const Point& p : figure.points) {
                const auto x = static_cast<std::size_t>(std::clamp(p.x - box.x, 0.0, box.width - 1.0));
                const auto y = static_cast<std::size_t>(std::clamp(p.y - box.y, 0.0, box.height - 1.0));
                covered[y * static_cast<std::size_t>(box.width) + x] =
                    static_cast<std::uint8_t>(255 - std::min(100 * figure.thickness, 200.0));
            }
        }
        return covered;
    }
    /// A page is its words, the colours of its marks and its texts.
    void write_pdf(file::ByteSink& sink, const Canvas& canvas, const FileMetadata& words) override {
        const auto put = [&sink](const std::string& text) { sink.write(std::as_bytes(std::span(text))); };
        for (const auto& [key, value] : words) put(key + " " + value + "\n");
        canvas.draw_with([&put](const auto& shape, const CanvasMark& mark) {
            put(std::to_string(mark.colour.r) + "\n");
            if constexpr (requires { shape.text.runs; })
                for (const TextRun& run : shape.text.runs) put(run.text + "\n");
        });
    }
    std::vector<std::string> exr_parts(const std::filesystem::path& path) override { refuse(path); }
    ExrImage read_exr(const std::filesystem::path& path, std::size_t) override { refuse(path); }
    PngImage read_png(const std::filesystem::path& path) override { refuse(path); }

protected:
    std::unique_ptr<PngWriter> make_png(std::unique_ptr<file::ByteSink> sink, const std::string&,
                                        const PngSpec& spec) override {
        return std::make_unique<PlainPng>(std::move(sink), spec);
    }

private:
    [[noreturn]] static void refuse(const std::filesystem::path& path) {
        throw lostbits::InputError(path.string() + ": a test that reads pictures sets LOSTBITS_IMAGE_MODULE");
    }
};

}  // namespace

extern "C" __attribute__((visibility("default"))) int lostbits_image_abi() { return image_module_abi; }
extern "C" __attribute__((visibility("default"))) ImageBackend* lostbits_image_backend() {
    static auto* backend = new PlainImages;
    return backend;
}
