#include "measure/blame/neighbours.hpp"

#include <cmath>
#include <cstdint>

#include "measure/blame/operation_error.hpp"

namespace lostbits::measure::blame {

namespace {

/// -1, 0 or 1, the same in every run: Knuth's generator (MMIX), whose high bits are the good ones.
class Moves {
public:
    int next() {
        state_ = state_ * 6364136223846793005u + 1442695040888963407u;
        return static_cast<int>((state_ >> 33) % 3) - 1;
    }

private:
    std::uint64_t state_ = 1;
};

double moved(double x, int ulps, const FloatFormat& format) {
    return x == 0 || !std::isfinite(x) ? x : x + ulps * ulp_at(x, format);
}

}  // namespace

std::vector<answer::OneRay> neighbours_of(const answer::OneRay& ray, const answer::OneRay::Inputs& in,
                                          const FloatFormat& format, const std::vector<Solid<double>>& solids) {
    std::vector<answer::OneRay> all;
    Moves moves;
    const Ray<double> middle = in.all.rays[in.index];
    for (int k = 0; k < neighbours; ++k) {
        Ray<double> beside = middle;
        for (Vec<double>* const v : {&beside.origin, &beside.direction}) {
            for (double* const x : {&v->x, &v->y, &v->z}) *x = moved(*x, moves.next(), format);
        }
        scene::rays::RayGroup group = scene::rays::group_of(beside);
        group.rays.push_range(in.all.rays, in.index);
        group.solids = solids;
        group.march = in.all.march;
        all.emplace_back(std::move(group)).judge_by(ray.judged());
    }
    return all;
}

}  // namespace lostbits::measure::blame
