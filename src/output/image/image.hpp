// Interface of the image module: PNG, contents of EXR files, colour ramps, text and lines, without types of the
// libraries behind it.
// OpenImageIO, which brings Cairo, takes 180 ms to load. So both are in a module of their own (`lostbits_image`), which
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

/// A channel of an EXR file with 32 bits per sample, never HALF.
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

/// Keywords and texts that a picture file records about itself.
using FileMetadata = std::vector<std::pair<std::string, std::string>>;

/// Metadata of the run that made the file, if the file is in a run's own folder: `Software`, `lostbits:command`,
/// `lostbits:forms`.
[[nodiscard]] FileMetadata metadata_of(const std::filesystem::path& path);

/// Description of a PNG file.
struct PngSpec {
    int width = 0, height = 0;
    FileMetadata metadata;  ///< text chunks
};

/// Writes one RGB PNG file from top to bottom, 8 bits, sRGB.
class PngWriter {
public:
    virtual ~PngWriter() = default;

    /// Writes the next `rows` rows. Throws EnvironmentError (a full disk), and std::logic_error for too many rows or a
    /// wrong size.
    virtual void write_rows(int row_count, std::span<const Rgb8> pixels) = 0;

    /// Gives the file its final name. Throws EnvironmentError, and std::logic_error if rows are missing.
    virtual void close() = 0;
};

enum class FontWeight { regular, bold };

/// Letters of one size on one baseline. SVG and PDF files store them as text.
struct TextRun {
    std::string text;  ///< UTF-8
    int size;          ///< pixels per em
    double x, y;       ///< start of the baseline, measured from the upper left corner of the line
    double width;
    bool is_exponent = false;  ///< copied text has a `^` before it
};

/// A line of text as the coverage of each pixel, from 0 (paper) to 255 (ink), row by row. All lines of one size have
/// the same height and baseline.
struct TextBitmap {
    int width = 0, height = 0;
    int baseline = 0;  ///< rows from the top to the baseline
    std::vector<std::uint8_t> coverage;
    std::vector<TextRun> runs = {};  ///< an exponent is a run of its own
    bool is_bold = false;
    bool is_rotated = false;  ///< by 90 degrees counterclockwise; `runs` are those of the level line
};

/// A position on a canvas. Pixel (i, j) covers i..i+1 by j..j+1, so its middle is at i + 1/2.
struct Point {
    double x, y;
};

/// A line through points, with round ends and joints. If the thickness is 0: the polygon with these corners.
struct Figure {
    std::vector<Point> points;
    double thickness = 0;             ///< pixels
    std::vector<double> dashes = {};  ///< alternate lengths of ink and gap; empty: solid
};

/// A rectangle of pixels of a canvas, given by its corner.
struct PixelBox {
    int x = 0, y = 0, width = 0, height = 0;
    friend bool operator==(const PixelBox&, const PixelBox&) = default;
};

/// One channel as read back, bit for bit.
struct ExrChannel {
    std::string name;
    std::variant<std::vector<float>, std::vector<std::uint32_t>> samples;  ///< row by row
};

/// An EXR file, or one part of it, in memory. Channels are sorted by name.
struct ExrImage {
    int width = 0, height = 0;
    std::vector<ExrChannel> channels;
    std::vector<std::pair<std::string, std::string>> attributes;  ///< the string attributes, sorted by name

    /// The channel of that name; null if the image has no such channel.
    [[nodiscard]] const ExrChannel* find(std::string_view name) const;
};

/// A PNG file in memory.
struct PngImage {
    int width = 0, height = 0;
    std::vector<Rgb8> pixels;
};

class Canvas;

/// Functions of the module. They may be called from several threads.
class ImageBackend {
public:
    virtual ~ImageBackend() = default;

    /// Opens `path` at once, like AtomicFile, for width × height RGB pixels. In a run's own folder (see
    /// file::ResultFolder) the file records what made it, in the text chunks `lostbits:command` and `Software`. Throws
    /// EnvironmentError, and std::logic_error for a picture without pixels.
    [[nodiscard]] std::unique_ptr<PngWriter> open_png(const std::filesystem::path& path, int width, int height);
    /// Like the other overload, for a file that is already open.
    [[nodiscard]] std::unique_ptr<PngWriter> open_png(std::unique_ptr<file::AtomicFile> file, int width, int height);

    /// The bytes of a PNG of these pixels, without text chunks.
    [[nodiscard]] std::string png_bytes(int width, int height, std::span<const Rgb8> pixels);

    /// Writes a PDF of one page, where a pixel is 1/96 inch and text is text in an embedded font. The same drawing
    /// gives the same bytes. Throws EnvironmentError.
    virtual void write_pdf(file::ByteSink& sink, const Canvas& canvas, const FileMetadata& metadata) = 0;

    /// `steps` (at least 2) colours of the ramp from low to high: viridis, inferno, magma, plasma or turbo. Throws
    /// InputError for another name.
    [[nodiscard]] virtual std::vector<Rgb8> ramp(std::string_view name, int steps) = 0;

    /// One line of text with letters of `size` pixels per em. The exponent of a power of 2 or 10, `2^-10`, is raised
    /// unless it is part of a name. A character that DejaVu Sans lacks becomes a box. If the text is not UTF-8, every
    /// byte beyond ASCII becomes `?`. Throws EnvironmentError if the font is not installed.
    [[nodiscard]] virtual TextBitmap render_text(std::string_view utf8, int size,
                                                 FontWeight weight = FontWeight::regular) = 0;

    /// Coverage of each pixel by all figures together, 0 to 255, row by row.
    [[nodiscard]] virtual std::vector<std::uint8_t> cover(std::span<const Figure> figures, const PixelBox& box) = 0;

    /// Names of the parts of an EXR in their order; one empty name for a file without parts. Throws InputError.
    [[nodiscard]] virtual std::vector<std::string> exr_parts(const std::filesystem::path& path) = 0;

    /// Reads an EXR, or one of its parts. HALF channels are widened to float. Throws InputError.
    [[nodiscard]] virtual ExrImage read_exr(const std::filesystem::path& path, std::size_t part = 0) = 0;

    /// Reads an 8-bit RGB PNG. Throws InputError.
    [[nodiscard]] virtual PngImage read_png(const std::filesystem::path& path) = 0;

protected:
    virtual std::unique_ptr<PngWriter> make_png(std::unique_ptr<file::ByteSink> sink, const std::string& path,
                                                const PngSpec& spec) = 0;
};

/// Version of this header; increase it with every change. A module of another build is then refused instead of
/// misread.
inline constexpr int image_module_abi = 8;

/// The module, loaded on the first call; later calls cost nothing. The program looks for it at $LOSTBITS_IMAGE_MODULE
/// (if set, only there), beside itself, in `../lib/lostbits` and in `src/output` next to itself. Throws
/// EnvironmentError that says what to install or build.
[[nodiscard]] ImageBackend& image_backend();

}  // namespace lostbits::output::image
