// From names and globs on the command line to forms, formats and metrics.
#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "intersect/table.hpp"
#include "measure/map.hpp"
#include "measure/metrics.hpp"
#include "number/error.hpp"
#include "number/format.hpp"

namespace lostbits::analysis {

/// Forms whose name matches any of the globs (`sphere.*`, `*press*`), in the catalogue's order. A name without a glob
/// character that is unknown is bad input, with did-you-mean; a glob that matches nothing selects nothing (exit 4).
std::vector<const Intersector*> select_forms(const std::vector<std::string>& globs);

/// Formats by name, or ranges `p5..p12`; duplicates are dropped. InputError with did-you-mean.
std::vector<Format> select_formats(const std::vector<std::string>& names);

/// Metrics by name or glob, in the order asked for. InputError with did-you-mean.
std::vector<const Metric*> select_metrics(const std::vector<std::string>& globs);

/// The default metrics and those that were asked for, in the table's order.
std::vector<const Metric*> measured(const std::vector<const Metric*>& asked);

/// Every selected form in every selected format that it exists in. NothingSelected where that leaves none.
std::vector<MapRow> cross(const std::vector<const Intersector*>& forms, const std::vector<Format>& formats);

/// Those rows whose forms meet solids of this shape.
std::vector<MapRow> of_shape(const std::vector<MapRow>& rows, Shape shape);

/// Drops what no selected form can meet and says so on stderr unless `quiet`; `shape_of` and `name_of` tell a thing's shape
/// and name. NothingSelected where that leaves none.
template <class Things, class ShapeOf, class NameOf>
void drop_unfitting(Things& things, const std::vector<MapRow>& rows, bool quiet, ShapeOf shape_of, NameOf name_of) {
    std::vector<std::string> left_out;
    std::erase_if(things, [&](const auto& thing) {
        if (!of_shape(rows, shape_of(thing)).empty()) return false;
        const std::string shape(shape_names[static_cast<std::size_t>(shape_of(thing))]);
        left_out.push_back(std::string(name_of(thing)) + " is about a " + shape + ", and none of the selected intersectors is; try -i '" + shape + ".*'");
        return true;
    });
    if (things.empty()) throw NothingSelected(left_out.front());
    for (const std::string& each : left_out) {
        if (!quiet) std::fprintf(stderr, "lostbits: left out: %s\n", each.c_str());
    }
}

/// Limits every parallel loop to that many threads while it lives; 0 stands for one a core.
class ThreadLimit {
public:
    explicit ThreadLimit(int threads);
    ~ThreadLimit();
    ThreadLimit(const ThreadLimit&) = delete;
    ThreadLimit& operator=(const ThreadLimit&) = delete;

private:
    struct Control;
    std::unique_ptr<Control> control_;
};

/// `WxH` in pixels. InputError otherwise.
std::pair<int, int> parse_size(const std::string& text);

/// The data folder: `--data`, then $LOSTBITS_DATA, then ./data, then the installed one beside the program.
std::filesystem::path data_folder(const std::string& given);

}  // namespace lostbits::analysis
