// Coin 4.0.0, src/actions/SoRayPickAction.cpp:606, SoRayPickAction::intersect with a triangle, which picks faces. It is
// Moller and Trumbore's test in double on floats. It returns a point of the line, which may lie behind the origin. t is
// computed from the point, along the largest component of the direction. The call is made in a traversal, where the
// matrices are known.
#include <Inventor/SbVec3f.h>
#include <Inventor/SbViewportRegion.h>
#include <Inventor/SoDB.h>
#include <Inventor/actions/SoRayPickAction.h>
#include <Inventor/nodes/SoCallback.h>
#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;

SbVec3f vec(const float (&v)[3]) { return {v[0], v[1], v[2]}; }

struct Question {
    SbVec3f a, b, c, point;
    bool met;
};
void ask(void* data, SoAction* action) {
    auto& q = *static_cast<Question*>(data);
    auto& pick = *static_cast<SoRayPickAction*>(action);
    SbVec3f weights;
    SbBool front = FALSE;
    pick.setObjectSpace();
    q.met = pick.intersect(q.a, q.b, q.c, q.point, weights, front) != FALSE;
}
SoCallback* made() {
    SoDB::init();
    SoCallback* const node = new SoCallback;
    return node->ref(), node;
}
Points<float> triangle(const Ray<float>& ray, const Triangle<float>& s) {
    static SoCallback* const node = made();
    static SoRayPickAction pick(SbViewportRegion(1, 1));
    Question q{vec(s.a), vec(s.b), vec(s.c), {}, false};
    node->setCallback(ask, &q);
    pick.setRay(vec(ray.origin), vec(ray.direction));
    pick.apply(node);
    return q.met ? Points<float>(q.point) : miss;
}

LOSTBITS_FORMS(form<triangle>("coin.triangle")
                   .unit_direction()
                   .near_root()
                   .ignores_end()
                   .one_thread()
                   .from("Coin 4.0.0, src/actions/SoRayPickAction.cpp:606, intersect"))
