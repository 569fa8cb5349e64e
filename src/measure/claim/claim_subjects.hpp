// Claims about one subject are measured together.
#pragma once

#include <algorithm>
#include <filesystem>
#include <vector>

#include "measure/claim/claim.hpp"
#include "number/error.hpp"
#include "scene/toml/did_you_mean.hpp"

namespace lostbits::measure::claim {

/// The place of a word in a list of names; the claim says what is wrong with it.
template <class Names>
std::size_t place_of_word(const scene::claim::Claim& claim, const char* what, const std::string& word,
                          const Names& names) {
    const auto found = std::ranges::find(names, word);
    if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
    scene::toml::fail(claim.where, "unknown " + std::string(what) + " \"" + word + "\"; " +
                                       scene::toml::did_you_mean(word, {names.begin(), names.end()}));
}

/// The claims about one scene or sweep: their places in the list.
using Places = std::vector<std::size_t>;

/// The claims at these places, each into its place of `results`: about a scene, a rendered scene, the respawned rays of
/// one, its questions put in two ways, a sweep along axes or over cases, a table. `draw`: how many seeds after the
/// subject's own.
void measure_scene(const std::vector<scene::claim::Claim>& claims, const Places& places, const ClaimRequest& run,
                   std::vector<ClaimResult>& results);
void measure_render(const std::vector<scene::claim::Claim>& claims, const Places& places, const ClaimRequest& run,
                    std::vector<ClaimResult>& results);
void measure_offsets(const std::vector<scene::claim::Claim>& claims, const Places& places, const ClaimRequest& run,
                     std::vector<ClaimResult>& results);
void measure_consistency(const std::vector<scene::claim::Claim>& claims, const Places& places, const ClaimRequest& run,
                         std::vector<ClaimResult>& results);
void measure_sweep(const std::vector<scene::claim::Claim>& claims, const Places& places, const ClaimRequest& run,
                   int draw, std::vector<ClaimResult>& results);
/// About a sweep over every float.
void measure_exhaustive(const std::vector<scene::claim::Claim>& claims, const Places& places,
                        const std::filesystem::path& path, const ClaimRequest& run, std::vector<ClaimResult>& results);
/// About the worst ray that a search finds.
void measure_search(const std::vector<scene::claim::Claim>& claims, const Places& places, const ClaimRequest& run,
                    std::vector<ClaimResult>& results);
/// About what mending makes of a form.
void measure_mend(const std::vector<scene::claim::Claim>& claims, const Places& places, const ClaimRequest& run,
                  std::vector<ClaimResult>& results);
void measure_table(const std::vector<scene::claim::Claim>& claims, const Places& places, const ClaimRequest& run,
                   int draw, std::vector<ClaimResult>& results);

/// The one scene of that name; the claim says what is wrong with it.
scene::file::Scene one_scene(const scene::claim::Claim& claim, const std::string& called, const ClaimRequest& run);

/// What becomes of a claim that measures so; `summary` (may be null) is what the number was taken from.
ClaimResult judge(const scene::claim::Claim& claim, double measured, const map::MapSummary* summary);

/// The format of a claim. InputError for an unknown name.
Format claim_format(const scene::claim::Claim& claim);

/// The rows of several claims, each once: its place.
inline std::size_t place_or_added(std::vector<map::MapRow>& rows, const map::MapRow& row) {
    const auto found = std::ranges::find(rows, row);
    if (found != rows.end()) return static_cast<std::size_t>(found - rows.begin());
    rows.push_back(row);
    return rows.size() - 1;
}

inline std::vector<scene::claim::Claim> claims_at(const std::vector<scene::claim::Claim>& claims,
                                                  const Places& places) {
    std::vector<scene::claim::Claim> some;
    for (const std::size_t i : places) some.push_back(claims[i]);
    return some;
}

/// The form and format of a claim about a scene or sweep that the form can be asked about.
template <class Subject>
map::MapRow row_for(const scene::claim::Claim& claim, const Subject& subject) {
    const map::MapRow row = claim_row(claim);
    if (subject.meets(row.form->shapes())) return row;
    scene::toml::fail(claim.where, claim.subject() + " is not handled by " + claim.form + ": it has " +
                                       (!is_solid(row.form->shape) ? "no [march] table" : "other solids") +
                                       "; name another form, or another scene or sweep");
}

/// What `find` finds for a claim; an unknown name is the claim's fault, so its place starts the message.
template <class Find>
auto find_or_blame_claim(const scene::claim::Claim& claim, const Find& find) {
    try {
        return find();
    } catch (const InputError& error) {
        scene::toml::fail(claim.where, error.what());
    }
}

}  // namespace lostbits::measure::claim
