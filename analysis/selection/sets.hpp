// Makes sets of forms, one form per shape, from forms of the command line, for scenes with primitives of several
// shapes.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "intersect/table/sets.hpp"
#include "measure/evaluate/evaluate.hpp"

namespace lostbits::analysis::selection {

/// The largest number of sets on one scene. More are an error, since a user who writes two patterns seldom means all
/// combinations.
inline constexpr std::size_t max_sets = 200;

/// The shapes of these primitives. All of them count as transformed if one is.
template <class List>
Shapes shapes_of(const List& primitives) {
    Shapes all;
    for (const auto& primitive : primitives) {
        const bool has_transform = all.have_transform() || primitive.transform;
        all |= primitive.shape;
        all = all.with_transform(has_transform);
    }
    return all;
}

/// True if forms for these shapes test primitives one by one, and do not march through one field of distances.
inline bool are_primitives(Shapes forms) { return !forms.has(Shape::sdf); }

/// True if forms for these shapes can test a subject, such as a scene.
using ShapePredicate = std::function<bool(Shapes)>;

/// The shapes of the subject's primitives if they have several; nothing if they have one.
std::optional<Shapes> several_shapes(const ShapePredicate& can_test);

/// "spheres and boxes"
std::string plurals(Shapes shapes);

/// True if a pattern of -i names a set, as `sphere.unified+box.signs` does, and not a form with a + in its name.
bool names_set(const std::string& pattern);
/// The sets that such a pattern names; the parts between the + are patterns too. Throws InputError for parts that
/// cannot form a set and for more than `max_sets` sets, NothingSelected for a part that matches nothing.
std::vector<const intersect::table::Intersector*> select_sets(const std::string& pattern, const char* option);

/// The forms that a pattern names, such as `sphere.*@pbrt` (a form with a transform method) or
/// `sphere.*^box.signs~nearest` (a form behind a bounding box), or of a pattern with several such parts. Throws
/// InputError and NothingSelected as the selection of each part does.
std::vector<const intersect::table::Intersector*> select_composed(const std::string& pattern, const char* option);

/// The forms in formats that -i and -f select, and the patterns of -i.
struct SelectedForms {
    std::vector<measure::evaluate::TestedForm>& tested_forms;
    const std::vector<std::string>& form_patterns;
    bool quiet = false;
};

/// Returns the tested forms that can test a subject called `name`. First it adds some to the chosen ones:
///   - if its primitives have transforms: every chosen form without a transform method, with the usual transform
///   method;
///   - if its primitives have several shapes: every combination of the chosen forms, one per shape, in each chosen
///     format. If all forms are chosen (as without -i) and none can test it, it adds only the plain set, and prints
///     that on stderr.
/// Throws InputError for more than `max_sets` sets, and for a chosen set that lacks a shape.
std::vector<measure::evaluate::TestedForm> tested_forms_handling(const SelectedForms& chosen, const std::string& name,
                                                                 const ShapePredicate& can_test);

/// The set of the first form of each shape that takes any direction and has the default convention (a touch is a hit).
const intersect::table::Intersector& default_set(Shapes shapes);

/// The patterns of the forms that can test the subject, or a set if its primitives have several shapes. They are for
/// text between single quotes: sphere.*' -i 'sdf.*
std::string patterns_for(const ShapePredicate& can_test);

/// Reason and advice for the end of a message that no selected form can test something: ": it has spheres; try -i
/// 'sphere.*'", or ": it has spheres and boxes, and no selected form is for boxes; try -i sphere.press+box.inclusive".
std::string forms_advice(const std::vector<measure::evaluate::TestedForm>& tested_forms,
                         const ShapePredicate& can_test);

/// Message that no selected form can test the subject called `name`, with the advice of `forms_advice`.
std::string unhandled_text(const std::string& name, const std::vector<measure::evaluate::TestedForm>& tested_forms,
                           const ShapePredicate& can_test);
/// Prints on stderr that a subject is left out, with the message of `unhandled_text`.
void note_left_out(const std::string& message);

}  // namespace lostbits::analysis::selection
