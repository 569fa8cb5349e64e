// Files from text, and the text of an error, for the tests of scenes.
#pragma once

#include <filesystem>
#include <string>

#include "catch.hpp"
#include "number/error.hpp"
#include "number/real.hpp"
#include "scene/file/scene.hpp"
#include "scene/toml/parse_number.hpp"
#include "scratch.hpp"

/// A failure prints numbers that paste straight back into a scene.
template <>
struct Catch::StringMaker<lostbits::Real> {
    static std::string convert(const lostbits::Real& x) { return lostbits::scene::toml::exact_text(x); }
};

namespace lostbits::scene::test {

namespace fs = std::filesystem;

using lostbits::test::Scratch;

/// The message of the InputError that `work` throws; "no error" if it throws nothing, and "another error: …" for other
/// exceptions.
template <class Work>
std::string error_of(Work work) {
    try {
        work();
    } catch (const InputError& error) {
        return error.what();
    } catch (const std::exception& error) {
        return std::string("another error: ") + error.what();
    }
    return "no error";
}

/// The same without the folder: `scene.toml:3:8: …`.
template <class Work>
std::string error_in(const Scratch& folder, Work work) {
    std::string text = error_of(work);
    const std::string prefix = folder.path().string() + '/';
    if (text.starts_with(prefix)) text.erase(0, prefix.size());
    return text;
}

inline bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

inline Real real(const std::string& text) { return std::get<Real>(scene::toml::parse_number(text)); }

inline std::string replace_text(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    if (at == std::string::npos) throw std::logic_error("the test replaces what is not there: " + from);
    return text.replace(at, from.size(), to);
}

/// Reads `text` as a file of that name; `error_as` returns the message of the error.
template <class File, class... More>
File read_as(const std::string& name, const std::string& text, const More&... more) {
    const Scratch folder;
    return File(folder.write(name, text), more...);
}
template <class File, class... More>
std::string error_as(const std::string& name, const std::string& text, const More&... more) {
    const Scratch folder;
    const fs::path file = folder.write(name, text);
    return error_in(folder, [&] { const File unused(file, more...); });
}

/// First lines of a sweep file.
inline const std::string sweep_head = "schema = \"lostbits-sweep/1\"\ntitle = \"A test\"\nsource = \"-\"\n";

/// A scene that loads; the tests break one line of it at a time. Keep the line numbers.
inline const std::string good_scene = R"(schema = "lostbits-scene/1"
title = "A test"
source = "-"
note = "nothing"
inputs = "shared"
size = [8, 4]
[camera]
kind = "orthographic"
eye = [0, 0, 0]
look_at = [0, 0, -1]
up = [0, 1, 0]
width = 2.5
[[sphere]]
centre = [0, 0, -10]
radius = 1
)";

/// Load `text` as scene.toml in a fresh folder and return the error.
inline std::string scene_error(const std::string& text, const scene::file::LoadOptions& options = {}) {
    const Scratch folder;
    const fs::path file = folder.write("scene.toml", text);
    return error_in(folder, [&] { scene::file::load_scene(file, options); });
}

inline std::vector<scene::file::Scene> load_scenes(const std::string& text,
                                                   const scene::file::LoadOptions& options = {}) {
    const Scratch folder;
    return scene::file::load_scene(folder.write("scene.toml", text), options);
}

inline scene::file::Scene load_text(const std::string& text, const scene::file::LoadOptions& options = {}) {
    return load_scenes(text, options).at(0);
}

}  // namespace lostbits::scene::test
