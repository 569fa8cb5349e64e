// Reads glTF 2.0. The JSON says where the bytes of buffers are, and vertices are stored there in binary32.
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <set>
#include <utility>

#include "shapes/triangle/mesh/gltf_json.hpp"
#include "shapes/triangle/mesh/mesh_readers.hpp"
#include "text/count_with_noun.hpp"
#include "text/did_you_mean.hpp"

namespace lostbits::scene::triangle {

namespace {

using nlohmann::json;

static_assert(std::endian::native == std::endian::little, "glTF is little endian, and its numbers are copied");

constexpr std::uint64_t max_json_bytes = std::uint64_t{1} << 29;  // larger meshes use .bin or .glb

/// The meshes of one file. A buffer is read once, when a primitive first needs it. The same holds for an accessor of
/// vertices: primitives that share an accessor share its vertices.
class GltfModel {
public:
    GltfModel(MeshBytes& bytes, const MeshSettings& settings) : file_(bytes.name()), settings_(settings) {
        const bool is_binary = bytes.peek(4) == "glTF";
        const auto [text, begin] = is_binary ? read_glb_json(bytes) : std::pair(read_text(bytes), std::uint64_t{0});

        json_ = parse_gltf_json(file_, text, begin, settings.stop);
        root_ = {&json_, "", &file_};
        if (!json_.is_object()) root_.fail("is not a JSON object; a glTF file is one");
        const std::string version = root_.at("asset").at("version").text();
        if (!version.starts_with("2."))
            root_.at("asset").at("version").fail("is " + text::quoted_excerpt(version) + "; only 2.0 is supported");
        require_no_extensions();

        for (const char* key : {"nodes", "meshes", "accessors", "bufferViews", "buffers"})
            sections_[key] = root_.elements(key);
        buffers_.resize(sections_["buffers"].size());
    }

    ParsedMesh read() {
        const auto scenes = root_.elements("scenes");
        if (scenes.empty()) {
            if (root_.has("scene")) root_.fail("names a scene, but the file has none");
            for (const GltfValue& mesh : sections_["meshes"]) add_mesh(mesh);
            return std::move(parsed_mesh_);
        }
        const std::uint64_t scene = root_.unsigned_number("scene", 0);
        if (scene >= scenes.size())
            root_.fail(fmt::format("names scene {}, but the file has {}", scene, scenes.size()));
        visit_nodes(scenes[scene].elements("nodes"));
        return std::move(parsed_mesh_);
    }

private:
    /// Refuses required extensions: by glTF 2.0, a reader that lacks an extension of this list must not read the file.
    void require_no_extensions() const {
        std::string names;
        for (const GltfValue& name : root_.elements("extensionsRequired"))
            names += (names.empty() ? "" : ", ") + text::quoted_excerpt(name.text());
        if (!names.empty())
            root_.at("extensionsRequired")
                .fail("names " + names + ", which are not supported; export the mesh without them");
    }
    std::string read_text(MeshBytes& bytes) const {
        if (bytes.size() > max_json_bytes)
            throw InputError(
                file_ + ": is larger than 512 MiB; write its buffers to a .bin file beside it, or write a .glb file");
        return std::string(bytes.take(bytes.size()));
    }
    /// Returns the JSON of a binary file, and its position. Stores the bytes of the chunk after it.
    std::pair<std::string, std::uint64_t> read_glb_json(MeshBytes& bytes) {
        read_word(bytes);  // the letters glTF, which are known to be there
        if (const std::uint32_t version = read_word(bytes); version != 2)
            throw InputError(fmt::format("{}: byte 4: has version {}; only 2 is supported", file_, version));
        if (const std::uint32_t size = read_word(bytes); size != bytes.size())
            fail_cut_short(8, fmt::format("states {} bytes, but the file has {}", size, bytes.size()));

        const std::uint32_t size = read_chunk_header(bytes, ChunkKind::json_text, "a chunk of JSON");
        if (size > max_json_bytes) throw InputError(file_ + ": byte 12: its JSON is larger than 512 MiB");
        const std::uint64_t begin = bytes.position();
        std::string text(bytes.take(size));
        if (bytes.remaining() > 0)
            chunk_bytes_.emplace(bytes.take(read_chunk_header(bytes, ChunkKind::binary, "a chunk of bytes")));
        return {std::move(text), begin};
    }

    /// The kinds of chunks of a binary file, which spell JSON and BIN.
    enum class ChunkKind : std::uint32_t { json_text = 0x4e4f534a, binary = 0x004e4942 };

