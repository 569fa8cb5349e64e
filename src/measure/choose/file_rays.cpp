#include "measure/choose/file_rays.hpp"

#include "measure/judge/judge.hpp"

namespace lostbits::measure::choose {

namespace {

/// Keeps every n-th ray of a file of unknown length. When the sample is full, n is doubled and every other ray is
/// dropped.
class Sampler {
public:
    void add(const scene::ray_file::Chunk& chunk) {
        for (std::size_t i = 0; i < chunk.size(); ++i) {
            if ((chunk.first + i) % step_ != 0) continue;
            if (sample_.rays.size() == max_rays) halve();
            // halve() doubles `step_`, so this ray may no longer be in the sample.
            if ((chunk.first + i) % step_ != 0) continue;
            sample_.rays.push(chunk.rays[i]);
            sample_.rays.push_range(chunk.rays, i);
            if (!chunk.primitives.empty()) sample_.primitives.push_back(chunk.primitives[i]);
        }
    }

    scene::rays::RayGroup take(const FileOptions& options) {
        sample_.rays.mark_as_list();
        sample_.is_paired = !sample_.primitives.empty();
        if (!sample_.is_paired)
            sample_.primitives =
                scene::rays::primitive_list_of({{}, options.primitives, {}, false, options.mesh}).all();
        return std::move(sample_);
    }

private:
    static constexpr std::size_t max_rays = 4096;

    void halve() {
        step_ *= 2;
        const auto drop_every_other = [](auto& column) {
            for (std::size_t i = 0; 2 * i < column.size(); ++i) column[i] = column[2 * i];
            column.resize((column.size() + 1) / 2);
        };
        for (auto* numbers : sample_.rays.numbers()) drop_every_other(*numbers);
        drop_every_other(sample_.rays.tmin);
        drop_every_other(sample_.rays.tmax);
        drop_every_other(sample_.primitives);
    }

    scene::rays::RayGroup sample_;
    std::uint64_t step_ = 1;
};

}  // namespace

FileRays judge_and_sample(scene::ray_file::RayFile& ray_file, const FileOptions& options,
                          const ChoiceRequest& request) {
    judge::JudgeRequest judge_request{.primitives = options.primitives,
                                      .mesh = options.mesh,
                                      .tested_forms = request.tested_forms,
                                      .metrics = request.requirement.metrics(),
                                      .limit = request.limit};
    judge_request.progress = [&options](std::uint64_t, std::uint64_t bytes) { options.progress(bytes); };

    // The answers of the file, if it has some, are judged as a form of their own.
    intersect::Info contract = options.contract;
    if (ray_file.layout().has_only_decisions()) contract.roots = intersect::Roots::none;
    const Shape shape = ray_file.layout().primitive_shape() ? *ray_file.layout().primitive_shape()
                                                            : options.representatives().front().shape;
    const judge::FileForm answers(options.result_name, shape, contract);
    if (ray_file.layout().has_first_hits()) {
        judge_request.file_answers_form = &answers.form();
        judge_request.tested_forms.insert(judge_request.tested_forms.begin(),
                                          {judge_request.file_answers_form, ray_file.format()});
    }

    // Keeps a sample of the rays, which are read only once.
    Sampler sampler;
    const judge::JudgeResult result = judge::run_judge(
        ray_file, judge_request,
        [&sampler](std::size_t form_index, const scene::ray_file::Chunk& chunk, const evaluate::BandResult&) {
            if (form_index == 0) sampler.add(chunk);
        });

    FileRays rays{.result_name = options.result_name,
                  .typed_file_names = ray_file.name(),
                  .format = ray_file.format(),
                  .ray_count = result.ray_count,
                  .rounded_count = result.rounded_count};
    for (std::size_t form_index = 0; form_index < judge_request.tested_forms.size(); ++form_index) {
        const FormQuality quality =
            to_quality(result.summaries[form_index], judge_request.tested_forms[form_index], request.requirement);
        if (judge_request.is_file_form(judge_request.tested_forms[form_index]))
            rays.answers = FileAnswers{std::string(answers.form().info->name), ray_file.format(), quality};
        else rays.quality.push_back(quality);
    }
    rays.sample = sampler.take(options);
    return rays;
}

}  // namespace lostbits::measure::choose
