#include "repository/rooms.hpp"

#include <algorithm>
#include <map>
#include <regex>
#include <set>

namespace lostbits::test {
namespace {

constexpr const char* program = "analysis";

/// `measure/truth` of src/measure/truth/x.hpp, `number` of src/number/x.hpp, `analysis` of analysis/x.cpp.
std::string room_of(const std::string& path) {
    const std::string folder = path.substr(0, path.rfind('/'));
    return folder.starts_with("src/") ? folder.substr(4) : folder;
}

/// The namespace of a room: that of its path. Operations of numbers must be found where a formula over float looks.
std::string namespace_of(const std::string& room) {
    static const std::regex of_shape("shapes/(\\w+)/(\\w+)");
    if (std::smatch m; std::regex_match(room, m, of_shape))
        return (m[2] == "forms" ? "lostbits::intersect::" : "lostbits::scene::") + m[1].str();
    if (room == "number" || room == "geometry" || room.starts_with("shapes")) return "lostbits";
    return "lostbits::" + std::regex_replace(room, std::regex("/"), "::");
}

/// What stands before an opening brace says what it opens.
class Scanner {
public:
    explicit Scanner(const SourceFile& file) : file_(file), code_(code_of(file.text)) {}

    std::vector<Definition> scan() {
        static const std::regex preprocessor(R"((^|\n)[ \t]*#[^\n]*)");
        for (auto m = std::sregex_iterator(code_.begin(), code_.end(), preprocessor); m != std::sregex_iterator(); ++m)
            std::fill_n(code_.begin() + m->position() + m->length(1), m->length() - m->length(1), ' ');
        for (std::size_t i = 0; i < code_.size(); ++i) {
            const char c = code_[i];
            if (c == '\n') ++line_;
            if (c == '{') open();
            else if (c == '}') close();
            else if (c == ';') {
                alias();
                head_.clear();
            } else {
                if (head_.empty() && !std::isspace(static_cast<unsigned char>(c))) head_line_ = line_;
                if (!head_.empty() || !std::isspace(static_cast<unsigned char>(c))) head_ += c;
            }
        }
        return std::move(found_);
    }

private:
    [[nodiscard]] bool at_namespace_scope() const {
        return std::ranges::all_of(scopes_, [](const std::string& s) { return !s.empty(); });
    }
    [[nodiscard]] std::string here() const {
        std::string all;
        for (const std::string& s : scopes_) all += s + "::";
        return all;
    }

    void open() {
        static const std::regex space(R"(^(inline\s+)?namespace\s*([\w:]*)\s*$)");
        static const std::regex type(
            R"(\b(struct|class|union|enum(?:\s+class)?)\s+(?:\[\[\w+\]\]\s*)?(\w+(?:<.*>)?)\s*)"
            R"((?:final\s*)?(?::[^:(].*)?$)");
        std::string scope;  // empty: no namespace, or an anonymous one, whose names are its file's own
        std::smatch m;
        if (std::regex_search(head_, m, space)) scope = m[2].str();
        else if (at_namespace_scope()) {
            const std::string flat = std::regex_replace(head_, std::regex(R"(\s+)"), " ");
            if (std::regex_search(flat, m, type) && flat.find('(') == std::string::npos) add(m[2].str(), m[2].str());
            else if (std::regex_search(flat, std::regex(R"(^(template|inline|constexpr)\b)"))) add(flat, "");
        }
        scopes_.push_back(scope);
        head_.clear();
    }
    void close() {
        if (!scopes_.empty()) scopes_.pop_back();
        head_.clear();
    }
    /// `using Name = …;`
    void alias() {
        static const std::regex pattern(R"(^(?:template\s*<[^=]*>\s*)?using\s+(\w+)\s*=)");
        std::smatch m;
        if (at_namespace_scope() && std::regex_search(head_, m, pattern)) add(m[1].str(), m[1].str());
    }
    void add(const std::string& name, const std::string& plain) {
        found_.push_back({file_.path, head_line_, here() + name, plain});
    }

