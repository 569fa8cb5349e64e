#include "measure/judge/judge.hpp"

#include <tbb/parallel_pipeline.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <exception>
#include <memory>
#include <ranges>

#include "intersect/process/parallel.hpp"
#include "intersect/sdf/march_loop.hpp"
#include "intersect/table/union_field.hpp"
#include "measure/culling/box_tree.hpp"
#include "measure/culling/culling.hpp"
#include "measure/evaluate/measure_form.hpp"
#include "measure/study/bands.hpp"
#include "number/error.hpp"
#include "scene/ray_file/number_parser.hpp"
#include "text/count_with_noun.hpp"

namespace lostbits::measure::judge {

using evaluate::FormSummary;
using evaluate::TestedForm;
using scene::ray_file::Chunk;
using scene::ray_file::RayFile;
using scene::ray_file::Records;
using scene::rays::RayGroup;
using truth::Band;
using truth::FormatInputs;
using truth::missing;

namespace {

/// Part of the file in the pipeline: its records are read first, then its rays are measured as a band.
struct Piece {
    Records records;
    std::exception_ptr read_error = {};  ///< error while reading, rethrown in the order of the file
    Chunk chunk = {};
    std::unique_ptr<culling::Culler> culler = {};  ///< for a mesh
    std::unique_ptr<Band> band = {};
    std::optional<evaluate::SharedBandTruth> shared = {};
    answer::Answers answers = {};
};

std::uint64_t pixels_of(const JudgeRequest& request) {
    return static_cast<std::uint64_t>(request.picture->first) * static_cast<std::uint64_t>(request.picture->second);
}

std::size_t records_of_piece(const JudgeRequest& request) {
    const int width = request.picture ? request.picture->first : 32768;
    return static_cast<std::size_t>(request.picture ? study::lines_per_band(width) : 1) *
           static_cast<std::size_t>(width);
}

[[noreturn]] void fail_wrong_size(const RayFile& ray_file, const JudgeRequest& request, const JudgeResult& result,
                                  const char* count_phrase) {
    throw InputError(ray_file.name() + ": the file " + count_phrase + " " +
                     text::count_with_noun(result.ray_count, "ray") + ", but a picture of " +
                     std::to_string(request.picture->first) + "x" + std::to_string(request.picture->second) + " has " +
                     std::to_string(pixels_of(request)) +
                     " pixels; give --size as columns x rows, with one pixel for each ray");
}

constexpr std::size_t max_first_rays = 4096;  // limit of JudgeResult::first_samples

/// Judges one file: reads it piece by piece, prepares several pieces at a time, and measures them in order.
class RayFileJudge {
public:
    RayFileJudge(RayFile& ray_file, const JudgeRequest& request, const ShowJudged& show)
        : ray_file_(ray_file),
          request_(request),
          show_(show),
          file_form_index_(request.file_form_index()),
          primitives_(scene::rays::primitive_list_of(group_of_primitives())) {
        if (file_form_index_ && ray_file.layout().has_only_decisions() &&
            file_form().form->info->roots != intersect::Roots::none)
            throw std::logic_error("a file without a t is judged by a row that has one");

        const bool has_own_primitives = ray_file.layout().primitive_shape() || ray_file.layout().has_matrix();
        if (!has_own_primitives) ray_file.number_primitives(primitives_.size());
        if (!has_own_primitives && request.mesh) culler_.emplace(primitives_);
        for (std::size_t r = 0; r < request.tested_forms.size(); ++r) result_.summaries.emplace_back(request.metrics);
    }

    JudgeResult run() {
        // Only a few pieces at a time, because each is measured in parallel.
        constexpr std::size_t max_pieces = 4;
        using intersect::process::in_standard_state;
        const auto read_filter = tbb::make_filter<void, std::shared_ptr<Piece>>(
            tbb::filter_mode::serial_in_order,
            in_standard_state([this](tbb::flow_control& flow) { return read_piece(flow); }));
        const auto prepare_filter = tbb::make_filter<std::shared_ptr<Piece>, std::shared_ptr<Piece>>(
            tbb::filter_mode::parallel, in_standard_state([this](std::shared_ptr<Piece> piece) {
                prepare(*piece);
                return piece;
            }));
        const auto measure_filter = tbb::make_filter<std::shared_ptr<Piece>, void>(
            tbb::filter_mode::serial_in_order,
            in_standard_state([this](const std::shared_ptr<Piece>& piece) { measure(*piece); }));

        tbb::parallel_pipeline(max_pieces, read_filter & prepare_filter & measure_filter);
        if (!request_.pieces) require_ray_count(ray_file_, request_, result_);
        return std::move(result_);
    }

private:
    [[nodiscard]] const TestedForm& file_form() const { return request_.tested_forms[*file_form_index_]; }
    [[nodiscard]] std::uint64_t pixel_count() const { return pixels_of(request_); }
    [[noreturn]] void fail_wrong_size(const char* count_phrase) const {
        lostbits::measure::judge::fail_wrong_size(ray_file_, request_, result_, count_phrase);
    }

