#include "output/choice/choice_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lostbits::output::choice {

using intersect::Info;
using measure::choice::Candidate;
using measure::choice::End;
using measure::choice::Growth;
using measure::choice::Room;
using measure::choice::Wish;
using measure::choice::Worth;

namespace {

double nanoseconds(const Candidate& c) { return c.time.median * 1e9; }

std::string name_of_row(const Candidate& c) {
    return fmt::format("{} in {}", c.row.form->info->name, c.row.format.name);
}

std::string kept(const Worth& worth, int precision) {
    return std::isnan(worth.kept_bits) ? "no hit to keep bits of"
                                       : fmt::format("{:.1f} of {} bits", worth.kept_bits, precision);
}

std::string decisions(const Worth& worth) {
    if (worth.wrong == 0) return fmt::format("no wrong decision in {} rays", worth.rays);
    const auto share = worth.wrong_fraction();
    return fmt::format("{} of {} rays decided wrongly ({}%)", worth.wrong, worth.rays,
                       share < 0.001 ? fmt::format("{:.2g}", share * 100) : fmt::format("{:.3g}", share * 100));
}

/// What the form asks of its caller, or takes for granted; empty where that is nothing.
std::string assumptions(const Info& info) {
    std::string words;
    const auto add = [&words](const char* more) { words += (words.empty() ? "" : ", ") + std::string(more); };
    if (info.direction == intersect::Direction::unit) add("directions of unit length");
    if (info.roots == intersect::Roots::near_only) add("rays that start outside");
    if (info.touching == intersect::Touching::miss) add("a touch is a miss");
    if (info.formats == intersect::Formats::binary32_only) add("inputs and answers in binary32");
    return words;
}

std::string times(double factor) { return fmt::format("{:.2f} times", factor); }

std::string broken_by(const Room& room, const Wish& wish, int precision) {
    if (!room.broken.decides(wish)) {
        std::string outcome(
            room.broken.first ? measure::answer::outcome_names[static_cast<std::size_t>(*room.broken.first)] : "");
        std::ranges::replace(outcome, '_', ' ');
        return fmt::format("{} ({} of {} rays)", outcome, room.broken.wrong, room.broken.rays);
    }
    return std::isnan(room.broken.kept_bits) ? "no hit that form and truth agree on"
                                             : "keeping " + kept(room.broken, precision);
}

const char* of_the_way(Growth way) {
    switch (way) {
        case Growth::distance: return "the camera is";
        case Growth::radius: return "the solids are";
        case Growth::offset: return "everything lies";
        case Growth::view: return "the view is";
    }
    return "";
}

std::string so_far(const Room& room) {
    switch (room.way) {
        case Growth::distance: return fmt::format("{:.3g} times farther ({:.4g} units)", room.holds, room.value);
        case Growth::radius: return fmt::format("{:.3g} times larger (radius {:.4g})", room.holds, room.value);
        case Growth::offset: return fmt::format("{:.4g} units away from the origin", room.value);
        case Growth::view: return fmt::format("{:.3g} degrees wide", room.value);
    }
    return "";
}

std::string room_in_words(const Room& room, const Wish& wish, int precision) {
    if (room.holds == 0) {
        return fmt::format(
            "no room in {} is known: on the smaller picture that it is tried on, it fails at once, by {}",
            measure::choice::growth_names[static_cast<std::size_t>(room.way)], broken_by(room, wish, precision));
    }
    const std::string until = fmt::format("until {} {}", of_the_way(room.way), so_far(room));
    switch (room.end) {
        case End::fails: return fmt::format("holds {}; first broken by {}", until, broken_by(room, wish, precision));
        case End::nothing_hit: return fmt::format("holds {}; beyond that no ray hits anything", until);
        case End::other_scene:
            return fmt::format("holds {}; beyond that binary32, to which inputs are rounded, holds another scene",
                               until);
        case End::none: return fmt::format("holds {}, which is as far as was tried", until);
    }
    return "";
}

std::string costs(const Chosen& chosen, const Candidate& c) {
    const auto& all = chosen.all;
    std::string text;
    const auto fast = *measure::choice::fastest(all), accurate = *measure::choice::most_accurate(all);
    if (&all[fast] == &c) text += "  It is the fastest of all.\n";
    else
        text +=
            fmt::format("  {} the time of the fastest, {} ({:.2f} ns; {}, {}).\n",
                        times(nanoseconds(c) / nanoseconds(all[fast])), name_of_row(all[fast]), nanoseconds(all[fast]),
                        kept(all[fast].worth, all[fast].row.format.shape.precision), decisions(all[fast].worth));
    if (&all[accurate] == &c) text += "  It is the most accurate of all.\n";
    else
        text += fmt::format("  {} the time of the most accurate, {} ({:.2f} ns; {}).\n",
                            times(nanoseconds(c) / nanoseconds(all[accurate])), name_of_row(all[accurate]),
                            nanoseconds(all[accurate]),
                            kept(all[accurate].worth, all[accurate].row.format.shape.precision));
    return text;
}

std::string nothing_meets(const Chosen& chosen) {
    const Candidate& near = chosen.all[*measure::choice::nearest(chosen.all, chosen.request.wish)];
    const int precision = near.row.format.shape.precision;
    std::string text = fmt::format("Nothing meets the wish. Nearest is {}: {}, {}; {:.2f} ns.\n", name_of_row(near),
                                   kept(near.worth, precision), decisions(near.worth), nanoseconds(near));
    if (!near.worth.decides(chosen.request.wish)) return text + "  In its way: its decisions.\n";
    bool wider = false;
    for (const Candidate& c : chosen.all) wider |= c.row.format.shape.precision > precision;
    if (chosen.request.wish.bits > precision)
        text += fmt::format("  In its way: {} has {} bits. Try a wider format.\n", near.row.format.name, precision);
    else if (chosen.request.scene->inputs == scene::file::Inputs::own)
        text +=
            "  The scene says inputs = \"own\": what each format rounds of it counts. The metric input_error of "
            "`lostbits map` says how much that is; with inputs = \"shared\" arithmetic counts alone.\n";
    else text += "  In its way: the arithmetic, since all formats get the same numbers here.\n";
    return text;
}

}  // namespace

