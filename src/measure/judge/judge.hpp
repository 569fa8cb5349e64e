// Judges a file of rays: compares the answers in it, and the answers of forms to the same rays, with one truth.
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
#include "measure/shard/share.hpp"
#include "scene/ray_file/ray_file.hpp"
#include "scene/rays/primitive_list.hpp"

namespace lostbits::measure::judge {

/// `file.NAME`, with `_` in place of characters that file names should not have.
std::string name_of_answers(const std::string& name);

/// Answers of a file as a row: a name and a contract, without a form to evaluate.
class FileForm {
public:
    /// Named by `name_of_answers`. `info` is the contract. Its texts are not used, and a file without a t has
    /// `Roots::none`.
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
    /// Primitives of all rays, in the format of the ray file. If neither these nor a mesh are given, each ray has its
    /// own.
    std::vector<Primitive<double>> primitives = {};
    std::shared_ptr<const scene::rays::StoredMesh> mesh = {};  ///< mesh whose triangles follow `primitives`; or null
    std::optional<intersect::MarchConstants<double>> march = {};
    std::vector<evaluate::TestedForm> tested_forms = {};
    /// Form of the file's answers (`FileForm`); null if the file has none.
    const intersect::table::Intersector* file_answers_form = nullptr;
    std::vector<const metric::Metric*> metrics = {};
    std::optional<std::pair<int, int>> picture = {};  ///< numbers of columns and lines; absent: the rays are a list
    /// Index of the column by whose values rays are grouped, among the columns that the ray file keeps.
    std::optional<std::size_t> group_column = {};
    truth::ProofLimit limit = {};
    truth::StageCounts* stages = nullptr;  ///< receives the counts of stages; may be null
    /// The pieces of the file to measure, see `count_pieces`; absent: all pieces.
    std::optional<shard::UnitRange> pieces = {};
    /// Receives the numbers of rays and of bytes of the file done since the last call; may throw to stop.
    std::function<void(std::uint64_t ray_count, std::uint64_t bytes)> progress = [](std::uint64_t, std::uint64_t) {};

    [[nodiscard]] bool is_file_form(const evaluate::TestedForm& tested_form) const {
        return tested_form.form == file_answers_form;
    }
    /// Index of the row of the file's answers, if there is one.
    [[nodiscard]] std::optional<std::size_t> file_form_index() const;
};

/// Receives the results of a row for some rays, with the file's record of these rays. Called in order for each row;
/// different forms may be shown at the same time.
using ShowJudged = std::function<void(std::size_t form_index, const scene::ray_file::Chunk& chunk,
                                      const evaluate::BandResult& result)>;

struct JudgeResult {
    std::vector<evaluate::FormSummary> summaries;  ///< one for each row
    std::uint64_t ray_count = 0;
    std::uint64_t rounded_count = 0;         ///< number of values in the file that its format cannot represent
    std::uint64_t nonzero_answer_count = 0;  ///< number of answers of the file whose t is not 0
    /// Number of these answers whose t is a binary32 number or, as long as all earlier ones count here, the decimal of
    /// one. If there are many answers and all count here, they were computed in binary32.
    std::uint64_t float_answer_count = 0;
    int max_digits = 0;                       ///< most digits of a decimal that the format cannot represent exactly
    std::uint64_t inexact_decimal_count = 0;  ///< number of such decimals
    /// The file's answers and the truth for the first rays that the file or the truth hits, for `contract::suspicion`.
    std::vector<contract::AnswerSample> first_samples = {};
    evaluate::Groups groups = {};  ///< used if the request has a column for grouping

    /// Adds the results of the next pieces.
    void append(JudgeResult&& next);
    /// Number of rays that the file correctly misses, according to its summary, scaled to the number of rays in
    /// `first_samples`.
    [[nodiscard]] std::uint64_t scaled_right_misses(const evaluate::FormSummary& file) const;
    /// True if `first_samples` has every ray that the file (with this summary) or the truth hits.
    [[nodiscard]] bool has_all_samples(const evaluate::FormSummary& file) const;
};

/// Counts the pieces in which the file is measured, which depend only on the request's picture and the file. Reads the
/// file to its end.
std::uint64_t count_pieces(scene::ray_file::RayFile& ray_file, const JudgeRequest& request);

/// Throws InputError if the file has no rays, or another number of rays than the picture.
void require_ray_count(const scene::ray_file::RayFile& ray_file, const JudgeRequest& request,
                       const JudgeResult& result);

/// Reads the ray file to its end, or to the end of its pieces. Memory does not grow with the file, and the results do
/// not depend on the number of threads: the pieces depend only on the rays, and are added in order. Throws InputError,
/// with the position, for anything the ray file refuses, for rays that do not fit the picture, and for too many groups.
JudgeResult run_judge(scene::ray_file::RayFile& ray_file, const JudgeRequest& request, const ShowJudged& show = {});

}  // namespace lostbits::measure::judge
