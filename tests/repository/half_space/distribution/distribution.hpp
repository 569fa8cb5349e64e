// Random rays at half spaces.
#include "scene/rays/aimed_distribution.hpp"

namespace lostbits::scene::half_space {

struct HalfSpaceDistribution : rays::AimedDistribution<HalfSpaceDistribution> {
    static constexpr std::string_view table = "half_space_rays";
    static Primitive<double> draw_primitive(rays::Random& random, const Vec<double>& middle, double size) {
        return HalfSpace<double>{middle, size * rays::draw_direction(random)};
    }
};

}  // namespace lostbits::scene::half_space
