// The exact answer to a ray at a torus, in fractions: the quartic in t itself, its roots told apart by halves with
// Sturm's theorem. No span and no form computes that.
#pragma once

#include <algorithm>
#include <vector>

#include "geometry/ray.hpp"
#include "intersect/exact.hpp"
#include "shapes/torus/torus.hpp"

namespace lostbits::test {

/// Of 1, t, t², …; the last is not 0.
using Powers = std::vector<Rational>;

inline void trim(Powers& f) {
    while (!f.empty() && f.back() == 0) f.pop_back();
}
inline Rational value_of(const Powers& f, const Rational& t) {
    Rational y = 0;
    for (std::size_t i = f.size(); i-- > 0;) y = y * t + f[i];
    return y;
}
inline Powers times(const Powers& f, const Powers& g) {
    Powers h(f.size() + g.size() - 1, Rational(0));
    for (std::size_t i = 0; i < f.size(); ++i)
        for (std::size_t j = 0; j < g.size(); ++j) h[i + j] += f[i] * g[j];
    return h;
}
inline Powers slope_of(const Powers& f) {
    Powers d;
    for (std::size_t i = 1; i < f.size(); ++i) d.push_back(f[i] * static_cast<int>(i));
    return d;
}
/// f over g, and the rest in the place of f.
inline Powers divided(Powers& f, const Powers& g) {
    Powers q(f.size() >= g.size() ? f.size() - g.size() + 1 : 0, Rational(0));
    for (std::size_t k = q.size(); k-- > 0;) {
        q[k] = f[k + g.size() - 1] / g.back();
        for (std::size_t i = 0; i < g.size(); ++i) f[k + i] -= q[k] * g[i];
    }
    trim(f);
    return q;
}

class TorusAnswer {
public:
    struct Root {
        Rational low, high;  ///< it is in between, or is both, and no other is
        bool crosses;
    };

    TorusAnswer(const Ray<double>& ray, const Torus<double>& torus) : q_(quartic(ray, torus)) {
        std::vector<Powers> chain = chain_of(q_);
        simple_ = q_;
        if (chain.back().size() > 1) {
            Powers rest = q_;
            simple_ = divided(rest, chain.back());
            chain = chain_of(simple_);
        }
        chain_ = chain;
        Rational bound = 1;
        for (const Rational& c : simple_) bound += abs(Rational(c / simple_.back()));
        isolate(-bound, bound);
        for (Root& root : roots_) {
            // An end that is another root says nothing of what is beside it.
            while (root.low != root.high && (value_of(q_, root.low) == 0 || value_of(q_, root.high) == 0)) halve(root);
            const Rational aside = root.low == root.high ? gap() : Rational(0);
            root.crosses = (value_of(q_, root.low - aside) < 0) != (value_of(q_, root.high + aside) < 0);
        }
    }

    [[nodiscard]] const std::vector<Root>& roots() const { return roots_; }
    [[nodiscard]] Rational at(const Rational& t) const { return value_of(q_, t); }
    /// How many roots lie in low ≤ t ≤ high.
    [[nodiscard]] int count(const Rational& low, const Rational& high) const {
        return changes(low) - changes(high) + (value_of(simple_, low) == 0 ? 1 : 0);
    }
    /// The first that is at least t; of those that are crossed, where that is asked. Null where there is none.
    [[nodiscard]] const Root* first(const Rational& t, bool crossed = false) const {
        for (const Root& root : roots_)
            if ((!crossed || root.crosses) && (root.low >= t || count(t, root.high) > 0)) return &root;
        return nullptr;
    }
    /// No root is a double one, complex roots included.
    [[nodiscard]] bool is_square_free() const { return simple_.size() == q_.size(); }
    [[nodiscard]] bool meets() const { return first(0) != nullptr; }
    [[nodiscard]] bool goes_through() const { return first(0, true) != nullptr; }
    [[nodiscard]] bool holds(const Rational& t) const { return at(t) <= 0; }
    [[nodiscard]] bool is_within(const Rational& t) const { return at(t) < 0; }
    [[nodiscard]] bool is_first(const Rational& t, const Rational& e) const { return is_first_from(0, t, e); }
    /// The same of the first root that is at least `from`, and of the first that is crossed.
    [[nodiscard]] bool is_first_from(const Rational& from, const Rational& t, const Rational& e,
                                     bool crossed = false) const {
        const Root* const root = first(from, crossed);
        if (root == nullptr) return false;
        if (root->low == root->high) return t - e <= root->low && root->low <= t + e;
        return count(std::max(Rational(t - e), root->low), std::min(Rational(t + e), root->high)) > 0;
    }

