// A reader of s-expressions and an evaluator of the part of FPCore that `explain --fpcore` writes, over the machine's
// own numbers.
#pragma once

#include <array>
#include <cfenv>
#include <cmath>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace lostbits::test {

struct SExpression {
    std::string atom;
    std::vector<SExpression> list;
};

/// Reads one expression from `at` on; throws if its brackets do not balance.
inline SExpression read_expression(const std::string& text, std::size_t& at) {
    const auto skip = [&] {
        while (at < text.size() && std::isspace(static_cast<unsigned char>(text[at]))) ++at;
    };
    skip();
    if (at >= text.size()) throw std::runtime_error("ends early");
    if (text[at] == '(' || text[at] == '[') {
        const char close = text[at++] == '(' ? ')' : ']';
        SExpression e;
        for (skip(); at < text.size() && text[at] != close; skip()) e.list.push_back(read_expression(text, at));
        if (at++ >= text.size()) throw std::runtime_error("a bracket stays open");
        return e;
    }
    SExpression e;
    if (text[at] == '"') {
        do e.atom += text[at++];
        while (at < text.size() && text[at] != '"');
        ++at;
        return e;
    }
    while (at < text.size() && !std::isspace(static_cast<unsigned char>(text[at])) &&
           std::string("()[]").find(text[at]) == std::string::npos)
        e.atom += text[at++];
    return e;
}

/// Evaluates in binary32 or binary64, and rounds each operation as the context that `!` sets says; booleans are 1 and
/// 0. Variables keep the value they were bound to, whatever the context that reads them.
class FpCore {
public:
    struct Context {
        bool single = false;
        int round = FE_TONEAREST;
    };

    FpCore(std::map<std::string, double> values, Context context) : values_(std::move(values)), context_(context) {}

    double operator()(const SExpression& e) {
        if (e.list.empty()) return atom(e.atom);
        const std::string& f = e.list.front().atom;
        const auto arg = [&](std::size_t i) { return (*this)(e.list.at(i)); };
        const std::size_t n = e.list.size();
        if (f == "let*") {
            for (const SExpression& binding : e.list.at(1).list)
                values_[binding.list.at(0).atom] = (*this)(binding.list.at(1));
            return arg(2);
        }
        if (f == "!") return in_context(e);
        if (f == "if") return arg(1) != 0 ? arg(2) : arg(3);
        if (f == "and" || f == "or") {
            for (std::size_t i = 1; i < n; ++i) {
                if ((arg(i) != 0) == (f == "or")) return f == "or";
            }
            return f == "and";
        }
        if (f == "not") return arg(1) == 0;
        if (f == "<") return arg(1) < arg(2);
        if (f == "<=") return n == 3 ? arg(1) <= arg(2) : arg(1) <= arg(2) && arg(2) <= arg(3);
        if (f == ">") return arg(1) > arg(2);
        if (f == ">=") return arg(1) >= arg(2);
        if (f == "==") return arg(1) == arg(2);
        if (f == "-" && n == 2) return -arg(1);
        if (f == "fabs") return std::fabs(arg(1));
        if (f == "copysign") return std::copysign(arg(1), arg(2));
        if (f == "cast") return context_.single ? static_cast<double>(static_cast<float>(arg(1))) : arg(1);
        if (f == "pow" && arg(1) == 2) return std::ldexp(1.0, static_cast<int>(arg(2)));
        std::array<double, 3> x{};
        for (std::size_t i = 1; i < n; ++i) x.at(i - 1) = arg(i);
        return context_.single ? rounded<float>(f, x) : rounded<double>(f, x);
    }

private:
    double in_context(const SExpression& e) {
        const Context before = context_;
        for (std::size_t i = 1; i + 1 < e.list.size(); i += 2) {
            const std::string &key = e.list[i].atom, &value = e.list[i + 1].atom;
            if (key == ":precision" && (value == "binary32" || value == "binary64"))
                context_.single = value == "binary32";
            else if (key == ":round" && value == "toPositive") context_.round = FE_UPWARD;
            else if (key == ":round" && value == "toNegative") context_.round = FE_DOWNWARD;
            else throw std::runtime_error("unknown property " + key + " " + value);
        }
        const double value = (*this)(e.list.back());
        context_ = before;
        return value;
    }
    /// Operands of a narrower context are already numbers of this context.
    template <class F>
    double rounded(const std::string& f, const std::array<double, 3>& of) const {
        volatile F x = static_cast<F>(of[0]), y = static_cast<F>(of[1]), z = static_cast<F>(of[2]), result;
        if (x != of[0] && !std::isnan(of[0])) throw std::runtime_error("an operand is wider than its context");
        std::fesetround(context_.round);
        if (f == "+") result = x + y;
        else if (f == "-") result = x - y;
        else if (f == "*") result = x * y;
        else if (f == "/") result = x / y;
        else if (f == "sqrt") result = std::sqrt(x);
        else if (f == "fma") result = std::fma(x, y, z);
        else throw std::runtime_error("unknown operator " + f);
        std::fesetround(FE_TONEAREST);
        return result;
    }
    double atom(const std::string& a) const {
        if (const auto found = values_.find(a); found != values_.end()) return found->second;
        if (a == "INFINITY") return HUGE_VAL;
        if (a == "NAN") return std::nan("");
        const auto slash = a.find('/');
        const double x =
            slash == std::string::npos ? std::stod(a) : std::stod(a.substr(0, slash)) / std::stod(a.substr(slash + 1));
        return context_.single ? static_cast<double>(static_cast<float>(x)) : x;
    }
    std::map<std::string, double> values_;
    Context context_;
};

}  // namespace lostbits::test
