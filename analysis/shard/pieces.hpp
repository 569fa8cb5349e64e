// The records of shards of a study, a map or a judgement: pieces of the files of rows, and the summaries at the end.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "analysis/shard/division.hpp"
#include "measure/study/study.hpp"
#include "output/pixel/row_files.hpp"

namespace lostbits::analysis::shard {

/// The kind of a record: a piece of a row's files, or the summaries at the end.
enum class RecordKind : std::uint8_t { piece, end };

/// A function that records the pieces of a job's rows in a shard; empty in other runs.
inline output::pixel::KeepPiece keep_in(Division& division, const std::string& job) {
    if (!division.is_shard()) return {};
    return [&division, job](std::size_t row, output::pixel::Piece&& piece) {
        if (!piece.is_empty()) division.put(job, RecordKind::piece, std::uint64_t{row}, piece);
    };
}

/// Passes a piece to its row's files. Returns false if the record is not a piece but the summaries.
template <class Files>
bool joined_piece(output::shard::BitReader& bits, Files& files) {
    RecordKind kind{};
    bits(kind);
    if (kind == RecordKind::end) return false;
    std::uint64_t row = 0;
    output::pixel::Piece piece;
    bits(row, piece);
    files.put(row, std::move(piece));
    return true;
}

/// The result of a job that writes files: what `measure` returns, or the sum of what shards found. Returns nothing in a
/// shard, which records its part. `none` is the result of no work. `files` take the pieces of the rows that shards
/// kept.
template <class Result, class Files, class Measure>
std::optional<Result> result_with_files(Result none, Files& files, Division& division, const std::string& job,
                                        const Measure& measure) {
    if (!division.joins()) {
        Result here = measure();
        if (!division.is_shard()) return here;
        division.put(job, RecordKind::end, here);
        return std::nullopt;
    }
    division.each(job, [&](output::shard::BitReader& bits) {
        if (joined_piece(bits, files)) return;
        Result part;
        bits(part);
        measure::study::add_up(none, std::move(part));
    });
    return none;
}

/// Findings of a study: a summary of each row, and how many truths each stage settled.
template <class Summary>
struct StudyResult {
    std::vector<Summary> rows;
    measure::truth::StageCounts stages = {};
};
template <class Bits, class Summary>
void fields(Bits& bits, StudyResult<Summary>& found) {
    auto& [rows, stages] = found;
    bits(rows, stages);
}

/// Measures a study, or a part of it in a shard, or joins what shards found. Returns nothing in a shard, which keeps
/// its part. `files` take the pieces of the rows. A study with `stages` gets the counts of all parts there.
template <measure::study::Study S, class Files>
std::optional<std::vector<typename S::Summary>> run_divided(S study, Files& files, Division& division,
                                                            const std::string& job) {
    using Result = StudyResult<typename S::Summary>;
    study.share = division.share();
    std::optional<Result> found =
        result_with_files(Result{measure::study::begin_all(study)}, files, division, job, [&] {
            Result here{measure::study::run_share(study, files.show())};
            if constexpr (requires { here.stages = *study.stages; }) here.stages = *study.stages;
            return here;
        });
    if (!found) return std::nullopt;
    if constexpr (requires { *study.stages = found->stages; }) *study.stages = found->stages;
    measure::study::seal_all(found->rows);
    return std::move(found->rows);
}

}  // namespace lostbits::analysis::shard
