// Files of judged rays: the files of a map, worst.toml with the rays that deserve a second look, and one row per ray
// as CSV.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "measure/judge/judge.hpp"
#include "measure/judge/worst_rays.hpp"
#include "output/map/map_exr.hpp"

namespace lostbits::output::judge {

using measure::judge::WorstRays;

struct JudgeWriterOptions {
    std::filesystem::path folder;
    std::string id, title;
    std::string command;  ///< the command that finds the worst rays again
    /// Metrics on sheets; empty: the rays are no picture.
    std::vector<const measure::metric::Metric*> drawn_metrics = {};
    bool draws_single_pictures = false;    ///< also each picture of a sheet alone
    bool writes_rows = false;              ///< one row per ray in `<form>.<format>.csv`
    std::size_t worst_count = 10;          ///< number of rays of each kind that worst.toml holds
    pixel::PieceReceiver keep_piece = {};  ///< receives the pieces of a shard
};

/// Opens every file before any work and gives all files their final names in `finish`.
class JudgeWriter {
public:
    /// All three arguments must outlive the object.
    JudgeWriter(const measure::judge::JudgeRequest& request, const scene::ray_file::RayFile& ray_file,
                JudgeWriterOptions options);
    ~JudgeWriter();
    JudgeWriter(const JudgeWriter&) = delete;
    JudgeWriter& operator=(const JudgeWriter&) = delete;

    /// Adds the next judged rays of a tested form (a form in a format). `form_index` is its index in the request.
    void add_piece(std::size_t form_index, const scene::ray_file::Chunk& chunk,
                   const measure::evaluate::BandResult& result);
    /// Writes the next piece of a tested form, which another run kept.
    void put(std::size_t form_index, pixel::Piece&& piece);
    /// Worst rays of each tested form. `append` adds the worst rays that another run found among later rays of the
    /// file.
    [[nodiscard]] std::vector<WorstRays> worst() const;
    void append(std::vector<WorstRays>&& later_rays);
    /// Gives all files their final names. Returns true if it wrote a worst.toml, that is, if some rays deserve a second
    /// look.
    bool finish(const measure::judge::JudgeResult& result);

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace lostbits::output::judge
