// Right and wrong forms of every shape, as an author may submit them: `plugin check` must accept the right ones and
// find the mistakes in the others.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "intersect/external/contract.hpp"
#include "measure/truth/truth.hpp"

namespace lostbits::test {

using intersect::external::Contract;
using intersect::external::ForeignForm;

using AnswerT = std::optional<double>;
using Solver = std::function<AnswerT(const Ray<double>&, const Primitive<double>&)>;

/// Right answer for a closed primitive: its first t >= 0.
inline AnswerT right(const Ray<double>& ray, const Primitive<double>& primitive) {
    const auto truth = measure::truth::find_truth(ray, primitive);
    if (!truth.is_hit()) return {};
    return std::ldexp(truth.t.hi, static_cast<int>(truth.t.exponent));
}

/// A function of one ray as a form that returns the first root.
inline ForeignForm make_form(Shape shape, const Solver& solve) {
    Contract contract{.name = "made." + std::string(row_of(shape).name), .title = {}, .source = {}, .shape = shape};
    contract.bits = 64;
    contract.roots = intersect::Roots::first_only;
    contract.flags = LB_ONE_THREAD | LB_NO_END;
    return {.contract = contract, .provider = "test", .answer = [shape, solve](const lb_batch& batch) {
                for (std::size_t i = 0; i < batch.size; ++i) {
                    const double* const r = static_cast<const double*>(batch.rays) + 6 * i;
                    Primitive<double> primitive(shape);
                    std::copy_n(static_cast<const double*>(batch.primitives) + batch.primitive_stride * i,
                                primitive.shape_numbers().size(), primitive.numbers.begin());
                    const AnswerT t = solve({{r[0], r[1], r[2]}, {r[3], r[4], r[5]}}, primitive);
                    batch.hit[i] = t ? 1 : 0;
                    static_cast<double*>(batch.near_far)[2 * i] = t.value_or(0);
                }
            }};
}

/// Its middle and half of its extent; for a plane, a point of it and 1.
inline Vec<double> middle_of(const Primitive<double>& primitive) {
    return visit(primitive, [](const auto& s) { return s.middle(); });
}
inline double extent_of(const Primitive<double>& primitive) {
    return primitive.shape == Shape::plane ? 1 : visit(primitive, [](const auto& s) { return s.half_extent(); });
}

/// The primitive with each of its points moved and its lengths multiplied by a factor.
template <class Point>
Primitive<double> change_points(const Primitive<double>& primitive, const Point& point, double factor = 1) {
    Primitive<double> other = primitive;
    for_each_key(primitive.shape, [&](const Key& key, std::size_t k) {
        if (key.kind == Key::Kind::point) other.set_point(k, point(primitive.point(k)));
        else if (key.is_length())
            for (std::size_t i = k; i < k + key.count(); ++i) other.numbers[i] *= factor;
    });
    return other;
}
inline Vec<double> exchange_y_and_z(const Vec<double>& v) { return {v.x, v.z, v.y}; }

/// One mistake.
struct Mistake {
    std::string name;
    Solver solve;
};

/// Mistakes that can be made for any shape.
inline std::vector<Mistake> make_common_mistakes() {
    using R = const Ray<double>&;
    using S = const Primitive<double>&;
    const auto translate = [](S s, const Vec<double>& by) {
        return change_points(s, [&](const Vec<double>& p) { return p + by; });
    };
    return {
        {"never hits", [](R, S) { return AnswerT(); }},
        {"a distance for t",
         [](R ray, S s) {
             const AnswerT t = right(ray, s);
             return t ? AnswerT(*t * length(ray.direction)) : t;
         }},
        {"t with the wrong sign",
         [](R ray, S s) {
             const AnswerT t = right(ray, s);
             return t ? AnswerT(-*t) : t;
         }},
        {"hits what lies behind",
         [](R ray, S s) {
             const AnswerT t = right(ray, s), behind = right({ray.origin, -ray.direction}, s);
             return t ? t : behind ? AnswerT(-*behind) : behind;
         }},
        {"a hit at NaN for a miss",
         [](R ray, S s) {
             const AnswerT t = right(ray, s);
             return t ? t : AnswerT(std::nan(""));
         }},
        {"a least t of 1e-3",
         [](R ray, S s) {
             const AnswerT t = right(ray, s);
             return t && *t < 1e-3 ? AnswerT() : t;
         }},
        {"misses what is smaller than 1e-6",
         [](R ray, S s) {
             const AnswerT t = right(ray, s);
             return t && *t < 1e-6 && *t > 0 ? AnswerT() : t;
         }},
        {"takes it to lie around the origin",
         [translate](R ray, S s) {
             return right(ray, translate(s, Vec<double>(0, 0,
                                                        s.shape == Shape::triangle || s.shape == Shape::disc ||
                                                                s.shape == Shape::plane
                                                            ? -2
                                                            : 0) -
                                                middle_of(s)));
         }},
        {"y for z in points", [](R ray, S s) { return right(ray, change_points(s, exchange_y_and_z)); }},
        {"half as large",
         [](R ray, S s) {
             const Vec<double> m = middle_of(s);
             return right(ray, change_points(
                                   s, [&m](const Vec<double>& p) { return m + 0.5 * (p - m); }, 0.5));
         }},
        {"1/8 off along x",
         [translate](R ray, S s) {
             return right(ray, translate(s, {extent_of(s) / 8, extent_of(s) / 8, extent_of(s) / 8}));
         }},
        {"hits at 0 from anywhere",
         [](R ray, S s) {
             const AnswerT t = right(ray, s);
             return t ? AnswerT(0) : t;
         }},
        {"hits the ball around it in its place",
         [](R ray, S s) {
             const AnswerT t = right(ray, s);
             if (t) return t;
             const Sphere<double> ball = visit(s, [](const auto& one) { return one.ball_around(); });
             return right(ray, Primitive<double>(Sphere<double>{ball.centre, 1.25 * ball.radius}));
         }},
    };
}

/// Mistakes that can be made for one shape.
inline std::vector<std::pair<Shape, Mistake>> make_mistakes_of_shapes() {
    using R = const Ray<double>&;
    using S = const Primitive<double>&;
    const auto on = [](auto change) { return Solver([change](R ray, S s) { return right(ray, change(s)); }); };
    /// The part of a primitive with an axis between `from` and `to` of its length.
    const auto stretched = [](S s, double from, double to) {
        Primitive<double> other = s;
        const Vec<double> a = s.point(0), v = s.point(3) - a;
        other.set_point(0, a + from * v);
        other.set_point(3, a + to * v);
        return other;
    };
    const auto as_cylinder = [](S s) {
        return Primitive<double>(Cylinder<double>{s.point(0), s.point(3), s.numbers[6]});
    };
    const auto as_tube = [](S s) { return Primitive<double>(Tube<double>{s.point(0), s.point(3), s.numbers[6]}); };
    return {
        {Shape::box,
         {"the near face from a face outwards",
          [](R ray, S s) {
              const AnswerT t = right(ray, s);
              const Box<double> box = s.box();
              for (int k = 0; k < 3; ++k)
                  if (t && *t == 0 && ray.origin[k] == box.lo[k] && ray.direction[k] < 0)
                      return AnswerT((box.hi[k] - box.lo[k]) / ray.direction[k]);
              return t;
          }}},
        {Shape::box, {"no z", on([](S s) {
                          Primitive<double> other = s;
                          other.numbers[2] -= 100, other.numbers[5] += 100;
                          return other;
                      })}},
        {Shape::triangle,
         {"a parallelogram",
          [](R ray, S s) {
              const Triangle<double> t = s.triangle();
              const AnswerT one = right(ray, s);
              return one ? one : right(ray, Primitive<double>(Triangle<double>{t.b + t.c - t.a, t.c, t.b}));
          }}},
        {Shape::triangle,
         {"a hit at NaN in its plane",
          [](R ray, S s) {
              const Triangle<double> t = s.triangle();
              return dot(cross(Vec<double>(t.b - t.a), Vec<double>(t.c - t.a)), ray.direction) == 0
                         ? AnswerT(std::nan(""))
                         : right(ray, s);
          }}},
        {Shape::triangle,
         {"an absolute epsilon on det",
          [](R ray, S s) {
              const Triangle<double> t = s.triangle();
              const double det = dot(cross(Vec<double>(t.b - t.a), Vec<double>(t.c - t.a)), ray.direction);
              return std::fabs(det) < 1e-12 ? AnswerT() : right(ray, s);
          }}},
        {Shape::disc, {"no hole", on([](S s) {
                           Primitive<double> other = s;
                           other.numbers[7] = 0;
                           return other;
                       })}},
        {Shape::disc,
         {"a hit at NaN in its plane",
          [](R ray, S s) { return dot(s.disc().normal, ray.direction) == 0 ? AnswerT(std::nan("")) : right(ray, s); }}},
        {Shape::disc, {"the square of the radius", on([](S s) {
                           Primitive<double> other = s;
                           other.numbers[6] = std::sqrt(other.numbers[6]);
                           return other;
                       })}},
        {Shape::plane,
         {"takes the normal for a unit one",
          [](R ray, S s) {
              const AnswerT t = right(ray, s);
              return t ? AnswerT(*t * length(s.plane().normal)) : t;
          }}},
        {Shape::plane,
         {"a hit at NaN beside it",
          [](R ray, S s) {
              return dot(s.plane().normal, ray.direction) == 0 ? AnswerT(std::nan("")) : right(ray, s);
          }}},
        {Shape::ellipsoid, {"a sphere of its largest radius", on([](S s) {
                                const Ellipsoid<double> e = s.ellipsoid();
                                const double r = std::max({e.radii.x, e.radii.y, e.radii.z});
                                return Primitive<double>(Ellipsoid<double>{e.centre, {r, r, r}});
                            })}},
        {Shape::ellipsoid, {"x for y in its radii", on([](S s) {
                                Primitive<double> other = s;
                                std::swap(other.numbers[3], other.numbers[4]);
                                return other;
                            })}},
        {Shape::cylinder, {"without end", on([stretched](S s) { return stretched(s, -20, 20); })}},
        {Shape::cylinder, {"without caps", on(as_tube)}},
        {Shape::cylinder,
         {"a hit at NaN along its axis",
          [](R ray, S s) {
              return length(cross(Vec<double>(s.point(3) - s.point(0)), ray.direction)) == 0 ? AnswerT(std::nan(""))
                                                                                             : right(ray, s);
          }}},
        {Shape::capsule, {"with flat ends", on(as_cylinder)}},
        {Shape::capsule, {"one end flat", on([stretched](S s) {
                              Primitive<double> other = s;
                              const Vec<double> v = s.point(3) - s.point(0);
                              other.set_point(3, s.point(3) - (0.9 * s.numbers[6] / length(v)) * v);
                              return other;
                          })}},
        {Shape::tube, {"with caps", on(as_cylinder)}},
        {Shape::tube,
         {"its first wall alone",
          [](R ray, S s) {
              const Tube<double> tube = s.tube();
              Primitive<double> endless = s;
              const Vec<double> v = tube.top - tube.bottom;
              endless.set_point(0, tube.bottom - 100.0 * v), endless.set_point(3, tube.top + 100.0 * v);
              const AnswerT t = right(ray, endless);
              const AnswerT own = right(ray, s);
              return t && own && std::fabs(*t - *own) < 1e-9 ? own : AnswerT();
          }}},
        {Shape::cone, {"with its ends exchanged", on([](S s) {
                           Primitive<double> other = s;
                           std::swap(other.numbers[6], other.numbers[7]);
                           return other;
                       })}},
        {Shape::cone, {"a cylinder of its base", on(as_cylinder)}},
        {Shape::torus, {"without a hole", on([](S s) {
                            const Torus<double> t = s.torus();
                            return Primitive<double>(Ellipsoid<double>{
                                t.centre,
                                {t.major_radius + t.minor_radius, t.minor_radius, t.major_radius + t.minor_radius}});
                        })}},
        {Shape::torus,
         {"its outer wall alone",
          [](R ray, S s) {
              AnswerT t = right(ray, s);
              Vec<double> o = ray.origin;
              double passed = 0;
              for (int i = 0; t && i < 4; ++i) {  // the last crossing
                  const double step = *t + 1e-9;
                  passed += step;
                  o = o + step * ray.direction;
                  const AnswerT next = right({o, ray.direction}, s);
                  if (!next) return AnswerT(passed);
                  t = next;
              }
              return t;
          }}},
        {Shape::torus, {"its axis upright", on([](S s) {
                            Primitive<double> other = s;
                            other.set_point(3, {0, 1, 0});
                            return other;
                        })}},
    };
}

}  // namespace lostbits::test
