// A mended form in words: what is done wider, what that keeps, that nothing can be taken from it, and how far it holds.
#pragma once

#include <string>
#include <vector>

#include "measure/mend/mend.hpp"
#include "measure/mend/price.hpp"

namespace lostbits::output::mend {

/// All that is known of a mended form.
struct MendResult {
    const measure::mend::MendRequest& request;
    const measure::mend::Mended& mended;
    /// The forms of the catalogue for the same solids in the same format, most accurate first, and what they are worth.
    std::vector<measure::evaluate::TestedForm> catalogue;
    std::vector<measure::mend::Worth> catalogue_worth;
    std::vector<measure::choice::Room> rooms = {};  ///< of the form with its set
    /// Of each way of writing it; empty of one that fails the wish.
    std::vector<std::vector<measure::choice::Room>> rewritten_rooms = {};
    /// The form, the set if there is one, each way of writing it, the catalogue; empty where nothing was timed.
    std::vector<measure::mend::Price> prices = {};
    std::string no_price = {};  ///< why nothing was timed although it was asked for

    [[nodiscard]] bool has_set() const { return mended.set && !mended.set->operations.empty(); }
};

/// What was found, the catalogue beside it and how far all of it holds; without prices.
MendResult result_of(const measure::mend::MendRequest& request, const measure::mend::Mended& mended);

/// A form that came out: the set, or a way of writing it.
struct Proposal {
    Tape tape;
    const measure::mend::Worth* worth;
    const measure::mend::Rewritten* rewritten;    ///< null: the set
    const measure::mend::Price* price = nullptr;  ///< null: it was not timed
};
/// The set first, if there is one.
std::vector<Proposal> proposals_of(const MendResult& result);
/// The one to take: of those that meet the wish the fastest in packs; where nothing was timed a way of writing it, the
/// one with fewest operations, before the set. Null where none does.
const Proposal* best_of(const std::vector<Proposal>& proposals, const measure::choice::Wish& wish);
/// `cross products, stable roots`
std::string rules_of(const measure::mend::Rewritten& rewritten);
/// `3 of its 15 operations in double`, `written another way: cross products`
std::string how_in_words(const MendResult& result, const Proposal& proposal);
/// The names of what the set does wider: `c, disc`.
std::string names_of_set(const MendResult& result);

/// `double`, `two floats`, `two doubles`.
std::string name_of_wider(const FloatFormat& wider);
/// `c = dot(o - centre, o - centre) - radius*radius`: an operation of the form's tape as the source has it.
std::string operation_in_words(const MendResult& result, NodeId operation);
/// The statements of the form that change, as a diff has them.
std::vector<std::string> changed_lines(const MendResult& result, const Tape& now);
/// The answer, several lines.
std::string in_words(const MendResult& result);

}  // namespace lostbits::output::mend
