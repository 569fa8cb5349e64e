#include "output/table/shared_columns.hpp"

#include "shapes/number_names.hpp"

namespace lostbits::output::table {

using measure::evaluate::TestedForm;

Table<TestedForm> make_subject_columns(const std::string& form, const std::string& format) {
    return {{"form", form, [](const TestedForm& tested_form) { return tested_form.form->info->name; }},
            {"format", format, [](const TestedForm& tested_form) { return tested_form.format.name; }}};
}

Table<Ray<double>> make_ray_columns(const std::string& meaning) {
    using R = Ray<double>;
    Table<R> table;
    const auto add = [&](const std::string& part, Vec<double> R::*vector) {
        for (int k = 0; k < 3; ++k)
            table.add({part + "_" + "xyz"[k] + "_hex", meaning,
                       [vector, k](const R& ray) { return file::hex((ray.*vector)[k]); }});
    };
    add("origin", &R::origin);
    add("direction", &R::direction);
    return table;
}

Table<Primitive<double>> make_primitive_columns(Shape shape, const std::string& meaning) {
    using S = Primitive<double>;
    Table<S> table;
    std::size_t index = 0;
    for (const auto& name : number_names(shape))
        table.add({std::string(name) + "_hex", meaning,
                   [k = index++](const S& primitive) { return file::hex(primitive.shape_numbers()[k]); }});
    return table;
}

}  // namespace lostbits::output::table
