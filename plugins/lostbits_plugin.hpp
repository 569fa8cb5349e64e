// A function of one ray as a form of a plugin (C++17). The whole of a plugin:
//
//   #include <lostbits_plugin.hpp>
//   using namespace lostbits_plugin;
//
//   Answer<float> mine(const Ray<float>& ray, const Sphere<float>& sphere) {
//       float t;
//       if (!my_intersect(ray.origin, ray.direction, sphere.centre, sphere.radius, &t)) return miss;
//       return {t};
//   }
//   LOSTBITS_FORMS(form<mine>("mylib.sphere").first_root().unit_direction())
//
// Shape and format follow from the function's arguments. What it throws is caught and told.
#pragma once

#include <cstddef>
#include <exception>

#include "lostbits_plugin.h"

namespace lostbits_plugin {

template <class T>
struct Ray {
    T origin[3], direction[3];
    T end;  ///< infinity where the ray does not end
};
template <class T>
struct Sphere {
    T centre[3], radius;
};
template <class T>
struct Box {
    T lo[3], hi[3];
};

inline constexpr struct Miss {
} miss{};

/// Where the ray meets the solid: `{t}`, or `{near, far}`; or `miss`. `bool` does for a form that tells no more.
template <class T>
struct Answer {
    bool hit;
    T near, far;
    Answer(T t) : hit(true), near(t), far(t) {}
    Answer(T first, T second) : hit(true), near(first), far(second) {}
    Answer(Miss) : hit(false), near(0), far(0) {}
};

template <class T>
struct Traits;
template <class T, class R>
struct SignatureOf {
    using Number = T;
    static constexpr bool hit_only = false;
};
template <class T>
struct SignatureOf<T, bool> {
    using Number = T;
    static constexpr bool hit_only = true;
};
template <class R, class T>
struct Traits<R (*)(const Ray<T>&, const Sphere<T>&)> : SignatureOf<T, R> {
    static constexpr int shape = LB_SPHERE;
    static Sphere<T> solid(const T* n) { return {{n[0], n[1], n[2]}, n[3]}; }
};
template <class R, class T>
struct Traits<R (*)(const Ray<T>&, const Box<T>&)> : SignatureOf<T, R> {
    static constexpr int shape = LB_BOX;
    static Box<T> solid(const T* n) { return {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}}; }
};

template <auto function>
const char* run(const lb_batch* batch) {
    using Of = Traits<decltype(function)>;
    using T = typename Of::Number;
    const T* ray = static_cast<const T*>(batch->rays);
    const T* const ends = static_cast<const T*>(batch->ends);
    const T* solid = static_cast<const T*>(batch->solids);
    T* const near_far = static_cast<T*>(batch->near_far);
    try {
        for (std::size_t i = 0; i < batch->size; ++i, ray += 6, solid += batch->solid_stride) {
            const Ray<T> one{{ray[0], ray[1], ray[2]},
                             {ray[3], ray[4], ray[5]},
                             ends ? ends[i] : static_cast<T>(__builtin_huge_val())};
            const auto answer = function(one, Of::solid(solid));
            if constexpr (Of::hit_only) {
                batch->hit[i] = answer ? 1 : 0;
            } else {
                batch->hit[i] = answer.hit ? 1 : 0;
                near_far[2 * i] = answer.near;
                near_far[2 * i + 1] = answer.far;
            }
        }
    } catch (const std::exception& error) {
        static thread_local char text[256];
        std::size_t k = 0;
        for (const char* c = error.what(); *c != 0 && k + 1 < sizeof text; ++c) text[k++] = *c;
        text[k] = 0;
        return text;
    } catch (...) {
        return "threw something that is no std::exception";
    }
    return nullptr;
}

/// What a form promises, word by word; see `lb_form`.
struct Form : lb_form {
    constexpr Form titled(const char* words) const { return with(&lb_form::title, words); }
    constexpr Form from(const char* words) const { return with(&lb_form::source, words); }
    constexpr Form unit_direction() const { return with(&lb_form::direction, int{LB_UNIT}); }
    constexpr Form both_roots() const { return with(&lb_form::roots, int{LB_BOTH}); }
    constexpr Form near_root() const { return with(&lb_form::roots, int{LB_NEAR}); }
    constexpr Form first_root() const { return with(&lb_form::roots, int{LB_FIRST}); }
    constexpr Form touching_misses() const { return with(&lb_form::touching, int{LB_MISS}); }
    constexpr Form origin_misses() const { return with(&lb_form::at_origin, int{LB_MISS}); }
    constexpr Form whole_line() const { return with(&lb_form::flags, flags | LB_LINE); }
    constexpr Form ignores_end() const { return with(&lb_form::flags, flags | LB_NO_END); }
    constexpr Form one_thread() const { return with(&lb_form::flags, flags | LB_ONE_THREAD); }

private:
    template <class Value>
    constexpr Form with(Value lb_form::*field, Value value) const {
        Form changed = *this;
        changed.*field = value;
        return changed;
    }
};

/// Both roots, any direction, the closed solid, until it is told otherwise.
template <auto function>
constexpr Form form(const char* name) {
    using Of = Traits<decltype(function)>;
    return {{name, nullptr, nullptr, Of::shape, sizeof(typename Of::Number) == 4 ? LB_F32 : LB_F64, LB_ANY,
             Of::hit_only ? LB_HIT_ONLY : LB_BOTH, LB_HIT, LB_HIT, 0, nullptr, run<function>}};
}

}  // namespace lostbits_plugin

/// The forms that the library exports.
#define LOSTBITS_FORMS(...)                                                 \
    extern "C" const lb_form* lostbits_forms(int abi, std::size_t* count) { \
        static const lb_form forms[] = {__VA_ARGS__};                       \
        if (abi != LOSTBITS_PLUGIN_ABI) return nullptr;                     \
        *count = sizeof forms / sizeof forms[0];                            \
        return forms;                                                       \
    }
