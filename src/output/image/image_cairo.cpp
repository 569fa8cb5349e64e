// Drawing with Cairo in the image module. Text in a font given by its file, lines and polygons are returned as
// coverage. The coverage is computed from whole numbers without any setting of the user's, so it is the same on every
// machine. A drawing can also become a PDF.
#include <cairo-ft.h>
#include <cairo-pdf.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "number/error.hpp"
#include "output/image/canvas.hpp"
#include "output/image/image_oiio.hpp"

namespace lostbits::output::image {
namespace {

constexpr double max_width = 32767;  // pixels; larger pictures are impossible in Cairo

void check(cairo_status_t status) {
    if (status != CAIRO_STATUS_SUCCESS)
        throw EnvironmentError(std::string("cannot draw: ") + cairo_status_to_string(status));
}

/// A surface that stores only coverage, at first 0 everywhere, and a Cairo context that draws on it.
class CoverageSurface {
public:
    CoverageSurface(int width, int height)
        : surface_(cairo_image_surface_create(CAIRO_FORMAT_A8, width, height), cairo_surface_destroy),
          pen_(cairo_create(surface_.get()), cairo_destroy) {}

    [[nodiscard]] cairo_t* pen() const { return pen_.get(); }

    [[nodiscard]] std::vector<std::uint8_t> coverage() const {
        check(cairo_status(pen()));
        cairo_surface_flush(surface_.get());
        const auto* row = cairo_image_surface_get_data(surface_.get());
        std::vector<std::uint8_t> bytes;
        for (int y = 0; y < cairo_image_surface_get_height(surface_.get()); ++y) {
            bytes.insert(bytes.end(), row, row + cairo_image_surface_get_width(surface_.get()));
            row += cairo_image_surface_get_stride(surface_.get());
        }
        return bytes;
    }

private:
    std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface_;
    std::unique_ptr<cairo_t, void (*)(cairo_t*)> pen_;
};

/// DejaVu Sans at the paths of Debian, Fedora or Arch.
FT_Face open_font(FontWeight weight) {
    static FT_Library library = nullptr;
    const std::string file = weight == FontWeight::bold ? "DejaVuSans-Bold.ttf" : "DejaVuSans.ttf";
    FT_Face face = nullptr;
    if (library != nullptr || FT_Init_FreeType(&library) == 0) {
        for (const char* folder :
             {"/usr/share/fonts/truetype/dejavu/", "/usr/share/fonts/dejavu-sans-fonts/", "/usr/share/fonts/TTF/"})
            if (FT_New_Face(library, (folder + file).c_str(), 0, &face) == 0) return face;
    }
    throw EnvironmentError(
        "cannot draw text: the font " + file +
        " cannot be read; install the package fonts-dejavu-core or, if it is installed, select fewer "
        "forms, or raise `ulimit -n` and `ulimit -v`");
}

std::mutex font_mutex;  // FreeType's faces are not safe for threads

/// FreeType's own hinting in greys, which is crisper at 9 to 18 pixels. Lives as long as the module.
cairo_scaled_font_t* make_font(int size, FontWeight weight) {
    cairo_font_options_t* options = cairo_font_options_create();
    cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
    cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_FULL);
    cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_ON);

    cairo_matrix_t identity, scale;
    cairo_matrix_init_identity(&identity);
    cairo_matrix_init_scale(&scale, size, size);
    cairo_font_face_t* face = cairo_ft_font_face_create_for_ft_face(open_font(weight), 0);
    cairo_scaled_font_t* font = cairo_scaled_font_create(face, &scale, &identity, options);

    cairo_font_face_destroy(face);
    cairo_font_options_destroy(options);
    check(cairo_scaled_font_status(font));
    return font;
}

cairo_scaled_font_t* cached_font(int size, FontWeight weight) {
    static std::map<std::pair<int, FontWeight>, cairo_scaled_font_t*> fonts;
    const auto entry = fonts.find({size, weight});
    return entry != fonts.end() ? entry->second
                                : fonts.emplace(std::pair(size, weight), make_font(size, weight)).first->second;
}

/// Glyphs of one size with their positions.
struct GlyphRun {
    cairo_scaled_font_t* font;
    std::unique_ptr<cairo_glyph_t, void (*)(cairo_glyph_t*)> glyphs;
    int count;
    TextRun run;
};

