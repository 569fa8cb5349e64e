#include "intersect/table/rows.hpp"
#include "number/rounded.hpp"

namespace lostbits::intersect::table {
namespace {

template <class Form>
void rounded_batch(const FloatFormat& format, const RayBatch<double>& rays, const Target<double>& target,
                   const HitBatch<double>& hits) {
    const CurrentFormat::Scope scope(format);
    intersect_batch<Form, RoundedAny>(
        rays, target, hits, [](double x) { return RoundedAny(x); }, [](RoundedAny x) { return x.value(); });
}

}  // namespace

void fill_rounded(std::span<Intersector> rows) {
    std::size_t i = 0;
    for_each_form([&]<class Form>() {
        if constexpr (Form::info.formats == Formats::all) rows[i].rounded = rounded_batch<Form>;
        ++i;
    });
}

}  // namespace lostbits::intersect::table
