#include "output/mend/mend_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "intersect/table/recording.hpp"
#include "measure/blame/tape_text.hpp"
#include "measure/tape/tape_form.hpp"
#include "output/choice/choice_text.hpp"
#include "output/mend/form_code.hpp"

namespace lostbits::output::mend {

using measure::blame::TapeText;
using measure::choice::End;
using measure::choice::Room;
using measure::mend::Worth;

namespace {

TapeText text_of(const MendResult& r) {
    const auto& form = *r.request.row.form;
    const Solid<double> solid(form.shape);
    return {r.mended.tape, intersect::table::input_names(form, intersect::Target<double>(solid)),
            TapeText::Style::plain};
}

/// `22.1 bits, no wrong decision`
std::string in_words(const Worth& worth, const measure::choice::Wish& wish) {
    const std::string bits = std::isnan(worth.kept_bits) ? "no bits, since no hit is agreed"
                                                         : choice::bits_beside(worth.kept_bits, wish) + " bits";
    if (worth.wrong == 0) return bits + ", no wrong decision";
    return fmt::format("{}, {} of {} rays decided wrongly", bits, worth.wrong, worth.rays);
}

std::string room_in_words(const Room& room, const MendResult& r) {
    const auto way = measure::choice::growth_names[static_cast<std::size_t>(room.way)];
    const auto& wish = r.request.wish;
    if (room.holds == 0)
        return fmt::format("{}: not even where nothing grows, on a smaller picture: {}", way,
                           in_words(room.broken, wish));
    const std::string holds = fmt::format("{}: holds up to {:.4g}-fold ({:.6g})", way, room.holds, room.value);
    switch (room.end) {
        case End::fails:
            return fmt::format("{}; first broken at {:.4g}-fold: {}", holds, room.beyond, in_words(room.broken, wish));
        case End::nothing_hit: return holds + "; beyond that no ray hits anything";
        case End::other_scene:
            return holds + "; beyond that binary32, to which inputs are rounded, holds another scene";
        case End::none: break;
    }
    return holds + ", which is as far as was tried";
}

/// The names of what is wider, each operation by that of the statement that it is part of, in order.
std::string names_of(const MendResult& r) {
    const Tape& tape = r.mended.tape;
    std::vector<std::string> names;
    std::set<std::string> seen;
    for (const NodeId i : r.mended.set->operations) {
        NodeId named = i;
        // The next operation with a name that is computed from it, as maps of culprits have it.
        for (NodeId k = i; k < tape.size() && tape[named].label.empty(); ++k) {
            const auto& operands = tape[k].operands;
            if (!is_given(tape[k].op) && std::ranges::find(operands, named) != operands.end()) named = k;
        }
        const std::string name = std::string(tape[named].label.empty() ? "what follows" : tape[named].label);
        if (seen.insert(name).second) names.push_back(name);
    }
    return fmt::format("{}", fmt::join(names, ", "));
}

std::string own_is_enough(const MendResult& r) {
    return fmt::format("It meets the wish as it is: nothing has to be wider.\n{}",
                       r.mended.own_apart.meets(r.request.wish)
                           ? ""
                           : fmt::format("On rays that lie between these it does not: {}.\n",
                                         in_words(r.mended.own_apart, r.request.wish)));
}

std::string set_in_words(const MendResult& r) {
    const auto& [request, m, catalogue, worth, rooms] = r;
    const auto& wish = request.wish;
    const std::string wider = name_of_wider(m.wider);
    const std::size_t n = m.set->operations.size();
    std::string text = fmt::format("With {} of its {} operations in {} it keeps {} ({} with all of them).\n", n,
                                   m.operations, wider, in_words(m.set->worth, wish), in_words(m.all, wish));
    text += fmt::format("  They are in: {}.\n", names_of(r));
    for (const std::string& line : changed_lines(r)) text += fmt::format("    {}\n", line);
    const auto best = std::ranges::min_element(m.set->without, measure::mend::is_more_accurate);
    text += fmt::format(
        "  Nothing can be taken from it: with any one of the {} as it was the wish fails; the best of these {} has "
        "{}.\n",
        n, n, in_words(*best, wish));
    if (m.set->none_of > 0) {
        const std::string sets =
            m.set->none_of == 1 ? "No operation alone" : fmt::format("No set of {} or fewer", m.set->none_of);
        text += fmt::format("  {} does it, every one was tried{}.\n", sets,
                            m.set->none_of + 1 == n ? ": it is one of the smallest" : "; between, others may do");
    }
    text += fmt::format("  On {}x{} other pixels, on which nothing was searched: {}; as it was: {}.\n", m.apart.width,
                        m.apart.height, in_words(m.apart_worth, wish), in_words(m.own_apart, wish));
    if (!m.apart_worth.meets(wish))
        text += "  There it does not meet the wish: it was found for the pixels of this scene alone.\n";
    for (const Room& room : rooms) text += fmt::format("  {}.\n", room_in_words(room, r));
    return text;
}

}  // namespace

std::string name_of_wider(const FloatFormat& wider) {
    if (wider == measure::tape::two_floats) return "two floats";
    return wider == measure::tape::two_doubles ? "two doubles" : "double";
}

std::string operation_in_words(const MendResult& result, NodeId operation) {
    return text_of(result).definition(operation);
}

std::vector<std::string> changed_lines(const MendResult& r) {
    if (!r.mended.set || r.mended.set->operations.empty()) return {};
    const auto& form = *r.request.row.form;
    return changed_lines(statements(r.mended.tape, form),
                         statements(with_wider(r.mended, r.mended.set->operations), form));
}

std::string in_words(const MendResult& r) {
    const auto& wish = r.request.wish;
    const auto& m = r.mended;
    std::string text = fmt::format("{}: {}\n{} in {} keeps {}.\n", r.request.scene->id, choice::in_words(wish),
                                   r.request.row.form->info->name, r.request.row.format.name, in_words(m.own, wish));
    if (!m.set)
        text += fmt::format(
            "Even with all of its {} operations in {} it does not meet the wish: {}. What is lost is not lost by "
            "rounding alone; `lostbits explain` shows where, and `lostbits choose` which form does better.\n",
            m.operations, name_of_wider(m.wider), in_words(m.all, wish));
    else text += m.set->operations.empty() ? own_is_enough(r) : set_in_words(r);
    if (!r.catalogue.empty()) {
        const auto meet = std::ranges::count_if(r.catalogue_worth, [&](const Worth& w) { return w.meets(wish); });
        text += fmt::format("The most accurate of the catalogue in {} is {}: {}. Of its {} forms {} meet the wish.\n",
                            r.request.row.format.name, r.catalogue.front().form->info->name,
                            in_words(r.catalogue_worth.front(), wish), r.catalogue.size(), meet);
    }
    return text + fmt::format("Tried: {} candidates on all {} rays.\n", m.tried, r.request.scene->pixels());
}

}  // namespace lostbits::output::mend
