// The files of judged rays: what a map writes, worst.toml with the rays to look at again, and one row per ray as CSV.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "measure/judge/judge.hpp"
#include "measure/judge/worst_rays.hpp"
#include "output/map/map_exr.hpp"

namespace lostbits::output::judge {

struct JudgeFilesOptions {
    std::filesystem::path folder;
    std::string id, title;
    std::string command;                                     ///< what to type to find the worst rays again
    std::vector<const measure::metric::Metric*> drawn = {};  ///< on sheets; empty: the rays are no picture
    bool singles = false;                                    ///< also each picture of a sheet alone
    bool rows = false;                                       ///< one row per ray in `<form>.<format>.csv`
    std::size_t worst = 10;                                  ///< so many rays of each kind go into worst.toml
    map::KeepPiece keep = {};                                ///< of a shard
};

/// Opens every file before any work and gives all their final names in `finish`, as `MapFiles` does.
class JudgeFiles {
public:
    /// All three outlive it.
    JudgeFiles(const measure::judge::JudgeRequest& request, const scene::dump::Dump& dump, JudgeFilesOptions options);
    ~JudgeFiles();
    JudgeFiles(const JudgeFiles&) = delete;
    JudgeFiles& operator=(const JudgeFiles&) = delete;

    /// The next rays of a row.
    void piece(std::size_t row, const scene::dump::Chunk& chunk, const measure::evaluate::BandResult& result);
    /// The next piece of a row, as another run kept it.
    void put(std::size_t row, map::MapPiece&& piece);
    /// Of each row; and what another run found in the rays that come next.
    [[nodiscard]] std::vector<measure::judge::WorstRays> worst() const;
    void append(std::vector<measure::judge::WorstRays>&& after);
    /// Whether there is a worst.toml: rays that are worth a second look.
    bool finish(const measure::judge::JudgeResult& result);

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace lostbits::output::judge