std::vector<std::size_t> by_price(const std::vector<Candidate>& all) {
    std::vector<std::size_t> order(all.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&all](std::size_t c) { return all[c].time.median; });
    return order;
}

std::string in_words(const Wish& wish) {
    const std::string hits = wish.quantile == 1 ? "every hit" : fmt::format("{:g} of 100 hits", wish.quantile * 100);
    const std::string wrong =
        wish.wrong == 0 ? "no wrong decision" : fmt::format("at most {:g} of the decisions wrong", wish.wrong);
    return fmt::format("{:g} correct bits of {}, {}", wish.bits, hits, wrong);
}

std::string in_words(const Chosen& chosen) {
    std::string text = fmt::format("{}: {}\n", chosen.request.scene->id, in_words(chosen.request.wish));
    if (!chosen.meets) {
        text += nothing_meets(chosen);
    } else {
        const Candidate& c = chosen.all[*chosen.meets];
        const int precision = c.row.format.shape.precision;
        text +=
            fmt::format("The cheapest is {}: {}, {}.\n", name_of_row(c), kept(c.worth, precision), decisions(c.worth));
        text += fmt::format("  It takes {:.2f} ns a ray and solid, {}.\n", nanoseconds(c),
                            c.isa == "scalar" ? "one ray at a time" : fmt::format("in registers of {} bits", c.isa));
        const std::string assumed = assumptions(*c.row.form->info);
        text += assumed.empty() ? "  It assumes nothing of the ray.\n" : fmt::format("  It assumes: {}.\n", assumed);
        text += costs(chosen, c);
        for (const Room& room : chosen.rooms)
            text += fmt::format("  It {}.\n", room_in_words(room, chosen.request.wish, precision));
    }
    return text + fmt::format("Times are of this run: {} rays of the scene against {} of its solids.\n",
                              chosen.timed.rays, chosen.timed.solids);
}

}  // namespace lostbits::output::choice
