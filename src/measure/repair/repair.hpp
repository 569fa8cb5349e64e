// Finds which operations of a form must be done in wider arithmetic so that it meets a requirement on all rays of a
// scene. Also finds rewritings of the form that are equal in real arithmetic and keep more bits.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "measure/identity/rules.hpp"
#include "measure/repair/probe.hpp"

namespace lostbits::measure::repair {

/// A set of operations to do in wider arithmetic. Without any one of them, the form fails the requirement.
struct WiderSet {
    std::vector<NodeId> operations;  ///< of the form's tape
    FormQuality quality{};
    /// For each operation of the set: the quality if only that operation is not widened. None of these qualities meets
    /// the requirement.
    std::vector<FormQuality> quality_without = {};
    /// No set of this many operations or fewer meets the requirement: all such sets were tried. If
    /// `largest_failing_size` is one less than the size of this set, the set is one of the smallest.
    std::size_t largest_failing_size = 0;
};

/// Starts from all operations done wider, which meets the requirement. Removes one operation after the other, each time
/// the one whose loss costs least, as long as the requirement is met. Then tries all smaller sets, size by size, as
/// long as there are at most `max_sets_per_size` sets of one size.
WiderSet find_smallest_set(const Tape& tape, const FloatFormat& wider, const FormQuality& all_wider_quality,
                           const RepairRequest& request, QualityMeasurer& measurer, std::uint64_t max_sets_per_size);

using identity::Rule;

/// Set of operations done wider that treats x, y and z alike: groups of `find_exchanged_groups`.
struct SymmetricSet {
    std::vector<NodeId> operations;
    FormQuality quality{}, held_out_quality{};      ///< quality on the scene, and on rays that were not searched on
    std::vector<FormQuality> probe_qualities = {};  ///< quality on each probe
    std::size_t group_count = 0, total_group_count = 0;  ///< number of groups in the set, and of all groups
    bool is_smallest = false;  ///< no set of groups with fewer operations passes: all were tried
};

/// A rewritten form, equal to the original in real arithmetic.
struct RewrittenForm {
    Tape tape;
    std::vector<const Rule*> rules;             ///< the rules that were applied, in order
    FormQuality quality{}, held_out_quality{};  ///< quality on the scene, and on rays that were not searched on
    std::size_t rounding_operation_count = 0;   ///< number of operations that round
    /// The fewest operations to do wider, if the form meets the requirement only with them; they are wider in `tape`.
    std::optional<WiderSet> wider_set = {};
    std::vector<FormQuality> probe_qualities = {};  ///< quality on each probe
};

/// Results of the search for rewritten forms.
struct RewritingResult {
    /// Forms that meet the requirement and that no other candidate beats in both accuracy and work (`estimate_work`),
    /// the most accurate first. If no form meets the requirement, the list holds only the most accurate form, and only
    /// if that is more accurate than the original form, or as accurate with less work.
    std::vector<RewrittenForm> forms;
    std::uint64_t tried_count = 0;    ///< candidates tried, each on all rays
    std::uint64_t untried_count = 0;  ///< candidates not tried, because they differ in real arithmetic on some ray
};

/// Limits of the search for rewritten forms.
struct SearchLimit {
    /// Number of rounds; each rewrites the most promising candidates once.
    std::size_t rounds = 8;
    /// Number of candidates that a round rewrites for their accuracy, and again for their little work.
    std::size_t beam_width = 4;
    /// Number of candidates from each form; operations that lose most bits come first.
    std::size_t max_children = 24;
    /// Number of forms in the result.
    std::size_t max_proposals = 3;
};

/// Rewrites the form in rounds. Each round applies the rules to the most accurate forms so far and to those that meet
/// the requirement with least work, and compares the results with the truth on all rays. The search ends when a round
/// finds no new form, or after the last round. A candidate that is not the form in real arithmetic (on a sample of the
/// rays, see `RaySample::have_same_answers`) is dropped.
RewritingResult rewrite(const RepairRequest& request, const Tape& form, const FormQuality& own_quality,
                        QualityMeasurer& measurer, const SearchLimit& limit = {});

/// Estimate of the time of a tape before it is measured: the number of operations that round, with each division and
/// root counted eight times. The estimate orders the search and is not printed.
std::size_t estimate_work(const Tape& tape);

/// Reason why the form does not meet the requirement even with every operation wider: its quality without any rounding.
struct Obstruction {
    /// Quality on some of the rays, each with the primitive that it truly hits, or with the first primitive.
    FormQuality exact{};
    /// For a form that asks for directions of length one: the quality with directions of length one to 53 bits, and the
    /// largest difference of the length of a stored direction from one.
    std::optional<FormQuality> with_unit_directions = {};
    double largest_length_error = 0;
};

struct RepairResult {
    Tape tape;                                       ///< the tape of the form
    FloatFormat wider;                               ///< the arithmetic of the wider operations
    std::size_t rounding_operation_count = 0;        ///< number of operations that round, and so could be done wider
    FormQuality own_quality{}, all_wider_quality{};  ///< quality of the form as it is, and with every operation wider
    /// The operations to widen. Empty if the form already meets the requirement; absent if it fails even with every
    /// operation wider.
    std::optional<WiderSet> wider_set = {};
    /// Other ways of writing the form; none if the form meets the requirement as it is.
    RewritingResult rewriting = {};
    std::uint64_t tried_count = 0;           ///< candidates tried, each on all rays
    scene::file::Scene held_out_scene = {};  ///< the scene in other pixels: rays that were not searched on
    /// Quality of the form and of the set on `held_out_scene`; with files, on all their rays.
    FormQuality own_held_out_quality{}, set_held_out_quality{};
    /// Probes that apply, and the quality there of the form and of the set (without a set, of the form with all
    /// operations wider). Empty if no set and no rewritten form meets the requirement.
    std::vector<const Isometry*> probes = {};
    std::vector<FormQuality> own_probe_qualities = {}, set_probe_qualities = {};
    std::uint64_t probed_ray_count = 0;          ///< number of rays of each probe
    std::optional<SymmetricSet> symmetric = {};  ///< found if the set fails exact probes
    /// Found if the form does not meet the requirement even with all operations wider.
    std::optional<Obstruction> obstruction = {};
};

/// Repairs the form of a request. `max_sets_per_size` limits the search as in `find_smallest_set`. Throws InputError if
/// the operations of the form differ from ray to ray, because one tape cannot then stand for the form.
RepairResult repair_form(const RepairRequest& request, std::uint64_t max_sets_per_size = 600);

/// True if the primitives' matrices are stored as inverses (world to object); false without matrices. Throws InputError
/// as `record_tape` does.
bool are_matrices_inverse(const RepairRequest& request);

/// Records every operation of the request's form, as its primitives are stored. Each way of storing a matrix has a tape
/// of its own, and so has a primitive without a matrix. Throws InputError if the primitives are of several kinds.
Tape record_tape(const RepairRequest& request);

/// Tape of the form with a set of operations done wider.
Tape widen_operations(const RepairResult& repair, const std::vector<NodeId>& operations);

/// Sample of the rays of a request, with the true answers.
class RaySample {
public:
    /// Takes about `ray_count` rays, evenly over the picture or the file. Each ray comes with the primitive that it
    /// truly hits, or with the first one.
    explicit RaySample(const RepairRequest& request, int ray_count = 64);

