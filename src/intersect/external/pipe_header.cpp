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

/// The texts that a key allows. The index of a text is the value of the enumerator that it names.
using Texts = std::span<const std::string_view>;

constexpr Texts shapes = std::span(shape_names).first(shape_rows.size());  // without sdf
constexpr std::array<std::string_view, 2> formats{"f32", "f64"}, directions{"any", "unit"}, touchings{"hit", "miss"};
constexpr Texts at_origins = at_origin_names, insides = inside_names, facings = facing_names;
constexpr std::array<std::string_view, 4> roots{"both", "near", "first", "none"};
constexpr std::array<std::string_view, 5> flags{"line", "no_end", "one_thread", "clipped", "range"};
constexpr std::array<unsigned, 5> flag_bits{LB_LINE, LB_NO_END, LB_ONE_THREAD, LB_CLIPPED, LB_RANGE};

/// One key of a form: the texts that it allows, and the functions that read them into a contract and write them from
/// it.
struct HeaderKey {
    std::string_view name;
    Texts texts;  ///< empty: any text is allowed
    std::function<void(Contract&, std::size_t, const std::string&)> set;
    std::function<std::string(const Contract&)> get;
};

template <class Value>
HeaderKey enumeration_key(std::string_view name, Texts texts, Value Contract::*field) {
    return {name, texts,
            [field](Contract& contract, std::size_t i, const std::string&) { contract.*field = static_cast<Value>(i); },
            [field, texts](const Contract& contract) {
                return std::string(texts[static_cast<std::size_t>(contract.*field)]);
            }};
}

HeaderKey text_key(std::string_view name, std::string Contract::*field) {
    return {name,
            {},
            [field](Contract& contract, std::size_t, const std::string& text) { contract.*field = text; },
            [field](const Contract& contract) { return contract.*field; }};
}

std::string flags_of(const Contract& contract) {
    std::string list;
    for (std::size_t i = 0; i < flags.size(); ++i) {
        if (contract.flags & flag_bits[i]) list += (list.empty() ? "" : ",") + std::string(flags[i]);
    }
    return list;
}

const std::vector<HeaderKey>& keys() {
    static const std::vector<HeaderKey> key_list{
        text_key("name", &Contract::name),
        text_key("title", &Contract::title),
        text_key("source", &Contract::source),
        enumeration_key("shape", shapes, &Contract::shape),
        {"format", formats,
         [](Contract& contract, std::size_t i, const std::string&) { contract.bits = i == 0 ? 32 : 64; },
         [](const Contract& contract) { return std::string(formats[contract.bits == 32 ? 0 : 1]); }},
        enumeration_key("direction", directions, &Contract::direction),
        enumeration_key("roots", roots, &Contract::roots),
        enumeration_key("touching", touchings, &Contract::touching),
        enumeration_key("at_origin", at_origins, &Contract::at_origin),
        enumeration_key("inside", insides, &Contract::inside),
        enumeration_key("facing", facings, &Contract::facing),
        text_key("state", &Contract::state)};
    return key_list;
}

std::string join_texts(Texts texts) {
    std::string list;
    for (const std::string_view text : texts) list += (list.empty() ? "" : ", ") + std::string(text);
    return list;
}

/// Returns the index of a text among the texts that its key allows. Throws InputError, which lists these texts, for any
/// other text.
std::size_t find_text(Texts texts, const std::string& text, const std::string& message_prefix, const std::string& key) {
    const auto allowed_text = std::ranges::find(texts, text);
    if (allowed_text == texts.end())
        throw InputError(message_prefix + ": " + key + " is " + quote_text(text) + "; it must be one of " +
                         join_texts(texts));
    return static_cast<std::size_t>(allowed_text - texts.begin());
}

void set_flags(Contract& contract, const std::string& value, const std::string& message_prefix) {
    for (std::size_t begin = 0; begin < value.size();) {
        const std::size_t comma = std::min(value.find(',', begin), value.size());
        contract.flags |= flag_bits[find_text(flags, value.substr(begin, comma - begin), message_prefix, "flags")];
        begin = comma + 1;
    }
}

