// Claims about speed: quotients of rates within one run.
#include <algorithm>

#include "measure/claim/claim_subjects.hpp"
#include "measure/speed/timing.hpp"
#include "measure/speed/timing_work.hpp"

namespace lostbits::measure::claim {

using speed::TimedKernel;
using speed::TimedWork;

namespace {

using scene::claim::Claim;
using scene::claim::TimingSubject;
using Works = std::vector<std::optional<TimedWork>>;

template <class Work>
Works on_all(std::span<const TimedKernel> kernels, std::size_t bytes) {
    Work work(bytes);
    Works all;
    for (const TimedKernel& k : kernels) all.push_back(work.on(k));
    return all;
}

constexpr std::pair<std::string_view, Works (*)(std::span<const TimedKernel>, std::size_t)> works[] = {
    {"one_ray_many_boxes", on_all<speed::BoxWork>}, {"many_rays_one_solid", on_all<speed::RayWork>}};

/// A work for each kernel, on the same data.
std::vector<TimedWork> make_work(const Claim& claim, const std::vector<TimedKernel>& kernels, std::size_t bytes) {
    const std::string& called = claim.subject_name();
    const auto named = std::ranges::find(works, called, [](const auto& each) { return each.first; });
    if (named == std::end(works))
        scene::toml::fail(claim.where,
                          "unknown work \"" + called + "\"; there are one_ray_many_boxes and many_rays_one_solid");
    std::vector<TimedWork> all;
    auto made = named->second(kernels, bytes);
    for (std::size_t i = 0; i < made.size(); ++i) {
        if (!made[i])
            scene::toml::fail(claim.where,
                              "no form \"" + std::string(kernels[i].form) + "\" in the kernel \"" +
                                  std::string(kernels[i].kernel) + "\" for " + called + " in " + claim.format +
                                  "; kernels are scalar, 128, 256 and 512, and plain-256 and plain-structs-256 for "
                                  "boxes in f32; `lostbits list forms` has the forms");
        all.push_back(std::move(*made[i]));
    }
    return all;
}

/// The median over interleaved repetitions of (seconds an item of `over`)/(seconds an item of the kernel).
double speed_ratio(const Claim& claim, const TimingSubject& t, std::size_t bytes, intersect::process::StopToken stop) {
    const auto work =
        make_work(claim, {{t.over_form, t.over_kernel, claim.format}, {claim.form, t.kernel, claim.format}}, bytes);
    const auto samples = speed::sample_interleaved(
        work, {.repetitions = speed::stay_in_cache(bytes) ? 101 : 15, .least_seconds = 1e-3, .stop = stop});
    return speed::ratio_of(samples[0], samples[1]).median;
}

/// The median of (rate of all allowed processors)/(rate of one · their number); 1 is perfect.
double speedup_per_processor(const Claim& claim, const TimingSubject& t, std::size_t bytes,
                             intersect::process::StopToken stop) {
    const auto work = [&](std::size_t) {
        return make_work(claim, {{claim.form, t.kernel, claim.format}}, bytes).front().pass;
    };
    return speed::timing_of(speed::thread_speedups(work, {.stop = stop})).median /
           static_cast<double>(speed::allowed_processors().size());
}

}  // namespace

void measure(const ClaimsOn<TimingSubject>& claims, const ClaimRequest& run) {
    for (const auto& [claim, t, result] : claims) {
        const std::size_t bytes = speed::working_set_bytes(t.data, speed::cache_sizes());
        if (bytes == 0) scene::toml::fail(claim.where, "unknown data \"" + t.data + "\"; there are l1, l2 and memory");
        const std::string_view metric = t.all_processors ? "speedup_per_processor" : "speed_ratio";
        if (claim.metric != metric)
            scene::toml::fail(claim.where,
                              "unknown metric \"" + claim.metric + "\"; here it is " + std::string(metric));
        const auto measured = t.all_processors ? speedup_per_processor : speed_ratio;
        result = judge(claim, measured(claim, t, bytes, run.stop), nullptr);
    }
}

}  // namespace lostbits::measure::claim
