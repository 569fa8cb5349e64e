// One self-contained HTML file: no request beyond it, a strict policy, readable without scripts.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "measure/claim.hpp"
#include "output/report/map_data.hpp"

namespace lostbits::output::report {

/// A PNG and what it shows.
struct Picture {
    std::string alt;
    std::string png;  ///< its bytes
};

struct MapPart {
    std::string id, title, note, source;
    std::vector<std::string> rows;  ///< `row_key` of each
    std::string index;  ///< JSON of `MapData::index`
    std::vector<Blob> blobs;
    std::string table;  ///< HTML, see `summary_table`
    Picture sheet;
    bool own_size = true;  ///< the scene's: claims are measured on the same rays
};

/// A sweep, or a file of cases, which has pictures alone.
struct SweepPart {
    std::string id, title, note, source;
    std::vector<std::string> rows;  ///< `row_key` of each
    std::string json;  ///< of `sweep_json`; empty where there is nothing to plot
    std::string table;
    std::vector<Picture> pictures;  ///< shown where scripts or uPlot are missing; always where `json` is empty
};

struct TradePart {
    std::string shape, json, words;
    std::vector<Picture> pictures;
};

struct Report {
    std::string command;  ///< what to type to make the page again
    std::vector<MapPart> maps;
    std::vector<SweepPart> sweeps;
    std::vector<TradePart> trades;
    std::vector<scene::Claim> claims;
    std::vector<ClaimResult> results;
};

/// Forms and formats of a map: decisions, and p50, p99 and max of lost bits; each number carries the CSV's own decimal.
[[nodiscard]] std::string summary_table(const MapRequest& request, const std::vector<MapSummary>& summaries);

/// The page, the same bytes for the same report.
[[nodiscard]] std::string page(const Report& report);

}  // namespace lostbits::output::report
