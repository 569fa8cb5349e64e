// GLM 0.9.9.8, gtx/intersect.inl:135, intersectRaySphere: the machine epsilon is used as a length, so the answer
// changes with the unit of measure. Where roots are below 1.2e-7 (float) the far one is told, or none.
//   g++ glm_sphere.cpp && ./a.out
#define GLM_ENABLE_EXPERIMENTAL
#include <cstdio>
#include <initializer_list>

#include <glm/glm.hpp>
#include <glm/gtx/intersect.hpp>

/// As in intersect.inl, with 0 in place of Epsilon.
bool mended(const glm::vec3& o, const glm::vec3& d, const glm::vec3& c, float rr, float& t) {
    const glm::vec3 diff = c - o;
    const float t0 = glm::dot(diff, d), d2 = glm::dot(diff, diff) - t0 * t0;
    if (d2 > rr) return false;
    const float t1 = glm::sqrt(rr - d2);
    t = t0 > t1 ? t0 - t1 : t0 + t1;
    return t > 0;
}

int main() {
    for (const float unit : {1.0F, 0x1p-20F, 0x1p-23F, 0x1p-26F}) {
        const glm::vec3 o(0), d(0, 0, 1), c(0, 0, 3 * unit);
        float t = 0, m = 0;
        const bool hit = glm::intersectRaySphere(o, d, c, unit * unit, t), again = mended(o, d, c, unit * unit, m);
        std::printf("radius %g, 3 radii ahead: expected %g, got %g%s, mended %g%s\n", unit, 2 * unit, t,
                    hit ? "" : " (no hit)", m, again ? "" : " (no hit)");
    }
    float t = 0;
    const bool hit = glm::intersectRaySphere(glm::vec3(0, 0, -1 - 0x1p-23F), {0, 0, 1}, glm::vec3(0), 1.0F, t);
    std::printf("one ulp in front of a unit sphere: expected %g, got %g%s\n", 0x1p-23, t, hit ? "" : " (no hit)");
}
