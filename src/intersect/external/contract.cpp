#include "intersect/external/contract.hpp"

#include <algorithm>
#include <cctype>

#include "intersect/conventions.hpp"
#include "intersect/process/floating_point.hpp"
#include "number/error.hpp"
#include "shapes/number_names.hpp"

namespace lostbits::intersect::external {
namespace {

/// "sphere., box. or sdf."
std::string shipped_prefixes() {
    std::string words;
    for (const std::string_view& name : shape_names)
        words += (words.empty() ? "" : &name == &shape_names.back() ? " or " : ", ") + std::string(name) + '.';
    return words;
}

/// Converts a field of `lb_form` to its enumeration. InputError unless 0 <= number < count.
template <class Value>
Value word(int number, int count, const char* field, const std::string& from) {
    if (number >= 0 && number < count) return static_cast<Value>(number);
    throw InputError(from + ": " + field + " is " + std::to_string(number) + "; it must be from 0 to " +
                     std::to_string(count - 1) + ", see lostbits_plugin.h");
}

std::string text_of(const char* text) { return text == nullptr ? std::string() : std::string(text); }

/// True if the name is safe as part of a folder, a column and a shell command: ASCII letters, digits and . _ - alone,
/// at most 64, a letter first, no dot at the end and no two dots in a row.
bool is_plain(const std::string& name) {
    const auto plain = [](char c) {
        return (std::isalnum(static_cast<unsigned char>(c)) != 0 && static_cast<unsigned char>(c) < 128) || c == '.' ||
               c == '_' || c == '-';
    };
    return !name.empty() && name.size() <= 64 && std::isalpha(static_cast<unsigned char>(name[0])) != 0 &&
           name.back() != '.' && name.find("..") == std::string::npos && std::ranges::all_of(name, plain);
}

/// Requires one line of text without control characters, as tables and captions show it on a terminal.
void require_line(const std::string& text, const char* field, const std::string& from) {
    const auto control = [](char c) { return static_cast<unsigned char>(c) < 32 || c == 127; };
    if (text.size() <= 400 && std::ranges::none_of(text, control)) return;
    throw InputError(from + ": " + field + " must be one line of at most 400 bytes without control characters");
}

/// Requires that the other properties of a contract agree with the roots that the form yields.
void require_roots(const Contract& c, const std::string& from) {
    const bool both = c.roots == Roots::both, near = c.roots == Roots::near_only;
    if ((c.flags & LB_LINE) != 0 && !both && !near)
        throw InputError(from +
                         ": line needs roots = both or near: lostbits takes the first of these roots that lies ahead; "
                         "set roots, or leave line out");
    if ((c.flags & LB_CLIPPED) != 0 && !both)
        throw InputError(from + ": clipped describes an interval, so it needs roots = both");
    const bool exits = !inside_returns_zero(c.shape) || c.inside == Inside::exit;
    if ((c.flags & LB_CLIPPED) != 0 && exits && c.at_origin == AtOrigin::hit)
        throw InputError(from +
                         ": with near clipped to 0, a surface at the origin looks the same as one behind it; set "
                         "at_origin = exit or miss");
    if ((c.flags & LB_RANGE) != 0 && (both || near))
        throw InputError(
            from +
            ": range needs roots = first or none: the form itself answers within the range; leave range out, "
            "and lostbits takes the first of near and far that lies in the range");
    if ((c.flags & LB_RANGE) != 0 && (c.flags & LB_NO_END) != 0)
        throw InputError(from +
                         ": range and no_end contradict each other: with range, the form takes the end of the ray into "
                         "account; leave one of them out");
    if (c.inside == Inside::near && !near) throw InputError(from + ": inside = near needs roots = near");
    if (c.inside == Inside::exit && near)
        throw InputError(
            from +
            ": inside = exit contradicts roots = near: from inside the near root lies behind the origin; set "
            "roots = first");
}

}  // namespace

void require_front(Facing facing, Shape shape, const std::string& from) {
    if (facing == Facing::both || is_flat(shape)) return;
    std::string flat;
    for (const ShapeRow& row : shape_rows)
        if (row.flat) flat += (flat.empty() ? "" : ", ") + std::string(row.plural);
    throw InputError(from + ": facing is only for shapes with a front and a back (" + flat + "); leave it out for " +
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
    if (form.run == nullptr) throw InputError(from + ": run is NULL; set it to the function that answers a batch");
    require_sense(c, library);
    return c;
}

void require_sense(const Contract& c, const std::string& library) {
    if (!is_plain(c.name))
        throw InputError(
            library +
            ": a form's name must begin with a letter and consist of at most 64 letters, digits and . _ -, "
            "without two dots in a row or a dot at the end: columns, folders and pictures are named after "
            "it");
    const std::string from = library + ": form \"" + c.name + "\"";
    const std::size_t dot = c.name.find('.');
    if (dot == std::string::npos || std::ranges::find(shape_names, c.name.substr(0, dot)) != shape_names.end())
        throw InputError(from + ": a name is LIBRARY.FORM, such as \"mylib.sphere\"; names that begin with " +
                         shipped_prefixes() + " belong to the forms that ship with lostbits");
    require_line(c.title, "title", from);
    require_line(c.source, "source", from);
    if (process::FloatingPoint ignored; !process::FloatingPoint::read(c.state, ignored))
        throw InputError(from +
                         ": state has an unknown value; leave it out if the processor computes as IEEE 754 asks");
    if (c.bits != 32 && c.bits != 64)
        throw InputError(from + ": format is " + std::to_string(c.bits) + "; it must be 32 (float) or 64 (double)");
    constexpr unsigned known = LB_LINE | LB_NO_END | LB_ONE_THREAD | LB_CLIPPED | LB_RANGE;
    if ((c.flags & ~known) != 0)
        throw InputError(from +
                         ": flags has bits that this version does not know; rebuild the library with this version's "
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
    const bool is_zero = inside_returns_zero(c.shape);  // if the contract does not say
    if (c.inside == Inside::usual) return c.roots == Roots::near_only ? Inside::miss : Inside::usual;
    return c.inside == (is_zero ? Inside::zero : Inside::exit) ? Inside::usual : c.inside;
}

}  // namespace lostbits::intersect::external
