// OGRE 1.12.10 in float: Math::intersects of a ray with a sphere (OgreRay.h:97), "tests whether this ray intersects the
// given sphere"; with a box (OgreMath.cpp:391); and with a box and two distances (:507), which "guarantee 0 <= d1 <=
// d2". For the sphere, `discardInside` is false, so a ray from inside gets the far surface.
#include <OgreAxisAlignedBox.h>
#include <OgreMath.h>
#include <OgreRay.h>
#include <OgreSphere.h>
#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;

Ogre::Vector3 vec(const float (&v)[3]) { return {v[0], v[1], v[2]}; }
Ogre::Ray ray_of(const Ray<float>& r) { return {vec(r.origin), vec(r.direction)}; }
Ogre::AxisAlignedBox box_of(const Box<float>& b) { return {vec(b.lo), vec(b.hi)}; }

Answer<float> sphere(const Ray<float>& r, const Sphere<float>& s) {
    const auto met = Ogre::Math::intersects(ray_of(r), Ogre::Sphere(vec(s.centre), s.radius), false);
    return met.first ? Answer<float>(met.second) : miss;
}
Answer<float> box(const Ray<float>& r, const Box<float>& b) {
    const auto met = Ogre::Math::intersects(ray_of(r), box_of(b));
    return met.first ? Answer<float>(met.second) : miss;
}
Answer<float> span(const Ray<float>& r, const Box<float>& b) {
    float near = 0, far = 0;
    if (!Ogre::Math::intersects(ray_of(r), box_of(b), &near, &far)) return miss;
    return {near, far};
}

LOSTBITS_FORMS(form<sphere>("ogre.sphere").first_root().ignores_end().from("OGRE 1.12.10, OgreRay.h:97, intersects"),
               form<box>("ogre.box")
                   .unit_direction()
                   .first_root()
                   .ignores_end()
                   .from("OGRE 1.12.10, OgreMath.cpp:391, intersects"),
               form<span>("ogre.box_span")
                   .unit_direction()
                   .first_root()
                   .ignores_end()
                   .from("OGRE 1.12.10, OgreMath.cpp:507, intersects with two distances"))
