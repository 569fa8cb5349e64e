#include "output/judge/ray_rows.hpp"

namespace lostbits::output::judge {

using file::Cell;
using scene::dump::Chunk;
using scene::dump::Dump;
using scene::dump::Layout;
using table::Table;
namespace slot = scene::dump::slot;

namespace {

bool has_hit(const JudgedRay& r) { return !r.chunk->hit.empty() && r.chunk->hit[r.found.i] != 0; }

/// What the file has of a ray and its solid.
Table<JudgedRay> given_columns(const Dump& dump) {
    using R = JudgedRay;
    const Layout& layout = dump.layout();
    Table<R> table{{"ray", "integer", "", "place of the ray in the file, from 0",
                    [](const R& r) { return r.chunk->first + r.found.i; }}};
    // Numbers of files of floats are written as short as floats are.
    const bool narrow = dump.format().engine == Format::Engine::native32;
    const auto number = [narrow](double x) { return narrow ? Cell(static_cast<float>(x)) : Cell(x); };
    const auto add = [&](std::size_t s, const char* type, const char* meaning, table::CellOf<R> value) {
        if (layout.has(s))
            table.add({std::string(scene::dump::name_of_slot(s, layout.solid())), type, "", meaning, std::move(value)});
    };
    const auto add_number = [&](std::size_t s, const char* meaning, const auto& value) {
        add(s, "number", meaning, [=](const R& r) { return number(value(*r.chunk, r.found.i)); });
    };
    for (int k = 0; k < 6; ++k)
        add_number(slot::origin + static_cast<std::size_t>(k), "of the ray, as it was judged",
                   [k](const Chunk& c, std::size_t i) {
                       const Ray<double> ray = c.rays[i];
                       return k < 3 ? ray.origin[k] : ray.direction[k - 3];
                   });
    add_number(slot::tmin, "where the range of the ray begins",
               [](const Chunk& c, std::size_t i) { return c.rays.tmin[i]; });
    add_number(slot::tmax, "where it ends", [](const Chunk& c, std::size_t i) { return c.rays.tmax[i]; });
    for (std::size_t s = slot::solid; s < slot::t; ++s)
        add_number(s, "of the ray's solid, as it was judged",
                   [k = s - slot::solid](const Chunk& c, std::size_t i) { return c.solids[i].used()[k]; });
    for (std::size_t s = slot::matrix; s < slot::count; ++s)
        add_number(s, "of its matrix, as it was judged",
                   [k = s - slot::matrix](const Chunk& c, std::size_t i) { return c.solids[i].placed->matrix[k]; });
    add(slot::hit, "boolean", "whether the file has a hit there", has_hit);
    add(slot::t, "number", "the file's answer; missing where it has no hit",
        [number](const R& r) { return has_hit(r) ? number(r.chunk->t[r.found.i]) : Cell(); });
    return table;
}

}  // namespace

Table<JudgedRay> ray_table(const Dump& dump, const std::vector<const measure::metric::Metric*>& metrics, bool decides) {
    using Found = map::BandRay;
    Table<Found> found{map::outcome_column()};
    found.add_exact({"answer", "number", "t", "the answer that was judged, in its own unit",
                     [decides](const Found& r) { return r.hit() && !decides ? r.t() : Cell(); }});
    found.add(map::found_columns(metrics));
    Table<JudgedRay> table = given_columns(dump);
    const std::size_t kept = dump.layout().kept().size();
    for (std::size_t k = 0; k < kept; ++k) {
        std::string name = file::csv_text(dump.layout().kept()[k]);  // a column may be called like a formula
        while (name.empty() || table.find(name) || found.find(name)) name = "file_" + name;
        table.add({name, "string", "", "as the file has it",
                   [k, kept](const JudgedRay& r) { return r.chunk->kept[r.found.i * kept + k]; }});
    }
    return table.add(found, &JudgedRay::found);
}

}  // namespace lostbits::output::judge
