// A reader of s-expressions and an evaluator of the part of FPCore that `explain --fpcore` writes, over the machine's own numbers.
#pragma once

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

/// One expression from `at` on; throws where brackets do not balance.
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
    while (at < text.size() && !std::isspace(static_cast<unsigned char>(text[at])) && std::string("()[]").find(text[at]) == std::string::npos) e.atom += text[at++];
    return e;
}

/// Evaluates in F; booleans are 1 and 0.
template <class F>
class FpCore {
public:
    explicit FpCore(std::map<std::string, F> values) : values_(std::move(values)) {}

    F operator()(const SExpression& e) {
        if (e.list.empty()) return atom(e.atom);
        const std::string& f = e.list.front().atom;
        const auto arg = [&](std::size_t i) { return (*this)(e.list.at(i)); };
        const std::size_t n = e.list.size();
        if (f == "let*") {
            for (const SExpression& binding : e.list.at(1).list) values_[binding.list.at(0).atom] = (*this)(binding.list.at(1));
            return arg(2);
        }
        if (f == "if") return arg(1) != 0 ? arg(2) : arg(3);
        if (f == "and") return arg(1) != 0 && arg(2) != 0;
        if (f == "or") return arg(1) != 0 || arg(2) != 0;
        if (f == "not") return arg(1) == 0;
        if (f == "+") return arg(1) + arg(2);
        if (f == "-") return n == 2 ? -arg(1) : arg(1) - arg(2);
        if (f == "*") return arg(1) * arg(2);
        if (f == "/") return arg(1) / arg(2);
        if (f == "sqrt") return std::sqrt(arg(1));
        if (f == "fabs") return std::fabs(arg(1));
        if (f == "fma") return std::fma(arg(1), arg(2), arg(3));
        if (f == "copysign") return std::copysign(arg(1), arg(2));
        if (f == "pow") return std::pow(arg(1), arg(2));
        if (f == "<") return arg(1) < arg(2);
        if (f == "<=") return n == 3 ? arg(1) <= arg(2) : arg(1) <= arg(2) && arg(2) <= arg(3);
        if (f == ">") return arg(1) > arg(2);
        if (f == ">=") return arg(1) >= arg(2);
        if (f == "==") return arg(1) == arg(2);
        throw std::runtime_error("unknown operator " + f);
    }

private:
    F atom(const std::string& a) const {
        if (const auto found = values_.find(a); found != values_.end()) return found->second;
        if (a == "INFINITY") return static_cast<F>(HUGE_VAL);
        if (a == "NAN") return static_cast<F>(std::nan(""));
        const auto slash = a.find('/');
        if (slash == std::string::npos) return static_cast<F>(std::stod(a));
        return static_cast<F>(std::stod(a.substr(0, slash)) / std::stod(a.substr(slash + 1)));
    }
    std::map<std::string, F> values_;
};

}  // namespace lostbits::test
