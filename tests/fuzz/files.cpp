// Readers of files and of words of the command line.
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <regex>

#include "analysis/selection/ray_numbers.hpp"
#include "fuzz/fuzz.hpp"
#include "output/file/read_csv.hpp"
#include "scene/check/claims_file.hpp"
#include "scene/check/report_file.hpp"
#include "scene/file/scene.hpp"
#include "scene/ray_file/ray_file.hpp"
#include "scene/sweep/case_file.hpp"
#include "scene/sweep/exhaustive_file.hpp"
#include "scene/sweep/search_file.hpp"
#include "scene/sweep/sweep_file.hpp"
#include "scene/toml/parse_number.hpp"
#include "scene/toml/toml_tree.hpp"
#include "shapes/triangle/mesh/mesh_file.hpp"
#include "text/did_you_mean.hpp"

namespace lostbits::fuzz {

namespace {

/// A folder of links to the file in memory, with names that end as a reader requires.
class LinkTree {
public:
    explicit LinkTree(std::string file) : file_(std::move(file)) {
        std::string name = (std::filesystem::temp_directory_path() / "lostbits-fuzz-XXXXXX").string();
        if (!mkdtemp(name.data())) throw std::runtime_error("no folder for the names of files in memory");
        folder_ = name;
    }
    ~LinkTree() {
        std::error_code ignored;
        std::filesystem::remove_all(folder_, ignored);
    }
    LinkTree(const LinkTree&) = delete;
    LinkTree& operator=(const LinkTree&) = delete;
    [[nodiscard]] std::filesystem::path ending_in(std::string_view extension) const {
        const std::filesystem::path link = folder_ / ("input" + std::string(extension));
        if (!std::filesystem::is_symlink(link)) std::filesystem::create_symlink(file_, link);
        return link;
    }

private:
    std::string file_;
    std::filesystem::path folder_;
};

}  // namespace

std::filesystem::path file_of(std::string_view bytes, std::string_view extension) {
    // Not under number 3, which is the memory that a request to serve may claim, and is closed then.
    static const int file = fcntl(memfd_create("input", 0), F_DUPFD_CLOEXEC, 64);
    if (file < 0 || ftruncate(file, 0) != 0) throw std::runtime_error("no file in memory");
    for (std::size_t done = 0; done < bytes.size();) {
        const ssize_t written = pwrite(file, bytes.data() + done, bytes.size() - done, static_cast<off_t>(done));
        if (written <= 0) throw std::runtime_error("the file in memory takes no more");
        done += static_cast<std::size_t>(written);
    }
    const std::string path = "/proc/self/fd/" + std::to_string(file);
    if (extension.empty()) return path;
    static const LinkTree links(path);
    return links.ending_in(extension);
}

void fuzz_scene(std::string_view bytes) {
    const std::filesystem::path path = file_of(bytes);
    answer_or_error([&] {
        const scene::file::SceneFile file(path);
        for (const scene::file::Scene& scene : file.load({.size = std::pair{4, 3}})) {
            if (scene.primitive_count() > 1000) continue;
            static_cast<void>(scene.primitives());
            static_cast<void>(scene.shapes());
        }
        static_cast<void>(file.load());
    });
}

void fuzz_sweep(std::string_view bytes) {
    using namespace scene::sweep;
    const std::filesystem::path path = file_of(bytes);
    answer_or_error([&] {
        switch (read_sweep_kind(path)) {
            case SweepKind::axes: static_cast<void>(SweepFile(path, LOSTBITS_DATA_DIR).shapes()); return;
            case SweepKind::cases: static_cast<void>(CaseFile{path}); return;
            case SweepKind::search: static_cast<void>(SearchFile{path}); return;
            case SweepKind::edge_search: static_cast<void>(EdgeSearchFile(path, LOSTBITS_DATA_DIR)); return;
            case SweepKind::every_float: break;
        }
        const ExhaustiveFile file(path, LOSTBITS_DATA_DIR);
        if (file.float_count() > 0) static_cast<void>(file.group_at(0, float_at(file.ranges().front().first)));
    });
}

void fuzz_claims(std::string_view bytes) {
    answer_or_error([&] { static_cast<void>(scene::check::read_claims(file_of(bytes))); });
}

void fuzz_report(std::string_view bytes) {
    answer_or_error([&] { static_cast<void>(scene::check::read_report_file(file_of(bytes))); });
}

/// A table, every cell of it read as a value, and each value equal to itself.
void fuzz_csv(std::string_view bytes) {
    answer_or_error([&] {
        const output::file::CsvTable table = output::file::parse_csv(std::string(bytes), "input.csv");
        for (const auto& column : table.columns) {
            for (const std::string_view cell : column.cells) {
                const output::file::CellValue value = output::file::read_cell(cell);
                if (value.kind != output::file::CellValue::Kind::number) continue;
                static_cast<void>(value.to_double());
                if (!(value == value)) throw std::logic_error("a number differs from itself");
            }
        }
    });
}

/// A file of rays: its first byte selects the container and the columns of the rest.
void fuzz_rays(std::string_view bytes) {
    if (bytes.empty()) return;
    const unsigned kind = static_cast<unsigned char>(bytes.front());
    const std::filesystem::path path = file_of(bytes.substr(1));
    using scene::ray_file::Container;
    scene::ray_file::ReadOptions options;
    options.container = std::array{Container::csv, Container::npy, Container::raw}[kind % 3];
    const bool raw = options.container == Container::raw;
    if (raw || (kind & 64) != 0)
        options.columns = (kind & 8) != 0 ? "ox:f32,oy,oz,dx,dy,dz,t:f64,hit:u8" : "ox:f64,oy,oz,dx,dy,dz,t";
    if (!raw) options.columns = std::regex_replace(options.columns, std::regex(":\\w+"), "");
    if ((kind & 16) != 0) options.skip = kind >> 5;
    if ((kind & 32) != 0) options.primitive = Shape::sphere;
    options.keeps_own_columns = (kind & 128) != 0;
    answer_or_error([&] {
        const auto ray_file = scene::ray_file::open_ray_file(path, options);
        scene::ray_file::Records records;
        while (ray_file->next(97, records)) static_cast<void>(ray_file->decode(records));
    });
}

/// A file of a mesh: the first line is the extension of its name.
void fuzz_mesh(std::string_view bytes) {
    static constexpr std::array<std::string_view, 5> extensions{".obj", ".ply", ".stl", ".gltf", ".glb"};
    const std::string extension = take_line(bytes);
    if (std::ranges::find(extensions, extension) == extensions.end()) return;
    answer_or_error([&] {
        const scene::triangle::Mesh mesh = scene::triangle::read_mesh_file(file_of(bytes, extension));
        for (const auto& face : mesh.faces)
            for (const std::size_t vertex : face)
                if (vertex >= mesh.vertices.size()) throw std::logic_error("a face of a vertex that is not there");
    });
}

/// Words of the command line, a line each: a number of `--ray` as it is, and a change of `--set` to a scene.
void fuzz_words(std::string_view bytes) {
    static const scene::file::SceneFile file(LOSTBITS_DATA_DIR "/scenes/near-benign.toml");
    scene::file::LoadOptions options{.size = std::pair{2, 2}};
    while (!bytes.empty() && options.overrides.size() < 16) {
        const std::string line = take_line(bytes);
        static_cast<void>(scene::toml::parse_number(line));
        static_cast<void>(text::did_you_mean(line.substr(0, 64), {"sphere", "camera"}));
        answer_or_error([&] { options.overrides.push_back(scene::toml::parse_override(line)); });
    }
    answer_or_error([&] { static_cast<void>(file.load(options)); });
}

/// `--ray`, `--sphere`, `--pixel` and `--as`: a line each.
void fuzz_ray(std::string_view bytes) {
    using namespace analysis::selection;
    std::array<std::string, 4> lines;
    for (std::string& line : lines) line = take_line(bytes);
    const std::optional<Format> as = find_format(lines[3]);
    answer_or_error([&] { static_cast<void>(parse_numbers(lines[0], {"--ray", "a ray", 6, as.has_value()}, as)); });
    answer_or_error([&] { static_cast<void>(parse_numbers(lines[1], {"--sphere", "a sphere", 4}, as)); });
    answer_or_error([&] { static_cast<void>(parse_pixel(lines[2])); });
}

}  // namespace lostbits::fuzz
