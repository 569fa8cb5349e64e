// Files of judged answers about the whole surface of a mesh: summary.csv, the first ray of each fault, and one row per
// ray.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "measure/judge/mesh_answers.hpp"
#include "output/table/table.hpp"

namespace lostbits::output::judge {

using measure::judge::JudgedAnswer;
using measure::judge::MeshAnswersResult;
using scene::ray_file::AnswerKind;

struct MeshAnswerWriterOptions {
    std::filesystem::path folder;
    std::string name;    ///< name of the file of answers
    std::string format;  ///< format in which the answers were computed
    std::string title;
    AnswerKind kind;
    bool writes_rows = false;  ///< one row per ray or point in `<name>.<format>.csv`
};

/// Row of summary.csv: the result for one file of answers.
struct MeshSummaryRow {
    std::string name, format;
    const MeshAnswersResult* result;
};
/// Columns of summary.csv for answers of this kind. The C and Python interfaces return the same columns.
table::Table<MeshSummaryRow> make_mesh_summary_table(AnswerKind kind);

/// A fault and the first ray or point that has it.
struct MeshFaultRow {
    measure::judge::MeshOutcome outcome;
    std::uint64_t count;
    const JudgedAnswer* first;
};
std::vector<MeshFaultRow> mesh_fault_rows(const MeshAnswersResult& result);
/// Command-line arguments that name a judged ray or point: `--ray=…` with the ends of its range, or the coordinates of
/// the point.
std::string answer_arguments(const JudgedAnswer& answer, bool is_point);

/// Columns of the table with one row per ray or point.
table::Table<JudgedAnswer> make_mesh_answer_table(AnswerKind kind);

/// Opens every file before any work, and gives all files their final names in `finish`.
class MeshAnswerWriter {
public:
    explicit MeshAnswerWriter(MeshAnswerWriterOptions options);
    void add(std::span<const JudgedAnswer> answers);
    void finish(const MeshAnswersResult& result);

private:
    MeshAnswerWriterOptions options_;
    table::TableFile<MeshSummaryRow> summary_;
    table::TableFile<MeshFaultRow> faults_;
    std::optional<table::TableFile<JudgedAnswer>> rows_;
};

}  // namespace lostbits::output::judge