    std::uint32_t read_word(MeshBytes& bytes) const {
        const std::uint64_t position = bytes.position();
        const std::string_view word_bytes = bytes.take(4);
        if (word_bytes.size() < 4) fail_cut_short(position, "ends inside a header");
        std::uint32_t word;
        std::memcpy(&word, word_bytes.data(), 4);
        return word;
    }
    /// Returns the size of a chunk, which must be of this kind.
    std::uint32_t read_chunk_header(MeshBytes& bytes, ChunkKind kind, const char* expected) const {
        const std::uint64_t position = bytes.position();
        const std::uint32_t size = read_word(bytes);
        if (read_word(bytes) != static_cast<std::uint32_t>(kind))
            throw InputError(fmt::format("{}: byte {}: is not {}", file_, position + 4, expected));
        if (size > bytes.remaining())
            fail_cut_short(position, fmt::format("states {} bytes, but {} follow", size, bytes.remaining()));
        return size;
    }
    [[noreturn]] void fail_cut_short(std::uint64_t byte, const std::string& message) const {
        throw InputError(fmt::format("{}: byte {}: {}; was it cut short?", file_, byte, message));
    }

    /// Returns the element of a section with a given index.
    [[nodiscard]] const GltfValue& element(const GltfValue& index_value, const char* section,
                                           const char* element_name) {
        const std::uint64_t index = index_value.unsigned_number();
        const std::vector<GltfValue>& all = sections_[section];
        if (index >= all.size())
            index_value.fail(fmt::format("names {} {}, but the file has {}", element_name, index, all.size()));
        return all[index];
    }

    /// Visits the nodes with these indices and their children. Nodes must form trees, so each node is visited at most
    /// once.
    void visit_nodes(std::vector<GltfValue> node_indices) {
        std::vector<bool> visited(sections_["nodes"].size());
        std::ranges::reverse(node_indices);
        while (!node_indices.empty()) {
            settings_.stop.check();
            const GltfValue index_value = std::move(node_indices.back());
            node_indices.pop_back();
            const GltfValue& node = element(index_value, "nodes", "node");
            if (visited[index_value.unsigned_number()])
                index_value.fail(fmt::format("names node {} again; nodes form trees, and each node has one parent",
                                             index_value.unsigned_number()));
            visited[index_value.unsigned_number()] = true;
            require_identity_transform(node);
            if (node.has("mesh")) add_mesh(element(node.at("mesh"), "meshes", "mesh"));
            auto children = node.elements("children");
            node_indices.insert(node_indices.end(), std::move_iterator(children.rbegin()),
                                std::move_iterator(children.rend()));
        }
    }

    static void require_identity_transform(const GltfValue& node) {
        static const std::pair<const char*, json> identities[] = {
            {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}},
            {"translation", {0, 0, 0}},
            {"rotation", {0, 0, 0, 1}},
            {"scale", {1, 1, 1}}};
        for (const auto& [key, identity] : identities)
            if (node.has(key) && *node.at(key).json_value != identity)
                node.at(key).fail(
                    (node.has("name") ? "moves " + text::quoted_excerpt(node.at("name").text()) : "moves a mesh") +
                    ", which would round its vertices; apply transforms before you export");
    }

    void add_mesh(const GltfValue& mesh) {
        constexpr std::uint64_t triangle_count = 4;
        for (const GltfValue& primitive : mesh.elements("primitives")) {
            if (const std::uint64_t mode = primitive.unsigned_number("mode", triangle_count); mode != triangle_count)
                primitive.at("mode").fail(fmt::format("is {}; only 4, triangles, is supported", mode));
            if (primitive.has("extensions") && !primitive.at("extensions").json_value->empty())
                primitive.at("extensions")
                    .fail("are not supported: " + text::excerpt(primitive.at("extensions").json_value->begin().key()));
            if (!primitive.has("attributes") || !primitive.at("attributes").has("POSITION")) continue;
            const Vertices vertices = read_vertices(primitive.at("attributes").at("POSITION"));
            add_faces(primitive, vertices);
        }
    }

    /// The elements of an accessor. Element i begins i·stride bytes after the first, and all are inside the buffer.
    struct Elements {
        const char* first;
        std::size_t stride, count;
        std::uint64_t offset;  ///< offset of the first element in the buffer

