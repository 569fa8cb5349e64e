// `plugin check` asks what the truth is: it acquits every form of the catalogue, under another name, and finds ten
// wrong ones of each shape.
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "catch.hpp"
#include "intersect/doors/contract.hpp"
#include "intersect/doors/foreign_batch.hpp"
#include "intersect/table/table.hpp"
#include "measure/contract/probe.hpp"
#include "measure/truth/truth.hpp"

namespace test_contract {

using namespace lostbits;
using intersect::doors::Contract;
using intersect::doors::ForeignForm;
using measure::contract::Observation;
using measure::contract::try_contract;

namespace {

/// The kernels of a row behind the interface of external intersectors; `roots` are those that it tells.
template <class S>
void answer_by_row(const intersect::table::Intersector& row, intersect::Roots roots, const lb_batch& batch) {
    std::array<std::vector<S>, 6> columns;
    std::vector<Solid<S>> solids;
    const auto* const rays = static_cast<const S*>(batch.rays);
    const auto* const numbers = static_cast<const S*>(batch.solids);
    for (std::size_t i = 0; i < batch.size; ++i) {
        for (std::size_t k = 0; k < 6; ++k) columns[k].push_back(rays[6 * i + k]);
        Solid<S> solid(row.shape);
        std::copy_n(numbers + batch.solid_stride * i, solid.used().size(), solid.numbers.begin());
        solids.push_back(solid);
    }
    const std::size_t n = batch.size;
    std::vector<S> t(n), near(n), far(n);
    intersect::table::RayBatch<S> asked{columns[0], columns[1], columns[2], columns[3], columns[4], columns[5]};
    if (batch.ends != nullptr) asked.tmax = {static_cast<const S*>(batch.ends), n};
    const intersect::table::HitBatch<S> hits{t, near, far, {batch.hit, n}};
    const intersect::Target<S> target{std::span<const Solid<S>>(solids)};
    if constexpr (std::same_as<S, float>) row.native32(asked, target, hits);
    else row.native64(asked, target, hits);
    auto* const out = static_cast<S*>(batch.near_far);
    for (std::size_t i = 0; i < n; ++i) {
        out[2 * i] = roots == intersect::Roots::both ? near[i] : t[i];
        out[2 * i + 1] = far[i];
    }
}

/// A row of the catalogue as somebody's own; `first`: t alone, of one that tells near and far.
ForeignForm renamed(const intersect::table::Intersector& row, int bits, bool first = false) {
    const intersect::Info& info = *row.info;
    Contract contract{.name = "own." + std::string(info.name),
                      .title = {},
                      .source = {},
                      .shape = row.shape,
                      .bits = bits,
                      .direction = info.direction,
                      .roots = first ? intersect::Roots::first_only : info.roots,
                      .touching = info.touching,
                      .at_origin = info.at_origin,
                      .inside = info.inside,
                      .facing = info.facing,
                      .flags = LB_ONE_THREAD | (told_end(row.shape) ? 0U : unsigned{LB_NO_END})};
    if (first && contract.inside == intersect::Inside::near) contract.inside = intersect::Inside::usual;
    const intersect::Roots roots = contract.roots;
    return {.contract = contract, .from = "catalogue", .answer = [&row, bits, roots](const lb_batch& batch) {
                if (bits == 32) answer_by_row<float>(row, roots, batch);
                else answer_by_row<double>(row, roots, batch);
            }};
}

std::map<std::string, std::string> broken_of(const ForeignForm& form, const ForeignForm* first = nullptr) {
    std::map<std::string, std::string> broken;
    for (const Observation& f : try_contract(form, first))
        if (f.verdict == Observation::Verdict::broken) broken[f.subject] = f.words;
    return broken;
}

using Found = std::optional<double>;
using Solves = std::function<Found(const Ray<double>&, const Solid<double>&)>;

/// What is right of a closed solid: its first t >= 0.
Found right(const Ray<double>& ray, const Solid<double>& solid) {
    const auto truth = measure::truth::find_truth(ray, solid);
    if (!truth.is_hit()) return {};
    return std::ldexp(truth.t.hi, static_cast<int>(truth.t.exponent));
}

/// A function of one ray as a form of the first root.
ForeignForm solved_by(Shape shape, const Solves& solve) {
    Contract contract{.name = "made." + std::string(row_of(shape).name), .title = {}, .source = {}, .shape = shape};
    contract.bits = 64;
    contract.roots = intersect::Roots::first_only;
    contract.flags = LB_ONE_THREAD | LB_NO_END;
    return {.contract = contract, .from = "test", .answer = [shape, solve](const lb_batch& batch) {
                for (std::size_t i = 0; i < batch.size; ++i) {
                    const double* const r = static_cast<const double*>(batch.rays) + 6 * i;
                    Solid<double> solid(shape);
                    std::copy_n(static_cast<const double*>(batch.solids) + batch.solid_stride * i, solid.used().size(),
                                solid.numbers.begin());
                    const Found t = solve({{r[0], r[1], r[2]}, {r[3], r[4], r[5]}}, solid);
                    batch.hit[i] = t ? 1 : 0;
                    static_cast<double*>(batch.near_far)[2 * i] = t.value_or(0);
                }
            }};
}

/// Its middle and half of its extent: of a plane the point it goes through, and 1.
Vec<double> middle_of(const Solid<double>& solid) {
    return visit(solid, [](const auto& s) { return s.middle(); });
}
double extent_of(const Solid<double>& solid) {
    return solid.shape == Shape::plane ? 1 : visit(solid, [](const auto& s) { return s.half_extent(); });
}

/// The solid with each of its points taken somewhere, and its lengths by a factor.
template <class Point>
Solid<double> changed(const Solid<double>& solid, const Point& point, double factor = 1) {
    Solid<double> other = solid;
    for_each_key(solid.shape, [&](const Key& key, std::size_t k) {
        if (key.kind == Key::Kind::point) other.set_point(k, point(solid.point(k)));
        else if (key.is_length())
            for (std::size_t i = k; i < k + key.count(); ++i) other.numbers[i] *= factor;
    });
    return other;
}
Vec<double> y_for_z(const Vec<double>& v) { return {v.x, v.z, v.y}; }

/// One mistake.
struct Mistake {
    std::string name;
    Solves solve;
};

/// Those that can be made of any shape.
std::vector<Mistake> mistakes_of_all() {
    using R = const Ray<double>&;
    using S = const Solid<double>&;
    const auto moved = [](S s, const Vec<double>& by) {
        return changed(s, [&](const Vec<double>& p) { return p + by; });
    };
    return {
        {"never hits", [](R, S) { return Found(); }},
        {"a distance for t",
         [](R ray, S s) {
             const Found t = right(ray, s);
             return t ? Found(*t * length(ray.direction)) : t;
         }},
        {"t with the wrong sign",
         [](R ray, S s) {
             const Found t = right(ray, s);
             return t ? Found(-*t) : t;
         }},
        {"hits what lies behind",
         [](R ray, S s) {
             const Found t = right(ray, s), behind = right({ray.origin, -ray.direction}, s);
             return t ? t : behind ? Found(-*behind) : behind;
         }},
        {"a hit at NaN for a miss",
         [](R ray, S s) {
             const Found t = right(ray, s);
             return t ? t : Found(std::nan(""));
         }},
        {"a least t of 1e-3",
         [](R ray, S s) {
             const Found t = right(ray, s);
             return t && *t < 1e-3 ? Found() : t;
         }},
        {"misses what is smaller than 1e-6",
         [](R ray, S s) {
             const Found t = right(ray, s);
             return t && *t < 1e-6 && *t > 0 ? Found() : t;
         }},
        {"takes it to lie around the origin",
         [moved](R ray, S s) {
             return right(ray, moved(s, Vec<double>(0, 0,
                                                    s.shape == Shape::triangle || s.shape == Shape::disc ||
                                                            s.shape == Shape::plane
                                                        ? -2
                                                        : 0) -
                                            middle_of(s)));
         }},
        {"y for z in points", [](R ray, S s) { return right(ray, changed(s, y_for_z)); }},
        {"half as large",
         [](R ray, S s) {
             const Vec<double> m = middle_of(s);
             return right(ray, changed(
                                   s, [&m](const Vec<double>& p) { return m + 0.5 * (p - m); }, 0.5));
         }},
        {"1/8 off along x",
         [moved](R ray, S s) {
             return right(ray, moved(s, {extent_of(s) / 8, extent_of(s) / 8, extent_of(s) / 8}));
         }},
        {"hits at 0 from anywhere",
         [](R ray, S s) {
             const Found t = right(ray, s);
             return t ? Found(0) : t;
         }},
        {"hits the ball around it in its place",
         [](R ray, S s) {
             const Found t = right(ray, s);
             if (t) return t;
             const Sphere<double> ball = visit(s, [](const auto& one) { return one.ball_around(); });
             return right(ray, Solid<double>(Sphere<double>{ball.centre, 1.25 * ball.radius}));
         }},
    };
}

/// Those of one shape.
std::vector<std::pair<Shape, Mistake>> mistakes_of_one() {
    using R = const Ray<double>&;
    using S = const Solid<double>&;
    const auto on = [](auto change) { return Solves([change](R ray, S s) { return right(ray, change(s)); }); };
    /// A solid of an axis from `from` to `to` of its length.
    const auto stretched = [](S s, double from, double to) {
        Solid<double> other = s;
        const Vec<double> a = s.point(0), v = s.point(3) - a;
        other.set_point(0, a + from * v);
        other.set_point(3, a + to * v);
        return other;
    };
    const auto as_cylinder = [](S s) { return Solid<double>(Cylinder<double>{s.point(0), s.point(3), s.numbers[6]}); };
    const auto as_tube = [](S s) { return Solid<double>(Tube<double>{s.point(0), s.point(3), s.numbers[6]}); };
    return {
        {Shape::box,
         {"the near face from a face outwards",
          [](R ray, S s) {
              const Found t = right(ray, s);
              const Box<double> box = s.box();
              for (int k = 0; k < 3; ++k)
                  if (t && *t == 0 && ray.origin[k] == box.lo[k] && ray.direction[k] < 0)
                      return Found((box.hi[k] - box.lo[k]) / ray.direction[k]);
              return t;
          }}},
        {Shape::box, {"no z", on([](S s) {
                          Solid<double> other = s;
                          other.numbers[2] -= 100, other.numbers[5] += 100;
                          return other;
                      })}},
        {Shape::triangle,
         {"a parallelogram",
          [](R ray, S s) {
              const Triangle<double> t = s.triangle();
              const Found one = right(ray, s);
              return one ? one : right(ray, Solid<double>(Triangle<double>{t.b + t.c - t.a, t.c, t.b}));
          }}},
        {Shape::triangle,
         {"a hit at NaN in its plane",
          [](R ray, S s) {
              const Triangle<double> t = s.triangle();
              return dot(cross(Vec<double>(t.b - t.a), Vec<double>(t.c - t.a)), ray.direction) == 0
                         ? Found(std::nan(""))
                         : right(ray, s);
          }}},
        {Shape::triangle,
         {"an absolute epsilon on det",
          [](R ray, S s) {
              const Triangle<double> t = s.triangle();
              const double det = dot(cross(Vec<double>(t.b - t.a), Vec<double>(t.c - t.a)), ray.direction);
              return std::fabs(det) < 1e-12 ? Found() : right(ray, s);
          }}},
        {Shape::disc, {"no hole", on([](S s) {
                           Solid<double> other = s;
                           other.numbers[7] = 0;
                           return other;
                       })}},
        {Shape::disc,
         {"a hit at NaN in its plane",
          [](R ray, S s) { return dot(s.disc().normal, ray.direction) == 0 ? Found(std::nan("")) : right(ray, s); }}},
        {Shape::disc, {"the square of the radius", on([](S s) {
                           Solid<double> other = s;
                           other.numbers[6] = std::sqrt(other.numbers[6]);
                           return other;
                       })}},
        {Shape::plane,
         {"takes the normal for a unit one",
          [](R ray, S s) {
              const Found t = right(ray, s);
              return t ? Found(*t * length(s.plane().normal)) : t;
          }}},
        {Shape::plane,
         {"a hit at NaN beside it",
          [](R ray, S s) { return dot(s.plane().normal, ray.direction) == 0 ? Found(std::nan("")) : right(ray, s); }}},
        {Shape::ellipsoid, {"a sphere of its largest radius", on([](S s) {
                                const Ellipsoid<double> e = s.ellipsoid();
                                const double r = std::max({e.radii.x, e.radii.y, e.radii.z});
                                return Solid<double>(Ellipsoid<double>{e.centre, {r, r, r}});
                            })}},
        {Shape::ellipsoid, {"x for y in its radii", on([](S s) {
                                Solid<double> other = s;
                                std::swap(other.numbers[3], other.numbers[4]);
                                return other;
                            })}},
        {Shape::cylinder, {"without end", on([stretched](S s) { return stretched(s, -20, 20); })}},
        {Shape::cylinder, {"without caps", on(as_tube)}},
        {Shape::cylinder,
         {"a hit at NaN along its axis",
          [](R ray, S s) {
              return length(cross(Vec<double>(s.point(3) - s.point(0)), ray.direction)) == 0 ? Found(std::nan(""))
                                                                                             : right(ray, s);
          }}},
        {Shape::capsule, {"with flat ends", on(as_cylinder)}},
        {Shape::capsule, {"one end flat", on([stretched](S s) {
                              Solid<double> other = s;
                              const Vec<double> v = s.point(3) - s.point(0);
                              other.set_point(3, s.point(3) - (0.9 * s.numbers[6] / length(v)) * v);
                              return other;
                          })}},
        {Shape::tube, {"with caps", on(as_cylinder)}},
        {Shape::tube,
         {"its first wall alone",
          [](R ray, S s) {
              const Tube<double> tube = s.tube();
              Solid<double> endless = s;
              const Vec<double> v = tube.top - tube.bottom;
              endless.set_point(0, tube.bottom - 100.0 * v), endless.set_point(3, tube.top + 100.0 * v);
              const Found t = right(ray, endless);
              const Found own = right(ray, s);
              return t && own && std::fabs(*t - *own) < 1e-9 ? own : Found();
          }}},
        {Shape::cone, {"with its ends exchanged", on([](S s) {
                           Solid<double> other = s;
                           std::swap(other.numbers[6], other.numbers[7]);
                           return other;
                       })}},
        {Shape::cone, {"a cylinder of its base", on(as_cylinder)}},
        {Shape::torus, {"without a hole", on([](S s) {
                            const Torus<double> t = s.torus();
                            return Solid<double>(Ellipsoid<double>{
                                t.centre,
                                {t.major_radius + t.minor_radius, t.minor_radius, t.major_radius + t.minor_radius}});
                        })}},
        {Shape::torus,
         {"its outer wall alone",
          [](R ray, S s) {
              Found t = right(ray, s);
              Vec<double> o = ray.origin;
              double passed = 0;
              for (int i = 0; t && i < 4; ++i) {  // the last crossing
                  const double step = *t + 1e-9;
                  passed += step;
                  o = o + step * ray.direction;
                  const Found next = right({o, ray.direction}, s);
                  if (!next) return Found(passed);
                  t = next;
              }
              return t;
          }}},
        {Shape::torus, {"its axis upright", on([](S s) {
                            Solid<double> other = s;
                            other.set_point(3, {0, 1, 0});
                            return other;
                        })}},
    };
}

}  // namespace

TEST_CASE("contract: every form of the catalogue does as it says under another name", "[doors]") {
    // The promises that a form breaks by its own formula, as its source has it: what is asked here is what the words of
    // the catalogue say.
    const std::set<std::string> epsilon{"scale"}, no_touch{"touching"}, at_origin{"at-origin"}, within{"within"};
    const std::map<std::string, std::set<std::string>> known{
        {"sphere.pbrt_interval", no_touch},     // of an interval around 0 the lower end is below 0
        {"sphere.closest_approach", no_touch},  // 0/0 where the origin is moved to a tangent point
        {"box.ieee_minmax", no_touch},          // 0 times infinity in the plane of a face
        {"triangle.moller_trumbore", epsilon},  // of the determinant
        {"triangle.moller_trumbore_culling", epsilon},
        {"ellipsoid.cesium", {"inside", "at-origin"}},  // near is 0 from inside; a miss from the surface outwards
        {"cylinder.quilez", {"hit"}},                   // 0/0 along its axis
        {"cylinder.framed",
         {"t", "direction", "far", "inside", "behind", "touching", "at-origin", "close"}},  // the same
        {"capsule.quilez", {"t", "inside", "at-origin", "close"}},              // the same
        {"cone.quilez", {"touching", "at-origin"}},  // caps are met from below and above alone, without their rims
        {"cone.embree", no_touch},                   // without rims
        {"plane.quotient", within},                  // a quotient by 0 is infinite, and not below 0
        {"plane.stored_distance", within},
        {"plane.two_words", within},
        {"plane.epsilon", {"at-origin", "close", "scale"}},
        {"torus.quilez", {"close", "at-origin"}},
        {"torus.brl_cad", no_touch},
        {"torus.sturm", at_origin},  // roots behind the place where it begins, without that place
        {"torus.bracketed", at_origin},
        {"torus.bracketed_double", at_origin}};
    std::map<std::string, std::set<std::string>> found;
    int tried = 0;
    for (const auto& row : intersect::table::catalogue()) {
        if (!is_solid(row.shape)) continue;
        for (const int bits : {32, 64}) {
            if (bits == 32 ? !row.native32 : !row.native64) continue;
            ++tried;
            const ForeignForm form = renamed(row, bits), first = renamed(row, bits, true);
            const auto broken = broken_of(form, row.info->roots == intersect::Roots::both ? &first : nullptr);
            const std::string name(row.info->name);
            const auto listed = known.find(name);
            for (const auto& [subject, words] : broken) {
                INFO(name << ' ' << bits << ' ' << subject << ": " << words);
                CHECK((listed != known.end() && listed->second.contains(subject)));
                found[name].insert(subject);
            }
        }
    }
    CHECK(tried > 150);
    for (const auto& [name, subjects] : known)
        for (const std::string& subject : subjects) {
            INFO(name << ' ' << subject);
            CHECK(found[name].contains(subject));
        }
}

TEST_CASE("contract: what the truth answers does as it says", "[doors]") {
    for (const ShapeRow& shape : shape_rows) {
        const auto broken = broken_of(solved_by(shape.shape, right));
        for (const auto& [subject, words] : broken) FAIL_CHECK(shape.name << ' ' << subject << ": " << words);
    }
}

TEST_CASE("contract: ten wrong forms of each shape are found", "[doors]") {
    std::map<Shape, int> found;
    const auto try_one = [&found](Shape shape, const Mistake& mistake) {
        const auto broken = broken_of(solved_by(shape, mistake.solve));
        INFO(row_of(shape).name << ' ' << mistake.name);
        CHECK_FALSE(broken.empty());
        found[shape] += broken.empty() ? 0 : 1;
    };
    for (const ShapeRow& shape : shape_rows)
        for (const Mistake& mistake : mistakes_of_all())
            if (shape.shape != Shape::plane || mistake.name != "half as large") try_one(shape.shape, mistake);
    for (const auto& [shape, mistake] : mistakes_of_one()) try_one(shape, mistake);
    for (const ShapeRow& shape : shape_rows) CHECK(found[shape.shape] >= 10);
}

}  // namespace test_contract
