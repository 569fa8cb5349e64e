#include "scene/file/scene.hpp"

#include "fuzz/fuzz.hpp"

namespace lostbits::fuzz {

void fuzz_scene(std::string_view bytes) {
    const std::filesystem::path path = file_of(bytes);
    answer_or_error([&] {
        const scene::file::SceneFile file(path);
        for (const scene::file::Scene& scene : file.load({.size = std::pair{4, 3}})) {
            if (scene.solid_count() > 1000) continue;
            static_cast<void>(scene.solids());
            static_cast<void>(scene.shapes());
        }
        static_cast<void>(file.load());
    });
}

}  // namespace lostbits::fuzz
