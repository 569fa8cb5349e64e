#include "fuzz/fuzz.hpp"
#include "intersect/shader/compiler_log.hpp"
#include "intersect/shader/kernel.hpp"

namespace lostbits::fuzz {

/// A file of GLSL: its first line is what stands behind the colon of `--shader`. Of one that is taken the programs are
/// made, and its own lines are read as the log of a compiler.
void fuzz_shader(std::string_view bytes) {
    using namespace intersect::shader;
    const std::size_t end = std::min(bytes.find('\n'), bytes.size());
    std::string words(bytes.substr(0, end));
    std::erase(words, '\0');  // no word of a command line has one
    const std::filesystem::path path = file_of(bytes.substr(std::min(end + 1, bytes.size())));
    answer_or_error([&] {
        const ShaderSource shader = read_shader(path.string() + ":" + words);
        for (const int bits : {32, 64}) static_cast<void>(program_text(shader, bits, 450));
        static_cast<void>(errors_of(shader.text, shader));
    });
}

}  // namespace lostbits::fuzz
