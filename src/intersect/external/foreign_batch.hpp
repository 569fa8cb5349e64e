// Converts a batch of the table to one for an external form, and its answers back.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>

#include "intersect/external/contract.hpp"

namespace lostbits::intersect::external {

/// Fills the answer buffers with a marker that no form writes, so that a missing answer is seen.
template <class S>
void mark_unwritten(std::span<S> near_far, std::span<std::uint8_t> hit);

/// One answer as the table takes it: the first of the roots that counts, or the contract's answer for a ray from
/// inside. `said` is `hit`; `end` is the end of the ray, for shapes whose forms take it.
template <class S>
Hit<S> hit_of(const Contract& contract, std::uint8_t said, const S* near_far, S end);

class ForeignBatch {
public:
    explicit ForeignBatch(ForeignForm form) : form_(std::move(form)) {}

    /// Asks the form and checks its answers against its contract. EnvironmentError if it leaves an answer out or writes
    /// a `hit` that is neither 1 nor 0; otherwise whatever the form throws.
    void answer(const table::RayBatch<float>& rays, const Target<float>& target, const table::HitBatch<float>& hits);
    void answer(const table::RayBatch<double>& rays, const Target<double>& target, const table::HitBatch<double>& hits);

    [[nodiscard]] const ForeignForm& form() const { return form_; }

private:
    template <class S>
    void answer_in(const table::RayBatch<S>& rays, const Target<S>& target, const table::HitBatch<S>& hits);
    void evaluate(const lb_batch& batch);

    ForeignForm form_;
    std::mutex one_at_a_time_;
};

/// The forms of one name, one or one for each of two formats, as a row of the table. It must not move: the row points
/// into it.
struct ForeignRow {
    Info info = {};
    std::unique_ptr<ForeignBatch> of32 = {}, of64 = {};

    explicit ForeignRow(ForeignForm first);
    ForeignRow(const ForeignRow&) = delete;
    ForeignRow& operator=(const ForeignRow&) = delete;
    /// Adds the same form in the other format. InputError if that is there already, or has another contract.
    void add(ForeignForm other);
    [[nodiscard]] table::Intersector row() const;

private:
    void put(ForeignForm form);
};

}  // namespace lostbits::intersect::external
