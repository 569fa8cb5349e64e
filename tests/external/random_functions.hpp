// Random functions in C: expressions, ifs, small loops, structs by value and by pointer, arrays, early returns.
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace lostbits::test {

/// Writes functions `int lostbits_entry_K(const T* in, T* out, int* hit)` of eleven numbers and the functions they
/// call. The same seed gives the same text.
class RandomFunctions {
public:
    RandomFunctions(std::uint64_t seed, bool is_double) : random_(seed), type_(is_double ? "double" : "float") {}

    static constexpr int inputs = 10;

    std::string file(int count) {
        text_ =
            "#include <math.h>\n#include <string.h>\ntypedef " + type_ +
            " T;\ntypedef struct { T x, y, z; } vec3;\ntypedef struct { vec3 o, d; T range[2]; int kind; } ray;\n"
            "static vec3 sub(vec3 a, vec3 b) { vec3 r = {a.x - b.x, a.y - b.y, a.z - b.z}; return r; }\n"
            "static vec3 scaled(const vec3* a, T s) { vec3 r; r.x = s * a->x; r.y = s * a->y; r.z = s * a->z; return "
            "r; }\nstatic T dot(vec3 a, vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }\n"
            "static T definite(T x) { return x == x ? x : 1; }\n"  // the sign of a NaN is not specified
            "static void swap(T* a, T* b) { T c = *a; *a = *b; *b = c; }\n"
            "static int roots(T a, T b, T c, T* near, T* far) {\n    T disc = b * b - a * c;\n    if (disc < 0) return "
            "0;\n    T s = " +
            (type_ == "float" ? std::string("sqrtf") : std::string("sqrt")) +
            "(disc);\n    *near = (-b - s) / a;\n    *far = (-b + s) / a;\n    return *near < *far ? 2 : 1;\n}\n";
        for (int k = 0; k < count; ++k) function(k);
        return text_;
    }

private:
    int below(int n) { return static_cast<int>(random_() % static_cast<std::uint64_t>(n)); }
    std::string one_of(const std::vector<std::string>& words) { return words[below(static_cast<int>(words.size()))]; }
    std::string math(const std::string& name) { return type_ == "float" && below(4) > 0 ? name + "f" : name; }

    /// Writes something that can be assigned.
    std::string variable() {
        switch (below(5)) {
            case 0: return "v" + std::to_string(below(3)) + "." + one_of({"x", "y", "z"});
            case 1: return "a[" + index(4) + "]";
            case 2: return one_of({"r.o.", "p->d."}) + one_of({"x", "y", "z"});
            case 3: return "r.range[" + index(2) + "]";
            default: return "s" + std::to_string(below(4));
        }
    }
    std::string index(int size) {
        switch (below(4)) {
            case 0: return "k % " + std::to_string(size);
            case 1: return "(k + " + std::to_string(below(3)) + ") % " + std::to_string(size);
            default: return std::to_string(below(size));
        }
    }
    std::string vector(int depth) {
        if (depth > 0 && below(3) == 0) return "sub(" + vector(depth - 1) + ", " + vector(depth - 1) + ")";
        if (depth > 0 && below(4) == 0)
            return "scaled(&v" + std::to_string(below(3)) + ", " + expression(depth - 1) + ")";
        return one_of({"v0", "v1", "v2", "r.o", "r.d", "p->o", "p->d"});
    }
    std::string literal() {
        std::string text = one_of({"0.0", "1.0", "2.0", "0.5", "3.0", "0.1", "1e-6", "1e10", "-1.0", "0.25", "7.0"});
        if (type_ == "float" && below(4) > 0) text += "f";
        return below(4) == 0 ? one_of({"1", "2", "3", "4", "0"}) : text;
    }
    std::string expression(int depth) {
        if (depth <= 0) return below(4) == 0 ? literal() : variable();
        const auto part = [&] { return expression(depth - 1 - below(2)); };
        switch (below(17)) {
            case 0: return "(" + part() + " * " + part() + ")";
            case 1: return quotient(part(), part());
            case 2:
            case 3: return "(" + part() + " + " + part() + ")";
            case 4:
            case 5: return "(" + part() + " - " + part() + ")";
            case 6: return "(- " + part() + ")";
            case 7: return math("fabs") + "(" + part() + ")";
            case 8: return math("sqrt") + "(" + part() + ")";
            case 9: return "(" + math(one_of({"fmin", "fmax"})) + "(" + part() + ", " + part() + ") + 0)";
            case 10: return math("copysign") + "(" + part() + ", definite(" + part() + "))";
            case 11: return (type_ == "float" ? "fmaf(" : "fma(") + part() + ", " + part() + ", " + part() + ")";
            case 12:
            case 13: return "(" + condition(depth - 1) + " ? " + part() + " : " + part() + ")";
            case 14: return "dot(" + vector(depth - 1) + ", " + vector(depth - 1) + ")";
            case 15: return type_ == "float" ? "(float)((double)" + part() + " * " + part() + ")" : part();
            default: return "(" + part() + " * " + part() + ")";
        }
    }
    /// A quotient of numbers of type T or double. An integer divided by 0 has no defined value.
    static std::string quotient(const std::string& a, const std::string& b) {
        return (a.find('.') == std::string::npos ? "((T)" : "(") + a + " / " + b + ")";
    }
    std::string condition(int depth) {
        if (depth > 0 && below(4) == 0)
            return "(" + condition(depth - 1) + one_of({" && ", " || "}) + condition(depth - 1) + ")";
        if (below(8) == 0) return "!(" + condition(depth - 1) + ")";
        if (below(8) == 0) return "k " + one_of({"<", "==", ">="}) + " " + std::to_string(below(4));
        return "(" + expression(depth - 1) + one_of({" < ", " <= ", " > ", " >= ", " == ", " != "}) +
               expression(depth - 1) + ")";
    }

    void line(int nesting, const std::string& words) {
        text_ += std::string(static_cast<std::size_t>(4 * nesting), ' ') + words + "\n";
    }
    void block(int nesting, int statements, bool in_loop) {
        for (int k = 0; k < statements; ++k) statement(nesting, in_loop);
    }
    void statement(int nesting, bool in_loop) {
        const bool deep = nesting > 3;
        switch (below(deep ? 6 : 14)) {
            case 0:
            case 1: return line(nesting, variable() + " = " + expression(3) + ";");
            case 2: return line(nesting, variable() + one_of({" += ", " -= ", " *= "}) + expression(2) + ";");
            case 3: return line(nesting, "v" + std::to_string(below(3)) + " = " + vector(2) + ";");
            case 4: return line(nesting, "swap(&" + variable() + ", &" + variable() + ");");
            case 5:
                return line(nesting, one_of({"memcpy(a, &v1, sizeof v1);", "memcpy(&v2, a, sizeof v2);", "p = &r;",
                                             "p = " + condition(1) + " ? &r : &q;", "q = r;", "r = *p;",
                                             "k = " + condition(1) + ";", "k += " + condition(2) + ";"}));
            case 6:
            case 7:
                line(nesting, "if (" + condition(2) + ") {");
                block(nesting + 1, 1 + below(3), in_loop);
                if (below(2) == 0) {
                    line(nesting, "} else {");
                    block(nesting + 1, 1 + below(2), in_loop);
                }
                return line(nesting, "}");
            case 8: return line(nesting, "if (" + condition(2) + ") " + early_return());
            case 9:
            case 10: {
                const std::string i = "i" + std::to_string(nesting);
                line(nesting,
                     "for (int " + i + " = 0; " + i + " < " + std::to_string(2 + below(3)) + "; ++" + i + ") {");
                line(nesting + 1, one_of({"k = " + i + ";", "a[" + i + " % 4] += " + expression(2) + ";"}));
                block(nesting + 1, 1 + below(2), true);
                return line(nesting, "}");
            }
            case 11:
                if (!in_loop)
                    return line(nesting, "k = roots(" + expression(1) + ", " + expression(1) + ", " + expression(1) +
                                             ", &s0, &a[1]);");
                return line(nesting, "if (" + condition(1) + ") " + one_of({"break;", "continue;"}));
            case 12:
                line(nesting, "switch (k) {");
                line(nesting, "case 0: " + variable() + " = " + expression(2) + "; break;");
                line(nesting, "case 1: " + variable() + " -= " + expression(1) + ";");
                line(nesting, "case 2: " + variable() + " = " + literal() + "; break;");
                line(nesting, "default: s1 = " + expression(1) + ";");
                return line(nesting, "}");
            default: return line(nesting, "k = " + condition(1) + " ? " + std::to_string(below(4)) + " : k;");
        }
    }
    std::string early_return() {
        return one_of({"return " + literal() + ";", "return " + expression(1) + ";",
                       "{ *hit = " + std::to_string(below(2)) + "; return s0; }"});
    }
    void function(int k) {
        const std::string n = std::to_string(k);
        text_ += "static T f" + n + "(vec3 v0, const vec3* from, const T c[3], ray r, T s3, int* hit) {\n";
        line(1, "vec3 v1 = *from, v2 = {c[2], c[0], c[1]};");
        line(1, "T a[4] = {c[0], c[1], c[2], s3}, s0 = v0.x, s1 = dot(v1, v2), s2 = r.range[0];");
        line(1, "ray q = {v1, v0, {1, 2}, 1}, *p = &q;");
        line(1, "int k = 0;");
        block(1, 3 + below(5), false);
        line(1, "*hit = " + condition(2) + ";");
        line(1, "return " + expression(2) + ";");
        text_ += "}\nvoid lostbits_entry_" + n +
                 "(const T* in, T* out, int* hit) {\n    vec3 v = {in[0], in[1], in[2]}, w = {in[3], in[4], in[5]};\n"
                 "    ray r = {w, v, {in[9], in[2]}, 0};\n    *hit = 1;\n    out[0] = f" +
                 n + "(v, &w, in + 6, r, in[9], hit);\n}\n";
    }

    std::mt19937_64 random_;
    std::string type_, text_;
};

}  // namespace lostbits::test
