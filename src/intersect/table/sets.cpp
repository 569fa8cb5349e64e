#include "intersect/table/sets.hpp"

#include <algorithm>
#include <deque>
#include <mutex>

#include "number/error.hpp"

namespace lostbits::intersect::table {

namespace {

/// A set of forms, and the data that its form points to.
struct FormSet {
    std::vector<const Intersector*> parts;
    std::string name, title, source;
    /// Indexed as `Info::by_shape`, then by shape.
    std::array<std::array<Convention, all_shapes.size()>, 3> conventions;
    Info info;
    Intersector intersector;
};

template <class S>
Shape shape_of_target(const Target<S>& target) {
    return target.primitives.front().shape;
}

/// The shape of the target among the arguments of one of the form's functions.
template <class First, class... Rest>
Shape shape_of_arguments(const First& first, const Rest&... rest) {
    if constexpr (requires { shape_of_target(first); }) return shape_of_target(first);
    else return shape_of_arguments(rest...);
}

/// Gives the set's form the function `member`, if every form of the set has one. The form's function calls the function
/// of the form for the target's shape. Pass the same member again as the argument, from which R and A are deduced.
template <auto member, class R, class... A>
void forward_if_all_have(FormSet& set, Function<R(A...)> Intersector::*) {
    if (!std::ranges::all_of(set.parts, [](const Intersector* part) { return static_cast<bool>(part->*member); }))
        return;
    set.intersector.*
        member = {[](void* context, A... a) -> R {
                      return (static_cast<Intersector*>(context)->form_for(shape_of_arguments(a...)).*member)(a...);
                  },
                  &set.intersector};
}

/// The arithmetic of the form for the target's shape. A form that does not filter decides every ray in its own
/// arithmetic.
DecidingArithmetic deciding_arithmetic_of_part(void* context, const Format& format, const Ray<double>& ray,
                                               const Target<double>& target, double tmax) {
    const Intersector& form = static_cast<Intersector*>(context)->form_for(shape_of_target(target));
    return form.deciding_arithmetic ? form.deciding_arithmetic(format, ray, target, tmax) : DecidingArithmetic::own;
}

void forward_all(FormSet& set) {
    forward_if_all_have<&Intersector::native32>(set, &Intersector::native32);
    forward_if_all_have<&Intersector::native64>(set, &Intersector::native64);
    forward_if_all_have<&Intersector::rounded>(set, &Intersector::rounded);
    forward_if_all_have<&Intersector::ball>(set, &Intersector::ball);
    forward_if_all_have<&Intersector::interval>(set, &Intersector::interval);
    forward_if_all_have<&Intersector::record>(set, &Intersector::record);
    forward_if_all_have<&Intersector::record_all>(set, &Intersector::record_all);
    forward_if_all_have<&Intersector::count>(set, &Intersector::count);
    forward_if_all_have<&Intersector::bounded>(set, &Intersector::bounded);
    if (std::ranges::any_of(set.parts,
                            [](const Intersector* part) { return static_cast<bool>(part->deciding_arithmetic); }))
        set.intersector.deciding_arithmetic = {deciding_arithmetic_of_part, &set.intersector};
}

/// The value of `member` if all forms of the set agree on it, else `otherwise`.
template <class T>
T common_value(const FormSet& set, T Info::*member, T otherwise) {
    const T first = set.parts.front()->info->*member;
    const auto has_common_value = [&](const Intersector* part) { return part->info->*member == first; };
    return std::ranges::all_of(set.parts, has_common_value) ? first : otherwise;
}

bool any_yields(const FormSet& set, Roots roots) {
    return std::ranges::any_of(set.parts, [roots](const Intersector* part) { return part->info->roots == roots; });
}

void fill_conventions(FormSet& set) {
    constexpr std::array<std::optional<Touching>, 3> touchings{std::nullopt, Touching::hit, Touching::miss};
    for (std::size_t j = 0; j < touchings.size(); ++j) {
        bool are_equal = true;
        for (const Intersector* const part : set.parts) {
            const Convention own = part->info->convention(touchings[j]);
            set.conventions[j][static_cast<std::size_t>(part->shape)] = own;
            are_equal = are_equal && own == set.parts.front()->info->convention(touchings[j]);
        }
        set.info.by_shape[j] = are_equal ? nullptr : set.conventions[j].data();
    }
}

void fill_set(FormSet& set) {
    for (const Intersector* const part : set.parts) {
        const auto add = [&set](std::string& text, std::string_view separator, std::string_view addition) {
            text.append(text.empty() ? "" : separator).append(addition);
        };
        add(set.name, "+", part->info->name);
        add(set.title, "; ", part->info->title);
        if (set.source != part->info->source) add(set.source, "; ", part->info->source);
    }

    // The set states one value if its forms disagree; `fill_conventions` keeps their conventions by shape.
    set.info = {.name = set.name,
                .title = set.title,
                .source = set.source,
                .direction = common_value(set, &Info::direction, Direction::unit),
                .roots = common_value(set, &Info::roots,
                                      any_yields(set, Roots::near_only) ? Roots::near_only : Roots::first_only),
                .touching = common_value(set, &Info::touching, Touching::hit),
                .at_origin = common_value(set, &Info::at_origin, AtOrigin::hit),
                .formats = common_value(set, &Info::formats, Formats::binary32_only),
                .inside = common_value(set, &Info::inside, Inside::usual),
                .facing = common_value(set, &Info::facing, Facing::both),
                .endless = common_value(set, &Info::endless, false)};
    fill_conventions(set);

    set.intersector = {.info = &set.info,
                       .shape = set.parts.front()->shape,
                       .native32 = nullptr,
                       .native64 = nullptr,
                       .parts = set.parts};
    forward_all(set);
}

}  // namespace

namespace {

bool share_a_format(const std::vector<const Intersector*>& parts) {
    const auto all_have = [&parts](auto kernel) {
        return std::ranges::all_of(parts,
                                   [kernel](const Intersector* part) { return static_cast<bool>(part->*kernel); });
    };
    return all_have(&Intersector::native32) || all_have(&Intersector::native64) || all_have(&Intersector::rounded);
}

}  // namespace

std::string refusal_of_set(const std::vector<const Intersector*>& parts) {
    const auto name = [](const Intersector* part) { return std::string(part->info->name); };
    for (const Intersector* const part : parts) {
        if (!is_primitive(part->shape))
            return name(part) + " marches through the field of all primitives at once; name it alone";
        const auto first_of_shape = std::ranges::find(parts, part->shape, &Intersector::shape);
        if (*first_of_shape != part)
            return name(*first_of_shape) + " and " + name(part) + " are both for " +
                   std::string(row_of(part->shape).plural) + "; name one form for each shape";
    }

    // All forms have a transform, or none.
    const auto without_transform =
        std::ranges::find_if_not(parts, [](const Intersector* part) { return part->has_transform_method; });
    const auto with_transform =
        std::ranges::find_if(parts, [](const Intersector* part) { return part->has_transform_method; });
    if (without_transform != parts.end() && with_transform != parts.end())
        return name(*without_transform) + " has no transform and " + name(*with_transform) +
               " has one; write @TRANSFORM after each form, or after none";

    if (!share_a_format(parts)) return "these forms have no format in common; name forms that run in the same format";

    // All forms yield t, or none.
    const auto yields_t = [](const Intersector* part) { return part->info->roots != Roots::none; };
    const auto without_t = std::ranges::find_if_not(parts, yields_t), with_t = std::ranges::find_if(parts, yields_t);
    if (without_t == parts.end() || with_t == parts.end()) return "";
    return name(*without_t) + " yields only hit or miss, but " + name(*with_t) +
           " yields t, so the first of their primitives cannot be found; name forms that all yield t";
}

const Intersector& find_or_add_set(std::vector<const Intersector*> parts) {
    std::ranges::sort(parts, {}, &Intersector::shape);
    if (const std::string reason = refusal_of_set(parts); !reason.empty()) throw InputError(reason);
    static std::mutex mutex;
    static std::deque<FormSet> sets;
    const std::lock_guard lock(mutex);
    const auto known_set = std::ranges::find(sets, parts, &FormSet::parts);
    if (known_set != sets.end()) return known_set->intersector;
    FormSet& set = sets.emplace_back();
    set.parts = std::move(parts);
    fill_set(set);
    return set.intersector;
}

}  // namespace lostbits::intersect::table
