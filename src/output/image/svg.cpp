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
std::string number(long hundredths) {
    const long size = std::labs(hundredths);
    std::string text = fmt::format("{}{}", hundredths < 0 ? "-" : "", size / 100);
    if (size % 100 == 0) return text;
    text += fmt::format(".{:02}", size % 100);
    return text.ends_with('0') ? text.substr(0, text.size() - 1) : text;
}

std::string number(double pixels) { return number(hundredths(pixels)); }

std::string colour(Rgb8 c) { return fmt::format("#{:02x}{:02x}{:02x}", c.r, c.g, c.b); }

/// The points as steps of a path: `M1 2l3-4`.
std::string path_through(std::span<const Point> points) {
    std::string text;
    long x = 0, y = 0;
    for (const Point& p : points) {
        const long to_x = hundredths(p.x), to_y = hundredths(p.y);
        const std::string across = number(to_x - x), down = number(to_y - y);
        text += text.empty() ? "M" : text.find('l') == std::string::npos ? "l" : across.starts_with('-') ? "" : " ";
        text += across + (down.starts_with('-') ? "" : " ") + down;
        x = to_x;
        y = to_y;
    }
    return text;
}

bool is_disc(const Figure& figure) {
    const auto& p = figure.points;
    return figure.thickness > 0 && p.size() == 2 && p[0].x == p[1].x && p[0].y == p[1].y;
}

bool are_one_path(const Figure& a, const Figure& b) {
    return !is_disc(a) && !is_disc(b) && a.thickness > 0 && a.thickness == b.thickness && a.dashes == b.dashes;
}

/// Writes the elements of marks one after the other.
class SvgElements {
public:
    explicit SvgElements(const Canvas& canvas) {
        canvas.draw_with([this](const auto& shape, const CanvasMark& mark) {
            group(mark.data.get());
            put(shape, mark);
        });
        group(nullptr);
        see({});
    }

    [[nodiscard]] const std::string& text() const { return text_; }

private:
    /// Begins the group of the marks that show this; null: marks that show nothing.
    void group(const MarkData* data) {
        if (data == data_) return;
        see({});
        if (data_ != nullptr) text_ += "</g>\n";
        data_ = data;
        if (data == nullptr) return;
        text_ += "<g data-keys=\"" + file::html(data->keys) + "\"";
        for (const auto& [name, places] : {std::pair("x", &data->x), {"y", &data->y}}) {
            std::string numbers;
            for (const double place : *places)
                numbers += (numbers.empty() ? "" : " ") + (std::isnan(place) ? "NaN" : number(place));
            if (!numbers.empty()) text_ += fmt::format(" data-{}=\"{}\"", name, numbers);
        }
        text_ += ">\n";
    }

    /// Cuts off marks outside of the box, until the next call; without a box, none.
    void see(const std::optional<PixelBox>& box) {
        if (box == seen_) return;
        if (seen_) text_ += "</svg>\n";
        seen_ = box;
        if (box)
            text_ += fmt::format(R"(<svg x="{0}" y="{1}" width="{2}" height="{3}" viewBox="{0} {1} {2} {3}">)", box->x,
                                 box->y, box->width, box->height) +
                     "\n";
    }

    void put(const CanvasMark::Fill& fill, const CanvasMark& mark) {
        see({});
        text_ += fmt::format("<path fill=\"{}\" d=\"", colour(mark.colour));
        for (const PixelBox& box : fill.boxes)
            text_ += fmt::format("M{} {}h{}v{}h-{}z", box.x, box.y, box.width, box.height, box.width);
        text_ += "\"/>\n";
    }

