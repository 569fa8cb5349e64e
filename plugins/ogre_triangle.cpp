// OGRE 1.12.10 in float, OgreMath.cpp:595 and :688: Math::intersects of a ray with a two-sided triangle. It returns
// "boolean result and distance". The normal "doesn't need normalised since we don't care" (OgreMath.h:627).
#include <OgreMath.h>
#include <OgreRay.h>
#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;

Ogre::Vector3 vec(const float (&v)[3]) { return {v[0], v[1], v[2]}; }

Answer<float> triangle(const Ray<float>& r, const Triangle<float>& s) {
    const Ogre::Ray ray(vec(r.origin), vec(r.direction));
    const auto met = Ogre::Math::intersects(ray, vec(s.a), vec(s.b), vec(s.c), true, true);
    return met.first ? Answer<float>(met.second) : miss;
}

LOSTBITS_FORMS(
    form<triangle>("ogre.triangle").first_root().ignores_end().from("OGRE 1.12.10, OgreMath.cpp:688, intersects"))
