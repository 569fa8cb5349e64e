#include <string_view>

#include "by_hand.hpp"
#include "intersect/simd/packed.hpp"
#include "measure/trade/timing_work.hpp"
#include "ratios.hpp"

namespace bench {
namespace {

using namespace lostbits;
using measure::trade::RayWork;

constexpr std::string_view sizes[] = {"l1", "l2", "memory"};

std::size_t bytes_of(std::string_view size) {
    return measure::trade::working_set_bytes(size, measure::trade::read_cache_sizes());
}

/// Bytes per ray: six numbers are read, three numbers and a byte are written.
template <class S>
constexpr double bytes_a_ray = 9 * sizeof(S) + 1;

#if defined(LOSTBITS_BY_HAND)
/// The hand-written loop of a form, or null if the form has no such loop.
template <class S>
by_hand::OnePrimitive<S> loop_of(const by_hand::Loops<S>& loops, std::string_view form) {
    if (form == "sphere.schoolbook") return loops.schoolbook;
    if (form == "sphere.unified") return loops.unified;
    if (form == "triangle.moller_trumbore") return loops.moller_trumbore;
    if (form == "triangle.undivided") return loops.undivided;
    return form == "triangle.woop" ? loops.woop : nullptr;
}

template <class S>
void add_by_hand(std::vector<Contestant>& all, const std::string& name,
                 const std::shared_ptr<measure::trade::RayStore<S>>& store, by_hand::OnePrimitive<S> loop, bool warm) {
    if (!loop) return;
    const auto kernel = [loop](const intersect::table::RayBatch<S>& rays, const Primitive<S>& primitive,
                               const intersect::table::HitBatch<S>& hits) {
        const S* const in[] = {rays.ox.data(), rays.oy.data(), rays.oz.data(),
                               rays.dx.data(), rays.dy.data(), rays.dz.data()};
        S* const out[] = {hits.t.data(), hits.near.data(), hits.far.data()};
        loop(in, primitive.numbers.data(), out, hits.hit.data(), rays.size());
    };
    all.push_back({name, "", bytes_a_ray<S>, {[store, kernel] { store->run(kernel); }, store->rays_per_run(), warm}});
}

void add_by_hand(std::vector<Contestant>& all, RayWork& work, Shape shape, const std::string& form,
                 intersect::simd::Isa isa, bool warm) {
    if (isa != intersect::simd::Isa::w256 && isa != intersect::simd::Isa::w512) return;
    const by_hand::Width loops = isa == intersect::simd::Isa::w256 ? by_hand::width_256() : by_hand::width_512();
    const std::string name = std::string(name_of(isa)) + "/by hand, " + form;
    add_by_hand(all, name + "/f32", work.f32(shape), loop_of(loops.f32, form), warm);
    add_by_hand(all, name + "/f64", work.f64(shape), loop_of(loops.f64, form), warm);
}
#else
void add_by_hand(std::vector<Contestant>&, RayWork&, Shape, const std::string&, intersect::simd::Isa, bool) {}
#endif

}  // namespace

void print_rays(Shape shape, const std::vector<std::string>& forms) {
    for (const std::string_view size : sizes) {
        std::vector<Contestant> all;
        RayWork work(bytes_of(size));
        for (const intersect::simd::Isa isa : intersect::simd::available_isas())
            for (const std::string& form : forms) {
                const std::string kernel(name_of(isa));
                for (const std::string format : {"f32", "f64"})
                    if (auto w = work.work_for({form, kernel, format}))
                        all.push_back({kernel + "/" + form + "/" + format, kernel + "/by hand, " + form + "/" + format,
                                       format == "f32" ? bytes_a_ray<float> : bytes_a_ray<double>, std::move(*w)});
                add_by_hand(all, work, shape, form, isa, measure::trade::fits_in_cache(bytes_of(size)));
            }
        print_ratios(std::string(size), std::move(all), bytes_of(size));
    }
    const std::string widest(name_of(intersect::simd::best_isa())), &last = forms.back();
    for (const std::string_view size : sizes)
        print_speedup(widest + "/" + last + "/f32", std::string(size), [&](std::size_t) {
            return RayWork(bytes_of(size)).work_for({last, widest, "f32"})->pass;
        });
}

}  // namespace bench
