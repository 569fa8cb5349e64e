#include "intersect/external/pipe_header.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <span>

#include "intersect/external/pipe.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::external {
namespace {

/// The texts that one key allows, in the order of the values that they stand for.
using Words = std::span<const std::string_view>;

constexpr Words shapes = std::span(shape_names).first(shape_rows.size());  // without sdf
constexpr std::array<std::string_view, 2> formats{"f32", "f64"}, directions{"any", "unit"}, counts{"hit", "miss"};
constexpr Words at_origins = at_origin_names, insides = inside_names, facings = facing_names;
constexpr std::array<std::string_view, 4> roots{"both", "near", "first", "none"};
constexpr std::array<std::string_view, 5> flags{"line", "no_end", "one_thread", "clipped", "range"};
constexpr std::array<unsigned, 5> flag_bits{LB_LINE, LB_NO_END, LB_ONE_THREAD, LB_CLIPPED, LB_RANGE};

/// One key of a form: the texts that it allows, and how they are read into a contract and written from it.
struct Key {
    std::string_view name;
    Words words;  ///< empty: any text is allowed
    std::function<void(Contract&, std::size_t, const std::string&)> set;
    std::function<std::string(const Contract&)> get;
};

template <class Value>
Key choice(std::string_view name, Words words, Value Contract::*field) {
    return {name, words, [field](Contract& c, std::size_t i, const std::string&) { c.*field = static_cast<Value>(i); },
            [field, words](const Contract& c) { return std::string(words[static_cast<std::size_t>(c.*field)]); }};
}

Key text(std::string_view name, std::string Contract::*field) {
    return {name,
            {},
            [field](Contract& c, std::size_t, const std::string& words) { c.*field = words; },
            [field](const Contract& c) { return c.*field; }};
}

std::string flags_of(const Contract& c) {
    std::string all;
    for (std::size_t i = 0; i < flags.size(); ++i) {
        if (c.flags & flag_bits[i]) all += (all.empty() ? "" : ",") + std::string(flags[i]);
    }
    return all;
}

const std::vector<Key>& keys() {
    static const std::vector<Key> all{
        text("name", &Contract::name),
        text("title", &Contract::title),
        text("source", &Contract::source),
        choice("shape", shapes, &Contract::shape),
        {"format", formats, [](Contract& c, std::size_t i, const std::string&) { c.bits = i == 0 ? 32 : 64; },
         [](const Contract& c) { return std::string(formats[c.bits == 32 ? 0 : 1]); }},
        choice("direction", directions, &Contract::direction),
        choice("roots", roots, &Contract::roots),
        choice("touching", counts, &Contract::touching),
        choice("at_origin", at_origins, &Contract::at_origin),
        choice("inside", insides, &Contract::inside),
        choice("facing", facings, &Contract::facing),
        text("state", &Contract::state)};
    return all;
}

std::string listed(Words words) {
    std::string all;
    for (const std::string_view word : words) all += (all.empty() ? "" : ", ") + std::string(word);
    return all;
}

/// Index of a text among those that its key allows. InputError, which lists these, for any other.
std::size_t index_of(Words words, const std::string& word, const std::string& where, const std::string& key) {
    const auto found = std::ranges::find(words, word);
    if (found == words.end())
        throw InputError(where + ": " + key + " is " + shown_text(word) + "; it must be one of " + listed(words));
    return static_cast<std::size_t>(found - words.begin());
}

void set_flags(Contract& contract, const std::string& value, const std::string& where) {
    for (std::size_t begin = 0; begin < value.size();) {
        const std::size_t comma = std::min(value.find(',', begin), value.size());
        contract.flags |= flag_bits[index_of(flags, value.substr(begin, comma - begin), where, "flags")];
        begin = comma + 1;
    }
}

/// Throws if the header says why the program cannot serve: EnvironmentError if any line begins with `missing=`, else
/// InputError.
void refuse_for(const std::vector<std::string>& lines, const PipeTerms& terms) {
    std::string words;
    bool machine = false;
    for (const std::string_view line : lines) {
        const bool missing = line.starts_with("missing=");
        if (!missing && !line.starts_with("error=")) continue;
        machine = machine || missing;
        const std::string_view said = line.substr(line.find('=') + 1);
        words += (words.empty() ? "" : "\n") + (terms.is_lostbits ? std::string(said) : plain_text(said));
    }
    if (words.empty()) return;
    if (!terms.is_lostbits) words = terms.message_prefix + ": refuses: " + words;
    if (machine) throw EnvironmentError(words);
    throw InputError(words);
}

}  // namespace

