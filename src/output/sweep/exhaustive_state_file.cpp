#include "output/sweep/exhaustive_state_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <bit>
#include <charconv>
#include <sstream>

#include "number/error.hpp"
#include "output/file/atomic_file.hpp"
#include "output/file/read_csv.hpp"

namespace lostbits::output::sweep {

using measure::answer::Outcome;
using measure::sweep::ExhaustiveRequest;
using measure::sweep::ExhaustiveState;
using measure::sweep::FloatTally;

namespace {

constexpr std::string_view heading = "lostbits-unfinished/3";

/// Whole numbers with spaces between them; what there is not is `-`.
std::string tally_text(std::size_t place, const FloatTally& t) {
    const auto wrong = [](const std::optional<FloatTally::Wrong>& w) {
        return w ? fmt::format("{} {}", w->place, static_cast<int>(w->outcome)) : std::string("- -");
    };
    std::string text = fmt::format("{} {}", place, fmt::join(t.outcomes, " "));
    text += t.worst ? fmt::format(" {} {}", t.worst->place, std::bit_cast<std::uint64_t>(t.worst->ulps)) : " - -";
    text += fmt::format(" {}", std::bit_cast<std::uint64_t>(t.at_most));
    text += " " + wrong(t.first_wrong) + " " + wrong(t.last_wrong);
    for (const auto& first : t.first) text += first ? fmt::format(" {}", *first) : " -";
    text += t.padding ? fmt::format(" {} {}", t.padding->place, std::bit_cast<std::uint64_t>(t.padding->u)) : " - -";
    return text + "\n";
}

/// Reads the words of a state one after another. InputError where one is missing or is not what it should be.
class StateWords {
public:
    StateWords(const std::filesystem::path& path, const std::string& text) : path_(path), words_(text) {}

    [[noreturn]] void fail(const std::string& what) const {
        throw InputError(path_.string() + ": " + what + "; leave out --resume to begin anew");
    }
    [[noreturn]] void damaged() const { fail("is damaged: nothing can go on from it"); }

    std::string line() {
        std::string text;
        if (!std::getline(words_, text)) damaged();
        return text;
    }
    std::string line_after(std::string_view name) {
        const std::string text = line();
        if (!text.starts_with(std::string(name) + " ")) damaged();
        return text.substr(name.size() + 1);
    }
    /// Nothing for `-`.
    template <class Whole>
    std::optional<Whole> optional() {
        std::string word;
        if (!(words_ >> word)) damaged();
        if (word == "-") return std::nullopt;
        Whole x{};
        const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), x);
        if (error != std::errc{} || stop != word.data() + word.size()) damaged();
        return x;
    }
    template <class Whole>
    Whole whole() {
        const auto x = optional<Whole>();
        if (!x) damaged();
        return *x;
    }
    void expect(std::string_view wanted) {
        std::string word;
        if (!(words_ >> word) || word != wanted) damaged();
    }

private:
    std::filesystem::path path_;
    std::istringstream words_;
};

std::optional<FloatTally::Wrong> read_wrong(StateWords& in) {
    const auto place = in.optional<std::uint32_t>();
    const auto outcome = in.optional<int>();
    if (place.has_value() != outcome.has_value()) in.damaged();
    if (!place) return std::nullopt;
    if (*outcome < 0 || *outcome >= static_cast<int>(measure::answer::outcome_names.size())) in.damaged();
    return FloatTally::Wrong{*place, static_cast<Outcome>(*outcome)};
}

/// A place and a number.
template <class Measured>
std::optional<Measured> read_measured(StateWords& in) {
    const auto place = in.optional<std::uint32_t>();
    const auto bits = in.optional<std::uint64_t>();
    if (place.has_value() != bits.has_value()) in.damaged();
    return place ? std::optional(Measured{*place, std::bit_cast<double>(*bits)}) : std::nullopt;
}

