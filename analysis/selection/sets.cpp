#include "analysis/selection/sets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "analysis/selection/select.hpp"
#include "intersect/bounding_box/behind.hpp"
#include "intersect/transform/transformed_form.hpp"
#include "measure/tape/contraction.hpp"
#include "measure/tape/tape_form.hpp"
#include "number/error.hpp"
#include "output/file/number_text.hpp"
#include "scene/rays/composed_forms.hpp"

namespace lostbits::analysis::selection {

using intersect::table::Intersector;
using measure::evaluate::TestedForm;

namespace {

using Forms = std::vector<const Intersector*>;

std::vector<Shape> list_shapes(Shapes shapes) {
    std::vector<Shape> result;
    for (const ShapeRow& shape_row : shape_rows)
        if (shapes.has(shape_row.shape)) result.push_back(shape_row.shape);
    return result;
}

/// "spheres, boxes and cones"
std::string plurals_text(const std::vector<Shape>& shapes) {
    std::vector<std::string> names;
    for (const Shape shape : shapes) names.emplace_back(row_of(shape).plural);
    return output::file::word_list(names);
}

/// "22 of spheres and 11 of boxes make 242 sets"
std::string set_counts_text(const std::vector<Forms>& forms_by_shape, std::size_t count) {
    std::vector<std::string> parts;
    for (const Forms& forms : forms_by_shape)
        parts.push_back(fmt::format("{} of {}", forms.size(), row_of(forms.front()->shape).plural));
    return fmt::format("{} make {} sets, one form for each shape", output::file::word_list(parts), count);
}

/// Every combination of one form of each list that can be a set. Throws InputError, which begins with `prefix`, for too
/// many combinations, and if none of them can be a set.
Forms combinations(const std::vector<Forms>& forms_by_shape, const std::string& prefix) {
    std::size_t count = 1;
    for (const Forms& forms : forms_by_shape) count *= forms.size();
    if (count > max_sets)
        throw InputError(fmt::format("{}: {}, and at most {} are allowed; name fewer forms, such as -i '{}.*' -i {}",
                                     prefix, set_counts_text(forms_by_shape, count), max_sets,
                                     name_of(forms_by_shape.front().front()->shape),
                                     forms_by_shape.back().front()->info->name));

    // Counts through the combinations, with the form of the last shape changing first.
    Forms sets;
    std::string refusal;
    for (std::size_t i = 0; i < count; ++i) {
        Forms parts;
        std::size_t remaining = i;
        for (auto forms = forms_by_shape.rbegin(); forms != forms_by_shape.rend(); ++forms) {
            parts.insert(parts.begin(), (*forms)[remaining % forms->size()]);
            remaining /= forms->size();
        }
        const std::string why = intersect::table::refusal_of_set(parts);
        if (why.empty()) sets.push_back(&intersect::table::find_or_add_set(parts));
        else if (refusal.empty()) refusal = why;
    }
    if (sets.empty()) throw InputError(prefix + ": " + refusal);
    return sets;
}

/// The forms for which `is_wanted` is true, each once.
Forms forms_in(const std::vector<TestedForm>& tested_forms, const std::function<bool(const Intersector&)>& is_wanted) {
    Forms forms;
    for (const TestedForm& tested_form : tested_forms)
        if (is_wanted(*tested_form.form) && std::ranges::find(forms, tested_form.form) == forms.end())
            forms.push_back(tested_form.form);
    return forms;
}

Forms forms_for(const std::vector<TestedForm>& tested_forms, Shapes shape) {
    return forms_in(tested_forms, [shape](const Intersector& form) {
        return !form.is_set() && form.shapes() == shape && !scene::rays::generator_of(form);
    });
}

/// The shapes of something whose primitives have transforms; nothing if none is.
std::optional<Shapes> shapes_with_transforms(const ShapePredicate& can_test) {
    for (const ShapeRow& shape_row : shape_rows)
        if (const Shapes shape = Shapes(shape_row.shape).with_transform(); can_test(shape)) return shape;
    const auto several = several_shapes(can_test);
    return several && several->have_transform() ? several : std::nullopt;
}

/// Adds each form for these shapes that has no transform method, with the usual transform method.
void add_transformed_forms(std::vector<TestedForm>& tested_forms, Shapes shapes) {
    const std::vector<TestedForm> original_forms = tested_forms;
    for (TestedForm tested_form : original_forms) {
        if (tested_form.form->is_set() || tested_form.form->has_transform_method ||
            !shapes.has(tested_form.form->shape))
            continue;
        if (scene::rays::generator_of(*tested_form.form)) continue;
        tested_form.form = &intersect::transform::transformed_form(intersect::transform::default_transform_method(),
                                                                   *tested_form.form);
        if (tested_form.against != nullptr && !tested_form.against->is_set() &&
            !tested_form.against->has_transform_method && is_primitive(tested_form.against->shape))
            tested_form.against = &intersect::transform::transformed_form(
                intersect::transform::default_transform_method(), *tested_form.against);
        if (std::ranges::find(tested_forms, tested_form) == tested_forms.end()) tested_forms.push_back(tested_form);
    }
}

const Intersector& plain_form(Shape shape) {
    const auto forms = intersect::table::intersectors(shape);
    const auto plain = std::ranges::find_if(forms, [](const Intersector& form) {
        return form.info->direction == intersect::Direction::any && form.info->convention() == intersect::Convention();
    });
    return plain == forms.end() ? forms.front() : *plain;
}

/// Adds the sets in each format of the tested forms. A set is compared with the same form as the tested form if that is
/// for the same shapes.
void add_set_forms(std::vector<TestedForm>& tested_forms, const Forms& sets) {
    const std::vector<TestedForm> original_forms = tested_forms;
    for (const Intersector* const set : sets) {
        for (TestedForm tested_form : original_forms) {
            tested_form.form = set;
            const auto same = [&tested_form](const TestedForm& other) {
                return other.form == tested_form.form && other.format == tested_form.format;
            };
            if (!set->exists_in(tested_form.format) || std::ranges::any_of(tested_forms, same)) continue;
            if (tested_form.against != nullptr && !(tested_form.against->shapes() == set->shapes())) continue;
            tested_forms.push_back(tested_form);
        }
    }
}

/// The shapes that no tested form is for, and advice.
std::string missing_shapes_text(const std::vector<TestedForm>& tested_forms, Shapes shapes) {
    std::vector<Shape> missing;
    std::string example;
    for (const Shape shape : list_shapes(shapes)) {
        const Forms forms = forms_for(tested_forms, Shapes(shape).with_transform(shapes.have_transform()));
        if (forms.empty()) missing.push_back(shape);
        example +=
            (example.empty() ? "" : "+") + std::string((forms.empty() ? plain_form(shape) : *forms.front()).info->name);
    }
    if (missing.empty()) return fmt::format("try -i {}", example);
    return fmt::format("it has {}, and no selected form is for {}; try -i {}", selection::plurals(shapes),
                       plurals_text(missing), example);
}

/// Adds the sets that `tested_forms_handling` adds for these shapes.
void add_sets(const SelectedForms& chosen, const std::string& name, Shapes shapes, const ShapePredicate& can_test) {
    // A chosen set must have a form for each shape.
    for (const Intersector* const set :
         forms_in(chosen.tested_forms, [](const Intersector& form) { return form.is_set(); })) {
        std::vector<TestedForm> parts;
        for (const Intersector* const part : set->parts) parts.push_back({part, chosen.tested_forms.front().format});
        for (const Shape shape : list_shapes(shapes))
            if (!set->shapes().has(shape))
                throw InputError(
                    fmt::format("-i {}: {}: {}", set->info->name, name, missing_shapes_text(parts, shapes)));
    }

    // Single forms are combined, unless some shape has none.
    std::vector<Forms> forms_by_shape;
    for (const Shape shape : list_shapes(shapes))
        forms_by_shape.push_back(forms_for(chosen.tested_forms, Shapes(shape).with_transform(shapes.have_transform())));
    if (std::ranges::any_of(forms_by_shape, &Forms::empty)) return;
    const bool chose_all = std::ranges::find(chosen.form_patterns, "*") != chosen.form_patterns.end();
    if (!chose_all)
        return add_set_forms(chosen.tested_forms, combinations(forms_by_shape, fmt::format("-i: on {}", name)));

    // Adds only the plain set, and only if no form can test the subject.
    if (std::ranges::any_of(chosen.tested_forms, [&can_test](const TestedForm& tested_form) {
            return can_test(tested_form.form->shapes());
        }))
        return;
    const Intersector& plain = default_set(shapes);
    add_set_forms(chosen.tested_forms, {&plain});
    if (!chosen.quiet)
        fmt::print(stderr,
                   "lostbits: {}: it has {}, so it is measured with sets, one form for each shape; without -i the "
                   "only set is {}. To measure all combinations of some forms, name them, such as -i '{}.*' -i {}\n",
                   name, selection::plurals(shapes), plain.info->name, name_of(plain.parts.front()->shape),
                   plain.parts.back()->info->name);
}

}  // namespace

std::optional<Shapes> several_shapes(const ShapePredicate& can_test) {
    for (std::size_t subset = 0; subset < std::size_t{1} << shape_rows.size(); ++subset) {
        Shapes shapes;
        for (const ShapeRow& shape_row : shape_rows)
            if ((subset >> static_cast<unsigned>(shape_row.shape) & 1) != 0) shapes |= shape_row.shape;
        for (const Shapes candidate : {shapes, shapes.with_transform()})
            if (candidate.are_several() && can_test(candidate)) return candidate;
    }
    return std::nullopt;
}

std::string plurals(Shapes shapes) { return plurals_text(list_shapes(shapes)); }

bool names_set(const std::string& pattern) {
    const auto all = intersect::table::intersectors();
    return scene::rays::forms_in_name(pattern).size() > 1 &&
           std::ranges::none_of(all, [&pattern](const Intersector& form) { return form.info->name == pattern; });
}

Forms select_sets(const std::string& pattern, const char* option) {
    std::vector<Forms> parts;
    for (const std::string& part : scene::rays::forms_in_name(pattern)) {
        if (part.empty())
            throw InputError(
                fmt::format("{} {}: the form on one side of a + is missing; name a form for each shape, such as "
                            "sphere.unified+box.signs",
                            option, pattern));
        parts.push_back(select_forms({part}, option));
        for (const Intersector* const form : parts.back()) scene::rays::require_no_generator(*form);
    }
    return combinations(parts, fmt::format("{} {}", option, pattern));
}

const Intersector& default_set(Shapes shapes) {
    Forms parts;
    for (const Shape shape : list_shapes(shapes)) {
        const Intersector& plain = plain_form(shape);
        parts.push_back(shapes.have_transform() ? &intersect::transform::transformed_form(
                                                      intersect::transform::default_transform_method(), plain)
                                                : &plain);
    }
    return intersect::table::find_or_add_set(parts);
}

namespace {

/// Throws InputError if one side of the sign in a composed name is empty.
void require_both_parts(const scene::rays::ComposedName& name, const std::string& pattern, const char* option) {
    using Kind = scene::rays::ComposedName::Kind;
    if (name.kind == Kind::contracted && name.form.empty())
        throw InputError(fmt::format(
            "{} {}: the form before +fma is missing; write FORM+fma, such as sphere.schoolbook+fma", option, pattern));
    const bool is_box = name.kind == Kind::box;
    if (name.form.empty() || name.last.empty())
        throw InputError(fmt::format(
            "{} {}: the form or the {} beside the {} is missing; write {}", option, pattern,
            is_box ? "box" : "transform", is_box ? "^" : "@",
            is_box ? "FORM^BOX or FORM^BOX~METHOD, such as sphere.unified^box.signs~nearest; `lostbits list boxes` "
                     "lists the ways to compute boxes"
                   : "FORM@TRANSFORM, such as sphere.unified@pbrt; `lostbits list transforms` lists them"));
}

}  // namespace

Forms select_composed(const std::string& pattern, const char* option) {
    using Kind = scene::rays::ComposedName::Kind;
    const auto name = scene::rays::split_composed_name(pattern).value();
    const bool is_contracted = name.kind == Kind::contracted;
    require_both_parts(name, pattern, option);
    // Messages about the last part quote the whole name, then the part.
    const std::string quoted_option = fmt::format("{} {}:", option, pattern);

    const Forms composed =
        rows_of(name, {.forms =
                           [&](const std::string& part_pattern) {
                               Forms forms = select_forms({part_pattern}, option);
                               // A pattern skips forms that march, which take no transform, and forms that choose
                               // their operations by the ray, which have no tape. Named in full, they are refused.
                               std::erase_if(forms, [&](const Intersector* form) {
                                   return is_pattern(name.form) &&
                                          ((name.kind == Kind::transform && !is_primitive(form->shape)) ||
                                           (is_contracted && !measure::tape::has_tape(*form)));
                               });
                               return forms;
                           },
                       .transform_methods =
                           [&quoted_option](const std::string& part_pattern) {
                               return select_items(intersect::transform::transform_methods(), {part_pattern},
                                                   "transform", quoted_option.c_str());
                           },
                       .ray_generators =
                           [&quoted_option](const std::string& part_pattern) {
                               return select_items(scene::camera::ray_generators(), {part_pattern}, "ray generator",
                                                   quoted_option.c_str());
                           },
                       .box_methods =
                           [&quoted_option](const std::string& part_pattern) {
                               return select_items(intersect::bounding_box::box_methods(), {part_pattern},
                                                   "bounding box", quoted_option.c_str());
                           },
                       .contracted = measure::tape::contract_form});

    if (composed.empty() && is_contracted)
        throw NothingSelected(
            fmt::format("{} {}: every matching form marches, filters or has no known operations, so none can be "
                        "contracted; try 'sphere.schoolbook+fma'",
                        option, pattern));
    if (composed.empty())
        throw NothingSelected(
            fmt::format("{} {}: every matching form marches, and forms that march take no transform; try '*@{}'",
                        option, pattern, name.last));
    return composed;
}

void require_no_generators(const Forms& forms, const char* command) {
    for (const Intersector* const form : forms)
        if (scene::rays::generator_of(*form))
            throw InputError(fmt::format(
                "-i {}: this form makes its own rays by the ray generator after the @, but {} gives every form the "
                "same rays of the camera; use `lostbits map`, `sweep`, `explain` or `check`, or leave out "
                "the @ and the ray generator",
                form->info->name, command));
}
void require_no_generators(const std::vector<TestedForm>& tested_forms, const char* command) {
    require_no_generators(forms_in(tested_forms, [](const Intersector&) { return true; }), command);
}

void require_no_contracted_forms(const std::vector<TestedForm>& tested_forms, const char* command) {
    const auto contracted = [](const Intersector& form) {
        return measure::tape::is_contracted(intersect::bounding_box::innermost_form(form));
    };
    for (const TestedForm& tested_form : tested_forms) {
        const auto& parts = tested_form.form->parts;
        if (contracted(*tested_form.form) ||
            std::ranges::any_of(parts, [&](const auto* part) { return contracted(*part); }))
            throw InputError(
                fmt::format("-i {}: {} measures time, but a contracted form runs operation by operation, which takes "
                            "longer than compiled code; use `lostbits map`, `sweep` or `judge`, or leave out +fma",
                            tested_form.form->info->name, command));
    }
}

void require_no_generated_rays(const std::vector<scene::file::Scene>& scenes, const char* command) {
    for (const scene::file::Scene& scene : scenes)
        if (scene.camera.ray_generator)
            throw InputError(fmt::format(
                "{}: {}: each format makes the rays of this scene by its own arithmetic (camera.rays), but {} "
                "needs exact rays, which it rounds to each format; use `lostbits map`, or leave out camera.rays",
                command, scene.id, command));
}

std::vector<TestedForm> tested_forms_handling(const SelectedForms& chosen, const std::string& name,
                                              const ShapePredicate& can_test) {
    if (const auto transform = shapes_with_transforms(can_test)) add_transformed_forms(chosen.tested_forms, *transform);
    if (const auto several = several_shapes(can_test)) add_sets(chosen, name, *several, can_test);
    return filter_tested_forms(chosen.tested_forms, can_test);
}

std::string patterns_for(const ShapePredicate& can_test) {
    std::string patterns;
    const auto add = [&patterns](const std::string& pattern) {
        patterns += (patterns.empty() ? "" : "' -i '") + pattern;
    };
    if (const auto several = several_shapes(can_test)) add(std::string(default_set(*several).info->name));
    for (const Shape shape : all_shapes)
        if (can_test(shape) || can_test(Shapes(shape).with_transform())) add(std::string(name_of(shape)) + ".*");
    return patterns;
}

std::string forms_advice(const std::vector<TestedForm>& tested_forms, const ShapePredicate& can_test) {
    if (const auto several = several_shapes(can_test)) return ": " + missing_shapes_text(tested_forms, *several);
    const auto has_needless_transform = [&can_test](const TestedForm& tested_form) {
        const Shapes shapes = tested_form.form->shapes();
        return shapes.have_transform() && can_test(shapes.with_transform(false));
    };
    if (std::ranges::any_of(tested_forms, has_needless_transform))
        return ": no primitive of it has a transform, so FORM@TRANSFORM makes no sense here; leave out the @ and the "
               "transform";
    std::vector<Shape> primitives;
    for (const Shape shape : all_shapes)
        if (is_primitive(shape) && (can_test(shape) || can_test(Shapes(shape).with_transform())))
            primitives.push_back(shape);
    const std::string reason = primitives.size() == 1 ? ": it has " + plurals_text(primitives) : "";
    return reason + "; try -i '" + patterns_for(can_test) + "'";
}

std::string unhandled_text(const std::string& name, const std::vector<TestedForm>& tested_forms,
                           const ShapePredicate& can_test) {
    return "no selected form handles " + name + forms_advice(tested_forms, can_test);
}

void note_left_out(const std::string& message) { fmt::print(stderr, "lostbits: left out: {}\n", message); }

}  // namespace lostbits::analysis::selection
