// glTF 2.0: nlohmann's JSON says where the bytes lie; the vertices are the binary32 that lie there.
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "number/error.hpp"
#include "scene/toml/counted.hpp"
#include "scene/toml/did_you_mean.hpp"
#include "shapes/triangle/mesh/mesh_readers.hpp"

namespace lostbits::scene::triangle {

namespace {

using intersect::process::StopToken;
using nlohmann::json;

static_assert(std::endian::native == std::endian::little, "glTF is little endian, and its numbers are copied");

constexpr std::uint64_t most_text = std::uint64_t{1} << 29;  // a larger mesh has its buffers beside it, or is a .glb
constexpr int deepest = 64;                                  // a mesh needs nine
constexpr std::size_t most_values = 10'000'000;              // some 100 bytes of memory each

/// The letters of a JSON, which know how far they are read and whether the work is to end.
class Letters {
public:
    using iterator_category = std::input_iterator_tag;
    using value_type = char;
    using difference_type = std::ptrdiff_t;
    using pointer = const char*;
    using reference = const char&;

    Letters(const char* at, StopToken stop, const char** seen = nullptr) : at_(at), stop_(stop), seen_(seen) {}
    reference operator*() const { return *at_; }
    Letters& operator++() {
        constexpr std::uintptr_t now_and_then = 0xffff;
        if ((reinterpret_cast<std::uintptr_t>(++at_) & now_and_then) == 0) stop_.check();
        if (seen_ != nullptr) *seen_ = at_;
        return *this;
    }
    Letters operator++(int) {
        const Letters before = *this;
        ++*this;
        return before;
    }
    friend bool operator==(const Letters& a, const Letters& b) { return a.at_ == b.at_; }

private:
    const char* at_;
    StopToken stop_;
    const char** seen_;
};

/// `file:line:col` of a byte of a text, or `file: byte n` of one that lies in a binary file from `begin` on.
std::string place_in(const std::string& file, std::string_view text, std::size_t byte, std::uint64_t begin) {
    if (begin > 0) return fmt::format("{}: byte {}", file, begin + byte);
    const std::string_view before = text.substr(0, byte);
    const std::size_t line_begin = before.rfind('\n') + 1;  // npos + 1 is 0
    const auto starts = [](char c) { return (c & 0xc0) != 0x80; };
    return fmt::format("{}:{}:{}", file, std::ranges::count(before, '\n') + 1,
                       std::ranges::count_if(before.substr(line_begin), starts) + 1);
}

/// Looks through a JSON before memory is made of it: how deep its values stand and how many there are depends on what
/// the text says of itself. (The library's own callback looks at all elements of an array again behind each of them.)
class Limits final : public nlohmann::json_sax<json> {
public:
    using Fail = std::function<void(const std::string&)>;
    explicit Limits(Fail fail) : fail_(std::move(fail)) {}

    bool null() override { return count(); }
    bool boolean(bool) override { return count(); }
    bool number_integer(number_integer_t) override { return count(); }
    bool number_unsigned(number_unsigned_t) override { return count(); }
    bool number_float(number_float_t, const string_t&) override { return count(); }
    bool string(string_t&) override { return count(); }
    bool binary(binary_t&) override { return count(); }
    bool key(string_t&) override { return true; }
    bool start_object(std::size_t) override { return enter(); }
    bool end_object() override { return leave(); }
    bool start_array(std::size_t) override { return enter(); }
    bool end_array() override { return leave(); }
    bool parse_error(std::size_t, const std::string&, const json::exception& error) override {
        // "[json.exception.parse_error.101] parse error at line 1, column 2: syntax error …": the place is ours.
        const std::string_view what = error.what();
        const std::size_t colon = what.find(": ");
        fail_("is not JSON: " + std::string(colon < what.size() ? what.substr(colon + 2) : what));
        return false;
    }

private:
    bool count() {
        if (++values_ > most_values) fail_(fmt::format("has more than {} values; is it a mesh?", most_values));
        return true;
    }
    bool enter() {
        if (++depth_ > deepest) fail_(fmt::format("stands in more than {} values; is it a glTF?", deepest));
        return count();
    }
    bool leave() {
        --depth_;
        return true;
    }

