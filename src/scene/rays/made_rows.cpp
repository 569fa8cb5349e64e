#include "scene/rays/made_rows.hpp"

#include <string>
#include <tuple>

#include "intersect/table/made_rows.hpp"
#include "number/error.hpp"

namespace lostbits::scene::rays {

using camera::Maker;
using intersect::table::Intersector;

namespace {

using Rows = intersect::table::MadeRows<std::tuple<const Maker*, const Intersector*>>;
Rows& rows() {
    static Rows all;
    return all;
}

}  // namespace

const Intersector& with_maker(const Maker& maker, const Intersector& form) {
    const std::string name =
        std::string(form.info->name) + "@" + std::string(maker_prefix) + std::string(maker.info->name);
    if (form.is_set() || form.is_placed || maker_of(form))
        throw InputError(name +
                         ": a ray generator follows one form without a transform; for several shapes, or "
                         "primitives under matrices, write camera.rays = \"" +
                         std::string(maker.info->name) +
                         "\" into the scene, or --set camera.rays=" + std::string(maker.info->name));
    return rows().row_of({&maker, &form}, [&](Rows::Made& made) {
        made.name = name;
        made.title = std::string(form.info->title) + "; rays: " + std::string(maker.info->title);
        made.source = std::string(form.info->source) + "; " + std::string(maker.info->source);
        made.tell_as(*form.info);
        made.row = form;
        made.row.info = &made.info;
    });
}

const Maker* maker_of(const Intersector& row) { return std::get<const Maker*>(rows().parts_of(row)); }

const Intersector& beneath_maker(const Intersector& row) {
    const auto* const form = std::get<const Intersector*>(rows().parts_of(row));
    return form ? *form : row;
}

const Intersector& without_maker(const Intersector& row) {
    if (maker_of(row))
        throw InputError(
            std::string(row.info->name) +
            ": the ray generator comes last, after one form and its box, as in "
            "sphere.unified^box.signs@ray-three; for several shapes, or with a transform, write camera.rays "
            "into the scene, or --set camera.rays=" +
            std::string(maker_of(row)->info->name));
    return row;
}

std::vector<std::string> forms_in_name(const std::string& name) {
    const auto is_suffix = [&name](std::size_t plus) {
        const std::size_t behind = plus + contracted_suffix.size();
        return name.compare(plus, contracted_suffix.size(), contracted_suffix) == 0 &&
               (behind == name.size() || std::string_view("+@^").find(name[behind]) != std::string_view::npos);
    };
    std::vector<std::string> forms{""};
    for (std::size_t i = 0; i < name.size(); ++i) {
        if (name[i] == '+' && !is_suffix(i)) forms.emplace_back();
        else forms.back() += name[i];
    }
    return forms;
}

std::optional<MadeName> made_name(const std::string& name) {
    using Kind = MadeName::Kind;
    if (name.ends_with(contracted_suffix))
        return MadeName{Kind::contracted,
                        name.substr(0, name.size() - contracted_suffix.size()),
                        std::string(contracted_suffix.substr(1)),
                        {}};
    const std::size_t at = name.find_last_of("@^");
    if (at == std::string::npos) return std::nullopt;
    MadeName found{name[at] == '^' ? Kind::box : Kind::space, name.substr(0, at), name.substr(at + 1), {}};
    if (found.kind == Kind::space && found.last.starts_with(maker_prefix)) {
        found.kind = Kind::maker;
        found.last.erase(0, maker_prefix.size());
    }
    if (const std::size_t tilde = found.last.find('~'); found.kind == Kind::box && tilde != std::string::npos) {
        found.hull = found.last.substr(tilde + 1);
        found.last.erase(tilde);
    }
    return found;
}

std::vector<const Intersector*> rows_of(const MadeName& name, const NamedParts& parts) {
    std::vector<const Intersector*> all;
    for (const Intersector* const form : parts.forms(name.form)) {
        switch (name.kind) {
            case MadeName::Kind::contracted: all.push_back(&parts.contracted(without_maker(*form))); break;
            case MadeName::Kind::maker:
                for (const Maker* const maker : parts.makers(name.last)) all.push_back(&with_maker(*maker, *form));
                break;
            case MadeName::Kind::space:
                for (const auto* const space : parts.spaces(name.last))
                    all.push_back(&intersect::space::through(*space, without_maker(*form)));
                break;
            case MadeName::Kind::box: {
                const auto hulls = name.hull ? parts.hulls(*name.hull) : std::vector{&intersect::hull::usual_hull()};
                for (const Intersector* const box : parts.forms(name.last))
                    for (const auto* const hull : hulls)
                        all.push_back(&intersect::hull::behind(*hull, without_maker(*box), without_maker(*form)));
                break;
            }
        }
    }
    return all;
}

}  // namespace lostbits::scene::rays
