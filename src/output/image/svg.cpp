// Writes a canvas as SVG.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "output/file/base64.hpp"
#include "output/file/escape.hpp"
#include "output/image/figure.hpp"

namespace lostbits::output::image {
namespace {

/// Hundredths of a pixel. Coordinates are rounded once, so that the steps of a path add up.
long hundredths(double pixels) { return std::lround(100 * pixels); }

/// `12.5`, `-0.07`, `3`
std::string number_text(long value) {
    const long magnitude = std::labs(value);
    std::string text = fmt::format("{}{}", value < 0 ? "-" : "", magnitude / 100);
    if (magnitude % 100 == 0) return text;
    text += fmt::format(".{:02}", magnitude % 100);
    return text.ends_with('0') ? text.substr(0, text.size() - 1) : text;
}

std::string number_text(double pixels) { return number_text(hundredths(pixels)); }

std::string colour_text(Rgb8 c) { return fmt::format("#{:02x}{:02x}{:02x}", c.r, c.g, c.b); }

/// The points as steps of a path: `M1 2l3-4`.
std::string path_through(std::span<const Point> points) {
    std::string text;
    long x = 0, y = 0;
    for (const Point& p : points) {
        const long next_x = hundredths(p.x), next_y = hundredths(p.y);
        const std::string dx_text = number_text(next_x - x), dy_text = number_text(next_y - y);
        text += text.empty() ? "M" : text.find('l') == std::string::npos ? "l" : dx_text.starts_with('-') ? "" : " ";
        text += dx_text + (dy_text.starts_with('-') ? "" : " ") + dy_text;
        x = next_x;
        y = next_y;
    }
    return text;
}

bool is_disc(const Figure& figure) {
    const auto& p = figure.points;
    return figure.thickness > 0 && p.size() == 2 && p[0].x == p[1].x && p[0].y == p[1].y;
}

bool can_share_path(const Figure& a, const Figure& b) {
    return !is_disc(a) && !is_disc(b) && a.thickness > 0 && a.thickness == b.thickness && a.dashes == b.dashes;
}

/// Writes the elements of marks one after the other.
class SvgElements {
public:
    explicit SvgElements(const Canvas& canvas) {
        canvas.draw_with([this](const auto& shape, const CanvasMark& mark) {
            begin_group(mark.data.get());
            add(shape, mark);
        });
        begin_group(nullptr);
        clip_to({});
    }

    [[nodiscard]] const std::string& text() const { return text_; }

private:
    /// Begins the group of the marks with this data; null: marks without data.
    void begin_group(const MarkData* data) {
        if (data == data_) return;
        clip_to({});
        if (data_ != nullptr) text_ += "</g>\n";
        data_ = data;
        if (data == nullptr) return;

        text_ += "<g data-keys=\"" + file::html(data->keys) + "\"";
        for (const auto& [name, positions] : {std::pair("x", &data->x), {"y", &data->y}}) {
            std::string numbers;
            for (const double position : *positions)
                numbers += (numbers.empty() ? "" : " ") + (std::isnan(position) ? "NaN" : number_text(position));
            if (!numbers.empty()) text_ += fmt::format(" data-{}=\"{}\"", name, numbers);
        }
        text_ += ">\n";
    }

    /// Clips the following marks to the box, until the next call; without a box, nothing is clipped.
    void clip_to(const std::optional<PixelBox>& box) {
        if (box == clip_) return;
        if (clip_) text_ += "</svg>\n";
        clip_ = box;
        if (box)
            text_ += fmt::format(R"(<svg x="{0}" y="{1}" width="{2}" height="{3}" viewBox="{0} {1} {2} {3}">)", box->x,
                                 box->y, box->width, box->height) +
                     "\n";
    }

    void add(const CanvasMark::Fill& fill, const CanvasMark& mark) {
        clip_to({});
        text_ += fmt::format("<path fill=\"{}\" d=\"", colour_text(mark.colour));
        for (const PixelBox& box : fill.boxes)
            text_ += fmt::format("M{} {}h{}v{}h-{}z", box.x, box.y, box.width, box.height, box.width);
        text_ += "\"/>\n";
    }