    /// A double next to a root, or the root where it is one.
    [[nodiscard]] double near(Root root) const {
        for (int i = 0; i < 80 && root.low != root.high; ++i) halve(root);
        return Rational((root.low + root.high) / 2).convert_to<double>();
    }

private:
    /// n² (p² + R² − r²)² − 4 R² |n × p|² with p = f + t d.
    static Powers quartic(const Ray<double>& ray, const Torus<double>& torus) {
        std::array<Powers, 3> p;
        std::array<Rational, 3> n;
        for (int i = 0; i < 3; ++i) {
            const auto k = static_cast<std::size_t>(i);
            p[k] = {Rational(ray.origin[i]) - Rational(torus.centre[i]), Rational(ray.direction[i])};
            n[k] = Rational(torus.axis[i]);
        }
        const Rational R(torus.major_radius), r(torus.minor_radius);
        const auto add = [](Powers& to, const Powers& f, const Rational& k) {
            to.resize(std::max(to.size(), f.size()), Rational(0));
            for (std::size_t i = 0; i < f.size(); ++i) to[i] += k * f[i];
        };
        Powers inner{R * R - r * r}, q;
        for (const Powers& x : p) add(inner, times(x, x), 1);
        add(q, times(inner, inner), Rational(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]));
        for (std::size_t i = 0; i < 3; ++i) {
            Powers across{0};
            add(across, p[(i + 2) % 3], n[(i + 1) % 3]), add(across, p[(i + 1) % 3], Rational(-n[(i + 2) % 3]));
            add(q, times(across, across), Rational(-4 * R * R));
        }
        trim(q);
        return q;
    }
    static std::vector<Powers> chain_of(const Powers& f) {
        std::vector<Powers> chain{f, slope_of(f)};
        while (chain.back().size() > 1) {
            Powers rest = chain[chain.size() - 2];
            divided(rest, chain.back());
            if (rest.empty()) break;
            for (Rational& c : rest) c = -c;
            chain.push_back(rest);
        }
        return chain;
    }
    [[nodiscard]] int changes(const Rational& t) const {
        int count = 0, before = 0;
        for (const Powers& f : chain_) {
            const int sign = value_of(f, t).sign();
            if (sign == 0) continue;
            count += before != 0 && sign != before ? 1 : 0;
            before = sign;
        }
        return count;
    }
    /// Those in low < t ≤ high, where neither end is a root.
    void isolate(const Rational& low, const Rational& high) {
        const int many = changes(low) - changes(high);
        if (many == 0) return;
        if (many == 1) return roots_.push_back({low, high, false});
        const Rational middle = (low + high) / 2;
        if (value_of(simple_, middle) == 0) {
            Rational beside = (high - low) / 4;
            while (changes(Rational(middle - beside)) - changes(Rational(middle + beside)) > 1) beside /= 2;
            isolate(low, middle - beside), roots_.push_back({middle, middle, false}), isolate(middle + beside, high);
        } else {
            isolate(low, middle), isolate(middle, high);
        }
    }
    void halve(Root& root) const {
        const Rational middle = (root.low + root.high) / 2;
        if (value_of(simple_, middle) == 0) root.low = root.high = middle;
        else (changes(root.low) - changes(middle) > 0 ? root.high : root.low) = middle;
    }
    /// Less than what any two roots are apart.
    [[nodiscard]] Rational gap() const {
        Rational least = 1;
        for (std::size_t i = 1; i < roots_.size(); ++i)
            if (const Rational apart = roots_[i].low - roots_[i - 1].high; apart > 0) least = std::min(least, apart);
        return least / 2;
    }

    Powers q_, simple_;
    std::vector<Powers> chain_;
    std::vector<Root> roots_;
};

/// With the question whether no equality is near: what is asked of a torus whose tube is a little thinner or thicker
/// has as many roots ahead, and begins on the same side.
struct ClearTorusAnswer : TorusAnswer {
    Ray<double> ray;
    Torus<double> torus;

    ClearTorusAnswer(const Ray<double>& r, const Torus<double>& t) : TorusAnswer(r, t), ray(r), torus(t) {}
    [[nodiscard]] bool is_clear() const {
        const auto ahead = [&](const TorusAnswer& a) {
            int count = a.is_within(0) ? 10 : 0;
            for (const Root& root : a.roots()) count += root.low > 0 || a.count(0, root.high) > 0 ? 1 : 0;
            return count;
        };
        for (const double k : {1 - 0x1p-16, 1 + 0x1p-16}) {
            Torus<double> other = torus;
            other.minor_radius *= k;
            if (other.minor_radius >= other.major_radius || ahead(TorusAnswer(ray, other)) != ahead(*this))
                return false;
        }
        return true;
    }
};

}  // namespace lostbits::test
