#include "fuzz/fuzz.hpp"
#include "scene/file/scene.hpp"
#include "scene/toml/did_you_mean.hpp"
#include "scene/toml/parse_number.hpp"
#include "scene/toml/toml_tree.hpp"

namespace lostbits::fuzz {

/// Words of the command line, a line each: a number of `--ray` as it is, and a change of `--set` to a scene.
void fuzz_words(std::string_view bytes) {
    static const scene::file::SceneFile file(LOSTBITS_DATA_DIR "/scenes/near-benign.toml");
    scene::file::LoadOptions options{.size = std::pair{2, 2}};
    for (std::size_t from = 0; from < bytes.size() && options.overrides.size() < 16;) {
        const std::size_t end = std::min(bytes.find('\n', from), bytes.size());
        const std::string line(bytes.substr(from, end - from));
        from = end + 1;
        static_cast<void>(scene::toml::parse_number(line));
        static_cast<void>(scene::toml::did_you_mean(line.substr(0, 64), {"sphere", "camera"}));
        answer_or_error([&] { options.overrides.push_back(scene::toml::parse_override(line)); });
    }
    answer_or_error([&] { static_cast<void>(file.load(options)); });
}

}  // namespace lostbits::fuzz
