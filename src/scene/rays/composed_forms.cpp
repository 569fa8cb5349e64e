#include "scene/rays/composed_forms.hpp"

#include <fmt/format.h>

#include <string>
#include <tuple>

#include "intersect/table/composed_forms.hpp"
#include "number/error.hpp"

namespace lostbits::scene::rays {

using camera::RayGenerator;
using intersect::table::Intersector;

namespace {

using FormTable = intersect::table::ComposedForms<std::tuple<const RayGenerator*, const Intersector*>>;
FormTable& composed_forms() {
    static FormTable forms;
    return forms;
}

}  // namespace

const Intersector& with_generator(const RayGenerator& generator, const Intersector& form) {
    const std::string name =
        std::string(form.info->name) + "@" + std::string(generator_prefix) + std::string(generator.info->name);
    if (form.is_set() || form.has_transform_method || generator_of(form))
        throw InputError(fmt::format(
            "{}: {} cannot be combined with {}; name one form without a transform method, or write camera.rays = "
            "\"{}\" into the scene, or use --set camera.rays={}",
            name, form.info->name, std::string(generator_prefix) + std::string(generator.info->name),
            generator.info->name, generator.info->name));
    return composed_forms().find_or_add({&generator, &form}, [&](FormTable::ComposedForm& made) {
        made.name = name;
        made.title = std::string(form.info->title) + "; rays: " + std::string(generator.info->title);
        made.source = std::string(form.info->source) + "; " + std::string(generator.info->source);
        made.copy_contract(*form.info);
        made.intersector = form;
        made.intersector.info = &made.info;
    });
}

const RayGenerator* generator_of(const Intersector& form) {
    return std::get<const RayGenerator*>(composed_forms().find_parts(form));
}

const Intersector& strip_generator(const Intersector& form) {
    const auto* const inner = std::get<const Intersector*>(composed_forms().find_parts(form));
    return inner ? *inner : form;
}

const Intersector& require_no_generator(const Intersector& form) {
    if (generator_of(form))
        throw InputError(
            std::string(form.info->name) +
            ": the ray generator comes last, after one form and its box, as in "
            "sphere.unified^box.signs@ray-three; for several shapes, or with a transform, write camera.rays "
            "into the scene, or --set camera.rays=" +
            std::string(generator_of(form)->info->name));
    return form;
}

std::vector<std::string> forms_in_name(const std::string& name) {
    const auto begins_suffix = [&name](std::size_t plus) {
        const std::size_t end_of_suffix = plus + contracted_suffix.size();
        return name.compare(plus, contracted_suffix.size(), contracted_suffix) == 0 &&
               (end_of_suffix == name.size() ||
                std::string_view("+@^").find(name[end_of_suffix]) != std::string_view::npos);
    };
    std::vector<std::string> forms{""};
    for (std::size_t i = 0; i < name.size(); ++i) {
        if (name[i] == '+' && !begins_suffix(i)) forms.emplace_back();
        else forms.back() += name[i];
    }
    return forms;
}

std::optional<ComposedName> split_composed_name(const std::string& name) {
    using Kind = ComposedName::Kind;
    if (name.ends_with(contracted_suffix))
        return ComposedName{Kind::contracted,
                            name.substr(0, name.size() - contracted_suffix.size()),
                            std::string(contracted_suffix.substr(1)),
                            {}};

    const std::size_t separator = name.find_last_of("@^");
    if (separator == std::string::npos) return std::nullopt;
    ComposedName split{name[separator] == '^' ? Kind::box : Kind::transform,
                       name.substr(0, separator),
                       name.substr(separator + 1),
                       {}};

    if (split.kind == Kind::transform && split.last.starts_with(generator_prefix)) {
        split.kind = Kind::generator;
        split.last.erase(0, generator_prefix.size());
    }
    if (const std::size_t tilde = split.last.find('~'); split.kind == Kind::box && tilde != std::string::npos) {
        split.box_method = split.last.substr(tilde + 1);
        split.last.erase(tilde);
    }
    return split;
}

std::vector<const Intersector*> rows_of(const ComposedName& name, const NamedParts& parts) {
    std::vector<const Intersector*> forms;
    for (const Intersector* const form : parts.forms(name.form)) {
        switch (name.kind) {
            case ComposedName::Kind::contracted: forms.push_back(&parts.contracted(require_no_generator(*form))); break;

            case ComposedName::Kind::generator:
                for (const RayGenerator* const generator : parts.ray_generators(name.last))
                    forms.push_back(&with_generator(*generator, *form));
                break;

            case ComposedName::Kind::transform:
                for (const auto* const method : parts.transform_methods(name.last))
                    forms.push_back(&intersect::transform::transformed_form(*method, require_no_generator(*form)));
                break;

            case ComposedName::Kind::box: {
                const auto box_methods = name.box_method ? parts.box_methods(*name.box_method)
                                                         : std::vector{&intersect::bounding_box::default_box_method()};
                for (const Intersector* const box : parts.forms(name.last))
                    for (const auto* const box_method : box_methods)
                        forms.push_back(&intersect::bounding_box::boxed_form(*box_method, require_no_generator(*box),
                                                                             require_no_generator(*form)));
                break;
            }
        }
    }
    return forms;
}

}  // namespace lostbits::scene::rays