    const SourceFile& file_;
    std::string code_, head_;
    std::size_t line_ = 1, head_line_ = 1;
    std::vector<std::string> scopes_;
    std::vector<Definition> found_;
};

std::string place(const Definition& d) { return d.path + ":" + std::to_string(d.line); }

}  // namespace

std::vector<std::string> rooms_in(const std::string& readme) {
    static const std::regex row(R"(\| `([\w/]+)` \|)");
    std::vector<std::string> rooms;
    for (auto m = std::sregex_iterator(readme.begin(), readme.end(), row); m != std::sregex_iterator(); ++m)
        rooms.push_back((*m)[1].str());
    rooms.emplace_back(program);
    return rooms;
}

Offences include_directions(const std::vector<std::string>& rooms, const SourceFile& file) {
    const auto place_of = [&rooms](const std::string& room) { return std::ranges::find(rooms, room) - rooms.begin(); };
    const auto nowhere = static_cast<std::ptrdiff_t>(rooms.size());
    Offences offences;
    const std::string own = room_of(file.path);
    if (place_of(own) == nowhere) return {file.path + ": in no room of src/README.md"};
    for (const Include& include : includes_of(file.text)) {
        const std::size_t slash = include.name.rfind('/');
        const std::string room = slash == std::string::npos ? "" : include.name.substr(0, slash);
        const bool beside = own == program && room.empty();
        if (place_of(room) == nowhere) {
            if (include.bracket == '"' && !beside)
                offences.push_back(at(file, include.line, include.name + " is not named from the source root"));
            continue;
        }
        // The catalogue is the closed list of the forms, so it alone looks down into their rooms.
        const bool lists =
            file.path == "src/intersect/catalogue.hpp" && (room.starts_with("intersect/") || room.ends_with("/forms"));
        if (place_of(room) > place_of(own) && !lists)
            offences.push_back(at(file, include.line, own + " includes " + include.name + ", which stands below it"));
    }
    return offences;
}

Offences room_namespace(const SourceFile& file) {
    static const std::regex opening(R"(\n(?:inline )?namespace ([\w:]+) \{)");
    const std::string code = "\n" + code_of(file.text), own = namespace_of(room_of(file.path));
    Offences offences;
    bool any = false;
    for (auto m = std::sregex_iterator(code.begin(), code.end(), opening); m != std::sregex_iterator(); ++m) {
        const std::string name = (*m)[1].str();
        any |= name == own;
        if (name != own && !(name + "::").starts_with(own + "::") && name.starts_with("lostbits"))
            offences.push_back(file.path + ": opens " + name + ", and its room is " + own);
    }
    const bool declares = code.find("\nnamespace ") != std::string::npos;
    if (declares && !any) offences.push_back(file.path + ": does not open " + own);
    return offences;
}

std::vector<Definition> definitions_in(const SourceFile& file) { return Scanner(file).scan(); }

Offences names_are_unique(const std::vector<SourceFile>& files) {
    std::map<std::string, Definition> by_name, by_word;
    Offences offences;
    for (const SourceFile& file : files) {
        for (const Definition& d : definitions_in(file)) {
            const auto [same, first] = by_name.try_emplace(d.name, d);
            if (!first) {
                offences.push_back(place(d) + ": " + d.name + " is defined at " + place(same->second) + " too");
            } else if (!d.plain.empty()) {
                const auto [word, unused] = by_word.try_emplace(d.plain, d);
                if (!unused)
                    offences.push_back(place(d) + ": " + d.name + " has the name of " + word->second.name + " at " +
                                       place(word->second));
            }
        }
    }
    return offences;
}

Offences room_sizes(const std::vector<SourceFile>& files) {
    static const std::set<std::string> grow{"shapes/sphere/forms", "shapes/box/forms", "shapes/triangle/forms",
                                            "intersect/sdf"};
    std::map<std::string, int> count;
    for (const SourceFile& file : files) ++count[room_of(file.path)];
    Offences offences;
    for (const auto& [room, n] : count)
        if (n > 22 && !grow.contains(room)) offences.push_back(room + ": " + std::to_string(n) + " files");
    return offences;
}

}  // namespace lostbits::test
