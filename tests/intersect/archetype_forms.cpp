// Every form obeys the rules of a formula. Compiled and never linked: the operations of the archetype have no bodies,
// so instantiating a form that needs more than these operations is an error here, by name.
#include <array>

#include "intersect/catalogue.hpp"
#include "number/archetype.hpp"

namespace lostbits::test {

using intersect::FormList;

/// Taking a form's address over the archetype compiles its body.
template <class... Form>
std::array<Hit<Archetype> (*)(const Ray<Archetype>&, const Sphere<Archetype>&), sizeof...(Form)> instantiate(
    FormList<Form...>) {
    return {&Form::template intersect<Archetype>...};
}

extern const auto spheres_over_archetype = instantiate(intersect::sphere::SphereForms{});

template <class... Form>
std::array<Hit<Archetype> (*)(const Ray<Archetype>&, const Box<Archetype>&, const Archetype&), sizeof...(Form)>
instantiate_boxes(FormList<Form...>) {
    return {&Form::template intersect<Archetype>...};
}

extern const auto boxes_over_archetype = instantiate_boxes(intersect::box::BoxForms{});

using ArchetypeField = Archetype (*)(const Vec<Archetype>&);

template <class... Form>
std::array<Hit<Archetype> (*)(const Ray<Archetype>&, const ArchetypeField&, const intersect::MarchConstants<Archetype>&,
                              intersect::sdf::NoMarchWatch&),
           sizeof...(Form)>
instantiate_marches(FormList<Form...>) {
    return {&Form::template intersect<Archetype, ArchetypeField, intersect::sdf::NoMarchWatch>...};
}

extern const auto marches_over_archetype = instantiate_marches(intersect::SdfForms{});
extern Archetype (Sphere<Archetype>::*const sphere_over_archetype)(const Vec<Archetype>&) const =
    &Sphere<Archetype>::distance;
extern Archetype (Box<Archetype>::*const box_over_archetype)(const Vec<Archetype>&) const = &Box<Archetype>::distance;

}  // namespace lostbits::test
