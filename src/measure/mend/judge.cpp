#include "measure/mend/judge.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>
#include <string>

#include "number/error.hpp"

namespace lostbits::measure::mend {

using map::MapRow;
using scene::file::Scene;
using tape::TapeForm;

namespace {

/// Rows of one map: more would only take memory.
constexpr std::size_t at_once = 48;

/// The bits of all answers of a row, in order.
class Bits final : public map::MapSink {
public:
    void band(const map::BandResult& result) override {
        const answer::Answers& a = *result.answers;
        for (std::size_t i = 0; i < a.hit.size(); ++i) {
            add(a.hit[i]);
            if (a.hit[i] != 0) add(std::isnan(a.t[i]) ? 1 : std::bit_cast<std::uint64_t>(a.t[i]));
        }
    }
    friend bool operator==(const Bits& a, const Bits& b) { return a.hash_ == b.hash_; }

private:
    /// FNV-1a, a word at a time.
    void add(std::uint64_t x) { hash_ = (hash_ ^ x) * 0x100000001b3U; }
    std::uint64_t hash_ = 0xcbf29ce484222325U;
};

choice::ChoiceRequest asked(const MendRequest& request, const Scene& scene, std::vector<MapRow> rows) {
    choice::ChoiceRequest choice{.scene = &scene, .rows = std::move(rows), .wish = request.wish};
    choice.limit = request.limit;
    return choice;
}

MapRow row_like(const MapRow& row, const TapeForm& form) {
    return {.form = &form.row(), .format = row.format, .judged = row.judged};
}

}  // namespace

bool is_more_accurate(const Worth& a, const Worth& b) {
    const auto bits = [](const Worth& w) { return std::isnan(w.kept_bits) ? -1 : w.kept_bits; };
    return a.wrong_fraction() != b.wrong_fraction() ? a.wrong_fraction() < b.wrong_fraction() : bits(a) > bits(b);
}

std::vector<Worth> Judge::worth_of(const std::vector<Tape>& tapes) {
    std::vector<Worth> all;
    for (std::size_t begin = 0; begin < tapes.size(); begin += at_once) {
        const std::size_t end = std::min(begin + at_once, tapes.size());
        std::vector<std::unique_ptr<TapeForm>> forms;
        std::vector<MapRow> rows;
        for (std::size_t k = begin; k < end; ++k) {
            forms.push_back(
                std::make_unique<TapeForm>(*request_.row.form, request_.row.format, tapes[k], "candidate", ""));
            rows.push_back(row_like(request_.row, *forms.back()));
        }
        const auto worth = choice::worth_of(asked(request_, scene_, std::move(rows)));
        all.insert(all.end(), worth.begin(), worth.end());
        tried_ += end - begin;
        request_.progress(end - begin);
    }
    return all;
}

Compared compare(const MendRequest& request, const MapRow& one, const MapRow& other) {
    Bits first, second;
    auto both = asked(request, *request.scene, {one, other});
    both.sinks = {&first, &second};
    const auto worth = choice::worth_of(both);
    return {worth.front(), first == second};
}

Worth own_worth(const MendRequest& request, const Tape& tape) {
    const TapeForm form(*request.row.form, request.row.format, tape, "tape", "");
    const Compared both = compare(request, request.row, row_like(request.row, form));
    if (both.same) return both.worth;
    throw InputError(std::string(request.row.form->info->name) +
                     ": its operations are not the same for every ray, since it decides by itself how far to go; name "
                     "a form that does the same to all");
}

}  // namespace lostbits::measure::mend
