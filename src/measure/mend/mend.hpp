// Which operations of a form must be done in wider arithmetic so that it meets a wish on all rays of a scene.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
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

/// A set of operations done wider, from which nothing can be taken.
struct WiderSet {
    std::vector<NodeId> operations;  ///< of the form's tape
    Worth worth{};
    std::vector<Worth> without = {};  ///< with each of the operations as it was, the others wider: none meets the wish
    /// No set of so many operations or fewer meets the wish: all were tried. One less than its own size: it is one of
    /// the smallest.
    std::size_t none_of = 0;
};

struct Mended {
    Tape tape;                         ///< of the form
    FloatFormat wider;                 ///< what operations are done in
    std::size_t operations = 0;        ///< that round, and so could be done wider
    Worth own{}, all{};                ///< as it is, and with every operation wider
    std::optional<WiderSet> set = {};  ///< none: with every operation wider it does not meet the wish; empty: it does
                                       ///< as it is
    std::uint64_t tried = 0;           ///< candidates, each on all rays
    scene::file::Scene apart = {};     ///< the scene in other pixels: rays that were not searched on
    Worth own_apart{}, apart_worth{};  ///< of the form and of the set there
};

/// Of two, fewer wrong decisions count before more bits.
bool is_more_accurate(const Worth& a, const Worth& b);

/// From all operations those are taken, one after the other, whose loss costs least while the wish is met, until none
/// can be spared; then all smaller sets are tried as far as there are at most `affordable` of one size.
/// InputError for a form whose operations are not the same for every ray of the scene: held against the form, its tape
/// has other answers.
Mended mend(const MendRequest& request, std::uint64_t affordable = 600);

/// The form with a set of operations done wider.
Tape with_wider(const Mended& mended, const std::vector<NodeId>& operations);

}  // namespace lostbits::measure::mend
