#include "intersect/shader/source.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "intersect/external/pipe_header.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::shader {

namespace fs = std::filesystem;

namespace {

/// A property of the function, and the position where the file or the command line states it.
struct Word {
    std::string key, value, where;
};

std::string read_text(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    if (!in || fs::is_directory(path))
        throw InputError(path.string() + ": cannot be read; --shader takes a GLSL file, and options after a colon");
    if (text.str().size() > 4'000'000) throw InputError(path.string() + ": is longer than 4 MB; is it a GLSL file?");
    return text.str();
}

/// Splits the argument into the file and the options after it.
std::pair<std::string, std::string> split(const std::string& named) {
    std::error_code none;
    for (std::size_t end = named.size();; end = named.rfind(':', end - 1)) {
        if (end == std::string::npos) break;
        if (fs::exists(named.substr(0, end), none))
            return {named.substr(0, end), end == named.size() ? "" : named.substr(end + 1)};
        if (end == 0) break;
    }
    throw InputError("--shader " + named + ": no such file; write FILE.glsl or FILE.glsl:FUNCTION");
}

/// Reads properties with `separator` or blanks between them; quotation marks hold one together.
void add_words(std::string_view text, char separator, const std::string& where, std::vector<Word>& words) {
    const auto separates = [separator](char c) { return c == separator || c == ' ' || c == '\t' || c == '\r'; };
    for (std::size_t at = 0; at < text.size();) {
        if (separates(text[at])) {
            ++at;
            continue;
        }
        std::string word;
        for (bool quoted = false; at < text.size() && (quoted || !separates(text[at])); ++at) {
            if (text[at] == '"') quoted = !quoted;
            else word += text[at];
        }
        const std::size_t equals = word.find('=');
        if (equals == std::string::npos) words.push_back({"function", word, where});
        else words.push_back({word.substr(0, equals), word.substr(equals + 1), where});
    }
}

/// Reads the properties that comments of the file state after `lostbits:`, up to the end of the line.
void add_header(const std::string& path, const std::vector<Token>& tokens, std::vector<Word>& words) {
    constexpr std::string_view mark = "lostbits:";
    for (const Token& token : tokens) {
        if (token.kind != Token::Kind::comment) continue;
        std::size_t line = token.line, counted = 0;
        for (std::size_t at = token.text.find(mark); at != std::string_view::npos; at = token.text.find(mark, at)) {
            line += static_cast<std::size_t>(std::ranges::count(token.text.substr(counted, at - counted), '\n'));
            const std::size_t newline = token.text.rfind('\n', at);
            const std::size_t column = newline == std::string_view::npos ? token.column + at : at - newline;
            const std::size_t end = std::min(token.text.find('\n', at), token.text.size());
            std::string_view rest = token.text.substr(at + mark.size(), end - at - mark.size());
            if (rest.ends_with("*/")) rest.remove_suffix(2);
            add_words(rest, ' ', path + ":" + std::to_string(line) + ":" + std::to_string(column), words);
            counted = at;
            at = end;
        }
    }
}

Sentinel sentinel_of(const Word& word) {
    using Kind = Sentinel::Kind;
    constexpr std::array<std::string_view, 4> kinds{"negative", "crossed", "zero", "infinite"};
    const auto known = std::ranges::find(kinds, word.value);
    if (known != kinds.end()) return {static_cast<Kind>(known - kinds.begin()), 0};
    Sentinel above{Kind::above, 0};
    const auto [end, error] = std::from_chars(word.value.data(), word.value.data() + word.value.size(), above.bound);
    if (error == std::errc() && end == word.value.data() + word.value.size() && above.bound > 0) return above;
    throw InputError(word.where + ": miss is " + external::shown_text(word.value) +
                     "; it must be negative (t < 0 means a miss), crossed (near > far), zero (t <= 0), infinite, or a "
                     "number from which on t means a miss, such as 1e20");
}

std::string place(const std::string& path, const Function& f) {
    return path + ":" + std::to_string(f.line) + ":" + std::to_string(f.column);
}

std::string listed(const std::vector<Function>& functions) {
    constexpr std::size_t most = 30;
    std::string text;
    for (const Function& f : functions) {
        if (&f - functions.data() == most) return text + "\n  and " + std::to_string(functions.size() - most) + " more";
        text += "\n  line " + std::to_string(f.line) + ": " + f.words();
    }
    return text;
}

/// The functions with the signature of the first kind that the file has (intersector, march, field): a file with a
/// march has a field too.
std::vector<Function> candidates(const std::vector<Function>& all) {
    std::vector<Function> best;
    auto kind = Signature::Kind::field;
    for (const Function& f : all) {
        const auto signature = signature_of(f);
        if (!signature || (!best.empty() && signature->kind > kind)) continue;
        if (signature->kind < kind) best.clear();
        kind = signature->kind;
        best.push_back(f);
    }
    return best;
}

/// Chooses the named function, or else the only one that has the types of an intersector.
Signature choose(const std::string& path, const std::vector<Function>& all, const Word* named) {
    if (all.empty())
        throw InputError(path + ": contains no function; write one, such as float f(vec3 ro, vec3 rd, vec4 sphere)");
    std::vector<Function> chosen = candidates(all);
    if (named) {
        chosen.clear();
        std::ranges::copy_if(all, std::back_inserter(chosen),
                             [&](const Function& f) { return f.name == named->value; });
    }
    if (chosen.empty() && named)
        throw InputError(named->where + ": no function " + external::shown_text(named->value) + " in " + path +
                         "; its functions are:" + listed(all));
    if (chosen.empty())
        throw InputError(path + ": no function has the types of an intersector, which are " +
                         std::string(known_signatures) + "; the functions of the file are:" + listed(all) +
                         "\nwrite one that calls yours, or name it as in --shader " + path + ":FUNCTION");
    if (!named && chosen.size() > 1)
        throw InputError(path + ": several functions have the types of an intersector; name one, as in --shader " +
                         path + ":" + chosen.back().name + ":" + listed(chosen));
    for (const Function& f : chosen) {
        if (auto signature = signature_of(f, named != nullptr)) return *signature;
    }
    throw InputError(place(path, chosen.front()) + ": `" + chosen.front().words() +
                     "` does not have the types of an intersector, which are " + std::string(known_signatures) +
                     "; write a function that calls it");
}

/// The default contract: the properties of most functions with such a signature.
external::Contract usual_contract(const std::string& path, const Signature& signature) {
    external::Contract c{.name = fs::path(path).stem().string(),
                         .title = signature.function.words(),
                         .source = {},
                         .shape = signature.shape,
                         .bits = signature.doubles ? 64 : 32};
    using Answers = Signature::Answers;
    c.direction = row_of(signature.shape).usually_unit ? Direction::unit : Direction::any;
    const bool two = signature.answers == Answers::near_far || signature.answers == Answers::hit_and_near_far;
    c.roots = two ? Roots::both : signature.answers == Answers::hit ? Roots::none : Roots::near_only;
    if (signature.kind != Signature::Kind::intersector) {
        c.direction = Direction::unit;
        c.roots = two ? Roots::both : Roots::near_only;
    }
    const bool ends_at_once = signature.kind != Signature::Kind::intersector || inside_returns_zero(signature.shape);
    if (c.roots == Roots::near_only && ends_at_once) c.inside = Inside::zero;  // a march ends where it begins
    c.flags = LB_ONE_THREAD;
    return c;
}

/// Turns the name into `shader.NAME` with only the characters that a name may have, and shortens a long title.
void name_it(external::Contract& contract) {
    for (char& c : contract.name) {
        const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-';
        if (!plain) c = '_';
    }
    contract.name = "shader." + contract.name.substr(0, 40);
    constexpr std::size_t most = 120;
    if (contract.title.size() > most) contract.title = contract.title.substr(0, most) + "...";
}

/// Reads a number x with 0 < x < 1e30.
double positive(const Word& word) {
    double number = 0;
    const char* const end = word.value.data() + word.value.size();
    const auto [stop, error] = std::from_chars(word.value.data(), end, number);
    if (error != std::errc() || stop != end || !(number > 0) || !(number < 1e30))
        throw InputError(word.where + ": " + word.key + " is " + external::shown_text(word.value) +
                         "; it must be a number above 0 and below 1e30");
    return number;
}

void set_formats(const Word& word, ShaderSource& shader) {
    if (word.value != "f32" && word.value != "f64" && word.value != "both")
        throw InputError(word.where + ": format is " + external::shown_text(word.value) +
                         "; it must be f32, f64 or both");
    shader.f32 = word.value != "f64";
    shader.f64 = word.value != "f32";
}

void obey(const Word& word, ShaderSource& shader) {
    const bool own_primitives =
        shader.signature.kind == Signature::Kind::march || shader.signature.arguments.size() == 1;
    if (word.key == "function") return;
    if (word.key == "miss") shader.sentinel = sentinel_of(word);
    else if (word.key == "format") set_formats(word, shader);
    else if (word.key == "hit_eps") shader.march.hit_eps = positive(word);
    else if (word.key == "max_dist") shader.march.max_dist = positive(word);
    else if (word.key == "max_steps") shader.march.max_steps = static_cast<int>(std::min(positive(word), 1e9));
    else if ((word.key == "shape" && !own_primitives) || word.key == "source" ||
             !external::set_property(shader.contract, word.key, word.value, word.where))
        throw InputError(word.where + ": unknown key " + external::shown_text(word.key) +
                         "; known keys are function, name, title, direction, roots, touching, at_origin, inside, "
                         "facing, flags, miss "
                         "and format; for a field also hit_eps, max_dist and max_steps; for a march or field with its "
                         "own primitives "
                         "also shape");
}

/// Throws InputError if the function does not receive where rays begin and end.
void require_range(const std::string& path, const Signature& s) {
    const std::string says = place(path, s.function) + ": flags=range is given, but `" + s.function.words() + "` ";
    if (s.kind == Signature::Kind::field)
        throw InputError(says +
                         "is a field: the loop around it begins at 0; write the march yourself, or leave range out: "
                         "lostbits then accepts only answers in the range");
    if (!s.knows_start || !s.knows_end)
        throw InputError(
            says +
            "has no parameters for where rays begin and end; add `float tmin, float tmax`, or leave range out: "
            "lostbits then takes the first root in the range");
}

}  // namespace

