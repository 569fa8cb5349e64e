// The culprits of a picture, most frequent first: colours go by their place.
#pragma once

#include "measure/map/map.hpp"

namespace lostbits::measure::map {

/// Replaces `culprit` among the request's metrics by one whose categories stand in the order of how often they are to
/// blame over all rows of a small picture of the scene (at most 96 rays across); what does not occur there comes after,
/// in the order of the tapes. The same for any number of threads.
void order_culprits(MapRequest& request);

}  // namespace lostbits::measure::map
