// A tape as statements, whatever the language: which operations have one of their own, and what they are called.
#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "intersect/table/table.hpp"
#include "number/tape.hpp"
#include "output/blame/tape_slice.hpp"

namespace lostbits::output::mend {

/// What a language calls the numbers of the solid, and words that are no names there.
struct CodeWords {
    std::string solid;  ///< in front of `centre.x`
    std::set<std::string, std::less<>> taken;
};

/// What the inputs on the tape of a form are called: those of a ray, of a solid, and of its matrix if it stands under
/// one.
std::vector<std::string> input_names_of(const intersect::table::Intersector& form);

class TapeCode {
public:
    virtual ~TapeCode() = default;
    TapeCode(const TapeCode&) = delete;
    TapeCode& operator=(const TapeCode&) = delete;

    /// Those of the operations that are not written within another expression, in order.
    [[nodiscard]] std::vector<std::string> statements() const;
    /// Node i in brackets where it binds less tightly.
    [[nodiscard]] std::string operand(NodeId i, int binds) const;

protected:
    /// Of what `wanted` is computed from. `like`: what has no name of its own is called as it is there.
    TapeCode(const Tape& tape, const intersect::table::Intersector& form, std::vector<NodeId> wanted, CodeWords words,
             const TapeCode* like = nullptr);

    [[nodiscard]] virtual std::string statement(NodeId i) const = 0;
    [[nodiscard]] virtual std::string expression(NodeId i) const = 0;
    [[nodiscard]] virtual std::string constant(NodeId i) const = 0;
    /// How tightly its expression binds.
    [[nodiscard]] virtual int binding(NodeId i) const = 0;

    [[nodiscard]] bool is_wide(NodeId i) const { return tape_.format_of(i) != own_; }
    [[nodiscard]] const std::string& name(NodeId i) const { return names_[static_cast<std::size_t>(i)]; }

    const Tape& tape_;

private:
    void name_all(const TapeCode* like);
    std::string new_name(const TapeNode& n, const TapeCode* like, std::set<std::string>& used);
    /// What an operation does to which names.
    [[nodiscard]] std::string text_of(const TapeNode& n) const;
    /// `o.x - centre.x` as `o_minus_centre_x`.
    [[nodiscard]] std::string of_inputs(const TapeNode& n) const;
    [[nodiscard]] std::string identifier(std::string_view label) const;
    /// The operations that take a result, conversions counted as what they convert.
    [[nodiscard]] int uses(NodeId i) const;
    [[nodiscard]] bool is_inlined(NodeId i) const { return inlined_[static_cast<std::size_t>(i)]; }
    void choose_inlined();

    std::vector<NodeId> wanted_;
    blame::TapeSlice slice_;
    CodeWords words_;
    FloatFormat own_;
    std::vector<std::string> inputs_, names_;
    std::size_t solid_numbers_;  ///< inputs behind the ray; the matrix follows
    /// What the source gives no name: by what it is, and the first that is the same.
    std::map<std::string, std::vector<std::string>> known_;
    std::vector<std::string> first_names_;
    int unnamed_ = 0;
    std::vector<bool> inlined_;
};

}  // namespace lostbits::output::mend