        template <class T, std::size_t n>
        [[nodiscard]] std::array<T, n> at(std::size_t i) const {
            std::array<T, n> numbers;
            std::memcpy(numbers.data(), first + i * stride, sizeof numbers);
            return numbers;
        }
    };
    [[nodiscard]] Elements read_elements(const GltfValue& accessor, std::size_t size) {
        if (accessor.has("sparse")) accessor.at("sparse").fail("is not supported");
        const GltfValue& view = element(accessor.at("bufferView"), "bufferViews", "buffer view");
        const std::string& bytes = buffer(view.at("buffer"));
        const std::uint64_t begin = view.unsigned_number("byteOffset", 0),
                            length = view.at("byteLength").unsigned_number(),
                            offset = accessor.unsigned_number("byteOffset", 0),
                            count = accessor.at("count").unsigned_number(),
                            stride = view.unsigned_number("byteStride", size);

        // Checks that the view is inside its buffer, and the elements inside the view.
        if (begin > bytes.size() || length > bytes.size() - begin)
            view.fail(fmt::format("ends beyond its buffer, which has {} bytes; was it cut short?", bytes.size()));
        if (stride < size) view.at("byteStride").fail(fmt::format("is {}, but an element has {} bytes", stride, size));
        if (offset > length || (count > 0 && (size > length - offset || count - 1 > (length - offset - size) / stride)))
            accessor.fail(fmt::format(
                "has {} elements, which end beyond its buffer view of {} bytes; was it cut short?", count, length));
        return {bytes.data() + begin + offset, stride, count, begin + offset};
    }

    /// The vertices of an accessor, as a range of the vertices of the mesh.
    struct Vertices {
        std::size_t first, count;
    };
    Vertices read_vertices(const GltfValue& index_value) {
        const GltfValue& accessor = element(index_value, "accessors", "accessor");
        const auto [entry, is_new] = vertices_.try_emplace(index_value.unsigned_number());
        if (!is_new) return entry->second;
        constexpr std::uint64_t float_count = 5126;
        if (accessor.at("type").text() != "VEC3" || accessor.at("componentType").unsigned_number() != float_count)
            accessor.fail("does not hold three floats for each vertex");
        const Elements elements = read_elements(accessor, 12);
        std::vector<Vec<double>>& vertices = parsed_mesh_.mesh.vertices;
        require_within_limit(accessor, vertices.size(), elements.count, "vertices");
        entry->second = {vertices.size(), elements.count};

        for (std::size_t i = 0; i < elements.count; ++i) {
            settings_.stop.check();
            const auto p = elements.at<float, 3>(i);
            for (const float x : p)
                if (const auto fault = reason_to_refuse_coordinate(x, settings_.vertex_format); !fault.empty())
                    accessor.fail(fmt::format("vertex {}, at byte {} of its buffer, {}", i,
                                              elements.offset + i * elements.stride, fault));
            vertices.emplace_back(p[0], p[1], p[2]);
        }
        return entry->second;
    }

    /// Limits the memory to a multiple of the size of the files. A vertex takes twelve bytes of a buffer and a triangle
    /// at least three, unless accessors overlap or are named more than once. So the limit is one vertex, and one
    /// triangle, for each byte.
    void require_within_limit(const GltfValue& value, std::size_t present_count, std::size_t added_count,
                              const char* element_names) const {
        if (added_count > max_faces || present_count > max_faces - added_count)
            value.fail(fmt::format("makes more than 2^31 - 1 {}", element_names));
        if (present_count + added_count > bytes_read_)
            value.fail(
                fmt::format("makes more {} than the buffers of the file have bytes; its primitives use the same "
                            "numbers again and again",
                            element_names));
    }

    void add_faces(const GltfValue& primitive, const Vertices& vertices) {
        if (!primitive.has("indices")) {
            add_faces(primitive, vertices, vertices.count, [](std::size_t i) { return i; });
            return;
        }
        const GltfValue& accessor = element(primitive.at("indices"), "accessors", "accessor");
        if (accessor.at("type").text() != "SCALAR") accessor.fail("does not hold one number for each corner");
        switch (accessor.at("componentType").unsigned_number()) {
            case 5121: return add_indexed_faces<std::uint8_t>(accessor, vertices);
            case 5123: return add_indexed_faces<std::uint16_t>(accessor, vertices);
            case 5125: return add_indexed_faces<std::uint32_t>(accessor, vertices);
            default: accessor.at("componentType").fail("is not a type of unsigned numbers; write 5121, 5123 or 5125");
        }
    }
    template <class T>
    void add_indexed_faces(const GltfValue& accessor, const Vertices& vertices) {
        const Elements elements = read_elements(accessor, sizeof(T));
        add_faces(accessor, vertices, elements.count,
                  [&](std::size_t i) { return std::size_t{elements.at<T, 1>(i)[0]}; });
    }
    template <class IndexAt>
    void add_faces(const GltfValue& value, const Vertices& vertices, std::size_t corner_count,
                   const IndexAt& index_at) {
        if (corner_count % 3 != 0)
            value.fail("has " + text::count_with_noun(corner_count, "corner") + "; three make a triangle");
        require_within_limit(value, parsed_mesh_.mesh.faces.size(), corner_count / 3, "triangles");
        for (std::size_t i = 0; i < corner_count; i += 3) {
            settings_.stop.check();
            std::array<std::uint32_t, 3> face;
            for (std::size_t k = 0; k < 3; ++k) {
                const std::size_t corner = index_at(i + k);
                if (corner >= vertices.count)
                    value.fail(fmt::format("face {} names vertex {} of {}; vertices count from 0", i / 3, corner,
                                           vertices.count));
                face[k] = static_cast<std::uint32_t>(vertices.first + corner);
            }
            parsed_mesh_.add(face, parsed_mesh_.mesh.faces.size());
        }
    }