    Fail fail_;
    int depth_ = 0;
    std::size_t values_ = 0;
};

json parsed(const std::string& file, std::string_view text, std::uint64_t begin, StopToken stop) {
    const char* seen = text.data();
    Limits limits([&](const std::string& what) {
        const auto read = static_cast<std::size_t>(seen - text.data());
        throw InputError(place_in(file, text, read - (read > 0 ? 1 : 0), begin) + ": " + what);
    });
    const Letters first(text.data(), stop), last(text.data() + text.size(), stop);
    json::sax_parse(Letters(text.data(), stop, &seen), last, &limits);
    return json::parse(first, last);
}

/// The bytes that four letters each of base64 stand for; nothing where they are none.
std::optional<std::string> from_base64(std::string_view letters, StopToken stop) {
    constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::array<std::int8_t, 256> values;
    values.fill(-1);
    for (std::size_t i = 0; i < alphabet.size(); ++i)
        values[static_cast<unsigned char>(alphabet[i])] = static_cast<std::int8_t>(i);
    for (int padding = 0; padding < 2 && letters.ends_with('='); ++padding) letters.remove_suffix(1);
    if (letters.size() % 4 == 1) return std::nullopt;
    std::string bytes;
    bytes.reserve(letters.size() / 4 * 3 + 2);
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < letters.size(); ++i) {
        const std::int8_t value = values[static_cast<unsigned char>(letters[i])];
        if (value < 0) return std::nullopt;
        bits = bits << 6 | static_cast<std::uint32_t>(value);
        if (i % 4 != 0) bytes += static_cast<char>(bits >> (6 - 2 * (i % 4)));
        if (i % 0x10000 == 0) stop.check();
    }
    return bytes;
}

/// `%20` as the byte that it stands for; nothing where it is none.
std::optional<std::string> from_percents(std::string_view uri) {
    std::string name;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        if (uri[i] != '%') {
            name += uri[i];
            continue;
        }
        const std::string_view digits = uri.substr(i + 1, 2);
        unsigned byte = 0;
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), byte, 16);
        if (digits.size() < 2 || error != std::errc() || end != digits.data() + 2) return std::nullopt;
        name += static_cast<char>(byte);
        i += 2;
    }
    return name;
}

/// A value, and the way to it from the top: `meshes[0].primitives[2]`.
struct Value {
    const json* json_value = nullptr;
    std::string way = {};
    const std::string* file = nullptr;

    [[noreturn]] void fail(const std::string& what) const {
        throw InputError(*file + ": " + (way.empty() ? "" : way + ": ") + what);
    }
    [[nodiscard]] bool has(const char* key) const { return json_value->contains(key); }
    /// A member that must be there.
    [[nodiscard]] Value at(const char* key) const {
        if (!json_value->is_object()) fail("is not an object");
        const auto found = json_value->find(key);
        if (found == json_value->end()) fail(std::string("has no ") + key);
        return {&*found, way.empty() ? key : way + '.' + key, file};
    }
    /// The elements of an array; none where the key is missing.
    [[nodiscard]] std::vector<Value> elements(const char* key) const {
        std::vector<Value> all;
        if (!has(key)) return all;
        const Value array = at(key);
        if (!array.json_value->is_array()) array.fail("is not an array");
        for (const json& element : *array.json_value)
            all.push_back({&element, fmt::format("{}[{}]", array.way, all.size()), file});
        return all;
    }
    [[nodiscard]] std::uint64_t whole() const {
        if (!json_value->is_number_unsigned()) fail("is not a whole number from 0 on");
        return json_value->get<std::uint64_t>();
    }
    [[nodiscard]] std::uint64_t whole(const char* key, std::uint64_t otherwise) const {
        return has(key) ? at(key).whole() : otherwise;
    }
    [[nodiscard]] const std::string& text() const {
        if (!json_value->is_string()) fail("is not a string");
        return json_value->get_ref<const std::string&>();
    }
};

/// The meshes of one file. Buffers are read when a primitive needs them, once each, and so are vertices: primitives
/// that share an accessor share its vertices.
class GltfModel {
public:
    GltfModel(MeshBytes& bytes, const MeshTerms& terms) : file_(bytes.name()), terms_(terms) {
        const bool is_binary = bytes.look(4) == "glTF";
        const auto [text, begin] = is_binary ? json_of_glb(bytes) : std::pair(whole_text(bytes), std::uint64_t{0});
        json_ = parsed(file_, text, begin, terms.stop);
        top_ = {&json_, "", &file_};
        if (!json_.is_object()) top_.fail("is not an object, and a glTF is one");
        const std::string version = top_.at("asset").at("version").text();
        if (!version.starts_with("2."))
            top_.at("asset").at("version").fail("is " + toml::quoted_excerpt(version) + ", and 2.0 is read");
        for (const char* key : {"nodes", "meshes", "accessors", "bufferViews", "buffers"})
            sections_[key] = top_.elements(key);
        buffers_.resize(sections_["buffers"].size());
    }

