// Rows composed of other rows at run time. Each row is created once and kept.
#pragma once

#include <algorithm>
#include <deque>
#include <mutex>
#include <string>

#include "intersect/table/table.hpp"

namespace lostbits::intersect::table {

/// The rows by their parts, a tuple of pointers. Rows do not move in memory. Several threads may call the functions.
template <class Parts>
class ComposedForms {
public:
    struct ComposedRow {
        Parts parts;
        std::string name, title, source;
        Info info;
        Intersector row;

        /// Copies the contract, but keeps this row's own name, title and source.
        void copy_contract(const Info& contract) {
            info = contract;
            info.name = name;
            info.title = title;
            info.source = source;
        }
    };

    /// Returns the row with these parts. If it is new, calls `fill(ComposedRow&)` after `parts` is set.
    template <class Fill>
    const Intersector& row_of(const Parts& parts, const Fill& fill) {
        const std::lock_guard lock(mutex_);
        const auto found = std::ranges::find(rows_, parts, &ComposedRow::parts);
        if (found != rows_.end()) return found->row;
        ComposedRow& composed = rows_.emplace_back();
        composed.parts = parts;
        fill(composed);
        return composed.row;
    }
    /// The parts of a row; null pointers if this object did not create the row.
    Parts parts_of(const Intersector& catalogue_row) {
        const std::lock_guard lock(mutex_);
        const auto found = std::ranges::find_if(
            rows_, [&catalogue_row](const ComposedRow& composed) { return &composed.row == &catalogue_row; });
        return found == rows_.end() ? Parts{} : found->parts;
    }

private:
    std::mutex mutex_;
    std::deque<ComposedRow> rows_;
};

}  // namespace lostbits::intersect::table