/// Throws if the header says why the program cannot serve: EnvironmentError if a line begins with `missing=`, else
/// InputError.
void require_not_refused(const std::vector<std::string>& lines, const PipeOptions& options) {
    std::string refusal;
    bool is_environment = false;
    for (const std::string_view line : lines) {
        const bool is_missing = line.starts_with("missing=");
        if (!is_missing && !line.starts_with("error=")) continue;
        is_environment = is_environment || is_missing;
        const std::string_view reason = line.substr(line.find('=') + 1);
        refusal += (refusal.empty() ? "" : "\n") + (options.is_lostbits ? std::string(reason) : escape_text(reason));
    }
    if (refusal.empty()) return;
    if (!options.is_lostbits) refusal = options.message_prefix + ": refuses: " + refusal;
    if (is_environment) throw EnvironmentError(refusal);
    throw InputError(refusal);
}

}  // namespace

std::string escape_text(std::string_view text) {
    constexpr std::string_view digits = "0123456789abcdef";
    std::string shown;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte >= 32 && byte < 127) shown += c;
        else (shown += "\\x") += {digits[byte / 16], digits[byte % 16]};
    }
    return shown;
}

std::string quote_text(std::string_view text, std::size_t max_bytes) {
    return "\"" + escape_text(text.substr(0, max_bytes)) + (text.size() > max_bytes ? "…\"" : "\"");
}

bool set_property(Contract& contract, const std::string& key, const std::string& value,
                  const std::string& message_prefix) {
    if (key == "flags") {
        set_flags(contract, value, message_prefix);
        return true;
    }
    const auto entry = std::ranges::find(keys(), key, &HeaderKey::name);
    if (entry == keys().end()) return false;
    entry->set(contract, entry->texts.empty() ? 0 : find_text(entry->texts, value, message_prefix, key), value);
    return true;
}

std::vector<Contract> read_pipe_header(const std::vector<std::string>& lines, const std::string& message_prefix) {
    std::vector<Contract> contracts;
    for (std::size_t i = 1; i < lines.size(); ++i) {
        const std::string line_prefix = message_prefix + ": header line " + std::to_string(i + 1);
        const std::size_t equals = lines[i].find('=');
        if (equals == std::string::npos)
            throw InputError(line_prefix + ": " + quote_text(lines[i]) + " is not key=value");
        const std::string key = lines[i].substr(0, equals), value = lines[i].substr(equals + 1);

        // Each name= begins the next form.
        if (key == "name") contracts.emplace_back();
        if (contracts.empty())
            throw InputError(line_prefix + ": a form begins with name=; write it before " + quote_text(key));
        if (!set_property(contracts.back(), key, value, line_prefix))
            throw InputError(
                line_prefix + ": unknown key " + quote_text(key) +
                "; known keys are name, title, source, shape, format, direction, roots, touching, at_origin, "
                "inside, facing, state, flags");
    }

    if (contracts.empty())
        throw InputError(
            message_prefix +
            ": its header names no form; write name=, shape= and format=, or see what it printed on standard error");
    for (const Contract& contract : contracts) require_valid(contract, message_prefix);
    return contracts;
}

std::string make_pipe_header(const std::vector<Contract>& contracts) {
    std::string header = std::string(pipe_version) + "\n";
    for (const Contract& contract : contracts) {
        for (const HeaderKey& key : keys()) {
            if (key.name == "state" && contract.state.empty()) continue;
            if (key.name == "facing" && contract.facing == Facing::both) continue;
            header += std::string(key.name) + "=" + key.get(contract) + "\n";
        }
        if (contract.flags != 0) header += "flags=" + flags_of(contract) + "\n";
    }
    return header + "\n";
}

std::vector<Contract> read_greeting(const LineSource& source, const PipeOptions& options) {
    std::vector<std::string> lines;
    for (std::size_t bytes = 0;;) {
        lines.push_back(source.next_line());
        if (lines.size() == 1 && lines.front() != pipe_version)
            source.fail("printed " + quote_text(lines.front()) +
                        " first; the first line of its standard output must be " + std::string(pipe_version) +
                        ", and whatever else it prints must go to standard error");
        if (lines.back().empty()) break;
        bytes += lines.back().size();
        if (bytes > 100'000) source.fail("sent more than 100000 bytes of header; an empty line must end it");
    }
    lines.pop_back();
    require_not_refused(lines, options);
    return read_pipe_header(lines, options.message_prefix);
}

}  // namespace lostbits::intersect::external
