#include "intersect/table/sets.hpp"

#include <algorithm>
#include <deque>
#include <mutex>

#include "number/error.hpp"

namespace lostbits::intersect::table {

namespace {

/// A set, and the data that its row points to.
struct Made {
    std::vector<const Intersector*> parts;
    std::string name, title, source;
    /// Indexed as `Info::by_shape`, then by shape.
    std::array<std::array<Convention, all_shapes.size()>, 3> conventions;
    Info info;
    Intersector row;
};

template <class S>
Shape shape_of_target(const Target<S>& target) {
    return target.primitives.front().shape;
}

/// The shape that a call of one of the row's functions is about: that of the target among its arguments.
template <class First, class... Rest>
Shape asked_shape(const First& first, const Rest&... rest) {
    if constexpr (requires { shape_of_target(first); }) return shape_of_target(first);
    else return asked_shape(rest...);
}

/// Sets the function `Which` of the set's row, if every form of the set has it: it calls that of the form for the
/// target's shape.
template <auto Which, class R, class... A>
void pass_on(Made& set, Function<R(A...)> Intersector::*) {
    if (!std::ranges::all_of(set.parts, [](const Intersector* part) { return static_cast<bool>(part->*Which); }))
        return;
    set.row.*Which = {
        [](void* own, A... a) -> R { return (static_cast<Intersector*>(own)->of(asked_shape(a...)).*Which)(a...); },
        &set.row};
}

/// The way of the form for the target's shape. A form that does not filter settles every ray in its own arithmetic.
FilterArithmetic filter_arithmetic_of_part(void* own, const Format& format, const Ray<double>& ray,
                                           const Target<double>& target, double tmax) {
    const Intersector& form = static_cast<Intersector*>(own)->of(shape_of_target(target));
    return form.filter_arithmetic ? form.filter_arithmetic(format, ray, target, tmax) : FilterArithmetic::own;
}

void forward_all(Made& set) {
    pass_on<&Intersector::native32>(set, &Intersector::native32);
    pass_on<&Intersector::native64>(set, &Intersector::native64);
    pass_on<&Intersector::rounded>(set, &Intersector::rounded);
    pass_on<&Intersector::ball>(set, &Intersector::ball);
    pass_on<&Intersector::interval>(set, &Intersector::interval);
    pass_on<&Intersector::record>(set, &Intersector::record);
    pass_on<&Intersector::record_all>(set, &Intersector::record_all);
    pass_on<&Intersector::count>(set, &Intersector::count);
    pass_on<&Intersector::bounded>(set, &Intersector::bounded);
    if (std::ranges::any_of(set.parts,
                            [](const Intersector* part) { return static_cast<bool>(part->filter_arithmetic); }))
        set.row.filter_arithmetic = {filter_arithmetic_of_part, &set.row};
}

/// The value of `member` if all forms of the set agree on it, else `otherwise`.
template <class T>
T common(const Made& set, T Info::*member, T otherwise) {
    const T first = set.parts.front()->info->*member;
    const auto same = [&](const Intersector* part) { return part->info->*member == first; };
    return std::ranges::all_of(set.parts, same) ? first : otherwise;
}

bool any_is(const Made& set, Roots roots) {
    return std::ranges::any_of(set.parts, [roots](const Intersector* part) { return part->info->roots == roots; });
}

void fill_conventions(Made& set) {
    constexpr std::array<std::optional<Touching>, 3> judged{std::nullopt, Touching::hit, Touching::miss};
    for (std::size_t j = 0; j < judged.size(); ++j) {
        bool same = true;
        for (const Intersector* const part : set.parts) {
            const Convention own = part->info->convention(judged[j]);
            set.conventions[j][static_cast<std::size_t>(part->shape)] = own;
            same = same && own == set.parts.front()->info->convention(judged[j]);
        }
        set.info.by_shape[j] = same ? nullptr : set.conventions[j].data();
    }
}

void fill(Made& set) {
    for (const Intersector* const part : set.parts) {
        const auto add = [&set](std::string& text, std::string_view separator, std::string_view words) {
            text.append(text.empty() ? "" : separator).append(words);
        };
        add(set.name, "+", part->info->name);
        add(set.title, "; ", part->info->title);
        if (set.source != part->info->source) add(set.source, "; ", part->info->source);
    }
    set.info = {
        .name = set.name,
        .title = set.title,
        .source = set.source,
        .direction = common(set, &Info::direction, Direction::unit),
        .roots = common(set, &Info::roots, any_is(set, Roots::near_only) ? Roots::near_only : Roots::first_only),
        .touching = common(set, &Info::touching, Touching::hit),
        .at_origin = common(set, &Info::at_origin, AtOrigin::hit),
        .formats = common(set, &Info::formats, Formats::binary32_only),
        .inside = common(set, &Info::inside, Inside::usual),
        .facing = common(set, &Info::facing, Facing::both),
        .endless = common(set, &Info::endless, false)};
    fill_conventions(set);
    set.row = {.info = &set.info,
               .shape = set.parts.front()->shape,
               .native32 = nullptr,
               .native64 = nullptr,
               .parts = set.parts};
    forward_all(set);
}

}  // namespace

namespace {

bool share_a_format(const std::vector<const Intersector*>& parts) {
    const auto all = [&parts](auto which) {
        return std::ranges::all_of(parts, [which](const Intersector* part) { return static_cast<bool>(part->*which); });
    };
    return all(&Intersector::native32) || all(&Intersector::native64) || all(&Intersector::rounded);
}

}  // namespace

std::string refusal_of_set(const std::vector<const Intersector*>& parts) {
    const auto name = [](const Intersector* part) { return std::string(part->info->name); };
    for (const Intersector* const part : parts) {
        if (!is_primitive(part->shape))
            return name(part) + " marches through the field of all primitives at once; name it alone";
        const auto same = std::ranges::find(parts, part->shape, &Intersector::shape);
        if (*same != part)
            return name(*same) + " and " + name(part) + " are both for " + std::string(row_of(part->shape).plural) +
                   "; name one form for each shape";
    }
    const auto bare = std::ranges::find_if_not(parts, [](const Intersector* part) { return part->is_placed; });
    const auto placed = std::ranges::find_if(parts, [](const Intersector* part) { return part->is_placed; });
    if (bare != parts.end() && placed != parts.end())
        return name(*bare) + " has no transform and " + name(*placed) +
               " has one; write @TRANSFORM after each form, or after none";
    if (!share_a_format(parts)) return "these forms have no format in common; name forms that run in the same format";
    const auto tells_t = [](const Intersector* part) { return part->info->roots != Roots::none; };
    const auto silent = std::ranges::find_if_not(parts, tells_t), telling = std::ranges::find_if(parts, tells_t);
    if (silent == parts.end() || telling == parts.end()) return "";
    return name(*silent) + " yields only hit or miss, but " + name(*telling) +
           " yields t, so the first of their primitives cannot be found; name forms that all yield t";
}

const Intersector& set_of(std::vector<const Intersector*> parts) {
    std::ranges::sort(parts, {}, &Intersector::shape);
    if (const std::string why = refusal_of_set(parts); !why.empty()) throw InputError(why);
    static std::mutex mutex;
    static std::deque<Made> all;
    const std::lock_guard lock(mutex);
    const auto made = std::ranges::find(all, parts, &Made::parts);
    if (made != all.end()) return made->row;
    Made& set = all.emplace_back();
    set.parts = std::move(parts);
    fill(set);
    return set.row;
}

}  // namespace lostbits::intersect::table
