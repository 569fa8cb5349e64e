// A tape as expressions that a person reads.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "number/tape.hpp"

namespace lostbits::measure::blame {

/// Names and expressions of the operations of one tape. The formula's own letters where it names them (a letter that
/// comes again, in a loop over axes, is numbered: `tmin`, `tmin2`); sums of three products as dot products; the three
/// components of a vector that occurs in one as `v1.x`, `v1.y`, `v1.z`; everything else is written out where it is
/// short and is `s12` where it is not.
class TapeText {
public:
    /// plain is ASCII: `dot(a, b) - r*r`; pretty: `a·b − r·r`; latex: in math mode; generic: plain, but alike for every
    /// axis and every round of a loop.
    enum class Style { plain, pretty, latex, generic };

    TapeText(const Tape& tape, std::vector<std::string> inputs, Style style);

    /// Unique on the tape: `c`, `v1.x`, `s12`, an input's name, a constant's digits.
    [[nodiscard]] const std::string& name(NodeId i) const { return names_[static_cast<std::size_t>(i)]; }
    /// The name as the style writes it.
    [[nodiscard]] std::string shown(NodeId i) const;
    /// The same as a C identifier; of a constant its digits.
    [[nodiscard]] std::string identifier(NodeId i) const;
    /// What it is computed from: `dot(o - centre, o - centre) - radius*radius`.
    [[nodiscard]] const std::string& expression(NodeId i) const;
    /// It within a larger expression: its name where it has one of its own, what it is computed from otherwise.
    [[nodiscard]] std::string operand(NodeId i) const { return operand(i, 0); }
    /// `c = dot(…) - radius*radius`, or the expression alone where the formula does not name it.
    [[nodiscard]] std::string definition(NodeId i) const;
    /// Of the generic style: `inv = 1/d.i`. What a map calls an operation by; names are not unique in it.
    [[nodiscard]] std::string category(NodeId i) const;

private:
    using Triple = std::array<NodeId, 3>;
    struct Dot {
        Triple a, b;
    };
    [[nodiscard]] bool is_vector(const Triple& v) const;
    /// Whether node i is the last sum of a dot product, and of which vectors.
    [[nodiscard]] bool dot_of(NodeId i, Dot& dot) const;
    void name_vector(const Triple& v);
    void name_all();
    [[nodiscard]] bool is_simple(NodeId i) const;
    [[nodiscard]] std::string vector_text(const Triple& v, bool alone) const;
    [[nodiscard]] std::string operand(NodeId i, int binds) const;
    [[nodiscard]] std::string composed(NodeId i) const;
    [[nodiscard]] std::string written_out(NodeId i) const;
    [[nodiscard]] std::string vector_shown(const std::string& base) const;

    const Tape& tape_;
    std::vector<std::string> inputs_;
    Style style_;
    std::vector<std::string> names_;
    std::map<Triple, std::string> vectors_;
    mutable std::vector<std::string> expressions_;  ///< those that were asked for: a march is a chain in which each
                                                    ///< step occurs several times in the next
    std::vector<NodeId> part_of_dot_;               ///< the dot product that a partial sum or product belongs to
};

}  // namespace lostbits::measure::blame