FloatTally read_tally(StateWords& in) {
    FloatTally t;
    for (auto& n : t.outcomes) n = in.whole<std::uint64_t>();
    t.worst = read_measured<FloatTally::Worst>(in);
    t.at_most = std::bit_cast<double>(in.whole<std::uint64_t>());
    t.first_wrong = read_wrong(in);
    t.last_wrong = read_wrong(in);
    for (auto& first : t.first) first = in.optional<std::uint32_t>();
    t.padding = read_measured<FloatTally::Padding>(in);
    return t;
}

}  // namespace

RunIdentity identity_of(const ExhaustiveRequest& request, const std::string& version) {
    RunIdentity identity{version, request.sweep->text_hash, {}, request.share};
    for (const auto& row : request.rows)
        identity.forms += (identity.forms.empty() ? "" : " ") + std::string(row.form->info->name);
    return identity;
}

std::string state_text(const ExhaustiveState& state) {
    std::string text =
        fmt::format("tried {}\nstages {} {} {} {}\ntallies {}\n", state.tried, state.stages.binary64,
                    state.stages.double_double, state.stages.ball, state.stages.interval, state.tallies.size());
    for (std::size_t i = 0; i < state.tallies.size(); ++i) {
        if (state.tallies[i].floats() > 0) text += tally_text(i, state.tallies[i]);
    }
    return text + "- end\n";
}

namespace {

ExhaustiveState read_rest(StateWords& in, const ExhaustiveRequest& request) {
    ExhaustiveState state;
    in.expect("tried");
    state.tried = in.whole<std::uint64_t>();
    in.expect("stages");
    for (auto* n : {&state.stages.binary64, &state.stages.double_double, &state.stages.ball, &state.stages.interval})
        *n = in.whole<std::uint64_t>();
    in.expect("tallies");
    state.tallies.resize(measure::sweep::binades_of(*request.sweep).size() * request.sweep->rays.size() *
                         request.rows.size());
    if (in.whole<std::size_t>() != state.tallies.size()) in.damaged();
    std::uint64_t counted = 0;
    while (const auto place = in.optional<std::size_t>()) {
        if (*place >= state.tallies.size()) in.damaged();
        state.tallies[*place] = read_tally(in);
        counted += state.tallies[*place].floats();
    }
    in.expect("end");
    if (counted != state.tried * request.sweep->rays.size() * request.rows.size()) in.damaged();
    return state;
}

/// The line of a run's sweep, with its shard where it is one of several.
std::string subject_of(const RunIdentity& identity) {
    const std::string shard =
        identity.share.is_whole() ? "" : fmt::format(" shard {}/{}", identity.share.number, identity.share.of);
    return fmt::format("{:016x}{}", identity.sweep_hash, shard);
}

}  // namespace

ExhaustiveState state_in(const std::string& text, const std::filesystem::path& path, const ExhaustiveRequest& request) {
    StateWords in(path, text);
    return read_rest(in, request);
}

void write_state(const std::filesystem::path& path, const RunIdentity& identity, const ExhaustiveState& state) {
    file::AtomicFile out(path);
    out.write(fmt::format("{}\nversion {}\nsweep {}\nforms {}\n", heading, identity.version, subject_of(identity),
                          identity.forms));
    out.write(state_text(state));
    out.commit();
}

ExhaustiveState read_state(const std::filesystem::path& path, const RunIdentity& identity,
                           const ExhaustiveRequest& request) {
    if (!std::filesystem::exists(path))
        throw InputError(path.string() +
                         ": there is no such file, so there is no unfinished run to go on with; leave out --resume");
    StateWords in(path, file::read_file(path));
    if (in.line() != heading) in.fail("is not the state of an unfinished run, or that of another version");
    if (const auto version = in.line_after("version"); version != identity.version)
        in.fail("was written by lostbits " + version + ", and this is " + identity.version);
    if (in.line_after("sweep") != subject_of(identity))
        in.fail("belongs to another sweep file, or to this one before it was changed, or to another shard of it");
    if (const auto forms = in.line_after("forms"); forms != identity.forms)
        in.fail("belongs to a run with other forms (" + forms + "); name the same with -i");
    return read_rest(in, request);
}

}  // namespace lostbits::output::sweep
