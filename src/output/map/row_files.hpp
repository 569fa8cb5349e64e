// Files that take the bands of one row of a map, or of the bits needed by one form.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "output/map/map_exr.hpp"
#include "output/pixel/columns.hpp"
#include "output/table/table.hpp"

namespace lostbits::output::map {

inline std::size_t pixels_of(const measure::evaluate::BandResult& band) { return band.outcomes.size(); }
inline std::size_t pixels_of(const measure::evaluate::NeededBand& band) { return band.needed.size(); }

/// Files that the rows of a scene share.
template <class Band>
struct BandFiles {
    pixel::ColumnFiles<Band>& pictures;
    MapExr* exr;            ///< null: no EXR is written
    const KeepPiece& keep;  ///< receives the pieces of a shard
};

/// `Pixel` is the record of a row of the table of pixels.
template <class Band, class Pixel>
class RowFiles {
public:
    /// Functions that turn a band into rows of the EXR, and a pixel into a row of the table.
    struct Writers {
        std::function<std::vector<ExrRows>(const Band&, std::span<const image::Rgb8> preview)> exr_rows;
        std::function<Pixel(const Band&, std::size_t i)> pixel;
    };
    RowFiles(std::size_t row, const BandFiles<Band>& files, Writers writers,
             std::unique_ptr<table::TableFile<Pixel>> table)
        : row_(row), files_(files), writers_(std::move(writers)), table_(std::move(table)) {}

    void band(const Band& result) {
        const std::size_t pixels = pixels_of(result);
        MapPiece piece{.y0 = result.y0, .strips = files_.pictures.draw(row_, result, pixels)};
        if (files_.exr)
            piece.exr = writers_.exr_rows(
                result, piece.strips.empty() ? std::span<const image::Rgb8>() : piece.strips[0].colours);
        for (std::size_t i = 0; table_ && i < pixels; ++i) table_->add(writers_.pixel(result, i));
        if (table_ && files_.keep) piece.lines = table_->take_lines();
        if (files_.keep) files_.keep(row_, std::move(piece));
        else put(piece);
    }

    void put(const MapPiece& piece) {
        files_.pictures.put(row_, piece.y0, piece.strips);
        if (files_.exr) files_.exr->write(piece.exr);
        if (table_) table_->add_lines(piece.lines);
    }

    /// Table of the pixels; null if there is none.
    [[nodiscard]] std::unique_ptr<table::TableFile<Pixel>>& table() { return table_; }

private:
    std::size_t row_;
    BandFiles<Band> files_;
    Writers writers_;
    std::unique_ptr<table::TableFile<Pixel>> table_;
};

}  // namespace lostbits::output::map
