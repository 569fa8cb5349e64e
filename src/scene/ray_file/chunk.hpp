// Blocks of records from a ray file, rounded to the format in which they are measured.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scene/ray_file/layout.hpp"
#include "scene/rays/rays.hpp"

namespace lostbits::scene::ray_file {

/// Rule for which t are misses if no column says whether the ray hits. NaN, infinities and empty cells are always
/// misses.
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
    std::optional<Shape> primitive = {};  ///< shape of the primitives that are given once for all rays
    bool keeps_own_columns = false;       ///< true: the user's own columns are stored
    OpenEnds open_ends = {};              ///< for the ranges of all rays
    /// The primitive for all rays, to which the matrix of each record is applied. Absent if records have no matrices,
    /// or have primitives of their own.
    std::optional<Primitive<double>> transformed_primitive = {};
    /// Number of the primitives that are given once for all rays; absent: unknown.
    std::optional<std::size_t> primitives = {};
};

/// A block of records from a ray file, rounded to the format.
struct Chunk {
    std::uint64_t first = 0;  ///< index of the first record in the file, from 0
    /// The file and the position of the first hit_index, for a fault that shows only in the next block; empty without a
    /// hit_index.
    std::string first_place = {};
    rays::RayBlock rays = {};
    std::vector<Primitive<double>> primitives = {};  ///< one per ray; empty if records have no primitives
    std::vector<double> t = {};                      ///< NaN if a hit has no number, 0 for misses
    std::vector<std::uint8_t> hit = {};              ///< empty if the file has no answers
    std::vector<std::int32_t> object = {};  ///< index of the primitive that was hit; empty if the file does not say
    /// The hit_index (−1: the ray has no hit), crossings, parity or inside of each record; empty for other answers.
    std::vector<std::int32_t> counts = {};
    std::vector<std::string> kept = {};  ///< the user's own columns, record by record, if they are stored
    std::uint64_t rounded_count = 0;     ///< count of numbers that were rounded, since the format does not have them
    int digits = 0;              ///< largest number of decimal digits of a number, see `NumberParser::ParsedNumber`
    std::uint64_t decimals = 0;  ///< count of numbers that are written with decimal digits

    [[nodiscard]] std::size_t size() const { return rays.size(); }
};

/// Takes the numbers of one record after another, and checks that each record has a valid ray, primitive and answer.
class ChunkWriter {
public:
    ChunkWriter(const Layout& layout, const ReadSettings& settings, std::size_t record_count, Chunk& chunk);

    /// Stores a number of this record, already rounded to the format; `is_representable` is false if rounding changed
    /// it. A number that is not stored is an empty cell.
    void put(std::size_t slot, double value, bool is_representable, int digits = 0) {
        numbers_[slot] = value;
        present_ |= std::uint64_t{1} << slot;
        chunk_.rounded_count += is_representable ? 0 : 1;
        chunk_.digits = std::max(chunk_.digits, digits);
        chunk_.decimals += digits > 0 ? 1 : 0;
    }
    /// Ends the record. Throws InputError with `place(slot)` in front if its ray, primitive or answer is not valid.
    template <class Place>
    void end_record(const Place& place) {
        if (const auto fault = find_fault()) fail(place(fault->slot), fault->why);
        if (answers_ == AnswerKind::all_hits && chunk_.size() == 0) chunk_.first_place = place(slot::hit_index);
        store_record();
    }

private:
    struct RecordFault {
        std::size_t slot;
        std::string why;
    };
    /// Finds the first fault of the record, if it has one. The functions below each look at one part of it.
    [[nodiscard]] std::optional<RecordFault> find_fault();
    [[nodiscard]] std::optional<RecordFault> find_fault_of_ray() const;
    [[nodiscard]] std::optional<RecordFault> find_fault_of_range() const;
    [[nodiscard]] std::optional<RecordFault> find_fault_of_primitive() const;
    [[nodiscard]] std::optional<RecordFault> find_fault_of_limits() const;
    [[nodiscard]] std::optional<RecordFault> find_fault_of_matrix() const;
    [[nodiscard]] std::optional<RecordFault> find_fault_of_object() const;
    [[nodiscard]] std::optional<RecordFault> find_fault_of_answer();
    [[nodiscard]] std::optional<RecordFault> find_fault_of_count();
    [[nodiscard]] std::optional<RecordFault> find_fault_of_hit_index();
    /// A fault of one number: its name and its value, then `why`.
    [[nodiscard]] RecordFault fault_at(std::size_t slot, std::string_view why) const;
    [[noreturn]] static void fail(const std::string& message_prefix, const std::string& why);
    [[nodiscard]] Primitive<double> primitive() const;  ///< of this record
    [[nodiscard]] Range<double> range() const;          ///< of this record's ray
    void store_record();
    [[nodiscard]] bool is_present(std::size_t slot) const { return (present_ >> slot & 1) != 0; }
    [[nodiscard]] std::string slot_name(std::size_t slot) const;

    const Layout& layout_;
    const ReadSettings& settings_;
    Chunk& chunk_;
    AnswerKind answers_;
    double numbers_[slot::count] = {};
    std::uint64_t present_ = 0;
    /// Shape of each record's own primitive, or of the primitive to which its matrix is applied.
    std::optional<Shape> shape_;
    bool has_answers_ = false;  ///< true if records have answers
    bool is_hit_ = false;       ///< true if the answer of this record is a hit
};

}  // namespace lostbits::scene::ray_file
