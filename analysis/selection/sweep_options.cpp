#include "analysis/selection/sweep_options.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "analysis/selection/ray_numbers.hpp"
#include "analysis/selection/select.hpp"
#include "number/error.hpp"

namespace lostbits::analysis::selection {

using scene::sweep::SweepKind;

namespace {

std::vector<long long> read_steps(const std::string& text) {
    std::vector<long long> steps;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        const std::string part = text.substr(begin, end - begin);
        const bool is_number =
            !part.empty() && part.size() < 10 && std::ranges::all_of(part, [](char c) { return c >= '0' && c <= '9'; });
        if (!is_number)
            throw InputError(fmt::format(
                "--steps {}: is not a number of steps; write one for all axes or one for each: 40 or 40,20", text));
        steps.push_back(std::stoll(part));
        begin = end + 1;
    }
    return steps;
}

const char* unit_name(SweepKind kind) {
    switch (kind) {
        case SweepKind::axes: return "steps";
        case SweepKind::cases: return "cases";
        case SweepKind::search:
        case SweepKind::edge_search: return "searches";
        case SweepKind::every_float: break;
    }
    return "floats";
}

}  // namespace

std::string SweepChangeOptions::title_suffix() const {
    std::string text;
    const auto add = [&text](const char* option, const std::string& value) {
        if (!value.empty()) text += (text.empty() ? " (" : ", ") + std::string(option) + value;
    };
    add("--size ", size);
    add("--steps ", steps);
    for (const std::string& change : set) add("--set ", change);
    return text.empty() ? "" : text + ")";
}

scene::sweep::SweepChanges read_changes(const SweepChangeOptions& options) {
    scene::sweep::SweepChanges changes;
    if (!options.size.empty()) changes.size = selection::parse_size(options.size);
    if (!options.steps.empty()) changes.steps = read_steps(options.steps);
    for (const std::string& assignment : options.set) changes.set.push_back(scene::toml::parse_override(assignment));
    return changes;
}

namespace {

/// An option, its value (empty: it is not given), and for each kind of sweep the message that refuses the option; null
/// if the kind takes it.
struct RefusalRow {
    const char* option;
    std::string value;
    const char *cases, *search, *edges, *every_float;

    [[nodiscard]] const char* reason(SweepKind kind) const {
        return kind == SweepKind::cases         ? cases
               : kind == SweepKind::search      ? search
               : kind == SweepKind::edge_search ? edges
                                                : every_float;
    }
};

/// The options that some kind of sweep refuses.
std::vector<RefusalRow> list_refusals(const SweepChangeOptions& options, SweepKind kind) {
    const auto first_or_empty = [](const std::vector<std::string>& given) {
        return given.empty() ? "" : given.front();
    };
    const auto other_format =
        std::ranges::find_if(options.formats, [](const std::string& format) { return format != "f32"; });
    const bool seeds_have_no_effect = kind == SweepKind::cases && options.seeds == 0;  // cases never draw rays
    return {
        {"--size", options.size, "has no picture, since its rays are the cases; leave out --size",
         "has no picture, since it searches for rays; leave out --size, and try --set starts=N for more of them",
         "has no picture, since it searches for rays; leave out --size, and try --set rays=N for more of them",
         "has no picture, since its rays are in the file; leave out --size"},
        {"--steps", options.steps, "is a list of cases and has no other steps; leave out --steps",
         "has no steps; try --set starts=N or --set generations=N", "has no steps; try --set rays=N",
         "tries every float of its range; leave out --steps"},
        {"--set", first_or_empty(options.set),
         "is a list of cases, whose numbers are in the file; copy the file and change the numbers there", nullptr,
         nullptr, "makes statements about the numbers in its file; copy the file and change the numbers there"},
        {"-f", other_format == options.formats.end() ? "" : *other_format, nullptr, nullptr, nullptr,
         "tries every number of f32 and of no other format; leave out -f"},
        {"--metric", first_or_empty(options.metrics), nullptr,
         "searches by the metric that its file names; leave out --metric, and try --set metric={}",
         "searches for the nearest cracks and double hits, not by a metric; leave out --metric",
         "tries every float and measures only outcomes and ulp errors; leave out --metric, and use `lostbits explain` "
         "for single floats"},
        {"--seeds", options.seeds && !seeds_have_no_effect ? std::to_string(*options.seeds) : "",
         "lists its rays and draws none at random; leave out --seeds",
         "has no onsets, and its file has the seed of its rays; leave out --seeds, and try --set seed=N",
         "has no onsets, and its file has the seed of its rays; leave out --seeds, and try --set seed=N",
         "tries every float and draws nothing at random; leave out --seeds"},
        {"--against", options.against, nullptr, "compares only with the truth; leave out --against",
         "compares only with the truth; leave out --against",
         "tries every float and compares only with the truth; leave out --against"},
        {"--pictures", options.pictures == "all" ? "all" : "", "has one picture for all forms; leave out --pictures",
         "has no contact sheet; leave out --pictures", "has no contact sheet; leave out --pictures",
         "has no contact sheet; leave out --pictures"}};
}

}  // namespace

void require_allowed_changes(const SweepChangeOptions& options, SweepKind kind, const std::string& name) {
    if (kind == SweepKind::axes) return;
    for (const RefusalRow& row : list_refusals(options, kind)) {
        const char* const reason = row.reason(kind);
        if (row.value.empty() || reason == nullptr) continue;
        const std::string text = fmt::format(fmt::runtime(reason), row.value);
        throw InputError(fmt::format("{} {}: {} {}", row.option, row.value, name, text));
    }
}

std::string interrupted_text(SweepKind kind, const std::string& name) {
    if (kind == SweepKind::every_float)
        return fmt::format("interrupted in the floats of {}: its progress is kept for --resume", name);
    return fmt::format(
        "interrupted in the {} of {}: the results of this sweep are lost, those of finished sweeps are kept",
        unit_name(kind), name);
}

std::vector<std::filesystem::path> list_input_files(const std::filesystem::path& path, SweepKind kind,
                                                    const SweepChangeOptions& options,
                                                    const std::filesystem::path& data,
                                                    intersect::process::StopToken stop) {
    std::vector<std::filesystem::path> files{path};
    if (kind == SweepKind::edge_search)
        files.push_back(scene::sweep::EdgeSearchFile(path, data, read_changes(options).set, stop).scene.path);
    if (kind == SweepKind::every_float)
        if (const auto scene = scene::sweep::ExhaustiveFile(path, data, stop).scene) files.push_back(scene->path);
    if (kind != SweepKind::axes) return files;
    const auto scene = scene::sweep::SweepFile(path, data, read_changes(options), stop).scene_path();
    if (!scene.empty()) files.push_back(scene);
    return files;
}

}  // namespace lostbits::analysis::selection
