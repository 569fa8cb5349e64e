// From forms on the command line to sets of forms, one a shape, for what has solids of several shapes.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "intersect/table/sets.hpp"
#include "measure/evaluate/evaluate.hpp"

namespace lostbits::analysis::selection {

/// More sets than this on one scene are an error: whoever writes two globs seldom means their product.
inline constexpr std::size_t most_sets = 200;

/// The shapes of solids, under matrices where one of them stands under one.
template <class List>
Shapes shapes_of(const List& solids) {
    Shapes all;
    for (const auto& solid : solids) {
        const bool placed = all.are_placed() || solid.placed;
        all |= solid.shape;
        all = all.placed(placed);
    }
    return all;
}

/// Whether forms for these meet solids one by one, and not as one field that they march through.
inline bool are_solids(Shapes forms) { return !forms.has(Shape::sdf); }

/// Whether the forms for these shapes can be asked about something.
using Meets = std::function<bool(Shapes)>;

/// The shapes of something with solids of several; nothing where they are of one.
std::optional<Shapes> several_shapes(const Meets& meets);

/// "spheres and boxes"
std::string plurals(Shapes shapes);

/// Whether a word of -i names a set, `sphere.unified+box.signs`, and not a form that has a + in its name.
bool names_set(const std::string& word);
/// The sets of such a word, whose parts are globs. InputError for parts that can be no set and for more than
/// `most_sets`; NothingSelected for a glob that matches nothing.
std::vector<const intersect::table::Intersector*> sets_named(const std::string& word, const char* option);

/// The rows of a word such as `sphere.*@pbrt` or `sphere.*^box.signs~nearest`, whose parts are globs: through a space,
/// or behind a box, which may stand one after the other. InputError and NothingSelected as of each part.
std::vector<const intersect::table::Intersector*> made_named(const std::string& word, const char* option);

/// What was chosen by -i and -f, and the words of -i.
struct ChosenRows {
    std::vector<measure::evaluate::TestedForm>& rows;
    const std::vector<std::string>& words;
    bool quiet = false;
};

/// The rows that meet something called `name`. Where its solids stand under matrices, adds before every chosen form
/// that names no space through the usual one. Where its solids are of several shapes, adds before every combination of
/// the chosen forms, one a shape, in each chosen format; where all forms are chosen, as without -i, and nothing else
/// meets it, the plain set alone, and says so on stderr. InputError for more than `most_sets`, and for a chosen set
/// that lacks a shape.
std::vector<measure::evaluate::TestedForm> rows_meeting(const ChosenRows& chosen, const std::string& name,
                                                        const Meets& meets);

/// The set of the first form of each shape that takes any direction and counts a touch as a hit.
const intersect::table::Intersector& plain_set(Shapes shapes);

/// `sphere.*' -i 'sdf.*`: the globs of the forms that meet something, or a set where its solids are of several shapes.
std::string globs_of(const Meets& meets);

/// What to write so that something is met, for the end of a message: "; try -i 'sphere.*'", or ": it has spheres and
/// boxes, and no selected form is for boxes; try -i sphere.press+box.inclusive".
std::string words_to_meet(const std::vector<measure::evaluate::TestedForm>& rows, const Meets& meets);

}  // namespace lostbits::analysis::selection