    MeshInFile read() {
        const auto scenes = top_.elements("scenes");
        if (scenes.empty()) {
            for (const Value& mesh : sections_["meshes"]) add(mesh);
            return std::move(found_);
        }
        const std::uint64_t scene = top_.whole("scene", 0);
        if (scene >= scenes.size()) top_.fail(fmt::format("names scene {}, and has {}", scene, scenes.size()));
        visit(scenes[scene].elements("nodes"));
        return std::move(found_);
    }

private:
    std::string whole_text(MeshBytes& bytes) const {
        if (bytes.size() > most_text)
            throw InputError(file_ + ": is larger than 512 MiB; write its buffers to a .bin beside it, or a .glb");
        return std::string(bytes.take(bytes.size()));
    }
    /// The JSON of a binary, and its place; the bytes behind it are kept.
    std::pair<std::string, std::uint64_t> json_of_glb(MeshBytes& bytes) {
        const auto fail = [&](std::uint64_t byte, const std::string& what) {
            throw InputError(fmt::format("{}: byte {}: {}; was it cut short?", file_, byte, what));
        };
        const auto next_word = [&] {
            const std::uint64_t place = bytes.place();
            const std::string_view raw = bytes.take(4);
            if (raw.size() < 4) fail(place, "ends inside of a head");
            std::uint32_t word;
            std::memcpy(&word, raw.data(), 4);
            return word;
        };
        const auto next_chunk = [&](std::uint32_t kind, const char* what) {
            const std::uint64_t place = bytes.place();
            const std::uint32_t size = next_word();
            if (next_word() != kind) throw InputError(fmt::format("{}: byte {}: is not {}", file_, place + 4, what));
            if (size > bytes.left()) fail(place, fmt::format("names {} bytes, and {} follow", size, bytes.left()));
            return size;
        };
        next_word();
        if (const std::uint32_t version = next_word(); version != 2)
            throw InputError(fmt::format("{}: byte 4: is of version {}, and 2 is read", file_, version));
        if (const std::uint32_t size = next_word(); size != bytes.size())
            fail(8, fmt::format("names {} bytes, and the file has {}", size, bytes.size()));
        const std::uint32_t size = next_chunk(0x4e4f534a, "a chunk of JSON");
        if (size > most_text) throw InputError(file_ + ": byte 12: its JSON is larger than 512 MiB");
        const std::uint64_t begin = bytes.place();
        std::string text(bytes.take(size));
        if (bytes.left() > 0) own_.emplace(bytes.take(next_chunk(0x004e4942, "a chunk of bytes")));
        return {std::move(text), begin};
    }

    /// The element of a section that a number names.
    [[nodiscard]] const Value& element(const Value& number, const char* section, const char* what) {
        const std::uint64_t place = number.whole();
        const std::vector<Value>& all = sections_[section];
        if (place >= all.size()) number.fail(fmt::format("names {} {}, and the file has {}", what, place, all.size()));
        return all[place];
    }

    /// Nodes are trees: each is visited once, however the file links them.
    void visit(std::vector<Value> numbers) {
        std::vector<bool> visited(sections_["nodes"].size());
        std::ranges::reverse(numbers);
        while (!numbers.empty()) {
            terms_.stop.check();
            const Value number = std::move(numbers.back());
            numbers.pop_back();
            const Value& node = element(number, "nodes", "node");
            if (visited[number.whole()])
                number.fail(
                    fmt::format("names node {} again; nodes are trees, and each stands in one place", number.whole()));
            visited[number.whole()] = true;
            require_unmoved(node);
            if (node.has("mesh")) add(element(node.at("mesh"), "meshes", "mesh"));
            auto children = node.elements("children");
            numbers.insert(numbers.end(), std::move_iterator(children.rbegin()), std::move_iterator(children.rend()));
        }
    }

