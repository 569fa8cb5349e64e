// A tape in the table of intersectors, so that all commands that measure forms can measure it.
#pragma once

#include <string>
#include <vector>

#include "intersect/table/table.hpp"
#include "measure/tape/tape_program.hpp"

namespace lostbits::measure::tape {

/// Records every operation that a form can perform on a ray in a format, with the values of one fixed ray. The tape is
/// the same for all rays if the form itself has no branches on its values. Throws InputError for a form whose
/// operations are not visible, for one that marches, and for a set of forms. `from_inverse` is true if the primitives'
/// matrices are stored as inverses (world to object).
Tape record_tape(const intersect::table::Intersector& form, const Format& format, bool from_inverse = false);
/// True if `record_tape` returns a tape for this form.
bool has_tape(const intersect::table::Intersector& form);

/// Returns the inputs of a form's tape, in the order of `input_names`. `ray_of` and `primitive_of` convert them back to
/// a ray and a primitive; everything but the numbers of the primitive is copied from `model`.
std::vector<double> inputs_of(const Ray<double>& ray, const Primitive<double>& primitive, double tmax);
Ray<double> ray_of(const std::vector<double>& inputs);
Primitive<double> primitive_of(const std::vector<double>& inputs, const Primitive<double>& model);

/// Returns the operations that can be computed in a wider format: those that round to the format of t, and whose
/// results the answer needs.
std::vector<NodeId> find_widenable_operations(const Tape& tape);

/// Returns a tape with these operations in the format `to`, which is wider, as source code would write them. The
/// operands of such an operation are widened exactly. Its result is rounded before another operation uses it, and
/// before it is part of the answer. Comparisons, choices and signs are computed in the widest format of their operands.
Tape widen_operations(const Tape& tape, const std::vector<NodeId>& operations, const FloatFormat& to);

/// Returns the next wider format: double for float, two doubles for double. With `two_words`, it is a pair of numbers
/// of the format itself.
FloatFormat wider_format(const FloatFormat& format, bool two_words);

/// A form that runs a tape in one format, with the contract of the form that the tape was recorded from.
class TapeForm {
public:
    TapeForm(const intersect::table::Intersector& model, const Format& format, const Tape& tape, std::string name,
             std::string title);
    TapeForm(const TapeForm&) = delete;
    TapeForm& operator=(const TapeForm&) = delete;

    /// Form of the table; valid as long as this object.
    [[nodiscard]] const intersect::table::Intersector& form() const { return form_; }
    [[nodiscard]] const TapeProgram& program() const { return program_; }

private:
    TapeProgram program_;
    std::string name_, title_;
    intersect::Info info_;
    intersect::table::Intersector form_;
};

}  // namespace lostbits::measure::tape
