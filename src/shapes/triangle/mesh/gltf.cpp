// tinygltf finds the bytes; the vertices are the binary32 that lie there.
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#include <tiny_gltf.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include "number/error.hpp"
#include "shapes/triangle/mesh/mesh_readers.hpp"

namespace lostbits::scene::triangle {

namespace {

static_assert(std::endian::native == std::endian::little, "glTF is little endian, and its numbers are copied");

bool is_identity(const tinygltf::Node& node) {
    const auto is_one_of = [](const std::vector<double>& given, std::vector<double> stays) {
        return given.empty() || given == stays;
    };
    return is_one_of(node.matrix, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}) &&
           is_one_of(node.translation, {0, 0, 0}) && is_one_of(node.rotation, {0, 0, 0, 1}) &&
           is_one_of(node.scale, {1, 1, 1});
}

/// Whether the library may read it: of a folder it would ask how long it is, and believe the answer.
bool is_file(const std::string& path, void*) {
    std::error_code ignored;
    return std::filesystem::is_regular_file(path, ignored);
}

/// The meshes of one file. Places are counted by the library as int, −1 where there is none.
class GltfModel {
public:
    explicit GltfModel(const std::filesystem::path& path) : path_(path) {
        tinygltf::TinyGLTF loader;
        loader.SetFsCallbacks(
            {is_file, tinygltf::ExpandFilePath, tinygltf::ReadWholeFile, tinygltf::WriteWholeFile, nullptr});
        loader.SetImageLoader([](tinygltf::Image*, int, std::string*, std::string*, int, int, const unsigned char*, int,
                                 void*) { return true; },
                              nullptr);
        std::string errors, warnings;
        const bool loaded = path.extension() == ".glb"
                                ? loader.LoadBinaryFromFile(&model_, &errors, &warnings, path.string())
                                : loader.LoadASCIIFromFile(&model_, &errors, &warnings, path.string());
        if (!loaded) fail("is not read: " + errors.substr(0, errors.find_last_not_of('\n') + 1));
    }

    MeshInFile read() {
        if (model_.scenes.empty()) {
            for (const tinygltf::Mesh& mesh : model_.meshes) add(mesh);
        } else {
            const auto scene = static_cast<std::size_t>(std::max(model_.defaultScene, 0));
            for (const int node : at(model_.scenes, static_cast<int>(scene), "scene").nodes) visit(node, 0);
        }
        return std::move(found_);
    }

private:
    [[noreturn]] void fail(const std::string& what) const { throw InputError(path_.string() + ": " + what); }
    template <class T>
    [[nodiscard]] const T& at(const std::vector<T>& all, int place, const std::string& what) const {
        if (place < 0 || static_cast<std::size_t>(place) >= all.size())
            fail("names " + what + " " + std::to_string(place) + ", and has " + std::to_string(all.size()));
        return all[static_cast<std::size_t>(place)];
    }

    void visit(int place, int depth) {
        constexpr int deepest = 1000;
        const tinygltf::Node& node = at(model_.nodes, place, "node");
        if (depth > deepest) fail("node " + std::to_string(place) + " stands in itself");
        if (!is_identity(node))
            fail("node " + std::to_string(place) + " (" + node.name.substr(0, 40) +
                 ") is moved by a transform, which would round its vertices; apply transforms before you export");
        if (node.mesh >= 0) add(at(model_.meshes, node.mesh, "mesh"));
        for (const int child : node.children) visit(child, depth + 1);
    }

    void add(const tinygltf::Mesh& mesh) {
        for (const tinygltf::Primitive& part : mesh.primitives) {
            if (part.mode != TINYGLTF_MODE_TRIANGLES && part.mode != -1)
                fail("mesh " + mesh.name.substr(0, 40) + " is not made of triangles: its mode is " +
                     std::to_string(part.mode) + ", and 4 is read");
            if (!part.extensions.empty()) fail("uses " + part.extensions.begin()->first + ", which is not read");
            const auto position = part.attributes.find("POSITION");
            if (position == part.attributes.end()) continue;
            const std::size_t first = found_.mesh.vertices.size();
            add_vertices(at(model_.accessors, position->second, "accessor"));
            add_faces(part.indices, first);
        }
    }

