#include "intersect/external/contract.hpp"

#include <algorithm>
#include <cctype>

#include "intersect/conventions.hpp"
#include "intersect/process/floating_point.hpp"
#include "number/error.hpp"
#include "shapes/number_names.hpp"

namespace lostbits::intersect::external {
namespace {

/// Returns the prefixes of the names of shipped forms, such as "sphere., box. or sdf.".
std::string shipped_prefixes() {
    std::string prefixes;
    for (const std::string_view& name : shape_names)
        prefixes += (prefixes.empty() ? "" : &name == &shape_names.back() ? " or " : ", ") + std::string(name) + '.';
    return prefixes;
}

/// Converts a field of `lb_form` to its enumeration. Throws InputError unless 0 <= number < count.
template <class Value>
Value read_enum(int number, int count, const char* field, const std::string& message_prefix) {
    if (number >= 0 && number < count) return static_cast<Value>(number);
    throw InputError(message_prefix + ": " + field + " is " + std::to_string(number) + "; it must be from 0 to " +
                     std::to_string(count - 1) + ", see lostbits_plugin.h");
}

std::string text_of(const char* text) { return text == nullptr ? std::string() : std::string(text); }

/// True if the name is safe as part of a folder, a column and a shell command: at most 64 ASCII letters, digits, dots,
/// underscores and hyphens, a letter first, no dot at the end and no two dots in a row.
bool is_safe_name(const std::string& name) {
    const auto is_allowed = [](char c) {
        return (std::isalnum(static_cast<unsigned char>(c)) != 0 && static_cast<unsigned char>(c) < 128) || c == '.' ||
               c == '_' || c == '-';
    };
    return !name.empty() && name.size() <= 64 && std::isalpha(static_cast<unsigned char>(name[0])) != 0 &&
           name.back() != '.' && name.find("..") == std::string::npos && std::ranges::all_of(name, is_allowed);
}

/// Throws InputError unless the text is one line without control characters, as tables and captions show it on a
/// terminal.
void require_line(const std::string& text, const char* field, const std::string& message_prefix) {
    const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 32 || c == 127; };
    if (text.size() <= 400 && std::ranges::none_of(text, is_control)) return;
    throw InputError(message_prefix + ": " + field +
                     " must be one line of at most 400 bytes without control characters");
}

/// Throws InputError if another property of a contract contradicts the roots that the form yields.
void require_roots(const Contract& contract, const std::string& message_prefix) {
    const bool has_both = contract.roots == Roots::both, near_only = contract.roots == Roots::near_only;

    // LB_LINE and LB_CLIPPED describe the roots.
    if ((contract.flags & LB_LINE) != 0 && !has_both && !near_only)
        throw InputError(message_prefix +
                         ": line needs roots = both or near: lostbits takes the first of these roots that lies ahead; "
                         "set roots, or leave line out");
    if ((contract.flags & LB_CLIPPED) != 0 && !has_both)
        throw InputError(message_prefix + ": clipped describes an interval, so it needs roots = both");
    const bool exits_from_inside = !inside_returns_zero(contract.shape) || contract.inside == Inside::exit;
    if ((contract.flags & LB_CLIPPED) != 0 && exits_from_inside && contract.at_origin == AtOrigin::hit)
        throw InputError(message_prefix +
                         ": with near clipped to 0, a surface at the origin looks the same as one behind it; set "
                         "at_origin = exit or miss");

    // LB_RANGE limits the answer to the range in the form itself.
    if ((contract.flags & LB_RANGE) != 0 && (has_both || near_only))
        throw InputError(
            message_prefix +
            ": range needs roots = first or none: the form itself answers within the range; leave range out, "
            "and lostbits takes the first of near and far that lies in the range");
    if ((contract.flags & LB_RANGE) != 0 && (contract.flags & LB_NO_END) != 0)
        throw InputError(message_prefix +
                         ": range and no_end contradict each other: with range, the form takes the end of the ray into "
                         "account; leave one of them out");

    // The answer from inside must be a root that the form yields.
    if (contract.inside == Inside::near && !near_only)
        throw InputError(message_prefix + ": inside = near needs roots = near");
    if (contract.inside == Inside::exit && near_only)
        throw InputError(
            message_prefix +
            ": inside = exit contradicts roots = near: from inside the near root lies behind the origin; set "
            "roots = first");
}

}  // namespace

void require_valid_facing(Facing facing, Shape shape, const std::string& message_prefix) {
    if (facing == Facing::both || is_flat(shape)) return;
    std::string flat_shapes;
    for (const ShapeRow& shape_row : shape_rows)
        if (shape_row.is_flat) flat_shapes += (flat_shapes.empty() ? "" : ", ") + std::string(shape_row.plural);
    throw InputError(message_prefix + ": facing is only for shapes with a front and a back (" + flat_shapes +
                     "); leave it out for " + with_article(shape));
}

