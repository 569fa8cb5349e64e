#include "number/format.hpp"

#include <charconv>

namespace lostbits {

std::optional<Format> find_format(std::string_view name) {
    using Engine = Format::Engine;
    if (name == "f32") return Format{"f32", binary32, Engine::native32};
    if (name == "f64") return Format{"f64", binary64, Engine::native64};
    if (name == "fp16") return Format{"fp16", binary16, Engine::rounded};
    if (name == "bf16") return Format{"bf16", bfloat16, Engine::rounded};
    if (name == "tf32") return Format{"tf32", tensor_float32, Engine::rounded};
    if (name.size() < 2 || name.front() != 'p' || name[1] == '0') return std::nullopt;
    int precision = 0;
    const auto [end, error] = std::from_chars(name.data() + 1, name.data() + name.size(), precision);
    if (error != std::errc{} || end != name.data() + name.size()) return std::nullopt;
    if (precision < 2 || precision > binary64.precision) return std::nullopt;
    return Format{std::string(name), {precision, binary64.emin, binary64.emax}, Engine::rounded};
}

}  // namespace lostbits
