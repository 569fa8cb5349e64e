// A number of a formula as a sum of products, independent of its brackets. Rules search for identities in such sums.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>

#include "measure/identity/terms.hpp"

namespace lostbits::measure::identity {

/// A fraction of small whole numbers in lowest terms, with a positive denominator.
struct Ratio {
    std::int64_t numerator = 0, denominator = 1;

    Ratio() = default;
    Ratio(std::int64_t a, std::int64_t b);
    friend Ratio operator*(const Ratio& a, const Ratio& b) {
        return {a.numerator * b.numerator, a.denominator * b.denominator};
    }
    friend Ratio operator+(const Ratio& a, const Ratio& b) {
        return {a.numerator * b.denominator + b.numerator * a.denominator, a.denominator * b.denominator};
    }
    friend Ratio operator-(const Ratio& a) { return {-a.numerator, a.denominator}; }
    friend bool operator==(const Ratio&, const Ratio&) = default;
};

/// Powers of atoms, which are numbers that are not multiplied out. An atom with a negative power is a divisor.
using Product = std::map<NodeId, int>;
inline Product power(NodeId atom, int exponent) { return {{atom, exponent}}; }
Product times(Product a, const Product& b);
Product inverse(Product a);

/// Products with their factors. No factor is zero.
using Sum = std::map<Product, Ratio>;
Sum plus(Sum a, const Sum& b);
Sum times(const Sum& a, const Sum& b);

/// Largest number of products in a sum. Rules skip longer sums.
inline constexpr std::size_t max_products = 32;

/// Multiplies out node i. Atoms are dot products, and all numbers that are not a sum, a difference, a product, or a
/// quotient by one product. Each atom represents all nodes with the same meaning. If `before_rules`, the nodes
/// are expanded in the form that they had before any rule was applied. `extra_atoms` are further nodes to use as atoms.
/// Returns nothing if the sum would be too long.
std::optional<Sum> multiply_out(const Terms& terms, NodeId i, bool before_rules = false,
                                const std::set<NodeId>& extra_atoms = {});

/// The node to write for each `meaning`: the newest node of a formula with that meaning.
using NewestNodes = std::map<NodeId, NodeId>;
NewestNodes find_newest_nodes(const Terms& terms, const std::vector<NodeId>& formula_nodes);

/// Writes a sum, which must not be empty, with the common factor of all products before the brackets and the positive
/// products first.
NodeId write_sum(Terms& terms, const Sum& sum, const NewestNodes& newest, std::string_view label = {});

/// A sum as the product of a common factor and the rest: factor · common · rest.
struct FactoredSum {
    Product common;
    Ratio factor;
    Sum rest;
};
FactoredSum factor_out_common(const Sum& sum);
/// Writes a product with its factor, and returns its node.
NodeId write_product(Terms& terms, const Product& product, const Ratio& factor, const NewestNodes& newest);

}  // namespace lostbits::measure::identity