    /// Returns the bytes of a buffer, read when they are first needed.
    const std::string& buffer(const GltfValue& index_value) {
        const GltfValue& value = element(index_value, "buffers", "buffer");
        std::optional<std::string>& bytes = buffers_[index_value.unsigned_number()];
        if (bytes) return *bytes;
        const std::uint64_t length = value.at("byteLength").unsigned_number();
        bytes = value.has("uri") ? read_uri(value.at("uri"), length) : read_chunk(value, index_value.unsigned_number());
        if (bytes->size() < length)
            value.fail(fmt::format("has {} of its {} bytes; was it cut short?", bytes->size(), length));
        bytes->resize(length);
        bytes_read_ += length;
        return *bytes;
    }
    std::string read_chunk(const GltfValue& value, std::uint64_t index) {
        if (index != 0 || !chunk_bytes_) value.fail("has no uri, and no bytes follow the JSON");
        return std::move(*chunk_bytes_);
    }
    std::string read_uri(const GltfValue& uri, std::uint64_t length) {
        if (uri.text().starts_with("data:")) return read_data_uri(uri);
        const std::filesystem::path file = resolve_path(uri);
        if (!opened_files_.insert(file).second)
            uri.fail("names the file of another buffer; write one buffer, and views of it");
        try {
            MeshBytes other_file(file, settings_.stop);
            return std::string(other_file.take(std::min(length, other_file.size())));
        } catch (const InputError& error) {
            uri.fail(error.what());
        }
    }
    [[nodiscard]] std::string read_data_uri(const GltfValue& uri) const {
        constexpr std::string_view separator = ";base64,";
        const std::string& text = uri.text();
        const std::size_t begin = text.find(separator);
        auto bytes = begin < text.size()
                         ? decode_base64(std::string_view(text).substr(begin + separator.size()), settings_.stop)
                         : std::nullopt;
        if (!bytes) uri.fail("is not base64; write data:application/octet-stream;base64, followed by the letters");
        return std::move(*bytes);
    }
    /// Returns the path of a file, which must be in the folder of the glTF or below it, so that a downloaded mesh
    /// cannot open other files.
    [[nodiscard]] std::filesystem::path resolve_path(const GltfValue& uri) const {
        const std::string& text = uri.text();
        const auto name = decode_uri(text);
        if (!name || name->empty() || name->find('\0') != std::string::npos)
            uri.fail("is " + text::quoted_excerpt(text) + ", which is not the name of a file");
        const std::filesystem::path path(*name);
        const bool leaves_folder =
            path.is_absolute() || text.find(':') != std::string::npos || std::ranges::find(path, "..") != path.end();
        if (leaves_folder)
            uri.fail(
                "is " + text::quoted_excerpt(text) +
                ", which is outside the folder of the glTF and is not opened; copy it there, and write its name alone");
        return (std::filesystem::path(file_).parent_path() / path).lexically_normal();
    }

    const std::string file_;
    const MeshSettings settings_;
    json json_;
    GltfValue root_;
    std::map<std::string, std::vector<GltfValue>, std::less<>> sections_;
    std::optional<std::string> chunk_bytes_;  ///< bytes of the chunk after the JSON in a binary file
    std::vector<std::optional<std::string>> buffers_;
    std::set<std::filesystem::path> opened_files_;
    std::uint64_t bytes_read_ = 0;  ///< total of all buffers so far
    std::map<std::uint64_t, Vertices> vertices_;
    ParsedMesh parsed_mesh_;
};

}  // namespace

ParsedMesh read_gltf(MeshBytes& bytes, const MeshSettings& settings) { return GltfModel(bytes, settings).read(); }

}  // namespace lostbits::scene::triangle
