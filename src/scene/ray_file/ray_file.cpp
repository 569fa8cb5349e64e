#include "scene/ray_file/ray_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "number/error.hpp"
#include "number/rounded.hpp"
#include "scene/ray_file/binary_ray_file.hpp"
#include "scene/ray_file/csv_ray_file.hpp"
#include "shapes/number_names.hpp"

namespace lostbits::scene::ray_file {

double number_in(double x, const Format& format) {
    if (!std::isfinite(x)) return x;
    switch (format.engine) {
        case Format::Engine::native32: return static_cast<float>(x);
        case Format::Engine::native64: return x;
        case Format::Engine::rounded: break;
    }
    return rounding::to_format(x, 0, format.parameters);
}

void RayFile::finish_header(const ReadOptions& options, const Layout& layout, const Format& file_format) {
    settings_.format = options.format.value_or(file_format);
    settings_.keeps_own_columns = options.keeps_own_columns;
    settings_.primitive = options.primitive;
    settings_.open_ends = options.open_ends;

    // Primitives come from the file or from the command line, not from both.
    const std::string& file = name_;
    if (layout.primitive_shape() && options.primitive)
        throw InputError(file +
                         ": its columns have a primitive for each ray, but the command line gives one for all; leave "
                         "one of the two out");
    if (!layout.primitive_shape() && !options.primitive)
        throw InputError(file +
                         ": no primitive: give one for all rays (--sphere CX,CY,CZ,R or --scene SCENE), or columns "
                         "(cx,cy,cz,radius); other shapes: `lostbits judge --help`");

    // The rule for misses is for files whose t alone decides.
    if (!options.miss) return;
    if (layout.has(slot::hit) || !layout.has(slot::t))
        throw InputError(file +
                         (layout.has(slot::hit)
                              ? ": --miss says which t is a miss, but the column hit already says so; leave --miss out"
                              : ": --miss says which t is a miss, but the file has no column t; leave --miss out"));
    settings_.miss = *options.miss;
    // The number that means a miss is rounded in the same way as the numbers of the file.
    settings_.miss.number = rounding::to_format(settings_.miss.number, 0, settings_.format.parameters);
}

std::unique_ptr<RayFile> open_ray_file(const std::filesystem::path& path, const ReadOptions& options) {
    Container container = options.container;
    if (container == Container::by_name) {
        std::string ending = path.extension().string();
        std::ranges::transform(ending, ending.begin(),
                               [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        container = ending == ".csv" ? Container::csv : ending == ".npy" ? Container::npy : Container::raw;
        if (container == Container::raw && options.columns.empty())
            throw InputError(
                path.string() +
                ": is not a known kind of file; use .csv or .npy, --columns ox:f32,oy,oz,dx,dy,dz,hit:u8,t:f32 for "
                "raw numbers, or --container csv");
    }
    if (options.skip > 0 && container != Container::raw)
        throw InputError(path.string() + ": --skip is only for bytes in front of raw numbers; leave out --skip");
    switch (container) {
        case Container::csv: return std::make_unique<CsvRayFile>(path, options);
        case Container::npy: return std::make_unique<BinaryRayFile>(path, options, read_npy_layout);
        default: return std::make_unique<BinaryRayFile>(path, options, read_raw_layout);
    }
}

namespace {

std::string names_of(const std::vector<std::unique_ptr<RayFile>>& files) {
    std::string names;
    for (const auto& file : files) names += (names.empty() ? "" : ", ") + file->name();
    return names;
}

/// True if both files have the same kinds of primitives and answers and the same format.
bool are_alike(const RayFile& a, const RayFile& b) {
    return a.layout().primitive_shape() == b.layout().primitive_shape() &&
           a.layout().has_matrix() == b.layout().has_matrix() &&
           a.layout().has_first_hits() == b.layout().has_first_hits() &&
           a.layout().has_only_decisions() == b.layout().has_only_decisions() && a.format() == b.format();
}

class JoinedRayFile final : public RayFile {
public:
    explicit JoinedRayFile(std::vector<std::unique_ptr<RayFile>> files)
        : RayFile(names_of(files), {.format = files.front()->format()}),
          files_(std::move(files)),
          first_records_(files_.size()) {
        for (const auto& file : files_) {
            if (!are_alike(*files_.front(), *file))
                throw InputError(
                    file->name() + ": its columns or its format differ from those of " + files_.front()->name() +
                    "; files that are read together all have primitives or none, answers or none, and the same "
                    "format; try each alone");
        }
    }

    [[nodiscard]] const Layout& layout() const override { return files_.front()->layout(); }
    [[nodiscard]] std::uint64_t bytes() const override {
        std::uint64_t sum = 0;
        for (const auto& file : files_) {
            if (file->bytes() == 0) return 0;
            sum += file->bytes();
        }
        return sum;
    }

    bool next(std::size_t max_records, Records& records) override {
        for (; file_index_ < files_.size(); ++file_index_) {
            if (files_[file_index_]->next(max_records, records)) {
                records.file = file_index_;
                record_count_ += records.count;
                return true;
            }
            if (record_count_ == first_records_[file_index_])
                throw InputError(files_[file_index_]->name() +
                                 ": has no rays; write a record for each after the header");
            if (file_index_ + 1 < files_.size()) first_records_[file_index_ + 1] = record_count_;
        }
        return false;
    }

    void transform_by_records(const Primitive<double>& primitive) override {
        for (const auto& file : files_) file->transform_by_records(primitive);
    }
    void number_primitives(std::size_t count) override {
        for (const auto& file : files_) file->number_primitives(count);
    }
    [[nodiscard]] Chunk decode(const Records& records) const override {
        Chunk chunk = files_[records.file]->decode(records);
        chunk.first += first_records_[records.file];
        return chunk;
    }

private:
    std::vector<std::unique_ptr<RayFile>> files_;
    std::vector<std::uint64_t> first_records_;  ///< rays before each file; set before its records are read
    std::size_t file_index_ = 0;
    std::uint64_t record_count_ = 0;
};

}  // namespace

std::unique_ptr<RayFile> join_ray_files(std::vector<std::unique_ptr<RayFile>> files) {
    if (files.size() == 1) return std::move(files.front());
    return std::make_unique<JoinedRayFile>(std::move(files));
}

}  // namespace lostbits::scene::ray_file