    /// Element i of an accessor begins at first + i·step, and all of them lie in the buffer.
    struct Elements {
        const unsigned char* first;
        std::size_t step, count;
    };
    [[nodiscard]] Elements elements_of(const tinygltf::Accessor& accessor, std::size_t size) const {
        if (accessor.sparse.isSparse) fail("has sparse vertices, which are not read");
        const tinygltf::BufferView& view = at(model_.bufferViews, accessor.bufferView, "buffer view");
        const tinygltf::Buffer& buffer = at(model_.buffers, view.buffer, "buffer");
        const std::size_t step = view.byteStride != 0 ? view.byteStride : size, bytes = buffer.data.size();
        const std::size_t begin = view.byteOffset + accessor.byteOffset;
        if (view.byteOffset > bytes || accessor.byteOffset > bytes || begin > bytes || step < size ||
            (accessor.count > 0 && (size > bytes - begin || (accessor.count - 1) > (bytes - begin - size) / step)))
            fail("has a buffer of " + std::to_string(bytes) +
                 " bytes, which ends before its numbers; was it cut short?");
        return {buffer.data.data() + begin, step, accessor.count};
    }

    void add_vertices(const tinygltf::Accessor& accessor) {
        if (accessor.type != TINYGLTF_TYPE_VEC3 || accessor.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT)
            fail("has vertices that are not three floats");
        const Elements all = elements_of(accessor, 12);
        if (all.count > most_vertices - found_.mesh.vertices.size()) fail("has more than 2^32 - 1 vertices");
        for (std::size_t i = 0; i < all.count; ++i) {
            float p[3];
            std::memcpy(p, all.first + i * all.step, sizeof p);
            for (const float x : p)
                if (!std::isfinite(x)) fail("vertex " + std::to_string(i) + " is not finite");
            found_.mesh.vertices.emplace_back(p[0], p[1], p[2]);
        }
    }

    void add_faces(int indices, std::size_t first) {
        const std::size_t vertices = found_.mesh.vertices.size() - first;
        std::vector<std::uint32_t> places(vertices);
        for (std::size_t i = 0; i < vertices; ++i) places[i] = static_cast<std::uint32_t>(i);
        if (indices >= 0) places = places_in(at(model_.accessors, indices, "accessor"));
        if (places.size() % 3 != 0) fail("has " + std::to_string(places.size()) + " corners; three make a triangle");
        std::vector<std::uint32_t> corners(3);
        for (std::size_t i = 0; i < places.size(); i += 3) {
            for (std::size_t k = 0; k < 3; ++k) {
                if (places[i + k] >= vertices)
                    fail("face " + std::to_string(i / 3) + " names vertex " + std::to_string(places[i + k]) + " of " +
                         std::to_string(vertices) + "; vertices count from 0");
                corners[k] = static_cast<std::uint32_t>(first + places[i + k]);
            }
            found_.add(corners, found_.mesh.faces.size());
        }
    }

    [[nodiscard]] std::vector<std::uint32_t> places_in(const tinygltf::Accessor& accessor) const {
        switch (accessor.componentType) {
            case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return copied<std::uint8_t>(accessor);
            case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return copied<std::uint16_t>(accessor);
            case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT: return copied<std::uint32_t>(accessor);
            default: fail("has corners that are not whole numbers");
        }
    }
    template <class T>
    [[nodiscard]] std::vector<std::uint32_t> copied(const tinygltf::Accessor& accessor) const {
        const Elements all = elements_of(accessor, sizeof(T));
        std::vector<std::uint32_t> places(all.count);
        for (std::size_t i = 0; i < all.count; ++i) {
            T place;
            std::memcpy(&place, all.first + i * all.step, sizeof place);
            places[i] = place;
        }
        return places;
    }

    const std::filesystem::path& path_;
    tinygltf::Model model_;
    MeshInFile found_;
};

}  // namespace

MeshInFile read_gltf(const std::filesystem::path& path, std::istream&) { return GltfModel(path).read(); }

}  // namespace lostbits::scene::triangle
