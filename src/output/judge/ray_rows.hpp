// A row a ray: what the file has of it, and what became of it.
#pragma once

#include <vector>

#include "measure/judge/judge.hpp"
#include "output/map/map_tables.hpp"

namespace lostbits::output::judge {

/// A ray of a chunk of the file.
struct JudgedRay {
    const scene::dump::Chunk* chunk;
    map::BandRay found;
};

/// The columns of one row of the work. `decides`: its answers have no t.
table::Table<JudgedRay> ray_table(const scene::dump::Dump& dump,
                                  const std::vector<const measure::metric::Metric*>& metrics, bool decides = false);

}  // namespace lostbits::output::judge
