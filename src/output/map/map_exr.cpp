#include "output/map/map_exr.hpp"

#include <bit>
#include <cmath>

#include "measure/truth/missing.hpp"
#include "output/image/exr_parts.hpp"
#include "output/map/row_names.hpp"
#include "scene/rays/made_rows.hpp"

namespace lostbits::output::map {

using image::Channel;
using image::ExrPart;
using measure::evaluate::BandResult;
using measure::evaluate::TestedForm;
using measure::metric::Metric;
using measure::truth::missing;

/// What rows with the same truth share; the first of them fills it.
struct MapExr::Truths {
    intersect::Direction direction;
    intersect::Convention convention;
    const scene::camera::Maker* maker;  ///< whose ideal rays may begin elsewhere
    const TestedForm* filled_by;

    [[nodiscard]] bool is_of(const TestedForm& row) const {
        return direction == row.form->info->direction && convention == row.convention() &&
               maker == scene::rays::maker_of(*row.form);
    }
    [[nodiscard]] std::string name() const {
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
        if (maker) name.append(".ray-").append(maker->info->name);
        return name;
    }
};

namespace {

using Attributes = std::vector<std::pair<std::string, std::string>>;

/// Whether every number of the format is one of binary32.
bool is_within_float(const Format& format) {
    const FloatFormat& f = format.shape;
    return f.precision <= binary32.precision && f.emax <= binary32.emax && f.emin >= binary32.emin;
}

void add_number(std::vector<Channel>& channels, const std::string& name, bool within_float) {
    channels.push_back({name + ".hi", Channel::Type::f32});
    if (within_float) return;
    channels.push_back({name + ".lo", Channel::Type::f32});
    channels.push_back({name + ".word1", Channel::Type::u32});
    channels.push_back({name + ".word0", Channel::Type::u32});
}

void put_number(std::vector<std::uint32_t>& out, double x, bool within_float) {
    const auto hi = static_cast<float>(x);
    out.push_back(std::bit_cast<std::uint32_t>(hi));
    if (within_float) return;
    const auto word = std::bit_cast<std::uint64_t>(x);
    out.push_back(image::float_word(std::isfinite(hi) ? x - static_cast<double>(hi) : 0.0));
    out.push_back(static_cast<std::uint32_t>(word >> 32));
    out.push_back(static_cast<std::uint32_t>(word));
}

void put_preview(std::vector<std::uint32_t>& out, image::Rgb8 colour) {
    for (const std::uint32_t word : image::preview_words(colour)) out.push_back(word);
}

void put_truth(std::vector<std::uint32_t>& out, const measure::truth::Truth& truth) {
    out.push_back(static_cast<std::uint32_t>(truth.decision));
    out.push_back(truth.is_hit() ? static_cast<std::uint32_t>(truth.object + 1) : 0);
}

/// `0 agree_hit, 1 agree_miss, …`
std::string numbered(const auto& names, const char* between) {
    std::string text;
    for (std::size_t k = 0; k < names.size(); ++k)
        text += (k ? between : "") + std::to_string(k) + " " + std::string(names[k]);
    return text;
}

ExrPart part_of(const MapExrRequest& request, std::string name, const char* schema) {
    const scene::file::Scene& scene = *request.map.scene;
    return {.name = std::move(name),
            .spec = {.width = scene.width,
                     .height = scene.height,
                     .channels = {},
                     .attributes = {{"lostbits:command", request.command},
                                    {"lostbits:schema", schema},
                                    {"lostbits:scene", scene.id},
                                    image::compiler_attribute(),
                                    image::objects_attribute()}}};
}

void add(Attributes& attributes, const Attributes& more) {
    attributes.insert(attributes.end(), more.begin(), more.end());
}

const std::vector<Channel> preview_channels{{"R", {}}, {"G", {}}, {"B", {}}};
const std::vector<Channel> truth_channels{{"class.truth", Channel::Type::u32},
                                          {"class.truth_object", Channel::Type::u32}};

ExrPart row_part(const MapExrRequest& request, const TestedForm& row, const std::string& truth) {
    ExrPart part = part_of(request, row_name(row), "lostbits-map/2");
    auto& channels = part.spec.channels = preview_channels;
    add_number(channels, "t", is_within_float(row.format));
    for (const char* name : {"class.outcome", "class.object"}) channels.push_back({name, Channel::Type::u32});
    for (const Metric* m : request.layers) channels.push_back({std::string(m->layer), {}});
    add(part.spec.attributes, {{"lostbits:form", std::string(row.form->info->name)},
                               {"lostbits:format", row.format.name},
                               {"lostbits:truth", truth},
                               {"lostbits:outcomes", numbered(measure::answer::outcome_names, ", ")}});
    for (const Metric* m : request.layers) {
        if (m->by_run && !m->categories.empty())
            part.spec.attributes.emplace_back("lostbits:culprits", numbered(m->categories, "; "));
    }
    return part;
}

ExrPart truth_part(const MapExrRequest& request, const std::string& name) {
    ExrPart part = part_of(request, name, "lostbits-map/2");
    add_number(part.spec.channels, "truth", false);
    part.spec.channels.insert(part.spec.channels.end(), truth_channels.begin(), truth_channels.end());
    part.spec.attributes.emplace_back("lostbits:truths", numbered(measure::truth::decision_names, ", "));
    return part;
}

ExrPart needed_part(const MapExrRequest& request, const intersect::Info& form) {
    ExrPart part = part_of(request, std::string(form.name) + ".needed", "lostbits-needed/2");
    part.run = 1;  // after the map
    part.spec.channels = preview_channels;
    part.spec.channels.push_back({"bits.needed", {}});
    part.spec.channels.insert(part.spec.channels.end(), truth_channels.begin(), truth_channels.end());
    using measure::evaluate::least_width, measure::evaluate::most_width;
    add(part.spec.attributes,
        {{"lostbits:form", std::string(form.name)},
         {"lostbits:format", "p" + std::to_string(least_width) + "..p" + std::to_string(most_width)},
         {"lostbits:bits", std::to_string(request.needed->bits)},
         {"lostbits:truths", numbered(measure::truth::decision_names, ", ")}});
    return part;
}

std::size_t place_in(const auto& all, const auto& is_it) {
    return static_cast<std::size_t>(std::ranges::find_if(all, is_it) - all.begin());
}

}  // namespace

MapExr::MapExr(const std::filesystem::path& path, const MapExrRequest& request) {
    for (const Metric* m : request.layers)
        layers_.push_back(place_in(request.map.metrics, [m](const Metric* measured) { return measured == m; }));
    std::vector<ExrPart> parts;
    for (const TestedForm& row : request.map.rows) {
        rows_.push_back(&row);
        const std::size_t truths = place_in(truths_, [&row](const Truths& t) { return t.is_of(row); });
        if (truths == truths_.size())
            truths_.push_back({row.form->info->direction, row.convention(), scene::rays::maker_of(*row.form), &row});
        parts.push_back(row_part(request, row, truths_[truths].name()));
    }
    for (const Truths& t : truths_) parts.push_back(truth_part(request, t.name()));
    if (request.needed) {
        for (const intersect::table::Intersector* form : request.needed->forms) {
            needed_.push_back(form->info);
            parts.push_back(needed_part(request, *form->info));
        }
    }
    if (!path.empty()) book_ = std::make_unique<image::ExrBook>(path, std::move(parts));
}

MapExr::~MapExr() = default;

std::vector<ExrRows> MapExr::rows_of(const TestedForm& row, const BandResult& result,
                                     std::span<const image::Rgb8> preview) const {
    const std::size_t n = result.outcomes.size();
    std::vector<ExrRows> pieces(1, {.y0 = result.y0, .rows = result.rows, .samples = {}});
    std::vector<std::uint32_t>& samples = pieces.front().samples;
    const bool within_float = is_within_float(row.format);
    for (std::size_t i = 0; i < n; ++i) {
        put_preview(samples, preview[i]);
        const bool hit = result.answers->hit[i] != 0;
        put_number(samples, hit ? result.answers->t[i] : missing, within_float);
        samples.push_back(static_cast<std::uint32_t>(result.outcomes[i]));
        samples.push_back(hit ? static_cast<std::uint32_t>(result.answers->object[i] + 1) : 0);
        for (const std::size_t m : layers_) samples.push_back(image::float_word(result.metrics[m][i]));
    }
    pieces.front().part = place_in(rows_, [&row](const TestedForm* r) { return r == &row; });

    const std::size_t truths = place_in(truths_, [&row](const Truths& t) { return t.filled_by == &row; });
    if (truths == truths_.size()) return pieces;
    ExrRows truth_rows{rows_.size() + truths, result.y0, result.rows, {}};
    for (std::size_t i = 0; i < n; ++i) {
        const measure::truth::Truth& truth = result.truth(i);
        put_number(truth_rows.samples,
                   truth.is_hit()
                       ? result.band->rounded_truth(i, binary64, row.form->info->direction, result.convention)
                       : missing,
                   false);
        put_truth(truth_rows.samples, truth);
    }
    pieces.push_back(std::move(truth_rows));
    return pieces;
}

std::vector<ExrRows> MapExr::rows_of(const measure::evaluate::NeededBand& result,
                                     std::span<const image::Rgb8> preview) const {
    std::vector<ExrRows> pieces(1, {.y0 = result.y0, .rows = result.rows, .samples = {}});
    std::vector<std::uint32_t>& samples = pieces.front().samples;
    for (std::size_t i = 0; i < preview.size(); ++i) {
        put_preview(samples, preview[i]);
        samples.push_back(image::float_word(result.needed[i]));
        put_truth(samples, result.truth(i));
    }
    const std::size_t place = place_in(needed_, [&result](const intersect::Info* form) { return form == result.form; });
    pieces.front().part = rows_.size() + truths_.size() + place;
    return pieces;
}

void MapExr::write(const std::vector<ExrRows>& pieces) {
    for (const ExrRows& piece : pieces)
        book_->write_rows(piece.part, piece.y0, piece.rows, std::as_bytes(std::span(piece.samples)));
}

void MapExr::close() { book_->close(); }

}  // namespace lostbits::output::map
