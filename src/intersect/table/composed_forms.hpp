// Rows made of other rows at run time. Each is made once and kept.
#pragma once

#include <algorithm>
#include <deque>
#include <mutex>
#include <string>

#include "intersect/table/table.hpp"

namespace lostbits::intersect::table {

/// The rows by their parts, a tuple of pointers. Rows do not move in memory; several threads may call.
template <class Parts>
class ComposedForms {
public:
    struct Made {
        Parts parts;
        std::string name, title, source;
        Info info;
        Intersector row;

        /// Takes the contract of `like`, but keeps its own name, title and source.
        void take_contract(const Info& like) {
            info = like;
            info.name = name, info.title = title, info.source = source;
        }
    };

    /// The row with these parts. If it is new, calls `fill(Made&)`; `parts` is set before.
    template <class Fill>
    const Intersector& row_of(const Parts& parts, const Fill& fill) {
        const std::lock_guard lock(mutex_);
        const auto known = std::ranges::find(rows_, parts, &Made::parts);
        if (known != rows_.end()) return known->row;
        Made& made = rows_.emplace_back();
        made.parts = parts;
        fill(made);
        return made.row;
    }
    /// The parts of a row; nulls if it was not made here.
    Parts parts_of(const Intersector& row) {
        const std::lock_guard lock(mutex_);
        const auto known = std::ranges::find_if(rows_, [&row](const Made& made) { return &made.row == &row; });
        return known == rows_.end() ? Parts{} : known->parts;
    }

private:
    std::mutex mutex_;
    std::deque<Made> rows_;
};

}  // namespace lostbits::intersect::table
