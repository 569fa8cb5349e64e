// GLM 0.9.9.8, gtx/intersect.inl:135, the intersectRaySphere that returns a distance. GLM promises "the intersection
// distance of a ray and a sphere. The ray direction vector is unit length" (gtx/intersect.hpp:63). It takes the radius
// squared, so r r is rounded before the call.
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
Answer<T> sphere(const Ray<T>& ray, const Sphere<T>& s) {
    T t = 0;
    if (!glm::intersectRaySphere(vec(ray.origin), vec(ray.direction), vec(s.centre), s.radius * s.radius, t))
        return miss;
    return {t};
}

template <class T>
constexpr Form contract(Form form) {  // t = 0 is a miss: it returns intersectionDistance > Epsilon
    return form.unit_direction()
        .first_root()
        .origin_misses()
        .ignores_end()
        .titled("intersectRaySphere of GLM")
        .from("GLM 0.9.9.8, gtx/intersect.inl:135, intersectRaySphere");
}

LOSTBITS_FORMS(contract<float>(form<sphere<float>>("glm.sphere")), contract<double>(form<sphere<double>>("glm.sphere")))
