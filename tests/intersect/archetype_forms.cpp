// Every form obeys the rules of a formula. Compiled and never linked: the archetype's operations have no bodies, so
// instantiating a form that needs more than they offer is an error here, by name.
#include <array>

#include "intersect/catalogue.hpp"
#include "number/archetype.hpp"

namespace lostbits::test {

/// Taking a form's address over the archetype compiles its body.
template <class... Form>
std::array<Hit<Archetype> (*)(const Ray<Archetype>&, const Sphere<Archetype>&), sizeof...(Form)> instantiate(
    FormList<Form...>) {
    return {&Form::template intersect<Archetype>...};
}

extern const auto spheres_over_archetype = instantiate(SphereForms{});

template <class... Form>
std::array<Hit<Archetype> (*)(const Ray<Archetype>&, const Box<Archetype>&, const Archetype&), sizeof...(Form)>
instantiate_boxes(FormList<Form...>) {
    return {&Form::template intersect<Archetype>...};
}

extern const auto boxes_over_archetype = instantiate_boxes(BoxForms{});

}  // namespace lostbits::test
