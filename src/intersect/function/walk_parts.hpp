// Parts that the files of `Walk` share: flags of instructions, integers of any width, and lanes of vectors.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "intersect/function/walk.hpp"

namespace lostbits::intersect::function {

inline constexpr std::size_t most_steps = 3'000'000;

inline void skip_flags(Cursor& at) {
    constexpr std::array flags{"nnan",     "ninf", "nsz",      "arcp",     "contract", "afn",
                               "reassoc",  "fast", "nuw",      "nsw",      "exact",    "disjoint",
                               "inbounds", "nneg", "samesign", "volatile", "nusw"};
    for (bool again = true; again;) {
        again = false;
        for (const char* const flag : flags) again = at.take(flag) || again;
    }
}

/// The bits of an integer type, sign-extended; of i1, 0 or 1.
inline std::int64_t wrapped(std::uint64_t x, int bits) {
    if (bits == 1) return static_cast<std::int64_t>(x & 1);
    if (bits >= 64) return static_cast<std::int64_t>(x);
    return static_cast<std::int64_t>(x << (64 - bits)) >> (64 - bits);
}

inline std::uint64_t without_sign(std::int64_t x, int bits) {
    return bits >= 64 ? static_cast<std::uint64_t>(x)
                      : static_cast<std::uint64_t>(x) & ((std::uint64_t{1} << bits) - 1);
}

/// Result of an integer operation; nothing if it has none (division by zero).
inline std::optional<std::int64_t> computed(std::string_view op, std::int64_t a, std::int64_t b, int bits) {
    const std::uint64_t x = without_sign(a, bits), y = without_sign(b, bits);
    const bool shifts = y < static_cast<std::uint64_t>(bits);
    if (op == "add") return wrapped(x + y, bits);
    if (op == "sub") return wrapped(x - y, bits);
    if (op == "mul") return wrapped(x * y, bits);
    if (op == "and") return wrapped(x & y, bits);
    if (op == "or") return wrapped(x | y, bits);
    if (op == "xor") return wrapped(x ^ y, bits);
    if (op == "shl") return shifts ? wrapped(x << y, bits) : 0;
    if (op == "lshr") return shifts ? wrapped(x >> y, bits) : 0;
    if (op == "ashr") return shifts ? wrapped(static_cast<std::uint64_t>(a >> y), bits) : 0;
    if (b == 0 || (b == -1 && a == INT64_MIN)) return {};
    if (op == "udiv") return wrapped(x / y, bits);
    if (op == "urem") return wrapped(x % y, bits);
    if (op == "sdiv") return wrapped(static_cast<std::uint64_t>(a / b), bits);
    if (op == "srem") return wrapped(static_cast<std::uint64_t>(a % b), bits);
    return {};
}

inline bool holds(std::string_view predicate, std::int64_t a, std::int64_t b, int bits) {
    const std::uint64_t x = without_sign(a, bits), y = without_sign(b, bits);
    if (bits == 1) a = -a, b = -b;
    if (predicate == "eq") return a == b;
    if (predicate == "ne") return a != b;
    if (predicate == "slt") return a < b;
    if (predicate == "sle") return a <= b;
    if (predicate == "sgt") return a > b;
    if (predicate == "sge") return a >= b;
    if (predicate == "ult") return x < y;
    if (predicate == "ule") return x <= y;
    if (predicate == "ugt") return x > y;
    return x >= y;
}

inline constexpr std::array whole_operations{"add", "sub",  "mul",  "udiv", "sdiv", "urem", "srem",
                                             "shl", "lshr", "ashr", "and",  "or",   "xor"};

/// The name of a function in the source, for messages.
inline std::string shown(const std::string& name) {
    if (name.starts_with("llvm.")) return name.substr(5, name.find('.', 5) - 5);
    return name;
}

/// Applies `act(type of a lane, offset)` to each lane of a vector, or to the type itself.
template <class Act>
Value Walk::each_lane(const Type& type, const Act& act) {
    if (!type.is_vector) return act(type, 0);
    Value all;
    for (std::size_t k = 0; k < type.count; ++k) {
        std::size_t at = 0;
        const Type& lane = *type.part(k, at);
        put(all, at, lane.size, act(lane, at));
    }
    return all;
}

}  // namespace lostbits::intersect::function
