// Tape as a row of the table, so that all commands that measure forms can measure it.
#pragma once

#include <string>
#include <vector>

#include "intersect/table/table.hpp"
#include "measure/tape/tape_program.hpp"

namespace lostbits::measure::tape {

/// Records every operation that a form can do to a ray in a format, with the values of some ray. The tape is the same
/// for all rays if the form does not decide by itself which way the formula goes. InputError for a form whose
/// operations are not visible, that marches, or that is several forms. `from_inverse`: the primitives' matrices are
/// stored as inverses (world to object).
Tape tape_of(const intersect::table::Intersector& form, const Format& format, bool from_inverse = false);
/// True where `tape_of` gives a tape.
bool has_tape(const intersect::table::Intersector& form);

/// Inputs on the tape of a form, in its order (`input_names`). The next two give back the ray and the primitive that
/// they stand for: equal to `like` in everything that is not a number.
std::vector<double> inputs_of(const Ray<double>& ray, const Primitive<double>& primitive, double tmax);
Ray<double> ray_of(const std::vector<double>& inputs);
Primitive<double> primitive_of(const std::vector<double>& inputs, const Primitive<double>& like);

/// Operations that can be done wider: their results are rounded in the format of the answer and are needed for it.
std::vector<NodeId> rounded_operations(const Tape& tape);

/// Tape with these operations in a wider format, as code would have it. The operands of such an operation are widened
/// exactly. Its result is rounded before another operation takes it, and before it is the answer. Comparisons, choices
/// and signs are as wide as the widest of their operands.
Tape widened(const Tape& tape, const std::vector<NodeId>& operations, const FloatFormat& to);

/// Next wider arithmetic: double for float, two doubles for double; with `two_words`, two of the format's own words.
FloatFormat wider_than(const FloatFormat& format, bool two_words);

/// Row that runs a program in one format, with the contract of the form that it was made from.
class TapeForm {
public:
    TapeForm(const intersect::table::Intersector& like, const Format& format, const Tape& tape, std::string name,
             std::string title);
    TapeForm(const TapeForm&) = delete;
    TapeForm& operator=(const TapeForm&) = delete;

    /// Row of the table; valid as long as this is.
    [[nodiscard]] const intersect::table::Intersector& row() const { return row_; }
    [[nodiscard]] const TapeProgram& program() const { return program_; }

private:
    TapeProgram program_;
    std::string name_, title_;
    intersect::Info info_;
    intersect::table::Intersector row_;
};

}  // namespace lostbits::measure::tape