std::string plain_text(std::string_view text) {
    constexpr std::string_view digits = "0123456789abcdef";
    std::string shown;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte >= 32 && byte < 127) shown += c;
        else (shown += "\\x") += {digits[byte / 16], digits[byte % 16]};
    }
    return shown;
}

std::string shown_text(std::string_view text, std::size_t most) {
    return "\"" + plain_text(text.substr(0, most)) + (text.size() > most ? "…\"" : "\"");
}

bool set_word(Contract& contract, const std::string& key, const std::string& value, const std::string& where) {
    if (key == "flags") {
        set_flags(contract, value, where);
        return true;
    }
    const auto known = std::ranges::find(keys(), key, &Key::name);
    if (known == keys().end()) return false;
    known->set(contract, known->words.empty() ? 0 : index_of(known->words, value, where, key), value);
    return true;
}

std::vector<Contract> read_pipe_header(const std::vector<std::string>& lines, const std::string& from) {
    std::vector<Contract> contracts;
    for (std::size_t i = 1; i < lines.size(); ++i) {
        const std::string where = from + ": header line " + std::to_string(i + 1);
        const std::size_t equals = lines[i].find('=');
        if (equals == std::string::npos) throw InputError(where + ": " + shown_text(lines[i]) + " is not key=value");
        const std::string key = lines[i].substr(0, equals), value = lines[i].substr(equals + 1);
        if (key == "name") contracts.emplace_back();
        if (contracts.empty())
            throw InputError(where + ": a form begins with name=; write it before " + shown_text(key));
        if (!set_word(contracts.back(), key, value, where))
            throw InputError(
                where + ": unknown key " + shown_text(key) +
                "; known keys are name, title, source, shape, format, direction, roots, touching, at_origin, "
                "inside, facing, state, flags");
    }
    if (contracts.empty())
        throw InputError(
            from +
            ": its header names no form; write name=, shape= and format=, or see what it printed on standard error");
    for (const Contract& contract : contracts) require_sense(contract, from);
    return contracts;
}

std::string pipe_header_of(const std::vector<Contract>& contracts) {
    std::string header = std::string(pipe_version) + "\n";
    for (const Contract& contract : contracts) {
        for (const Key& key : keys()) {
            if (key.name == "state" && contract.state.empty()) continue;
            if (key.name == "facing" && contract.facing == Facing::both) continue;
            header += std::string(key.name) + "=" + key.get(contract) + "\n";
        }
        if (contract.flags != 0) header += "flags=" + flags_of(contract) + "\n";
    }
    return header + "\n";
}

std::vector<Contract> read_greeting(const LineSource& speaker, const PipeTerms& terms) {
    std::vector<std::string> lines;
    for (std::size_t bytes = 0;;) {
        lines.push_back(speaker.next_line());
        if (lines.size() == 1 && lines.front() != pipe_version)
            speaker.fail("printed " + shown_text(lines.front()) +
                         " first; the first line of its standard output must be " + std::string(pipe_version) +
                         ", and whatever else it prints must go to standard error");
        if (lines.back().empty()) break;
        bytes += lines.back().size();
        if (bytes > 100'000) speaker.fail("sent more than 100000 bytes of header; an empty line must end it");
    }
    lines.pop_back();
    refuse_for(lines, terms);
    return read_pipe_header(lines, terms.message_prefix);
}

}  // namespace lostbits::intersect::external
