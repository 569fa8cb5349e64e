// The EXR of a scene's map: every value that the pictures were made of, a part a row.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "measure/evaluate/evaluate.hpp"
#include "measure/evaluate/needed.hpp"
#include "output/image/colour.hpp"
#include "output/image/exr_book.hpp"
#include "output/pixel/columns.hpp"
#include "output/pixel/exr_layers.hpp"

namespace lostbits::output::map {

/// What is written and how it was asked for.
struct MapExrRequest {
    const measure::evaluate::EvaluationRequest& map;
    std::vector<const measure::metric::Metric*> layers;        ///< of the map's metrics
    std::string command;                                       ///< what to type to make the file again
    const measure::evaluate::NeededRequest* needed = nullptr;  ///< null where bits needed are not asked for
};

/// What a part takes of a band; all its pixels have a preview.
template <class Result>
struct Previewed {
    const Result* result;
    std::span<const image::Rgb8> preview;
};
using MapStrip = Previewed<measure::evaluate::BandResult>;
using NeededStrip = Previewed<measure::evaluate::NeededBand>;

/// Rows of a part, as the file has them.
struct ExrRows {
    std::uint64_t part = 0;
    int y0 = 0, rows = 0;
    std::vector<std::uint32_t> samples;
};

template <class Bits>
void fields(Bits& bits, ExrRows& piece) {
    auto& [part, y0, rows, samples] = piece;
    bits(part, y0, rows, samples);
}

/// Parts, in this order, all channels of 32 bits:
/// - `<form>.<format>`, one a row: `R`, `G`, `B` (the heatmap in linear light); the answer t (below); `class.outcome`,
///   `class.object` (UINT; 0 is none, otherwise 1 + the number of the solid, counted from 0); one FLOAT channel a
///   metric, NaN where it does not exist. The attribute `lostbits:truth` names the part with the row's truth.
/// - `truth…`, one for each way of the rows to ask: t* correctly rounded to binary64, `class.truth` (UINT: 0 miss, 1
///   hit, 2 unresolved), `class.truth_object`. In `truth.distance` t* is a distance, for unit-direction forms.
/// - `<form>.needed`: `R`, `G`, `B`, `bits.needed` (FLOAT: 2 to 53, infinity where not even 53 suffice, NaN where the
///   truth is unresolved), `class.truth`, `class.truth_object`.
/// A number x is `x.hi` (FLOAT); and where its format is not within binary32 also `x.lo` (hi + lo is good to 48 bits,
/// for viewers), `x.word1` and `x.word0` (UINT, the high and low halves of the binary64, exact).
class MapExr {
public:
    /// Without a path there is no file: `rows_of` alone may be asked.
    MapExr(const std::filesystem::path& path, const MapExrRequest& request);
    ~MapExr();
    MapExr(const MapExr&) = delete;
    MapExr& operator=(const MapExr&) = delete;

    /// What the file has of a band of a row of the map, its truth where no other row has it; or of a form of the bits
    /// needed.
    [[nodiscard]] std::vector<ExrRows> rows_of(const measure::evaluate::TestedForm& row,
                                               const measure::evaluate::BandResult& result,
                                               std::span<const image::Rgb8> preview) const;
    [[nodiscard]] std::vector<ExrRows> rows_of(const measure::evaluate::NeededBand& result,
                                               std::span<const image::Rgb8> preview) const;
    /// The next rows of their parts. Parts may be served at the same time.
    void write(const std::vector<ExrRows>& pieces);
    void close();

private:
    struct Row {
        const measure::evaluate::TestedForm* row;
        pixel::ExrLayers<MapStrip> layers;
    };
    struct Truths;
    std::vector<Row> rows_;
    std::vector<Truths> truths_;
    std::vector<const intersect::Info*> needed_;
    std::unique_ptr<image::ExrBook> book_;
};

/// What the files of a map take of a band of one of its rows, or of a form of the bits needed: what a shard keeps, and
/// what is written where there are none.
struct MapPiece {
    int y0 = 0;
    std::vector<pixel::Strip> strips = {};  ///< of each picture that is drawn, in their order
    std::vector<ExrRows> exr = {};
    std::string lines = {};  ///< of the table of pixels

    [[nodiscard]] bool is_empty() const { return strips.empty() && exr.empty() && lines.empty(); }
};

template <class Bits>
void fields(Bits& bits, MapPiece& piece) {
    auto& [y0, strips, exr, lines] = piece;
    bits(y0, strips, exr, lines);
}

/// Takes the pieces of each row in place of the files, of which none is opened then.
using KeepPiece = std::function<void(std::size_t row, MapPiece&& piece)>;

}  // namespace lostbits::output::map
