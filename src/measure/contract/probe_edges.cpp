// Probes with rays that look for trouble: at rims, seams, apexes and edges behind which a primitive goes on, and at the
// edges and vertices of meshes, at nine scales.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "measure/contract/random_questions.hpp"
#include "measure/crossing/mesh_crossings.hpp"
#include "scene/sweep/distributions.hpp"
#include "shapes/triangle/mesh/made.hpp"

namespace lostbits::measure::contract {
namespace {

namespace rays = scene::rays;
using scene::triangle::Face;
using scene::triangle::Mesh;

/// Powers of two by which all lengths are multiplied, the smallest change first.
constexpr std::array scale_powers{0, -15, 15, -30, 30, -45, 45, -60, 60};

bool is_off_surface(const Primitive<double>& primitive, const Vec<double>& p) {
    return std::fabs(visit(primitive, [&p](const auto& shape) { return shape.distance(p); })) >
           half_extent_of(primitive) / 16;
}

/// Sets lengths that may be 0 to 0: such a cone has an apex.
Primitive<double> pointed(Primitive<double> primitive) {
    for_each_key(primitive.shape, [&primitive](const Key& key, std::size_t k) {
        if (key.limit == Key::Limit::not_negative) primitive.numbers[k] = 0;
    });
    return primitive;
}

/// Rays at one kind of place of random primitives. Half of them are aimed at the place itself, the others up to 2^-10
/// of the primitive beside it. All are benign. A ray that misses counts only if the place is not of the surface: one
/// that touches an edge from outside would pass for benign, as few rays near it hit.
std::vector<AnsweredQuestion> rays_at(const Trial& trial, const scene::sweep::DistributionRow& distribution, int aim,
                                      bool upright) {
    constexpr int attempts = 320, changes = 32;
    constexpr std::size_t most = 64;
    RandomNumbers random;
    rays::Random places(1);
    std::vector<Question> all;
    for (int i = 0; i < attempts && all.size() < most; ++i) {
        const Primitive<double> any_primitive = random_primitive(trial.shape, upright, random);
        const Primitive<double> primitive = i % 4 < 2 ? any_primitive : pointed(any_primitive);
        const rays::AimedPlace target = distribution.aimed_at(places, primitive, aim);
        const Vec<double> any = random.unit(), d = target.along.value_or(any);
        const double half = half_extent_of(primitive), aside = i % 2 == 0 ? 0 : half * std::ldexp(1, -10 - i % 16);
        const Vec<double> origin = target.point + aside * random.unit() - 4 * half * d;
        Question q = question_of(origin, d, primitive);
        for (int k = 0; k < 3 && trial.contract.bits == 64; ++k)  // nearer to the place than floats are
            q.ray[static_cast<std::size_t>(k)] = origin[k], q.ray[static_cast<std::size_t>(k) + 3] = d[k];
        if ((trial.truth(q).hit || is_off_surface(primitive, target.point)) && is_benign(trial, q, random, changes))
            all.push_back(q);
    }
    return with_truth(trial, all);
}

/// Rays at all places of a shape, by the name of the place.
using Places = std::vector<std::pair<std::string_view, std::vector<AnsweredQuestion>>>;

Places places_of(const Trial& trial, const scene::sweep::DistributionRow& distribution, bool upright) {
    Places places;
    for (const auto& [name, aim] : distribution.aims)
        places.emplace_back(name, rays_at(trial, distribution, aim, upright));
    return places;
}

WrongCount wrong_at_scale(const Trial& trial, const Places& places, int power) {
    WrongCount found;
    for (const auto& [name, known] : places) {
        WrongCount there(trial, known, power);
        if (!there.first.empty()) there.first = fmt::format("aimed at its {}, {}", name, there.first);
        found.add(there);
    }
    return found;
}

/// For example "383 of 2200 (17 %)".
std::string share_text(std::size_t part, std::size_t whole) {
    const double percent = 100.0 * static_cast<double>(part) / static_cast<double>(std::max<std::size_t>(whole, 1));
    return fmt::format("{} of {} ({:.3g} %)", part, whole, percent);
}

std::string power_text(int power) { return "2^" + std::to_string(power); }

/// Words about the first scale at which far more is wrong than at 2^0.
std::string scale_text(int power, std::size_t wrong, std::size_t asked) {
    return fmt::format(
        "; the first of nine scales that fails is {}, where {} of {} are answered wrongly: it compares with a fixed "
        "number, or its products leave the range of the format",
        power_text(power), wrong, asked);
}
constexpr const char* all_scales = ", at nine scales from 2^-60 to 2^60";

/// Axes along x, y and z come first: a form may know no others.
void try_places(Trial& trial, const scene::sweep::DistributionRow& distribution) {
    std::size_t asked = 0;
    std::string names, beyond;
    for (const auto& [name, aim] : distribution.aims) names += (names.empty() ? "" : ", ") + std::string(name);
    for (const bool upright : {true, false}) {
        if (upright && !has_axis(trial.shape)) continue;
        const Places places = places_of(trial, distribution, upright);
        const WrongCount plain = wrong_at_scale(trial, places, 0);
        asked += plain.asked;
        if (plain.wrong > 0) {
            const bool oblique = !upright && has_axis(trial.shape);
            const std::string words = fmt::format(
                "{} of {} rays are answered wrongly that cross the surface near a place where its parts meet; the "
                "first is {}{}",
                plain.wrong, plain.asked, plain.first, oblique ? "; where axes lie along x, y or z it is right" : "");
            return plain.is_many() && !oblique ? trial.broken(words) : trial.warned(words);
        }
        for (const int power : scale_powers)
            if (const WrongCount found = wrong_at_scale(trial, places, power); found.is_many() && beyond.empty())
                beyond = scale_text(power, found.wrong, found.asked);
    }
    const std::string words =
        fmt::format("{} rays at places of {} ({}) get the right answer", asked, row_of(trial.shape).plural, names);
    if (beyond.empty()) trial.kept(words + all_scales);
    else trial.noted(words + beyond);
}

Vec<double> in_format(const Vec<double>& v, int bits) { return bits == 32 ? rays::stored(v) : v; }

/// A closed convex mesh: an icosphere, stretched and turned at random, in numbers of the format.
Mesh random_mesh(int bits, rays::Random& random) {
    Mesh mesh = scene::triangle::make_icosphere(1, {0, 0, 0}, 1);
    const Vec<double> x = random.between(0.5, 2) * rays::draw_direction(random);
    const Vec<double> y = random.between(0.5, 2) * rays::draw_across(random, x);
    const Vec<double> z = cross((1 / length(x)) * x, y);
    for (Vec<double>& v : mesh.vertices) v = in_format(v.x * x + v.y * y + v.z * z, bits);
    tidy(mesh, [](std::size_t) { return std::string(); });
    return mesh;
}

/// A ray that meets a closed mesh near an edge or a vertex, and the triangles around it.
struct RayAtMeshEdge {
    Ray<double> ray{};
    bool at_vertex = false;
    double distance = 0;                            ///< from the origin to the point, in lengths of the edge
    std::vector<Primitive<double>> around = {};     ///< those at the edge or the vertex first
    std::vector<Primitive<double>> elsewhere = {};  ///< the others that face the ray
};

/// Moves a number by up to two places of the format.
double moved(double x, int bits, rays::Random& random) {
    for (int k = random.below(3); k > 0; --k) {
        const double towards = random.sign() * std::numeric_limits<float>::max();
        x = bits == 32 ? std::nextafter(static_cast<float>(x), static_cast<float>(towards))
                       : std::nextafter(x, towards);
    }
    return x;
}

/// Draws a ray from 2^-10 to 2^20 lengths of an edge away. It meets all triangles at the edge or the vertex from the
/// front, at an angle of 7° or more, so that no light should pass. Nothing if that is not so for the rounded ray.
std::optional<RayAtMeshEdge> draw_ray(const Mesh& mesh, const intersect::external::Contract& contract,
                                      rays::Random& random) {
    const Face& face = mesh.faces[static_cast<std::size_t>(random.below(static_cast<int>(mesh.faces.size())))];
    const auto k = static_cast<std::size_t>(random.below(3));
    const std::array<std::uint32_t, 2> ends{face[k], face[(k + 1) % 3]};
    RayAtMeshEdge drawn;
    drawn.at_vertex = random.below(3) == 0;
    const Vec<double> a = mesh.vertices[ends[0]], b = mesh.vertices[ends[1]];
    const Vec<double> at = drawn.at_vertex ? a : a + random.unit() * (b - a), any = rays::draw_direction(random);
    const Vec<double> d = dot(any, at) < 0 ? any : -1.0 * any;  // the mesh is around the origin
    const int octave = random.below(30);
    drawn.distance = std::ldexp(1 + random.unit(), octave - 10);
    const Vec<double> origin = in_format(at - (drawn.distance * length(b - a)) * d, contract.bits), to = at - origin;
    Vec<double> direction = in_format((1 / length(to)) * to, contract.bits);
    if (contract.direction == intersect::Direction::any && random.below(4) != 0)
        for (int i = 0; i < 3; ++i) direction[i] = moved(direction[i], contract.bits, random);
    drawn.ray = {origin, direction};
    bool is_met = false;
    for (const Face& f : mesh.faces) {
        const auto has = [&](std::uint32_t v) { return std::ranges::count(f, v) != 0; };
        const bool is_at = has(ends[0]) && (drawn.at_vertex || has(ends[1]));
        const auto triangle = scene::triangle::corners_of(f, mesh.vertices);
        const Vec<double> n = cross(triangle.b - triangle.a, triangle.c - triangle.a);
        if (!has(ends[0]) && (drawn.at_vertex || !has(ends[1]))) {
            if (dot(n, direction) < 0) drawn.elsewhere.emplace_back(triangle);
            continue;
        }
        if (is_at && !(-dot(n, direction) > 0.125 * length(n))) return std::nullopt;
        if (is_at) is_met = is_met || truth::find_truth(drawn.ray, Primitive<double>(triangle)).is_hit();
        drawn.around.insert(is_at ? drawn.around.begin() : drawn.around.end(), triangle);
    }
    return is_met ? std::optional(drawn) : std::nullopt;
}

Question question_at(const Ray<double>& ray, const Primitive<double>& primitive) {
    Question q{.ray = {ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x, ray.direction.y, ray.direction.z},
               .primitive = {}};
    std::ranges::copy(primitive.used(), q.primitive.begin());
    return q;
}

/// Rays at edges and vertices of meshes, and what passes.
struct EdgeRayCounts {
    std::array<std::size_t, 2> asked{}, passed{};  ///< at edges, at vertices
    std::string first;

