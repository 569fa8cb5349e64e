#include "measure/choice/file_rays.hpp"

#include "measure/judge/judge.hpp"

namespace lostbits::measure::choice {

namespace {

/// Keeps every n-th ray of a file of unknown length. When the sample is full, n is doubled and every other ray is
/// dropped.
class Sampler {
public:
    void add(const scene::dump::Chunk& chunk) {
        for (std::size_t i = 0; i < chunk.size(); ++i) {
            if ((chunk.first + i) % step_ != 0) continue;
            if (sample_.rays.size() == most) halve();
            if ((chunk.first + i) % step_ != 0) continue;
            sample_.rays.push(chunk.rays[i]);
            sample_.rays.push_range(chunk.rays, i);
            if (!chunk.primitives.empty()) sample_.primitives.push_back(chunk.primitives[i]);
        }
    }

    scene::rays::RayGroup take(const FileTerms& terms) {
        sample_.rays.set_as_list();
        sample_.paired = !sample_.primitives.empty();
        if (!sample_.paired)
            sample_.primitives = scene::rays::primitive_list_of({{}, terms.primitives, {}, false, terms.mesh}).all();
        return std::move(sample_);
    }

private:
    static constexpr std::size_t most = 4096;

    void halve() {
        step_ *= 2;
        const auto thin = [](auto& all) {
            for (std::size_t i = 0; 2 * i < all.size(); ++i) all[i] = all[2 * i];
            all.resize((all.size() + 1) / 2);
        };
        for (auto* column : sample_.rays.numbers()) thin(*column);
        thin(sample_.rays.tmin), thin(sample_.rays.tmax);
        thin(sample_.primitives);
    }

    scene::rays::RayGroup sample_;
    std::uint64_t step_ = 1;
};

}  // namespace

FileRays judge_rays(scene::dump::Dump& dump, const FileTerms& terms, const ChoiceRequest& request) {
    judge::JudgeRequest asked{.primitives = terms.primitives,
                              .mesh = terms.mesh,
                              .rows = request.rows,
                              .metrics = request.requirement.metrics(),
                              .limit = request.limit};
    asked.progress = [&terms](std::uint64_t, std::uint64_t bytes) { terms.progress(bytes); };
    intersect::Info contract = terms.contract;
    if (dump.layout().decides_only()) contract.roots = intersect::Roots::none;
    const Shape shape = dump.layout().primitive() ? *dump.layout().primitive() : terms.examples().front().shape;
    const judge::FileForm answers(terms.id, shape, contract);
    if (dump.layout().has_answers()) {
        asked.file_form = &answers.form();
        asked.rows.insert(asked.rows.begin(), {asked.file_form, dump.format()});
    }
    Sampler sampler;
    const judge::JudgeResult result = judge::run_judge(
        dump, asked, [&sampler](std::size_t row, const scene::dump::Chunk& chunk, const evaluate::BandResult&) {
            if (row == 0) sampler.add(chunk);
        });
    FileRays rays{
        .id = terms.id, .name = dump.name(), .format = dump.format(), .rays = result.rays, .rounded = result.rounded};
    for (std::size_t r = 0; r < asked.rows.size(); ++r) {
        const RowQuality quality = quality_of(result.summaries[r], asked.rows[r], request.requirement);
        if (asked.is_of_file(asked.rows[r]))
            rays.answers = FileAnswers{std::string(answers.form().info->name), dump.format(), quality};
        else rays.quality.push_back(quality);
    }
    rays.sample = sampler.take(terms);
    return rays;
}

}  // namespace lostbits::measure::choice
