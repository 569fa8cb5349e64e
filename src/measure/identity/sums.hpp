// A number of a formula as a sum of products, whatever brackets it was written with: what identities are found in.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>

#include "measure/identity/terms.hpp"

namespace lostbits::measure::identity {

/// A fraction of small whole numbers, in lowest terms, the lower one positive.
struct Ratio {
    std::int64_t over = 0, under = 1;

    Ratio() = default;
    Ratio(std::int64_t a, std::int64_t b);
    friend Ratio operator*(const Ratio& a, const Ratio& b) { return {a.over * b.over, a.under * b.under}; }
    friend Ratio operator+(const Ratio& a, const Ratio& b) {
        return {a.over * b.under + b.over * a.under, a.under * b.under};
    }
    friend Ratio operator-(const Ratio& a) { return {-a.over, a.under}; }
    friend bool operator==(const Ratio&, const Ratio&) = default;
};

/// Powers of numbers that are taken as they are, negative ones below the line.
using Product = std::map<NodeId, int>;
inline Product power(NodeId atom, int exponent) { return {{atom, exponent}}; }
Product times(Product a, const Product& b);
Product inverse(Product a);

/// Products with their factors; none is zero.
using Sum = std::map<Product, Ratio>;
Sum plus(Sum a, const Sum& b);
Sum times(const Sum& a, const Sum& b);

/// More products than these are no sum that a rule reads.
inline constexpr std::size_t most_products = 32;

/// Node i multiplied out. What is taken as it is: dot products, and whatever is not a sum, a difference, a product or a
/// quotient by one product; each stands for all that mean the same. `written`: as it was before rules were applied.
/// `kept`: these are taken as they are, too. Nothing where it would be too long.
std::optional<Sum> multiplied_out(const Terms& terms, NodeId i, bool written = false,
                                  const std::set<NodeId>& kept = {});

/// The node that `meaning`s are to be written with: the newest that a formula has of each.
using Newest = std::map<NodeId, NodeId>;
Newest newest_of(const Terms& terms, const std::vector<NodeId>& needed);

/// What all products have in common before the brackets, and between them a sum, the positive products first. The sum
/// is not empty.
NodeId written_out(Terms& terms, const Sum& sum, const Newest& newest, std::string_view label = {});

/// The common factor, and the sum without it.
std::pair<std::pair<Product, Ratio>, Sum> without_common(const Sum& sum);
/// A product with its factor.
NodeId product_of(Terms& terms, const Product& product, const Ratio& factor, const Newest& newest);

}  // namespace lostbits::measure::identity
