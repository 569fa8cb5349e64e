#include "exact/draw.hpp"

#include <bit>
#include <cmath>
#include <limits>

namespace lostbits::exact {

Chance::Chance(std::uint64_t seed) {
    for (std::uint64_t& word : s_) {  // splitmix64
        std::uint64_t z = seed += 0x9e3779b97f4a7c15;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
        z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
        word = z ^ (z >> 31);
    }
}

std::uint64_t Chance::bits() {
    const std::uint64_t result = std::rotl(s_[0] + s_[3], 23) + s_[0], t = s_[1] << 17;
    s_[2] ^= s_[0], s_[3] ^= s_[1], s_[1] ^= s_[2], s_[0] ^= s_[3], s_[2] ^= t;
    s_[3] = std::rotl(s_[3], 45);
    return result;
}

namespace {

/// Kinds of the numbers of a primitive: (p)oints of three numbers, (d)irections, (r)adii > 0, (n)o less than 0, (i)nner
/// < the one before and no less than 0, (m)inor < the one before and > 0, (h)igh corners.
std::string_view layout_of(std::string_view shape) {
    if (shape == "sphere") return "pr";
    if (shape == "box") return "ph";
    if (shape == "triangle") return "ppp";
    if (shape == "ellipsoid") return "prrr";
    if (shape == "cone") return "pprn";
    if (shape == "disc") return "pdri";
    if (shape == "plane") return "pd";
    if (shape == "torus") return "pdrm";
    return "ppr";
}
bool is_triple(char c) { return c == 'p' || c == 'd' || c == 'h'; }
std::size_t numbers_in(std::string_view layout) {
    std::size_t n = 0;
    for (const char c : layout) n += is_triple(c) ? 3 : 1;
    return n;
}

/// True if the three numbers at k are those at l, or 0 each without an l.
bool is_zero(const Problem& problem, std::size_t k) {
    return problem.primitive[k] == 0 && problem.primitive[k + 1] == 0 && problem.primitive[k + 2] == 0;
}
bool are_same(const Problem& problem, std::size_t k, std::size_t l) {
    return problem.primitive[k] == problem.primitive[l] && problem.primitive[k + 1] == problem.primitive[l + 1] &&
           problem.primitive[k + 2] == problem.primitive[l + 2];
}
bool are_on_one_line(const Problem& problem) {
    const auto point = [&problem](std::size_t k) {
        return Vector<Whole>{Whole(problem.primitive[k]), Whole(problem.primitive[k + 1]),
                             Whole(problem.primitive[k + 2])};
    };
    const Vector<Whole> n = cross(point(3) - point(0), point(6) - point(0));
    return sign(n.x) == 0 && sign(n.y) == 0 && sign(n.z) == 0;
}

/// True if the problem is a ray and a primitive in numbers of the format, and its range contains a t.
template <class S>
bool is_proper(std::string_view layout, const Problem& problem) {
    const auto is_number = [](double x) {
        return std::isfinite(static_cast<S>(x)) && static_cast<double>(static_cast<S>(x)) == x;
    };
    for (const double x : problem.ray)
        if (!is_number(x)) return false;
    for (std::size_t k = 0; k < numbers_in(layout); ++k)
        if (!is_number(problem.primitive[k])) return false;
    if (problem.ray[3] == 0 && problem.ray[4] == 0 && problem.ray[5] == 0) return false;
    if (!is_number(problem.tmin) || !(problem.tmin >= 0)) return false;
    if (!(problem.tmax == INFINITY || is_number(problem.tmax)) || problem.tmax < problem.tmin) return false;
    if (problem.tmax == problem.tmin && (problem.open_tmin || problem.open_tmax)) return false;
    std::size_t k = 0;
    for (const char c : layout) {
        if ((c == 'r' || c == 'm') && !(problem.primitive[k] > 0)) return false;
        if (c == 'n' && !(problem.primitive[k] >= 0)) return false;
        if ((c == 'i' || c == 'm') && !(problem.primitive[k] >= 0 && problem.primitive[k] < problem.primitive[k - 1]))
            return false;
        if (c == 'd' && is_zero(problem, k)) return false;
        for (std::size_t i = k; c == 'h' && i < k + 3; ++i)
            if (problem.primitive[i] < problem.primitive[i - 3]) return false;
        k += is_triple(c) ? 3 : 1;
    }
    if (layout == "ppp") return !are_on_one_line(problem);
    return !layout.starts_with("pp") || !are_same(problem, 0, 3);
}

/// Each number through `draw(kind)`, corners in order.
template <class Draw>
void draw_primitive(std::string_view layout, Problem& problem, const Draw& draw) {
    std::size_t k = 0;
    for (const char c : layout)
        for (const std::size_t end = k + (is_triple(c) ? 3 : 1); k < end; ++k) {
            problem.primitive[k] = draw(c);
            if (c == 'h' && problem.primitive[k] < problem.primitive[k - 3])
                std::swap(problem.primitive[k], problem.primitive[k - 3]);
            if ((c == 'i' || c == 'm') && problem.primitive[k] > problem.primitive[k - 1])
                std::swap(problem.primitive[k], problem.primitive[k - 1]);
        }
}

/// A point of the primitive, or one beside it.
void aim_at(std::string_view layout, const Problem& problem, Chance& chance, double (&target)[3]) {
    const double u = (chance.part() + 1) * 0.6 - 0.1, v = (chance.part() + 1) * 0.6 - 0.1;
    for (std::size_t i = 0; i < 3; ++i) {
        target[i] = problem.primitive[i];
        if (layout == "ph")
            target[i] += ((chance.part() + 1) * 0.6 - 0.1) * (problem.primitive[i + 3] - problem.primitive[i]);
        else if (layout == "ppp")
            target[i] += u * (problem.primitive[i + 3] - problem.primitive[i]) +
                         v * (problem.primitive[i + 6] - problem.primitive[i]);
        else if (layout.starts_with("pp")) target[i] += u * (problem.primitive[i + 3] - problem.primitive[i]);
        if (layout == "pr") target[i] += 1.1 * chance.part() * problem.primitive[3];
        else if (layout == "prrr") target[i] += 1.1 * chance.part() * problem.primitive[3 + i];
        else if (layout.ends_with('r') || layout.ends_with('n'))
            target[i] += 1.2 * chance.part() * problem.primitive[6];
        else if (layout.starts_with("pdr")) target[i] += 1.2 * chance.part() * problem.primitive[6];
    }
}

template <class S>
Problem random_problem(std::string_view layout, Ends ends, Chance& chance) {
    Problem p{.ray = {}, .open_tmin = ends.open_tmin, .open_tmax = ends.open_tmax};
    const double size = std::ldexp(1, chance.below(9) - 4);
    draw_primitive(layout, p, [&](char c) {
        const double x = size * chance.part();
        return stored<S>(c == 'p' || c == 'h' ? 4 * x : c == 'd' ? x : std::fabs(x));
    });
    if (const int thin = 1 + chance.below(40); layout == "pdrm" && chance.below(2) == 0) {  // a wire, or a tiny hole
        const double of_major = chance.below(2) == 0 ? std::ldexp(1, -thin) : 1 - std::ldexp(1, -thin);
        p.primitive[7] = stored<S>(p.primitive[6] * of_major);
    }
    double target[3];
    aim_at(layout, p, chance, target);
    const double away = chance.below(4) == 0 ? 0.5 : std::ldexp(1, chance.below(15));
    const double step = std::ldexp(1, chance.below(7) - 3);
    const int along = chance.below(16);  // for a few, one component of the direction is 0
    for (std::size_t i = 0; i < 3; ++i) {
        const double d = along == static_cast<int>(i) ? 0 : chance.part();
        p.ray[i] = stored<S>(target[i] - 4 * size * away * d);
        p.ray[i + 3] = stored<S>(step * d);
    }
    if (chance.below(3) == 0) {
        const double t = 4 * size * away / step;
        p.tmin = stored<S>(std::fabs(chance.part()) * t);
        if (chance.below(2) == 0) p.tmax = stored<S>(p.tmin + std::fabs(chance.part()) * t);
    }
    return p;
}

/// Finite numbers of any bits.
template <class S>
double any_number(Chance& chance) {
    using Bits = std::conditional_t<sizeof(S) == 4, std::uint32_t, std::uint64_t>;
    return static_cast<double>(std::bit_cast<S>(static_cast<Bits>(chance.bits())));
}

template <class S>
Problem wild_problem(std::string_view layout, Ends ends, Chance& chance) {
    Problem p{.ray = {}, .open_tmin = ends.open_tmin, .open_tmax = ends.open_tmax};
    const auto any = [&chance] { return any_number<S>(chance); };
    draw_primitive(layout, p, [&](char c) { return c == 'p' || c == 'h' || c == 'd' ? any() : std::fabs(any()); });
    for (double& x : p.ray) x = any();
    for (std::size_t i = 0; i < 3 && chance.below(2) == 0; ++i) p.ray[i] = p.primitive[i];  // from a point of it
    if (chance.below(4) == 0) p.tmin = std::fabs(any());
    return p;
}

/// The power of two by which whole numbers are multiplied.
template <class S>
int power_of_unit(Chance& chance) {
    using Limits = std::numeric_limits<S>;
    switch (chance.below(8)) {
        case 0: return Limits::min_exponent - Limits::digits + chance.below(20);  // the least subnormal number, and on
        case 1: return Limits::max_exponent - 6 - chance.below(20);
        case 2: return chance.below(60) - 30;
        default: return 0;
    }
}

template <class S>
Problem made_problem(std::string_view layout, Ends ends, Chance& chance) {
    Problem p{.ray = {}, .open_tmin = ends.open_tmin, .open_tmax = ends.open_tmax};
    constexpr int reaches[] = {1, 2, 4, 13};
    const int reach = reaches[chance.below(4)];
    const auto whole = [&](int least) { return static_cast<double>(least + chance.below(reach + 1 - least)); };
    const bool aligned = chance.below(2) == 0;  // the second point is the first moved along an axis
    const std::size_t axis = static_cast<std::size_t>(chance.below(3));
    draw_primitive(layout, p, [&](char c) {
        return c == 'r' || c == 'm' ? whole(1) : c == 'n' || c == 'i' ? whole(0) : whole(-reach);
    });
    for (std::size_t i = 0; aligned && i < 3; ++i) {
        if (i == axis) continue;
        if (layout.starts_with("pd")) p.primitive[i + 3] = 0;
        else if (layout.starts_with("pp")) p.primitive[i + 3] = p.primitive[i];
    }
    for (std::size_t i = 3; i < 6; ++i) p.ray[i] = chance.below(3) == 0 ? 0 : whole(-reach);
    const double away = static_cast<double>(chance.below(6) - 1);
    const std::size_t from =
        layout.starts_with("pp") || layout == "ph" ? 3 * static_cast<std::size_t>(chance.below(2)) : 0;
    const double radius = p.primitive[layout.starts_with("pp") || layout.starts_with("pdr") ? 6 : 3];
    const bool aimed = chance.below(4) != 0, on_edge = chance.below(3) == 0;
    for (std::size_t i = 0; i < 3; ++i) {
        double at = p.primitive[from + i];
        if (layout == "ph" && chance.below(2) == 0)
            at = p.primitive[3 - from + i];  // a corner, or on an edge or a face
        else if (on_edge && layout == "ppp") at = p.primitive[6 + i];
        else if (layout != "ph" && layout != "ppp") {
            double r = layout == "prrr" ? p.primitive[3 + i] : radius;
            if (layout == "pdrm" && chance.below(2) == 0)  // the top, the hole, and all of it
                r = chance.below(2) == 0 ? p.primitive[7]
                                         : r + (chance.below(2) == 0 ? p.primitive[7] : -p.primitive[7]);
            at += r * static_cast<double>(chance.below(3) - 1);
        }
        p.ray[i] = aimed ? at - away * p.ray[i + 3] : whole(-reach);
    }
    if (chance.below(3) == 0) p.tmin = static_cast<double>(chance.below(6)) / 2;
    if (chance.below(3) == 0) p.tmax = p.tmin + static_cast<double>(chance.below(6)) / 2;
    const int unit = power_of_unit<S>(chance), of_direction = chance.below(2) == 0 ? unit : power_of_unit<S>(chance);
    std::size_t k = 0;
    for (const char c : layout)
        for (const std::size_t end = k + (is_triple(c) ? 3 : 1); k < end; ++k)
            p.primitive[k] = std::ldexp(p.primitive[k], c == 'd' ? of_direction : unit);
    for (std::size_t i = 0; i < 6; ++i) p.ray[i] = std::ldexp(p.ray[i], i < 3 ? unit : of_direction);
    p.tmin = std::ldexp(p.tmin, unit - of_direction), p.tmax = std::ldexp(p.tmax, unit - of_direction);
    if (chance.below(4) == 0) {  // one number is moved
        const std::size_t which = static_cast<std::size_t>(chance.below(static_cast<int>(6 + numbers_in(layout))));
        double& x = which < 6 ? p.ray[which] : p.primitive[which - 6];
        const S infinity = std::numeric_limits<S>::infinity();
        x = static_cast<double>(std::nextafter(static_cast<S>(x), chance.below(2) == 0 ? infinity : -infinity));
    }
    return p;
}

template <class S, class Draw>
void draw_proper(std::string_view shape, std::vector<Problem>& problems, const Draw& draw) {
    const std::string_view layout = layout_of(shape);
    for (Problem& p : problems) {
        do p = draw(layout);
        while (!is_proper<S>(layout, p));
    }
}

template <class S>
void draw_all_made(std::string_view shape, Ends ends, Chance& chance, std::vector<Problem>& problems) {
    draw_proper<S>(shape, problems, [&](std::string_view layout) {
        return chance.below(16) == 0 ? wild_problem<S>(layout, ends, chance) : made_problem<S>(layout, ends, chance);
    });
}
template <class S>
void draw_all_random(std::string_view shape, Ends ends, Chance& chance, std::vector<Problem>& problems) {
    draw_proper<S>(shape, problems, [&](std::string_view layout) { return random_problem<S>(layout, ends, chance); });
}

}  // namespace

void draw_random(const ShapeTest& shape, bool floats, Ends ends, Chance& chance, std::vector<Problem>& problems) {
    floats ? draw_all_random<float>(shape.name, ends, chance, problems)
           : draw_all_random<double>(shape.name, ends, chance, problems);
}

void draw_made(const ShapeTest& shape, bool floats, Ends ends, Chance& chance, std::vector<Problem>& problems) {
    floats ? draw_all_made<float>(shape.name, ends, chance, problems)
           : draw_all_made<double>(shape.name, ends, chance, problems);
}

}  // namespace lostbits::exact
