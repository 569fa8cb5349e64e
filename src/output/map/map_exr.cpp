// Layers and parts of a map's EXR.
#include "output/map/map_exr.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "measure/truth/missing.hpp"
#include "output/map/form_names.hpp"

namespace lostbits::output::map {

using image::Channel;
using image::ExrPart;
using measure::truth::missing;

/// A part with the truth that several tested forms share. It is filled from the first of these, `first_form`.
struct MapExr::TruthPart {
    TruthKey kind;
    const TestedForm* first_form;
    pixel::ExrLayers<MapStrip> layers;

    [[nodiscard]] std::string name() const {
        const auto& [direction, convention, generator] = kind;
        std::string name = "truth";
        if (direction == intersect::Direction::unit) name += ".distance";
        if (convention.touching == intersect::Touching::miss) name += ".open";
        if (convention.at_origin == intersect::AtOrigin::miss) name += ".ahead";
        if (convention.at_origin == intersect::AtOrigin::exit) name += ".leaving";
        if (convention.inside != intersect::Inside::usual)
            name.append(".inside_").append(intersect::inside_names[static_cast<std::size_t>(convention.inside)]);
        if (convention.facing != intersect::Facing::both)
            name.append(".").append(intersect::facing_names[static_cast<std::size_t>(convention.facing)]);
        if (convention.endless) name += ".endless";
        if (generator) name.append(".ray-").append(generator->info->name);
        return name;
    }
};

namespace {

using Attributes = std::vector<std::pair<std::string, std::string>>;

/// True if binary32 can represent every number of the format.
bool fits_binary32(const Format& format) {
    const FloatFormat& f = format.parameters;
    return f.precision <= binary32.precision && f.emax <= binary32.emax && f.emin >= binary32.emin;
}

/// Adds channels that hold a number exactly; see `MapExr`.
template <class Band, class ValueOf>
void add_exact_number(pixel::ExrLayers<Band>& layers, const std::string& name, bool is_within_binary32,
                      ValueOf value_of) {
    if (is_within_binary32) return layers.add_number(name + ".hi", value_of);
    layers.add(
        {{name + ".hi"}, {name + ".lo"}, {name + ".word1", Channel::Type::u32}, {name + ".word0", Channel::Type::u32}},
        [value_of](const Band& band, std::size_t i, std::uint32_t* samples) {
            const double x = value_of(band, i);
            const auto hi = static_cast<float>(x);
            const auto bits = std::bit_cast<std::uint64_t>(x);
            samples[0] = std::bit_cast<std::uint32_t>(hi);
            samples[1] = image::float_word(std::isfinite(hi) ? x - static_cast<double>(hi) : 0.0);
            samples[2] = static_cast<std::uint32_t>(bits >> 32);
            samples[3] = static_cast<std::uint32_t>(bits);
        });
}

template <class Band>
void add_truth(pixel::ExrLayers<Band>& layers) {
    layers.add({{"class.truth", Channel::Type::u32}, {"class.truth_object", Channel::Type::u32}},
               [](const Band& band, std::size_t i, std::uint32_t* samples) {
                   const measure::truth::Truth ray_truth = band.result->truth(i);
                   samples[0] = static_cast<std::uint32_t>(ray_truth.decision);
                   samples[1] = ray_truth.is_hit() ? static_cast<std::uint32_t>(ray_truth.primitive + 1) : 0;
               });
}

ExrPart make_part(const MapExrRequest& request, std::string name, const char* schema, std::vector<Channel> channels) {
    const scene::file::Scene& scene = *request.map.scene;
    return {.name = std::move(name),
            .spec = {.width = scene.width,
                     .height = scene.height,
                     .channels = std::move(channels),
                     .attributes = {{"lostbits:command", request.command},
                                    {"lostbits:schema", schema},
                                    {"lostbits:scene", scene.id},
                                    image::compiler_attribute(),
                                    image::primitives_attribute()}}};
}

void append(Attributes& attributes, const Attributes& added) {
    attributes.insert(attributes.end(), added.begin(), added.end());
}

pixel::ExrLayers<MapStrip> series_layers(const MapExrRequest& request, const TestedForm& tested_form) {
    pixel::ExrLayers<MapStrip> layers;
    layers.add_preview([](const MapStrip& strip, std::size_t i) { return strip.preview[i]; });
    add_exact_number(layers, "t", fits_binary32(tested_form.format), [](const MapStrip& strip, std::size_t i) {
        const auto& answers = *strip.result->answers;
        return answers.hit[i] != 0 ? answers.t[i] : missing;
    });

    layers.add_uint("class.outcome", [](const MapStrip& strip, std::size_t i) { return strip.result->outcomes[i]; });
    layers.add_uint("class.object", [](const MapStrip& strip, std::size_t i) {
        const auto& answers = *strip.result->answers;
        return answers.hit[i] != 0 ? answers.primitive[i] + 1 : 0;
    });

    for (const Metric* metric : request.layers)
        layers.add_number(std::string(metric->layer),
                          [metric_index = measure::metric::index_of(request.map.metrics, metric->name)](
                              const MapStrip& strip, std::size_t i) { return strip.result->metrics[metric_index][i]; });
    return layers;
}

pixel::ExrLayers<MapStrip> truth_layers(const TestedForm& first_form) {
    pixel::ExrLayers<MapStrip> layers;
    add_exact_number(
        layers, "truth", false, [direction = first_form.form->info->direction](const MapStrip& strip, std::size_t i) {
            const BandResult& result = *strip.result;
            return result.truth(i).is_hit() ? result.band->rounded_truth(i, binary64, direction, result.convention)
                                            : missing;
        });
    add_truth(layers);
    return layers;
}

pixel::ExrLayers<BitsNeededStrip> bits_needed_layers() {
    pixel::ExrLayers<BitsNeededStrip> layers;
    layers.add_preview([](const BitsNeededStrip& strip, std::size_t i) { return strip.preview[i]; });
    layers.add_number("bits.needed",
                      [](const BitsNeededStrip& strip, std::size_t i) { return strip.result->bits_needed[i]; });
    add_truth(layers);
    return layers;
}

ExrPart series_part(const MapExrRequest& request, const TestedForm& tested_form, const std::string& truth_name,
                    std::vector<Channel> channels) {
    ExrPart part = make_part(request, tested_form_name(tested_form), "lostbits-map/2", std::move(channels));
    append(part.spec.attributes, {{"lostbits:form", std::string(tested_form.form->info->name)},
                                  {"lostbits:format", tested_form.format.name},
                                  {"lostbits:truth", truth_name},
                                  {"lostbits:outcomes", pixel::numbered_list(measure::answer::outcome_names)}});
    for (const Metric* m : request.layers) {
        if (m->depends_on_forms && !m->categories.empty())
            part.spec.attributes.emplace_back("lostbits:culprits", pixel::numbered_list(m->categories, "; "));
    }
    return part;
}

ExrPart needed_part(const MapExrRequest& request, const Info& form) {
    ExrPart part =
        make_part(request, std::string(form.name) + ".needed", "lostbits-needed/2", bits_needed_layers().channels());
    part.run = 1;  // after the map
    using measure::evaluate::min_precision, measure::evaluate::max_precision;
    append(part.spec.attributes,
           {{"lostbits:form", std::string(form.name)},
            {"lostbits:format", "p" + std::to_string(min_precision) + "..p" + std::to_string(max_precision)},
            {"lostbits:bits", std::to_string(request.needed->correct_bits)},
            {"lostbits:truths", pixel::numbered_list(measure::truth::decision_names)}});
    return part;
}

std::size_t index_in(const auto& list, const auto& matches) {
    return static_cast<std::size_t>(std::ranges::find_if(list, matches) - list.begin());
}

template <class Band>
ExrScanlines band_forms(std::size_t part, const pixel::ExrLayers<Band>& layers, const Band& band) {
    return {part, band.result->y0, band.result->scanlines, layers.samples(band, band.preview.size())};
}

}  // namespace

MapExr::MapExr(const std::filesystem::path& path, const MapExrRequest& request) {
    std::vector<ExrPart> parts;

    // A part for each tested form. The first tested form with a truth of its own makes the part of that truth.
    for (const TestedForm& tested_form : request.map.tested_forms) {
        series_.push_back({&tested_form, series_layers(request, tested_form)});
        const std::size_t truth_index = index_in(
            truth_parts_, [kind = truth_key(tested_form)](const TruthPart& part) { return part.kind == kind; });
        if (truth_index == truth_parts_.size())
            truth_parts_.push_back({truth_key(tested_form), &tested_form, truth_layers(tested_form)});
        parts.push_back(
            series_part(request, tested_form, truth_parts_[truth_index].name(), series_.back().layers.channels()));
    }

    for (const TruthPart& part : truth_parts_) {
        parts.push_back(make_part(request, part.name(), "lostbits-map/2", part.layers.channels()));
        parts.back().spec.attributes.emplace_back("lostbits:truths",
                                                  pixel::numbered_list(measure::truth::decision_names));
    }

    if (request.needed) {
        for (const intersect::table::Intersector* form : request.needed->tested_forms) {
            needed_forms_.push_back(form->info);
            parts.push_back(needed_part(request, *form->info));
        }
    }
    if (!path.empty()) book_ = std::make_unique<image::ExrBook>(path, std::move(parts));
}

MapExr::~MapExr() = default;

std::vector<ExrScanlines> MapExr::make_rows(const TestedForm& tested_form, const BandResult& result,
                                            std::span<const image::Rgb8> preview) const {
    const MapStrip strip{&result, preview};
    const std::size_t index =
        index_in(series_, [&tested_form](const SeriesLayers& s) { return s.tested_form == &tested_form; });
    std::vector<ExrScanlines> part_rows{band_forms(index, series_[index].layers, strip)};
    const std::size_t truth_index =
        index_in(truth_parts_, [&tested_form](const TruthPart& part) { return part.first_form == &tested_form; });
    if (truth_index < truth_parts_.size())
        part_rows.push_back(band_forms(series_.size() + truth_index, truth_parts_[truth_index].layers, strip));
    return part_rows;
}

std::vector<ExrScanlines> MapExr::make_rows(const BitsNeededBand& result, std::span<const image::Rgb8> preview) const {
    const std::size_t index = index_in(needed_forms_, [&result](const Info* form) { return form == result.form; });
    return {band_forms(series_.size() + truth_parts_.size() + index, bits_needed_layers(),
                       BitsNeededStrip{&result, preview})};
}

void MapExr::write(const std::vector<ExrScanlines>& part_rows) {
    for (const ExrScanlines& rows : part_rows)
        book_->write_rows(rows.part, rows.y0, rows.rows, std::as_bytes(std::span(rows.samples)));
}

void MapExr::close() { book_->close(); }

}  // namespace lostbits::output::map
