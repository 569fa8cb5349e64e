#include "shapes/triangle/mesh/mesh_file.hpp"

#include "number/error.hpp"
#include "shapes/triangle/mesh/mesh_readers.hpp"

namespace lostbits::scene::triangle {

namespace {

struct MeshFormat {
    std::string_view extension;
    ParsedMesh (*read)(MeshBytes&, const MeshSettings&);
    bool has_lines;
};
constexpr MeshFormat mesh_formats[] = {{".obj", read_obj, true},
                                       {".ply", read_ply, false},
                                       {".stl", read_stl, false},
                                       {".gltf", read_gltf, false},
                                       {".glb", read_gltf, false}};

const MeshFormat& format_of(const std::filesystem::path& path) {
    for (const MeshFormat& format : mesh_formats)
        if (path.extension() == format.extension) return format;
    throw InputError(path.string() +
                     ": is not a known kind of mesh; its name must end in .obj, .ply, .stl, .gltf or .glb");
}

}  // namespace

Mesh read_mesh_file(const std::filesystem::path& path, const MeshSettings& settings) {
    const MeshFormat& format = format_of(path);
    MeshBytes bytes(path, settings.stop);
    ParsedMesh parsed_mesh = format.read(bytes, settings);
    const auto describe_face = [&](std::size_t face) {
        return format.has_lines ? path.string() + ":" + std::to_string(parsed_mesh.lines[face])
                                : "face " + std::to_string(parsed_mesh.lines[face]) + " of " + path.string();
    };
    if (parsed_mesh.mesh.faces.empty())
        throw InputError(path.string() + ": has no faces; a mesh has at least one triangle");
    merge_and_count(parsed_mesh.mesh, describe_face, settings.stop);
    if (parsed_mesh.mesh.faces.empty())
        throw InputError(path.string() + ": none of its faces has an area; " + parsed_mesh.mesh.first_removed_face +
                         " is the first");
    return std::move(parsed_mesh.mesh);
}

}  // namespace lostbits::scene::triangle
