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
                         ": a way to make rays stands behind one form without a space; of several shapes, or of "
                         "solids under matrices, write camera.rays = \"" +
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

const Intersector& without_maker(const Intersector& row) {
    if (maker_of(row))
        throw InputError(std::string(row.info->name) +
                         ": the way that makes the rays stands last, behind one form and its box, as in "
                         "sphere.unified^box.signs@ray-three; of several shapes, or through a space, write camera.rays "
                         "into the scene, or --set camera.rays=" +
                         std::string(maker_of(row)->info->name));
    return row;
}

}  // namespace lostbits::scene::rays
