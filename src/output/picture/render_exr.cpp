#include "output/picture/render_exr.hpp"

#include <span>

#include "output/image/exr_parts.hpp"
#include "output/picture/render_colour.hpp"

namespace lostbits::output::picture {

using image::float_word;

namespace {

image::ExrSpec spec_of(const measure::picture::RenderRequest& request, const measure::evaluate::TestedForm& row,
                       const std::string& command) {
    using enum image::Channel::Type;
    image::ExrSpec spec{.width = request.scene->width,
                        .height = request.scene->height,
                        .channels = {{"R", f32}, {"G", f32}, {"B", f32}},
                        .attributes = {}};
    for (const scene::file::Stage stage : request.stages) {
        const std::string name(name_of(stage));
        for (const char* channel : {".r", ".g", ".b", "_true.r", "_true.g", "_true.b", ".difference"})
            spec.channels.push_back({name + channel, f32});
    }
    for (const char* name : {"normal.angle", "point.residual"}) spec.channels.push_back({name, f32});
    for (const char* name : {"class.seen", "class.shadow", "class.object", "class.true_object"})
        spec.channels.push_back({name, u32});
    const auto list = [](const auto& names) {
        std::string text;
        for (std::size_t k = 0; k < names.size(); ++k)
            text += (k ? ", " : "") + std::to_string(k) + " " + std::string(names[k]);
        return text;
    };
    spec.attributes = {{"lostbits:command", command},
                       {"lostbits:schema", "lostbits-render/1"},
                       {"lostbits:scene", request.scene->id},
                       {"lostbits:form", std::string(row.form->info->name)},
                       {"lostbits:format", row.format.name},
                       image::compiler_attribute(),
                       {"lostbits:seen", list(measure::picture::seen_names)},
                       {"lostbits:shadow", list(measure::picture::shadow_names)},
                       image::objects_attribute()};
    return spec;
}

}  // namespace

RenderExr::RenderExr(image::ImageBackend& backend, const std::filesystem::path& path,
                     const measure::picture::RenderRequest& request, const measure::evaluate::TestedForm& row,
                     const std::string& command)
    : request_(request), writer_(backend.open_exr(path, spec_of(request, row, command))) {}

void RenderExr::write(const measure::picture::RenderBand& band) {
    samples_.clear();
    for (std::size_t i = 0; i < band.seen.size(); ++i) {
        for (const std::uint32_t word : image::preview_words(picture_colour(band.painted.back()[i])))
            samples_.push_back(word);
        for (std::size_t s = 0; s < request_.stages.size(); ++s) {
            const measure::picture::Painted& p = band.painted[s][i];
            const measure::picture::TrueColour& truth =
                band.truth[i].colours[static_cast<std::size_t>(request_.stages[s])];
            for (int k = 0; k < 3; ++k) samples_.push_back(float_word(p.colour[k]));
            for (const measure::picture::Tight& c : truth.channel)
                samples_.push_back(truth.certain ? float_word(c.hi)
                                                 : float_word(std::numeric_limits<double>::quiet_NaN()));
            samples_.push_back(float_word(p.error));
        }
        samples_.push_back(float_word(band.normal_angle[i]));
        samples_.push_back(float_word(band.residual[i]));
        samples_.push_back(static_cast<std::uint32_t>(band.seen[i]));
        samples_.push_back(band.shadow.empty() ? 0 : static_cast<std::uint32_t>(band.shadow[i]));
        samples_.push_back(band.answers->hit[i] != 0 ? static_cast<std::uint32_t>(band.answers->object[i] + 1) : 0);
        samples_.push_back(static_cast<std::uint32_t>(band.truth_object[i] + 1));
    }
    writer_->write_rows(band.y0, band.rows, std::as_bytes(std::span(samples_)));
}

}  // namespace lostbits::output::picture
