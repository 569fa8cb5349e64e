// Forms composed of other forms at run time. Each form is created once and kept.
#pragma once

#include <algorithm>
#include <deque>
#include <mutex>
#include <string>

#include "intersect/table/table.hpp"

namespace lostbits::intersect::table {

/// The forms by their parts, a tuple of pointers. Forms do not move in memory. Several threads may call the functions.
template <class Parts>
class ComposedForms {
public:
    struct ComposedForm {
        Parts parts;
        std::string name, title, source;
        Info info;
        Intersector intersector;

        /// Copies the contract, but keeps this form's own name, title and source.
        void copy_contract(const Info& contract) {
            info = contract;
            info.name = name;
            info.title = title;
            info.source = source;
        }
    };

    /// Returns the form with these parts. If it is new, calls `fill(ComposedForm&)` after `parts` is set.
    template <class Fill>
    const Intersector& find_or_add(const Parts& parts, const Fill& fill) {
        const std::lock_guard lock(mutex_);
        const auto found = std::ranges::find(forms_, parts, &ComposedForm::parts);
        if (found != forms_.end()) return found->intersector;
        ComposedForm& composed = forms_.emplace_back();
        composed.parts = parts;
        fill(composed);
        return composed.intersector;
    }
    /// The parts of a form; null pointers if this object did not create the form.
    Parts find_parts(const Intersector& form) {
        const std::lock_guard lock(mutex_);
        const auto found = std::ranges::find_if(
            forms_, [&form](const ComposedForm& composed) { return &composed.intersector == &form; });
        return found == forms_.end() ? Parts{} : found->parts;
    }

private:
    std::mutex mutex_;
    std::deque<ComposedForm> forms_;
};

}  // namespace lostbits::intersect::table