    std::shared_ptr<Piece> read_piece(tbb::flow_control& flow) {
        auto piece = std::make_shared<Piece>();
        const std::size_t record_count = records_of_piece(request_);
        if (has_failed_ ||
            (request_.pieces && (request_.pieces->size() == 0 || pieces_read_ >= request_.pieces->last))) {
            flow.stop();
            return piece;
        }

        // Skips the pieces before the first one requested.
        try {
            bool is_read = ray_file_.next(record_count, piece->records);
            for (; is_read && request_.pieces && pieces_read_ < request_.pieces->first; ++pieces_read_)
                is_read = ray_file_.next(record_count, piece->records);
            ++pieces_read_;
            if (!is_read) flow.stop();
        } catch (...) {
            piece->read_error = std::current_exception();
            has_failed_ = true;
        }
        return piece;
    }

    void prepare(Piece& piece) const {
        if (piece.read_error) return;
        try {
            piece.chunk = ray_file_.decode(piece.records);
        } catch (...) {
            piece.read_error = std::current_exception();
            return;
        }
        RayGroup group = make_group(piece.chunk);
        if (group.mesh && culler_) piece.culler = std::make_unique<culling::Culler>(*culler_, group.rays);
        piece.band = std::make_unique<Band>(std::move(group), request_.limit, piece.culler.get());
        piece.shared.emplace(*piece.band, request_.tested_forms, request_.metrics);
        if (file_form_index_) piece.answers = make_answers(piece);
    }

    /// Makes the group of the rays of a chunk, with their primitives.
    [[nodiscard]] RayGroup make_group(const Chunk& chunk) const {
        const std::size_t ray_count = chunk.size();
        RayGroup group;
        group.rays = chunk.rays;
        const auto width = static_cast<std::size_t>(request_.picture ? request_.picture->first : 0);
        // False for a list, and for the last piece of a file that is not a picture of this size, which `measure`
        // refuses.
        const bool has_whole_lines = width > 0 && ray_count % width == 0 && chunk.first + ray_count <= pixel_count();
        group.rays.width = static_cast<int>(has_whole_lines ? width : ray_count);
        group.rays.y0 = has_whole_lines ? static_cast<int>(chunk.first / width) : 0;
        group.rays.y1 = group.rays.y0 + static_cast<int>(has_whole_lines ? ray_count / width : 1);

        group.is_paired = !chunk.primitives.empty();
        if (group.is_paired) {
            group.primitives = chunk.primitives;
        } else {
            group.primitives = request_.primitives;
            group.mesh = request_.mesh;
        }
        group.march = request_.march;
        return group;
    }

    /// Primitives of all rays. A mesh stays a mesh, because only a mesh can have cracks and double hits.
    [[nodiscard]] RayGroup group_of_primitives() const {
        RayGroup group;
        group.primitives = request_.primitives;
        group.mesh = request_.mesh;
        return group;
    }

    /// Makes answers from those in the file, as a form would give them.
    [[nodiscard]] answer::Answers make_answers(const Piece& piece) const {
        const Chunk& chunk = piece.chunk;
        answer::Answers answers{chunk.t, chunk.hit, std::vector<std::int32_t>(chunk.size(), -1)};
        for (double& t : answers.t) t = t == t ? t : missing;
        const bool may_be_behind = file_form().form->info->inside == intersect::Inside::near;
        for (std::size_t i = 0; i < chunk.size(); ++i) {
            if (may_be_behind && answers.t[i] < 0) {
                answers.hit[i] = 0;
                answers.t[i] = 0;
            }
            if (answers.hit[i] != 0) answers.primitive[i] = find_object(piece, i);
        }
        return answers;
    }