    void put(const CanvasMark::Line& line, const CanvasMark& mark) {
        see({});
        const TextBitmap& text = line.text;
        if (text.runs.empty()) return;
        text_ += "<text";
        if (text.turned)
            text_ += fmt::format(" transform=\"translate({} {})rotate(-90)\"", line.x, line.y + text.height);
        const auto place = [&](const TextRun& run) {
            // Letters of another font are set as wide as these.
            return fmt::format(" x=\"{}\" y=\"{}\" font-size=\"{}\" textLength=\"{}\"",
                               number(run.x + (text.turned ? 0 : line.x)), number(run.y + (text.turned ? 0 : line.y)),
                               run.size, number(run.width));
        };
        if (text.runs.size() == 1) text_ += place(text.runs.front());
        if (text.bold) text_ += " font-weight=\"bold\"";
        text_ += fmt::format(" fill=\"{}\">", colour(mark.colour));
        for (const TextRun& run : text.runs) {
            const std::string letters = file::html(run.text);
            text_ += text.runs.size() == 1 ? letters : fmt::format("<tspan{}>{}</tspan>", place(run), letters);
        }
        text_ += "</text>\n";
    }

    void put(const CanvasMark::Coat& coat, const CanvasMark& mark) {
        see(reaches_beyond(coat, mark.seen) ? std::optional(mark.seen) : std::nullopt);
        const std::string ink = colour(mark.colour);
        // A group blends figures that overlap once.
        if (coat.opacity < 1) text_ += fmt::format("<g opacity=\"{}\">", number(coat.opacity));
        for (auto figure = coat.figures.begin(); figure != coat.figures.end(); ++figure) {
            if (is_disc(*figure)) {
                text_ +=
                    fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{}\"/>\n", number(figure->points[0].x),
                                number(figure->points[0].y), number(figure->thickness / 2), ink);
                continue;
            }
            std::string path = path_through(figure->points);
            if (figure->thickness == 0) {
                text_ += fmt::format("<path fill=\"{}\" d=\"{}z\"/>\n", ink, path);
                continue;
            }
            for (; figure + 1 != coat.figures.end() && are_one_path(*figure, figure[1]); ++figure)
                path += path_through(figure[1].points);
            text_ += fmt::format("<path fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"{} d=\"{}\"/>\n", ink,
                                 number(figure->thickness), dashes_of(*figure), path);
        }
        if (coat.opacity < 1) text_ += "</g>\n";
    }

    static std::string dashes_of(const Figure& figure) {
        std::string lengths;
        for (const double length : figure.dashes) lengths += (lengths.empty() ? "" : " ") + number(length);
        return lengths.empty() ? "" : fmt::format(" stroke-dasharray=\"{}\"", lengths);
    }

    static bool reaches_beyond(const CanvasMark::Coat& coat, const PixelBox& box) {
        return std::ranges::any_of(coat.figures, [&box](const Figure& figure) {
            const double half = figure.thickness / 2;
            return std::ranges::any_of(figure.points, [&](const Point& p) {
                return p.x - half < box.x || p.y - half < box.y || p.x + half > box.x + box.width ||
                       p.y + half > box.y + box.height;
            });
        });
    }

    void put(const CanvasMark::Field& field, const CanvasMark& /*mark*/) {
        see({});
        text_ += fmt::format(
            "<image x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" preserveAspectRatio=\"none\" "
            "image-rendering=\"pixelated\" href=\"data:image/png;base64,{}\"/>\n",
            field.box.x, field.box.y, field.box.width, field.box.height,
            file::base64(image_backend().png_bytes(field.columns, field.rows(), field.samples)));
    }

    std::string text_;
    const MarkData* data_ = nullptr;
    std::optional<PixelBox> seen_ = {};
};

}  // namespace

std::string svg_text(const Canvas& canvas, const FileMetadata& words) {
    std::string about;
    for (const auto& [keyword, text] : words) about += fmt::format("{}: {}\n", keyword, file::html(text));
    return fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
        "font-family=\"DejaVu Sans, Verdana, sans-serif\" stroke-linecap=\"round\" stroke-linejoin=\"round\" "
        "xml:space=\"preserve\">\n{2}<rect width=\"{0}\" height=\"{1}\" fill=\"{3}\"/>\n{4}</svg>\n",
        canvas.width(), canvas.height(), about.empty() ? "" : fmt::format("<metadata>{}</metadata>\n", about),
        colour(canvas.paper()), SvgElements(canvas).text());
}

}  // namespace lostbits::output::image
