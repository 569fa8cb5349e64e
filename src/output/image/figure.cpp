#include "output/image/figure.hpp"

#include "output/file/result_folder.hpp"

namespace lostbits::output::image {

namespace fs = std::filesystem;

FigureWriter::FigureWriter(const fs::path& path) : FigureWriter(path, file::figure_kinds(path)) {}

FigureWriter::FigureWriter(const fs::path& path, const std::vector<std::string>& kinds) {
    for (const std::string& kind : kinds)
        files_.push_back(std::make_unique<file::AtomicFile>(fs::path(path).replace_extension(kind)));
}

void FigureWriter::save(const Canvas& canvas) {
    for (auto& file : files_) {
        const fs::path path = file->path();
        const std::string kind = path.extension().string();
        if (kind == ".png") {
            const auto png = image_backend().open_png(std::move(file), canvas.width(), canvas.height());
            png->write_rows(canvas.height(), canvas.pixels());
            png->close();
            continue;
        }
        if (kind == ".pdf") image_backend().write_pdf(*file, canvas, metadata_of(path));
        else file->write(svg_text(canvas, metadata_of(path)));
        file->commit();
    }
}

void save_figure(const fs::path& path, const Canvas& canvas) { FigureWriter(path).save(canvas); }

std::vector<fs::path> figure_paths(const fs::path& path) {
    std::vector<fs::path> paths;
    for (const std::string& kind : file::figure_kinds(path)) paths.push_back(fs::path(path).replace_extension(kind));
    return paths;
}

}  // namespace lostbits::output::image
