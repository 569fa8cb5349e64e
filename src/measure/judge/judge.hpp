// A file of rays under test: the answers in it, and what forms answer to the same rays, against one truth.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "measure/contract/suspect.hpp"
#include "measure/evaluate/evaluate.hpp"
#include "measure/evaluate/groups.hpp"
#include "scene/dump/dump.hpp"
#include "scene/rays/solid_list.hpp"

namespace lostbits::measure::judge {

/// The answers of a file as a row of the work: a name and a contract, and nothing that could be asked.
class FileForm {
public:
    /// Called `file.NAME`, of which a letter that no file name should have becomes `_`. `info` is the contract: its
    /// texts are not read, and a file without a t has `Roots::none`.
    FileForm(const std::string& name, Shape shape, const intersect::Info& info);
    FileForm(const FileForm&) = delete;
    FileForm& operator=(const FileForm&) = delete;
    [[nodiscard]] const intersect::table::Intersector& form() const { return form_; }

private:
    std::string name_;
    intersect::Info info_;
    intersect::table::Intersector form_;
};

struct JudgeRequest {
    /// Of all rays, numbers of the dump's format; each ray has its own where there are none, and no mesh.
    std::vector<Solid<double>> solids = {};
    std::shared_ptr<const scene::rays::MeshColumns> mesh = {};  ///< whose triangles come after these; null: none
    std::optional<intersect::MarchConstants<double>> march = {};
    std::vector<evaluate::TestedForm> rows = {};
    const intersect::table::Intersector* file_form = nullptr;  ///< of the row of the file's answers; null: it has none
    std::vector<const metric::Metric*> metrics = {};
    std::optional<std::pair<int, int>> picture = {};  ///< columns and rows; absent: the rays are a list
    /// Of the columns that the dump keeps, the place of the one by whose values rays are grouped too.
    std::optional<std::size_t> by = {};
    truth::TruthLimit limit = {};
    truth::StageCounts* stages = nullptr;  ///< where they are added up; null: nowhere
    /// The pieces of the file that are measured, see `count_pieces`; absent: all.
    std::optional<shard::Units> pieces = {};
    /// Called with the number of rays, and of bytes of the file, that are done since the last call; may throw to stop.
    std::function<void(std::uint64_t rays, std::uint64_t bytes)> progress = [](std::uint64_t, std::uint64_t) {};

    [[nodiscard]] bool is_of_file(const evaluate::TestedForm& row) const { return row.form == file_form; }
    /// The place of the row of the file's answers, if there is one.
    [[nodiscard]] std::optional<std::size_t> file_place() const;
};

/// Is shown what is found of some rays by a row, with what the file has of them: each row's in order, different rows at
/// the same time.
using ShowJudged =
    std::function<void(std::size_t row, const scene::dump::Chunk& chunk, const evaluate::BandResult& result)>;

struct JudgeResult {
    std::vector<evaluate::FormSummary> summaries;  ///< one a row
    std::uint64_t rays = 0;
    std::uint64_t rounded = 0;  ///< numbers of the file that its format does not hold
    /// Answers of the file with a t that is not 0, and those whose t is a number of binary32 or a decimal of one: all
    /// of many, where they were computed in it. The latter are counted until one is neither.
    std::uint64_t answers = 0, floats = 0;
    int digits = 0;              ///< the most that a decimal has which is not exactly a number of the format
    std::uint64_t decimals = 0;  ///< so many of those there are
    /// What the file's answers and the truth make of the first rays that either has a hit on, for
    /// `contract::suspicion`.
    std::vector<contract::Judged> first = {};
    evaluate::Groups groups = {};  ///< where the request has a column for them

    /// What is known of the pieces that come next.
    void append(JudgeResult&& after);
    /// So many rays the file rightly misses, by its summary, for as many as `first` holds.
    [[nodiscard]] std::uint64_t misses_beside_first(const evaluate::FormSummary& file) const;
    /// Whether `first` has every ray that the file, of this summary, or the truth has a hit on.
    [[nodiscard]] bool first_are_all(const evaluate::FormSummary& file) const;
};

/// In how many pieces the file is measured: they are cut by the request's picture and the file alone. Reads it to its
/// end.
std::uint64_t count_pieces(scene::dump::Dump& dump, const JudgeRequest& request);

/// InputError where all that is known of the file is not of the rays of a picture, or of none.
void check_whole(const scene::dump::Dump& dump, const JudgeRequest& request, const JudgeResult& result);

/// Reads the dump to its end, or to that of its pieces. Memory does not grow with the file, and nothing depends on the
/// number of threads: pieces are cut by their rays alone and taken up in order. InputError, with the place, for what
/// the dump refuses, where the rays are not those of the picture, and for too many groups.
JudgeResult run_judge(scene::dump::Dump& dump, const JudgeRequest& request, const ShowJudged& show = {});

}  // namespace lostbits::measure::judge
