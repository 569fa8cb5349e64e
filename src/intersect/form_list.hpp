#pragma once

#include <cstddef>

namespace lostbits::intersect {

/// A list of form types, in the order in which every table shows them.
template <class... Form>
struct FormList {
    static constexpr std::size_t size = sizeof...(Form);
    /// Calls `visit.operator()<Form>()` for each.
    template <class Visitor>
    static void for_each(Visitor&& visit) {
        (visit.template operator()<Form>(), ...);
    }
};

}  // namespace lostbits::intersect
