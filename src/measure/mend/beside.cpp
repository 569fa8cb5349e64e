#include "measure/mend/beside.hpp"

#include <algorithm>

#include "intersect/space/space.hpp"
#include "intersect/space/spaced.hpp"

namespace lostbits::measure::mend {

std::vector<evaluate::TestedForm> catalogue_beside(const evaluate::TestedForm& row) {
    std::vector<evaluate::TestedForm> rows;
    const auto made = intersect::space::made_of(*row.form);
    for (const auto& form : intersect::table::catalogue()) {
        if (form.shape != row.form->shape || !form.exists_in(row.format)) continue;
        rows.push_back({made.form ? &intersect::space::through(*made.space, form) : &form, row.format});
    }
    for (const auto& space : intersect::space::spaces())
        if (made.form && &space != made.space)
            rows.push_back({&intersect::space::through(space, *made.form), row.format});
    return rows;
}

std::vector<Ranked> ranked_catalogue(const MendRequest& request) {
    choice::ChoiceRequest all{.scene = request.scene, .rows = catalogue_beside(request.row), .wish = request.wish};
    all.limit = request.limit;
    const auto worth = request.scene ? worth_of(all) : request.rays->worth;
    std::vector<Ranked> ranked;
    for (std::size_t k = 0; k < worth.size(); ++k) ranked.push_back({all.rows[k], worth[k]});
    std::ranges::stable_sort(ranked, is_more_accurate, &Ranked::worth);
    return ranked;
}

std::vector<choice::Room> rooms_of_tape(const MendRequest& request, const Tape& tape) {
    choice::ChoiceRequest asked{.scene = request.scene, .rays = request.rays, .wish = request.wish};
    asked.limit = request.limit;
    const tape::TapeForm form(*request.row.form, request.row.format, tape, "mended", "");
    return rooms_of(asked, {.form = &form.row(), .format = request.row.format});
}

}  // namespace lostbits::measure::mend
