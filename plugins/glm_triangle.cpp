// GLM 0.9.9.8, gtx/intersect.inl:34, intersectRayTriangle: "the intersection of a ray and a triangle"
// (gtx/intersect.hpp:46). It is Moller and Trumbore's test with a branch on the sign of the determinant. It does not
// test if the triangle lies behind the origin. A determinant within epsilon of 0 counts as a parallel ray, whatever the
// size of the triangle.
#define GLM_ENABLE_EXPERIMENTAL
#include <glm/glm.hpp>
#include <glm/gtx/intersect.hpp>
#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;

template <class T>
glm::vec<3, T> vec(const T (&v)[3]) {
    return {v[0], v[1], v[2]};
}
template <class T>
Answer<T> triangle(const Ray<T>& ray, const Triangle<T>& s) {
    T t = 0;
    glm::vec<2, T> uv(0);
    if (!glm::intersectRayTriangle(vec(ray.origin), vec(ray.direction), vec(s.a), vec(s.b), vec(s.c), uv, t))
        return miss;
    return {t};
}

constexpr Form contract(Form form) {
    return form.first_root().ignores_end().from("GLM 0.9.9.8, gtx/intersect.inl:34, intersectRayTriangle");
}

LOSTBITS_FORMS(contract(form<triangle<float>>("glm.triangle")), contract(form<triangle<double>>("glm.triangle")))