GlyphRun lay_out(cairo_scaled_font_t* font, std::string_view utf8, const Point& origin) {
    cairo_glyph_t* glyphs = nullptr;
    int count = 0;
    std::string text(utf8);
    const auto glyphs_of_text = [&] {
        return cairo_scaled_font_text_to_glyphs(font, origin.x, origin.y, text.data(), static_cast<int>(text.size()),
                                                &glyphs, &count, nullptr, nullptr, nullptr);
    };

    // Bytes beyond ASCII become question marks if the text is not UTF-8.
    cairo_status_t status = glyphs_of_text();
    if (status == CAIRO_STATUS_INVALID_STRING) {
        std::ranges::replace_if(
            text, [](char c) { return static_cast<unsigned char>(c) > 0x7F; }, '?');
        status = glyphs_of_text();
    }
    check(status);

    cairo_text_extents_t extents;
    cairo_scaled_font_glyph_extents(font, glyphs, count, &extents);
    return {font, {glyphs, cairo_glyph_free}, count, {std::move(text), 0, origin.x, origin.y, extents.x_advance}};
}

/// Number of letters of the exponent after the `^` at index `caret`, if `^` belongs to a power of 2 or 10 that stands
/// alone. Otherwise 0, as in the name of a form, of a file or of an operation.
std::size_t exponent_after(std::string_view text, std::size_t caret) {
    const auto ends_name = [](std::string_view before) {
        return !before.empty() &&
               (std::isalnum(static_cast<unsigned char>(before.back())) || std::strchr("_./^-+@~", before.back()));
    };
    const auto begins_name = [](std::string_view after) {
        if (after.starts_with('.')) after.remove_prefix(1);
        return !after.empty() && (std::isalpha(static_cast<unsigned char>(after[0])) || after[0] == '_');
    };

    // The base, perhaps with a minus sign.
    std::string_view before = text.substr(0, caret);
    if (!before.ends_with('2') && !before.ends_with("10")) return 0;
    before.remove_suffix(before.ends_with('2') ? 1 : 2);
    if (before.ends_with('-')) before.remove_suffix(1);

    // The exponent, perhaps with a sign.
    text.remove_prefix(caret + 1);
    const std::size_t sign = text.starts_with('-') || text.starts_with('+') ? 1 : 0;
    const auto number = text.substr(0, text.find_first_not_of(".0123456789", sign));
    const std::size_t digits =
        number.find_last_of("0123456789") + 1;  // without a dot that ends a sentence; 0 after npos
    return ends_name(before) || begins_name(text.substr(digits)) ? 0 : digits;
}

/// Paints figures one after the other.
void draw_figures(cairo_t* pen, std::span<const Figure> figures) {
    cairo_set_line_cap(pen, CAIRO_LINE_CAP_ROUND);
    cairo_set_line_join(pen, CAIRO_LINE_JOIN_ROUND);
    for (const Figure& figure : figures) {
        for (const Point& p : figure.points) cairo_line_to(pen, p.x, p.y);
        if (figure.thickness > 0) {
            cairo_set_line_width(pen, figure.thickness);
            cairo_set_dash(pen, figure.dashes.data(), static_cast<int>(figure.dashes.size()), 0);
            cairo_stroke(pen);
        } else {
            cairo_fill(pen);
        }
    }
}

}  // namespace

TextBitmap cairo_text(std::string_view utf8, int size, FontWeight weight) {
    const FloatingPointGuard guard;
    const std::lock_guard lock(font_mutex);

    // Line box of DejaVu Sans in em, the same for every text, which keeps the baselines of different texts level.
    // Digits are 0.73 em high, so raised digits stay inside.
    TextBitmap out;
    out.baseline = static_cast<int>(std::ceil(0.93 * size));
    out.height = out.baseline + static_cast<int>(std::ceil(0.24 * size));
    const int exponent_size = std::max(size * 3 / 4, style::smallest_size - 1), exponent_rise = size * 2 / 5;
    out.is_bold = weight == FontWeight::bold;

    std::vector<GlyphRun> glyph_runs;
    double pen_x = 0;
    const auto add_run = [&](std::string_view text, int letter_size, double raised_by) {
        if (text.empty()) return;
        glyph_runs.push_back(lay_out(cached_font(letter_size, weight), text, {pen_x, out.baseline - raised_by}));
        pen_x += glyph_runs.back().run.width;
        out.runs.push_back(glyph_runs.back().run);
        out.runs.back().size = letter_size;
        out.runs.back().is_exponent = raised_by > 0;
    };

    // Each exponent is a run of its own, between runs of plain text.
    std::size_t start = 0;
    for (std::size_t caret = utf8.find('^'); caret != std::string_view::npos; caret = utf8.find('^', caret + 1)) {
        const std::size_t exponent_length = exponent_after(utf8, caret);
        if (exponent_length == 0) continue;
        add_run(utf8.substr(start, caret - start), size, 0);
        add_run(utf8.substr(caret + 1, exponent_length), exponent_size, exponent_rise);
        start = caret + 1 + exponent_length;
    }
    add_run(utf8.substr(start), size, 0);

    out.width = static_cast<int>(std::lround(std::clamp(pen_x, 0.0, max_width)));
    const CoverageSurface surface(out.width, out.height);
    for (const GlyphRun& glyph_run : glyph_runs) {
        cairo_set_scaled_font(surface.pen(), glyph_run.font);
        cairo_show_glyphs(surface.pen(), glyph_run.glyphs.get(), glyph_run.count);
    }
    out.coverage = surface.coverage();
    return out;
}

