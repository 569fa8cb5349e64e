#include "analysis/selection/options.hpp"

#include <fmt/format.h>
#include <fnmatch.h>
#include <glob.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <string_view>
#include <thread>

#include "analysis/selection/select.hpp"
#include "number/error.hpp"
#include "output/attribution/explain_command.hpp"
#include "text/shell_word.hpp"

namespace lostbits::analysis::selection {

namespace {

/// Options that change no result.
constexpr std::array<std::string_view, 19> options_without_effect{
    "out",    "progress",    "quiet",   "verbose",    "threads",    "isa",        "force",
    "resume", "junit",       "isolate", "in-process", "time-limit", "export-csv", "export-json",
    "report", "annotations", "shard",   "save",       "moves"};

bool changes_results(const shell::Option& option) {
    return std::ranges::none_of(option.long_names(), [](const std::string& name) {
        return std::ranges::find(options_without_effect, name) != options_without_effect.end();
    });
}

/// ` -f f32 -f f64`, or ` --exr` for a flag.
std::string shell_text_of(const shell::Option& option) {
    const std::string name =
        option.short_names().empty() ? "--" + option.long_names().front() : "-" + option.short_names().front();
    if (!option.takes_value()) return " " + name;
    std::string text;
    for (const std::string& value : option.given_values()) text += " " + name + " " + text::shell_word(value);
    return text;
}

/// Adds the options and arguments that were given.
void add_given_options(const shell::Command& command, TypedCommand& typed) {
    for (const shell::Option& option : command.options()) {
        if (option.given_values().empty() || !changes_results(option)) continue;
        if (option.is_argument()) {
            for (const std::string& value : option.given_values()) typed.subjects += " " + text::shell_word(value);
        } else typed.options += shell_text_of(option);
    }
}

}  // namespace

bool matches_any(const std::vector<std::string>& patterns, const std::string& name) {
    return std::ranges::any_of(patterns,
                               [&name](const auto& pattern) { return fnmatch(pattern.c_str(), name.c_str(), 0) == 0; });
}

void add_scenes(const shell::Command& command, SharedOptions& shared, const std::string& kinds) {
    command.add("SCENE", shared.scenes.names, "Scene files or names in data/scenes" + kinds).required();
}

void add_forms(const shell::Command& command, std::vector<std::string>& forms, const std::string& default_text) {
    command.add_list("-i,--form", forms, "Forms, by name or glob (default: " + default_text + ")");
}

void add_formats(const shell::Command& command, std::vector<std::string>& formats, const std::string& default_text) {
    command.add_list("-f,--format", formats,
                     "Formats: f32, f64, fp16, bf16, tf32, pN, pA..pB (default: " + default_text + ")");
}

void add_pixels(const shell::Command& command, SharedOptions& shared) {
    command.add("--pixels", shared.pixels, "csv: also write one row per pixel", shell::one_of({"none", "csv"}));
}

void add_pictures(const shell::Command& command, std::string& pictures) {
    command.add("--pictures", pictures,
                "sheets: write contact sheets (default); all: also write each picture of a sheet as a file of its own",
                shell::one_of({"sheets", "all"}));
}

void add_out(const shell::Command& command, std::string& out, const std::string& contents) {
    out = "out/" + command.name();
    const std::string rest =
        command.name() == "report"
            ? ""
            : "; each scene or file has a subfolder in it. With -, only the table is written, to standard output";
    command.add("-o,--out", out, "Folder for " + contents + " (default: " + out + ")" + rest);
}

void add_changes(const shell::Command& command, SceneOptions& scenes, const std::string& example) {
    command.add("--size", scenes.size, "Picture size, WxH in pixels (default: the scene's)");
    command.add("--variant", scenes.variant, "One variant of a scene that has several (default: all)");
    command.add_set(scenes.set, "Change a number of the scene first: " + example);
}

namespace {

std::vector<std::string> files_matching(const std::string& pattern) {
    glob_t found{};
    std::vector<std::string> files;
    if (glob(pattern.c_str(), 0, nullptr, &found) == 0) files.assign(found.gl_pathv, found.gl_pathv + found.gl_pathc);
    globfree(&found);
    return files;
}

}  // namespace

void find_in_data(const shell::Command& command, const std::string& data) {
    constexpr std::string_view prefix = "data/";
    for (const shell::Option& option : command.options()) {
        if (!option.is_argument()) continue;
        std::vector<std::string> values;
        for (const std::string& value : option.given_values()) {
            std::vector<std::string> found;
            if (value.starts_with(prefix) && files_matching(value).empty())
                found = files_matching((data_folder(data) / value.substr(prefix.size())).string());
            if (found.empty()) found.push_back(value);
            std::ranges::move(found, std::back_inserter(values));
        }
        if (values != option.given_values()) option.replace(values);
    }
}

using measure::metric::Metric;
using measure::metric::Ramp;

namespace {

std::optional<double> parse_finite(std::string_view text) {
    double value = 0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool is_number = error == std::errc{} && stop == text.data() + text.size() && std::isfinite(value);
    return is_number ? std::optional(value) : std::nullopt;
}

}  // namespace

std::optional<output::map::BarRange> parse_range(const std::string& text,
                                                 const std::vector<const Metric*>& drawn_metrics) {
    if (text.empty()) return std::nullopt;
    const std::size_t colon = text.find(':');
    const auto lo = parse_finite(std::string_view(text).substr(0, colon));
    const std::string_view last = colon == std::string::npos ? "" : std::string_view(text).substr(colon + 1);
    const auto hi = parse_finite(last);
    if (!lo || !hi || !(*lo < *hi))
        throw InputError(fmt::format(
            "--range {}: is not a range; write its ends in the unit of the metric, the lower one first, like 0:24",
            text));

    // All drawn metrics must have the same kind of bar.
    const Metric* first = nullptr;
    for (const Metric* m : drawn_metrics) {
        if (m->ramp == Ramp::categories) continue;
        if (first && (m->unit != first->unit || (m->ramp == Ramp::magnitude) != (first->ramp == Ramp::magnitude)))
            throw InputError(
                fmt::format("--range {}: {} and {} cannot share one range, because their units or scales differ; draw "
                            "them in two runs",
                            text, first->name, m->name));
        first = m;
    }

    if (!first)
        throw InputError(
            fmt::format("--range {}: the drawn metrics have categories, not a scale; leave out --range", text));
    if (first->ramp == Ramp::magnitude && !(*lo > 0))
        throw InputError(fmt::format("--range {}: the bar of {} is logarithmic; write ends above 0, like 1:1000", text,
                                     first->name));
    return output::map::BarRange{*lo, *hi};
}

std::vector<std::string> split_shell_words(const std::string& command) {
    std::vector<std::string> words;
    bool is_quoted = false, is_in_word = false;
    for (std::size_t i = 0; i < command.size(); ++i) {
        const char c = command[i];
        if (c == ' ' && !is_quoted) {
            is_in_word = false;
            continue;
        }
        if (!is_in_word) words.emplace_back();
        is_in_word = true;
        if (c == '\'') is_quoted = !is_quoted;
        else if (c == '\\' && !is_quoted && i + 1 < command.size()) words.back() += command[++i];
        else words.back() += c;
    }
    return words;
}

TypedCommand typed_command(const shell::Command& program) {
    TypedCommand result;
    for (const shell::Command& command : program.given_commands()) {
        result.command_name += (result.command_name.empty() ? "" : " ") + command.name();
        add_given_options(command, result);
    }
    return result;
}

struct ThreadLimit::Control {
    tbb::global_control limit;
};

ThreadLimit::ThreadLimit(int thread_count) {
    const auto count = static_cast<std::size_t>(
        thread_count > 0 ? thread_count : static_cast<int>(std::max(1U, std::thread::hardware_concurrency())));
    control_.reset(new Control{{tbb::global_control::max_allowed_parallelism, count}});
}

ThreadLimit::~ThreadLimit() = default;

}  // namespace lostbits::analysis::selection
