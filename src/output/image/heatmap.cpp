// Streams heatmaps into PNG files, and draws them for the other kinds of files.
#include "output/image/heatmap.hpp"

#include <algorithm>
#include <stdexcept>

#include "output/file/result_folder.hpp"

namespace lostbits::output::image {
namespace {

/// A field with fewer samples across is enlarged.
constexpr int min_width = 384;
/// An enlarged field has at most this many pixels down.
constexpr int max_enlarged_height = 2048;

/// Factor by which a field is enlarged.
int enlargement_for(int width, int height) {
    if (width >= min_width) return 1;
    return std::max(1, std::min((min_width + width - 1) / width, max_enlarged_height / height));
}

}  // namespace

HeatmapWriter::HeatmapWriter(const std::filesystem::path& path, HeatmapSpec spec) : spec_(std::move(spec)) {
    if (spec_.width <= 0 || spec_.height <= 0) throw std::logic_error(path.string() + ": a field without samples");

    // Sizes of the field with its frame, and of the bar beside it.
    enlargement_ = enlargement_for(spec_.width, spec_.height);
    field_width_ = spec_.width * enlargement_;
    field_height_ = spec_.height * enlargement_;
    body_height_ = field_height_ + 2;  // the frame
    int content_width = field_width_ + 2;
    if (spec_.scale) {
        bar_ = colour_bar(*spec_.scale, spec_.bar_label,
                          std::clamp(body_height_, style::min_bar_height, style::max_bar_height));
        content_width += style::gap + bar_.width();
        body_height_ = std::max(body_height_, bar_.height());
    }
    content_width = std::max(content_width, style::min_content_width);
    canvas_width_ = content_width + 2 * style::margin;

    // The head of the page is drawn now, and the foot at the end.
    const Canvas head = heading(spec_.title, spec_.subtitle, content_width);
    legend_.emplace(spec_.legend, content_width);
    caption_lines_ =
        static_cast<int>(wrap_text(spec_.widest_caption, style::text_size, FontWeight::regular, content_width).size());
    const int head_height = style::margin + head.height() + (head.height() > 0 ? style::gap : 0);
    head_ = Canvas(canvas_width_, head_height);
    head_.draw_canvas(style::margin, style::margin, head);

    auto kinds = file::figure_kinds(path);
    const bool has_png = std::erase(kinds, "png") > 0;
    if (!kinds.empty()) other_figure_writer_ = std::make_unique<FigureWriter>(path, kinds);
    if (!has_png) return;

    // A PNG is written row by row, beginning with the head and the upper line of the frame.
    png_ = image_backend().open_png(path, canvas_width_, head_height + body_height_ + foot_height());
    png_->write_rows(head_.height(), head_.pixels());
    bar_pixels_ = bar_.pixels();
    const std::vector<Rgb8> frame_row(static_cast<std::size_t>(spec_.width), style::line);
    write_body_row(frame_row);
}

void HeatmapWriter::write_body_row(std::span<const Rgb8> samples) {
    canvas_row_.assign(static_cast<std::size_t>(canvas_width_), style::background);
    auto out = canvas_row_.begin() + style::margin;
    if (!samples.empty()) {
        *out++ = style::line;
        if (enlargement_ == 1) out = std::ranges::copy(samples, out).out;
        else
            for (const Rgb8 sample : samples) out = std::fill_n(out, enlargement_, sample);
        *out++ = style::line;
    } else {
        out += field_width_ + 2;
    }

    if (body_y_ < bar_.height())
        std::copy_n(bar_pixels_.begin() + std::ptrdiff_t{body_y_} * bar_.width(), bar_.width(), out + style::gap);
    png_->write_rows(1, canvas_row_);
    ++body_y_;
}

void HeatmapWriter::write_rows(std::span<const Rgb8> samples) {
    const auto width = static_cast<std::size_t>(spec_.width);
    if (samples.size() % width != 0) throw std::logic_error("heatmap: an incomplete row");
    if (samples.size() / width > static_cast<std::size_t>(spec_.height - written_rows_)) {
        throw std::logic_error("heatmap: more rows than the field has");
    }
    if (other_figure_writer_) field_.insert(field_.end(), samples.begin(), samples.end());
    for (; !samples.empty(); samples = samples.subspan(width)) {
        for (int i = 0; i < enlargement_ && png_; ++i) write_body_row(samples.first(width));
        ++written_rows_;
    }
}

int HeatmapWriter::foot_height() const {
    const int legend_height = legend_->height() > 0 ? style::gap + legend_->height() : 0;
    return legend_height + caption_height() + style::margin;
}

int HeatmapWriter::caption_height() const {
    return caption_lines_ > 0 ? style::gap + caption_lines_ * style::line_height(style::text_size) : 0;
}

void HeatmapWriter::finish(std::span<const LegendEntry> legend, std::string_view caption) {
    if (written_rows_ != spec_.height) throw std::logic_error("heatmap: rows are missing");

    Canvas foot(canvas_width_, foot_height());
    const auto lines = wrap_text_into(caption, style::text_size, canvas_width_ - 2 * style::margin,
                                      static_cast<std::size_t>(caption_lines_));
    for (std::size_t i = 0; i < lines.size(); ++i)
        foot.text(style::margin, style::gap + static_cast<int>(i) * style::line_height(style::text_size), lines[i],
                  style::ink);
    foot.draw_canvas(style::margin, style::gap + caption_height(), legend_->draw(legend));
    if (other_figure_writer_) save_other_files(foot);
    if (!png_) return;

    // The lower line of the frame, empty rows beside a longer bar, and the foot.
    const std::vector<Rgb8> frame_row(static_cast<std::size_t>(spec_.width), style::line);
    write_body_row(frame_row);
    while (body_y_ < body_height_) write_body_row({});
    png_->write_rows(foot.height(), foot.pixels());
    png_->close();
}

void HeatmapWriter::save_other_files(const Canvas& foot) {
    Canvas canvas(canvas_width_, head_.height() + body_height_ + foot.height());
    canvas.draw_canvas(0, 0, head_);
    const PixelBox box{style::margin + 1, head_.height() + 1, field_width_, field_height_};
    canvas.frame(box.x, box.y, box.width, box.height, style::line);
    canvas.field(box, spec_.width, std::move(field_));
    canvas.draw_canvas(box.x + field_width_ + 1 + style::gap, head_.height(), bar_);
    canvas.draw_canvas(0, head_.height() + body_height_, foot);
    other_figure_writer_->save(canvas);
}

}  // namespace lostbits::output::image
