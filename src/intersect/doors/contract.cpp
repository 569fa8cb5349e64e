#include "intersect/doors/contract.hpp"

#include <algorithm>
#include <cctype>

#include "intersect/conventions.hpp"
#include "intersect/process/floating_point.hpp"
#include "number/error.hpp"
#include "shapes/number_names.hpp"

namespace lostbits::intersect::doors {
namespace {

/// "sphere., box. and sdf."
std::string shipped_rooms() {
    std::string words;
    for (const std::string_view& name : shape_names)
        words += (words.empty() ? "" : &name == &shape_names.back() ? " and " : ", ") + std::string(name) + '.';
    return words;
}

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

/// What the roots that a form tells have to do with its other words.
void require_roots(const Contract& c, const std::string& from) {
    const bool both = c.roots == Roots::both, near = c.roots == Roots::near_only;
    if ((c.flags & LB_LINE) != 0 && !both && !near)
        throw InputError(from +
                         ": answers for the whole line need both roots, or the near one: of these the first ahead is "
                         "taken");
    if ((c.flags & LB_CLIPPED) != 0 && !both)
        throw InputError(from + ": clipped is about an interval, and needs both roots");
    const bool exits = !zero_inside(c.shape) || c.inside == Inside::exit;
    if ((c.flags & LB_CLIPPED) != 0 && exits && c.at_origin == AtOrigin::hit)
        throw InputError(from +
                         ": a near root that is clipped to 0 cannot tell a surface at the origin from one behind it; "
                         "say at_origin = exit as well, or miss");
    if ((c.flags & LB_RANGE) != 0 && (both || near))
        throw InputError(from +
                         ": range is for a form that tells the first root in the range (roots = first) or yes and no; "
                         "of near and far the first in the range is taken afterwards");
    if ((c.flags & LB_RANGE) != 0 && (c.flags & LB_NO_END) != 0)
        throw InputError(from +
                         ": says range and no_end; a form that looks at where rays begin looks at their ends too");
    if (c.inside == Inside::near && !near)
        throw InputError(from + ": inside = near is for a form of the near root alone (roots = near)");
    if (c.inside == Inside::exit && near)
        throw InputError(from + ": a form that answers the exit from inside tells the first root (roots = first)");
}

}  // namespace

void require_front(Facing facing, Shape shape, const std::string& from) {
    if (facing == Facing::both || is_flat(shape)) return;
    std::string flat;
    for (const ShapeRow& row : shape_rows)
        if (row.flat) flat += (flat.empty() ? "" : ", ") + std::string(row.plural);
    throw InputError(from + ": facing is for what has a front and a back (" + flat + "); leave it out of " +
                     with_article(shape));
}

Contract contract_of(const lb_form& form, const std::string& library) {
    if (form.name == nullptr) throw InputError(library + ": a form has no name");
    const std::string from = library + ": form \"" + form.name + "\"";
    Contract c{.name = form.name, .title = text_of(form.title), .source = text_of(form.source)};
    c.shape = word<Shape>(form.shape, static_cast<int>(shape_rows.size()), "shape", from);
    c.bits = form.format;
    c.direction = word<Direction>(form.direction, 2, "direction", from);
    c.roots = word<Roots>(form.roots, 4, "roots", from);
    c.touching = word<Touching>(form.touching, 2, "touching", from);
    c.at_origin = word<AtOrigin>(form.at_origin, 3, "at_origin", from);
    c.inside = word<Inside>(static_cast<int>((form.flags & LB_INSIDE) / LB_INSIDE_EXIT), 5, "LB_INSIDE in flags", from);
    c.facing =
        word<Facing>(static_cast<int>((form.flags & LB_FACING) / LB_FACING_FRONT), 3, "LB_FACING in flags", from);
    c.flags = form.flags & ~static_cast<unsigned>(LB_INSIDE | LB_FACING);
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
        throw InputError(from + ": a name is LIBRARY.FORM, such as \"mylib.sphere\"; " + shipped_rooms() +
                         " begin the names of the forms that ship with lostbits");
    require_line(c.title, "title", from);
    require_line(c.source, "source", from);
    if (process::FloatingPoint ignored; !process::FloatingPoint::read(c.state, ignored))
        throw InputError(from +
                         ": state has a word that is unknown; leave it out where the processor computes as usual");
    if (c.bits != 32 && c.bits != 64)
        throw InputError(from + ": format is " + std::to_string(c.bits) + "; it must be 32 (float) or 64 (double)");
    constexpr unsigned known = LB_LINE | LB_NO_END | LB_ONE_THREAD | LB_CLIPPED | LB_RANGE;
    if ((c.flags & ~known) != 0)
        throw InputError(from +
                         ": flags has bits that this version does not know; rebuild it with this version's "
                         "lostbits_plugin.h");
    require_roots(c, from);
    require_front(c.facing, c.shape, from);
    require_origin(c.at_origin, inside_of(c), c.shape, from);
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
            .facing = c.facing,
            .endless = c.roots == Roots::none && (c.flags & LB_NO_END) != 0,
            .ranged = (c.flags & LB_RANGE) != 0};
}

Inside inside_of(const Contract& c) {
    const bool is_zero = zero_inside(c.shape);  // without a word
    if (c.inside == Inside::usual) return c.roots == Roots::near_only ? Inside::miss : Inside::usual;
    return c.inside == (is_zero ? Inside::zero : Inside::exit) ? Inside::usual : c.inside;
}

}  // namespace lostbits::intersect::doors
