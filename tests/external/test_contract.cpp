// `plugin check` compares a form with the truth. It accepts every form of the catalogue under another name, and detects
// ten wrong forms of each shape.
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "catch.hpp"
#include "external/wrong_forms.hpp"
#include "intersect/external/contract.hpp"
#include "intersect/external/foreign_batch.hpp"
#include "intersect/table/table.hpp"
#include "measure/contract/probe.hpp"
#include "measure/tape/contraction.hpp"
#include "measure/truth/truth.hpp"

namespace test_contract {

using namespace lostbits;
using namespace lostbits::test;
using measure::contract::Observation;
using measure::contract::try_contract;

namespace {

/// The kernels of a row behind the interface of external intersectors; `roots` are the roots that it returns.
template <class S>
void answer_by_row(const intersect::table::Intersector& row, intersect::Roots roots, const lb_batch& batch) {
    std::array<std::vector<S>, 6> columns;
    std::vector<Primitive<S>> primitives;
    const auto* const rays = static_cast<const S*>(batch.rays);
    const auto* const numbers = static_cast<const S*>(batch.primitives);
    for (std::size_t i = 0; i < batch.size; ++i) {
        for (std::size_t k = 0; k < 6; ++k) columns[k].push_back(rays[6 * i + k]);
        Primitive<S> primitive(row.shape);
        std::copy_n(numbers + batch.primitive_stride * i, primitive.shape_numbers().size(), primitive.numbers.begin());
        primitives.push_back(primitive);
    }
    const std::size_t n = batch.size;
    std::vector<S> t(n), near(n), far(n);
    intersect::table::RayBatch<S> ray_batch{columns[0], columns[1], columns[2], columns[3], columns[4], columns[5]};
    if (batch.ends != nullptr) ray_batch.tmax = {static_cast<const S*>(batch.ends), n};
    const intersect::table::HitBatch<S> hits{t, near, far, {batch.hit, n}};
    const intersect::Target<S> target{std::span<const Primitive<S>>(primitives)};
    if constexpr (std::same_as<S, float>) row.native32(ray_batch, target, hits);
    else row.native64(ray_batch, target, hits);
    auto* const out = static_cast<S*>(batch.near_far);
    for (std::size_t i = 0; i < n; ++i) {
        out[2 * i] = roots == intersect::Roots::both ? near[i] : t[i];
        out[2 * i + 1] = far[i];
    }
}

/// A row of the catalogue as a form of somebody else; `first`: only t, for a form that returns near and far.
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
                      .flags = LB_ONE_THREAD | (takes_tmax(row.shape) ? 0U : unsigned{LB_NO_END})};
    if (first && contract.inside == intersect::Inside::near) contract.inside = intersect::Inside::usual;
    const intersect::Roots roots = contract.roots;
    return {.contract = contract, .provider = "catalogue", .answer = [&row, bits, roots](const lb_batch& batch) {
                if (bits == 32) answer_by_row<float>(row, roots, batch);
                else answer_by_row<double>(row, roots, batch);
            }};
}

std::map<std::string, std::string> broken_of(const ForeignForm& form, const ForeignForm* first = nullptr) {
    std::map<std::string, std::string> broken;
    for (const Observation& observation : try_contract(form, first))
        if (observation.verdict == Observation::Verdict::broken) broken[observation.subject] = observation.text;
    return broken;
}

}  // namespace