Contract read_form_contract(const lb_form& form, const std::string& library) {
    if (form.name == nullptr)
        throw InputError(library + ": the name of a form is NULL; set `name`, such as \"sphere.mine\"");
    const std::string message_prefix = library + ": form \"" + form.name + "\"";

    Contract c{.name = form.name, .title = text_of(form.title), .source = text_of(form.source)};
    c.shape = read_enum<Shape>(form.shape, static_cast<int>(shape_rows.size()), "shape", message_prefix);
    c.bits = form.format;
    c.direction = read_enum<Direction>(form.direction, 2, "direction", message_prefix);
    c.roots = read_enum<Roots>(form.roots, 4, "roots", message_prefix);
    c.touching = read_enum<Touching>(form.touching, 2, "touching", message_prefix);
    c.at_origin = read_enum<AtOrigin>(form.at_origin, 3, "at_origin", message_prefix);
    c.inside = read_enum<Inside>(static_cast<int>((form.flags & LB_INSIDE) / LB_INSIDE_EXIT), 5, "LB_INSIDE in flags",
                                 message_prefix);
    c.facing = read_enum<Facing>(static_cast<int>((form.flags & LB_FACING) / LB_FACING_FRONT), 3, "LB_FACING in flags",
                                 message_prefix);
    c.flags = form.flags & ~static_cast<unsigned>(LB_INSIDE | LB_FACING);

    if (form.run == nullptr)
        throw InputError(message_prefix + ": run is NULL; set it to the function that answers a batch");
    require_valid(c, library);
    return c;
}

void require_valid(const Contract& contract, const std::string& library) {
    if (!is_safe_name(contract.name))
        throw InputError(
            library +
            ": a form's name must begin with a letter and consist of at most 64 letters, digits and . _ -, "
            "without two dots in a row or a dot at the end: columns, folders and pictures are named after "
            "it");

    const std::string message_prefix = library + ": form \"" + contract.name + "\"";
    const std::size_t dot = contract.name.find('.');
    if (dot == std::string::npos || std::ranges::find(shape_names, contract.name.substr(0, dot)) != shape_names.end())
        throw InputError(message_prefix + ": a name is LIBRARY.FORM, such as \"mylib.sphere\"; names that begin with " +
                         shipped_prefixes() + " belong to the forms that ship with lostbits");

    require_line(contract.title, "title", message_prefix);
    require_line(contract.source, "source", message_prefix);
    if (process::FloatingPointState ignored; !process::FloatingPointState::parse_differences(contract.state, ignored))
        throw InputError(message_prefix +
                         ": state has an unknown value; leave it out if the processor computes as IEEE 754 requires");
    if (contract.bits != 32 && contract.bits != 64)
        throw InputError(message_prefix + ": format is " + std::to_string(contract.bits) +
                         "; it must be 32 (float) or 64 (double)");
    constexpr unsigned known_flags = LB_LINE | LB_NO_END | LB_ONE_THREAD | LB_CLIPPED | LB_RANGE;
    if ((contract.flags & ~known_flags) != 0)
        throw InputError(message_prefix +
                         ": flags has bits that this version does not know; rebuild the library with this version's "
                         "lostbits_plugin.h");

    // The properties must not contradict each other.
    require_roots(contract, message_prefix);
    require_valid_facing(contract.facing, contract.shape, message_prefix);
    refuse_unused_at_origin(contract.at_origin, inside_of(contract), contract.shape, message_prefix);
}

Info make_info(const Contract& contract) {
    return {.name = contract.name,
            .title = contract.title,
            .source = contract.source,
            .direction = contract.direction,
            .roots = contract.roots,
            .touching = contract.touching,
            .at_origin = contract.at_origin,
            .formats = contract.bits == 32 ? Formats::binary32_only : Formats::all,
            .inside = inside_of(contract),
            .facing = contract.facing,
            .endless = contract.roots == Roots::none && (contract.flags & LB_NO_END) != 0,
            .ranged = (contract.flags & LB_RANGE) != 0};
}

Inside inside_of(const Contract& contract) {
    const bool is_zero = inside_returns_zero(contract.shape);  // the usual answer of the shape
    if (contract.inside == Inside::usual) return contract.roots == Roots::near_only ? Inside::miss : Inside::usual;
    return contract.inside == (is_zero ? Inside::zero : Inside::exit) ? Inside::usual : contract.inside;
}

}  // namespace lostbits::intersect::external
