#include "analysis/selection/subject_kinds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <initializer_list>
#include <regex>
#include <string_view>
#include <vector>

#include "number/error.hpp"
#include "output/attribution/explain_command.hpp"
#include "output/file/number_text.hpp"
#include "scene/file/scene.hpp"
#include "scene/sweep/case_file.hpp"
#include "scene/sweep/sweep_file.hpp"
#include "text/shell_word.hpp"

namespace lostbits::analysis::selection {

namespace {

namespace fs = std::filesystem;
using Kind = SubjectKind;

struct KindRow {
    Kind kind;
    const char* noun;
    const char* command;  ///< the command that takes such a subject; {} stands for its name
};
constexpr KindRow kind_rows[] = {
    {Kind::scene, "a scene", "lostbits map {}"},
    {Kind::sweep, "a sweep", "lostbits sweep {}"},
    {Kind::cases, "a file of cases", "lostbits sweep {}"},
    {Kind::search, "a search for the worst rays", "lostbits sweep {} --worst"},
    {Kind::claims, "a file of claims", "lostbits check {}"},
    {Kind::choices, "the choice of a report", "lostbits report"},
    {Kind::rays, "a file of rays", "lostbits judge {}"},
    {Kind::library, "a library or a program", "lostbits plugin check {}"},
    {Kind::shader, "a shader", "lostbits plugin check --shader {}"},
    {Kind::results, "a folder of results", "lostbits diff {} OTHER"},
    {Kind::picture, "a picture", "lostbits diff {} OTHER --strict"},
};

const KindRow& row_of(Kind kind) { return *std::ranges::find(kind_rows, kind, &KindRow::kind); }

/// The kinds that an argument takes.
struct ArgumentKinds {
    const char *command, *argument;
    const char* option;  ///< only with this option; empty: in any other case
    std::initializer_list<Kind> kinds;
};
/// The argument of every command that is not in the table.
const ArgumentKinds default_row{"", "SCENE", "", {Kind::scene}};
const ArgumentKinds argument_rows[] = {
    {"check", "CLAIMS", "", {Kind::claims}},
    {"choose", "SCENE", "", {Kind::scene, Kind::rays}},
    {"choose", "--scene", "", {Kind::scene}},
    {"explain", "SCENE", "--case", {Kind::cases}},
    {"explain", "SCENE", "--worst", {Kind::scene, Kind::sweep, Kind::cases}},
    {"explain", "SCENE", "--ranges", {Kind::scene, Kind::sweep}},
    {"explain", "SCENE", "--pixel", {Kind::scene}},
    {"explain", "SCENE", "", {Kind::scene}},
    {"judge", "FILE", "", {Kind::rays}},
    {"judge", "--scene", "", {Kind::scene}},
    {"mend", "SCENE", "", {Kind::scene, Kind::rays}},
    {"mend", "--scene", "", {Kind::scene}},
    {"plugin", "LIBRARY", "", {Kind::library}},
    {"report", "SUBJECT", "", {Kind::scene, Kind::sweep, Kind::cases, Kind::search}},
    {"sweep", "SWEEP", "", {Kind::sweep, Kind::cases, Kind::search}},
};

/// The kind of a sweep file. A file that cannot be read counts as a sweep: the command that reads it reports the error.
Kind read_sweep_kind(const fs::path& path) {
    using scene::sweep::SweepKind;
    try {
        const SweepKind kind = scene::sweep::read_sweep_kind(path);
        return kind == SweepKind::cases                                      ? Kind::cases
               : kind == SweepKind::search || kind == SweepKind::edge_search ? Kind::search
                                                                             : Kind::sweep;
    } catch (const Error&) {
        return Kind::sweep;
    }
}

/// The kind of a TOML file, by the schema in its first lines or, without a schema, by the first table that only one
/// kind of file has.
std::optional<Kind> find_toml_kind(const std::string& begin, const fs::path& path) {
    static const std::regex schema(R"re((?:^|\n)[ \t]*"?schema"?[ \t]*=[ \t]*["']lostbits-([a-z]+)/)re");
    static const std::regex table(R"re((?:^|\n)[ \t]*\[\[?(camera|claim|axis|case|search|edge_search)[\].])re");
    static constexpr std::pair<std::string_view, Kind> kinds[] = {{"scene", Kind::scene},
                                                                  {"camera", Kind::scene},
                                                                  {"claims", Kind::claims},
                                                                  {"claim", Kind::claims},
                                                                  {"report", Kind::choices}};
    std::smatch match;
    if (!std::regex_search(begin, match, schema) && !std::regex_search(begin, match, table)) return std::nullopt;
    const std::string word = match[1];
    if (const auto* const found = std::ranges::find(kinds, word, &std::pair<std::string_view, Kind>::first);
        found != std::end(kinds))
        return found->second;
    if (word == "sweep" || match.str().find('[') != std::string::npos) return read_sweep_kind(path);
    return std::nullopt;
}

std::string read_beginning(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::string text(std::size_t{1} << 16, '\0');
    file.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(std::max<std::streamsize>(file.gcount(), 0)));
    return text;
}

/// Kind of the file that a name stands for, among the files of kind `wanted` in the data folder; nothing if there is no
/// such file.
std::optional<Kind> find_named_kind(const std::string& word, Kind wanted, const fs::path& data) {
    std::error_code ignored;
    const auto is_there = [&](const fs::path& path) { return fs::is_regular_file(path, ignored); };
    try {
        if (wanted == Kind::scene && is_there(scene::file::find_scene(word, data).path)) return Kind::scene;
        if (wanted == Kind::sweep)
            if (const auto path = scene::sweep::find_sweep(word, data); is_there(path)) return read_sweep_kind(path);
    } catch (const Error&) {
        return std::nullopt;
    }
    if (wanted == Kind::claims && is_there(data / "claims" / (word + ".toml"))) return Kind::claims;
    return std::nullopt;
}

/// The kind of a subject. A name that files of several kinds have stands for the first of these kinds: those of
/// `preferred`, then the others.
std::optional<Kind> find_kind(const std::string& word, std::initializer_list<Kind> preferred, const fs::path& data) {
    std::error_code ignored;
    if (fs::exists(word, ignored) && (fs::path(word).has_extension() || fs::is_regular_file(word, ignored)))
        return find_file_kind(word);
    std::vector<Kind> order{preferred};
    order.insert(order.end(), {Kind::scene, Kind::sweep, Kind::claims});
    for (const Kind wanted : order)
        if (const auto kind = find_named_kind(word, wanted, data)) return kind;
    return find_file_kind(word);
}

/// "a scene, a sweep or a file of cases"
std::string enumerated_or(const std::vector<std::string>& words) {
    std::string text;
    for (std::size_t i = 0; i < words.size(); ++i)
        text += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + words[i];
    return text;
}

std::string nouns_of(std::initializer_list<Kind> kinds) {
    std::vector<std::string> nouns;
    for (const Kind kind : kinds) nouns.emplace_back(row_of(kind).noun);
    return enumerated_or(nouns);
}

/// The options with which the command takes that kind.
std::vector<std::string> options_taking(const ArgumentKinds& refused, Kind kind) {
    std::vector<std::string> options;
    for (const ArgumentKinds& row : argument_rows) {
        if (std::string_view(row.command) == refused.command && std::string_view(row.argument) == refused.argument &&
            row.option[0] != '\0' && std::ranges::find(row.kinds, kind) != row.kinds.end())
            options.emplace_back(row.option);
    }
    return options;
}

void require_argument_kind(const std::string& word, const ArgumentKinds& row, const std::string& command,
                           const fs::path& data) {
    const auto kind = find_kind(word, row.kinds, data);
    if (!kind || std::ranges::find(row.kinds, *kind) != row.kinds.end()) return;
    // A folder of claims may hold results too.
    if (*kind == Kind::results && std::ranges::find(row.kinds, Kind::claims) != row.kinds.end()) return;
    const std::string other = fmt::format(fmt::runtime(row_of(*kind).command), text::shell_word(word));
    if (const auto options = options_taking(row, *kind); !options.empty())
        throw InputError(fmt::format("{}: is {}, which `{}` takes with {}; {}, or try `{}`", word, row_of(*kind).noun,
                                     command, enumerated_or(options),
                                     options.size() > 1 ? "add one of them" : "add that", other));
    throw InputError(fmt::format("{}: is {}, and {} takes {}; try `{}`", word, row_of(*kind).noun,
                                 row.argument[0] == '-' ? std::string(row.argument) : "`" + command + "`",
                                 nouns_of(row.kinds), other));
}

}  // namespace

std::optional<SubjectKind> find_file_kind(const fs::path& path) {
    std::error_code ignored;
    if (fs::is_directory(path, ignored))
        return fs::is_regular_file(path / "manifest.json", ignored) ? std::optional(Kind::results) : std::nullopt;
    if (!fs::is_regular_file(path, ignored)) return std::nullopt;

    // The first bytes decide, and then the ending of the name.
    const std::string begin = read_beginning(path), ending = path.extension().string();
    static constexpr std::pair<std::string_view, Kind> magic[] = {{"\x7f"
                                                                   "ELF",
                                                                   Kind::library},
                                                                  {"\x93NUMPY", Kind::rays},
                                                                  {"\x89PNG", Kind::picture},
                                                                  {"\x76\x2f\x31\x01", Kind::picture}};
    for (const auto& [bytes, kind] : magic)
        if (begin.starts_with(bytes)) return kind;

    static constexpr std::pair<std::string_view, Kind> endings[] = {
        {".csv", Kind::rays}, {".npy", Kind::rays}, {".glsl", Kind::shader}, {".hlsl", Kind::shader}};
    for (const auto& [text, kind] : endings)
        if (ending == text) return kind;
    return ending == ".toml" ? find_toml_kind(begin, path) : std::nullopt;
}

void require_argument_kinds(const shell::Command& command, const fs::path& data) {
    const std::vector<shell::Command> given_commands = command.given_commands();
    const shell::Command& last_command = given_commands.back();

    // The first row of an argument whose option is given decides.
    std::vector<std::string> decided_arguments;
    for (const ArgumentKinds& row : argument_rows) {
        if (given_commands.size() < 2 || given_commands[1].name() != row.command ||
            std::ranges::find(decided_arguments, row.argument) != decided_arguments.end())
            continue;
        if (row.option[0] != '\0' && last_command.option(row.option).given_values().empty()) continue;
        decided_arguments.emplace_back(row.argument);
        const shell::Option argument = last_command.option(row.argument);
        if (!argument) continue;
        for (const std::string& word : argument.given_values())
            require_argument_kind(word, row, command.command_path(), data);
    }

    if (std::ranges::find(decided_arguments, default_row.argument) != decided_arguments.end()) return;
    if (const shell::Option argument = last_command.option(default_row.argument))
        for (const std::string& word : argument.given_values())
            require_argument_kind(word, default_row, command.command_path(), data);
}

}  // namespace lostbits::analysis::selection
