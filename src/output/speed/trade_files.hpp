// The files of a trade: trade.csv (time), pareto.csv (time against accuracy), a scatter plot a set of rays, trade.txt (the answer
// in words) and datapackage.json. Times are measured: of all files of the laboratory these alone differ from run to run; their
// columns of accuracy and of operations do not.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "measure/speed/trade.hpp"
#include "output/file/csv.hpp"

namespace lostbits::output {

/// Opened before the work, named when it is whole.
class TradeFiles {
public:
    TradeFiles(const TradeRequest& request, const std::filesystem::path& folder);
    void finish(const TradeResult& result);

private:
    void write_times(const TradeResult& result);
    void write_standings(const TradeResult& result);

    const TradeRequest& request_;
    std::filesystem::path folder_;
    CsvWriter times_, standings_;
};

/// What every kernel is worth on a set of rays, by its time on the standing load.
std::vector<ParetoPoint> pareto_points_of(const TradeRequest& request, const TradeResult& result, std::size_t set);

/// For each set of rays and number of bits: the cheapest that keeps them, or that none does.
std::string trade_in_words(const TradeRequest& request, const TradeResult& result);

}  // namespace lostbits::output
