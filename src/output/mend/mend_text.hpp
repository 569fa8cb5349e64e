// A mended form in words: what is done wider, what that keeps, that nothing can be taken from it, and how far it holds.
#pragma once

#include <string>
#include <vector>

#include "measure/choice/room.hpp"
#include "measure/mend/mend.hpp"

namespace lostbits::output::mend {

/// All that is known of a mended form.
struct MendResult {
    const measure::mend::MendRequest& request;
    const measure::mend::Mended& mended;
    /// The forms of the catalogue for the same solids in the same format, most accurate first, and what they are worth.
    std::vector<measure::map::MapRow> catalogue;
    std::vector<measure::mend::Worth> catalogue_worth;
    std::vector<measure::choice::Room> rooms = {};  ///< of the mended form
};

/// `double`, `two floats`, `two doubles`.
std::string name_of_wider(const FloatFormat& wider);
/// `c = dot(o - centre, o - centre) - radius*radius`: an operation of the form's tape as the source has it.
std::string operation_in_words(const MendResult& result, NodeId operation);
/// The statements of the form that change, as a diff has them; none where nothing does.
std::vector<std::string> changed_lines(const MendResult& result);
/// The answer, several lines.
std::string in_words(const MendResult& result);

}  // namespace lostbits::output::mend
