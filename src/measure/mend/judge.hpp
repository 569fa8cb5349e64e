// What a wish is, and what tapes are worth to it on all rays of a scene.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "measure/choice/candidates.hpp"
#include "measure/tape/tape_form.hpp"

namespace lostbits::measure::mend {

using choice::Wish;
using choice::Worth;

struct MendRequest {
    const scene::file::Scene* scene = nullptr;
    map::MapRow row;  ///< in f32 or f64
    Wish wish{};
    bool two_words = false;  ///< two floats in place of a double; for double always
    truth::TruthLimit limit{};
    /// Candidates that were tried; may throw to stop.
    std::function<void(std::uint64_t)> progress = [](std::uint64_t) {};
};

/// What tapes are worth on the rays of a scene.
class Judge {
public:
    Judge(const MendRequest& request, const scene::file::Scene& scene) : request_(request), scene_(scene) {}
    /// In the order of the tapes: whole maps, whose truth is that of every map.
    std::vector<Worth> worth_of(const std::vector<Tape>& tapes);
    [[nodiscard]] std::uint64_t tried() const { return tried_; }

private:
    const MendRequest& request_;
    const scene::file::Scene& scene_;
    std::uint64_t tried_ = 0;
};

/// Of two, fewer wrong decisions count before more bits.
bool is_more_accurate(const Worth& a, const Worth& b);

/// The worth of the form itself. InputError where its tape answers otherwise on some ray.
Worth own_worth(const MendRequest& request, const Tape& tape);

/// Whether two rows have the same answers, to the bit, on all rays of the scene.
struct Compared {
    Worth worth;  ///< of the first
    bool same;
};
Compared compare(const MendRequest& request, const map::MapRow& one, const map::MapRow& other);

}  // namespace lostbits::measure::mend
