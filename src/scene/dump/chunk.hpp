// Some records of a file of rays, as the numbers that the measuring takes.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scene/dump/layout.hpp"
#include "scene/rays/rays.hpp"

namespace lostbits::scene::dump {

/// What a t means where no column says whether the ray hits. NaN, infinities and empty cells are misses in any case.
struct MissRule {
    enum class Kind {
        ask,       ///< a negative t is refused: it may be either
        never,     ///< every finite t is a hit
        negative,  ///< a t below 0 is a miss
        number     ///< this number is a miss
    };
    Kind kind = Kind::ask;
    double number = 0;
};

/// How the records of a file are to be read.
struct DumpTerms {
    Format format;                    ///< of the answers: every number is rounded once to it
    MissRule miss = {};               ///< where no column is `hit`
    std::optional<Shape> solid = {};  ///< of the solids given once for all rays
    bool keep = false;                ///< the user's own columns are wanted
    OpenEnds open = {};               ///< of the ranges of all rays
    /// The one solid that stands under the matrix of each record, where these have matrices and no solids.
    std::optional<Solid<double>> under = {};
    /// So many primitives are there for all rays; absent: nobody says so.
    std::optional<std::size_t> primitives = {};
};

struct Chunk {
    std::uint64_t first = 0;  ///< the place of the first record in the file, from 0
    rays::RayBlock rays = {};
    std::vector<Solid<double>> solids = {};  ///< one a ray; empty where records have none
    std::vector<double> t = {};              ///< NaN where a hit has none that is a number, 0 of misses
    std::vector<std::uint8_t> hit = {};      ///< empty where the file has no answers
    std::vector<std::int32_t> object = {};   ///< the solid that was hit; empty where the file does not say
    std::vector<std::string> kept = {};      ///< the user's own columns, record by record, where they are wanted
    std::uint64_t rounded = 0;               ///< numbers that the format does not hold
    int digits = 0;                          ///< the most that a number has, see `NumberWords::Word`
    std::uint64_t decimals = 0;              ///< numbers that have some

    [[nodiscard]] std::size_t size() const { return rays.size(); }
};

/// Takes the numbers of one record after another, and holds each to what a ray, a solid and an answer must be.
class ChunkWriter {
public:
    ChunkWriter(const Layout& layout, const DumpTerms& terms, std::size_t records, Chunk& chunk);

    /// A number of this record, as the format holds it; where none is put, the cell is empty.
    void put(std::size_t slot, double value, bool held, int digits = 0) {
        numbers_[slot] = value;
        there_ |= std::uint64_t{1} << slot;
        chunk_.rounded += held ? 0 : 1;
        chunk_.digits = std::max(chunk_.digits, digits);
        chunk_.decimals += digits > 0 ? 1 : 0;
    }
    /// Ends the record. Throws InputError, with `place(slot)` in front, for what is no ray, no solid or no answer.
    template <class Place>
    void end_record(const Place& place) {
        if (const auto fault = find_fault()) fail(place(fault->slot), fault->why);
        keep();
    }

private:
    struct Fault {
        std::size_t slot;
        std::string why;
    };
    [[nodiscard]] std::optional<Fault> find_fault();
    [[nodiscard]] std::optional<Fault> find_fault_of_answer();
    [[noreturn]] static void fail(const std::string& place, const std::string& why);
    [[nodiscard]] Solid<double> solid() const;  ///< of this record
    [[nodiscard]] Range<double> range() const;  ///< of its ray
    void keep();
    [[nodiscard]] bool is_there(std::size_t slot) const { return (there_ >> slot & 1) != 0; }
    [[nodiscard]] std::string called(std::size_t slot) const;

    const Layout& layout_;
    const DumpTerms& terms_;
    Chunk& chunk_;
    double numbers_[slot::count] = {};
    std::uint64_t there_ = 0;
    std::optional<Shape> shape_;  ///< of the solid that each record has, or that stands under its matrix
    bool decides_ = false;        ///< records have answers
    bool hits_ = false;           ///< this record's
};

}  // namespace lostbits::scene::dump
