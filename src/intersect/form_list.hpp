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

/// Several lists, one after the other.
template <class... List>
struct JoinedLists {
    static constexpr std::size_t size = (List::size + ... + 0);
    /// Calls `visit.operator()<Form>()` for each form.
    template <class Visitor>
    static void for_each(Visitor&& visit) {
        (List::for_each(visit), ...);
    }
};

/// The two parts of the catalogue, in catalogue_first.hpp and catalogue_second.hpp.
struct FirstForms;
struct SecondForms;

}  // namespace lostbits::intersect