std::vector<std::uint8_t> cairo_coverage(std::span<const Figure> figures, const PixelBox& box) {
    const FloatingPointGuard guard;
    const CoverageSurface surface(box.width, box.height);
    cairo_t* const pen = surface.pen();
    cairo_translate(pen, -box.x, -box.y);
    cairo_set_antialias(pen, CAIRO_ANTIALIAS_BEST);
    cairo_set_tolerance(pen, 0.01);  // markers are circles of three pixels
    draw_figures(pen, figures);
    return surface.coverage();
}

namespace {

constexpr double points_per_pixel = 0.75;  // 72 points and 96 pixels are an inch

/// Writes a page of a PDF to a sink. The first error of the sink is kept until the end, because an exception must not
/// pass through the C code of Cairo.
class PdfPage {
public:
    PdfPage(file::ByteSink& sink, const Canvas& canvas, const FileMetadata& metadata)
        : sink_(sink),
          surface_(cairo_pdf_surface_create_for_stream(&PdfPage::write_bytes, this, canvas.width() * points_per_pixel,
                                                       canvas.height() * points_per_pixel),
                   cairo_surface_destroy) {
        // Cairo writes the time of day if no date is given.
        cairo_pdf_surface_set_metadata(surface_.get(), CAIRO_PDF_METADATA_CREATE_DATE, "2000-01-01T00:00:00Z");
        for (const auto& [keyword, text] : metadata)
            cairo_pdf_surface_set_metadata(surface_.get(), metadata_field(keyword), text.c_str());

        const std::unique_ptr<cairo_t, void (*)(cairo_t*)> pen(cairo_create(surface_.get()), cairo_destroy);
        pen_ = pen.get();
        cairo_scale(pen_, points_per_pixel, points_per_pixel);
        set_colour(canvas.background());
        cairo_paint(pen_);
        canvas.draw_with([this](const auto& shape, const CanvasMark& mark) {
            cairo_save(pen_);
            cairo_rectangle(pen_, mark.clip.x, mark.clip.y, mark.clip.width, mark.clip.height);
            cairo_clip(pen_);
            set_colour(mark.colour);
            paint(shape, mark);
            cairo_restore(pen_);
        });

        const cairo_status_t drawing_status = cairo_status(pen_);
        cairo_surface_finish(surface_.get());
        if (failure_) std::rethrow_exception(failure_);
        check(drawing_status);
        check(cairo_surface_status(surface_.get()));
    }

private:
    static cairo_pdf_metadata_t metadata_field(std::string_view keyword) {
        return keyword == "Software"           ? CAIRO_PDF_METADATA_CREATOR
               : keyword == "lostbits:command" ? CAIRO_PDF_METADATA_SUBJECT
                                               : CAIRO_PDF_METADATA_KEYWORDS;
    }

    static cairo_status_t write_bytes(void* page, const unsigned char* bytes, unsigned length) noexcept {
        auto& self = *static_cast<PdfPage*>(page);
        try {
            if (!self.failure_) self.sink_.write(std::as_bytes(std::span(bytes, length)));
        } catch (...) {
            self.failure_ = std::current_exception();
        }
        return self.failure_ ? CAIRO_STATUS_WRITE_ERROR : CAIRO_STATUS_SUCCESS;
    }

    void set_colour(Rgb8 c, double opacity = 1) {
        cairo_set_source_rgba(pen_, c.r / 255.0, c.g / 255.0, c.b / 255.0, opacity);
    }

    void paint(const CanvasMark::Fill& fill, const CanvasMark& /*mark*/) {
        for (const PixelBox& box : fill.boxes) cairo_rectangle(pen_, box.x, box.y, box.width, box.height);
        cairo_fill(pen_);
    }

