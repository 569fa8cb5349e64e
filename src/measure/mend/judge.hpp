// What a wish is, what tapes are worth to it on all rays of a scene, or on those kept of files, and what stands beside
// a mended form: the catalogue's forms for the same solids, and how far it holds.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "measure/choice/file_rays.hpp"
#include "measure/choice/room.hpp"
#include "measure/tape/tape_form.hpp"

namespace lostbits::measure::mend {

using choice::Wish;
using choice::Worth;

struct MendRequest {
    const scene::file::Scene* scene = nullptr;
    const choice::FileRays* rays = nullptr;  ///< in place of a scene: what is searched on is their sample
    evaluate::TestedForm row;                ///< in f32 or f64
    Wish wish{};
    bool two_words = false;  ///< two floats in place of a double; for double always
    truth::TruthLimit limit{};
    /// Candidates that were tried; may throw to stop.
    std::function<void(std::uint64_t)> progress = [](std::uint64_t) {};

    /// Of files, whose rays are in no other pixels: what tapes are worth on all of them.
    std::function<std::vector<Worth>(const std::vector<Tape>&)> on_all = nullptr;

    /// Of the scene, or of the files: what results are called.
    [[nodiscard]] const std::string& id() const;
};

/// What tapes are worth on the rays of a request. The truth of at most `most_kept` rays is found once and kept; of more
/// it is found again for every call.
class Judge {
public:
    explicit Judge(const MendRequest& request) : Judge(request, request.scene) {}
    /// Of the request's row and wish, but on the rays of this scene.
    Judge(const MendRequest& request, const scene::file::Scene& scene) : Judge(request, &scene) {}
    ~Judge();
    Judge(const Judge&) = delete;
    Judge& operator=(const Judge&) = delete;

    /// In the order of the tapes.
    std::vector<Worth> worth_of(const std::vector<Tape>& tapes);
    /// Of rows with the contract and format of the request's; `shows`, none or as many, are shown what they answer.
    std::vector<Worth> worth_of(const std::vector<evaluate::TestedForm>& rows,
                                const std::vector<evaluate::Show>& shows = {});
    [[nodiscard]] std::uint64_t rays() const;
    [[nodiscard]] std::uint64_t tried() const { return tried_; }

    static constexpr std::uint64_t most_kept = 1U << 19;

private:
    class Part;
    Judge(const MendRequest& request, const scene::file::Scene* scene);
    [[nodiscard]] std::vector<int> bands() const;
    std::vector<Worth> worth_of(const std::vector<evaluate::TestedForm>& rows, const std::vector<evaluate::Show>& shows,
                                const std::vector<std::unique_ptr<tape::TapeForm>>& tapes);
    void each_part(const std::function<void(const Part&)>& act);

    const MendRequest& request_;
    const scene::file::Scene* scene_;
    std::unique_ptr<culling::Culler> culler_;
    std::vector<std::unique_ptr<Part>> kept_;
    std::uint64_t tried_ = 0;
};

/// Of two, fewer wrong decisions count before more bits.
bool is_more_accurate(const Worth& a, const Worth& b);

/// The worth of the form itself. InputError where its tape answers otherwise on some ray.
Worth own_worth(const MendRequest& request, const Tape& tape, Judge& judge);

/// Whether a form with the contract of the request's answers on all its rays as a tape does, to the bit.
bool answers_as(const evaluate::TestedForm& form, const Tape& tape, const MendRequest& request, Judge& judge);

/// All forms of the catalogue for the same solids and format; of solids under matrices through the same space, and the
/// form itself through all.
std::vector<evaluate::TestedForm> catalogue_beside(const evaluate::TestedForm& row);

struct Ranked {
    evaluate::TestedForm row;
    Worth worth;
};
/// These with what they are worth on the request's rays, the most accurate first.
std::vector<Ranked> ranked_catalogue(const MendRequest& request);

/// How far a form with the contract of the request's holds that does what the tape does.
std::vector<choice::Room> rooms_of_tape(const MendRequest& request, const Tape& tape);

}  // namespace lostbits::measure::mend
