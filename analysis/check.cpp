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
#include "output/claim/claim_files.hpp"
#include "output/file/atomic_file.hpp"
#include "output/file/escape.hpp"
#include "output/file/number_text.hpp"
#include "scene/toml/counted.hpp"
#include "scene/toml/files_of_run.hpp"

namespace lostbits::analysis {

using measure::claim::ClaimResult;
using output::file::terminal_line;

namespace {

using scene::claim::Claim;
using State = ClaimResult::State;

struct CheckOptions {
    std::vector<std::string> files;
    std::vector<std::string> filters;
    std::string junit, csv, json, report, annotations = "none", shard;
    std::string profile = "results";
    bool strict = false, measure = false;
    int seeds = 0;

    [[nodiscard]] bool timing() const { return profile == "timing"; }
    [[nodiscard]] bool selects(const std::string& id) const {
        return filters.empty() || selection::matches_any(filters, id);
    }
};

std::vector<Claim> load(const CheckOptions& o, const std::filesystem::path& data) {
    std::vector<Claim> claims;
    std::set<std::string> ids;
    const auto profile = o.timing()                 ? Claim::Profile::timing
                         : o.profile == "libraries" ? Claim::Profile::libraries
                                                    : Claim::Profile::results;
    std::set<std::string> other_profiles;
    const auto claim_paths = o.files.empty() ? std::vector<std::string>{(data / "claims").string()} : o.files;
    for (const std::string& claim_path : claim_paths) {
        for (const auto& path : scene::claim::claim_files(claim_path)) {
            for (Claim& claim : scene::claim::read_claims(path)) {
                if (!ids.insert(claim.id).second)
                    scene::toml::fail(claim.where, "the id \"" + claim.id +
                                                       "\" is used in another file too; each id may be used once");
                const bool is_selected = o.selects(claim.id);
                if (is_selected && claim.profile != profile) other_profiles.emplace(name_of(claim.profile));
                else if (is_selected) claims.emplace_back(std::move(claim)).named = !o.files.empty();
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

void print(const Claim& claim, const ClaimResult& r, const CheckOptions& o, bool verbose) {
    const std::string_view verdict = name_of(claim.verdict);
    if (r.state == State::agrees) {
        const std::string floats = output::claim::floats_text(r), evidence = output::claim::evidence_text(claim, r);
        if (verbose)
            fmt::print("ok       {} ({}{}{}): {}\n", terminal_line(claim.id), verdict,
                       floats.empty() ? "" : ", " + floats, evidence.empty() ? "" : ", " + terminal_line(evidence),
                       output::file::decimal(r.measured));
        return;
    }
    const char* label = r.state != State::skipped && claim.severity == Claim::Severity::warn && !o.strict ? "warning"
                        : r.state == State::unmeasurable                                                  ? "broken"
                        : r.state == State::skipped                                                       ? "skipped"
                                                                                                          : "FAILED";
    const std::string problem = r.state == State::skipped        ? "cannot be measured on this machine"
                                : r.state == State::unmeasurable ? "could not be measured"
                                                                 : output::claim::changed_text(claim, r);
    fmt::print("{}: {}: {} ({})\n", label, problem, terminal_line(claim.id), terminal_line(claim.statement));
    fmt::print("         {}: {}\n", terminal_line(claim.where.text()), terminal_line(output::claim::explain(claim, r)));
    if (r.witness.x >= 0) {
        fmt::print("         worst ray: origin {} {} {}, direction {} {} {}\n",
                   output::file::hex(r.witness.ray.origin.x), output::file::hex(r.witness.ray.origin.y),
                   output::file::hex(r.witness.ray.origin.z), output::file::hex(r.witness.ray.direction.x),
                   output::file::hex(r.witness.ray.direction.y), output::file::hex(r.witness.ray.direction.z));
    }
    if (const std::string command = output::claim::explain_witness(claim, r); !command.empty())
        fmt::print("         explain it: {}\n", terminal_line(command));
    fmt::print("         reproduce: {}\n", terminal_line(output::claim::words_of(claim).command));
    if (o.annotations == "github" && r.state != State::skipped) {
        fmt::print("::{} file={},line={},title={}::{}\n", std::string_view(label) == "warning" ? "warning" : "error",
                   output::file::workflow_value(claim.where.source), claim.where.line,
                   output::file::workflow_value(claim.id),
                   output::file::workflow_text(output::claim::explain(claim, r)));
    }
}

/// `; 5 draws: 1.2 to 1.4, median 1.3; their interval is [1.1, 1.5]`.
std::string draws_text(const Claim& claim, const ClaimResult& r) {
    if (r.further_measured.empty()) return "";
    const auto s = r.spread();
    const std::size_t draws = 1 + r.further_measured.size();
    if (static_cast<std::size_t>(s.draws) < draws)
        return fmt::format("; only {} of {} draws have a value, so they give no interval", s.draws, draws);
    const auto interval = measure::claim::expected_interval(claim, r);
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
                   results[i].samples);
    }
}

/// Prints every claim about speed with its measured ratio. None fails, since a ratio of two speeds depends on the
/// machine and the minute.
Exit report_times(const std::vector<Claim>& claims, const std::vector<ClaimResult>& results) {
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
    return Exit::done;
}

/// The files that decide what claims measure.
std::vector<std::filesystem::path> files_of(const CheckOptions& o, const std::filesystem::path& data) {
    std::vector<std::filesystem::path> files;
    for (const std::string& path : o.files.empty() ? std::vector{(data / "claims").string()} : o.files)
        std::ranges::copy(scene::claim::claim_files(path), std::back_inserter(files));
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
void check_shard_options(const CheckOptions& o) {
    if (o.shard.empty()) return;
    if (o.report.empty())
        throw InputError("--shard " + o.shard +
                         ": needs a folder for the shards; add --report DIR, and join them by `lostbits merge DIR -o "
                         "REPORT`");
    if (o.timing() || o.measure || !o.junit.empty() || !o.csv.empty() || !o.json.empty() || o.annotations != "none")
        throw InputError(
            "--shard " + o.shard +
            ": cannot be combined with --junit, --export-csv, --export-json, --annotations, --measure or --profile "
            "timing: a shard does not judge claims; pass --junit, --export-csv and --export-json to `lostbits merge` "
            "instead");
}

Exit run(const CheckOptions& o, const Common& common) {
    check_shard_options(o);
    shell::require_different_files({{"--junit", o.junit}, {"--export-csv", o.csv}, {"--export-json", o.json}},
                                   {"--report", o.report});
    if (o.timing() && (o.strict || !o.junit.empty() || !o.csv.empty() || !o.json.empty() || !o.report.empty() ||
                       o.annotations != "none")) {
        throw InputError(
            "--profile timing cannot be combined with --strict, --junit, --export-csv, --export-json, --report or "
            "--annotations: claims about time never fail a check, and no report shows them; leave "
            "out --profile timing, or the other options");
    }
    if (o.measure && (!o.junit.empty() || !o.csv.empty() || !o.json.empty() || !o.report.empty())) {
        throw InputError(
            "--measure cannot be combined with --junit, --export-csv, --export-json or --report: it does not judge "
            "claims; leave out --measure, or the other options");
    }
    const auto data = selection::data_folder(common.data);
    const auto claims = load(o, data);
    const selection::ThreadLimit limit(common.threads);
    // Checks before the work that the reports can be written; they are small and written at the end.
    for (const std::string& path : {o.junit, o.csv, o.json}) {
        if (!path.empty()) output::file::AtomicFile probe(path);
    }
    // Only a shard records which files it read, so a whole run need not list the data folder.
    const bool is_whole_run = o.shard.empty() && !common.shards_to_join;
    RunDivision run_division =
        divide_run(o.shard, o.report, is_whole_run ? std::vector<std::filesystem::path>{} : files_of(o, data), common);
    run_division.division.expect({"check"});
    std::unique_ptr<output::file::ResultFolder> folder;
    if (!o.report.empty())
        folder = take_folder(run_division, o.report, common, common.typed_command.all_subjects(), {.shared = true});
    if (folder) require_writable(std::filesystem::path(o.report) / "README.md");
    const study::StudiesByName studies;
    const measure::claim::ClaimRequest request{
        .data_dir = data, .stop = common.stop, .further_draws = o.seeds, .studies = &studies};
    const auto measured = run_division.division.result_of("check", [&] {
        const auto units = run_division.division.share().of_units(claims.size());
        const std::vector<Claim> own_claims(claims.begin() + static_cast<std::ptrdiff_t>(units.first),
                                            claims.begin() + static_cast<std::ptrdiff_t>(units.last));
        return measure::claim::measure_claims(own_claims, request);
    });
    finish_run(run_division, common);
    if (!measured) return Exit::done;
    const auto& results = *measured;
    if (o.timing() && !o.measure) return report_times(claims, results);
    if (o.measure) {
        for (std::size_t i = 0; i < claims.size(); ++i)
            fmt::print("{} = {}{}\n", terminal_line(claims[i].id), output::file::decimal(results[i].measured),
                       draws_text(claims[i], results[i]));
        return Exit::done;
    }
    const auto counts = output::claim::count_verdicts(claims, results);
    const std::size_t agreed = counts.all.confirmed(), skipped = counts.all.skipped;
    std::size_t failed = 0;
    for (std::size_t i = 0; i < claims.size(); ++i) {
        print(claims[i], results[i], o, common.verbose);
        failed += results[i].state != State::agrees && results[i].state != State::skipped &&
                  (o.strict || claims[i].severity == Claim::Severity::error);
    }
    if (o.seeds > 0 && !common.quiet) print_spreads(claims, results);
    if (!o.junit.empty()) output::claim::write_junit(o.junit, claims, results, o.strict);
    if (!o.csv.empty()) output::claim::write_claims_csv(o.csv, claims, results);
    if (!o.json.empty()) output::claim::write_claims_json(o.json, claims, results);
    if (!o.report.empty()) output::claim::write_claim_report(o.report, claims, results, request);
    complete_folder(folder);
    if (!common.quiet) {
        // A confirmed verdict may be that a statement is wrong, so the counts by verdict follow.
        fmt::print("{} confirmed, {} failed{}\n", scene::toml::count_with_noun(agreed, "verdict"),
                   claims.size() - agreed - skipped, skipped == 0 ? "" : fmt::format(", {} skipped", skipped));
        if (agreed > 0) fmt::print("{}\n", counts.text());
    }
    if (skipped > 0 && skipped == claims.size()) {
        fmt::print(stderr, "lostbits: every claim was skipped, so nothing was checked; the reason of the first: {}\n",
                   terminal_line(results.front().reason));
        return Exit::nothing_selected;
    }
    return failed == 0 ? Exit::done : Exit::answer_is_no;
}

}  // namespace

void add_check(const shell::Command& program, const Common& common) {
    auto command =
        program.add_command("check", "Measure claims again, and compare the numbers with what the claims state");
    const auto o = std::make_shared<CheckOptions>();
    command.add("CLAIMS", o->files, "Claim files or folders (default: data/claims)");
    command.add_list("--filter", o->filters, "Measure only claims whose id matches a glob");
    command.add("--junit", o->junit, "Write JUnit XML");
    command.add("--export-csv", o->csv, "Write CSV, one row per claim");
    command.add("--export-json", o->json, "Write JSON, one object per claim");
    command.add("--report", o->report, "Write README.md, claims.csv and pictures into this folder");
    add_shard(command, o->shard);
    command.add("--annotations", o->annotations, "github: also print annotations that GitHub shows beside the code",
                shell::one_of({"none", "github"}));
    command.add("--profile", o->profile, "Kind of claims to measure (default: results; docs/claims.md)",
                shell::one_of({"results", "timing", "libraries"}));
    command.add("--seeds", o->seeds,
                "Also measure each claim about random rays on this many further draws, and show the spread",
                shell::whole_from(0, 1000));
    command.add("--strict", o->strict, "Also fail for claims of severity warn");
    command.add("--measure", o->measure, "Print the measured number of each claim, without judging it");
    command.runs([o, &common] { return run(*o, common); });
}

}  // namespace lostbits::analysis
