// Adds external forms to the table as forms.
#include <algorithm>
#include <deque>
#include <memory>

#include "intersect/external/contract.hpp"
#include "intersect/external/foreign_batch.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::external {
namespace {

std::deque<ForeignIntersector>& all_registered() {
    static std::deque<ForeignIntersector> rows;
    return rows;
}

template <class S>
void answer_batch(void* context, const table::RayBatch<S>& rays, const Target<S>& target,
                  const table::HitBatch<S>& hits) {
    static_cast<ForeignBatch*>(context)->answer(rays, target, hits);
}

}  // namespace

ForeignIntersector::ForeignIntersector(ForeignForm first) {
    store(std::move(first));
    info = make_info((batch32 ? batch32 : batch64)->form().contract);
}

void ForeignIntersector::add(ForeignForm other) {
    store(std::move(other));
    info.formats = Formats::all;
}

void ForeignIntersector::store(ForeignForm form) {
    std::unique_ptr<ForeignBatch>& same_format = form.contract.bits == 32 ? batch32 : batch64;
    const std::unique_ptr<ForeignBatch>& other_format = form.contract.bits == 32 ? batch64 : batch32;
    if (same_format)
        throw InputError(form.provider + ": " + form.contract.name + " is defined twice in binary" +
                         std::to_string(form.contract.bits) + ", first in " + same_format->form().provider +
                         "; give each form its own name, or add a prefix to the names of one library: --plugin new=" +
                         form.provider + " calls this form new." + form.contract.name);

    // The two formats of a form share one contract, up to its texts and flags.
    if (other_format) {
        Contract expected = other_format->form().contract;
        expected.bits = form.contract.bits;
        expected.title = form.contract.title;
        expected.source = form.contract.source;
        expected.flags = form.contract.flags;
        if (expected != form.contract)
            throw InputError(form.provider + ": " + form.contract.name +
                             " has different contracts in binary32 and binary64; give the two forms different names");
    }

    same_format = std::make_unique<ForeignBatch>(std::move(form));
}

table::Intersector ForeignIntersector::to_intersector() const {
    const Contract& contract = (batch32 ? batch32 : batch64)->form().contract;
    table::Intersector form{.info = &info, .shape = contract.shape, .native32 = {}, .native64 = {}};
    if (batch32) form.native32 = {answer_batch<float>, batch32.get()};
    if (batch64) form.native64 = {answer_batch<double>, batch64.get()};
    return form;
}

void register_forms(std::vector<ForeignForm> forms) {
    const std::size_t old_count = all_registered().size();
    for (ForeignForm& form : forms) {
        const auto existing = std::ranges::find_if(
            all_registered().begin() + static_cast<std::ptrdiff_t>(old_count), all_registered().end(),
            [&form](const ForeignIntersector& e) { return e.info.name == form.contract.name; });
        if (existing != all_registered().end()) {
            existing->add(std::move(form));
            continue;
        }
        all_registered().emplace_back(std::move(form));
    }
    std::vector<table::Intersector> intersectors;
    for (std::size_t i = old_count; i < all_registered().size(); ++i)
        intersectors.push_back(all_registered()[i].to_intersector());
    table::register_intersectors(intersectors);
}

std::vector<const ForeignForm*> find_foreign_forms(const table::Intersector& form) {
    std::vector<const ForeignForm*> forms;
    for (const ForeignIntersector& e : all_registered()) {
        if (&e.info != form.info) continue;
        if (e.batch32) forms.push_back(&e.batch32->form());
        if (e.batch64) forms.push_back(&e.batch64->form());
    }
    return forms;
}

bool is_safe_to_run(const table::Intersector& form) {
    const auto catalogue = table::catalogue();
    if (&form >= catalogue.data() && &form < catalogue.data() + catalogue.size()) return true;
    const auto forms = find_foreign_forms(form);  // empty for a formula of a library, which runs in this process
    return !forms.empty() && std::ranges::all_of(forms, &ForeignForm::is_isolated);
}

}  // namespace lostbits::intersect::external
