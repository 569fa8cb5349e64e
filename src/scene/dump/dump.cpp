#include "scene/dump/dump.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "number/error.hpp"
#include "number/rounded.hpp"
#include "scene/dump/csv_dump.hpp"
#include "scene/dump/npy_dump.hpp"
#include "scene/dump/raw_dump.hpp"
#include "shapes/number_names.hpp"

namespace lostbits::scene::dump {

double number_in(double x, const Format& format) {
    if (!std::isfinite(x)) return x;
    switch (format.engine) {
        case Format::Engine::native32: return static_cast<float>(x);
        case Format::Engine::native64: return x;
        case Format::Engine::rounded: break;
    }
    return rounding::to_format(x, 0, format.shape);
}

void Dump::settle(const DumpOptions& options, const Layout& layout, const Format& own) {
    terms_.format = options.format.value_or(own);
    terms_.keep = options.keep;
    terms_.solid = options.solid;
    terms_.open = options.open;
    const std::string& file = name_;
    if (layout.solid() && options.solid)
        throw InputError(file +
                         ": its columns have a solid for each ray, and the command line has one for all; leave "
                         "one of the two out");
    if (!layout.solid() && !options.solid) {
        std::string columns, named;
        for (const ShapeRow& row : shape_rows) {
            columns += (columns.empty() ? "" : " or ") + fmt::format("{}", fmt::join(column_names(row.shape), ","));
            named += fmt::format("--{} {}, ", row.name, option_words(row.shape));
        }
        throw InputError(file + ": no column has a solid; add " + columns + ", or name one for all rays with " + named +
                         "or --scene SCENE");
    }
    if (!options.miss) return;
    if (layout.has(slot::hit) || !layout.has(slot::t))
        throw InputError(file +
                         (layout.has(slot::hit)
                              ? ": --miss says which t is a miss, and the column hit says so already; leave --miss out"
                              : ": --miss says which t is a miss, and there is no column t; leave --miss out"));
    terms_.miss = *options.miss;
    // The sentinel as the file's numbers are read: the same rounding.
    terms_.miss.number = rounding::to_format(terms_.miss.number, 0, terms_.format.shape);
}

std::unique_ptr<Dump> open_dump(const std::filesystem::path& path, const DumpOptions& options) {
    Container container = options.container;
    if (container == Container::by_name) {
        std::string ending = path.extension().string();
        std::ranges::transform(ending, ending.begin(),
                               [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        container = ending == ".csv" ? Container::csv : ending == ".npy" ? Container::npy : Container::raw;
        if (container == Container::raw && options.columns.empty())
            throw InputError(path.string() +
                             ": a file of rays ends in .csv or .npy, or has raw numbers whose names and types are "
                             "given: --columns ox:f32,oy,oz,dx,dy,dz,hit:u8,t:f32; or say --container csv");
    }
    if (options.skip > 0 && container != Container::raw)
        throw InputError(path.string() + ": --skip passes over bytes in front of raw numbers; leave it out");
    switch (container) {
        case Container::csv: return std::make_unique<CsvDump>(path, options);
        case Container::npy: return std::make_unique<NpyDump>(path, options);
        default: return std::make_unique<RawDump>(path, options);
    }
}

}  // namespace lostbits::scene::dump