bool Sentinel::says_miss(double near, double far) const {
    switch (kind) {
        case Kind::negative: return far < 0;
        case Kind::crossed: return near > far || far < 0;
        case Kind::zero: return far <= 0;
        case Kind::infinite: return !std::isfinite(near);
        case Kind::above: return near >= bound;
    }
    return false;
}

ShaderSource read_shader(const std::string& named) {
    const auto [path, after] = split(named);
    ShaderSource shader{.path = path,
                        .text = read_text(path),
                        .signature = {},
                        .contract = {},
                        .sentinel = {},
                        .march = {},
                        .hlsl = fs::path(path).extension() == ".hlsl",
                        .loops = {}};
    const std::vector<Token> tokens = tokens_of(shader.text), code = code_tokens(tokens);
    std::vector<Word> words;
    add_header(path, tokens, words);
    add_words(after, ',', "--shader " + named, words);
    const auto is_function = [](const Word& word) { return word.key == "function"; };
    const auto function = std::find_if(words.rbegin(), words.rend(), is_function);
    shader.signature = choose(path, functions_of(code), function == words.rend() ? nullptr : &*function);
    shader.contract = usual_contract(path, shader.signature);
    if (function != words.rend() && function->where.starts_with("--shader")) shader.contract.name = function->value;
    if (shader.signature.answers == Signature::Answers::near_far) shader.sentinel.kind = Sentinel::Kind::crossed;
    shader.f32 = !shader.signature.doubles;
    shader.f64 = shader.signature.doubles;
    for (const Word& word : words) obey(word, shader);
    if (shader.hlsl && shader.f64) throw InputError(path + ": HLSL is measured in floats only; leave format= out");
    if ((shader.contract.flags & LB_RANGE) != 0) require_range(path, shader.signature);
    name_it(shader.contract);
    shader.signature.shape = shader.contract.shape;
    const bool ends = takes_tmax(shader.contract.shape) && shader.contract.roots != Roots::none;
    if (ends && !shader.signature.knows_end) shader.contract.flags |= LB_NO_END;
    external::require_sense(shader.contract, path);
    shader.loops = loops_of(tokens, code);
    if (shader.signature.kind == Signature::Kind::field)
        shader.loops.push_back({shader.signature.function.line, shader.march.max_steps, shader.march.max_steps});
    return shader;
}

}  // namespace lostbits::intersect::shader
