#include "intersect/device/probe_program.hpp"

namespace lostbits::intersect::device {
namespace {

/// The operations, in the order of `ProbedOperation`. R and V stand for the types of numbers and vectors.
constexpr const char* operations = R"(
R two_sum_plain(R a, R b) {
    R s = a + b;
    R t = s - a;
    return (a - (s - t)) + (b - t);
}
R two_sum_precise(R a, R b) {
    precise R s = a + b;
    precise R t = s - a;
    precise R e = (a - (s - t)) + (b - t);
    return e;
}
R kahan_plain(R numbers[6]) {
    R sum = R(0), c = R(0);
    for (int k = 0; k < 6; ++k) {
        R y = numbers[k] - c;
        R t = sum + y;
        c = (t - sum) - y;
        sum = t;
    }
    return sum;
}
R kahan_precise(R numbers[6]) {
    precise R sum = R(0), c = R(0);
    for (int k = 0; k < 6; ++k) {
        precise R y = numbers[k] - c;
        precise R t = sum + y;
        c = (t - sum) - y;
        sum = t;
    }
    return sum;
}
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Inputs { R inputs[]; };
layout(std430, binding = 1) writeonly buffer Answers { R answers[]; };
void main() {
    uint i = gl_GlobalInvocationID.x;
    R n[6];
    for (uint k = 0u; k < 6u; ++k) n[k] = inputs[6u * i + k];
    R x = n[0], y = n[1], z = n[2];
    V a = V(n[0], n[1], n[2]), b = V(n[3], n[4], n[5]);

    precise R fused = fma(x, y, z);
    precise R unfused = x * y + z;

    // The answers, in the order of the enumeration.
    uint o = COUNTu * i;
    answers[o++] = x + y;
    answers[o++] = x - y;
    answers[o++] = x * y;
    answers[o++] = x / y;
    answers[o++] = sqrt(abs(x));
    answers[o++] = inversesqrt(abs(x));
    answers[o++] = length(a);
    answers[o++] = normalize(a).x;
    answers[o++] = fma(x, y, z);
    answers[o++] = fused;
    answers[o++] = x * y + z;
    answers[o++] = unfused;
    answers[o++] = dot(a, b);
    answers[o++] = two_sum_plain(x, y);
    answers[o++] = two_sum_precise(x, y);
    answers[o++] = kahan_plain(n);
    answers[o++] = kahan_precise(n);
    answers[o++] = x * y + x * z;
    answers[o++] = sqrt(abs(x)) * sqrt(abs(x));
}
)";

std::string version_line(int version) { return "#version " + std::to_string(version) + "\n"; }

}  // namespace

std::string write_probe_program(int bits, int version) {
    const bool is_double = bits == 64;
    return version_line(version) + "#define R " + (is_double ? "double" : "float") + "\n#define V " +
           (is_double ? "dvec3" : "vec3") + "\n#define COUNTu " + std::to_string(probed_count) + "u\n" + operations;
}

std::string write_loop_program(int version, LoopKind kind) {
    return version_line(version) + "#define OUTER_LOOP " +
           (kind == LoopKind::nested ? "for (uint r = 0u; r < inputs[2]; ++r)" : "") + R"(
layout(local_size_x = 1) in;
layout(std430, binding = 0) readonly buffer Inputs { uint inputs[]; };
layout(std430, binding = 1) writeonly buffer Answers { uint answers[]; };
void main() {
    uint n = 0u, state = inputs[1];
    OUTER_LOOP for (uint k = 0u; k < inputs[0]; ++k) {
        state = state * 1664525u + 1013904223u;
        if (state != 12345u) ++n;
    }
    answers[0] = n;
    answers[1] = state;
}
)";
}

}  // namespace lostbits::intersect::device