    static void require_unmoved(const Value& node) {
        static const std::pair<const char*, json> stays[] = {
            {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}},
            {"translation", {0, 0, 0}},
            {"rotation", {0, 0, 0, 1}},
            {"scale", {1, 1, 1}}};
        for (const auto& [key, identity] : stays)
            if (node.has(key) && *node.at(key).json_value != identity)
                node.at(key).fail(
                    (node.has("name") ? "moves " + toml::quoted_excerpt(node.at("name").text()) : "moves a mesh") +
                    ", which would round its vertices; apply transforms before you export");
    }

    void add(const Value& mesh) {
        constexpr std::uint64_t triangles = 4;
        for (const Value& part : mesh.elements("primitives")) {
            if (const std::uint64_t mode = part.whole("mode", triangles); mode != triangles)
                part.at("mode").fail(fmt::format("is {}, and 4, triangles, is read", mode));
            if (part.has("extensions") && !part.at("extensions").json_value->empty())
                part.at("extensions")
                    .fail("are not read: " + toml::excerpt(part.at("extensions").json_value->begin().key()));
            if (!part.has("attributes") || !part.at("attributes").has("POSITION")) continue;
            const Vertices vertices = vertices_of(part.at("attributes").at("POSITION"));
            add_faces(part, vertices);
        }
    }

    /// Element i of an accessor begins at byte i·step, and all of them lie in the buffer.
    struct Elements {
        const char* first;
        std::size_t step, count;
        std::uint64_t place;  ///< of the first, in the buffer

        template <class T, std::size_t n>
        [[nodiscard]] std::array<T, n> at(std::size_t i) const {
            std::array<T, n> numbers;
            std::memcpy(numbers.data(), first + i * step, sizeof numbers);
            return numbers;
        }
    };
    [[nodiscard]] Elements elements_of(const Value& accessor, std::size_t size) {
        if (accessor.has("sparse")) accessor.at("sparse").fail("is not read");
        const Value& view = element(accessor.at("bufferView"), "bufferViews", "buffer view");
        const std::string& bytes = buffer(view.at("buffer"));
        const std::uint64_t begin = view.whole("byteOffset", 0), length = view.at("byteLength").whole(),
                            offset = accessor.whole("byteOffset", 0), count = accessor.at("count").whole(),
                            step = view.whole("byteStride", size);
        if (begin > bytes.size() || length > bytes.size() - begin)
            view.fail(fmt::format("ends behind its buffer, which has {} bytes; was it cut short?", bytes.size()));
        if (step < size) view.at("byteStride").fail(fmt::format("is {}, and an element has {} bytes", step, size));
        if (offset > length || (count > 0 && (size > length - offset || count - 1 > (length - offset - size) / step)))
            accessor.fail(fmt::format(
                "has {} elements, which end behind its buffer view of {} bytes; was it cut short?", count, length));
        return {bytes.data() + begin + offset, step, count, begin + offset};
    }

    /// Those of an accessor, among all.
    struct Vertices {
        std::size_t first, count;
    };
    Vertices vertices_of(const Value& number) {
        const Value& accessor = element(number, "accessors", "accessor");
        const auto [known, is_new] = vertices_.try_emplace(number.whole());
        if (!is_new) return known->second;
        constexpr std::uint64_t floats = 5126;
        if (accessor.at("type").text() != "VEC3" || accessor.at("componentType").whole() != floats)
            accessor.fail("is not three floats a vertex");
        const Elements all = elements_of(accessor, 12);
        std::vector<Vec<double>>& vertices = found_.mesh.vertices;
        require_room(accessor, vertices.size(), all.count, "vertices");
        known->second = {vertices.size(), all.count};
        for (std::size_t i = 0; i < all.count; ++i) {
            terms_.stop.check();
            const auto p = all.at<float, 3>(i);
            for (const float x : p)
                if (const auto fault = fault_of_coordinate(x, terms_.stored); !fault.empty())
                    accessor.fail(
                        fmt::format("vertex {}, at byte {} of its buffer, {}", i, all.place + i * all.step, fault));
            vertices.emplace_back(p[0], p[1], p[2]);
        }
        return known->second;
    }

    /// A vertex takes twelve bytes of a buffer and a triangle three, but where accessors overlap or are named again. So
    /// no more are taken than there are bytes: memory is a multiple of the files'.
    void require_room(const Value& value, std::size_t taken, std::size_t more, const char* what) const {
        if (more > most_faces || taken > most_faces - more)
            value.fail(fmt::format("makes more than 2^31 - 1 {}", what));
        if (taken + more > bytes_read_)
            value.fail(
                fmt::format("makes more {} than the buffers of the file have bytes; its primitives name the same "
                            "numbers again and again",
                            what));
    }

    void add_faces(const Value& part, const Vertices& vertices) {
        if (!part.has("indices")) {
            add_faces(part, vertices, vertices.count, [](std::size_t i) { return i; });
            return;
        }
        const Value& accessor = element(part.at("indices"), "accessors", "accessor");
        if (accessor.at("type").text() != "SCALAR") accessor.fail("is not one number a corner");
        switch (accessor.at("componentType").whole()) {
            case 5121: return add_indexed<std::uint8_t>(accessor, vertices);
            case 5123: return add_indexed<std::uint16_t>(accessor, vertices);
            case 5125: return add_indexed<std::uint32_t>(accessor, vertices);
            default: accessor.at("componentType").fail("is not one of whole numbers from 0 on, 5121, 5123 or 5125");
        }
    }
    template <class T>
    void add_indexed(const Value& accessor, const Vertices& vertices) {
        const Elements all = elements_of(accessor, sizeof(T));
        add_faces(accessor, vertices, all.count, [&](std::size_t i) { return std::size_t{all.at<T, 1>(i)[0]}; });
    }
    template <class At>
    void add_faces(const Value& value, const Vertices& vertices, std::size_t corners, const At& at) {
        if (corners % 3 != 0) value.fail("has " + toml::counted(corners, "corner") + "; three make a triangle");
        require_room(value, found_.mesh.faces.size(), corners / 3, "triangles");
        for (std::size_t i = 0; i < corners; i += 3) {
            terms_.stop.check();
            std::array<std::uint32_t, 3> face;
            for (std::size_t k = 0; k < 3; ++k) {
                const std::size_t corner = at(i + k);
                if (corner >= vertices.count)
                    value.fail(fmt::format("face {} names vertex {} of {}; vertices count from 0", i / 3, corner,
                                           vertices.count));
                face[k] = static_cast<std::uint32_t>(vertices.first + corner);
            }
            found_.add(face, found_.mesh.faces.size());
        }
    }

    /// The bytes of a buffer, read where they are wanted first.
    const std::string& buffer(const Value& number) {
        const Value& value = element(number, "buffers", "buffer");
        std::optional<std::string>& bytes = buffers_[number.whole()];
        if (bytes) return *bytes;
        const std::uint64_t length = value.at("byteLength").whole();
        bytes = value.has("uri") ? bytes_of(value.at("uri"), length) : own_bytes(value, number.whole());
        if (bytes->size() < length)
            value.fail(fmt::format("has {} of its {} bytes; was it cut short?", bytes->size(), length));
        bytes->resize(length);
        bytes_read_ += length;
        return *bytes;
    }
    std::string own_bytes(const Value& value, std::uint64_t place) {
        if (place != 0 || !own_) value.fail("has no uri, and no bytes follow the JSON");
        return std::move(*own_);
    }
    std::string bytes_of(const Value& uri, std::uint64_t length) {
        const std::string& text = uri.text();
        if (text.starts_with("data:")) {
            constexpr std::string_view mark = ";base64,";
            const std::size_t begin = text.find(mark);
            auto bytes = begin < text.size()
                             ? from_base64(std::string_view(text).substr(begin + mark.size()), terms_.stop)
                             : std::nullopt;
            if (!bytes) uri.fail("is not base64; write data:application/octet-stream;base64, and letters");
            return std::move(*bytes);
        }
        const std::filesystem::path file = path_of(uri);
        if (!opened_.insert(file).second)
            uri.fail("names the file of another buffer; write one buffer, and views of it");
        try {
            MeshBytes beside(file, terms_.stop);
            return std::string(beside.take(std::min(length, beside.size())));
        } catch (const InputError& error) {
            uri.fail(error.what());
        }
    }
    /// A file in the folder of this one or below it: what a mesh from elsewhere names is not looked for elsewhere.
    [[nodiscard]] std::filesystem::path path_of(const Value& uri) const {
        const std::string& text = uri.text();
        const auto name = from_percents(text);
        if (!name || name->empty() || name->find('\0') != std::string::npos)
            uri.fail("is " + toml::quoted_excerpt(text) + ", which is not the name of a file");
        const std::filesystem::path path(*name);
        const bool leads_out =
            path.is_absolute() || text.find(':') != std::string::npos || std::ranges::find(path, "..") != path.end();
        if (leads_out)
            uri.fail(
                "is " + toml::quoted_excerpt(text) +
                ", which lies outside of the folder of the glTF and is not opened; copy it there, and name it alone");
        return (std::filesystem::path(file_).parent_path() / path).lexically_normal();
    }

    const std::string file_;
    const MeshTerms terms_;
    json json_;
    Value top_;
    std::map<std::string, std::vector<Value>, std::less<>> sections_;
    std::optional<std::string> own_;  ///< the bytes behind the JSON of a binary
    std::vector<std::optional<std::string>> buffers_;
    std::set<std::filesystem::path> opened_;
    std::uint64_t bytes_read_ = 0;  ///< of all buffers so far
    std::map<std::uint64_t, Vertices> vertices_;
    MeshInFile found_;
};

}  // namespace

MeshInFile read_gltf(MeshBytes& bytes, const MeshTerms& terms) { return GltfModel(bytes, terms).read(); }

}  // namespace lostbits::scene::triangle
