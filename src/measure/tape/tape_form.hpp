// A tape as a row of the table, so that whatever measures forms measures it.
#pragma once

#include <string>
#include <vector>

#include "intersect/table/table.hpp"
#include "measure/tape/tape_program.hpp"

namespace lostbits::measure::tape {

/// Every operation that a form can ever do to a ray in a format, with the values of some ray: the same tape for all
/// rays where none of them decides by itself which way the formula goes. InputError for a form whose operations are not
/// seen, that marches or that is several. `from_inverse`: of solids under matrices that are stored as the way to the
/// solid.
Tape tape_of(const intersect::table::Intersector& form, const Format& format, bool from_inverse = false);
/// Whether there is such a tape.
bool has_tape(const intersect::table::Intersector& form);

/// The inputs on the tape of a form, in its order (`input_names`), and the ray and the solid that they stand for: one
/// like `like` in what is no number.
std::vector<double> inputs_of(const Ray<double>& ray, const Solid<double>& solid, double tmax);
Ray<double> ray_of(const std::vector<double>& inputs);
Solid<double> solid_of(const std::vector<double>& inputs, const Solid<double>& like);

/// Operations whose results are rounded in the format of the answer and are needed for it: those that can be done
/// wider.
std::vector<NodeId> rounded_operations(const Tape& tape);

/// The tape with these operations in a wider format. As code would have it: what such an operation takes is widened
/// exactly; what another one takes of its result, and the answer, is rounded first; comparisons, choices and signs are
/// as wide as the widest of their operands.
Tape widened(const Tape& tape, const std::vector<NodeId>& operations, const FloatFormat& to);

/// The next wider arithmetic: double for float, two doubles for double; or two of the format's own words.
FloatFormat wider_than(const FloatFormat& format, bool two_words);

/// A row that runs a program in one format, with the contract of the form that it was made from.
class TapeForm {
public:
    TapeForm(const intersect::table::Intersector& like, const Format& format, const Tape& tape, std::string name,
             std::string title);
    TapeForm(const TapeForm&) = delete;
    TapeForm& operator=(const TapeForm&) = delete;

    /// Valid as long as this is.
    [[nodiscard]] const intersect::table::Intersector& row() const { return row_; }
    [[nodiscard]] const TapeProgram& program() const { return program_; }

private:
    TapeProgram program_;
    std::string name_, title_;
    intersect::Info info_;
    intersect::table::Intersector row_;
};

}  // namespace lostbits::measure::tape
