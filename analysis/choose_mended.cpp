#include "analysis/choose_mended.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <set>
#include <utility>

#include "number/error.hpp"
#include "output/file/atomic_file.hpp"
#include "output/mend/form_code.hpp"
#include "output/mend/mend_files.hpp"

namespace lostbits::analysis {

using measure::choice::ChoiceRequest;
using measure::map::MapRow;
using measure::mend::Mended;
using measure::mend::MendRequest;
using measure::mend::Worth;
using output::mend::MendResult;
using output::mend::Proposal;

namespace {

/// Forms mended one after the other; what came out stays where it is.
class Bench {
public:
    Bench(const ChoiceRequest& asked, std::string command) : asked_(asked), command_(std::move(command)) {}

    void mend_all() {
        ChoiceRequest quiet = asked_;
        quiet.progress = [](std::uint64_t) {};
        const auto worth = worth_of(quiet);
        for (std::size_t r = 0; r < asked_.rows.size(); ++r)
            if (!worth[r].meets(asked_.wish)) mend_one(asked_.rows[r]);
    }

    std::vector<measure::mend::Written> written = {};
    std::vector<output::choice::MendedCandidate> candidates = {};

private:
    void mend_one(const MapRow& row) {
        requests_.push_back({.scene = asked_.scene, .row = row, .wish = asked_.wish, .limit = asked_.limit});
        try {
            // The sets' minimality is not proved beyond the search: no smaller sets are tried.
            mended_.push_back(measure::mend::mend(requests_.back(), 0));
        } catch (const InputError&) {
            return;  // its operations are not seen, or are not the same for every ray
        }
        const MendResult result{
            .request = requests_.back(), .mended = mended_.back(), .catalogue = {}, .catalogue_worth = {}};
        proposals_.push_back(proposals_of(result));
        int count = 0;
        for (const Proposal& one : proposals_.back())
            if (one.worth->meets(asked_.wish) && is_new(one, row)) add(result, one, ++count);
    }

    bool is_new(const Proposal& proposal, const MapRow& row) {
        const auto lines = output::mend::statements(proposal.tape, *row.form);
        return seen_
            .insert(fmt::format("{} {} {}", static_cast<int>(row.form->shape), row.format.name, fmt::join(lines, "\n")))
            .second;
    }

    void add(const MendResult& result, const Proposal& proposal, int count) {
        const MapRow& row = result.request.row;
        std::string name(row.form->info->name);
        std::ranges::replace(name, '.', '_');
        name += fmt::format("_{}{}", row.format.name == "f32" ? "" : row.format.name + "_", count);
        written.push_back(output::mend::written(result, proposal, name, command_));
        std::string how = fmt::format("{}, {}", row.form->info->name, how_in_words(result, proposal));
        if (!proposal.rewritten) how += ": " + names_of_set(result);
        candidates.push_back({"mended." + name, std::move(how),
                              proposal.rewritten ? proposal.rewritten->apart : result.mended.apart_worth,
                              name + ".hpp"});
    }

    const ChoiceRequest& asked_;
    std::string command_;
    std::deque<MendRequest> requests_;
    std::deque<Mended> mended_;
    std::deque<std::vector<Proposal>> proposals_;
    std::set<std::string> seen_;
};

}  // namespace

Mending mended(const ChoiceRequest& request, const measure::mend::Workshop& workshop,
               const std::filesystem::path& folder, const std::string& command) {
    Bench bench(request, command);
    bench.mend_all();
    Mending all;
    if (bench.written.empty()) return all;
    auto formulas = compiled({.scene = request.scene, .row = {}, .limit = request.limit}, bench.written, workshop);
    for (std::size_t k = 0; k < formulas.size(); ++k) {
        auto& candidate = bench.candidates[k];
        const auto file = folder / candidate.file;
        output::file::AtomicFile header(file);
        header.write(bench.written[k].header);
        header.commit();
        candidate.file = file.string();
        all.made.push_back({std::move(formulas[k]), bench.written[k].from.format});
    }
    all.candidates = std::move(bench.candidates);
    return all;
}

}  // namespace lostbits::analysis