    void add(const CanvasMark::Line& line, const CanvasMark& mark) {
        clip_to({});
        const TextBitmap& text = line.text;
        if (text.runs.empty()) return;

        // One run has its attributes in the element itself; of several, each gets a `tspan`.
        text_ += "<text";
        if (text.is_rotated)
            text_ += fmt::format(" transform=\"translate({} {})rotate(-90)\"", line.x, line.y + text.height);
        const auto run_attributes = [&](const TextRun& run) {
            // If the viewer has another font, its letters are set as wide as these.
            return fmt::format(" x=\"{}\" y=\"{}\" font-size=\"{}\" textLength=\"{}\"",
                               number_text(run.x + (text.is_rotated ? 0 : line.x)),
                               number_text(run.y + (text.is_rotated ? 0 : line.y)), run.size, number_text(run.width));
        };
        if (text.runs.size() == 1) text_ += run_attributes(text.runs.front());
        if (text.is_bold) text_ += " font-weight=\"bold\"";
        text_ += fmt::format(" fill=\"{}\">", colour_text(mark.colour));

        for (const TextRun& run : text.runs) {
            const std::string escaped_text = file::html(run.text);
            text_ += text.runs.size() == 1 ? escaped_text
                                           : fmt::format("<tspan{}>{}</tspan>", run_attributes(run), escaped_text);
        }
        text_ += "</text>\n";
    }

    void add(const CanvasMark::FigureGroup& group, const CanvasMark& mark) {
        clip_to(reaches_beyond(group, mark.clip) ? std::optional(mark.clip) : std::nullopt);
        const std::string ink = colour_text(mark.colour);
        // A group blends overlapping figures only once.
        if (group.opacity < 1) text_ += fmt::format("<g opacity=\"{}\">", number_text(group.opacity));
        for (auto figure = group.figures.begin(); figure != group.figures.end(); ++figure) {
            if (is_disc(*figure)) {
                text_ += fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{}\"/>\n",
                                     number_text(figure->points[0].x), number_text(figure->points[0].y),
                                     number_text(figure->thickness / 2), ink);
                continue;
            }

            // Lines of one look share a path.
            std::string path = path_through(figure->points);
            if (figure->thickness == 0) {
                text_ += fmt::format("<path fill=\"{}\" d=\"{}z\"/>\n", ink, path);
                continue;
            }
            for (; figure + 1 != group.figures.end() && can_share_path(*figure, figure[1]); ++figure)
                path += path_through(figure[1].points);
            text_ += fmt::format("<path fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"{} d=\"{}\"/>\n", ink,
                                 number_text(figure->thickness), dashes_of(*figure), path);
        }
        if (group.opacity < 1) text_ += "</g>\n";
    }

    static std::string dashes_of(const Figure& figure) {
        std::string lengths;
        for (const double length : figure.dashes) lengths += (lengths.empty() ? "" : " ") + number_text(length);
        return lengths.empty() ? "" : fmt::format(" stroke-dasharray=\"{}\"", lengths);
    }

    static bool reaches_beyond(const CanvasMark::FigureGroup& group, const PixelBox& box) {
        return std::ranges::any_of(group.figures, [&box](const Figure& figure) {
            const double radius = figure.thickness / 2;
            return std::ranges::any_of(figure.points, [&](const Point& p) {
                return p.x - radius < box.x || p.y - radius < box.y || p.x + radius > box.x + box.width ||
                       p.y + radius > box.y + box.height;
            });
        });
    }

    void add(const CanvasMark::Field& field, const CanvasMark& /*mark*/) {
        clip_to({});
        text_ += fmt::format(
            "<image x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" preserveAspectRatio=\"none\" "
            "image-rendering=\"pixelated\" href=\"data:image/png;base64,{}\"/>\n",
            field.box.x, field.box.y, field.box.width, field.box.height,
            file::encode_base64(image_backend().png_bytes(field.columns, field.rows(), field.samples)));
    }

    std::string text_;
    const MarkData* data_ = nullptr;
    std::optional<PixelBox> clip_ = {};
};

}  // namespace

std::string svg_text(const Canvas& canvas, const FileMetadata& metadata) {
    std::string metadata_text;
    for (const auto& [keyword, text] : metadata) metadata_text += fmt::format("{}: {}\n", keyword, file::html(text));
    return fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
        "font-family=\"DejaVu Sans, Verdana, sans-serif\" stroke-linecap=\"round\" stroke-linejoin=\"round\" "
        "xml:space=\"preserve\">\n{2}<rect width=\"{0}\" height=\"{1}\" fill=\"{3}\"/>\n{4}</svg>\n",
        canvas.width(), canvas.height(),
        metadata_text.empty() ? "" : fmt::format("<metadata>{}</metadata>\n", metadata_text),
        colour_text(canvas.background()), SvgElements(canvas).text());
}

}  // namespace lostbits::output::image