    /// Counts, for each operation of a tape, the rays of the sample on which it is the culprit.
    [[nodiscard]] std::vector<int> count_culprits(Tape tape) const;

    /// True if two tapes of one form have the same answers on these rays in real arithmetic: both miss, or both hit at
    /// the same t to 45 bits. A ray is not compared if a division by zero leaves either tape undefined. If the form
    /// asks for directions of length one, the directions are turned to an axis, so that their length is exactly one.
    [[nodiscard]] bool have_same_answers(const Tape& a, const Tape& b) const;

    /// Compares the tape without any rounding with the truth of these rays.
    [[nodiscard]] Obstruction compare_without_rounding(const Tape& tape) const;

private:
    /// Right answer of a ray. `t` is correctly rounded to a double; it is the distance for a form that asks for
    /// directions of length one.
    struct CorrectAnswer {
        truth::Truth::Decision decision;
        double t;
        Range<double> range;
    };
    [[nodiscard]] FormQuality measure_exact_quality(const Tape& tape,
                                                    const std::vector<std::vector<double>>& inputs) const;

    evaluate::TestedForm tested_form_;
    Requirement requirement_;
    truth::ProofLimit limit_;
    std::vector<std::vector<double>> inputs_, exact_inputs_;  ///< inputs of each ray, in the order of the tape's inputs
    std::vector<CorrectAnswer> correct_answers_;
};

/// Tape with other inputs and all values that follow from them, rounded to the format or not rounded.
Tape run_with_inputs(Tape tape, const std::vector<double>& inputs, bool rounds);

/// True if the tape divides by zero.
bool divides_by_zero(const Tape& tape);

}  // namespace lostbits::measure::repair
