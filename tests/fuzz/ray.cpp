#include "analysis/selection/ray_numbers.hpp"
#include "fuzz/fuzz.hpp"

namespace lostbits::fuzz {

/// `--ray`, `--sphere`, `--pixel` and `--as`: a line each.
void fuzz_ray(std::string_view bytes) {
    using namespace analysis::selection;
    std::array<std::string, 4> lines;
    for (std::string& line : lines) {
        const std::size_t end = std::min(bytes.find('\n'), bytes.size());
        line = bytes.substr(0, end);
        bytes.remove_prefix(std::min(end + 1, bytes.size()));
    }
    const std::optional<Format> as = find_format(lines[3]);
    answer_or_error([&] { static_cast<void>(numbers_of(lines[0], {"--ray", "a ray", 6, as.has_value()}, as)); });
    answer_or_error([&] { static_cast<void>(numbers_of(lines[1], {"--sphere", "a sphere", 4}, as)); });
    answer_or_error([&] { static_cast<void>(pixel_named(lines[2])); });
}

}  // namespace lostbits::fuzz
