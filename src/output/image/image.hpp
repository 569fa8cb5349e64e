// The face of the image module: PNG, what an EXR holds, colour ramps, text and lines, without a type of the libraries
// behind it.
//
// OpenImageIO, which brings Cairo, costs 180 ms to load, so they sit in a module of their own (`lostbits_image`) that
// `image_backend()` loads when a command first writes a picture.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "output/file/atomic_file.hpp"
#include "output/image/colour.hpp"

namespace lostbits::output::image {

/// A channel of an EXR file: 32 bits a sample, never HALF.
struct Channel {
    enum class Type { f32, u32 };
    std::string name;  ///< `layer.channel` with one dot, or R, G, B
    Type type = Type::f32;
};

/// The header of an EXR file.
struct ExrSpec {
    int width = 0, height = 0;
    std::vector<Channel> channels;
    std::vector<std::pair<std::string, std::string>> attributes;  ///< `lostbits:scene`, ...; written as strings
};

/// What a PNG file is to be.
struct PngSpec {
    int width = 0, height = 0;
    std::vector<std::pair<std::string, std::string>> words;  ///< its text chunks: keyword and text
};

/// Writes one RGB PNG file from top to bottom, 8 bits, sRGB.
class PngWriter {
public:
    virtual ~PngWriter() = default;

    /// The next `rows` rows. Throws EnvironmentError (a full disk), and std::logic_error for too many rows or a wrong
    /// size.
    virtual void write_rows(int rows, std::span<const Rgb8> pixels) = 0;

    /// Gives the file its final name. Throws EnvironmentError, and std::logic_error when rows are lacking.
    virtual void close() = 0;
};

/// A line of text as coverage, 0 (paper) to 255 (ink), row by row. All lines of one size share height and baseline.
struct TextBitmap {
    int width = 0, height = 0;
    int baseline = 0;  ///< rows from the top to the line that the letters stand on
    std::vector<std::uint8_t> coverage;
};

/// A place on a canvas: pixel (i, j) covers i..i+1 by j..j+1, so its middle is at i + 1/2.
struct Point {
    double x, y;
};

/// A line through points, with round ends and joints; of no thickness, the polygon between them.
struct Figure {
    std::vector<Point> points;
    double thickness = 0;             ///< pixels
    std::vector<double> dashes = {};  ///< the lengths of ink and gap in turn; empty: solid
};

/// Pixels of a canvas, from a corner on.
struct PixelBox {
    int x = 0, y = 0, width = 0, height = 0;
};

/// One channel as it was read back, bit for bit.
struct ExrChannel {
    std::string name;
    std::variant<std::vector<float>, std::vector<std::uint32_t>> samples;  ///< row by row
};

/// An EXR file, or one part of it, in memory, channels sorted by name.
struct ExrImage {
    int width = 0, height = 0;
    std::vector<ExrChannel> channels;
    std::vector<std::pair<std::string, std::string>> attributes;  ///< the string attributes, sorted by name

    /// The channel of that name, or nullptr.
    [[nodiscard]] const ExrChannel* find(std::string_view name) const;
};

/// A PNG file in memory.
struct PngImage {
    int width = 0, height = 0;
    std::vector<Rgb8> pixels;
};

/// What the module does. Safe to use from several threads.
class ImageBackend {
public:
    virtual ~ImageBackend() = default;

    /// Opens `path` at once, as AtomicFile does, for width × height RGB pixels. In a run's own folder (see
    /// file::ResultFolder) the file says what made it, in text chunks `lostbits:command` and `Software`. Throws
    /// EnvironmentError, and std::logic_error for a picture without pixels.
    [[nodiscard]] std::unique_ptr<PngWriter> open_png(const std::filesystem::path& path, int width, int height);

    /// `steps` (at least 2) colours of the ramp, low to high: viridis, inferno, magma, plasma or turbo. Throws
    /// InputError for another name.
    [[nodiscard]] virtual std::vector<Rgb8> ramp(std::string_view name, int steps) = 0;

    /// One line of text with letters `size` pixels to the em; the exponent of a power of 2 or 10, `2^-10`, is raised
    /// where it is not a part of a name. A character that DejaVu Sans lacks becomes a box; where the text is not UTF-8,
    /// every byte beyond ASCII `?`. Throws EnvironmentError when that font is not installed.
    [[nodiscard]] virtual TextBitmap render_text(std::string_view utf8, int size, bool bold = false) = 0;

    /// How much of each pixel the figures cover together, 0 to 255, row by row.
    [[nodiscard]] virtual std::vector<std::uint8_t> cover(std::span<const Figure> figures, const PixelBox& box) = 0;

    /// The names of an EXR's parts, in their order; of a file without parts one empty name. Throws InputError.
    [[nodiscard]] virtual std::vector<std::string> exr_parts(const std::filesystem::path& path) = 0;

    /// Reads an EXR, or one of its parts, HALF channels widened to float. Throws InputError.
    [[nodiscard]] virtual ExrImage read_exr(const std::filesystem::path& path, std::size_t part = 0) = 0;

    /// Reads an 8-bit RGB PNG. Throws InputError.
    [[nodiscard]] virtual PngImage read_png(const std::filesystem::path& path) = 0;

protected:
    virtual std::unique_ptr<PngWriter> make_png(std::unique_ptr<file::ByteSink> sink, const std::string& path,
                                                const PngSpec& spec) = 0;
};

/// Grows with every change of this header; a module of another build is refused rather than misread.
inline constexpr int image_module_abi = 5;

/// The module, loaded on the first call; later calls cost nothing. Looks at $LOSTBITS_IMAGE_MODULE (then nowhere
/// else), beside the program, in its `../lib/lostbits` and in its `src/output`. Throws EnvironmentError that says
/// what to install or build.
[[nodiscard]] ImageBackend& image_backend();

}  // namespace lostbits::output::image