    void add(const EdgeRayCounts& more) {
        for (std::size_t k = 0; k < 2; ++k) asked[k] += more.asked[k], passed[k] += more.passed[k];
        if (first.empty()) first = more.first;
    }
    [[nodiscard]] std::size_t all_asked() const { return asked[0] + asked[1]; }
    [[nodiscard]] std::size_t all_passed() const { return passed[0] + passed[1]; }
};

/// The ray and each of the triangles, at a scale.
std::vector<Question> questions_at(const Trial& trial, const Ray<double>& ray,
                                   const std::vector<Primitive<double>>& triangles, int power) {
    std::vector<Question> questions;
    for (Primitive<double> primitive : triangles) {
        // Forms for one side see the mesh from inside: `ask` mirrors what only sees fronts.
        if (trial.contract.facing != intersect::Facing::both)
            std::swap_ranges(primitive.numbers.begin(), primitive.numbers.begin() + 3, primitive.numbers.begin() + 3);
        questions.push_back(scaled_by(question_at(ray, primitive), trial.shape, power));
    }
    return questions;
}

bool any_hit(const Trial& trial, std::span<const Question> questions, std::span<const Reply> replies) {
    for (std::size_t k = 0; k < questions.size(); ++k)
        if (read_reply(trial.contract, replies[k], questions[k]).hit) return true;
    return false;
}

/// Light passes if the form claims no triangle that faces the ray. Those around the edge or vertex are asked in
/// one batch, the others only if it claims none of these. Each scale has rays of its own.
EdgeRayCounts light_at_scale(const Trial& trial, std::size_t scale) {
    constexpr int attempts = 768, rays_of_mesh = 16;
    rays::Random random(scale + 1);
    std::vector<RayAtMeshEdge> all;
    std::vector<Question> questions;
    Mesh mesh;
    for (int i = 0; i < attempts; ++i) {
        if (i % rays_of_mesh == 0) mesh = random_mesh(trial.contract.bits, random);
        const auto drawn = draw_ray(mesh, trial.contract, random);
        if (!drawn) continue;
        all.push_back(*drawn);
        const auto around = questions_at(trial, drawn->ray, drawn->around, scale_powers[scale]);
        questions.insert(questions.end(), around.begin(), around.end());
    }
    const std::vector<Reply> replies = ask(trial.form, questions);
    EdgeRayCounts light;
    std::size_t first = 0;
    for (const RayAtMeshEdge& drawn : all) {
        const auto around = std::span(questions).subspan(first, drawn.around.size());
        bool is_stopped = any_hit(trial, around, std::span(replies).subspan(first, drawn.around.size()));
        first += drawn.around.size();
        if (!is_stopped) {
            const auto others = questions_at(trial, drawn.ray, drawn.elsewhere, scale_powers[scale]);
            is_stopped = any_hit(trial, others, ask(trial.form, others));
        }
        ++light.asked[drawn.at_vertex];
        light.passed[drawn.at_vertex] += !is_stopped;
        if (!is_stopped && light.first.empty())
            light.first = fmt::format("ray {} at {} of triangles {} and {}, {:.3g} edge lengths away",
                                      numbers_text(around[0].ray), drawn.at_vertex ? "a vertex" : "the edge",
                                      numbers_text(std::span(around[0].primitive).first(9)),
                                      numbers_text(std::span(around[1].primitive).first(9)), drawn.distance);
    }
    return light;
}

void try_mesh(Trial& trial) {
    const EdgeRayCounts plain = light_at_scale(trial, 0);
    EdgeRayCounts all = plain;
    std::string beyond = all_scales;
    for (std::size_t scale = 1; scale < scale_powers.size(); ++scale) {
        const EdgeRayCounts found = light_at_scale(trial, scale);
        if (20 * found.all_passed() > found.all_asked() + 60 * plain.all_passed()) {
            beyond = scale_text(scale_powers[scale], found.all_passed(), found.all_asked());
            break;
        }
        all.add(found);
    }
    const bool everywhere = beyond == all_scales;
    if (all.all_passed() > 0)
        return trial.warned(fmt::format(
            "{} rays at edges and {} at vertices of closed meshes pass between the triangles: it claims none of them; "
            "the first is {}{}",
            share_text(all.passed[0], all.asked[0]), share_text(all.passed[1], all.asked[1]), all.first,
            everywhere ? "" : beyond));
    const std::string words = fmt::format(
        "no ray passes between triangles, of {} at edges and {} at vertices of "
        "closed meshes{}",
        all.asked[0], all.asked[1], beyond);
    if (everywhere) trial.kept(words);
    else trial.noted(words);
}

}  // namespace

void try_edges(Trial& trial) {
    if (trial.shape == Mesh::shape) return try_mesh(trial);
    const auto distribution =
        std::ranges::find(scene::sweep::distributions(), trial.shape, &scene::sweep::DistributionRow::shape);
    if (distribution != scene::sweep::distributions().end() && !distribution->aims.empty())
        try_places(trial, *distribution);
}

}  // namespace lostbits::measure::contract
