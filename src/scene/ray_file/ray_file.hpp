// Reads a file of rays, primitives and answers in any container, in pieces, so that memory does not grow with the file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "intersect/process/stop_token.hpp"
#include "scene/ray_file/chunk.hpp"

namespace lostbits::scene::ray_file {

/// The container of a file of rays. `by_name` uses the ending: `.csv`, `.npy`, or raw numbers for any other.
enum class Container { by_name, csv, npy, raw };

/// The command line's options for a file.
struct ReadOptions {
    Container container = Container::by_name;
    /// Names of the columns, and types for raw numbers: `ox:f32,oy,oz`. A column without a type has the type of the
    /// column before it. For a CSV: the names of its columns, since it has no header. For an array: the names of its
    /// last axis.
    std::string columns = {};
    std::uint64_t skip = 0;                       ///< bytes in front of raw numbers
    std::optional<Format> format = std::nullopt;  ///< format of the answers; absent: the file's own format
    std::optional<MissRule> miss = std::nullopt;
    std::optional<Shape> primitive = std::nullopt;  ///< shape of the primitives that are given once for all rays
    OpenEnds open_ends = {};                        ///< for the ranges of all rays
    intersect::process::StopToken stop = {};        ///< checked before each piece is read
    bool keeps_own_columns = false;                 ///< true: the user's own columns are stored
};

/// Consecutive records as they are in the file.
struct Records {
    std::uint64_t first = 0;  ///< index of the first record, from 0
    std::size_t count = 0;
    std::uint64_t line = 0;  ///< for text: number of the first record's line, from 1
    std::size_t file = 0;    ///< index of the file, if several are read as one
    std::string bytes;
};

/// Rounds a number of a file once to a format. Infinities and NaN stay as they are.
double number_in(double x, const Format& format);

/// A file of rays. Throws only InputErrors, which name the file and the position, and EnvironmentErrors.
class RayFile {
public:
    virtual ~RayFile() = default;

    [[nodiscard]] const std::string& name() const { return name_; }
    [[nodiscard]] virtual const Layout& layout() const = 0;
    /// The format of the answers; every number is rounded once to it.
    [[nodiscard]] const Format& format() const { return settings_.format; }
    /// Number of records, if it is known before the records are read.
    [[nodiscard]] virtual std::optional<std::uint64_t> size() const { return {}; }
    /// Columns and rows of the picture whose pixels the records are, if the file has that shape.
    [[nodiscard]] virtual std::optional<std::pair<int, int>> picture() const { return {}; }
    /// Size of the whole file; 0 if unknown.
    [[nodiscard]] virtual std::uint64_t bytes() const = 0;

    /// Reads the next records, at most `max_records`. Returns false if no records are left. Only one thread may call
    /// this at a time.
    virtual bool next(std::size_t max_records, Records& records) = 0;
    /// Decodes the numbers of records. Several threads may call this at once.
    [[nodiscard]] virtual Chunk decode(const Records& records) const = 0;
    /// Transforms one primitive by the matrix of each record, for a file with matrices and no primitives. The numbers
    /// of the primitive must be numbers of the format. Call this before any record is read.
    virtual void transform_by_records(const Primitive<double>& primitive) {
        settings_.transformed_primitive = primitive;
    }
    /// Sets the number of primitives at which the rays are aimed. No record may have an index beyond them. Call this
    /// before any record is read.
    virtual void number_primitives(std::size_t count) { settings_.primitives = count; }

protected:
    explicit RayFile(const std::filesystem::path& path) : name_(path.string()) {}
    RayFile(std::string name, ReadSettings settings) : name_(std::move(name)), settings_(std::move(settings)) {}
    /// Ends the reading of the header. `file_format` is the format of the file's numbers. Throws InputError if the
    /// options and the file both give the primitives or the rule for misses, or if neither gives primitives.
    void finish_header(const ReadOptions& options, const Layout& layout, const Format& file_format);
    [[nodiscard]] const ReadSettings& settings() const { return settings_; }

private:
    std::string name_;
    ReadSettings settings_ = {};
};

/// Opens a file and reads everything before its records.
std::unique_ptr<RayFile> open_ray_file(const std::filesystem::path& path, const ReadOptions& options);

/// Joins one or more files into one, in their order. Several joined files are not a picture. Throws InputError unless
/// all files have the same kinds of primitives and answers and the same format.
std::unique_ptr<RayFile> join_ray_files(std::vector<std::unique_ptr<RayFile>> files);

}  // namespace lostbits::scene::ray_file