    /// Finds the index of the primitive that an answer is about: the only one, else the one that the file names, else
    /// the one that the ray truly hits, else the one whose surface is nearest to the answer.
    [[nodiscard]] std::int32_t find_object(const Piece& piece, std::size_t i) const {
        const Chunk& chunk = piece.chunk;
        if (!chunk.primitives.empty()) return static_cast<std::int32_t>(i);
        if (primitives_.size() == 1) return 0;
        if (!chunk.object.empty() && chunk.object[i] >= 0) return chunk.object[i];
        const truth::Truth& ray_truth = piece.band->truth(i, file_form().convention());
        if (ray_truth.is_hit()) return ray_truth.primitive;

        const Vec<double> p = intersect::sdf::point_on_ray(chunk.rays[i], chunk.t[i]);
        const auto distance = [this, &p](std::size_t s) {
            return std::fabs(intersect::table::distance(primitives_[s], p));
        };
        const auto* const tree = dynamic_cast<const culling::BoxTree*>(culler_ ? culler_->index_for_truth() : nullptr);
        if (tree) return static_cast<std::int32_t>(tree->nearest(p, distance));
        const auto indices = std::views::iota(std::size_t{0}, primitives_.size());
        return static_cast<std::int32_t>(*std::ranges::min_element(indices, {}, distance));
    }

    void measure(Piece& piece) {
        if (piece.read_error) std::rethrow_exception(piece.read_error);
        const Chunk& chunk = piece.chunk;
        if (chunk.size() == 0) return;
        add_counts(chunk);
        require_picture_size(chunk);
        if (request_.stages) *request_.stages += piece.band->stages();
        measure_rows(piece);
        if (file_form_index_) add_first_samples(piece);
        request_.progress(chunk.size(), piece.records.bytes.size());
    }

    /// Counts the rays of a chunk, and what its numbers tell of their format.
    void add_counts(const Chunk& chunk) {
        result_.ray_count += chunk.size();
        result_.rounded_count += chunk.rounded_count;
        result_.max_digits = std::max(result_.max_digits, chunk.digits);
        result_.inexact_decimal_count += chunk.decimals;
        for (const double t : chunk.t) {
            const bool are_all_floats = result_.float_answer_count == result_.nonzero_answer_count;
            result_.nonzero_answer_count += t != 0;
            result_.float_answer_count += t != 0 && (static_cast<double>(static_cast<float>(t)) == t || std::isnan(t) ||
                                                     (are_all_floats && scene::ray_file::is_float_in_decimal(t)));
        }
    }

    /// Throws if the rays so far do not fit the picture.
    void require_picture_size(const Chunk& chunk) const {
        if (request_.picture && result_.ray_count > pixel_count()) fail_wrong_size("has at least");
        if (request_.picture && chunk.size() % static_cast<std::size_t>(request_.picture->first) != 0)
            fail_wrong_size("has");
    }

    /// Measures every row on a piece, into the summaries of all rays and those of the groups.
    void measure_rows(const Piece& piece) {
        const Chunk& chunk = piece.chunk;
        const std::int64_t first = request_.picture ? 0 : static_cast<std::int64_t>(chunk.first);
        const auto rays_by_value = group_rays(chunk);
        intersect::process::in_parallel(std::size_t{0}, request_.tested_forms.size(), [&](std::size_t r) {
            const TestedForm& tested_form = request_.tested_forms[r];

            // The function that shows the results, and the groups that they are added to.
            evaluate::Show show;
            if (show_) show = [&, r](const evaluate::BandResult& result) { show_(r, chunk, result); };
            std::vector<evaluate::RaySubset> parts;
            for (const auto& [value, rays] : rays_by_value)
                parts.push_back({rays, &result_.groups.at(value).summaries[r]});

            evaluate::measure_form({.tested_form = tested_form,
                                    .metrics = request_.metrics,
                                    .show = show,
                                    .first = first,
                                    .answers = request_.is_file_form(tested_form) ? &piece.answers : nullptr},
                                   piece.shared->inputs_of(tested_form), result_.summaries[r], parts);
        });
    }

    /// Groups the rays, and makes groups for new values. Nothing if grouping is not requested.
    std::vector<evaluate::RaysWithValue> group_rays(const Chunk& chunk) {
        if (!request_.group_column) return {};
        const std::size_t columns = ray_file_.layout().kept_columns().size();
        auto values = evaluate::group_by_value(std::span(chunk.kept).subspan(*request_.group_column), columns);
        try {
            for (const auto& rays_of_value : values)
                result_.groups.add(rays_of_value.value, request_.tested_forms.size(), request_.metrics);
        } catch (const InputError& e) {
            throw InputError(ray_file_.name() + ": " + ray_file_.layout().kept_columns()[*request_.group_column] +
                             " has " + e.what());
        }
        return values;
    }

