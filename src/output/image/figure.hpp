// Files of a drawing: PNG, SVG or PDF, as the run asked for with `--figure`.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "output/file/atomic_file.hpp"
#include "output/image/canvas.hpp"
#include "output/image/image.hpp"

namespace lostbits::output::image {

/// The files of one drawing, opened at once like AtomicFile: one of each kind, by default the kinds of pictures in the
/// folder (`file::figure_kinds`). `path` ends in .png; a file of another kind has that ending instead.
class FigureWriter {
public:
    explicit FigureWriter(const std::filesystem::path& path);
    FigureWriter(const std::filesystem::path& path, const std::vector<std::string>& kinds);

    /// Writes every file and gives it its final name. Throws EnvironmentError, and std::logic_error for a drawing
    /// without pixels.
    void save(const Canvas& canvas);

private:
    std::vector<std::unique_ptr<file::AtomicFile>> files_;
};

/// Opens and writes the files of a drawing.
void save_figure(const std::filesystem::path& path, const Canvas& canvas);

/// Paths of the files of a drawing, to print them or to link to one.
[[nodiscard]] std::vector<std::filesystem::path> figure_paths(const std::filesystem::path& path);

/// The drawing as an SVG with `metadata`. Its text stays text, in DejaVu Sans if the viewer has that font. A field is
/// an embedded PNG.
[[nodiscard]] std::string svg_text(const Canvas& canvas, const FileMetadata& metadata = {});

}  // namespace lostbits::output::image