TEST_CASE("contract: every form of the catalogue keeps its contract under another name", "[external]") {
    // The properties that a form lacks by its own formula, as in its source: the checks use the properties of the
    // catalogue.
    const std::set<std::string> epsilon{"scale"}, no_touch{"touching"}, at_origin{"at-origin"}, within{"within"};
    const std::map<std::string, std::set<std::string>> known{
        {"sphere.pbrt_interval", no_touch},     // the lower end of an interval around 0 is below 0
        {"sphere.closest_approach", no_touch},  // 0/0 where the origin is moved to a tangent point
        {"box.ieee_minmax", no_touch},          // 0 times infinity in the plane of a face
        {"triangle.moller_trumbore", epsilon},  // of the determinant
        {"triangle.moller_trumbore_culling", epsilon},
        {"ellipsoid.cesium", {"inside", "at-origin"}},  // near is 0 from inside; a miss from the surface outwards
        {"cylinder.quilez", {"hit"}},                   // 0/0 along its axis
        {"cylinder.framed", {"t", "behind"}},           // the same
        {"capsule.quilez", {"t"}},                      // the same
        {"cone.quilez", {"touching", "at-origin"}},  // caps can be hit from below and above alone, without their rims
        {"cone.embree", {"touching", "edges"}},      // without rims
        {"plane.quotient", within},                  // a quotient by 0 is infinite, not below 0
        {"plane.stored_distance", within},
        {"plane.two_words", within},
        {"plane.epsilon", {"at-origin", "close", "scale"}},
        {"torus.quilez", {"close", "at-origin"}},
        {"torus.brl_cad", no_touch},
        {"torus.sturm", at_origin},  // roots behind the origin, without the origin itself
        {"torus.bracketed", at_origin},
        {"torus.bracketed_double", at_origin}};
    std::map<std::string, std::set<std::string>> found;
    int tried = 0;
    for (const auto& row : intersect::table::catalogue()) {
        if (!is_primitive(row.shape)) continue;
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

TEST_CASE("contract: the truth itself keeps its contract", "[external]") {
    for (const ShapeRow& shape : shape_rows) {
        const auto broken = broken_of(make_form(shape.shape, right));
        for (const auto& [subject, words] : broken) FAIL_CHECK(shape.name << ' ' << subject << ": " << words);
    }
}

namespace {

std::set<std::string> subjects_of(const std::map<std::string, std::string>& broken) {
    std::set<std::string> subjects;
    for (const auto& [subject, words] : broken) subjects.insert(subject);
    return subjects;
}

/// Changes the t of every hit.
template <class Change>
Solver with_t(const Change& change) {
    return [change](const Ray<double>& ray, const Primitive<double>& primitive) {
        const AnswerT t = right(ray, primitive);
        return t ? AnswerT(change(*t, ray)) : t;
    };
}

/// Returns the answers for a sphere of another radius.
template <class Change>
Solver with_radius(const Change& change) {
    return [change](const Ray<double>& ray, const Primitive<double>& primitive) {
        Primitive<double> other = primitive;
        other.numbers[3] = change(primitive.numbers[3]);
        return right(ray, other);
    };
}

}  // namespace

TEST_CASE("contract: one mistake in t has one explanation, and a halved t is not blamed on the direction",
          "[external]") {
    const std::set<std::string> t{"t"};
    const auto broken_sphere = [](const Solver& solves) { return broken_of(make_form(Shape::sphere, solves)); };
    CHECK(subjects_of(broken_sphere(with_t([](double x, const auto&) { return 3 * x; }))) == t);
    CHECK(subjects_of(broken_sphere(with_t([](double x, const auto&) { return x + 1; }))) == t);
    CHECK(subjects_of(broken_sphere(with_t([](double, const auto&) { return 5.0; }))) == t);
    // The form is wrong, and returns a distance besides.
    const auto distance =
        broken_sphere(with_t([](double x, const auto& ray) { return x * length(ray.direction) + 1; }));
    CHECK(subjects_of(distance) == std::set<std::string>{"t", "direction"});
    CHECK(distance.at("direction").find("say LB_UNIT") != std::string::npos);
    // Right for unit directions, and no distance for others: the property says that it takes no others.
    ForeignForm odd = make_form(Shape::sphere,
                                with_t([](double x, const auto& ray) { return x * std::sqrt(length(ray.direction)); }));
    const auto broken = broken_of(odd);
    REQUIRE(broken.contains("direction"));
    CHECK(broken.at("direction").find("if so, say LB_UNIT") != std::string::npos);
    odd.contract.direction = intersect::Direction::unit;
    CHECK(broken_of(odd).empty());
}

TEST_CASE("contract: twice a radius and its square are told apart", "[external]") {
    const auto words = [](const Solver& solves) { return broken_of(make_form(Shape::sphere, solves)).at("t"); };
    CHECK(words(with_radius([](double r) {
              return 2 * r;
          })).starts_with("the form doubles the radius (does it compute a diameter?)"));
    CHECK(words(with_radius([](double r) { return r * r; })).starts_with("the radius is squared once too often"));
    CHECK(words(with_radius([](double r) {
              return r / 2;
          })).starts_with("the form expects a diameter instead of the radius"));
    CHECK(words(with_radius([](double r) {
              return std::sqrt(r);
          })).starts_with("the form expects the square of the radius"));
    CHECK(words(with_radius([](double r) { return r + 2; })).starts_with("t is wrong"));
}

TEST_CASE("contract: a wrong radius of a disc is named, and an inner radius that is ignored", "[external]") {
    const auto changed_disc = [](std::size_t number, const auto& change) {
        return make_form(Shape::disc, [number, change](const Ray<double>& ray, const Primitive<double>& primitive) {
            Primitive<double> other = primitive;
            other.numbers[number] = change(primitive.numbers[number]);
            return right(ray, other);
        });
    };
    const auto of_radius = [&](const auto& change) {
        const auto broken = broken_of(changed_disc(6, change));
        CHECK(subjects_of(broken) == std::set<std::string>{"t"});
        return broken.contains("t") ? broken.at("t") : std::string();
    };
    CHECK(of_radius([](double r) { return 2 * r; }).starts_with("the form doubles the outer_radius"));
    CHECK(of_radius([](double r) { return r * r; }).starts_with("the outer_radius is squared once too often"));
    CHECK(of_radius([](double r) {
              return r / 2;
          }).starts_with("the form expects a diameter instead of the outer_radius"));
    CHECK(of_radius([](double r) {
              return std::sqrt(r);
          }).starts_with("the form expects the square of the outer_radius"));
    const auto full = broken_of(changed_disc(7, [](double) { return 0.0; }));
    REQUIRE(subjects_of(full) == std::set<std::string>{"rays"});
    CHECK(full.at("rays").find("it seems to ignore the inner_radius") != std::string::npos);
    ForeignForm silent = changed_disc(6, [](double r) { return std::sqrt(r); });
    silent.contract.roots = intersect::Roots::none;
    CHECK(subjects_of(broken_of(silent)) == std::set<std::string>{"hit"});
}

TEST_CASE("contract: a NaN answer comes with advice on how to mark a miss", "[external]") {
    using R = const Ray<double>&;
    using S = const Primitive<double>&;
    const auto never = broken_of(make_form(
        Shape::sphere, [](R ray, S primitive) { return right(ray, primitive) ? AnswerT(std::nan("")) : AnswerT(); }));
    REQUIRE(never.contains("t"));
    CHECK(never.at("t").starts_with("t is not a number"));
    const auto for_a_miss = broken_of(make_form(Shape::sphere, [](R ray, S primitive) {
        const AnswerT t = right(ray, primitive);
        return t ? t : AnswerT(std::nan(""));
    }));
    REQUIRE(for_a_miss.contains("aside"));
    CHECK(for_a_miss.at("aside").starts_with("a ray that passes by hits with a t that is not a number; set hit to 0"));
}

TEST_CASE("contract: a surface at the origin is tested from the sides that can be hit", "[external]") {
    for (const Shape shape : {Shape::triangle, Shape::disc, Shape::plane}) {
        const auto one_sided =
            broken_of(make_form(shape, [](const Ray<double>& ray, const Primitive<double>& primitive) {
                return ray.direction.z < 0 ? AnswerT() : right(ray, primitive);
            }));
        INFO(row_of(shape).name);
        CHECK(subjects_of(one_sided) == std::set<std::string>{"facing"});
        ForeignForm denies = make_form(shape, right);
        denies.contract.at_origin = intersect::AtOrigin::miss;
        const auto broken = broken_of(denies);
        REQUIRE(subjects_of(broken) == std::set<std::string>{"at-origin"});
        CHECK(broken.at("at-origin") == "a surface at the origin counts; say LB_HIT (at_origin=hit)");
    }
}

TEST_CASE("contract: answers that change with each call allow no verdict on batches, primitives and threads",
          "[external]") {
    int calls = 0;
    ForeignForm form = make_form(Shape::sphere, right);
    form.contract.flags &= ~unsigned{LB_ONE_THREAD};
    form.answer = [answer = form.answer, &calls](const lb_batch& batch) {
        answer(batch);
        if (batch.size > 1 && ++calls % 2 == 0) batch.hit[7] = batch.hit[7] == 0 ? 1 : 0;
    };
    std::set<std::string> judged;
    bool noted = false;
    for (const Observation& observation : try_contract(form)) {
        if (observation.verdict != Observation::Verdict::noted) judged.insert(observation.subject);
        noted = noted || (observation.subject == "again" && observation.verdict == Observation::Verdict::noted);
    }
    CHECK(judged.contains("again"));
    CHECK(noted);
    for (const char* subject : {"batches", "primitives", "threads"}) CHECK_FALSE(judged.contains(subject));
}

namespace {

/// The one finding of the probe `edges`.
Observation edges_of(const ForeignForm& form) {
    std::vector<Observation> found;
    for (const Observation& observation : try_contract(form))
        if (observation.subject == "edges") found.push_back(observation);
    REQUIRE(found.size() == 1);
    return found.front();
}

/// Loses rays whose first point is nearer than a thousandth to a given place.
template <class Near>
ForeignForm losing(Shape shape, const Near& near) {
    return make_form(shape, [near](const Ray<double>& ray, const Primitive<double>& primitive) {
        const AnswerT t = right(ray, primitive);
        return t && near(ray.origin + *t * ray.direction, primitive) ? AnswerT() : t;
    });
}

const intersect::table::Intersector& row_named(std::string_view name) {
    return *std::ranges::find(intersect::table::catalogue(), name, [](const auto& row) { return row.info->name; });
}

}  // namespace

TEST_CASE("contract: hits lost where the parts of a surface meet are found and located", "[external]") {
    using enum Observation::Verdict;
    const auto at_rim = [](const Vec<double>& p, const Primitive<double>& primitive) {
        const Cylinder<double> c = primitive.cylinder();
        const Vec<double> axis = c.top - c.base;
        const double u = dot(p - c.base, axis) / square(axis), r = length(p - (c.base + u * axis));
        return std::min(std::fabs(u), std::fabs(1 - u)) < 1e-3 && std::fabs(r / c.radius - 1) < 1e-3;
    };
    const Observation rim = edges_of(losing(Shape::cylinder, at_rim));
    CHECK(rim.verdict == broken);
    CHECK(rim.text.find("aimed at its rim") != std::string::npos);

    const auto at_apex = [](const Vec<double>& p, const Primitive<double>& primitive) {
        const Cone<double> c = primitive.cone();
        return c.top_radius == 0 && length(p - c.top) < 1e-3 * c.base_radius;
    };
    CHECK(edges_of(losing(Shape::cone, at_apex)).text.find("aimed at its apex") != std::string::npos);

    const auto at_corner = [](const Vec<double>& p, const Primitive<double>& primitive) {
        const Box<double> b = primitive.box();
        int ends = 0;
        for (int k = 0; k < 3; ++k) ends += std::min(std::fabs(p[k] - b.lo[k]), std::fabs(p[k] - b.hi[k])) < 1e-3;
        return ends == 3;
    };
    const Observation corner = edges_of(losing(Shape::box, at_corner));
    CHECK(corner.verdict == broken);
    CHECK(corner.text.find("aimed at its corner") != std::string::npos);

    const auto at_vertex = [](const Vec<double>& p, const Primitive<double>& primitive) {
        const Triangle<double> t = primitive.triangle();
        return std::min({length(p - t.a), length(p - t.b), length(p - t.c)}) < 1e-3 * t.unit();
    };
    const Observation vertex = edges_of(losing(Shape::triangle, at_vertex));
    CHECK(vertex.verdict == warned);
    CHECK(vertex.text.find("at a vertex of triangles") != std::string::npos);
}

TEST_CASE("contract: the first scale that fails is named", "[external]") {
    using enum Observation::Verdict;
    for (const Shape shape : {Shape::capsule, Shape::disc, Shape::triangle, Shape::torus}) {
        const auto with_epsilon = [](const Ray<double>& ray, const Primitive<double>& primitive) {
            const AnswerT t = right(ray, primitive);
            return t && *t < 0x1p-40 ? AnswerT() : t;
        };
        const Observation found = edges_of(make_form(shape, with_epsilon));
        INFO(row_of(shape).name << ": " << found.text);
        CHECK(found.verdict == (shape == Shape::triangle ? warned : noted));  // rounding lets light through at 2^0, too
        CHECK(found.text.find("the first of nine scales that fails is 2^-45") != std::string::npos);
    }
    CHECK(edges_of(make_form(Shape::capsule, right)).verdict == kept);
}

TEST_CASE("contract: contraction makes a watertight test leak", "[external]") {
    using enum Observation::Verdict;
    const Observation filtered = edges_of(renamed(row_named("triangle.filtered"), 32));
    INFO(filtered.text);
    CHECK(filtered.text.starts_with("no ray passes"));
    const auto passing = [](const intersect::table::Intersector& row) {
        const Observation found = edges_of(renamed(row, 32));
        INFO(found.text);
        CHECK(found.verdict == warned);
        return found.text.starts_with("no ray") ? 0 : std::stoi(found.text);
    };
    const auto& woop = row_named("triangle.woop");
    CHECK(passing(woop) <= 1);  // 3e5 edges away, where a vertex is rounded by a hundredth of an edge
    CHECK(passing(measure::tape::contract_form(woop)) >= 10);
    CHECK(edges_of(renamed(row_named("triangle.undivided"), 64)).verdict == warned);
}

TEST_CASE("contract: ten wrong forms of each shape are detected", "[external]") {
    std::map<Shape, int> found;
    const auto try_one = [&found](Shape shape, const Mistake& mistake) {
        const auto broken = broken_of(make_form(shape, mistake.solve));
        INFO(row_of(shape).name << ' ' << mistake.name);
        CHECK_FALSE(broken.empty());
        found[shape] += broken.empty() ? 0 : 1;
    };
    for (const ShapeRow& shape : shape_rows)
        for (const Mistake& mistake : make_common_mistakes())
            if (shape.shape != Shape::plane || mistake.name != "half as large") try_one(shape.shape, mistake);
    for (const auto& [shape, mistake] : make_mistakes_of_shapes()) try_one(shape, mistake);
    for (const ShapeRow& shape : shape_rows) CHECK(found[shape.shape] >= 10);
}

}  // namespace test_contract
