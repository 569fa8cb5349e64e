#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <memory>
#include <optional>
#include <set>

#include "analysis/selection/options.hpp"
#include "analysis/selection/select.hpp"
#include "analysis/shell/command_line.hpp"
#include "analysis/study/studies_by_name.hpp"
#include "commands.hpp"
#include "number/error.hpp"
#include "output/check/claim_files.hpp"
#include "output/file/atomic_file.hpp"
#include "output/file/escape.hpp"
#include "output/file/number_text.hpp"
#include "scene/toml/files_of_run.hpp"
#include "text/count_with_noun.hpp"
#include "text/did_you_mean.hpp"

namespace lostbits::analysis {

using measure::check::ClaimResult;
using output::file::terminal_line;

namespace {

using scene::check::Claim;
using State = ClaimResult::State;

struct CheckOptions {
    std::vector<std::string> files;
    std::vector<std::string> filters;
    std::string junit, csv, json, report, annotations = "none", shard;
    std::string profile = "results";
    bool strict = false, prints_numbers_only = false;
    int further_draw_count = 0;

    [[nodiscard]] bool is_timing() const { return profile == "timing"; }
    [[nodiscard]] bool writes_files() const {
        return !junit.empty() || !csv.empty() || !json.empty() || !report.empty();
    }
    [[nodiscard]] bool selects(const std::string& id) const {
        return filters.empty() || selection::matches_any(filters, id);
    }
};

/// Throws InputError if the path of a claim file or of a folder does not exist. Suggests the claim file of the data
/// folder with the nearest name.
void require_claim_path(const std::string& path, const std::filesystem::path& data) {
    std::error_code error;
    if (std::filesystem::status(path, error).type() != std::filesystem::file_type::not_found) return;
    const std::filesystem::path folder = data / "claims";
    std::vector<std::string> names;
    if (std::filesystem::is_directory(folder, error))
        for (const auto& claim_file : scene::check::list_claim_files(folder))
            names.push_back(claim_file.stem().string());
    const auto closest_name = text::closest(std::filesystem::path(path).stem().string(), names);
    throw InputError(path + ": no such file or folder; " +
                     (closest_name ? "did you mean \"" + (folder / (*closest_name + ".toml")).string() + "\"?"
                                   : "name a claim file, or a folder of claim files such as " + folder.string()));
}

std::vector<Claim> load_claims(const CheckOptions& options, const std::filesystem::path& data) {
    const auto profile = options.is_timing()              ? Claim::Profile::timing
                         : options.profile == "libraries" ? Claim::Profile::libraries
                                                          : Claim::Profile::results;
    const auto claim_paths =
        options.files.empty() ? std::vector<std::string>{(data / "claims").string()} : options.files;

    // An id may be used only once in all files.
    std::vector<Claim> claims;
    std::set<std::string> ids, other_profiles;
    for (const std::string& claim_path : claim_paths) {
        require_claim_path(claim_path, data);
        for (const auto& path : scene::check::list_claim_files(claim_path)) {
            for (Claim& claim : scene::check::read_claims(path)) {
                if (!ids.insert(claim.id).second)
                    scene::toml::fail(claim.where, "the id \"" + claim.id +
                                                       "\" is used in another file too; each id may be used once");
                const bool is_selected = options.selects(claim.id);
                if (is_selected && claim.profile != profile) other_profiles.emplace(name_of(claim.profile));
                else if (is_selected) claims.emplace_back(std::move(claim)).named = !options.files.empty();
            }
        }
    }

    if (claims.empty() && !other_profiles.empty())
        throw NothingSelected(
            fmt::format("no claim is selected: the claims that match have another profile; try --profile {}",
                        fmt::join(other_profiles, ", ")));
    if (claims.empty()) throw NothingSelected("no claim is selected; see --filter, or `lostbits list claims`");
    return claims;
}

void print_agreement(const Claim& claim, const ClaimResult& result) {
    const std::string floats = output::check::floats_text(result),
                      evidence = output::check::evidence_text(claim, result);
    fmt::print("ok       {} ({}{}{}): {}\n", terminal_line(claim.id), name_of(claim.verdict),
               floats.empty() ? "" : ", " + floats, evidence.empty() ? "" : ", " + terminal_line(evidence),
               output::file::decimal(result.measured));
}

/// Prints the annotation that GitHub shows beside the line of the claim.
void print_annotation(const Claim& claim, const ClaimResult& result, bool is_warning) {
    fmt::print("::{} file={},line={},title={}::{}\n", is_warning ? "warning" : "error",
               output::file::workflow_value(claim.where.source), claim.where.line,
               output::file::workflow_value(claim.id),
               output::file::workflow_text(output::check::explanation_text(claim, result)));
}

void print(const Claim& claim, const ClaimResult& result, const CheckOptions& options, bool verbose) {
    if (result.state == State::agrees) {
        if (verbose) print_agreement(claim, result);
        return;
    }

    // The first line says what is wrong, the others where, on which ray, and how to see it again.
    const bool is_warning =
        result.state != State::skipped && claim.severity == Claim::Severity::warn && !options.strict;
    const char* const label = is_warning                            ? "warning"
                              : result.state == State::unmeasurable ? "broken"
                              : result.state == State::skipped      ? "skipped"
                                                                    : "FAILED";
    const std::string problem = result.state == State::skipped        ? "cannot be measured on this machine"
                                : result.state == State::unmeasurable ? "could not be measured"
                                                                      : output::check::disagreement_text(claim, result);
    fmt::print("{}: {}: {} ({})\n", label, problem, terminal_line(claim.id), terminal_line(claim.statement));
    fmt::print("         {}: {}\n", terminal_line(claim.where.text()),
               terminal_line(output::check::explanation_text(claim, result)));
    if (result.witness.x >= 0) {
        const Ray<double>& ray = result.witness.ray;
        fmt::print("         worst ray: origin {} {} {}, direction {} {} {}\n", output::file::hex(ray.origin.x),
                   output::file::hex(ray.origin.y), output::file::hex(ray.origin.z), output::file::hex(ray.direction.x),
                   output::file::hex(ray.direction.y), output::file::hex(ray.direction.z));
    }
    if (const std::string command = output::check::witness_command(claim, result); !command.empty())
        fmt::print("         explain it: {}\n", terminal_line(command));
    fmt::print("         reproduce: {}\n", terminal_line(output::check::subject_texts(claim).command));

    if (options.annotations == "github" && result.state != State::skipped) print_annotation(claim, result, is_warning);
}

/// `; 5 draws: 1.2 to 1.4, median 1.3; their interval is [1.1, 1.5]`.
std::string draws_text(const Claim& claim, const ClaimResult& result) {
    if (result.further_measured.empty()) return "";
    const auto s = result.spread();
    const std::size_t draw_count = 1 + result.further_measured.size();
    if (static_cast<std::size_t>(s.draws) < draw_count)
        return fmt::format("; only {} of {} draws have a value, so they give no interval", s.draws, draw_count);
    const auto interval = measure::check::expected_interval(claim, result);
    return fmt::format("; {} draws: {} to {}, median {}; their interval is [{}, {}]", s.draws,
                       output::file::decimal(s.low), output::file::decimal(s.high), output::file::decimal(s.median),
                       output::file::decimal(interval.low), output::file::decimal(interval.high));
}

/// Prints a table of the values that claims about random rays measure in several draws.
void print_spreads(const std::vector<Claim>& claims, const std::vector<ClaimResult>& results) {
    if (std::ranges::none_of(results, &ClaimResult::is_random)) return;
    constexpr const char* line_format = "{:<44} {:>12} {:>12} {:>12} {:>12}  {:<26} {}\n";
    fmt::print(line_format, "claims about random rays", "own draw", "lowest", "median", "highest", "interval",
               "samples");
    for (std::size_t i = 0; i < claims.size(); ++i) {
        if (!results[i].is_random()) continue;
        const auto s = results[i].spread();
        const auto text = [](double x) { return fmt::format("{:.6g}", x); };
        fmt::print(line_format, terminal_line(claims[i].id), text(results[i].measured), text(s.low), text(s.median),
                   text(s.high), fmt::format("[{}, {}]", text(claims[i].low), text(claims[i].high)),
                   results[i].sample_count);
    }
}

/// Prints every claim about speed with its measured ratio. None fails, since a ratio of two speeds depends on the
/// machine and the minute.
ExitStatus report_times(const std::vector<Claim>& claims, const std::vector<ClaimResult>& results) {
    for (std::size_t i = 0; i < claims.size(); ++i) {
        const Claim& c = claims[i];
        const bool is_measured = results[i].state == State::agrees || results[i].state == State::disagrees;
        const char* label = results[i].state == State::agrees    ? "as found"
                            : is_measured                        ? "differs"
                            : results[i].state == State::skipped ? "skipped"
                                                                 : "broken";
        fmt::print("{:<8} {:<9} {:>5} in [{}, {}]  {}: {}\n", label, name_of(c.verdict),
                   is_measured ? fmt::format("{:.2f}", results[i].measured) : "-", c.low, c.high, terminal_line(c.id),
                   terminal_line(is_measured ? c.statement : results[i].reason));
    }
    return ExitStatus::done;
}

/// The files that decide what claims measure.
std::vector<std::filesystem::path> input_files(const CheckOptions& options, const std::filesystem::path& data) {
    std::vector<std::filesystem::path> files;
    for (const std::string& path : options.files.empty() ? std::vector{(data / "claims").string()} : options.files)
        std::ranges::copy(scene::check::list_claim_files(path), std::back_inserter(files));
    for (const char* folder : {"scenes", "sweeps"}) {
        std::error_code ignored;
        std::vector<std::filesystem::path> folder_files;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(data / folder, ignored)) {
            if (entry.path().extension() == ".toml") folder_files.push_back(entry.path());
        }
        std::ranges::sort(folder_files);
        std::ranges::copy(folder_files, std::back_inserter(files));
    }
    return files;
}

/// Throws InputError if a shard gets options for files that only the whole run can write.
void require_shard_options(const CheckOptions& options) {
    if (options.shard.empty()) return;
    if (options.report.empty())
        throw InputError(
            "--shard " + options.shard +
            ": needs a folder for the shards; add --report FOLDER, and join them by `lostbits merge FOLDER -o "
            "REPORT`");
    if (options.is_timing() || options.prints_numbers_only || !options.junit.empty() || !options.csv.empty() ||
        !options.json.empty() || options.annotations != "none")
        throw InputError(
            "--shard " + options.shard +
            ": cannot be combined with --junit, --export-csv, --export-json, --annotations, --measure or --profile "
            "timing: a shard does not judge claims; pass --junit, --export-csv and --export-json to `lostbits "
            "merge` instead");
}

/// Throws InputError for options that do not go with --profile timing or --measure, for shards and for files.
void require_compatible_options(const CheckOptions& options) {
    require_shard_options(options);
    shell::require_different_files(
        {{"--junit", options.junit}, {"--export-csv", options.csv}, {"--export-json", options.json}},
        {"--report", options.report});
    if (options.is_timing() && (options.strict || options.writes_files() || options.annotations != "none"))
        throw InputError(
            "--profile timing: cannot be combined with --strict, --junit, --export-csv, --export-json, --report or "
            "--annotations: claims about time never fail a check, and no report shows them; leave "
            "out --profile timing, or the other options");
    if (options.prints_numbers_only && options.writes_files())
        throw InputError(
            "--measure: cannot be combined with --junit, --export-csv, --export-json or --report: it does not judge "
            "claims; leave out --measure, or the other options");
}

RunDivision divide_check(const CheckOptions& options, const std::filesystem::path& data, const CommonOptions& common) {
    // Only a shard records which files it read, so a whole run need not list the data folder.
    const bool is_whole_run = options.shard.empty() && !common.shards_to_join;
    RunDivision run_division =
        divide_run(options.shard, options.report,
                   is_whole_run ? std::vector<std::filesystem::path>{} : input_files(options, data), common);
    run_division.division.require_same_jobs({"check"});
    return run_division;
}

/// The folder of --report; null without one, and in a shard.
std::unique_ptr<output::file::ResultFolder> lock_report_folder(const CheckOptions& options,
                                                               const RunDivision& run_division,
                                                               const CommonOptions& common) {
    if (options.report.empty()) return nullptr;
    auto folder =
        lock_folder(run_division, options.report, common, common.typed_command.all_subjects(), {.is_shared = true});
    if (folder) require_writable(std::filesystem::path(options.report) / "README.md");
    return folder;
}

/// Measures the claims. A shard measures and records its part of them, and returns nothing.
std::optional<std::vector<ClaimResult>> measure_claims(const std::vector<Claim>& claims,
                                                       const measure::check::ClaimRequest& request,
                                                       shard::Division& division) {
    return division.measure_or_join("check", [&] {
        const auto units = division.share().unit_range(claims.size());
        const std::vector<Claim> shard_claims(claims.begin() + static_cast<std::ptrdiff_t>(units.first),
                                              claims.begin() + static_cast<std::ptrdiff_t>(units.last));
        return measure::check::measure_claims(shard_claims, request);
    });
}

void print_measured_numbers(const std::vector<Claim>& claims, const std::vector<ClaimResult>& results) {
    for (std::size_t i = 0; i < claims.size(); ++i)
        fmt::print("{} = {}{}\n", terminal_line(claims[i].id), output::file::decimal(results[i].measured),
                   draws_text(claims[i], results[i]));
}

void write_reports(const CheckOptions& options, const std::vector<Claim>& claims,
                   const std::vector<ClaimResult>& results, const measure::check::ClaimRequest& request) {
    if (!options.junit.empty()) output::check::write_junit(options.junit, claims, results, options.strict);
    if (!options.csv.empty()) output::check::write_claims_csv(options.csv, claims, results);
    if (!options.json.empty()) output::check::write_claims_json(options.json, claims, results);
    if (!options.report.empty()) output::check::write_claim_report(options.report, claims, results, request);
}

bool fails(const Claim& claim, const ClaimResult& result, bool is_strict) {
    return result.state != State::agrees && result.state != State::skipped &&
           (is_strict || claim.severity == Claim::Severity::error);
}

void print_counts(const std::vector<Claim>& claims, const std::vector<ClaimResult>& results) {
    const auto counts = output::check::count_verdicts(claims, results);
    const std::size_t agreeing_count = counts.all.agreeing_count(), skipped = counts.all.skipped;
    // "Confirmed" means that the verdict still holds, and the verdict may be that the statement is wrong. So the second
    // line counts them by verdict.
    fmt::print("{} confirmed, {} failed{}\n", text::count_with_noun(agreeing_count, "verdict"),
               claims.size() - agreeing_count - skipped, skipped == 0 ? "" : fmt::format(", {} skipped", skipped));
    if (agreeing_count > 0) fmt::print("{}\n", counts.text());
}

ExitStatus run(const CheckOptions& options, const CommonOptions& common) {
    require_compatible_options(options);
    const auto data = selection::data_folder(common.data);
    const auto claims = load_claims(options, data);
    const selection::ThreadLimit limit(common.threads);

    // Checks before the work that the reports can be written; they are small and written at the end.
    for (const std::string& path : {options.junit, options.csv, options.json}) {
        if (!path.empty()) output::file::AtomicFile probe(path);
    }
    RunDivision run_division = divide_check(options, data, common);
    const auto folder = lock_report_folder(options, run_division, common);

    const study::StudiesByName studies;
    const measure::check::ClaimRequest request{
        .data_dir = data, .stop = common.stop, .further_draw_count = options.further_draw_count, .studies = &studies};
    const auto measured = measure_claims(claims, request, run_division.division);
    finish_run(run_division, common);
    if (!measured) return ExitStatus::done;

    const auto& results = *measured;
    if (options.is_timing() && !options.prints_numbers_only) return report_times(claims, results);
    if (options.prints_numbers_only) {
        print_measured_numbers(claims, results);
        return ExitStatus::done;
    }

    bool any_fails = false;
    for (std::size_t i = 0; i < claims.size(); ++i) {
        print(claims[i], results[i], options, common.verbose);
        any_fails |= fails(claims[i], results[i], options.strict);
    }
    if (options.further_draw_count > 0 && !common.quiet) print_spreads(claims, results);
    write_reports(options, claims, results, request);
    complete_folder(folder);
    if (!common.quiet) print_counts(claims, results);

    const auto is_skipped = [](const ClaimResult& result) { return result.state == State::skipped; };
    if (!results.empty() && std::ranges::all_of(results, is_skipped)) {
        fmt::print(stderr, "lostbits: every claim was skipped, so nothing was checked; the reason of the first: {}\n",
                   terminal_line(results.front().reason));
        return ExitStatus::nothing_selected;
    }
    return any_fails ? ExitStatus::answer_is_no : ExitStatus::done;
}

}  // namespace

