// A sweep over every float of a distance: two rays at a unit sphere, from 0x1.69p10 on.
#pragma once

#include <string>

namespace lostbits::test {

inline std::string every_float_to(const std::string& end) {
    return R"(schema = "lostbits-sweep/1"
title = "A test"
source = "-"

[axis]
name = "distance"
unit = "r"
spacing = "every_float"
set = "ray.origin.z"
from = "0x1.69p10"
to = ")" + end +
           R"("

[[ray]]
name = "beside"
origin = [0.75, 0.75, 0]
direction = [0, 0, -1]

[[ray]]
name = "half"
origin = [0.5, 0.25, 0]
direction = [0, 0, -1]

[sphere]
centre = [0, 0, 0]
radius = 1
)";
}

}  // namespace lostbits::test
