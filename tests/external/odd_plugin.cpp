// A library whose forms misbehave, each in its own way.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <thread>

#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;

namespace {

using Rays = const Ray<float>&;
using Spheres = const Sphere<float>&;

/// Is right for every length of direction.
Answer<float> right(Rays ray, Spheres sphere) {
    double f[3], a = 0, h = 0, c = -static_cast<double>(sphere.radius) * static_cast<double>(sphere.radius);
    for (int k = 0; k < 3; ++k) {
        f[k] = static_cast<double>(ray.origin[k]) - static_cast<double>(sphere.centre[k]);
        a += static_cast<double>(ray.direction[k]) * static_cast<double>(ray.direction[k]);
        h += f[k] * static_cast<double>(ray.direction[k]);
        c += f[k] * f[k];
    }
    const double disc = h * h - a * c;
    if (!(disc >= 0)) return miss;
    return {static_cast<float>((-h - std::sqrt(disc)) / a), static_cast<float>((-h + std::sqrt(disc)) / a)};
}

/// Returns the first root ahead.
Answer<float> first(Rays ray, Spheres sphere) {
    const Answer<float> both = right(ray, sphere);
    if (!both.hit || both.far < 0) return miss;
    return {both.near < 0 ? both.far : both.near};
}

bool predicate(Rays ray, Spheres sphere) { return first(ray, sphere).hit; }

Answer<float> distance(Rays ray, Spheres sphere) {
    Answer<float> t = first(ray, sphere);
    t.near *= std::hypot(ray.direction[0], ray.direction[1], ray.direction[2]);
    return t;
}

Answer<float> squared(Rays ray, Spheres sphere) {
    return first(ray, {{sphere.centre[0], sphere.centre[1], sphere.centre[2]}, std::sqrt(sphere.radius)});
}

Answer<float> far_first(Rays ray, Spheres sphere) {
    const Answer<float> both = right(ray, sphere);
    if (!both.hit || both.far < 0) return miss;
    return {both.far};
}

/// Returns 0 for every hit.
Answer<float> nothing_ahead(Rays ray, Spheres sphere) {
    Answer<float> t = first(ray, sphere);
    t.near = 0;
    return t;
}

Answer<float> both_ways(Rays ray, Spheres sphere) { return right(ray, sphere); }

Answer<float> crash(Rays, Spheres) {
    volatile int* nowhere = nullptr;
    return {static_cast<float>(*nowhere)};
}

int deep(int n) {
    volatile char stack[4096];
    stack[0] = static_cast<char>(n);
    return n < 0 ? 0 : deep(n + 1) + stack[0];
}
Answer<float> overflow(Rays, Spheres) { return {static_cast<float>(deep(0))}; }

Answer<float> throws(Rays, Spheres) { throw std::runtime_error("no bananas"); }
Answer<float> aborts(Rays, Spheres) { std::abort(); }
Answer<float> exits(Rays, Spheres) { std::exit(0); }
Answer<float> hangs(Rays, Spheres) {
    std::fputs("the batch begins\n", stderr);
    for (;;) std::this_thread::sleep_for(std::chrono::seconds(1));
}

Answer<float> talks(Rays ray, Spheres sphere) {
    std::puts("hello");
    return first(ray, sphere);
}

float counter = 0;
Answer<float> forgetful(Rays, Spheres) { return {counter += 1}; }

const char* throws_through(const lb_batch*) { throw 7; }
const char* refuses(const lb_batch*) { return "it is \033[31mMonday"; }
const char* lazy(const lb_batch*) { return nullptr; }
const char* garbage(const lb_batch* batch) {
    for (std::size_t i = 0; i < batch->size; ++i) batch->hit[i] = 7;
    return nullptr;
}
const char* half(const lb_batch* batch) {
    for (std::size_t i = 0; i < batch->size; ++i) {
        batch->hit[i] = 1;
        static_cast<float*>(batch->near_far)[2 * i] = 1;
    }
    return nullptr;
}

constexpr Form raw(const char* name, const char* (*run)(const lb_batch*)) {
    Form made = form<right>(name);
    made.run = run;
    return made;
}

}  // namespace

LOSTBITS_FORMS(form<right>("odd.right").whole_line(),                       //
               form<first>("odd.first").first_root(),                       //
               form<predicate>("odd.predicate"),                            //
               form<distance>("odd.distance").first_root(),                 //
               form<distance>("odd.unit").first_root().unit_direction(),    //
               form<squared>("odd.squared").first_root(),                   //
               form<far_first>("odd.far_first").first_root(),               //
               form<both_ways>("odd.both_ways"),                            //
               form<nothing_ahead>("odd.nothing_ahead").first_root(),       //
               form<crash>("odd.crash").first_root(),                       //
               form<overflow>("odd.overflow").first_root(),                 //
               form<throws>("odd.throws").first_root(),                     //
               form<aborts>("odd.aborts").first_root(),                     //
               form<exits>("odd.exits").first_root(),                       //
               form<hangs>("odd.hangs").first_root(),                       //
               form<talks>("odd.talks").first_root(),                       //
               form<forgetful>("odd.forgetful").first_root().one_thread(),  //
               raw("odd.throws_through", throws_through),                   //
               raw("odd.refuses", refuses),                                 //
               raw("odd.lazy", lazy),                                       //
               raw("odd.garbage", garbage),                                 //
               raw("odd.half", half))