void add_check(const shell::Command& program, const CommonOptions& common) {
    auto command =
        program.add_command("check", "Measure claims again, and compare the numbers with what the claims state");
    const auto options = std::make_shared<CheckOptions>();
    command.add("CLAIMS", options->files, "Claim files or folders (default: data/claims)");
    command.add_list("--filter", options->filters, "Measure only claims whose id matches a glob");

    // Outputs.
    command.add("--junit", options->junit, "Write JUnit XML");
    command.add("--export-csv", options->csv, "Write CSV, one row per claim");
    command.add("--export-json", options->json, "Write JSON, one object per claim");
    command.add("--report", options->report, "Write README.md, claims.csv and pictures into this folder");
    add_shard(command, options->shard);
    command.add("--annotations", options->annotations,
                "github: also print annotations that GitHub shows beside the code", shell::one_of({"none", "github"}));

    // Claims to measure, and how they are judged.
    command.add("--profile", options->profile, "Kind of claims to measure (default: results; docs/claims.md)",
                shell::one_of({"results", "timing", "libraries"}));
    command.add("--seeds", options->further_draw_count,
                "Also measure each claim about random rays on this many further draws, and show the spread",
                shell::whole_number_between(0, 1000));
    command.add("--strict", options->strict, "Also fail for claims of severity warn");
    command.add("--measure", options->prints_numbers_only,
                "Print the measured number of each claim, without judging it");
    command.set_action([options, &common] { return run(*options, common); });
}

}  // namespace lostbits::analysis
