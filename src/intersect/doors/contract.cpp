#include "intersect/doors/contract.hpp"

#include <algorithm>
#include <cctype>
#include <deque>
#include <memory>
#include <mutex>

#include "intersect/doors/foreign_batch.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::doors {
namespace {

/// One value of `lb_form`, which must be one of the first `count`.
template <class Value>
Value word(int number, int count, const char* field, const std::string& from) {
    if (number >= 0 && number < count) return static_cast<Value>(number);
    throw InputError(from + ": " + field + " is " + std::to_string(number) + "; it must be from 0 to " +
                     std::to_string(count - 1) + ", see lostbits_plugin.h");
}

std::string text_of(const char* text) { return text == nullptr ? std::string() : std::string(text); }

/// What names a folder and a column: nothing that a shell, a file system or a table would read otherwise.
bool is_plain(const std::string& name) {
    const auto plain = [](char c) {
        return (std::isalnum(static_cast<unsigned char>(c)) != 0 && static_cast<unsigned char>(c) < 128) || c == '.' ||
               c == '_' || c == '-';
    };
    return !name.empty() && name.size() <= 64 && std::isalpha(static_cast<unsigned char>(name[0])) != 0 &&
           name.back() != '.' && name.find("..") == std::string::npos && std::ranges::all_of(name, plain);
}

/// A line of words for tables and captions: nothing that a terminal would obey.
void require_line(const std::string& text, const char* field, const std::string& from) {
    const auto control = [](char c) { return static_cast<unsigned char>(c) < 32 || c == 127; };
    if (text.size() <= 400 && std::ranges::none_of(text, control)) return;
    throw InputError(from + ": " + field + " must be one line of at most 400 bytes without control characters");
}

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
            .formats = c.bits == 32 ? Formats::binary32_only : Formats::all};
}

void add_format(Enrolled& to, ForeignForm form) {
    std::unique_ptr<ForeignBatch>& place = form.contract.bits == 32 ? to.of32 : to.of64;
    const std::unique_ptr<ForeignBatch>& other = form.contract.bits == 32 ? to.of64 : to.of32;
    if (place)
        throw InputError(form.from + ": " + form.contract.name + " comes twice in binary" +
                         std::to_string(form.contract.bits) + "; give each form a name of its own");
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

Contract contract_of(const lb_form& form, const std::string& library) {
    if (form.name == nullptr) throw InputError(library + ": a form has no name");
    const std::string from = library + ": form \"" + form.name + "\"";
    Contract c{.name = form.name, .title = text_of(form.title), .source = text_of(form.source)};
    c.shape = word<Shape>(form.shape, 2, "shape", from);
    c.bits = form.format;
    c.direction = word<Direction>(form.direction, 2, "direction", from);
    c.roots = word<Roots>(form.roots, 4, "roots", from);
    c.touching = word<Touching>(form.touching, 2, "touching", from);
    c.at_origin = word<AtOrigin>(form.at_origin, 2, "at_origin", from);
    c.flags = form.flags;
    if (form.run == nullptr) throw InputError(from + ": run is NULL; it is the function that answers a batch");
    require_sense(c, library);
    return c;
}

void require_sense(const Contract& c, const std::string& library) {
    if (!is_plain(c.name))
        throw InputError(library +
                         ": a form's name must begin with a letter and be of letters, digits and . _ -, at "
                         "most 64 of them: it names columns, folders and pictures");
    const std::string from = library + ": form \"" + c.name + "\"";
    const std::size_t dot = c.name.find('.');
    if (dot == std::string::npos || std::ranges::find(shape_names, c.name.substr(0, dot)) != shape_names.end())
        throw InputError(from +
                         ": a name is LIBRARY.FORM, such as \"mylib.sphere\"; sphere., box. and sdf. begin the "
                         "names of the forms that ship with lostbits");
    require_line(c.title, "title", from);
    require_line(c.source, "source", from);
    if (c.bits != 32 && c.bits != 64)
        throw InputError(from + ": format is " + std::to_string(c.bits) + "; it must be 32 (float) or 64 (double)");
    if ((c.flags & ~7U) != 0)
        throw InputError(from +
                         ": flags has bits that this version does not know; rebuild it with this version's "
                         "lostbits_plugin.h");
    if ((c.flags & LB_LINE) != 0 && c.roots != Roots::both)
        throw InputError(from + ": answers for the whole line need both roots, since the first ahead is taken of them");
    if (c.shape == Shape::box && c.at_origin == AtOrigin::miss)
        throw InputError(from +
                         ": a box is solid, so a ray that starts on it hits at t = 0; at_origin = miss is for "
                         "spheres");
    if ((c.flags & LB_NO_END) != 0 && c.roots == Roots::none)
        throw InputError(from + ": a form that tells no t must look at the ends of rays itself");
}

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

}  // namespace lostbits::intersect::doors