    /// Paints overlapping figures opaquely and then blends the whole group, so that overlaps are not darker.
    void paint(const CanvasMark::FigureGroup& group, const CanvasMark& mark) {
        const bool is_blended = group.opacity < 1 && group.figures.size() > 1;
        if (is_blended) cairo_push_group(pen_);
        else set_colour(mark.colour, group.opacity);
        draw_figures(pen_, group.figures);
        if (!is_blended) return;
        cairo_pop_group_to_source(pen_);
        cairo_paint_with_alpha(pen_, group.opacity);
    }

    void paint(const CanvasMark::Field& field, const CanvasMark& /*mark*/) {
        const std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> samples(
            cairo_image_surface_create(CAIRO_FORMAT_RGB24, field.columns, field.rows()), cairo_surface_destroy);
        check(cairo_surface_status(samples.get()));

        // Copies the samples row by row, because Cairo pads its rows.
        unsigned char* row = cairo_image_surface_get_data(samples.get());
        const int stride = cairo_image_surface_get_stride(samples.get());
        auto sample = field.samples.begin();
        for (int y = 0; y < field.rows(); ++y, row += stride) {
            for (int x = 0; x < field.columns; ++x, ++sample) {
                const std::uint32_t packed_colour =
                    std::uint32_t{sample->r} << 16 | std::uint32_t{sample->g} << 8 | sample->b;
                std::memcpy(row + 4 * x, &packed_colour, sizeof packed_colour);
            }
        }
        cairo_surface_mark_dirty(samples.get());

        // Stretches them to the box without blending neighbours.
        cairo_translate(pen_, field.box.x, field.box.y);
        cairo_scale(pen_, static_cast<double>(field.box.width) / field.columns,
                    static_cast<double>(field.box.height) / field.rows());
        cairo_set_source_surface(pen_, samples.get(), 0, 0);
        cairo_pattern_set_filter(cairo_get_source(pen_), CAIRO_FILTER_NEAREST);
        cairo_rectangle(pen_, 0, 0, field.columns, field.rows());
        cairo_fill(pen_);
    }

    void paint(const CanvasMark::Line& line, const CanvasMark& /*mark*/) {
        cairo_translate(pen_, line.x, line.y);
        if (line.text.is_rotated) {
            cairo_translate(pen_, 0, line.text.height);
            cairo_rotate(pen_, -std::acos(0.0));
        }
        for (const TextRun& run : line.text.runs)
            paint_run(run, line.text.is_bold ? FontWeight::bold : FontWeight::regular);
    }

    /// Letters without hinting are some percent narrower or wider, so they get the positions that they have in the PNG.
    /// The first letter of an exponent stands for itself and a `^`, so that copied text reads `2^-10` and not `2-10`.
    void paint_run(const TextRun& run, FontWeight weight) {
        cairo_set_font_face(pen_, cairo_scaled_font_get_font_face(cached_font(style::text_size, weight)));
        cairo_set_font_size(pen_, run.size);

        cairo_glyph_t* glyphs = nullptr;
        cairo_text_cluster_t* clusters = nullptr;
        int count = 0, cluster_count = 0;
        cairo_text_cluster_flags_t flags{};
        cairo_scaled_font_t* const font = cairo_get_scaled_font(pen_);
        check(cairo_scaled_font_text_to_glyphs(font, 0, 0, run.text.data(), static_cast<int>(run.text.size()), &glyphs,
                                               &count, &clusters, &cluster_count, &flags));

        // Stretches the letters to the width that they have in the PNG.
        cairo_text_extents_t extents;
        cairo_scaled_font_glyph_extents(font, glyphs, count, &extents);
        const double stretch = extents.x_advance > 0 ? run.width / extents.x_advance : 1;
        for (int i = 0; i < count; ++i) glyphs[i] = {glyphs[i].index, run.x + glyphs[i].x * stretch, run.y};

        const std::string copied_text = (run.is_exponent ? "^" : "") + run.text;
        if (run.is_exponent && cluster_count > 0) ++clusters[0].num_bytes;
        cairo_show_text_glyphs(pen_, copied_text.data(), static_cast<int>(copied_text.size()), glyphs, count, clusters,
                               cluster_count, flags);
        cairo_text_cluster_free(clusters);
        cairo_glyph_free(glyphs);
    }

    file::ByteSink& sink_;
    std::exception_ptr failure_;
    std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface_;
    cairo_t* pen_ = nullptr;
};

}  // namespace

void cairo_pdf(file::ByteSink& sink, const Canvas& canvas, const FileMetadata& metadata) {
    const FloatingPointGuard guard;
    const std::lock_guard lock(font_mutex);
    const PdfPage page(sink, canvas, metadata);
}

}  // namespace lostbits::output::image
