#include "output/claim/claim_history.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <set>
#include <string_view>
#include <utility>

#include "number/error.hpp"
#include "output/claim/claim_files.hpp"
#include "output/file/atomic_file.hpp"
#include "output/file/escape.hpp"
#include "output/file/json.hpp"
#include "output/file/number_text.hpp"
#include "output/file/read_csv.hpp"
#include "output/image/exr_parts.hpp"
#include "scene/toml/counted.hpp"

namespace lostbits::output::claim {

namespace {

constexpr const char* baseline_schema = "lostbits-baseline/1";

/// Compares bits. NaN equals NaN: nothing was measured.
bool same_number(double x, double y) {
    return (std::isnan(x) && std::isnan(y)) || std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
}

bool is_same(const MeasuredClaim& a, const MeasuredClaim& b) {
    return a.state == b.state && a.quantity == b.quantity && same_number(a.measured, b.measured);
}

/// `+0.38 %`; empty if there is no ratio.
std::string change_text(const ClaimMove& move) {
    if (!move.before || !move.now) return "";
    const double x = move.before->measured, y = move.now->measured;
    if (!std::isfinite(x) || !std::isfinite(y) || same_number(x, y)) return "";
    return x == 0 ? "" : fmt::format("{:+.3g} %", (y - x) / std::fabs(x) * 100);
}

std::string state_text(const ClaimMove& move) {
    if (!move.before) return "new: " + move.now->state;
    if (!move.now) return "gone";
    const bool same = move.before->state == move.now->state;
    return (same ? move.now->state : move.before->state + " -> " + move.now->state) +
           (move.before->quantity == move.now->quantity ? "" : ", but of another quantity");
}

std::string interval_text(const ClaimMove& move) {
    const MeasuredClaim& claim = move.now ? *move.now : *move.before;
    return fmt::format("[{}, {}]", file::decimal(claim.low), file::decimal(claim.high));
}

std::string measured_text(const std::optional<MeasuredClaim>& claim) {
    return !claim ? "" : std::isnan(claim->measured) ? "-" : file::decimal(claim->measured);
}

std::string summary_text(const ClaimMoves& moves) {
    const std::size_t n = moves.moves.size();
    const bool foreign = n > 0 && moves.same == 0 &&
                         std::ranges::none_of(moves.moves, [](const auto& move) { return move.before && move.now; });
    if (foreign) return "no claim is in both runs: the earlier run had other claims, or --filter leaves them out";
    return n == 0 ? fmt::format("no measured value moved; {} {} the same", moves.same, moves.same == 1 ? "is" : "are")
                  : fmt::format("{} moved, {} {} the same", scene::toml::counted(n, "measured value"), moves.same,
                                moves.same == 1 ? "is" : "are");
}

constexpr const char* remedy = "name a file that `lostbits check --save` wrote";

/// Error that says what is wrong with a file.
InputError wrong(const std::filesystem::path& path, const std::string& what) {
    return InputError(path.string() + ": " + file::terminal_line(what) + "; " + remedy);
}

/// Reads a hexadecimal float, or `inf`, `-inf` and `nan`.
double number_in(const nlohmann::json& hex, const std::filesystem::path& path) {
    const auto& text = hex.get_ref<const std::string&>();
    const auto x = file::number_in(text);
    if (!x) throw wrong(path, "\"" + text + "\" is not a number in the range of a double");
    return *x;
}

MeasuredClaim claim_in(const nlohmann::json& json, const std::filesystem::path& path) {
    MeasuredClaim claim{.id = json.at("id").get<std::string>(),
                        .quantity = json.at("quantity").get<std::string>(),
                        .state = json.at("state").get<std::string>(),
                        .measured = number_in(json.at("measured_hex"), path),
                        .low = number_in(json.at("expected_hex").at(0), path),
                        .high = number_in(json.at("expected_hex").at(1), path)};
    if (std::ranges::find(state_names, claim.state) == state_names.end())
        throw wrong(path, "it has the claim " + claim.id + " in the state \"" + claim.state +
                              "\", which is not a state of claims");
    const auto& decimal = json.at("measured");
    const bool same = decimal.is_string() ? decimal.get<std::string>() == file::decimal(claim.measured)
                                          : same_number(decimal.get<double>(), claim.measured);
    if (!same)
        throw wrong(path, "it says that " + claim.id + " measured " + decimal.dump() + " and, in hexadecimal, " +
                              file::decimal(claim.measured) + ": one of the two was edited");
    return claim;
}

std::string made_text(const ClaimBaseline& run) {
    return file::terminal_line(fmt::format("{}, {}: {}", run.program, run.compiler, run.command));
}

}  // namespace

ClaimBaseline baseline_of(const std::vector<scene::claim::Claim>& claims,
                          const std::vector<measure::claim::ClaimResult>& results, const std::string& program,
                          const std::string& command) {
    ClaimBaseline run{program, image::compiler_attribute().second, command};
    for (std::size_t i = 0; i < claims.size(); ++i)
        run.claims.push_back({.id = claims[i].id,
                              .quantity = quantity(claims[i]),
                              .state = state_name(results[i].state),
                              .measured = results[i].measured,
                              .low = claims[i].low,
                              .high = claims[i].high});
    return run;
}

std::string baseline_text(const ClaimBaseline& baseline) {
    auto claims = file::OrderedJson::array();
    for (const MeasuredClaim& c : baseline.claims)
        claims.push_back({{"id", c.id},
                          {"quantity", c.quantity},
                          {"state", c.state},
                          {"measured", file::json_number(c.measured)},
                          {"measured_hex", file::hex(c.measured)},
                          {"expected_hex", {file::hex(c.low), file::hex(c.high)}}});
    const file::OrderedJson all{{"schema", baseline_schema},
                                {"program", baseline.program},
                                {"compiler", baseline.compiler},
                                {"command", baseline.command},
                                {"claims", claims}};
    return file::json_text(all);
}

void write_baseline(const std::filesystem::path& path, const ClaimBaseline& baseline) {
    file::write_file(path, baseline_text(baseline));
}

ClaimBaseline read_baseline(const std::filesystem::path& path) {
    const std::string text = file::read_file(path);
    ClaimBaseline run;
    try {
        const auto all = nlohmann::json::parse(text);
        const std::string schema = all.value("schema", "");
        if (schema != baseline_schema)
            throw wrong(path, fmt::format("it has {}, but only {} can be read",
                                          schema.empty() ? "no schema" : "the schema " + schema, baseline_schema));
        run.program = all.at("program").get<std::string>();
        run.compiler = all.at("compiler").get<std::string>();
        run.command = all.at("command").get<std::string>();
        std::set<std::string> ids;
        for (const auto& claim : all.at("claims")) {
            run.claims.push_back(claim_in(claim, path));
            if (!ids.insert(run.claims.back().id).second)
                throw wrong(path, "it has the claim " + run.claims.back().id + " twice");
        }
    } catch (const nlohmann::json::parse_error& error) {
        const std::string_view before = std::string_view(text).substr(0, std::max<std::size_t>(error.byte, 1) - 1);
        const auto line_begin = before.rfind('\n') + 1;  // 0 if npos
        throw InputError(fmt::format("{}:{}:{}: not valid JSON from here on; {}", path.string(),
                                     1 + std::ranges::count(before, '\n'), before.size() - line_begin + 1, remedy));
    } catch (const nlohmann::json::exception&) {
        throw wrong(path, "it is not a baseline: a key is missing or has the wrong type");
    }
    return run;
}

std::string ClaimMove::words() const {
    if (!before) return "new, not in the earlier run";
    if (!now) return "in the earlier run only";
    const std::string change = change_text(*this);
    return fmt::format("{} before, {} now{}, {}", measured_text(before), measured_text(now),
                       change.empty() ? "" : " (" + change + ")", state_text(*this));
}

ClaimMoves moves_between(const ClaimBaseline& before, const ClaimBaseline& now) {
    ClaimMoves found;
    const auto with_id = [](const ClaimBaseline& run, const std::string& id) {
        const auto at = std::ranges::find(run.claims, id, &MeasuredClaim::id);
        return at == run.claims.end() ? std::nullopt : std::optional(*at);
    };
    for (const MeasuredClaim& claim : now.claims) {
        const auto earlier = with_id(before, claim.id);
        if (earlier && is_same(*earlier, claim)) ++found.same;
        else found.moves.push_back({earlier, claim});
    }
    for (const MeasuredClaim& claim : before.claims) {
        if (!with_id(now, claim.id)) found.moves.push_back({claim, std::nullopt});
    }
    return found;
}

std::string moves_text(const ClaimBaseline& before, const ClaimBaseline& now, const ClaimMoves& moves) {
    std::string text =
        fmt::format("before: {}\nnow:    {}\n{}\n", made_text(before), made_text(now), summary_text(moves));
    if (moves.moves.empty()) return text;
    constexpr const char* row = "  {:<44} {:>14} {:>14} {:>12}  {:<26} {}\n";
    text += fmt::format(row, "claim", "before", "now", "change", "interval", "state");
    for (const ClaimMove& move : moves.moves)
        text += fmt::format(row, file::terminal_line(move.id()), measured_text(move.before), measured_text(move.now),
                            change_text(move), interval_text(move), file::terminal_line(state_text(move)));
    return text;
}

void write_moves(const std::filesystem::path& path, const ClaimBaseline& before, const ClaimBaseline& now,
                 const ClaimMoves& moves) {
    std::string text = fmt::format(
        "# What claims measure, before and now\n\n{}.\n\n| | program | compiler | command |\n"
        "|---|---|---|---|\n",
        summary_text(moves));
    for (const auto& [name, run] : {std::pair("before", &before), {"now", &now}})
        text += fmt::format("| {} | {} | {} | {} |\n", name, file::markdown_text(run->program),
                            file::markdown_text(run->compiler), file::markdown_code(run->command));
    if (!moves.moves.empty())
        text += "\n| claim | quantity | before | now | change | interval | state |\n|---|---|---:|---:|---:|---|---|\n";
    for (const ClaimMove& move : moves.moves)
        text += fmt::format("| {} | {} | {} | {} | {} | {} | {} |\n", file::markdown_text(move.id()),
                            file::markdown_text((move.now ? *move.now : *move.before).quantity),
                            measured_text(move.before), measured_text(move.now), change_text(move), interval_text(move),
                            file::markdown_text(state_text(move)));
    file::write_file(path, text);
}

}  // namespace lostbits::output::claim
