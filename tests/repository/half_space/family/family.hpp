// Random rays at half spaces.
#include "scene/rays/aimed_family.hpp"

namespace lostbits::scene::half_space {

struct HalfSpaceFamily : rays::AimedFamily<HalfSpaceFamily> {
    static constexpr std::string_view table = "half_space_family";
    static Solid<double> drawn(rays::Random& random, const Vec<double>& middle, double size) {
        return HalfSpace<double>{middle, size * rays::draw_direction(random)};
    }
};

}  // namespace lostbits::scene::half_space
