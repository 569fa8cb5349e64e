// A file of rays, solids and answers, whatever it is kept in: read in pieces, so that memory does not grow with it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "intersect/process/stop_token.hpp"
#include "scene/dump/chunk.hpp"

namespace lostbits::scene::dump {

/// What a file of rays is kept in: by its ending, `.csv` or `.npy`, anything else being raw numbers.
enum class Container { by_name, csv, npy, raw };

/// What the command line says of a file.
struct DumpOptions {
    Container container = Container::by_name;
    /// Names, and for raw numbers types: `ox:f32,oy,oz`, a column without a type having that of the one before it. Of
    /// a CSV: it has no header, and these are its columns. Of an array: the names of its last axis.
    std::string columns = {};
    std::uint64_t skip = 0;                       ///< bytes in front of raw numbers
    std::optional<Format> format = std::nullopt;  ///< of the answers; the file's own where absent
    std::optional<MissRule> miss = std::nullopt;
    std::optional<Shape> solid = std::nullopt;  ///< of the solids that are given once
    OpenEnds open = {};                         ///< of the ranges of all rays
    intersect::process::StopToken stop = {};    ///< asked before each piece is read
    bool keep = false;                          ///< the user's own columns are wanted
};

/// Consecutive records as the file has them.
struct Records {
    std::uint64_t first = 0;  ///< the place of the first, from 0
    std::size_t count = 0;
    std::uint64_t line = 0;  ///< of text: the line of the first, from 1
    std::size_t file = 0;    ///< of several that are read as one
    std::string bytes;
};

/// A number of a file as a format has it: rounded once. What is not finite stays.
double number_in(double x, const Format& format);

/// One file. Everything it throws is an InputError that names the file and the place, or an EnvironmentError.
class Dump {
public:
    virtual ~Dump() = default;

    [[nodiscard]] const std::string& name() const { return name_; }
    [[nodiscard]] virtual const Layout& layout() const = 0;
    /// Of the answers: every number is rounded once to it.
    [[nodiscard]] const Format& format() const { return terms_.format; }
    /// How many records the file has, where it says so before it is read.
    [[nodiscard]] virtual std::optional<std::uint64_t> size() const { return {}; }
    /// Columns and rows of the picture whose pixels the records are, where the file is shaped like one.
    [[nodiscard]] virtual std::optional<std::pair<int, int>> picture() const { return {}; }
    /// Of the whole file; 0 where nobody knows.
    [[nodiscard]] virtual std::uint64_t bytes() const = 0;

    /// The next records, so many or up to the last; false where there are none left. One thread at a time.
    virtual bool next(std::size_t most, Records& records) = 0;
    /// The numbers of records. For several threads at once.
    [[nodiscard]] virtual Chunk decode(const Records& records) const = 0;
    /// Puts one solid, whose numbers are of the format, under the matrix of each record, of a file with matrices and no
    /// solids; before any record is read.
    virtual void put_under_matrices(const Solid<double>& solid) { terms_.under = solid; }
    /// Says how many primitives the rays are aimed at, beyond which no record may name one; before any is read.
    virtual void number_primitives(std::size_t count) { terms_.primitives = count; }

protected:
    explicit Dump(const std::filesystem::path& path) : name_(path.string()) {}
    Dump(std::string name, DumpTerms terms) : name_(std::move(name)), terms_(std::move(terms)) {}
    /// Ends the reading of the header: `own` is the format of the file's numbers. InputError where options say what
    /// the file says already, or neither says it.
    void settle(const DumpOptions& options, const Layout& layout, const Format& own);
    [[nodiscard]] const DumpTerms& terms() const { return terms_; }

private:
    std::string name_;
    DumpTerms terms_ = {};
};

/// Opens a file and reads what stands in front of its records.
std::unique_ptr<Dump> open_dump(const std::filesystem::path& path, const DumpOptions& options);

/// Several as one, in their order, at least one; the pictures that they may be are forgotten. InputError where not all
/// have solids, answers and a format alike.
std::unique_ptr<Dump> join_dumps(std::vector<std::unique_ptr<Dump>> files);

}  // namespace lostbits::scene::dump
