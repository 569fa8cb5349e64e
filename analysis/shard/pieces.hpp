// The records of shards of a study, a map or a judgement: pieces of the files of rows, and the summaries at the end.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "analysis/shard/division.hpp"
#include "measure/study/study.hpp"
#include "output/pixel/form_files.hpp"

namespace lostbits::analysis::shard {

/// The kind of a record: a piece of a row's files, or the summaries at the end.
enum class RecordKind : std::uint8_t { piece, end };

/// Returns a function that records the pieces of a job's rows in a shard; an empty function in other runs.
inline output::pixel::PieceReceiver piece_recorder(Division& division, const std::string& job) {
    if (!division.is_shard()) return {};
    return [&division, job](std::size_t form_index, output::pixel::Piece&& piece) {
        if (!piece.is_empty()) division.put(job, RecordKind::piece, std::uint64_t{form_index}, piece);
    };
}

/// Passes a piece to its row's files. Returns false if the record is not a piece but the summaries.
template <class Files>
bool pass_piece(output::shard::BitReader& bits, Files& files) {
    RecordKind kind{};
    bits(kind);
    if (kind == RecordKind::end) return false;
    std::uint64_t row = 0;
    output::pixel::Piece piece;
    bits(row, piece);
    files.put(row, std::move(piece));
    return true;
}

/// Does a job that writes files, as the kind of run requires:
///
/// - A whole run returns the result of `measure`.
/// - A shard records the result of `measure` and returns nothing.
/// - A run that joins shards does not call `measure`. It passes the pieces that the shards recorded to `files`, and
///   returns the sum of the recorded results.
///
/// `sum` begins as the result of no work.
template <class Result, class Files, class Measure>
std::optional<Result> result_with_files(Result sum, Files& files, Division& division, const std::string& job,
                                        const Measure& measure) {
    if (!division.joins()) {
        Result result = measure();
        if (!division.is_shard()) return result;
        division.put(job, RecordKind::end, result);
        return std::nullopt;
    }
    division.for_each_record(job, [&](output::shard::BitReader& bits) {
        if (pass_piece(bits, files)) return;
        Result part;
        bits(part);
        measure::study::add_up(sum, std::move(part));
    });
    return sum;
}

/// Findings of a study: a summary of each row, and how many truths each stage settled.
template <class Summary>
struct StudyResult {
    std::vector<Summary> rows;
    measure::truth::StageCounts stages = {};
};
template <class Archive, class Summary>
void fields(Archive& archive, StudyResult<Summary>& study_result) {
    auto& [rows, stages] = study_result;
    archive(rows, stages);
}

/// Measures a study, and passes the pieces of its rows to `files`. A shard measures and records its part and returns
/// nothing; a run that joins shards adds up their parts. A study with `stages` gets the counts of all parts there.
template <measure::study::Study S, class Files>
std::optional<std::vector<typename S::Summary>> run_divided(S study, Files& files, Division& division,
                                                            const std::string& job) {
    using Result = StudyResult<typename S::Summary>;
    study.share = division.share();
    std::optional<Result> study_result =
        result_with_files(Result{measure::study::empty_summaries(study)}, files, division, job, [&] {
            Result result{measure::study::run_share(study, files.show())};
            if constexpr (requires { result.stages = *study.stages; }) result.stages = *study.stages;
            return result;
        });
    if (!study_result) return std::nullopt;
    if constexpr (requires { *study.stages = study_result->stages; }) *study.stages = study_result->stages;
    measure::study::seal_all(study_result->rows);
    return std::move(study_result->rows);
}

}  // namespace lostbits::analysis::shard
