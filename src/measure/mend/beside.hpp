// What stands beside a mended form: the catalogue's forms for the same solids, and how far it holds.
#pragma once

#include <vector>

#include "measure/choice/room.hpp"
#include "measure/mend/judge.hpp"

namespace lostbits::measure::mend {

/// All forms of the catalogue for the same solids and format; of solids under matrices through the same space, and the
/// form itself through all.
std::vector<evaluate::TestedForm> catalogue_beside(const evaluate::TestedForm& row);

struct Ranked {
    evaluate::TestedForm row;
    Worth worth;
};
/// These with what they are worth on the request's rays, the most accurate first.
std::vector<Ranked> ranked_catalogue(const MendRequest& request);

/// How far a form with the contract of the request's holds that does what the tape does.
std::vector<choice::Room> rooms_of_tape(const MendRequest& request, const Tape& tape);

}  // namespace lostbits::measure::mend