    void add_first_samples(const Piece& piece) {
        const TestedForm& tested_form = file_form();
        const FormatInputs& inputs = piece.shared->inputs_of(tested_form).inputs;
        for (std::size_t i = 0; i < piece.chunk.size() && result_.first_samples.size() < max_first_rays; ++i) {
            const truth::Truth ray_truth = piece.band->truth(i, tested_form.convention());
            const bool hit = piece.answers.hit[i] != 0;
            if (ray_truth.decision == truth::Truth::Decision::unresolved || !(hit || ray_truth.is_hit())) continue;

            const int primitive = ray_truth.is_hit() ? ray_truth.primitive : piece.answers.primitive[i];
            result_.first_samples.push_back(contract::make_answer_sample(inputs.rays_for(*tested_form.form->info)[i],
                                                                         inputs.primitives[primitive], ray_truth,
                                                                         tested_form, hit, piece.answers.t[i]));
        }
    }

    RayFile& ray_file_;
    const JudgeRequest& request_;
    const ShowJudged& show_;
    std::optional<std::size_t> file_form_index_;     ///< index of the row of the file's answers
    scene::rays::PrimitiveList<double> primitives_;  ///< primitives of all rays
    std::optional<culling::Culler> culler_ = {};     ///< index over the primitives of all rays, if they have a mesh
    std::uint64_t pieces_read_ = 0;                  ///< number of pieces read
    bool has_failed_ = false;
    JudgeResult result_;
};

}  // namespace

void JudgeResult::append(JudgeResult&& next) {
    if (summaries.empty()) summaries = std::move(next.summaries);
    else
        for (std::size_t r = 0; r < summaries.size(); ++r) summaries[r].append(std::move(next.summaries.at(r)));
    ray_count += next.ray_count;
    rounded_count += next.rounded_count;
    nonzero_answer_count += next.nonzero_answer_count;
    float_answer_count += next.float_answer_count;
    max_digits = std::max(max_digits, next.max_digits);
    inexact_decimal_count += next.inexact_decimal_count;
    for (contract::AnswerSample& sample : next.first_samples) {
        if (first_samples.size() < max_first_rays) first_samples.push_back(std::move(sample));
    }
    groups.append(std::move(next.groups));
}

std::optional<std::size_t> JudgeRequest::file_form_index() const {
    const auto found =
        std::ranges::find_if(tested_forms, [this](const TestedForm& tested_form) { return is_file_form(tested_form); });
    return found == tested_forms.end() ? std::nullopt
                                       : std::optional(static_cast<std::size_t>(found - tested_forms.begin()));
}

std::uint64_t JudgeResult::scaled_right_misses(const evaluate::FormSummary& file) const {
    const std::uint64_t misses = file.count(answer::Outcome::agree_miss);
    return ray_count > misses ? misses * first_samples.size() / (ray_count - misses) : misses;
}

bool JudgeResult::has_all_samples(const evaluate::FormSummary& file) const {
    const std::uint64_t right_miss_count = file.count(answer::Outcome::agree_miss);
    return first_samples.size() + right_miss_count + file.count(answer::Outcome::unresolved) >= ray_count;
}

std::uint64_t count_pieces(RayFile& ray_file, const JudgeRequest& request) {
    Records records;
    std::uint64_t piece_count = 0;
    while (ray_file.next(records_of_piece(request), records)) ++piece_count;
    return piece_count;
}

void require_ray_count(const RayFile& ray_file, const JudgeRequest& request, const JudgeResult& result) {
    if (result.ray_count == 0)
        throw InputError(ray_file.name() + ": has no rays; write one record for each ray after the header");
    if (request.picture && result.ray_count != pixels_of(request)) fail_wrong_size(ray_file, request, result, "has");
}

JudgeResult run_judge(RayFile& ray_file, const JudgeRequest& request, const ShowJudged& show) {
    return RayFileJudge(ray_file, request, show).run();
}

std::string name_of_answers(const std::string& name) {
    std::string result = "file.";
    for (const char c : name)
        result += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' ? c : '_';
    return result;
}

FileForm::FileForm(const std::string& name, Shape shape, const intersect::Info& info)
    : name_(name_of_answers(name)), info_(info) {
    info_.name = name_;
    info_.title = "the answers of a file";
    info_.source = "a file";
    form_.info = &info_;
    form_.shape = shape;
}

}  // namespace lostbits::measure::judge
