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

/// Passes the pieces of a job's rows in all shards to its files, and adds up the summaries.
template <class Files, class Summary>
void join_into(Files& files, std::vector<Summary>& all, measure::truth::StageCounts& stages, Division& division,
               const std::string& job) {
    division.each(job, [&](output::shard::BitReader& bits) {
        if (joined_piece(bits, files)) return;
        std::vector<Summary> part;
        measure::truth::StageCounts of_part;
        bits(part, of_part);
        stages += of_part;
        if (all.empty()) all = std::move(part);
        else
            for (std::size_t r = 0; r < all.size(); ++r) all[r].append(std::move(part.at(r)));
    });
}

/// Measures a study, or a part of it in a shard, or joins what shards found. Returns nothing in a shard, which keeps
/// its part. `files` take the pieces of the rows.
template <measure::study::Study S, class Files>
std::optional<std::vector<typename S::Summary>> run_divided(S study, Files& files, Division& division,
                                                            const std::string& job) {
    if (!division.joins() && !division.is_shard()) return measure::study::run_study(study, files.show());
    if (division.is_shard()) {
        study.share = division.share();
        division.put(job, RecordKind::end, measure::study::run_share(study, files.show()));
        return std::nullopt;
    }
    auto all = measure::study::begin_all(study);
    division.each(job, [&](output::shard::BitReader& bits) {
        if (joined_piece(bits, files)) return;
        std::vector<typename S::Summary> part;
        bits(part);
        measure::study::add_up(all, std::move(part));
    });
    measure::study::seal_all(all);
    return all;
}

}  // namespace lostbits::analysis::shard
