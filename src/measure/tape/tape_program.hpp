// Runs a tape over columns of rays: the operations recorded for one ray are performed for many, each in its format on
// the tape. A form whose operations are the same for every ray (`select` in place of `if`) is a single program.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "intersect/table/table.hpp"
#include "measure/tape/steps.hpp"
#include "number/tape.hpp"

namespace lostbits::measure::tape {

/// Formats of a node that is a pair of floats or of doubles, high and low (`number::wide::TwoWords`).
inline constexpr FloatFormat two_floats{48, -126, 127}, two_doubles{106, -1022, 1023};

/// Arithmetic of a format. Throws std::logic_error for a format without arithmetic in a program.
NodeArithmetic arithmetic_of(const FloatFormat& format);

/// A tape as a program: a list of steps in order, each an operation on columns of results.
class TapeProgram {
public:
    /// Uses only the nodes that the outputs depend on. Throws std::logic_error for a node in a format without
    /// arithmetic.
    explicit TapeProgram(const Tape& tape);

    /// Runs as a kernel of the table (`Intersector::native32`, `native64`). The answers are the tape's outputs, which
    /// are in the format S. The inputs are in the order of `input_names`. Thread-safe.
    template <class S>
    void run(const intersect::table::RayBatch<S>& rays, const intersect::Target<S>& target,
             const intersect::table::HitBatch<S>& hits) const;

    /// Number of operations that are performed for each ray.
    [[nodiscard]] std::size_t operation_count() const { return steps_.size(); }

private:
    struct Constant {
        NodeArithmetic arithmetic;
        double value;
        std::uint16_t out;
    };
    struct Input {
        std::size_t index;
        std::uint16_t out;
    };
    class Columns;

    std::vector<TapeStep> steps_;
    std::vector<Constant> constants_;
    std::vector<Input> inputs_;
    std::size_t input_count_ = 0;
    std::array<std::uint16_t, 3> column_counts_{};  ///< number of columns of floats, doubles and decisions
    std::array<std::uint16_t, 4> outputs_{};        ///< hit, t, near, far
};

}  // namespace lostbits::measure::tape
