// Request of a repair, and the quality of tapes on all rays of a scene, or on a sample of the rays of files. Also finds
// the forms of the catalogue to compare a repaired form with, and the ranges in which a repaired form meets the
// requirement.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <variant>
#include <vector>

#include "measure/choose/file_rays.hpp"
#include "measure/choose/margin.hpp"
#include "measure/tape/tape_form.hpp"

namespace lostbits::measure::repair {

using choose::FormQuality;
using choose::Requirement;

struct RepairRequest {
    const scene::file::Scene* scene = nullptr;
    const choose::FileRays* rays = nullptr;  ///< in place of a scene; the search uses their sample
    evaluate::TestedForm tested_form;        ///< in f32 or f64
    Requirement requirement{};
    bool two_words = false;  ///< wider arithmetic is two floats in place of a double; for double always two doubles
    truth::ProofLimit limit{};
    /// Receives the number of candidates just tried; may throw to stop.
    std::function<void(std::uint64_t)> progress = [](std::uint64_t) {};

    /// Quality of tapes on all rays of the files. Set for files only, since files have no other pixels to hold out.
    std::function<std::vector<FormQuality>(const std::vector<Tape>&)> quality_on_all_rays = nullptr;

    /// Name of the results: the id of the scene, or of the files.
    [[nodiscard]] const std::string& id() const;
};

/// Rays that replace those of a request: stored numbers, or ideal rays that each format rounds.
using MovedRays = std::variant<scene::rays::RayGroup, choose::IdealRays>;

/// Measures the quality of tapes on the rays of a request. If there are at most `max_kept_rays` rays, their truth is
/// found once and kept; otherwise it is found again in every call.
class QualityMeasurer {
public:
    explicit QualityMeasurer(const RepairRequest& request) : QualityMeasurer(request, request.scene) {}
    /// Uses the request's row and requirement, but the rays of this scene.
    QualityMeasurer(const RepairRequest& request, const scene::file::Scene& scene) : QualityMeasurer(request, &scene) {}
    /// Uses the request's row and requirement, but these rays.
    QualityMeasurer(const RepairRequest& request, const MovedRays& rays);
    ~QualityMeasurer();
    QualityMeasurer(const QualityMeasurer&) = delete;
    QualityMeasurer& operator=(const QualityMeasurer&) = delete;

    /// Quality of each tape, in the order of the tapes.
    std::vector<FormQuality> measure_quality(const std::vector<Tape>& tapes);
    /// Quality of rows that have the contract and format of the request's row. `show` receives their answers; it may be
    /// empty.
    std::vector<FormQuality> measure_quality(const std::vector<evaluate::TestedForm>& tested_forms,
                                             const evaluate::ShowForms& show = {});
    [[nodiscard]] std::uint64_t rays() const;
    [[nodiscard]] std::uint64_t tried_count() const { return tried_count_; }

    static constexpr std::uint64_t max_kept_rays = 1U << 19;

private:
    class Part;
    QualityMeasurer(const RepairRequest& request, const scene::file::Scene* scene);
    std::vector<FormQuality> measure_quality(const std::vector<evaluate::TestedForm>& tested_forms,
                                             const evaluate::ShowForms& show,
                                             const std::vector<std::unique_ptr<tape::TapeForm>>& tapes);
    void for_each_part(const std::function<void(const Part&)>& action);

    const RepairRequest& request_;
    const scene::file::Scene* scene_;
    std::unique_ptr<culling::Culler> culler_;
    std::vector<std::unique_ptr<Part>> parts_;
    std::uint64_t tried_count_ = 0;
};

/// True if `a` has fewer wrong decisions than `b`, or as many and more bits.
bool is_more_accurate(const FormQuality& a, const FormQuality& b);

/// Quality of the form itself. Throws InputError if its tape answers differently on some ray.
FormQuality measure_own_quality(const RepairRequest& request, const Tape& tape, QualityMeasurer& measurer);

/// True if a form with the contract of the request's form has the same answers as a tape, to the bit, on all rays of
/// the request.
bool has_answers_of_tape(const evaluate::TestedForm& form, const Tape& tape, const RepairRequest& request,
                         QualityMeasurer& measurer);

/// All forms of the catalogue for the same primitives and format. With transforms, every form is combined with the
/// transform method of the row, and the form itself with all methods.
std::vector<evaluate::TestedForm> list_comparable_forms(const evaluate::TestedForm& tested_form);

/// Form of the catalogue with its quality.
struct FormWithQuality {
    evaluate::TestedForm tested_form;
    FormQuality quality;
};
/// The forms of `list_comparable_forms` with their quality on the request's rays, the most accurate first.
std::vector<FormWithQuality> rank_catalogue(const RepairRequest& request);

/// Largest number of rays on which `find_margins_of_tape` and probes measure.
inline constexpr int few_rays_count = 4096;

/// Ranges in which the requirement holds for a form that has the contract of the request's form and the operations of
/// the tape.
std::vector<choose::GrowthMargin> find_margins_of_tape(const RepairRequest& request, const Tape& tape);

}  // namespace lostbits::measure::repair
