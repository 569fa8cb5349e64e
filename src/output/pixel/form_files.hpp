// Files that receive the bands of one tested form (a form in a format): strips of pictures, lines of a table of pixels,
// rows of an EXR.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "output/pixel/columns.hpp"
#include "output/table/table.hpp"

namespace lostbits::output::pixel {

/// Rows of a part of an EXR, as stored in the file.
struct ExrScanlines {
    std::uint64_t part = 0;
    int y0 = 0, rows = 0;
    std::vector<std::uint32_t> samples;
};

template <class Archive>
void fields(Archive& archive, ExrScanlines& piece) {
    auto& [part, y0, rows, samples] = piece;
    archive(part, y0, rows, samples);
}

/// Everything that the files receive from one band of a tested form. A shard stores the piece; other runs write it.
struct Piece {
    int y0 = 0;
    std::vector<Strip> strips = {};  ///< strips of the pictures that are drawn, in the pictures' order
    std::vector<ExrScanlines> exr = {};
    std::string lines = {};  ///< lines of the table of pixels

    [[nodiscard]] bool is_empty() const { return strips.empty() && exr.empty() && lines.empty(); }
};

template <class Archive>
void fields(Archive& archive, Piece& piece) {
    auto& [y0, strips, exr, lines] = piece;
    archive(y0, strips, exr, lines);
}

/// Receives the pieces of each row in place of the files, which are then not opened.
using PieceReceiver = std::function<void(std::size_t form_index, Piece&& piece)>;

/// Files that the rows of a scene share.
template <class Band>
struct BandFiles {
    PictureWriter<Band>& pictures;
    std::function<void(const std::vector<ExrScanlines>&)> write_exr;  ///< empty: no EXR is written
    const PieceReceiver& receive_piece;                               ///< receives the pieces of a shard
};

/// Files of one tested form. `Pixel` is the record of a row of the table of pixels.
template <class Band, class Pixel>
class FormFilesWriter {
public:
    struct Functions {
        /// Turns a band into rows of the EXR; empty: the run writes no EXR.
        std::function<std::vector<ExrScanlines>(const Band&, std::span<const image::Rgb8> preview)> exr_scanlines = {};
        /// Adds pixel i to the table; empty: the run writes no table.
        std::function<void(table::TableFile<Pixel>&, const Band&, std::size_t i)> add_pixel = {};
        std::size_t (*pixels)(const Band&);  ///< the number of pixels of a band
    };
    FormFilesWriter(std::size_t form_index, const BandFiles<Band>& files, Functions functions,
                    std::unique_ptr<table::TableFile<Pixel>> table)
        : form_index_(form_index), files_(files), functions_(std::move(functions)), table_(std::move(table)) {}

    void add_band(const Band& result) {
        const std::size_t pixels = functions_.pixels(result);
        Piece piece{.y0 = result.y0, .strips = files_.pictures.draw(form_index_, result, pixels)};
        if (functions_.exr_scanlines)
            piece.exr = functions_.exr_scanlines(
                result, piece.strips.empty() ? std::span<const image::Rgb8>() : piece.strips[0].colours);
        for (std::size_t i = 0; table_ && i < pixels; ++i) functions_.add_pixel(*table_, result, i);
        if (table_ && files_.receive_piece) piece.lines = table_->take_lines();
        if (files_.receive_piece) files_.receive_piece(form_index_, std::move(piece));
        else write_piece(piece);
    }

    void write_piece(const Piece& piece) {
        files_.pictures.write_strips(form_index_, piece.y0, piece.strips);
        if (files_.write_exr) files_.write_exr(piece.exr);
        if (table_) table_->add_lines(piece.lines);
    }

    /// Table of the pixels; null if the run writes no such table.
    [[nodiscard]] std::unique_ptr<table::TableFile<Pixel>>& table() { return table_; }

private:
    std::size_t form_index_;
    BandFiles<Band> files_;
    Functions functions_;
    std::unique_ptr<table::TableFile<Pixel>> table_;
};

}  // namespace lostbits::output::pixel
