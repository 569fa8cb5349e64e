// Numbers the values of several tapes: equal operations on equal values get one number.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "number/tape.hpp"

namespace lostbits::measure::repair {

/// Values of several tapes, numbered.
class SharedNodes {
public:
    /// Number of the value of an operation on numbered values. Sums and products do not depend on the order of their
    /// two operands.
    int value_of(TapeOp op, const FloatFormat& format, std::array<int, 3> operands) {
        if ((op == TapeOp::add || op == TapeOp::mul) && operands[0] > operands[1]) std::swap(operands[0], operands[1]);
        return value_with_key({op, is_decision(op) ? -1 : index_of(format), operands, 0});
    }
    int constant(double x, const FloatFormat& format) {
        return value_with_key({TapeOp::constant, index_of(format), {-1, -1, -1}, std::bit_cast<std::uint64_t>(x)});
    }
    int input(int k, const FloatFormat& format) {
        return value_with_key({TapeOp::input, index_of(format), {k, -1, -1}, 0});
    }

    /// Number of the value of each node. `replaced_values`: values that some nodes have instead of their own.
    std::vector<int> values_of(const Tape& tape, const std::map<NodeId, int>& replaced_values = {}) {
        std::vector<int> values;
        for (NodeId i = 0; i < tape.size(); ++i) {
            const TapeNode& n = tape[i];
            const FloatFormat& format = tape.format_of(i);
            const auto replacement = replaced_values.find(i);
            if (replacement != replaced_values.end()) {
                values.push_back(replacement->second);
            } else if (n.op == TapeOp::input) {
                values.push_back(input(n.operands[0], format));
            } else if (n.op == TapeOp::constant) {
                values.push_back(constant(n.operands[0], format));
            } else {
                std::array<int, 3> operands{-1, -1, -1};
                for (std::size_t k = 0; k < row_of(n.op).operand_count; ++k) operands[k] = values[n.operands[k]];
                values.push_back(folded_value_of(n.op, format, operands));
            }
        }
        return values;
    }
    /// Constant with this number; null if the value is not a constant.
    [[nodiscard]] const double* constant_of(int value) const {
        const auto found = constants_.find(value);
        return found == constants_.end() ? nullptr : &found->second;
    }

private:
    using Key = std::tuple<TapeOp, int, std::array<int, 3>, std::uint64_t>;

    int value_with_key(const Key& key) {
        const int value = values_.try_emplace(key, static_cast<int>(values_.size())).first->second;
        if (std::get<0>(key) == TapeOp::constant) constants_[value] = std::bit_cast<double>(std::get<3>(key));
        return value;
    }
    int index_of(const FloatFormat& format) {
        for (std::size_t k = 0; k < formats_.size(); ++k)
            if (formats_[k] == format) return static_cast<int>(k);
        formats_.push_back(format);
        return static_cast<int>(formats_.size() - 1);
    }
    /// Number of the value of an operation. Folds operations on constants: a formula computes its constants from small
    /// integers, and each constant gets one number.
    int folded_value_of(TapeOp op, const FloatFormat& format, const std::array<int, 3>& operands) {
        const double* const a = constant_of(operands[0]);
        const double* const b = operands[1] < 0 ? nullptr : constant_of(operands[1]);
        const auto rounded = [&](double x) {
            return constant(format == binary32 ? static_cast<double>(static_cast<float>(x)) : x, format);
        };
        const bool is_native = format == binary32 || format == binary64;
        if (a != nullptr && is_native) {
            if (op == TapeOp::neg) return rounded(-*a);
            if (op == TapeOp::convert) return rounded(*a);
            if (b != nullptr && op == TapeOp::add) return rounded(*a + *b);
            if (b != nullptr && op == TapeOp::sub) return rounded(*a - *b);
            if (b != nullptr && op == TapeOp::mul) return rounded(*a * *b);
            if (b != nullptr && op == TapeOp::div) return rounded(*a / *b);
        }
        return value_of(op, format, operands);
    }

    std::map<Key, int> values_;
    std::map<int, double> constants_;
    std::vector<FloatFormat> formats_;
};

}  // namespace lostbits::measure::repair
