// Converts a batch of the table to a batch for an external form, and converts its answers back.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>

#include "intersect/external/contract.hpp"

namespace lostbits::intersect::external {

/// Fills the answer buffers with values that no form writes, so that a missing answer is detected.
template <class S>
void mark_unwritten(std::span<S> near_far, std::span<std::uint8_t> hit);

/// Applies the contract of a form to one answer: decides if it is a hit, and which t the table stores. t is the first
/// of the roots that counts, or the contract's answer for a ray from inside. `hit_byte` is the form's `hit`; `end` is
/// the end of the ray, for shapes whose forms take tmax.
template <class S>
Hit<S> apply_contract(const Contract& contract, std::uint8_t hit_byte, const S* near_far, S end);

class ForeignBatch {
public:
    explicit ForeignBatch(ForeignForm form) : form_(std::move(form)) {}

    /// Calls the form and checks its answers against its contract. Throws EnvironmentError if the form leaves an answer
    /// out or writes a `hit` that is neither 1 nor 0; otherwise whatever the form throws.
    void answer(const table::RayBatch<float>& rays, const Target<float>& target, const table::HitBatch<float>& hits);
    void answer(const table::RayBatch<double>& rays, const Target<double>& target, const table::HitBatch<double>& hits);

    [[nodiscard]] const ForeignForm& form() const { return form_; }

private:
    template <class S>
    void answer_in_format(const table::RayBatch<S>& rays, const Target<S>& target, const table::HitBatch<S>& hits);
    void evaluate(const lb_batch& batch);

    ForeignForm form_;
    std::mutex one_at_a_time_;
};

/// The forms of one name, in one format or in both, in the table of intersectors. A `ForeignIntersector` must not move
/// in memory, since the form points into it.
struct ForeignIntersector {
    Info info = {};
    std::unique_ptr<ForeignBatch> batch32 = {}, batch64 = {};

    explicit ForeignIntersector(ForeignForm first);
    ForeignIntersector(const ForeignIntersector&) = delete;
    ForeignIntersector& operator=(const ForeignIntersector&) = delete;
    /// Adds the same form in the other format. Throws InputError if there is already a form in that format, or if its
    /// contract differs.
    void add(ForeignForm other);
    [[nodiscard]] table::Intersector to_intersector() const;

private:
    void store(ForeignForm form);
};

}  // namespace lostbits::intersect::external
