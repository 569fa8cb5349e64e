#include "scene/rays/made_rows.hpp"

#include <algorithm>
#include <deque>
#include <mutex>
#include <string>

#include "number/error.hpp"

namespace lostbits::scene::rays {

using camera::Maker;
using intersect::table::Intersector;

namespace {

struct MadeRow {
    const Maker* maker;
    const Intersector* form;
    std::string name, title, source;
    intersect::Info info;
    Intersector row;
};

struct MadeRows {
    std::mutex mutex;
    std::deque<MadeRow> rows;  // rows stay where they are
};
MadeRows& all() {
    static MadeRows one;
    return one;
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
    MadeRows& made = all();
    const std::lock_guard lock(made.mutex);
    const auto known =
        std::ranges::find_if(made.rows, [&](const MadeRow& row) { return row.maker == &maker && row.form == &form; });
    if (known != made.rows.end()) return known->row;
    MadeRow& row = made.rows.emplace_back(
        MadeRow{.maker = &maker,
                .form = &form,
                .name = name,
                .title = std::string(form.info->title) + "; rays: " + std::string(maker.info->title),
                .source = std::string(form.info->source) + "; " + std::string(maker.info->source),
                .info = *form.info,
                .row = form});
    row.info.name = row.name, row.info.title = row.title, row.info.source = row.source;
    row.row.info = &row.info;
    return row.row;
}

const Maker* maker_of(const Intersector& row) {
    MadeRows& made = all();
    const std::lock_guard lock(made.mutex);
    const auto known = std::ranges::find_if(made.rows, [&](const MadeRow& one) { return &one.row == &row; });
    return known == made.rows.end() ? nullptr : known->maker;
}

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
