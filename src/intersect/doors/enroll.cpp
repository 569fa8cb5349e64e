// Forms from outside as rows of the table.
#include <algorithm>
#include <deque>
#include <memory>

#include "intersect/doors/contract.hpp"
#include "intersect/doors/foreign_batch.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::doors {
namespace {

/// One row and what its kernels are bound to.
struct Enrolled {
    Info info;
    std::unique_ptr<ForeignBatch> of32, of64;
};

std::deque<Enrolled>& all_enrolled() {
    static std::deque<Enrolled> rows;
    return rows;
}

Info info_of(const Contract& c) {
    return {.name = c.name,
            .title = c.title,
            .source = c.source,
            .direction = c.direction,
            .roots = c.roots,
            .touching = c.touching,
            .at_origin = c.at_origin,
            .formats = c.bits == 32 ? Formats::binary32_only : Formats::all,
            .inside = inside_of(c),
            .endless = c.roots == Roots::none && (c.flags & LB_NO_END) != 0,
            .ranged = (c.flags & LB_RANGE) != 0};
}

void add_format(Enrolled& to, ForeignForm form) {
    std::unique_ptr<ForeignBatch>& place = form.contract.bits == 32 ? to.of32 : to.of64;
    const std::unique_ptr<ForeignBatch>& other = form.contract.bits == 32 ? to.of64 : to.of32;
    if (place)
        throw InputError(form.from + ": " + form.contract.name + " comes twice in binary" +
                         std::to_string(form.contract.bits) + ", the first time from " + place->form().from +
                         "; give each form a name of its own, or name the library: --plugin new=" + form.from +
                         " calls its forms new." + form.contract.name);
    if (other) {
        Contract same = other->form().contract;
        same.bits = form.contract.bits;
        same.title = form.contract.title, same.source = form.contract.source, same.flags = form.contract.flags;
        if (same != form.contract)
            throw InputError(form.from + ": " + form.contract.name +
                             " promises one thing in binary32 and another in binary64; give the two different names");
    }
    place = std::make_unique<ForeignBatch>(std::move(form));
}

template <class S>
void answer_batch(void* own, const table::RayBatch<S>& rays, const Target<S>& target, const table::HitBatch<S>& hits) {
    static_cast<ForeignBatch*>(own)->answer(rays, target, hits);
}

table::Intersector row_of(const Enrolled& e) {
    const Contract& contract = (e.of32 ? e.of32 : e.of64)->form().contract;
    table::Intersector row{.info = &e.info, .shape = contract.shape, .native32 = {}, .native64 = {}};
    if (e.of32) row.native32 = {answer_batch<float>, e.of32.get()};
    if (e.of64) row.native64 = {answer_batch<double>, e.of64.get()};
    return row;
}

}  // namespace

void enroll(std::vector<ForeignForm> forms) {
    const std::size_t before = all_enrolled().size();
    for (ForeignForm& form : forms) {
        const auto added =
            std::ranges::find_if(all_enrolled().begin() + static_cast<std::ptrdiff_t>(before), all_enrolled().end(),
                                 [&form](const Enrolled& e) { return e.info.name == form.contract.name; });
        if (added != all_enrolled().end()) {
            add_format(*added, std::move(form));
            added->info.formats = Formats::all;
            continue;
        }
        Enrolled& fresh = all_enrolled().emplace_back();
        add_format(fresh, std::move(form));
        fresh.info = info_of((fresh.of32 ? fresh.of32 : fresh.of64)->form().contract);
    }
    std::vector<table::Intersector> rows;
    for (std::size_t i = before; i < all_enrolled().size(); ++i) rows.push_back(row_of(all_enrolled()[i]));
    table::enroll(rows);
}

std::vector<const ForeignForm*> behind(const table::Intersector& row) {
    std::vector<const ForeignForm*> forms;
    for (const Enrolled& e : all_enrolled()) {
        if (&e.info != row.info) continue;
        if (e.of32) forms.push_back(&e.of32->form());
        if (e.of64) forms.push_back(&e.of64->form());
    }
    return forms;
}

bool is_harmless(const table::Intersector& row) {
    const auto own = table::catalogue();
    if (&row >= own.data() && &row < own.data() + own.size()) return true;
    const auto forms = behind(row);  // none for a formula of a library, which runs here
    return !forms.empty() && std::ranges::all_of(forms, &ForeignForm::isolated);
}

}  // namespace lostbits::intersect::doors
