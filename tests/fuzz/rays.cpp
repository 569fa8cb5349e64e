#include "fuzz/fuzz.hpp"
#include "scene/dump/dump.hpp"

namespace lostbits::fuzz {

/// A file of rays: its first byte says in which container, and with which columns, the rest is.
void fuzz_rays(std::string_view bytes) {
    if (bytes.empty()) return;
    const unsigned kind = static_cast<unsigned char>(bytes.front());
    const std::filesystem::path path = file_of(bytes.substr(1));
    using scene::dump::Container;
    scene::dump::DumpOptions options;
    options.container = std::array{Container::csv, Container::npy, Container::raw}[kind % 3];
    if (options.container == Container::raw || (kind & 64) != 0)
        options.columns = (kind & 8) != 0 ? "ox:f32,oy,oz,dx,dy,dz,t:f64,hit:u8" : "ox:f64,oy,oz,dx,dy,dz,t";
    if ((kind & 16) != 0) options.skip = kind >> 5;
    if ((kind & 32) != 0) options.solid = Shape::sphere;
    options.keep = (kind & 128) != 0;
    answer_or_error([&] {
        const auto dump = scene::dump::open_dump(path, options);
        scene::dump::Records records;
        while (dump->next(97, records)) static_cast<void>(dump->decode(records));
    });
}

}  // namespace lostbits::fuzz
