#include "output/map/map_exr.hpp"

#include <bit>
#include <cmath>

#include "measure/truth/missing.hpp"

#include "output/image/exr_parts.hpp"

namespace lostbits::output::map {

using image::ExrSpec;
using measure::truth::missing;

namespace {

ExrSpec spec_of(const measure::map::MapRequest& request, const measure::map::MapRow& row, const std::string& command) {
    using enum image::Channel::Type;
    ExrSpec spec;
    spec.width = request.scene->width;
    spec.height = request.scene->height;
    spec.channels = {{"R", f32}, {"G", f32}, {"B", f32}};
    for (const char* layer : {"t", "truth"}) {
        const std::string name(layer);
        spec.channels.push_back({name + ".hi", f32});
        spec.channels.push_back({name + ".lo", f32});
        spec.channels.push_back({name + ".word1", u32});
        spec.channels.push_back({name + ".word0", u32});
    }
    for (const char* name : {"class.outcome", "class.object", "class.truth_object"})
        spec.channels.push_back({name, u32});
    for (const measure::metric::Metric* m : request.metrics) spec.channels.push_back({std::string(m->layer), f32});
    std::string outcomes;
    for (std::size_t o = 0; o < measure::answer::outcome_names.size(); ++o)
        outcomes += (o ? ", " : "") + std::to_string(o) + " " + std::string(measure::answer::outcome_names[o]);
    spec.attributes = {
        {"lostbits:command", command},
        {"lostbits:schema", "lostbits-map/1"},
        {"lostbits:scene", request.scene->id},
        {"lostbits:form", std::string(row.form->info->name)},
        {"lostbits:format", row.format.name},
        image::compiler_attribute(),
        {"lostbits:outcomes", outcomes},
        {"lostbits:objects", "0 none, otherwise the solid's place in the scene, from 1"},
    };
    for (const measure::metric::Metric* m : request.metrics) {
        if (!m->by_run()) continue;
        std::string names;
        for (std::size_t c = 0; c < m->categories.size(); ++c)
            names += (c ? "; " : "") + std::to_string(c) + " " + std::string(m->categories[c]);
        spec.attributes.push_back({"lostbits:culprits", names});
    }
    return spec;
}

/// hi, lo, word1, word0 of one number.
std::uint32_t* put(std::uint32_t* out, double x) {
    const auto hi = static_cast<float>(x);
    const double lo = std::isfinite(hi) ? x - static_cast<double>(hi) : 0.0;
    const auto word = std::bit_cast<std::uint64_t>(x);
    *out++ = std::bit_cast<std::uint32_t>(hi);
    *out++ = image::float_word(lo);
    *out++ = static_cast<std::uint32_t>(word >> 32);
    *out++ = static_cast<std::uint32_t>(word);
    return out;
}

}  // namespace

MapExr::MapExr(image::ImageBackend& backend, const std::filesystem::path& path, const measure::map::MapRequest& request,
               const measure::map::MapRow& row, const std::string& command)
    : row_(&row) {
    const ExrSpec spec = spec_of(request, row, command);
    channels_ = spec.channels.size();
    writer_ = backend.open_exr(path, spec);
}

void MapExr::write(const measure::map::BandResult& result, std::span<const image::Rgb8> preview) {
    const std::size_t n = result.outcomes.size();
    samples_.resize(n * channels_);
    std::uint32_t* out = samples_.data();
    const auto id = [](int object) { return static_cast<std::uint32_t>(object + 1); };
    for (std::size_t i = 0; i < n; ++i) {
        for (const std::uint32_t word : image::preview_words(preview[i])) *out++ = word;
        const bool hit = result.answers->hit[i] != 0;
        out = put(out, hit ? result.answers->t[i] : missing);
        const measure::truth::Truth& truth = result.truth(i);
        out = put(out, truth.is_hit()
                           ? result.band->rounded_truth(i, binary64, row_->form->info->direction, result.convention)
                           : missing);
        *out++ = static_cast<std::uint32_t>(result.outcomes[i]);
        *out++ = id(hit ? result.answers->object[i] : -1);
        *out++ = id(truth.is_hit() ? truth.object : -1);
        for (const auto& metric : result.metrics) *out++ = image::float_word(metric[i]);
    }
    writer_->write_rows(result.y0, result.rows, std::as_bytes(std::span(samples_)));
}

}  // namespace lostbits::output::map
