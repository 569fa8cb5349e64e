// Blocks of records from a ray file, rounded to the format in which they are measured.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scene/dump/layout.hpp"
#include "scene/rays/rays.hpp"

namespace lostbits::scene::dump {

/// The meaning of t if no column says that the ray hits. NaN, infinities and empty cells are always misses.
struct MissRule {
    enum class Kind {
        refuse_negative,  ///< a negative t is refused: it may be a hit or a miss
        never,            ///< every finite t is a hit
        negative,         ///< a t below 0 is a miss
        number            ///< this number is a miss
    };
    Kind kind = Kind::refuse_negative;
    double number = 0;
};

/// Settings for reading the records of a file.
struct ReadSettings {
    Format format;                        ///< the format of the answers; every number is rounded once to it
    MissRule miss = {};                   ///< used if there is no column `hit`
    std::optional<Shape> primitive = {};  ///< the shape of the primitives that are given once for all rays
    bool keep = false;                    ///< keep the user's own columns
    OpenEnds open = {};                   ///< for the ranges of all rays
    /// The one primitive for all rays that the matrix of each record is applied to. Absent if records have no matrices,
    /// or have primitives of their own.
    std::optional<Primitive<double>> under_matrix = {};
    /// The number of primitives for all rays; absent: unknown.
    std::optional<std::size_t> primitives = {};
};

/// A block of records from a ray file, rounded to the format.
struct Chunk {
    std::uint64_t first = 0;  ///< position of the first record in the file, from 0
    /// The file and the place of the first hit_index, for a fault that shows only in the next block; empty without one.
    std::string first_place = {};
    rays::RayBlock rays = {};
    std::vector<Primitive<double>> primitives = {};  ///< one per ray; empty if records have no primitives
    std::vector<double> t = {};                      ///< NaN if a hit has no number, 0 for misses
    std::vector<std::uint8_t> hit = {};              ///< empty if the file has no answers
    std::vector<std::int32_t> object = {};           ///< the primitive that was hit; empty if the file does not say
    /// The hit_index (−1: the ray has no hit), crossings, parity or inside of each record; empty for other answers.
    std::vector<std::int32_t> counts = {};
    std::vector<std::string> kept = {};  ///< the user's own columns, record by record, if they are kept
    std::uint64_t rounded = 0;           ///< count of numbers that were rounded, since the format lacks them
    int digits = 0;                      ///< largest number of decimal digits of a number, see `NumberParser::Parsed`
    std::uint64_t decimals = 0;          ///< count of numbers that are written with decimal digits

    [[nodiscard]] std::size_t size() const { return rays.size(); }
};

/// Takes the numbers of one record after another, and checks that each is a ray, a primitive and an answer.
class ChunkWriter {
public:
    ChunkWriter(const Layout& layout, const ReadSettings& terms, std::size_t records, Chunk& chunk);

    /// Stores a number of this record, already rounded to the format; `representable` is false if rounding changed it.
    /// A cell without a stored number is empty.
    void put(std::size_t slot, double value, bool representable, int digits = 0) {
        numbers_[slot] = value;
        present_ |= std::uint64_t{1} << slot;
        chunk_.rounded += representable ? 0 : 1;
        chunk_.digits = std::max(chunk_.digits, digits);
        chunk_.decimals += digits > 0 ? 1 : 0;
    }
    /// Ends the record. Throws InputError with `place(slot)` in front if it is not a ray, a primitive or an answer.
    template <class Place>
    void end_record(const Place& place) {
        if (const auto fault = find_fault()) fail(place(fault->slot), fault->why);
        if (answers_ == AnswerKind::all_hits && chunk_.size() == 0) chunk_.first_place = place(slot::hit_index);
        keep();
    }

private:
    struct Fault {
        std::size_t slot;
        std::string why;
    };
    [[nodiscard]] std::optional<Fault> find_fault();
    [[nodiscard]] std::optional<Fault> find_fault_of_answer();
    [[nodiscard]] std::optional<Fault> find_fault_of_count();
    [[nodiscard]] std::optional<Fault> find_fault_of_hit_index();
    [[noreturn]] static void fail(const std::string& place, const std::string& why);
    [[nodiscard]] Primitive<double> primitive() const;  ///< of this record
    [[nodiscard]] Range<double> range() const;          ///< of this record's ray
    void keep();
    [[nodiscard]] bool is_present(std::size_t slot) const { return (present_ >> slot & 1) != 0; }
    [[nodiscard]] std::string slot_name(std::size_t slot) const;

    const Layout& layout_;
    const ReadSettings& terms_;
    Chunk& chunk_;
    AnswerKind answers_;
    double numbers_[slot::count] = {};
    std::uint64_t present_ = 0;
    std::optional<Shape> shape_;  ///< shape of each record's own primitive, or of the one that its matrix applies to
    bool decides_ = false;        ///< records have answers
    bool hits_ = false;           ///< the answer of this record is a hit
};

}  // namespace lostbits::scene::dump
